"""What people watch modes with today, to compare: regression with control charts, and PCA novelty.

Each takes daily medians, learns from the baseline, and has its limit where normal independent residuals would
alarm once in the average run length asked for.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2, norm


def daily(
    days: np.ndarray, values: np.ndarray, beside: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return days, daily medians of values, and daily means of what stands beside."""
    whole = np.floor(days)
    unique = np.unique(whole)
    y = np.array([np.median(values[whole == d], axis=0) for d in unique])
    x = np.array([beside[whole == d].mean(axis=0) for d in unique])
    return unique, y, x


def regressed(y: np.ndarray, x: np.ndarray, learn: np.ndarray) -> np.ndarray:
    """Return residuals over their standard deviation, by least squares on the baseline."""
    full = np.column_stack([np.ones(len(x)), x, x**2])
    centre, scale = full[learn].mean(axis=0), full[learn].std(axis=0)
    scale[0], centre[0] = 1.0, 0.0
    full = (full - centre) / scale
    beta, *_ = np.linalg.lstsq(full[learn], y[learn], rcond=None)
    rest = y - full @ beta
    return rest / rest[learn].std(axis=0)


def ewma(rest: np.ndarray, learn: np.ndarray, looks: float, weight: float = 0.1) -> np.ndarray:
    """Return the largest EWMA of the modes over its limit, after the baseline."""
    limit = norm.isf(0.5 / (looks * rest.shape[1])) * np.sqrt(weight / (2.0 - weight))
    z, out = np.zeros(rest.shape[1]), []
    for row in rest[~learn]:
        z = (1.0 - weight) * z + weight * row
        out.append(np.abs(z).max() / limit)
    return np.array(out)


def hotelling(rest: np.ndarray, learn: np.ndarray, looks: float) -> np.ndarray:
    """Return Hotelling's T² over its limit, after the baseline."""
    inverse = np.linalg.inv(np.cov(rest[learn].T))
    t2 = np.einsum("ti,ij,tj->t", rest[~learn], inverse, rest[~learn])
    return t2 / chi2.isf(1.0 / looks, rest.shape[1])


def pca_novelty(y: np.ndarray, learn: np.ndarray, looks: float, kept: int = 2) -> np.ndarray:
    """Return the squared distance from the baseline's leading components over its limit (Yan et al. 2005)."""
    z = (y - y[learn].mean(axis=0)) / y[learn].std(axis=0)
    _, _, vectors = np.linalg.svd(z[learn], full_matrices=False)
    rest = z @ vectors[kept:].T
    q = np.sum((rest / rest[learn].std(axis=0)) ** 2, axis=1)
    return q[~learn] / chi2.isf(1.0 / looks, rest.shape[1])
