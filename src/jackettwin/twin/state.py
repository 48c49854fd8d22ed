"""State of a twin: exact sums over its records by UTC day and state of operation.

A state consists of whole numbers, identities, earliest and latest times, and best shapes. Addition, union of
sets, minimum and maximum do not depend on order, so that the same records give the same state, bit for bit,
whatever their order and the division of the work.
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
from jackettwin.twin.life.damage_sums import SensedTime, WeldSums
from jackettwin.twin.model import TwinModel

ALL = "all"
"""The state of operation that holds every record."""
UNDATED = ""
"""The day of records without a start."""


class ConditionSums(NamedTuple):
    """Sums over records of their conditions, as whole numbers (:data:`~.sums.UNIT` per unit).

    Attributes
    ----------
    records : int
    duration : int
        Σ T [s].
    windy, wind : int
        Σ T and Σ T·v of those that state their wind speed [s, m].
    waved, wave_height, wave_period : int
        Number of those that state their sea, and sums of height [m] and period [s].
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
        """Mean wind speed [m/s], if every record states it."""
        return self.wind / self.windy if self.windy and self.windy == self.duration else None

    @property
    def waves(self) -> tuple[float, float] | None:
        """Mean wave height [m] and period [s], if every record states them."""
        if not self.waved or self.waved < self.records:
            return None
        return self.wave_height / UNIT / self.waved, self.wave_period / UNIT / self.waved


class NumberSum(NamedTuple):
    """Number of records that state a condition, and its sum as a whole number."""

    n: int = 0
    total: int = 0


class RateSums(NamedTuple):
    """Sums over real poles of similar rates: n, Σw, Σw ln a and Σw (ln a)² with w = 1/var(ln a)."""

    n: int = 0
    w: int = 0
    wx: int = 0
    wxx: int = 0


class AngleSums(NamedTuple):
    """Sums over records of the direction α in which a pair's lower mode moves: Σw cos 2α and Σw sin 2α.

    The weights are w = 1/var(α). The angle is doubled because opposite directions are equivalent.
    """

    w: int = 0
    cosine: int = 0
    sine: int = 0

    @classmethod
    def of(cls, angle: float, std: float) -> AngleSums:
        """Return the sums of one record's direction [rad]."""
        w = std**-2
        return cls(whole(w), whole(w * cos(2.0 * angle)), whole(w * sin(2.0 * angle)))

    @property
    def mean(self) -> tuple[float, float]:
        """Direction and standard deviation [rad]."""
        return 0.5 * atan2(self.sine, self.cosine), sqrt(UNIT / self.w)


@dataclass(frozen=True)
class ClearShape:
    """The most certain shape of a mode or real pole.

    Attributes
    ----------
    clarity : float
        Criterion of the best shape: MAC with the model, or the negative standard deviation of ln rate.
    record_id : str
        Of the record with the shape.
    frequency_hz : float
        Of the mode in that record; the rate [rad/s] of a real pole.
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
    """Sums over the records of one day in one state of operation.

    Attributes
    ----------
    beside : {condition: NumberSum}
        Levels and temperatures, as whole numbers, which affect frequencies besides wind and waves.
    angles : {mode: AngleSums}
        Of the lower modes of bending pairs.
    sensed : SensedTime
        Of the records that tell of damage.
    welds : {side of a weld: WeldSums}
        Damage of the worst of each record.
    """

    conditions: ConditionSums = ConditionSums()
    modes: Mapping[int, ModeSums] = field(default_factory=dict)
    rates: Mapping[str, RateSums] = field(default_factory=dict)
    beside: Mapping[str, NumberSum] = field(default_factory=dict)
    angles: Mapping[int, AngleSums] = field(default_factory=dict)
    sensed: SensedTime = SensedTime()
    welds: Mapping[int, WeldSums] = field(default_factory=dict)


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
        Empty unless the model fits shapes.
    """

    records: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    first: datetime | None = None
    last: datetime | None = None
    operations: Mapping[str, Operation] = field(default_factory=dict)
    clearest: Mapping[str, ClearShape] = field(default_factory=dict)

    @property
    def time_utc(self) -> datetime | None:
        """The middle of its records' period."""
        return (
            None if self.first is None or self.last is None else self.first + 0.5 * (self.last - self.first)
        )

    def of_operations(self, chosen: Callable[[str], bool]) -> Day:
        """Return the day with the records of some states of operation only."""
        return replace(self, operations={name: o for name, o in self.operations.items() if chosen(name)})


@dataclass(frozen=True)
class OperationTotal:
    """Sums over all records in one state of operation."""

    conditions: ConditionSums = ConditionSums()
    modes: Mapping[int, ModeTotal] = field(default_factory=dict)
    rates: Mapping[str, RateSums] = field(default_factory=dict)
    sensed: SensedTime = SensedTime()
    welds: Mapping[int, WeldSums] = field(default_factory=dict)

    def plus(self, other: OperationTotal) -> OperationTotal:
        """Return the total of both, without sums that became zero."""
        modes = _joined(self.modes, other.modes, ModeTotal())
        return OperationTotal(
            plus(self.conditions, other.conditions),
            {m: total for m, total in modes.items() if total.sums.n},
            {b: sums for b, sums in _joined(self.rates, other.rates, RateSums()).items() if sums.n},
            plus(self.sensed, other.sensed),
            {w: sums for w, sums in _joined(self.welds, other.welds, WeldSums()).items() if sums.n},
        )

    def negated(self) -> OperationTotal:
        """Return the negative of the total."""
        return OperationTotal(
            negated(self.conditions),
            {m: negated(total) for m, total in self.modes.items()},
            {b: negated(sums) for b, sums in self.rates.items()},
            negated(self.sensed),
            {w: negated(sums) for w, sums in self.welds.items()},
        )


Totals = Mapping[str, OperationTotal]
"""By state of operation; :data:`ALL` holds every record."""


@dataclass(frozen=True)
class TwinState:
    """State of a twin.

    Attributes
    ----------
    model_hash : str
        Of the model that its observations were made with.
    by_wind, with_shapes : bool
        Whether the model separates wind speeds and stores the best shapes.
    days : {date: Day}
        ISO dates, sorted; a service may store each day in its own row.
    totals : {state of operation: OperationTotal}
        Of all days; parameters are estimated from these at a cost that does not depend on the number of days.
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
        """The last day; empty without days."""
        return next(reversed(dict(self.days)), "")

    def until(self, date: str) -> TwinState:
        """Return the state of the records up to the end of a day."""
        days = {own: day for own, day in self.days.items() if own <= date}
        totals: dict[str, OperationTotal] = {}
        clearest: dict[str, ClearShape] = {}
        for day in days.values():
            totals = add_totals(totals, day_totals(day))
            clearest = clearer(clearest, day.clearest)
        return replace(self, days=days, totals=totals, clearest=clearest)

    def with_day(self, date: str, day: Day) -> TwinState:
        """Return the state with one day replaced; the new day must contain the shapes of the old one."""
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
        """Return the state of the records in some states of operation only."""
        days = {date: day.of_operations(chosen) for date, day in self.days.items()}
        kept = {date: day for date, day in days.items() if day.operations}
        return replace(self, days=kept).until(max(kept, default=UNDATED))

    def without_day(self, date: str) -> TwinState:
        """Return the state without the records of one day.

        To replace a record by a new observation, remove its day and advance with all observations of that
        day.
        """
        others = replace(self, days={own: day for own, day in self.days.items() if own != date})
        return others.until(max(others.days, default=UNDATED))


def empty_state(model: TwinModel) -> TwinState:
    """Return the state of a twin without records."""
    return TwinState(model.model_hash, model.by_wind, model.with_shapes)


def day_totals(day: Day) -> dict[str, OperationTotal]:
    """Return the contribution of one day to the totals."""
    whole = Operation()
    for operation in day.operations.values():
        whole = join(whole, operation)
    named = {**day.operations, ALL: whole} if day.operations else {}
    return {
        name: OperationTotal(
            o.conditions, {m: of_day(sums) for m, sums in o.modes.items()}, o.rates, o.sensed, o.welds
        )
        for name, o in named.items()
    }


def join(a: Operation, b: Operation) -> Operation:
    """Return the sums over two sets of records of one day."""
    return Operation(
        plus(a.conditions, b.conditions),
        _joined(a.modes, b.modes, ModeSums()),
        _joined(a.rates, b.rates, RateSums()),
        _joined(a.beside, b.beside, NumberSum()),
        _joined(a.angles, b.angles, AngleSums()),
        plus(a.sensed, b.sensed),
        _joined(a.welds, b.welds, WeldSums()),
    )


def add_totals(a: Totals, b: Totals) -> dict[str, OperationTotal]:
    """Return the sum of two totals, without states of operation that have no record."""
    both = {**a, **{name: a[name].plus(total) if name in a else total for name, total in b.items()}}
    kept = {name: total for name, total in both.items() if total.conditions.records}
    return kept if len(kept) == len(a) else dict(sorted(kept.items()))


def clearer(a: Mapping[str, ClearShape], b: Mapping[str, ClearShape]) -> dict[str, ClearShape]:
    """Return the more certain of two shapes of each mode; of equal ones by the record's identity."""
    return {
        name: max(
            (shapes[name] for shapes in (a, b) if name in shapes), key=lambda s: (s.clarity, s.record_id)
        )
        for name in sorted({*a, *b})
    }


def _joined(a: Mapping[Any, Sums], b: Mapping[Any, Sums], none: Sums) -> dict[Any, Sums]:
    return {key: plus(a.get(key, none), b.get(key, none)) for key in sorted({*a, *b})}


STATE = StoredSchema("twin_state", TwinState)
"""Format of stored states."""
