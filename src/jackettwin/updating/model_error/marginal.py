r"""Errors that data share, marginalised: normal unknowns φ that enter residuals linearly.

With residuals r whitened by what is measured, and their derivatives Γ by independent φ of variance one,

.. math:: r + Γφ \sim N(0, I) \quad\Rightarrow\quad r \sim N(0, A), \qquad A = I + ΓΓ^T,

.. math:: φ \mid r \sim N(-Γ^T A^{-1} r,\; I - Γ^T A^{-1} Γ).
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray


def covariance(gains: FloatArray) -> FloatArray:
    """Return A (..., n_data, n_data) from Γ (..., n_data, n)."""
    return np.asarray(np.eye(gains.shape[-2]) + gains @ np.swapaxes(gains, -1, -2))


def inverse_root(gains: FloatArray) -> FloatArray:
    """Return the symmetric A^(−1/2) (n_data, n_data): so whitened, a residual stays nearest to its datum."""
    w, v = np.linalg.eigh(covariance(gains))
    return np.asarray((v / np.sqrt(w)) @ v.T)


def log_density(r: FloatArray, gains: FloatArray) -> FloatArray:
    """Return ln N(r; 0, A) + n_data/2 ln 2π (n_sets,) of residuals (n_sets, n_data) and Γ."""
    root = np.linalg.cholesky(covariance(gains))
    log_det = np.log(np.einsum("kii->ki", root)).sum(axis=-1)
    return np.asarray(-0.5 * squares(r, gains) - log_det)


def squares(r: FloatArray, gains: FloatArray) -> FloatArray:
    """Return χ² = rᵀA⁻¹r (n_sets,) of residuals r (n_sets, n_data) and Γ."""
    x = np.linalg.solve(covariance(gains), r[..., None])[..., 0]
    return np.asarray((r * x).sum(axis=-1))


def errors_given(r: FloatArray, gains: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean (..., n) and covariance (..., n, n) of φ given residuals r (..., n_data)."""
    weights = np.linalg.solve(covariance(gains), gains)  # A⁻¹Γ
    mean = -np.einsum("...ij,...i->...j", weights, r)
    return mean, np.asarray(np.eye(gains.shape[-1]) - np.swapaxes(weights, -1, -2) @ gains)


def drawn(mean: FloatArray, variance: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return one draw (n_sets, n) from each of many normals."""
    w, v = np.linalg.eigh(variance)
    steps = np.sqrt(np.maximum(w, 0.0)) * rng.standard_normal(mean.shape)
    return np.asarray(mean + np.einsum("kij,kj->ki", v, steps))
