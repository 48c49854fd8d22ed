r"""Tracking of a common level that changes all quantities in known proportions, in the presence of weather.

.. math:: y_q(t) = X(t) β_q + u_q(t) + u(t) + s_q ℓ(t) + e_q(t)

with y the logarithms of frequencies, X the conditions' regressors (:mod:`jackettwin.watching.design`), β
unknown coefficients, u the unexplained variation (per quantity and common, of days and of weeks), s known
slopes, e the stated noise, and ℓ a random walk with jumps. For given hyperparameters and days of jumps the
model is linear and Gaussian, so that a Kalman filter is exact; each such hypothesis is filtered, and the
result is their mixture weighted by evidence. Hypotheses with the same hyperparameters whose jumps are old are
merged by their moments (Blom & Bar-Shalom 1988), so that the cost per row is bounded.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.intervals import QUANTILES
from jackettwin.watching.level_kernels import (
    BEFORE,
    LEVEL,
    REFERENCE,
    age_all,
    average_all,
    jump_all,
    learn_all,
    smooth_one,
)

UNEXPLAINED = (1e-4, 3e-4, 1e-3, 3e-3)
"""Standard deviations of ln f that no condition explains."""
WALKS = (1e-4, 5e-4, 3e-3)
"""Standard deviations of the daily step of the level; they accumulate to 0.2, 1 or 6 % in a year."""
SCALES = (1.0, 2.5)
"""Factors on stated variances."""
FAST_DAYS, SLOW_DAYS = 2.0, (8.0, 30.0)
"""Time constants of the unexplained variation. A third of its variance is white, a third fast, a third slow;
half of the fast and of the slow part is common to all quantities. The slow part limits what many days say of
a level, so that its memory is left to the data: weather that lasts a week, or a month."""
_GRID = np.array(list(product(UNEXPLAINED, WALKS, SCALES, SLOW_DAYS)))
JUMPS = (0.05, 0.3)
"""Standard deviations of a jump."""
JUMPS_A_DAY = 1e-3
"""Prior rate of jumps: one in three years."""
_MOST, _YOUNG_ROWS, _OLD_ROWS, _PARENTS = len(_GRID), 6, 40, 3
"""Largest number of hypotheses; rows for which a new one is retained regardless of its weight; rows after
which its jump is merged with others; and number of hypotheses that may branch into a jump on a day."""
_MOST_ROOTS = 8
"""Number of hypotheses retained at the beginning of a window."""
_NEGLIGIBLE = 16.0
"""Hypotheses whose ln weight is this far below the largest are dropped."""
_DOUBTFUL = 3.0
_SMOOTHED = 6
"""Number of most likely hypotheses used for smoothing."""


@dataclass(frozen=True)
class Readings:
    """Rows of quantities, in the order of time.

    Attributes
    ----------
    days : (n,) times [days]
    rows : (n, p) regressors
    values, noise : (n, m) ln of ratios to typical values, NaN where missing, and their stated variances
    copied : (n,) bool, whether the mean level becomes the reference after the row
    """

    days: FloatArray
    rows: FloatArray
    values: FloatArray
    noise: FloatArray
    copied: BoolArray

    def part(self, first: int, last: int) -> Readings:
        """Return some of the rows."""
        s = slice(first, last)
        return Readings(self.days[s], self.rows[s], self.values[s], self.noise[s], self.copied[s])


@dataclass(frozen=True)
class Mixture:
    """Mixtures of normal distributions: of the level, and of the level minus its reference."""

    weights: FloatArray
    level: FloatArray
    level_std: FloatArray
    shift: FloatArray
    shift_std: FloatArray


@dataclass(frozen=True)
class Jump:
    """A recent jump of the level: its probability, and 5, 50 and 95 % quantiles of its day and size."""

    probability: float
    days: tuple[float, float, float]
    size: tuple[float, float, float]


@dataclass(frozen=True)
class Hypotheses:
    """State after some rows: weighted hypotheses.

    Attributes
    ----------
    mean, cov, log_weight : (h, n), (h, n, n), (h,) state, its covariance and ln weight of each hypothesis
    model : (h,) index of its hyperparameters
    row, jumped : (h,) row and day of its last jump; −1 and NaN if there is none or it is old
    root : (h,) index of its ancestor at the last :func:`rooted`
    paths : for each, (row, index in ``JUMPS``) of its jumps since then
    slopes : (m,) change of each quantity per unit of the level
    n_rows, day : number of rows processed, and day of the last
    taken : sum of the rows' weights in the mean of the level
    half : (h,) index of its ancestor at the last :func:`halved`, if any
    """

    mean: FloatArray
    cov: FloatArray
    log_weight: FloatArray
    model: IntArray
    row: IntArray
    jumped: FloatArray
    root: IntArray
    paths: tuple[tuple[tuple[int, int], ...], ...]
    slopes: FloatArray
    n_rows: int = 0
    day: float = float("nan")
    taken: float = 0.0
    half: IntArray | None = None

    @property
    def weights(self) -> FloatArray:
        """Weights of the hypotheses, (h,); they sum to one."""
        return np.asarray(np.exp(self.log_weight - np.logaddexp.reduce(self.log_weight)))

    @property
    def mixture(self) -> Mixture:
        """Distribution of the level."""
        level, reference = self.mean[:, LEVEL], self.mean[:, REFERENCE]
        var = self.cov[:, LEVEL, LEVEL]
        apart = var - 2.0 * self.cov[:, LEVEL, REFERENCE] + self.cov[:, REFERENCE, REFERENCE]
        return Mixture(self.weights, level, _root(var), level - reference, _root(apart))

    @property
    def jump(self) -> Jump | None:
        """The last jump, if any hypothesis has a recent one."""
        chosen = self.row >= 0
        if not chosen.any():
            return None
        w = self.weights[chosen]
        size = self.mean[chosen, LEVEL] - self.mean[chosen, BEFORE]
        cov = self.cov[chosen]
        std = _root(cov[:, LEVEL, LEVEL] - 2.0 * cov[:, LEVEL, BEFORE] + cov[:, BEFORE, BEFORE])
        return Jump(
            float(w.sum()),
            _three(_steps(self.jumped[chosen], w)),
            _three(mixture_quantiles(w / w.sum(), size, std, QUANTILES)),
        )


def _three(x: FloatArray) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])


def _steps(x: FloatArray, w: FloatArray) -> FloatArray:
    order = np.argsort(x)
    total = np.cumsum(w[order]) / w.sum()
    return np.asarray(x[order][np.minimum(np.searchsorted(total, QUANTILES), x.size - 1)])


def _root(x: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.maximum(x, 1e-18)))


def mixture_quantiles(
    weights: FloatArray, mean: FloatArray, std: FloatArray, levels: tuple[float, ...]
) -> FloatArray:
    """Return quantiles of a mixture of normal distributions, by bisection.

    >>> mixture_quantiles(np.ones(1), np.zeros(1), np.ones(1), (0.05, 0.9)).round(2)
    array([-1.64,  1.28])
    """
    from scipy.special import ndtr

    low = np.full(len(levels), float(np.min(mean - 8.0 * std)))
    high = np.full(len(levels), float(np.max(mean + 8.0 * std)))
    for _ in range(50):
        middle = 0.5 * (low + high)
        below = ndtr((middle[:, None] - mean) / std) @ weights < np.asarray(levels)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(0.5 * (low + high))


def no_rows(slopes: FloatArray, coefficient_std: FloatArray) -> Hypotheses:
    """Return the state before the first row: equal weights of all hyperparameters, and a level of zero.

    Parameters
    ----------
    slopes : (m,) change of each quantity per unit of the level
    coefficient_std : (m, p) prior standard deviations of the coefficients
    """
    m, p = coefficient_std.shape
    n, h = m * p + 2 * m + 6, len(_GRID)
    cov = np.zeros((h, n, n))
    diagonal = np.zeros((h, n))
    diagonal[:, : m * p] = coefficient_std.ravel() ** 2
    diagonal[:, m * p : n - 4] = _process_variance(_GRID[:, 0, None])
    cov[:, range(n), range(n)] = diagonal
    whole = np.arange(h)
    return Hypotheses(
        np.zeros((h, n)), cov, np.zeros(h), whole, np.full(h, -1), np.full(h, np.nan), whole,
        ((),) * h, np.asarray(slopes, dtype=np.float64),
    )  # fmt: skip


def _process_variance(unexplained: FloatArray) -> FloatArray:
    """Return the variance of each of the four processes: a sixth of the unexplained variance."""
    return np.asarray(unexplained**2 / 6.0)


def _decay(gap: FloatArray, slow_days: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factor on each process over a gap, and its new variance as a share of the stationary one."""
    fast, slow = np.exp(-gap / FAST_DAYS), np.exp(-gap / slow_days)
    keep = np.stack(np.broadcast_arrays(fast, slow, fast, slow), axis=-1)
    return keep, 1.0 - keep**2


def after_row(known: Hypotheses, readings: Readings, r: int) -> tuple[Hypotheses, FloatArray]:
    """Return the state after one more row, and the noise variances (m,) used for its values."""
    day, m = float(readings.days[r]), known.slopes.size
    p = readings.rows.shape[1]
    gap = 0.0 if known.n_rows == 0 else max(day - known.day, 0.0)
    known, n_old = _branched(known, day, gap)
    mean, cov, grid = known.mean, known.cov, _GRID[known.model]
    keep, grown = _decay(np.array(gap), grid[:, 3])
    age_all(mean, cov, gap, m, p, keep, grown * _process_variance(grid[:, :1]), grid[:, 1])
    jump_all(mean[n_old:], cov[n_old:], np.tile(np.array(JUMPS) ** 2, (len(mean) - n_old) // len(JUMPS)))
    noise = readings.noise[r].copy()
    likelihood = learn_all(
        mean, cov, readings.rows[r], readings.values[r], noise, known.slopes, grid[:, 2],
        grid[:, 0] ** 2 / 3.0, known.weights, _DOUBTFUL,
    )  # fmt: skip
    taken, share = _mean_step(known.taken, readings, r, known.slopes)
    average_all(mean, cov, share, bool(readings.copied[r]))
    weight = known.log_weight + likelihood
    known = replace(known, log_weight=weight - weight.max(), day=day, taken=taken, n_rows=known.n_rows + 1)
    return _pruned(known), noise


def _mean_step(taken: float, readings: Readings, r: int, slopes: FloatArray) -> tuple[float, float]:
    """Return the weight of all rows so far in the mean of the level, and the share of the current row."""
    seen = np.isfinite(readings.values[r])
    own = float(np.sum(slopes[seen] ** 2 / readings.noise[r][seen]))
    total = taken + own
    return total, own / total if total > 0.0 else 0.0


def _branched(known: Hypotheses, day: float, gap: float) -> tuple[Hypotheses, int]:
    """Return a copy of the hypotheses, followed by those in which the level jumps, and where these begin.

    The level may have jumped since the last row if that is of an earlier day.
    """
    may = known.n_rows > 0 and np.floor(day) > np.floor(known.day)
    n, best = known.log_weight.size, np.argsort(-known.log_weight, kind="stable")[: _PARENTS if may else 0]
    more = _chosen(known, np.concatenate([np.arange(n), np.repeat(best, len(JUMPS))]))
    if may:
        more.log_weight[n:] += np.log(-np.expm1(-JUMPS_A_DAY * gap) / len(JUMPS))
        more.row[n:], more.jumped[n:] = known.n_rows, day
    sizes = tuple(range(len(JUMPS))) * best.size
    paths = ((*path, (known.n_rows, size)) for path, size in zip(more.paths[n:], sizes, strict=True))
    return replace(more, paths=(*known.paths, *paths)), n


def _pruned(known: Hypotheses) -> Hypotheses:
    """Return the hypotheses without those of negligible weight."""
    old = (known.row < 0) | (known.n_rows - known.row > _OLD_ROWS)
    if (old & (known.row >= 0)).any():
        known = _merged(known, old)
    order = np.argsort(-known.log_weight, kind="stable")
    kept = np.zeros(order.size, dtype=np.bool_)
    kept[order[:_MOST]] = True
    kept &= known.log_weight > known.log_weight[order[0]] - _NEGLIGIBLE
    kept |= (known.row >= 0) & (known.n_rows - known.row <= _YOUNG_ROWS)
    return known if kept.all() else _chosen(known, np.flatnonzero(kept))


def _chosen(known: Hypotheses, kept: IntArray) -> Hypotheses:
    return replace(
        known,
        mean=known.mean[kept],
        cov=known.cov[kept],
        log_weight=known.log_weight[kept],
        model=known.model[kept],
        row=known.row[kept],
        root=known.root[kept],
        half=None if known.half is None else known.half[kept],
        jumped=known.jumped[kept],
        paths=tuple(known.paths[i] for i in kept),
    )


def _merged(known: Hypotheses, old: BoolArray) -> Hypotheses:
    """Return the hypotheses with those without a recent jump merged, one per set of hyperparameters."""
    mean, cov = known.mean.copy(), known.cov.copy()
    weight, row, jumped = known.log_weight.copy(), known.row.copy(), known.jumped.copy()
    kept = list(np.flatnonzero(~old))
    for model in np.unique(known.model[old]):
        members = np.flatnonzero(old & (known.model == model))
        likeliest = members[np.argmax(weight[members])]
        total = float(np.logaddexp.reduce(weight[members]))
        w = np.exp(weight[members] - total)
        middle = w @ mean[members]
        off = mean[members] - middle
        cov[likeliest] = np.einsum("h,hij->ij", w, cov[members]) + (w[:, None] * off).T @ off
        mean[likeliest], weight[likeliest] = middle, total
        row[likeliest], jumped[likeliest] = -1, np.nan
        kept.append(likeliest)
    merged = replace(known, mean=mean, cov=cov, log_weight=weight, row=row, jumped=jumped)
    return _chosen(merged, np.array(sorted(kept)))


def forecast(known: Hypotheses, days: float) -> Mixture:
    """Return the distribution of the level some days later, after a random walk with at most one jump."""
    now = known.mixture
    walked = _GRID[known.model, 1] ** 2 * days
    chance = -np.expm1(-JUMPS_A_DAY * days)
    parts = [(1.0 - chance, 0.0), *((chance / len(JUMPS), jump**2) for jump in JUMPS)]
    many = len(parts)
    more = np.concatenate([walked + variance for _, variance in parts])
    return Mixture(
        np.concatenate([share * now.weights for share, _ in parts]),
        np.tile(now.level, many),
        np.sqrt(np.tile(now.level_std, many) ** 2 + more),
        np.tile(now.shift, many),
        np.sqrt(np.tile(now.shift_std, many) ** 2 + more),
    )


def halved(known: Hypotheses) -> Hypotheses:
    """Return the hypotheses, each its own ancestor from here on; see :func:`rooted`."""
    return replace(known, half=np.arange(known.log_weight.size))


def rooted(known: Hypotheses, later: Hypotheses) -> Hypotheses:
    """Return the hypotheses as roots of later ones, from which smoothing can start.

    Parameters
    ----------
    later : later state, descended from these since they were :func:`halved`; only the roots that are the most
        likely by then are returned
    """
    if later.half is None:
        raise ValueError("hypotheses that were never halved")
    weight = np.bincount(later.half, later.weights, known.log_weight.size)
    known = _chosen(known, np.sort(np.argsort(-weight, kind="stable")[:_MOST_ROOTS]))
    h = known.log_weight.size
    return replace(known, root=np.arange(h), paths=((),) * h, half=None)


def smoothed(start: Hypotheses, end: Hypotheses, readings: Readings) -> tuple[Mixture, ...]:
    """Return the level after each row since ``start``, given all rows; ``end`` must be rooted at ``start``.

    Parameters
    ----------
    readings : rows between ``start`` and ``end``, with the noise variances that were used
    """
    best = np.argsort(-end.log_weight, kind="stable")[:_SMOOTHED]
    weights = end.weights[best] / end.weights[best].sum()
    gaps = np.diff(readings.days, prepend=readings.days[0] if np.isnan(start.day) else start.day)
    gaps = np.maximum(gaps, 0.0)
    shares, taken = np.empty(gaps.size), start.taken
    for r in range(gaps.size):
        taken, shares[r] = _mean_step(taken, readings, r, start.slopes)
    parts, spread = [], []
    for h in best:
        root, (unexplained, walk, scale, slow_days) = end.root[h], _GRID[end.model[h]]
        jumps = np.zeros(gaps.size)
        for row, size in end.paths[h]:
            jumps[row - start.n_rows] = JUMPS[size] ** 2
        keep, grown = _decay(gaps, slow_days)
        parts.append(
            smooth_one(
                start.mean[root].copy(), start.cov[root].copy(), readings.rows, readings.values,
                readings.noise, start.slopes, gaps, jumps, shares, readings.copied, keep,
                grown * _process_variance(unexplained), walk, scale, unexplained**2 / 3.0,
            )
        )  # fmt: skip
        spread.append((end.mean[h, REFERENCE], end.cov[h, REFERENCE, REFERENCE]))
    out, (reference, variance) = np.array(parts), np.array(spread).T
    return tuple(
        Mixture(
            weights, out[:, r, 0], _root(out[:, r, 1]), out[:, r, 0] - reference,
            _root(out[:, r, 1] - 2.0 * out[:, r, 2] + variance),
        )
        for r in range(gaps.size)
    )  # fmt: skip
