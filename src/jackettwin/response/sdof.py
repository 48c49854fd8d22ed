"""One degree of freedom: what every larger model must agree with."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response.state import state_matrix
from jackettwin.response.system import Group, Pencil
from jackettwin.soil.viscoelastic import Law
from jackettwin.structure.damping import Rayleigh


def sdof(mass_kg: float, law: Law) -> Pencil:
    """Return a mass on a viscoelastic law, thesis (3.1) and (4.10)–(4.11)."""
    one = np.ones((1, 1))
    return Pencil(mass_kg * one, 0.0 * one, Rayleigh(), (Group(law, one, np.array([0])),))


def poles(pencil: Pencil) -> ComplexArray:
    """Return every pole of a small dense pencil, complex pairs first, by |λ|."""
    values = np.linalg.eigvals(state_matrix(pencil)).astype(np.complex128)
    return values[np.lexsort((-values.imag, np.abs(values), np.abs(values.imag) < 1e-12 * np.abs(values)))]


def free_vibration(
    zeta: float, omega: float, t: FloatArray, *, x0: float = 1.0, v0: float = 0.0
) -> FloatArray:
    """Return x(t) of ẍ + 2ζω ẋ + ω² x = 0: under-, critically and overdamped, thesis (3.6)–(3.8)."""
    decay = np.exp(-zeta * omega * t)
    if zeta < 1.0:
        wd = omega * np.sqrt(1.0 - zeta**2)
        return np.asarray(decay * (x0 * np.cos(wd * t) + (v0 + zeta * omega * x0) / wd * np.sin(wd * t)))
    if zeta == 1.0:
        return np.asarray(decay * (x0 + (v0 + omega * x0) * t))
    root = omega * np.sqrt(zeta**2 - 1.0)
    slow, fast = -zeta * omega + root, -zeta * omega - root
    a = (v0 - fast * x0) / (slow - fast)
    return np.asarray(a * np.exp(slow * t) + (x0 - a) * np.exp(fast * t))
