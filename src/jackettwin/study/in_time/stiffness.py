r"""The ground's stiffness over time, from frequencies corrected for the weather.

All stiffness changes by one factor, k(t) = k₁ e^{x(t)}, where k₁ is that of the first day. Frequencies are
the less sensitive to it the stiffer the ground is: ln f = ln f₁ + s h(x) with

.. math:: h(x) = (1 - e^{-ax}) / a

and one a for all modes. It is 1 where the ground's share of the flexibility is small, for frequencies are
then linear in 1/k. So ℓ = h(x) is the level of :mod:`jackettwin.watching.level`; the model gives s and a.
Since the sensitivity depends on the ground's stiffness, each draw of the posterior has its own slope e^{-aΔ}
s. The estimate from all records together holds for the ground at the mean of ℓ so far.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from jackettwin.arrays import FloatArray
from jackettwin.change import Columns, Days, history_of
from jackettwin.intervals import QUANTILES
from jackettwin.twin import TwinModel
from jackettwin.updating import Problem
from jackettwin.watching import (
    Design,
    History,
    Jump,
    Lagged,
    Mixture,
    Readings,
    design_of,
    regressors,
    typical,
    with_time_of_year,
)

_APART = 0.4
"""Step of ln k, up and down, of the finite differences for slopes and bend."""
_LEAST_SLOPE = 0.02
"""Share of the steepest mode's slope below which a mode is not used."""
_MOST_MODES = 6
_LEAST_SPREAD = 5e-4
"""Least standard deviation of ln f that conditions may explain."""
_EPOCH = np.datetime64("1970-01-01")
_MOST_DRAWS = 60
_STEPS = (32, 24)
"""Steps into which the range of a level is divided, then the one that contains a quantile. Within the last
step, a 64th of a standard deviation, the distribution is linear."""
_FINE, _COARSE, _HEAVY = np.linspace(-6.0, 6.0, 49), np.linspace(-6.0, 6.0, 9), 6
"""Standard deviations from the mean of the heaviest components, and of all, at which the distribution of a
level is computed. In between it is linear: wrong by 0.002 at most."""
_LEAST_WEIGHT = 1e-4
"""Least weight of a mixture's component that is used."""
_FARTHEST = 4.0
"""Largest change of ln k: a factor of 50."""

Span3 = tuple[float, float, float]
"""Quantiles of 5, 50 and 95 %."""


@dataclass(frozen=True)
class Sensitivity:
    """Sensitivity of frequencies to a common change x of ln k: ln f = s h(x), h(x) = (1 − e^{−ax})/a.

    Attributes
    ----------
    modes : mode numbers
    slopes : (m,) s at ``log_k``
    bend : a
    log_k : mean of ln k of the stiffness parameters
    """

    modes: tuple[int, ...]
    slopes: FloatArray
    bend: float
    log_k: float


def sensitivity(
    problem: Problem, z: FloatArray, stiff: Sequence[int], modes: tuple[int, ...]
) -> Sensitivity | None:
    """Return the sensitivity of some modes' frequencies to the stiffness at a point z = ln θ.

    None if no mode can be followed there.

    Parameters
    ----------
    stiff : indices of the stiffness parameters
    """
    points = np.array([z, z, z])
    points[np.ix_([0, 2], list(stiff))] += np.array([[-_APART], [_APART]])
    theta = problem.vectors(points, problem.states[0])
    poles = problem.model.predict_many(theta, modes, slopes=False).poles
    down, up = np.log(np.abs(poles[[0, 2]]) / np.abs(poles[1]))
    rise = up - down
    seen = np.isfinite(rise) & (rise > 0.0)
    if not seen.any():
        return None
    best = float(np.max(rise[seen]))
    kept = [i for i in np.argsort(-np.nan_to_num(rise)) if seen[i] and rise[i] > _LEAST_SLOPE * best]
    kept = sorted(kept[:_MOST_MODES])
    ratio = float(np.sum(rise[kept] * (up + down)[kept]) / np.sum(rise[kept] ** 2))
    bend = float(np.clip(-np.arctanh(np.clip(ratio, -0.9, 0.9)) / (0.5 * _APART), 1e-3, 5.0))
    slopes = rise[kept] * bend / (2.0 * np.sinh(_APART * bend))
    return Sensitivity(tuple(modes[i] for i in kept), slopes, bend, float(np.mean(z[list(stiff)])))


@dataclass(frozen=True)
class Reference:
    """Posterior of all records up to a day: draws of ln k of every stiffness, (n, n_stiff)."""

    log_k: FloatArray

    @classmethod
    def of(cls, log_theta: FloatArray, stiff: Sequence[int]) -> Reference:
        """Return a reference of some of a posterior's draws."""
        chosen = np.linspace(0, len(log_theta) - 1, min(_MOST_DRAWS, len(log_theta))).round().astype(np.intp)
        return cls(log_theta[np.ix_(chosen, np.array(stiff, dtype=np.intp))])


class StiffnessLevel(NamedTuple):
    """Stiffness at a time: its ratio to the first day's, and each parameter; quantiles of 5, 50 and 95 %."""

    relative: Span3
    absolute: tuple[Span3, ...]


def level_of(mixture: Mixture, reference: Reference, about: Sensitivity) -> StiffnessLevel:
    """Return the stiffness at a level; see :func:`levels_of`."""
    return levels_of((mixture,), reference, about)[0]


def levels_of(
    mixtures: Sequence[Mixture], reference: Reference, about: Sensitivity
) -> tuple[StiffnessLevel, ...]:
    """Return the stiffness at levels, which are mixtures with the same weights.

    The reference's draws hold for the ground at the mean level r of its records. On the first day ln k was
    less by x_r and the slope greater by the factor e^{a x_r}, with e^{-ad} h(x_r) e^{a x_r} = r, where d is
    the difference of ln k between a draw and the point of the slopes.
    """
    if not mixtures:
        return ()
    weights, draws = mixtures[0].weights, reference.log_k
    kept = weights > _LEAST_WEIGHT
    w = weights[kept] / weights[kept].sum()
    level, level_std, shift, shift_std = (
        np.array([getattr(mixture, name)[kept] for mixture in mixtures])
        for name in ("level", "level_std", "shift", "shift_std")
    )
    there = np.exp(-about.bend * (draws.mean(axis=1) - about.log_k))
    mean = (level - shift) @ w
    first = there * np.maximum(1.0 + about.bend * mean[:, None] / there, np.exp(-_FARTHEST))
    still = np.zeros(len(draws))
    relative = _quantiles(w, level, level_std, first, still, about.bend)
    every = np.broadcast_to(there, first.shape)
    absolute = [_quantiles(w, shift, shift_std, every, own, about.bend) for own in draws.T]
    return tuple(
        StiffnessLevel(_three(relative[i]), tuple(_three(one[i]) for one in absolute))
        for i in range(len(mixtures))
    )


def _three(x: FloatArray) -> Span3:
    return float(x[0]), float(x[1]), float(x[2])


def _quantiles(
    weights: FloatArray,
    mean: FloatArray,
    std: FloatArray,
    flatter: FloatArray,
    origin: FloatArray,
    bend: float,
) -> FloatArray:
    """Return quantiles (t, 3) of exp(origin + h⁻¹(level/flatter)) over draws and mixtures of levels.

    Parameters
    ----------
    weights, mean, std : (c,), (t, c), (t, c)
    flatter, origin : (t, n), (n,)
    """
    wanted, heaviest = np.array(QUANTILES), np.argsort(-weights)[:_HEAVY]
    out = np.empty((len(mean), 3))
    for t, (m, s, flat) in enumerate(zip(mean, std, flatter, strict=True)):
        at = [m[heaviest, None] + s[heaviest, None] * _FINE, m[:, None] + s[:, None] * _COARSE]
        levels = np.unique(np.concatenate([one.ravel() for one in at]))
        below = ndtr((levels[:, None] - m) / s) @ weights
        inside = np.minimum(bend * levels[[0, -1], None] / flat, -np.expm1(-bend * _FARTHEST))
        ends = origin + np.clip(-np.log1p(-inside) / bend, -_FARTHEST, _FARTHEST)
        low, high = np.full((3, 1), ends[0].min()), np.full((3, 1), ends[1].max())
        for steps in _STEPS:
            y = low + (high - low) * np.linspace(0.0, 1.0, steps + 1)
            x = np.clip(y[..., None] - origin, -_FARTHEST, _FARTHEST)
            share = np.interp(-np.expm1(-bend * x) / bend * flat, levels, below).mean(axis=-1)
            at = np.clip((share < wanted[:, None]).sum(axis=1), 1, steps)[:, None]
            low, high = (np.take_along_axis(y, at - side, axis=1) for side in (1, 0))
        out[t] = np.exp([np.interp(p, own, one) for p, own, one in zip(wanted, share, y, strict=True)])
    return out


def change_of(jump: Jump, reference: Reference, about: Sensitivity) -> Span3:
    """Return the factor by which a jump changes the stiffness."""
    low, middle, high = jump.size
    flatter = np.exp(-about.bend * (float(np.median(reference.log_k.mean(axis=1))) - about.log_k))
    inside = np.minimum(np.array([low, middle, high]) / flatter * about.bend, 1.0 - np.exp(-_FARTHEST))
    a, b, c = np.exp(-np.log1p(-inside) / about.bend).tolist()
    return a, b, c


@dataclass(frozen=True)
class Normalisation:
    """Normalisation of the rows, taken from the first days and used for all later ones."""

    columns: Columns
    design: Design
    about: Sensitivity
    typical: FloatArray
    spread: FloatArray
    usual_std: FloatArray


def normalisation_of(
    model: TwinModel, every: Days, dates: Sequence[str], about: Sensitivity
) -> Normalisation | None:
    """Return the normalisation from some days; None if they have no mode that is sensitive to stiffness."""
    columns = Columns.of(model, every, dates)
    seen = [i for i, number in enumerate(about.modes) if number in columns.numbers]
    if not seen:
        return None
    about = replace(about, modes=tuple(about.modes[i] for i in seen), slopes=about.slopes[seen])
    history = history_of(columns, every, dates)
    frequency, std = _of_modes(columns, about, history)
    middle = typical(frequency)
    with np.errstate(invalid="ignore"):
        y, relative = np.log(frequency / middle), std / frequency
        usual = np.nanmedian(np.where(relative > 0.0, relative, np.nan), axis=0)
        own = np.nanvar(y, axis=0) - usual**2
    usual = np.nan_to_num(usual, nan=_LEAST_SPREAD)
    spread = np.sqrt(np.maximum(np.nan_to_num(own), 0.0) + _LEAST_SPREAD**2)
    return Normalisation(columns, with_time_of_year(design_of(history)), about, middle, spread, usual)


def _of_modes(columns: Columns, about: Sensitivity, history: History) -> tuple[FloatArray, FloatArray]:
    chosen = [columns.numbers.index(number) for number in about.modes]
    return history.frequency[:, chosen], history.frequency_std[:, chosen]


def readings_of(
    known: Normalisation, every: Days, dates: Sequence[str], lagged: Lagged, copied: Container[str]
) -> tuple[Readings, Lagged]:
    """Return the rows of some days, and the state of lagged regressors after them."""
    history = history_of(known.columns, every, dates)
    rows, lagged = regressors(known.design, history, lagged)
    frequency, std = _of_modes(known.columns, known.about, history)
    with np.errstate(invalid="ignore"):
        values, relative = np.log(frequency / known.typical), std / frequency
    noise = np.where(relative > 0.0, relative, known.usual_std)
    noise = np.clip(noise, 0.3 * known.usual_std, 10.0 * known.usual_std) ** 2
    values[~np.isfinite(rows).all(axis=1)] = np.nan
    of = np.floor(history.days).astype(np.intp)
    last = np.append(of[1:] != of[:-1], True)[: of.size]
    flags = np.array([end and str(_EPOCH + int(day)) in copied for end, day in zip(last, of, strict=True)])
    return Readings(history.days, np.nan_to_num(rows), values, noise, flags), lagged
