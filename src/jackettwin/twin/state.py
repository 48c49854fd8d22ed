"""What a twin knows of all its records: exact sums by UTC day and state of operation, small and bounded.

A state is a set of whole numbers, of identities, of earliest and latest times and of clearest shapes. Adding,
joining sets, taking the earliest and taking the best do not depend on order, so the same records give the
same state, bit for bit, in whatever order they arrived and however the work was split.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from math import atan2, cos, sin, sqrt
from typing import Any, NamedTuple

from jackettwin.arrays import ComplexArray
from jackettwin.files import StoredSchema, digest
from jackettwin.response import Sensor
from jackettwin.twin.exact_sums import UNIT, ModeSums, ModeTotal, Sums, negated, of_day, plus, whole
from jackettwin.twin.model import TwinModel

ALL = "all"
"""The state of operation that holds every record."""
UNDATED = ""
"""The day of records without a start."""


class ConditionSums(NamedTuple):
    """Sums over records of what they say of themselves, as whole numbers (:data:`~.sums.UNIT` a unit).

    Attributes
    ----------
    records : int
    duration : int
        Σ T [s].
    windy, wind : int
        Σ T and Σ T·v of those that say their wind [s, m].
    waved, wave_height, wave_period : int
        How many say their sea, and sums of height [m] and period [s].
    """

    records: int = 0
    duration: int = 0
    windy: int = 0
    wind: int = 0
    waved: int = 0
    wave_height: int = 0
    wave_period: int = 0

    @property
    def wind_m_s(self) -> float | None:
        """Mean wind speed, if every record says it."""
        return self.wind / self.windy if self.windy and self.windy == self.duration else None

    @property
    def waves(self) -> tuple[float, float] | None:
        """Mean wave height [m] and period [s], if every record says them."""
        if not self.waved or self.waved < self.records:
            return None
        return self.wave_height / UNIT / self.waved, self.wave_period / UNIT / self.waved


class NumberSum(NamedTuple):
    """How many records say a number, and its sum as a whole number."""

    n: int = 0
    total: int = 0


class RateSums(NamedTuple):
    """Sums over real poles of about one rate: n, Σw, Σw ln a and Σw (ln a)² with w = 1/var(ln a)."""

    n: int = 0
    w: int = 0
    wx: int = 0
    wxx: int = 0


class AngleSums(NamedTuple):
    """Sums over records of the direction α in which a pair's lower mode moves: Σw cos 2α and Σw sin 2α.

    The weights are w = 1/var(α); twice the angle, since a direction is as good as its opposite.
    """

    w: int = 0
    cosine: int = 0
    sine: int = 0

    @classmethod
    def of(cls, angle: float, std: float) -> AngleSums:
        """Return what one record says of a direction [rad]."""
        w = std**-2
        return cls(whole(w), whole(w * cos(2.0 * angle)), whole(w * sin(2.0 * angle)))

    @property
    def mean(self) -> tuple[float, float]:
        """Direction and standard deviation [rad]."""
        return 0.5 * atan2(self.sine, self.cosine), sqrt(UNIT / self.w)


@dataclass(frozen=True)
class ClearShape:
    """The clearest shape of a mode or real pole.

    Attributes
    ----------
    clarity : float
        What it is the best of: MAC with the model, or the negative standard deviation of a logarithmic rate.
    record_id : str
        Of the record that shows it.
    frequency_hz : float
        Of the mode there; the rate [rad/s] of a real pole.
    sensors : tuple of Sensor
    shape : (n_sensors,) complex
    """

    clarity: float
    record_id: str
    frequency_hz: float
    sensors: tuple[Sensor, ...]
    shape: ComplexArray


@dataclass(frozen=True)
class Operation:
    """What the records of one day in one state of operation say.

    Attributes
    ----------
    beside : {condition: NumberSum}
        Levels and temperatures, as whole numbers: what moves frequencies besides wind and waves.
    angles : {mode: AngleSums}
        Of the lower modes of bending pairs.
    """

    conditions: ConditionSums = ConditionSums()
    modes: Mapping[int, ModeSums] = field(default_factory=dict)
    rates: Mapping[str, RateSums] = field(default_factory=dict)
    beside: Mapping[str, NumberSum] = field(default_factory=dict)
    angles: Mapping[int, AngleSums] = field(default_factory=dict)


@dataclass(frozen=True)
class Day:
    """The records of one UTC day.

    Attributes
    ----------
    records : {record_id: (start, duration)}
        Whole seconds after midnight and whole seconds; sorted.
    first, last : datetime or None
        Starts of the first and the last record.
    operations : {state of operation: Operation}
        Sorted; every record is in one of them.
    clearest : {mode or rate: ClearShape}
        If the model fits shapes.
    """

    records: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    first: datetime | None = None
    last: datetime | None = None
    operations: Mapping[str, Operation] = field(default_factory=dict)
    clearest: Mapping[str, ClearShape] = field(default_factory=dict)

    @property
    def time_utc(self) -> datetime | None:
        """The middle of its records."""
        return (
            None if self.first is None or self.last is None else self.first + 0.5 * (self.last - self.first)
        )

    def of_operations(self, chosen: Callable[[str], bool]) -> Day:
        """Return the day with the records of some states of operation alone."""
        return replace(self, operations={name: o for name, o in self.operations.items() if chosen(name)})


@dataclass(frozen=True)
class OperationTotal:
    """What all records in one state of operation say."""

    conditions: ConditionSums = ConditionSums()
    modes: Mapping[int, ModeTotal] = field(default_factory=dict)
    rates: Mapping[str, RateSums] = field(default_factory=dict)

    def plus(self, other: OperationTotal) -> OperationTotal:
        """Return the total of both; what became nothing is left out."""
        modes = _joined(self.modes, other.modes, ModeTotal())
        return OperationTotal(
            plus(self.conditions, other.conditions),
            {m: total for m, total in modes.items() if total.sums.n},
            {b: sums for b, sums in _joined(self.rates, other.rates, RateSums()).items() if sums.n},
        )

    def negated(self) -> OperationTotal:
        """Return what takes the total out again when it is added."""
        return OperationTotal(
            negated(self.conditions),
            {m: negated(total) for m, total in self.modes.items()},
            {b: negated(sums) for b, sums in self.rates.items()},
        )


Totals = Mapping[str, OperationTotal]
"""By state of operation; :data:`ALL` holds every record."""


@dataclass(frozen=True)
class TwinState:
    """What a twin knows.

    Attributes
    ----------
    model_hash : str
        Of the model that its observations were made with.
    by_wind, with_shapes : bool
        Whether winds are kept apart, and the clearest shapes are kept; of the model.
    days : {date: Day}
        ISO dates, sorted; a service may keep each in a row of its own.
    totals : {state of operation: OperationTotal}
        Of all days: what the parameters are estimated from, at the same cost however many days there are.
    clearest : {mode or rate: ClearShape}
        Of all days.
    """

    model_hash: str
    by_wind: bool = False
    with_shapes: bool = False
    days: Mapping[str, Day] = field(default_factory=dict)
    totals: Mapping[str, OperationTotal] = field(default_factory=dict)
    clearest: Mapping[str, ClearShape] = field(default_factory=dict)

    def __repr__(self) -> str:
        until = f" to {self.last_date}" if self.days else ""
        states = ", ".join(self.totals) or "none"
        return f"TwinState({len(self.days)} days{until}; states of operation: {states})"

    @property
    def state_hash(self) -> str:
        """Identity of the state by its content."""
        return digest(self)

    @property
    def last_date(self) -> str:
        """The last day there is; empty without one."""
        return next(reversed(dict(self.days)), "")

    def until(self, date: str) -> TwinState:
        """Return the state as it was after a day: of the records of this day and those before."""
        days = {own: day for own, day in self.days.items() if own <= date}
        totals: dict[str, OperationTotal] = {}
        clearest: dict[str, ClearShape] = {}
        for day in days.values():
            totals = add_totals(totals, day_totals(day))
            clearest = clearer(clearest, day.clearest)
        return replace(self, days=days, totals=totals, clearest=clearest)

    def with_day(self, date: str, day: Day) -> TwinState:
        """Return the state with another content of one day; its shapes must hold those it had."""
        days, old = dict(self.days), day_totals(self.days.get(date, Day()))
        in_order = date in days or date > self.last_date
        days[date] = day
        changed = {name: total for name, total in day_totals(day).items() if total != old.get(name)}
        gone = {name: old[name].negated() for name in changed if name in old}
        return replace(
            self,
            days=days if in_order else dict(sorted(days.items())),
            totals=add_totals(add_totals(self.totals, changed), gone),
            clearest=clearer(self.clearest, day.clearest),
        )

    def of_operations(self, chosen: Callable[[str], bool]) -> TwinState:
        """Return what is known from the records of some states of operation alone."""
        days = {date: day.of_operations(chosen) for date, day in self.days.items()}
        kept = {date: day for date, day in days.items() if day.operations}
        return replace(self, days=kept).until(max(kept, default=UNDATED))

    def without_day(self, date: str) -> TwinState:
        """Return the state without the records of one day.

        This is what a record that was observed anew asks for: take its day out, then advance with all
        observations of the day.
        """
        others = replace(self, days={own: day for own, day in self.days.items() if own != date})
        return others.until(max(others.days, default=UNDATED))


def empty_state(model: TwinModel) -> TwinState:
    """Return the state of a twin that has seen no record."""
    return TwinState(model.model_hash, model.by_wind, model.with_shapes)


def day_totals(day: Day) -> dict[str, OperationTotal]:
    """Return what one day adds to the totals."""
    whole = Operation()
    for operation in day.operations.values():
        whole = join(whole, operation)
    named = {**day.operations, ALL: whole} if day.operations else {}
    return {
        name: OperationTotal(o.conditions, {m: of_day(sums) for m, sums in o.modes.items()}, o.rates)
        for name, o in named.items()
    }


def join(a: Operation, b: Operation) -> Operation:
    """Return what two sets of records of one day say together."""
    return Operation(
        plus(a.conditions, b.conditions),
        _joined(a.modes, b.modes, ModeSums()),
        _joined(a.rates, b.rates, RateSums()),
        _joined(a.beside, b.beside, NumberSum()),
        _joined(a.angles, b.angles, AngleSums()),
    )


def add_totals(a: Totals, b: Totals) -> dict[str, OperationTotal]:
    """Return two totals as one, without states of operation that no record is in."""
    both = {**a, **{name: a[name].plus(total) if name in a else total for name, total in b.items()}}
    kept = {name: total for name, total in both.items() if total.conditions.records}
    return kept if len(kept) == len(a) else dict(sorted(kept.items()))


def clearer(a: Mapping[str, ClearShape], b: Mapping[str, ClearShape]) -> dict[str, ClearShape]:
    """Return the clearer of two shapes of each mode; the record's identity decides between equals."""
    return {
        name: max(
            (shapes[name] for shapes in (a, b) if name in shapes), key=lambda s: (s.clarity, s.record_id)
        )
        for name in sorted({*a, *b})
    }


def _joined(a: Mapping[Any, Sums], b: Mapping[Any, Sums], none: Sums) -> dict[Any, Sums]:
    return {key: plus(a.get(key, none), b.get(key, none)) for key in sorted({*a, *b})}


STATE = StoredSchema("twin_state", TwinState)
"""How states are kept."""
