"""Regressors of each operating state: conditions, some of them delayed by the thermal lag of the steel."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.constants import YEAR_DAYS
from jackettwin.watching.history import History

LAGS_DAYS = (0.25, 1.5)
"""Time constants with which the temperatures of steel and ground follow the air [days]. The weights of the
three regressors (no lag and these two) represent lags from none to some days."""
GROUND_DAYS = 40.0
"""Time constant with which the ground some metres down, which is seldom measured, follows the air [days]."""
HEALING_DAYS = 20.0
"""Time constant with which ground that a storm has softened recovers [days]."""
_SEVERAL = 6.0
"""Number of time constants that a baseline must cover to tell a slow regressor from an intercept."""
_ROUGH = 1.0
"""Standard deviations above the mean from which a sea softens the ground, by the square of the excess."""
_WAVES = re.compile(r"(^|_)(hs|hm0|hsig)(_|$)|wave_?height|significant", re.IGNORECASE)
_WIND = re.compile(r"^(?!.*(dir|yaw|turb|std|deg)).*wind", re.IGNORECASE)
_TEMPERATURE = re.compile(r"temp|^t_?air|^t_?steel|°c|_c$|deg_?c", re.IGNORECASE)
_FEWEST_COLD = 0.02
"""Share of the baseline below freezing from which temperatures below zero have a separate slope, for frozen
soil or asphalt."""
_FEWEST_OF_STATE = 50
"""Fewest rows of an operating state for its own slopes, and for an intercept."""
WHOLE_YEAR_DAYS = 330.0
"""Length of a baseline from which the time of year replaces a missing temperature [days]."""
_CURVED, _LINEAR, _LEVEL, _SLOW = 0.5, 1.0, 20.0, 0.3
"""Prior standard deviations of coefficients, in standard deviations of the quantity over the baseline.
A linear term may explain all of it, a quadratic one half, a slow one a third; the intercept is unknown."""


@dataclass(frozen=True)
class Slope:
    """Prior effect of a condition: d ln f per unit of it, and its standard deviation, (m,) each."""

    condition: str
    per_unit: FloatArray
    std: FloatArray


class RegressionPrior(NamedTuple):
    """Prior of coefficients, (m, p): means and standard deviations."""

    mean: FloatArray
    std: FloatArray

    def of(self, chosen: list[int]) -> RegressionPrior:
        """Return the prior of some of the quantities."""
        return RegressionPrior(self.mean[chosen], self.std[chosen])


@dataclass(frozen=True)
class Column:
    """One regressor: a condition, possibly lagged or nonlinear, in standard units.

    Attributes
    ----------
    name : name of the condition
    source : its column in the history
    lag_days : time constant of the lag; 0 for none
    shape : "line", "square" (of the standardised condition, minus one), "frost" (the part below zero),
        "storm" (the square of what exceeds usual seas), "sine" and "cosine" (of the time of day or of the
        year), "trend" (the time), or "settling" (what is left of an unknown start, exp(−t/scale))
    centre, scale : mean and standard deviation over the baseline; ``scale`` is the period [days] of a sine or
        cosine, a year of a trend, and the time constant of a settling, which starts at ``centre``
    prior : prior standard deviation of the coefficient, in standard deviations of the quantity
    """

    name: str
    source: int
    lag_days: float
    shape: str
    centre: float
    scale: float
    prior: float


@dataclass(frozen=True)
class Design:
    """The regressors of every operating state.

    Attributes
    ----------
    columns : regressors of one state
    states : numbers of the known states, each of which has an intercept
    sloped : number of states, counted from the first, with separate slopes; the others use those of the first
    """

    columns: tuple[Column, ...]
    states: tuple[int, ...]
    sloped: int

    @property
    def hidden(self) -> bool:
        """Whether no conditions are given, so that their effects belong to the unexplained variation."""
        return all(column.source < 0 for column in self.columns)

    @property
    def width(self) -> int:
        """Number of regressors p."""
        return len(self.states) + self.sloped * len(self.columns)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of the condition of each regressor; intercepts are ``level``."""
        return ("level",) * len(self.states) + tuple(c.name for _ in range(self.sloped) for c in self.columns)

    @property
    def priors(self) -> FloatArray:
        """Prior standard deviations of the coefficients, in standard deviations of the quantity, (p,)."""
        slopes = [c.prior for _ in range(self.sloped) for c in self.columns]
        return np.array([_LEVEL] * len(self.states) + slopes)

    def coefficients(self, spread: FloatArray, slopes: Sequence[Slope] = ()) -> RegressionPrior:
        """Return the prior of the coefficients of quantities of given standard deviations, (m,) each.

        The slope from a model is the prior mean of the linear term of its condition.
        """
        std = np.outer(spread, self.priors)
        mean = np.zeros_like(std)
        for k, column in enumerate(self.columns * self.sloped, start=len(self.states)):
            for slope in slopes:
                if (column.name, column.shape, column.lag_days) == (slope.condition, "line", 0.0):
                    mean[:, k] = column.scale * slope.per_unit
                    std[:, k] = column.scale * slope.std
        return RegressionPrior(mean, std)


@dataclass(frozen=True)
class Lagged:
    """State of lagged regressors: ``values`` by column of a design, at ``day``."""

    day: float
    values: FloatArray


def design_of(baseline: History) -> Design:
    """Return the regressors that a baseline supports; constant conditions are left out."""
    columns: list[Column] = []
    warm = False
    for k, name in enumerate(baseline.condition_names):
        x = baseline.conditions[:, k]
        x = x[np.isfinite(x)]
        if x.size < _FEWEST_OF_STATE // 2 or np.std(x) <= 1e-9 * max(1.0, float(np.max(np.abs(x)))):
            continue
        centre, scale = float(np.mean(x)), float(np.std(x))
        columns.append(Column(name, k, 0.0, "line", centre, scale, _LINEAR))
        if _TEMPERATURE.search(name):
            warm = True
            columns += [Column(name, k, lag, "line", centre, scale, _LINEAR) for lag in LAGS_DAYS]
            if np.mean(x < 0.0) > _FEWEST_COLD:
                lags = (0.0, *LAGS_DAYS)
                columns += [Column(name, k, lag, "frost", 0.0, scale, _LINEAR) for lag in lags]
        else:
            columns.append(Column(name, k, 0.0, "square", centre, scale, _CURVED))
    if not warm:
        columns += [
            Column(name, -1, 0.0, shape, 0.0, period, _CURVED)
            for name, period, seen in (
                ("time of day", 1.0, _whole_days(baseline)),
                ("time of year", YEAR_DAYS, np.ptp(baseline.days) > WHOLE_YEAR_DAYS),
            )
            if seen
            for shape in ("sine", "cosine")
        ]
    numbers, counts = np.unique(baseline.states, return_counts=True)
    by_size = [int(s) for s in numbers[np.argsort(-counts)] if counts[numbers == s] >= _FEWEST_OF_STATE]
    known = tuple(by_size) or (int(numbers[np.argmax(counts)]),)
    return Design(tuple(columns), known, min(2, len(known)))


def with_slow_processes(design: Design, baseline: History) -> Design:
    """Return the design with regressors of harmless processes that take weeks or years.

    These are ground that storms soften and that recovers, ground that follows the air, and marine growth.
    They are added if the baseline is long enough to separate them from the intercept. After a part of a year
    what the ground was like before it is unknown, and without a temperature so is what the other seasons do.
    They are not for following a stiffness through time, of whose changes they would explain a part.
    """
    span, lines = float(np.ptp(baseline.days)), [c for c in design.columns if c.shape == "line"]
    if span <= _SEVERAL * HEALING_DAYS:
        return design
    there = [c for c in lines if c.lag_days == 0.0]
    rough = [c for pattern in (_WAVES, _WIND) for c in there if pattern.search(c.name)][:1]
    slow = [replace(c, shape="storm", lag_days=HEALING_DAYS, prior=_CURVED) for c in rough]
    slow += [replace(c, lag_days=GROUND_DAYS, prior=_SLOW) for c in lines if c.lag_days == max(LAGS_DAYS)]
    first = float(baseline.days[0])
    if span <= WHOLE_YEAR_DAYS:
        slow += [Column(c.name, -1, 0.0, "settling", first, c.lag_days, c.prior) for c in slow]
        if all(c.lag_days == 0.0 for c in lines):
            slow += _time_of_year(_CURVED)
    slow.append(Column("time", -1, 0.0, "trend", first + 0.5 * span, YEAR_DAYS, _SLOW))
    return replace(design, columns=(*design.columns, *slow))


def with_time_of_year(design: Design) -> Design:
    """Return the design with the time of year as regressor, which replaces a missing temperature."""
    if any(c.lag_days > 0.0 or c.name == "time of year" for c in design.columns):
        return design
    return replace(design, columns=(*design.columns, *_time_of_year(_LINEAR)))


def _time_of_year(prior: float) -> list[Column]:
    return [Column("time of year", -1, 0.0, shape, 0.0, YEAR_DAYS, prior) for shape in ("sine", "cosine")]


def _whole_days(baseline: History) -> bool:
    """Tell whether the rows cover all hours of the day."""
    return bool(np.ptp(np.histogram(baseline.days % 1.0, 8, (0.0, 1.0))[0]) < 0.5 * baseline.days.size)


def fresh(design: Design, baseline: History | None = None) -> Lagged:
    """Return the state of lagged regressors before the first row.

    With a baseline, regressors with lags of weeks start from their values at its end if that is a whole year
    later, and if not from the mean condition and no storm; the others start from the first row.
    """
    slow = np.array([column.lag_days >= HEALING_DAYS for column in design.columns], dtype=np.bool_)
    none = Lagged(-np.inf, np.zeros(len(design.columns)))
    if baseline is None or not slow.any():
        return none
    first = regressors(design, baseline.rows(np.arange(baseline.days.size) == 0), none)[1].values
    whole = np.ptp(baseline.days) > WHOLE_YEAR_DAYS
    last = regressors(design, baseline, none)[1].values if whole else np.zeros_like(first)
    return Lagged(float(baseline.days[0]), np.where(slow, last, first))


def regressors(design: Design, history: History, lagged: Lagged) -> tuple[FloatArray, Lagged]:
    """Return the regressors (n, p) of some rows and the state of lagged ones after them.

    A missing condition is replaced by its mean over the baseline and does not change the state. The
    regressors are NaN in operating states that do not occur in the baseline.
    """
    standard = [_standard(column, history) for column in design.columns]
    values, day = lagged.values.copy(), lagged.day
    slopes = np.zeros((history.days.size, len(design.columns)))
    for j, column in enumerate(design.columns):
        if column.lag_days == 0.0:
            slopes[:, j] = np.nan_to_num(standard[j])
            continue
        at, before = values[j], day
        for i, (now, x) in enumerate(zip(history.days, standard[j], strict=True)):
            if np.isfinite(x):
                at += (1.0 - np.exp(-(now - before) / column.lag_days)) * (x - at)
                before = now
            slopes[i, j] = at
        values[j] = at
    last = float(history.days[-1]) if history.days.size else day
    return _by_state(design, history.states, slopes), Lagged(last, values)


def _standard(column: Column, history: History) -> FloatArray:
    """Return a standardised condition after its nonlinearity, without lag."""
    if column.shape == "trend":
        return np.asarray((history.days - column.centre) / column.scale)
    if column.shape == "settling":
        return np.asarray(np.exp((column.centre - history.days) / column.scale))
    if column.shape in ("sine", "cosine"):
        turn = 2.0 * np.pi * history.days / column.scale
        return np.asarray(np.sin(turn) if column.shape == "sine" else np.cos(turn))
    x = history.conditions[:, column.source]
    if column.shape == "frost":
        return np.asarray(np.minimum(x, 0.0) / column.scale)
    x = (x - column.centre) / column.scale
    if column.shape == "storm":
        return np.asarray(np.maximum(x - _ROUGH, 0.0) ** 2)
    return np.asarray(x * x - 1.0 if column.shape == "square" else x)


def _by_state(design: Design, states: IntArray, slopes: FloatArray) -> FloatArray:
    """Return intercepts and slopes, each in the columns of its state."""
    n, k = slopes.shape
    rows = np.full((n, design.width), np.nan)
    for place, state in enumerate(design.states):
        chosen = states == state
        rows[chosen] = 0.0
        rows[chosen, place] = 1.0
        first = len(design.states) + k * (place if place < design.sloped else 0)
        rows[chosen, first : first + k] = slopes[chosen]
    return rows
