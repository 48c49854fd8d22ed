"""Root locus: how the poles of a mode move as a parameter of the support goes from one limit to the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi

import numpy as np
import numpy.typing as npt

from jackettwin.response.follow import follow
from jackettwin.response.modal import UndampedModes
from jackettwin.response.reduced import Reduced, pinned_reference
from jackettwin.response.state import state_matrix
from jackettwin.response.system import Pencil
from jackettwin.soil.viscoelastic import Law

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]


def oscillating_poles(pencil: Pencil) -> tuple[ComplexArray, ComplexArray]:
    """Return λ with Im λ > 0 by |λ| and the shapes (n, n_poles) of a dense pencil of finite laws."""
    values, vectors = np.linalg.eig(state_matrix(pencil))
    keep = np.flatnonzero(values.imag > 1e-9 * np.abs(values))
    keep = keep[np.argsort(np.abs(values[keep]))]
    return values[keep], vectors[: pencil.n, keep]


def followed_poles(pencil: Pencil, reference: UndampedModes) -> ComplexArray:
    """Return the pole of each reference mode (NaN where a mode has no successor)."""
    values, shapes = oscillating_poles(pencil)
    successor = follow(pencil.M, reference.omega, reference.shapes, shapes)
    return np.where(successor >= 0, values[successor], np.nan)


def root_locus(
    reduced: Reduced, law_of: Callable[[float], Law], values: Sequence[float], *, n_modes: int
) -> ComplexArray:
    """Return the poles (n_values, n_modes) of the modes numbered on held supports.

    Parameters
    ----------
    reduced : Reduced
        Its every group takes the law ``law_of(value)``.
    values : sequence of float
        The parameter that is swept.
    """
    reference = pinned_reference(reduced, n_modes)
    poles = np.empty((len(values), n_modes), dtype=np.complex128)
    for row, value in enumerate(values):
        laws = [law_of(value)] * len(reduced.pencil.groups)
        poles[row] = followed_poles(reduced.pencil.with_laws(laws), reference)
    return poles


def frequency_hz(poles: ComplexArray) -> FloatArray:
    """Return |λ|/2π."""
    return np.abs(poles) / (2.0 * pi)


def damping_ratio(poles: ComplexArray) -> FloatArray:
    """Return −Re λ/|λ|."""
    return np.asarray(-poles.real / np.abs(poles))
