"""Tracking of modes from one support to another by shape, not by their position in a sorted list."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import FloatArray, IntArray

NEAR_DEGENERATE = 0.03
"""Reference modes closer than this (relative) are tracked as one subspace."""
RECOGNISED = 0.3
"""Smallest mass-weighted MAC of modes that are taken for the same mode."""


def mass_mac(M: Any, phi: FloatArray, x: npt.NDArray[Any]) -> FloatArray:
    r"""Return the mass-weighted MAC :math:`|φ^T M x|² / (φ^T M φ · x^H M x)`, (n_reference, n_candidates)."""
    Mx = M @ x
    cross = np.abs(phi.T @ Mx) ** 2
    own = np.einsum("ij,ij->j", phi, M @ phi)
    return np.asarray(cross / np.outer(own, np.einsum("ij,ij->j", x.conj(), Mx).real))


def near_degenerate(frequencies: FloatArray, closer_than: float = NEAR_DEGENERATE) -> list[IntArray]:
    """Return the indices of ascending frequencies in groups whose neighbours are near-degenerate."""
    cuts = np.flatnonzero(np.diff(frequencies) > closer_than * frequencies[1:]) + 1
    return np.split(np.arange(frequencies.size), cuts)


def track_modes(M: Any, omega: FloatArray, phi: FloatArray, x: npt.NDArray[Any]) -> IntArray:
    """Return for each reference mode the index of its successor among the candidates, or −1.

    Parameters
    ----------
    M : (n, n) mass matrix
    omega : (n_reference,) ascending frequencies of the reference modes [rad/s]
    phi : (n, n_reference) mass-orthogonal reference modes
    x : (n, n_candidates) real or complex shapes
    """
    successor = np.full(omega.size, -1, dtype=np.intp)
    if x.shape[1] == 0:
        return successor
    single = mass_mac(M, phi, x)
    subspace = np.empty_like(single)
    for group in near_degenerate(omega):
        subspace[group] = single[group].sum(axis=0)
    # candidates are assigned to subspaces first; within a subspace single shapes decide
    from scipy.optimize import linear_sum_assignment  # half a second, and rarely needed

    rows, columns = linear_sum_assignment(-(subspace + 0.1 * single))
    known = subspace[rows, columns] >= RECOGNISED
    successor[rows[known]] = columns[known]
    return successor
