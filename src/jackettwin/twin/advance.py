"""Second function of the pair: the next state from a state and an observation, at low cost.

The order of observations does not matter: each is added to the sums of the UTC day on which it began. A late
observation changes its own day; estimates for later days are then outdated, and a finding states from which
day on. An observation with samples that the state contains already, or of another structure, changes nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from datetime import UTC, datetime
from math import floor, isfinite, log

import numpy as np

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification import RealPole
from jackettwin.twin.exact_sums import of_estimate, plus, whole
from jackettwin.twin.life.damage_sums import sensed_time, weld_sums
from jackettwin.twin.observation import Observation
from jackettwin.twin.pair_angles import pair_angles
from jackettwin.twin.state import (
    UNDATED,
    AngleSums,
    ClearShape,
    ConditionSums,
    Day,
    NumberSum,
    Operation,
    RateSums,
    TwinState,
    clearer,
    join,
)

WIND_BIN_M_S = 2.0
"""Width of a wind speed bin, around whole multiples (IEC 61400-1)."""
BESIDE = re.compile("level|temp", re.IGNORECASE)
"""Names of conditions, besides wind and waves, that a state stores because they affect frequencies."""
RATE_BIN = 0.1
"""Width of a bin of logarithmic rates, about the spread of one relaxation's poles over the model orders."""


def advance(state: TwinState, observation: Observation) -> tuple[TwinState, tuple[Finding, ...]]:
    """Return the state with one more observation, and findings on that observation.

    Raises
    ------
    InputError
        If the observation was made with another model than the state's.
    """
    if observation.model_hash != state.model_hash:
        raise InputError(
            "the observation is of another structure or other sensors than the state",
            field="model_hash",
            value=observation.model_hash,
            allowed=state.model_hash,
            remedy="observe the record with the model of the state, or rebuild the state with the new model",
        )
    if observation.mismatched:
        modes = len(observation.identification.modes)
        return state, (Finding("record_mismatched", observation.name, {"modes": modes}),)
    date = day_of(observation)
    old = state.days.get(date, Day())
    if observation.record_id in old.records:
        return state, (Finding("record_doubled", observation.name),)
    findings = [*_overlapping(observation, old), *_late(state, observation, date)]
    return state.with_day(date, _added(old, observation, state)), tuple(findings)


def advance_all(
    state: TwinState, observations: Iterable[Observation]
) -> tuple[TwinState, tuple[Finding, ...]]:
    """Return the state with some more observations, and findings on them."""
    findings: list[Finding] = []
    for observation in observations:
        state, found = advance(state, observation)
        findings += found
    return state, tuple(findings)


def day_of(observation: Observation) -> str:
    """Return the UTC date that a record began on, ISO; empty if it has no start."""
    start = observation.start_utc
    return UNDATED if start is None else start.astimezone(UTC).date().isoformat()


def operation_of(observation: Observation, *, by_wind: bool) -> str:
    """Return the state of operation of a record, from its conditions, with its wind speed bin.

    Wind speed bins are 2 m/s wide, which gives about a dozen states of operation.
    """
    state = observation.conditions.get("state")
    wind = observation.wind_m_s if by_wind else None
    words = [] if state is None else [str(state)]
    if wind is not None:
        words.append(f"{WIND_BIN_M_S * floor(wind / WIND_BIN_M_S + 0.5):g} m/s")
    return ", ".join(words) or "unknown"


def _added(day: Day, seen: Observation, state: TwinState) -> Day:
    start = seen.start_utc
    at = 0 if start is None else round(_since_midnight(start))
    records = {**day.records, seen.record_id: (at, round(seen.duration_s))}
    name = operation_of(seen, by_wind=state.by_wind)
    operations = {**day.operations, name: join(day.operations.get(name, Operation()), _operation(seen))}
    times = [t for t in (day.first, day.last, start) if t is not None]
    return Day(
        records=dict(sorted(records.items())),
        first=min(times).astimezone(UTC) if times else None,
        last=max(times).astimezone(UTC) if times else None,
        operations=dict(sorted(operations.items())),
        clearest=clearer(day.clearest, _shapes(seen, state.with_shapes)),
    )


def _operation(seen: Observation) -> Operation:
    """Return the sums of one record."""
    wind, duration = seen.wind_m_s, seen.duration_s
    height, period = (seen.conditions.get(key) for key in ("wave_height_m", "wave_period_s"))
    waved = height is not None and period is not None
    conditions = ConditionSums(
        records=1,
        duration=whole(duration),
        windy=0 if wind is None else whole(duration),
        wind=0 if wind is None else whole(duration * wind),
        waved=int(waved),
        wave_height=whole(float(height)) if height is not None and waved else 0,
        wave_period=whole(float(period)) if period is not None and waved else 0,
    )
    modes = {
        number: of_estimate(mode, duration)
        for number, (mode, _) in sorted(seen.modes.items())
        if mode.status.is_a_mode
    }
    rates: dict[str, RateSums] = {}
    for pole in seen.identification.real_poles:
        w, x, bin_ = (pole.rate_rad_s / pole.rate_std_rad_s) ** 2, log(pole.rate_rad_s), _bin(pole, seen)
        own = RateSums(int(bin_ not in rates), whole(w), whole(w * x), whole(w * x * x))
        rates[bin_] = plus(rates.get(bin_, RateSums()), own)
    directions = pair_angles(seen)
    angles = {
        number: AngleSums.of(*directions[known.label])
        for number, (_, known) in sorted(seen.modes.items())
        if known.label in directions
    }
    welds = weld_sums(seen.damage)
    return Operation(
        conditions, modes, rates, _beside(seen), angles, sensed_time(seen.damage, duration), welds
    )


def _beside(seen: Observation) -> dict[str, NumberSum]:
    """Return the levels and temperatures that a record states."""
    return {
        name: NumberSum(1, whole(float(value)))
        for name, value in sorted(seen.conditions.items())
        if BESIDE.search(name) and isinstance(value, (int, float)) and isfinite(value)
    }


def _shapes(seen: Observation, of_modes: bool) -> dict[str, ClearShape]:
    """Return the shapes of a record's real poles, and with ``of_modes`` those of its modes."""
    by_channel = {sensor.channel: sensor for sensor in seen.sensors}
    sensors = tuple(by_channel[c.name] for c in seen.identification.channels if c.name in by_channel)
    if len(sensors) < len(seen.identification.channels):
        return {}
    shapes = {
        str(number): ClearShape(
            known.mac, seen.record_id, mode.frequency_hz, sensors, mode.lagging.mode_shape
        )
        for number, (mode, known) in seen.modes.items()
        if of_modes and mode.status.is_a_mode
    }
    for pole in seen.identification.real_poles:
        clarity = -pole.rate_std_rad_s / pole.rate_rad_s
        shape = ClearShape(clarity, seen.record_id, pole.rate_rad_s, sensors, pole.mode_shape)
        shapes = clearer(shapes, {f"a{_bin(pole, seen)}": shape})
    return shapes


def _bin(pole: RealPole, seen: Observation) -> str:
    """Return the key that distinguishes relaxations: a bin of the rate, and the channel that moves most."""
    channel = seen.identification.channels[int(np.argmax(np.abs(pole.mode_shape)))].name
    return f"{floor(log(pole.rate_rad_s) / RATE_BIN)}:{channel}"


def _since_midnight(time: datetime) -> float:
    utc = time.astimezone(UTC)
    return (utc - utc.replace(hour=0, minute=0, second=0, microsecond=0)).total_seconds()


def _overlapping(seen: Observation, day: Day) -> list[Finding]:
    """Report that the state contains other samples of the same period, which would then be counted twice."""
    if seen.start_utc is None:
        return []
    start = _since_midnight(seen.start_utc)
    # consecutive records do not overlap, although rounding of the rate may suggest it
    margin = 0.01 * seen.duration_s
    if any(
        at < start + seen.duration_s - margin and start < at + t - margin for at, t in day.records.values()
    ):
        return [Finding("record_overlaps", seen.name)]
    return []


def _late(state: TwinState, seen: Observation, date: str) -> list[Finding]:
    if not date or not state.days or date >= state.last_date:
        return []
    later = sum(1 for other in state.days if other > date)
    return [Finding("record_late", seen.name, {"days": later, "from": date})]
