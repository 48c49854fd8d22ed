"""Compiled Kalman filter that removes the effects of conditions and slow processes, and tests for steps.

The state of m quantities with p regressors each is

    coefficients (m·p), quantity after quantity · slow processes, from fast to slow (m each)

and a row of a table observes quantity q as X·β_q + Σ process_q + noise. Rows and, within a row, quantities
are processed one by one. The innovations over their standard deviations are z = L⁻¹r, with L the Cholesky
factor of the covariance of the whole series, which is never formed.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit

compiled = njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})


@compiled
def _age(mean, cov, response, first, keep, drive):
    """Advance one process of all quantities, stored from index ``first`` on: x ← keep·x + noise."""
    m, n = drive.shape[0], mean.size
    for i in range(first, first + m):
        mean[i] *= keep
        for j in range(n):
            cov[i, j] *= keep
        for j in range(n):
            cov[j, i] *= keep
    grown = 1.0 - keep * keep
    for i in range(m):
        for j in range(m):
            cov[first + i, first + j] += grown * drive[i, j]
    for t in range(response.shape[0]):
        for d in range(m):
            for i in range(first, first + m):
                response[t, d, i] *= keep


@compiled
def _through(vector, x, q, m):
    """Return H·vector for quantity q."""
    p = x.size
    total = 0.0
    for k in range(p):
        total += vector[q * p + k] * x[k]
    for i in range(m * p + q, vector.size, m):
        total += vector[i]
    return total


@compiled
def _covariance_with(cov, x, q, m, g):
    """Fill g with the covariance between the state and quantity q."""
    for i in range(g.size):
        g[i] = _through(cov[i], x, q, m)


@compiled
def _follow(response, info, score, cross, x, q, m, g, nu, s, steps):
    """Update every possible step with one value: its information, and the response of the state."""
    for t in range(response.shape[0]):
        h = steps[t]
        for d in range(m):
            h[d] = (1.0 if d == q else 0.0) - _through(response[t, d], x, q, m)
        for before in range(t + 1 if cross.shape[0] else 0):
            for d in range(m):
                for e in range(m):
                    cross[t, before, d, e] += h[d] * steps[before, e] / s
        for d in range(m):
            gain = h[d] / s
            score[t, d] += gain * nu
            row = response[t, d]
            for i in range(g.size):
                row[i] += gain * g[i]
            for e in range(m):
                info[t, d, e] += gain * h[e]


@compiled
def learn_value(mean, cov, g, nu, s):
    """Update the state with one value."""
    for i in range(g.size):
        mean[i] += g[i] * nu / s
        part = g[i] / s
        row = cov[i]
        for j in range(g.size):
            row[j] -= part * g[j]


@compiled
def filter_rows(
    mean, cov, response, info, score, cross, rows, values, noise, gaps, rates, slow, innovation, spread
):
    """Filter some rows in place and return their log likelihood.

    Parameters
    ----------
    mean, cov : (n,), (n, n) state
    response : (n_begins, m, n) response of the state to a unit step of each quantity at each onset
    info, score : (n_begins, m, m), (n_begins, m) Σ hhᵀ/s and Σ hν/s of these steps, updated in place
    cross : (n_begins, n_begins, m, m) Σ hhᵀ/s of pairs of steps whose second is not the later one, updated in
        place; of size zero if not needed
    rows : (n_rows, p) regressors
    values, noise : (n_rows, m) observations, NaN where missing, and the variances of their noise
    gaps : (n_rows,) days since the previous row
    rates : (k,) inverse time constants of the processes [1/day]
    slow : (k, m, m) stationary covariances of the processes
    innovation, spread : (n_rows, m) filled with ν and its variance s, NaN where missing
    """
    m, p = slow.shape[1], rows.shape[1]
    g, steps = np.empty(mean.size), np.empty((response.shape[0], m))
    log_likelihood = 0.0
    for r in range(rows.shape[0]):
        x = rows[r]
        if gaps[r] > 0.0:
            for k in range(rates.size):
                _age(mean, cov, response, m * p + k * m, np.exp(-gaps[r] * rates[k]), slow[k])
        for q in range(m):
            innovation[r, q] = np.nan
            spread[r, q] = np.nan
            if not np.isfinite(values[r, q]):
                continue
            _covariance_with(cov, x, q, m, g)
            s = _through(g, x, q, m) + noise[r, q]
            nu = values[r, q] - _through(mean, x, q, m)
            _follow(response, info, score, cross, x, q, m, g, nu, s, steps)
            learn_value(mean, cov, g, nu, s)
            innovation[r, q] = nu
            spread[r, q] = s
            log_likelihood -= 0.5 * (np.log(2.0 * np.pi * s) + nu * nu / s)
    return log_likelihood


@compiled
def _log_sum(x):
    """Return ln Σ exp."""
    most = x.max()
    total = 0.0
    for one in x:
        total += np.exp(one - most)
    return most + np.log(total)


@compiled
def log_mixed(a, c, mu, square, log_weight, out):
    """Fill ``out`` (n,) with ln of the Bayes factors of steps δ ~ N(μ, v²), averaged over sizes.

    Parameters
    ----------
    a, c : (n,) uᵀAu and uᵀb, of one direction after the other, again and again
    mu, square : (n_sizes,) μ and v²
    log_weight : (n_directions, n_sizes) ln of the weights
    """
    each = np.empty(mu.size)
    for i in range(a.size):
        own = log_weight[i % len(log_weight)]
        for k in range(mu.size):
            wide = 1.0 + a[i] * square[k]
            bent = c[i] * c[i] * square[k] + 2.0 * c[i] * mu[k] - a[i] * mu[k] * mu[k]
            each[k] = 0.5 * (bent / wide - np.log(wide)) + own[k]
        out[i] = _log_sum(each)


@compiled
def log_any(info, score, std, log_weight, out):
    """Fill ``out`` (n,) with ln of the Bayes factors of δ ~ N(0, s²I), averaged over sizes.

    Each is ½ s²bᵀ(I + s²A)⁻¹b − ½ ln det (I + s²A), computed by Cholesky factors.

    Parameters
    ----------
    info, score : (n, m, m), (n, m) A and b
    std, log_weight : (n_sizes,) s, and ln of the weights
    """
    m = score.shape[1]
    each, root, turned = np.empty(std.size), np.empty((m, m)), np.empty(m)
    for t in range(out.size):
        for k in range(std.size):
            square = std[k] * std[k]
            each[k] = log_weight[k]
            for i in range(m):
                for j in range(i + 1):
                    x = square * info[t, i, j] + (1.0 if i == j else 0.0)
                    for q in range(j):
                        x -= root[i, q] * root[j, q]
                    root[i, j] = np.sqrt(x) if i == j else x / root[j, j]
                x = std[k] * score[t, i]
                for q in range(i):
                    x -= root[i, q] * turned[q]
                turned[i] = x / root[i, i]
                each[k] += 0.5 * turned[i] * turned[i] - np.log(root[i, i])
        out[t] = _log_sum(each)
