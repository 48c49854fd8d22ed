r"""Tuning of the steel's damping so that the first modes of the whole asset have a given ratio.

A ratio set on the tower alone says little of the coupled modes, which bend jacket and piles too (thesis
section 5.3), and damping in proportion to stiffness that gives the first modes 1 % gives the third bending
modes 8 %. So every undamped mode of the whole asset is given damping of its own,

.. math:: C = \sum_j 2 z_j ω_j\, Mφ_j φ_j^T M,

with the z of the first fore-aft and side-side modes found together from the coupled poles, soil included, and
their mean for all other modes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.linalg as la

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, NumericalError
from jackettwin.response import (
    Group,
    Reduced,
    aligned,
    aligned_coordinates,
    damping_ratio,
    mode_kinds,
    state_matrix,
)
from jackettwin.soil import Prony
from jackettwin.structure import Assembly

_PLANES = ("fore_aft", "side_side")
_TOLERANCE = 1e-7
_STEP = 1e-4
"""Of a ratio, for the slopes."""


def tuned_damping(assembly: Assembly, small: Reduced, ratio: float) -> FloatArray:
    """Return the damping matrix (n, n) of the steel that gives both first modes the damping ``ratio``.

    Raises
    ------
    InputError
        If there are no such modes, or the rest of the asset damps more than ``ratio`` already.
    NumericalError
        If the ratio is not met.
    """
    omega, forces, first = _modes(assembly, small)
    bare = first_ratios(assembly, small, np.zeros((small.n, small.n)))
    if bare.max() > ratio:
        raise InputError(
            "the asset without this damping has more already",
            field="damping.coupled",
            value=ratio,
            allowed=f"> {bare.max():.4f}",
            remedy="lower damping.rayleigh or the soil's damping",
        )

    def matrix(z: FloatArray) -> FloatArray:
        every = np.full(omega.size, z.mean())
        every[list(first)] = z
        return np.asarray((forces * (2.0 * every * omega)) @ forces.T)

    z = ratio - bare
    for _ in range(20):
        error = first_ratios(assembly, small, matrix(z)) - ratio
        if np.abs(error).max() < _TOLERANCE:
            return matrix(z)
        slopes = np.empty((2, 2))
        for j in range(2):
            moved = first_ratios(assembly, small, matrix(z + _STEP * np.eye(2)[j])) - ratio
            slopes[:, j] = (moved - error) / _STEP
        z = np.maximum(z - np.linalg.solve(slopes, error), 0.0)
    raise NumericalError(f"the damping could not be tuned to {ratio}")


def _modes(assembly: Assembly, small: Reduced) -> tuple[FloatArray, FloatArray, tuple[int, int]]:
    """Return ω, Mφ (n, n_modes) of the undamped modes, and which are the first fore-aft and side-side."""
    M = small.pencil.M
    w2, phi = la.eigh(small.pencil.static_stiffness(), M)
    omega = np.sqrt(np.maximum(w2, 0.0))
    phi = aligned_coordinates(assembly, small.basis, omega, phi)
    kinds = mode_kinds(assembly, small.basis @ phi[:, :8], omega[:8] / (2.0 * np.pi))
    return omega, np.asarray(M @ phi), _first_of(kinds)


def first_ratios(assembly: Assembly, small: Reduced, damping: FloatArray) -> FloatArray:
    """Return the damping ratios of the first fore-aft and side-side modes, with ``damping`` (n, n) added."""
    group = Group(Prony(c=1.0), damping, np.arange(small.n))
    pencil = replace(small.pencil, groups=(*small.pencil.groups, group))
    values, states = np.linalg.eig(state_matrix(pencil))
    oscillating = np.flatnonzero(values.imag > 0.0)
    lowest = oscillating[np.argsort(np.abs(values[oscillating]))[:8]]
    poles = values[lowest]
    shapes = aligned(assembly, poles, small.basis @ states[: small.n, lowest])
    kinds = mode_kinds(assembly, shapes, np.abs(poles) / (2.0 * np.pi))
    found = values[lowest[list(_first_of(kinds))]]
    return damping_ratio(found)


def _first_of(kinds: tuple[str, ...]) -> tuple[int, int]:
    for kind in _PLANES:
        if kind not in kinds:
            raise InputError(f"the asset has no {kind.replace('_', '-')} mode", field="damping.coupled")
    return kinds.index(_PLANES[0]), kinds.index(_PLANES[1])
