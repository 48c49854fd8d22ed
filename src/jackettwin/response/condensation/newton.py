"""Refinement of initial poles of many sets: one or two by compiled code, larger clusters in NumPy."""

from __future__ import annotations

import logging
from functools import cache
from typing import Any

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.response.condensation.condensed import Condensed

log = logging.getLogger(__name__)

STEP = 1e-6
"""Largest relative size of the last step: convergence is cubic, so that the remaining error is at rounding
level."""


@cache
def kernels() -> Any:
    """Return the compiled module, imported when first needed because it loads a compiler."""
    from jackettwin.response.condensation import kernels as condensed_kernels

    if not condensed_kernels.compiled_before():
        log.info("the numerical kernels are compiled, once after an installation: a quarter of a minute")
    return condensed_kernels


def refined(
    model: Condensed,
    rows: FloatArray,
    rayleigh: FloatArray,
    family: IntArray,
    values: ComplexArray,
    vectors: ComplexArray,
    near: float,
) -> BoolArray:
    """Refine initial poles in place, those of one family together if they are near each other.

    Parameters
    ----------
    rows, rayleigh : (n_sets, …) as in :class:`jackettwin.response.condensation.numbered_modes.Points`
    family : (n_modes,) ascending numbers
    values : (n_sets, n_modes) initial poles; NaN for a mode without one
    vectors : (n_sets, n_modes, n)
    near : float
        Relative distance below which poles are refined together.

    Returns
    -------
    (n_sets, n_modes), whether each converged
    """
    found = kernels().refine(model.arrays(), rows, rayleigh, family, values, vectors, near, STEP)
    done: BoolArray = found == 1
    for k in np.flatnonzero((found < 0).any(axis=1)):
        for cluster in np.unique(found[k][found[k] < 0]):
            at = np.flatnonzero(found[k] == cluster)
            pole, shape = values[k, at], vectors[k, at]
            done[k, at] = _cluster(model, rows[k], rayleigh[k], pole, shape, near)
            values[k, at], vectors[k, at] = pole, shape
    return done


def _cluster(
    model: Condensed,
    rows: FloatArray,
    rayleigh: FloatArray,
    values: ComplexArray,
    vectors: ComplexArray,
    near: float,
) -> BoolArray:
    """Refine a cluster of more than two poles in place: first together, then distinct ones separately."""
    limits = kernels()
    inseparable = near <= limits.INSEPARABLE
    if not _block(model, rows, rayleigh, values, vectors, STEP if inseparable else limits.COARSE):
        return np.zeros(values.size, dtype=np.bool_)
    if inseparable:
        return np.ones(values.size, dtype=np.bool_)
    one = np.zeros(values.size, dtype=np.intp)
    parts = (rows[None], rayleigh[None], one, values[None], vectors[None])
    return np.asarray(refined(model, *parts, limits.INSEPARABLE)[0])


def _block(
    model: Condensed,
    rows: FloatArray,
    rayleigh: FloatArray,
    values: ComplexArray,
    vectors: ComplexArray,
    tolerance: float,
) -> bool:
    """Refine nearly equal poles by block inverse iteration and Rayleigh–Ritz about their mean, in place.

    Return whether the mean converged. The remaining error is the square of the poles' distance from each
    other.
    """
    n, n_pairs = model.n, model.terms.shape[1]
    F, dF = np.empty((2, n, n), np.complex128)
    s0, s1 = np.empty((2, n_pairs), np.complex128)
    for number in range(kernels().MAX_STEPS):
        s = values.mean()
        kernels().fill(model.arrays(), rows, *rayleigh, s, F, dF, s0, s1)
        try:
            # the Rayleigh quotients of the shapes are more accurate than the initial poles
            force = F @ vectors.T if number == 0 else dF @ vectors.T
            U, R = np.linalg.qr(vectors.T if number == 0 else np.linalg.solve(F, force))
            residual = np.linalg.solve(R.T, force.T).T
            delta, Y = np.linalg.eig(np.linalg.solve(U.T @ dF @ U, -U.T @ residual))
        except np.linalg.LinAlgError:
            # F is numerically singular at a pole
            return number > 0
        step, most = delta.mean(), 0.3 * abs(s)
        if not np.isfinite(delta).all():
            return False
        spread = float(np.abs(delta - step).max())
        shrunk = min(1.0, most / max(spread, np.finfo(float).tiny))
        values[:] = s + step * min(1.0, most / max(abs(step), np.finfo(float).tiny)) + shrunk * (delta - step)
        # eigenvectors of equal values would be determined by rounding and might be parallel
        mixed = (U @ Y if spread > kernels().EQUAL * abs(s) else U).T
        vectors[:] = mixed / np.linalg.norm(mixed, axis=1)[:, None]
        if number > 0 and abs(step) <= tolerance * abs(s):
            return True
    return False


def law_response(
    rows: FloatArray, jacobian: FloatArray, s: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the complex stiffness of laws and its derivatives by their parameters.

    Parameters
    ----------
    rows : (n_groups, width) as in :mod:`jackettwin.soil.laws.coefficients`
    jacobian : (n_groups, width, n_z) d rows/dz
    s : (n_s,) Laplace variable [rad/s]

    Returns
    -------
    (n_groups, n_s) D(s) [N/m], and (n_groups, n_s, n_z) dD/dz
    """
    D = np.empty((len(rows), s.size), np.complex128)
    dD = np.empty((*D.shape, jacobian.shape[2]), np.complex128)
    kernels().law_response(
        np.ascontiguousarray(rows), np.ascontiguousarray(jacobian), np.ascontiguousarray(s), D, dD
    )
    return D, dD
