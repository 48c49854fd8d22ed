r"""Marginalisation of errors that are common to data: normal unknowns φ that enter residuals linearly.

With residuals r whitened by the measurement uncertainty, and their derivatives Γ by independent φ of variance
one,

.. math:: r + Γφ \sim N(0, I) \quad\Rightarrow\quad r \sim N(0, A), \qquad A = I + ΓΓ^T,

.. math:: φ \mid r \sim N(-Γ^T A^{-1} r,\; I - Γ^T A^{-1} Γ).

The sizes of the errors are estimates themselves: with equally likely scales s, r is a mixture of N(0, I +
s²ΓΓᵀ), and data that need large errors make a larger scale likely.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp

from jackettwin.arrays import FloatArray


def covariance(gains: FloatArray) -> FloatArray:
    """Return A (..., n_data, n_data) from Γ (..., n_data, n)."""
    return np.asarray(np.eye(gains.shape[-2]) + gains @ np.swapaxes(gains, -1, -2))


def inverse_root(gains: FloatArray) -> FloatArray:
    """Return the symmetric A^(−1/2) (n_data, n_data), which changes residuals least of all whitenings."""
    w, v = np.linalg.eigh(covariance(gains))
    return np.asarray((v / np.sqrt(w)) @ v.T)


def log_density(r: FloatArray, gains: FloatArray, scales: Sequence[float] = (1.0,)) -> FloatArray:
    """Return ln of r's density + n_data/2 ln 2π (n_sets,) of residuals (n_sets, n_data) and Γ.

    Parameters
    ----------
    scales : equally likely common scales of all errors
    """
    each = _log_densities(r, gains, scales)
    return np.asarray(logsumexp(each, axis=0) - np.log(len(scales)))


def _log_densities(r: FloatArray, gains: FloatArray, scales: Sequence[float]) -> FloatArray:
    """Return ln N(r; 0, I + s²ΓΓᵀ) + n_data/2 ln 2π of every scale, (n_scales, n_sets)."""
    found = []
    for scale in scales:
        root = np.linalg.cholesky(covariance(scale * gains))
        log_det = np.log(np.einsum("kii->ki", root)).sum(axis=-1)
        found.append(-0.5 * squares(r, scale * gains) - log_det)
    return np.array(found)


def squares(r: FloatArray, gains: FloatArray) -> FloatArray:
    """Return χ² = rᵀA⁻¹r (n_sets,) of residuals r (n_sets, n_data) and Γ."""
    x = np.linalg.solve(covariance(gains), r[..., None])[..., 0]
    return np.asarray((r * x).sum(axis=-1))


def errors_given(r: FloatArray, gains: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean (..., n) and covariance (..., n, n) of φ given residuals r (..., n_data)."""
    weights = np.linalg.solve(covariance(gains), gains)  # A⁻¹Γ
    mean = -np.einsum("...ij,...i->...j", weights, r)
    return mean, np.asarray(np.eye(gains.shape[-1]) - np.swapaxes(weights, -1, -2) @ gains)


def drawn_scales(
    r: FloatArray, gains: FloatArray, scales: Sequence[float], rng: np.random.Generator
) -> FloatArray:
    """Return one scale (n_sets,) drawn for each of many residuals (n_sets, n_data)."""
    log_p = _log_densities(r, gains, scales)
    share = np.cumsum(np.exp(log_p - logsumexp(log_p, axis=0)), axis=0)
    which = (rng.random(len(r)) > share[:-1]).sum(axis=0)
    return np.asarray(np.array(scales)[which])


def drawn(mean: FloatArray, variance: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return one draw (n_sets, n) from each of many normals."""
    w, v = np.linalg.eigh(variance)
    steps = np.sqrt(np.maximum(w, 0.0)) * rng.standard_normal(mean.shape)
    return np.asarray(mean + np.einsum("kij,kj->ki", v, steps))
