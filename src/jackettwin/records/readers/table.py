"""Contents of a data file, and their conversion to a ``Record`` with the help of the JSON beside it."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime, timedelta, tzinfo
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import FloatArray
from jackettwin.constants import HOUR_S
from jackettwin.errors import InputError, did_you_mean, require
from jackettwin.quantities import guess_quantity, names_other
from jackettwin.records.clocks import between_ticks, regularise, without_hours
from jackettwin.records.readers.channel_names import Reading, read_name, read_names, told
from jackettwin.records.readers.channels import (
    DescribedChannel,
    FileDefaults,
    described_channel,
    merged,
    without_flows,
    without_sentinels,
)
from jackettwin.records.readers.description import ChannelEntry, Description
from jackettwin.records.readers.stamps import (
    COUNTED_DAYS,
    UNSAID,
    ambiguous_date,
    dates_of_days,
    in_utc,
    read_zone,
    refuse_ambiguous,
    refuse_put_back,
    steady,
    unfolded,
)
from jackettwin.records.record import LARGEST, Record

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


TIME_NAMES = (
    *("time", "t", "timestamp", "time_utc", "datetime", "date_time", "times", "tid", "zeit", "zeitstempel"),
    *("datum_zeit", "datum", "uhrzeit", "elapsed", "elapsed_time", "unix_time"),
)
UNSTATED_RATES_HZ = (0.1, 2e4)
"""Sample rates of records of vibrations whose time column has no unit; others are not in seconds."""
COARSE = "many samples share a time stamp, alike for all stamps: taken as evenly spread, at"
PUT_ON = "taken for summer time or another zone, with no sample missing; if the logger paused, cut it there"
_SECONDS_IN = {
    "ns": 1e-9, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ms": 1e-3, "s": 1.0, "sec": 1.0, "seconds": 1.0,
    "min": 60.0, "h": 3600.0, "d": 86400.0, "day": 86400.0, "days": 86400.0, "tage": 86400.0,
}  # fmt: skip
"""Unit of a time → seconds."""
_TIME_UNIT = re.compile(r"^(?P<name>.+?)[_ ]*\(?(?P<unit>ms|us|µs|ns|s)\)?$", re.IGNORECASE)


@dataclass(frozen=True)
class ReadTable:
    """Named columns and whatever else the file said.

    Attributes
    ----------
    names : tuple of str
    data : (n_channels, n_samples) array
        In the file's own units.
    channels : mapping
        Per name what the file says of the channel; units in ``unit``.
    zone_said : bool
        Whether ``start_utc`` is UTC; else it is what a clock shows whose zone the file does not say.
    clock : str, optional
        The zone of the clock that the file's comments name.
    times_s : (n_samples,) array, optional
        Stamps, if the file has them, from any origin.
    times_unit_said : bool
        Whether the file says the unit of the stamps; numbers without one are taken as seconds.
    description : Description, optional
        A complete description stored inside the file.
    unit : str, optional
        Of the channels without one in ``channels``, as ``FileDefaults.unit``.
    ambiguous : tuple of str and str, optional
        Column and cell of a date that was not read because its day or its month may come first.
    remarks : tuple of str
        What the reader did that the user should know; ``metadata["remarks"]`` of the record.
    """

    names: tuple[str, ...]
    data: FloatArray
    channels: Mapping[str, ChannelEntry] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    start_utc: datetime | None = None
    zone_said: bool = True
    clock: str | None = None
    times_s: FloatArray | None = None
    times_unit_said: bool = True
    metadata: Mapping[str, Any] = field(default_factory=dict)
    description: Description | None = None
    unit: str | None = None
    ambiguous: tuple[str, str] | None = None
    remarks: tuple[str, ...] = ()


def table_from_columns(
    names: Sequence[str],
    columns: Sequence[npt.NDArray[Any]],
    units: Mapping[str, str] | None = None,
    **known: Any,
) -> ReadTable:
    """Return a table of equally long columns.

    The first column is the time if its name says so; if it climbs evenly, a later one that does so too and is
    named a time; else the first if it climbs evenly or has no name and does not just count rows. A column of
    datetimes or of times of day is the time wherever it stands. Columns without numbers, that count rows, or
    that are a clock or a count beside the time are left out and named in a remark.

    Raises
    ------
    InputError
        If there is no column left or a name is given twice.
    """
    channels = {name: ChannelEntry(unit=unit) for name, unit in (units or {}).items() if unit}
    time = _time_column(names, columns, channels)
    remarks: list[str] = []
    if time is not None:
        unit = channels.pop(names[time], ChannelEntry()).unit or time_unit(names[time])
        may_be_days = _SECONDS_IN.get((unit or "d").lower()) == _SECONDS_IN["d"]
        days = dates_of_days(columns[time]) if may_be_days and columns[time].dtype.kind == "f" else None
        if days is not None:
            columns = [*columns[:time], days, *columns[time + 1 :]]
            remarks.append(f"column {names[time]} {COUNTED_DAYS}")
        times_s, start_utc = seconds(columns[time], unit)
        dated = columns[time].dtype.kind == "M" and "start_utc" not in known
        known = {"start_utc": start_utc, "zone_said": not dated, **known, "times_s": times_s}
        known["times_unit_said"] = columns[time].dtype.kind != "f" or (unit or "").lower() in _SECONDS_IN
    counts = names and _counts_rows(columns[0]) and not _is_channel(names[0], channels)
    counted = 0 if time is None and counts else None
    kept = [i for i in range(len(names)) if i not in (time, counted) and names[i]]
    kept = [i for i in kept if columns[i].dtype.kind == "f"]
    clocks = [i for i in kept if time is not None and _is_clock(names[i], columns[i], channels)]
    kept = [i for i in kept if i not in clocks] or kept
    left_out = [name for i, name in enumerate(names) if name and i not in (time, counted, *clocks, *kept)]
    if left_out:
        remarks.append(f"columns without numbers are left out: {', '.join(left_out)}")
    if counted is not None and names[counted]:
        remarks.append(f"column {names[counted]} counts rows and is left out")
    if time is not None and clocks and clocks != kept:
        also = ", ".join(names[i] for i in clocks)
        remarks.append(f"time is column {names[time]}; also climbing evenly, and left out: {also}")
    if time is not None and names[time] and columns[time].dtype.kind == "f" and not is_time(names[time]):
        remarks.append(f"column {names[time]} climbs evenly and is taken for the time in s")
    words = [
        (name, str(x[0])) for name, x in zip(names, columns, strict=True) if x.dtype.kind == "U" and len(x)
    ]
    known["ambiguous"] = next(((name, cell) for name, cell in words if ambiguous_date(cell)), None)
    if known["ambiguous"] is not None:
        name, cell = known["ambiguous"]
        remarks.append(
            f"column {name}: {cell.split()[0]} may begin with its day or its month; dates are not read"
        )
    if remarks:
        known["remarks"] = (*known.get("remarks", ()), *remarks)
    if not kept:
        raise InputError(
            "holds no channels",
            field="channels",
            value=", ".join(names),
            allowed="at least one column of numbers",
            remedy="check separator and decimal sign",
        )
    return ReadTable(tuple(names[i] for i in kept), np.vstack([columns[i] for i in kept]), channels, **known)


def _time_column(
    names: Sequence[str], columns: Sequence[npt.NDArray[Any]], channels: Mapping[str, ChannelEntry]
) -> int | None:
    dated = [i for i, column in enumerate(columns) if column.dtype.kind in "Mm"]
    if dated:
        return dated[0]
    if not names:
        return None
    # a data frame's index, or a logger's count of samples, before the time
    if not is_time(names[0]) and _is_clock(names[0], columns[0], channels):
        named = (i for i, name in enumerate(names) if is_time(name) and climbs_evenly(columns[i]))
        if (called := next(named, None)) is not None:
            return called
    numeric, called_time = columns[0].dtype.kind == "f", is_time(names[0])
    if called_time and not numeric:
        refuse_ambiguous(str(columns[0][0]) if len(columns[0]) else "", names[0])
        raise InputError(
            "times are not understood",
            field=names[0],
            value=str(columns[0][0]) if len(columns[0]) else None,
            allowed="seconds, or 2025-01-01T13:00:00Z",
            remedy="write times in seconds or as ISO 8601",
        )
    clock = not names[0] or (climbs_evenly(columns[0]) and not _is_channel(names[0], channels))
    return 0 if called_time or (numeric and clock and not _counts_rows(columns[0])) else None


def _is_channel(name: str, channels: Mapping[str, ChannelEntry]) -> bool:
    """Tell whether its unit, quantity, place or direction says that a column is no clock nor count."""
    measured = guess_quantity(name, "") != "other" or names_other(name)
    return name in channels or measured or read_name(name) != Reading()


def _is_clock(name: str, column: npt.NDArray[Any], channels: Mapping[str, ChannelEntry]) -> bool:
    """Tell whether a column is a clock or a count by its values, and not a channel by its name."""
    return climbs_evenly(column) and (is_time(name) or not _is_channel(name, channels))


def climbs_evenly(column: npt.NDArray[Any]) -> bool:
    """Tell whether numbers climb by steps that are alike, as those of a clock or a count do.

    >>> climbs_evenly(np.array([0.0, 0.1, 0.2, 0.31])), climbs_evenly(np.array([0.0, 0.1, 0.1, 0.3]))
    (True, False)
    """
    if column.dtype.kind != "f" or len(column) < 3 or not np.isfinite(column).all():
        return False
    steps = np.diff(column)
    return bool(np.all(np.abs(steps - np.median(steps)) < 0.5 * np.median(steps)))


def _counts_rows(column: npt.NDArray[Any]) -> bool:
    if column.dtype.kind != "f" or not len(column) or column[0] not in (0.0, 1.0):
        return False
    return bool(np.array_equal(column, column[0] + np.arange(len(column))))


def is_time(name: str) -> bool:
    """Tell whether a name is that of a time, with or without its unit.

    >>> [is_time(name) for name in ("Time", "timestamp_ms", "time (s)", "temp")]
    [True, True, True, False]
    """
    match = _TIME_UNIT.match(name.strip())
    return any(text.lower() in TIME_NAMES for text in (name.strip(), match["name"] if match else ""))


def time_unit(name: str) -> str | None:
    """Return the unit in the name of a time, e.g. ``ms`` of ``timestamp_ms``."""
    match = _TIME_UNIT.match(name.strip())
    return match["unit"].lower() if match and name.strip().lower() not in TIME_NAMES else None


def seconds(stamps: npt.NDArray[Any], unit: str | None = None) -> tuple[FloatArray, datetime | None]:
    """Return stamps as seconds, and the UTC time of the first if they are absolute.

    Datetimes are absolute, times of day are not; numbers that read as Unix seconds between 2001 and 2100 are.
    """
    if np.issubdtype(stamps.dtype, np.timedelta64):
        return stamps / np.timedelta64(1, "s"), None
    if np.issubdtype(stamps.dtype, np.datetime64):
        first = stamps[0] if len(stamps) else np.datetime64("NaT")
        if np.isnat(first):
            raise InputError("first time stamp is missing", field="time", remedy="remove the first row")
        relative = (stamps - first) / np.timedelta64(1, "ns")
        start = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(
            microseconds=int(first.astype("datetime64[us]").astype(np.int64))
        )
        return relative * 1e-9, start
    factor = _SECONDS_IN.get((unit or "s").lower(), 1.0)
    times_s = np.asarray(stamps, dtype=np.float64) * factor
    if len(times_s) and 1e9 < times_s[0] < 4.1e9:
        start = datetime.fromtimestamp(float(times_s[0]), tz=UTC)
        return times_s - times_s[0], start
    return times_s, None


def to_record(
    table: ReadTable, beside: Description | None, path: Path, defaults: FileDefaults | None = None
) -> Record:
    """Return the record: columns chosen and described by the JSON, in SI units, on a regular grid.

    Raises
    ------
    InputError
        If the two contradict each other or something needed is in neither.
    """
    _refuse_twins(table.names)
    said, defaults = beside or table.description or Description(), defaults or FileDefaults()
    names = tuple(said.channels) if said.channels else table.names
    data = table.data[[_row_of(name, table) for name in names]]
    stated = stated_rate(table, said)
    data, missing = _without_sentinels(names, data)
    metadata = {**table.metadata, **said.metadata}
    if table.remarks or missing:
        metadata["remarks"] = [*table.remarks, *missing]
    if data.shape[1] < 2:
        raise InputError(
            "holds no samples",
            field="data",
            value=data.shape[1],
            allowed="at least 2 samples",
            remedy="export the record again",
        )
    start_utc, times_s, unzoned = _start(table, said, defaults)
    if times_s is not None:
        times_s, put_on = without_hours(times_s)
        if put_on is not None:
            jump = f"the clock is put on by {put_on[1] / HOUR_S:g} h after {put_on[0]:.4g} s: {PUT_ON}"
            metadata["remarks"] = [*metadata.get("remarks", ()), jump]
        spread = between_ticks(times_s)
        data, clock = regularise(times_s if spread is None else spread, data, sample_rate_hz=stated)
        if stated is None and not table.times_unit_said:
            _refuse_other_units(clock.sample_rate_hz)
        stated = clock.sample_rate_hz
        if spread is not None:
            metadata["remarks"] = [*metadata.get("remarks", ()), f"{COARSE} {stated:g} Hz"]
        metadata["clock"] = asdict(clock)
    stated = stated or defaults.sample_rate_hz
    stated = known_rate(table, stated, path.with_suffix(".json").name)
    metadata["remarks"] = [*metadata.get("remarks", ()), *unzoned]
    described = _described(names, table, said, defaults)
    with np.errstate(over="ignore"):  # what overflows is as unreadable as infinity: missing
        data = data * np.array([one.factor for one in described])[:, None]
    data = np.where(np.abs(data) <= LARGEST, data, np.nan)
    described, flows = without_flows(described, data)
    ruled = [name for name, entry in (said.channels or {}).items() if entry.unit is not None]
    metadata["remarks"] += flows
    metadata["remarks"] += [d.remark for d in described if d.remark and d.channel.name not in ruled]
    metadata["remarks"] += told({one.channel.name: one.from_name for one in described})
    if not metadata["remarks"]:
        del metadata["remarks"]
    return Record(
        data=data,
        sample_rate_hz=stated,
        channels=tuple(one.channel for one in described),
        start_utc=start_utc,
        conditions=dict(said.conditions),
        metadata=metadata,
        name=path.stem,
    )


def _refuse_other_units(rate_hz: float) -> None:
    """Refuse stamps without a unit that are no record of vibrations in seconds."""
    low, high = UNSTATED_RATES_HZ
    require(
        low <= rate_hz <= high,
        "the column of times has no unit, and in seconds it is no record of vibrations",
        field="time",
        value=f"{rate_hz:.3g} samples a second",
        allowed=f"{low:g} to {high:g} samples a second",
        remedy="name its unit in the heading, e.g. time [ms], or remove it and state sample_rate_hz",
    )


def _start(
    table: ReadTable, said: Description, defaults: FileDefaults
) -> tuple[datetime | None, FloatArray | None, tuple[str, ...]]:
    """Return the start in UTC, the times since then, and remarks on the clock's zone and summer time."""
    if said.start_utc is not None or table.start_utc is None or table.zone_said:
        return said.start_utc or table.start_utc, table.times_s, ()
    zone = zone_of(table, said, defaults)
    if zone is None:
        refuse_put_back(table.times_s)
        return table.start_utc, table.times_s, (UNSAID,)
    times_s = unfolded(table.start_utc, table.times_s, zone)
    if times_s is not None:
        return in_utc(table.start_utc.replace(tzinfo=None), zone), times_s, ()
    return steady(table.start_utc, table.times_s, zone)


def zone_of(table: ReadTable, said: Description, defaults: FileDefaults) -> tzinfo | None:
    """Return the zone of a clock whose stamps do not: the description's, the file's, or what is assumed.

    Raises
    ------
    InputError
        If it is none.
    """
    text = said.clock or table.clock or defaults.timezone
    return None if text is None else read_zone(text, field="clock" if said.clock else "--timezone")


def _described(
    names: Sequence[str], table: ReadTable, said: Description, defaults: FileDefaults
) -> tuple[DescribedChannel, ...]:
    if defaults.unit is None and table.unit is not None:
        defaults = replace(defaults, unit=table.unit)
    given = said.channels or {}
    return tuple(
        described_channel(name, named_so, merged(table.channels.get(name), given.get(name)), defaults)
        for name, named_so in read_names(names).items()
    )


def _without_sentinels(names: tuple[str, ...], data: FloatArray) -> tuple[FloatArray, list[str]]:
    """Return the data with gaps where a logger wrote a number for none, and what was found."""
    rows, remarks = [], []
    for name, row in zip(names, data, strict=True):
        cleaned, value, count = without_sentinels(row)
        rows.append(cleaned)
        if value is not None:
            remarks.append(
                f"{name}: {count} samples read {value:.10g}, a sign for no value; declared missing"
            )
    return np.array(rows, dtype=np.float64).reshape(data.shape), remarks


def _refuse_twins(names: tuple[str, ...]) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise InputError(
                "channel name is given twice",
                field="channels",
                value=name,
                allowed="different names",
                remedy="rename one",
            )


def _row_of(name: str, table: ReadTable) -> int:
    if name not in table.names:
        raise InputError(
            "channel is described but not in the data file",
            field="channels",
            value=name,
            allowed=", ".join(table.names),
            remedy=did_you_mean(name, table.names) or "remove it from the description",
        )
    return table.names.index(name)


def known_rate(table: ReadTable, rate: float | None, beside: str) -> float:
    """Return the sample rate if it is known.

    Raises
    ------
    InputError
        If it is not: because the dates of the file are ambiguous, or because nothing says it.
    """
    if rate is None and table.ambiguous is not None:
        refuse_ambiguous(table.ambiguous[1], table.ambiguous[0])
    if rate is None:
        raise InputError(
            "sample rate is missing",
            field="sample_rate_hz",
            allowed="> 0 Hz",
            remedy=f'write "sample_rate_hz" into {beside} beside the file (identify, init: or --sample-rate)',
        )
    return rate


def stated_rate(table: ReadTable, said: Description) -> float | None:
    """Return the rate that the file or its description states, if either does.

    Raises
    ------
    InputError
        If they contradict each other.
    """
    own, given = table.sample_rate_hz, said.sample_rate_hz
    if own is not None and given is not None and abs(own / given - 1.0) > 1e-3:
        raise InputError(
            "sample rate of the description contradicts the data file",
            field="sample_rate_hz",
            value=given,
            allowed=f"{own:g} Hz",
            remedy="correct or remove it in the description",
        )
    return given if given is not None else own
