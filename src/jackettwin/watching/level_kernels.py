"""Compiled Kalman filters of many hypotheses on one level in parallel, and the smoother of one hypothesis.

The state of m quantities with p regressors each is

    coefficients (m·p) · own fast, own slow (m each) · common fast, common slow · level · mean · reference ·
    before

and a row observes quantity q as X·β_q + own_q + common + slope_q·level + noise. ``mean`` is the weighted mean
of the level so far, ``reference`` a copy of the mean made at one row, ``before`` the level before its last
jump.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np

from jackettwin.watching.kernels import compiled, learn_value

LEVEL, MEAN, REFERENCE, BEFORE = -4, -3, -2, -1
"""Indices in the state, from its end."""


@compiled
def _age(mean, cov, gap, m, p, keep, grown, walk):
    """Advance the processes and the random walk in time; ``keep``, ``grown`` are as in :func:`smooth_one`."""
    n = mean.size
    first = m * p
    for i in range(first, n - 4):
        which = (i - first) // m if i < first + 2 * m else 2 + i - first - 2 * m
        mean[i] *= keep[which]
        for j in range(n):
            cov[i, j] *= keep[which]
        for j in range(n):
            cov[j, i] *= keep[which]
        cov[i, i] += grown[which]
    cov[n + LEVEL, n + LEVEL] += walk * walk * gap


@compiled
def _jump(mean, cov, variance):
    """Copy the level to ``before``, and add the variance of a jump to it."""
    _copy(mean, cov, mean.size + LEVEL, mean.size + BEFORE)
    cov[mean.size + LEVEL, mean.size + LEVEL] += variance


@compiled
def _copy(mean, cov, source, target):
    n = mean.size
    mean[target] = mean[source]
    for j in range(n):
        cov[target, j] = cov[source, j]
    for j in range(n):
        cov[j, target] = cov[j, source]


@compiled
def _average(mean, cov, share):
    """Move the mean of the level towards the level by a share of the way."""
    n = mean.size
    a, b = n + MEAN, n + LEVEL
    mean[a] += share * (mean[b] - mean[a])
    for j in range(n):
        cov[a, j] += share * (cov[b, j] - cov[a, j])
    for j in range(n):
        cov[j, a] += share * (cov[j, b] - cov[j, a])


@compiled
def _through(v, x, q, m, slope):
    """Return h·v, with h the observation vector of quantity q."""
    p = x.size
    first = m * p
    total = slope * v[v.size + LEVEL]
    for k in range(p):
        total += v[q * p + k] * x[k]
    return total + v[first + q] + v[first + m + q] + v[first + 2 * m] + v[first + 2 * m + 1]


@compiled
def _add_h(v, x, q, m, slope, factor):
    """Add factor·h to a vector."""
    p = x.size
    first = m * p
    v[v.size + LEVEL] += factor * slope
    for k in range(p):
        v[q * p + k] += factor * x[k]
    for i in (first + q, first + m + q, first + 2 * m, first + 2 * m + 1):
        v[i] += factor


@compiled
def age_all(mean, cov, gap, m, p, keep, grown, walk):
    """Advance all hypotheses by a gap of days, in place."""
    for h in range(mean.shape[0]):
        _age(mean[h], cov[h], gap, m, p, keep[h], grown[h], walk[h])


@compiled
def jump_all(mean, cov, variance):
    """Let the level of all hypotheses jump, in place."""
    for h in range(mean.shape[0]):
        _jump(mean[h], cov[h], variance[h])


@compiled
def average_all(mean, cov, share, copied):
    """Update the mean of the level, and copy it to the reference if ``copied``, in place."""
    for h in range(mean.shape[0]):
        _average(mean[h], cov[h], share)
        if copied:
            _copy(mean[h], cov[h], mean[h].size + MEAN, mean[h].size + REFERENCE)


@compiled
def learn_all(mean, cov, x, y, noise, slopes, scale, white, weights, doubtful):
    """Update all hypotheses with a row and return their log likelihoods.

    The noise variance of a value that is more than ``doubtful`` standard deviations from the predictions of
    all likely hypotheses is increased to limit its influence (Huber 1964); ``noise`` is filled with the
    variances used.

    Parameters
    ----------
    mean, cov : (h, n), (h, n, n), changed in place
    x, y, noise, slopes : (p,), (m,), (m,), (m,); y is NaN where missing, noise a variance, changed in place
    scale, white : (h,) factors on the noise, and additional white variances
    weights : (h,) weights of the hypotheses, which decide whether one is likely
    """
    m, n = y.size, mean.shape[1]
    out = np.zeros(mean.shape[0])
    g, nu, s = np.empty((mean.shape[0], n)), np.empty(mean.shape[0]), np.empty(mean.shape[0])
    for q in range(m):
        if not np.isfinite(y[q]):
            continue
        nearest = np.inf
        for h in range(mean.shape[0]):
            for i in range(n):
                g[h, i] = _through(cov[h, i], x, q, m, slopes[q])
            s[h] = _through(g[h], x, q, m, slopes[q]) + white[h]
            nu[h] = y[q] - _through(mean[h], x, q, m, slopes[q])
            if weights[h] > 0.001:
                nearest = min(nearest, abs(nu[h]) / np.sqrt(s[h] + scale[h] * noise[q]))
        noise[q] *= max(nearest / doubtful, 1.0) ** 2
        for h in range(mean.shape[0]):
            total = s[h] + scale[h] * noise[q]
            out[h] -= 0.5 * (np.log(total) + nu[h] * nu[h] / total)
            learn_value(mean[h], cov[h], g[h], nu[h], total)
    return out


@compiled
def smooth_one(
    mean, cov, rows, values, noise, slopes, gaps, jumps, shares, copied, keep, grown, walk, scale, white
):
    """Return the level after each row, given all rows (Bryson & Frazier 1963).

    Parameters
    ----------
    mean, cov : state before the first row, changed in place
    rows, values, noise : (r, p), (r, m), (r, m)
    gaps, jumps, shares : (r,) days before each row, variance of a jump before it, share of the step of the
        mean
    copied : (r,) bool, whether the mean becomes the reference
    keep, grown : (r, 4), (r, 4) factor on each process over the gap, and its new variance

    Returns
    -------
    (r, 3) means and variances of the level, and its covariance with the last reference.
    """
    r, m, n, p = gaps.size, slopes.size, mean.size, rows.shape[1]
    g, nu, s = np.empty((r, m, n)), np.empty((r, m)), np.full((r, m), np.nan)
    level, along = np.empty(r), np.empty((r, n))
    for t in range(r):
        _age(mean, cov, gaps[t], m, p, keep[t], grown[t], walk)
        if jumps[t] > 0.0:
            _jump(mean, cov, jumps[t])
        for q in range(m):
            if not np.isfinite(values[t, q]):
                continue
            for i in range(n):
                g[t, q, i] = _through(cov[i], rows[t], q, m, slopes[q])
            s[t, q] = _through(g[t, q], rows[t], q, m, slopes[q]) + white + scale * noise[t, q]
            nu[t, q] = values[t, q] - _through(mean, rows[t], q, m, slopes[q])
            learn_value(mean, cov, g[t, q], nu[t, q], s[t, q])
        level[t] = mean[n + LEVEL]
        along[t] = cov[n + LEVEL]
        _average(mean, cov, shares[t])
        if copied[t]:
            _copy(mean, cov, n + MEAN, n + REFERENCE)
    return _backward(rows, slopes, jumps, shares, copied, keep, g, nu, s, level, along)


@compiled
def _backward(rows, slopes, jumps, shares, copied, keep, g, nu, s, level, along):
    r, m, n = s.shape[0], s.shape[1], along.shape[1]
    first = m * rows.shape[1]
    out = np.empty((r, 3))
    pull, bend, last = np.zeros(n), np.zeros((n, n)), np.zeros(n)
    last[n + REFERENCE] = 1.0
    turned = np.empty(n)
    for t in range(r - 1, -1, -1):
        _back_mean(pull, shares[t], copied[t])
        _back_mean(last, shares[t], copied[t])
        for i in range(n):
            _back_mean(bend[i], shares[t], copied[t])
        for i in range(n):
            _back_mean(bend[:, i], shares[t], copied[t])
        turned[:] = bend @ along[t]
        out[t, 0] = level[t] - along[t] @ pull
        out[t, 1] = along[t][n + LEVEL] - along[t] @ turned
        out[t, 2] = along[t] @ last
        for q in range(m - 1, -1, -1):
            if np.isfinite(s[t, q]):
                _back_value(pull, bend, last, g[t, q] / s[t, q], nu[t, q], s[t, q], rows[t], q, m, slopes[q])
        _back_jump(pull, bend, last, jumps[t])
        _back_age(pull, bend, last, first, m, keep[t])
    return out


@compiled
def _back_mean(v, share, copied):
    n = v.size
    if copied:
        v[n + MEAN] += v[n + REFERENCE]
        v[n + REFERENCE] = 0.0
    v[n + LEVEL] += share * v[n + MEAN]
    v[n + MEAN] *= 1.0 - share


@compiled
def _back_jump(pull, bend, last, variance):
    """Propagate the adjoints back through a jump, if there was one; ``before`` then is the level."""
    if variance == 0.0:
        return
    n = pull.size
    a, b = n + LEVEL, n + BEFORE
    pull[a] += pull[b]
    last[a] += last[b]
    pull[b] = 0.0
    last[b] = 0.0
    for i in range(n):
        bend[i, a] += bend[i, b]
        bend[i, b] = 0.0
    for i in range(n):
        bend[a, i] += bend[b, i]
        bend[b, i] = 0.0


@compiled
def _back_age(pull, bend, last, first, m, keep):
    """Propagate the adjoints back through the gap before a row."""
    n = pull.size
    for i in range(first, n - 4):
        which = (i - first) // m if i < first + 2 * m else 2 + i - first - 2 * m
        pull[i] *= keep[which]
        last[i] *= keep[which]
        for j in range(n):
            bend[i, j] *= keep[which]
        for j in range(n):
            bend[j, i] *= keep[which]


@compiled
def _back_value(pull, bend, last, gain, nu, s, x, q, m, slope):
    """Update the adjoints backwards by one value: λ ← (I − hKᵀ)λ − hν/s, Λ ← (I − hKᵀ)Λ(I − Khᵀ) + hhᵀ/s."""
    n = pull.size
    _add_h(pull, x, q, m, slope, -(gain @ pull) - nu / s)
    _add_h(last, x, q, m, slope, -(gain @ last))
    bent = bend @ gain
    twice = gain @ bent + 1.0 / s
    h = np.zeros(n)
    _add_h(h, x, q, m, slope, 1.0)
    for i in range(n):
        for j in range(n):
            bend[i, j] += h[i] * (twice * h[j] - bent[j]) - bent[i] * h[j]
