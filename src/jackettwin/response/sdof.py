"""One degree of freedom: what every larger model must agree with."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray
from jackettwin.response.state import state_matrix
from jackettwin.response.system import Group, Pencil
from jackettwin.soil import Law
from jackettwin.structure import Rayleigh


def sdof(mass_kg: float, law: Law) -> Pencil:
    """Return a mass on a viscoelastic law, thesis (3.1) and (4.10)–(4.11)."""
    one = np.ones((1, 1))
    return Pencil(mass_kg * one, 0.0 * one, Rayleigh(), (Group(law, one, np.array([0])),))


def poles(pencil: Pencil) -> ComplexArray:
    """Return every pole of a small dense pencil, complex pairs first, by |λ|."""
    values = np.linalg.eigvals(state_matrix(pencil)).astype(np.complex128)
    return values[np.lexsort((-values.imag, np.abs(values), np.abs(values.imag) < 1e-12 * np.abs(values)))]
