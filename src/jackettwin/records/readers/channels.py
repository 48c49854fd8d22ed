"""A channel from its file, description and name: in SI units, with place and direction.

Placeholders that loggers write for missing values (−9999, 1e30, the ends of an integer's range)
become missing samples.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.quantities import (
    VIBRATIONS,
    guess_quantity,
    names_other,
    plain_unit,
    quantity,
    to_si,
    unit_in_name,
    vibration_of,
)
from jackettwin.records.readers.channel_names import Reading
from jackettwin.records.readers.description import ChannelEntry
from jackettwin.records.record import Channel

if TYPE_CHECKING:
    from collections.abc import Mapping


RAW_UNITS = ("counts", "count", "cts", "digits", "digit", "lsb", "raw", "adc", "v", "mv", "volt", "volts")
"""Units of raw converter readings, which need a gain."""
STANDING_FOR_RAW = "m/s^2"
"""Unit of numbers times gain if none is stated."""


@dataclass(frozen=True)
class FileDefaults:
    """Properties of a file that neither it nor the JSON beside it states.

    Attributes
    ----------
    sample_rate_hz : float or None
    unit : str or None
        Of the channels without a unit: of acceleration, velocity, displacement or another vibration.
    gain : float or None
        Value of one count (or volt) in that unit, for channels stored unscaled;
        if no unit is stated anywhere, also for channels without one.
    timezone : str or None
        Time zone of a clock without one: an IANA name (``Europe/Berlin``) or an offset (``+02:00``).
    """

    sample_rate_hz: float | None = None
    unit: str | None = None
    gain: float | None = None
    timezone: str | None = None


@dataclass(frozen=True)
class DescribedChannel:
    """A channel, the factor from its stored numbers to SI, and what was taken from its name."""

    channel: Channel
    factor: float
    from_name: Reading
    by_unit: bool = False
    """Whether only the unit says that it is a velocity."""
    remark: str = ""
    """That its name ends in another unit than it is read in."""


def merged(own: ChannelEntry | None, given: ChannelEntry | None) -> dict[str, Any]:
    """Return the file's entry of a channel, overruled by the description; null removes a value."""
    own_entry = (own or ChannelEntry()).model_dump(exclude_none=True)
    return own_entry | (given or ChannelEntry()).model_dump(exclude_unset=True)


def described_channel(
    name: str, named_so: Reading, entry: Mapping[str, Any], defaults: FileDefaults
) -> DescribedChannel:
    """Return the channel in SI units, placed and directed by its entry, else by what its name says.

    Raises
    ------
    InputError
        If the unit is missing or wrong, a gain is missing, or the direction is none; names the channel.
    """
    try:
        kind, unit, gain = _measures(name, entry, defaults)
        named = unit_in_name(name, kind) if kind in VIBRATIONS and not unit else ""
        factor, si_unit = _factor(kind, unit or named)
        read = replace(_from_name(named_so, entry, kind), unit=named)
        direction = _unit_vector(entry.get("direction") or read.direction or (0.0, 0.0, 0.0))
    except InputError as error:
        raise error.at(field=f"channels.{name}") from None
    node = entry.get("node")
    channel = Channel(
        name=name,
        quantity=kind,
        unit=si_unit,
        height_m=entry.get("height_m", read.height_m),
        node=None if node is None else str(node),
        direction=direction,
        frame=entry.get("frame") or "global",
    )
    said = entry.get("quantity") or defaults.unit or guess_quantity(name, "") == kind
    by_unit = kind == "velocity" and not said
    remark = _contradiction(name, kind, unit) if gain == 1.0 else ""
    return DescribedChannel(channel, factor * gain, read, by_unit=by_unit, remark=remark)


def _contradiction(name: str, kind: str, unit: str) -> str:
    """Return what to say of a vibration channel whose name ends in another unit than is stated."""
    named = unit_in_name(name, kind) if kind in VIBRATIONS and unit else ""
    if not named or to_si(kind, named) == to_si(kind, unit):
        return ""
    factor = to_si(kind, named) / to_si(kind, unit)
    return (
        f"{name}: its name ends in {named}, but {unit} is stated and used: if {named} is right, amplitudes "
        f'are wrong by a factor of {factor:.4g}; "unit" in the JSON beside the file overrules both'
    )


def _measures(name: str, entry: Mapping[str, Any], defaults: FileDefaults) -> tuple[str, str, float]:
    """Return quantity, unit, and the gain from the stored numbers to this unit."""
    unit, gain = plain_unit(entry.get("unit") or ""), entry.get("gain")
    raw = unit.lower() in RAW_UNITS
    kind = entry.get("quantity") or guess_quantity(name, "" if raw else unit)
    could_vibrate = kind in (*VIBRATIONS, "other") and not names_other(name)
    gain = defaults.gain if gain is None and could_vibrate and (raw or not unit) else gain
    if raw and gain is None and kind in VIBRATIONS:
        raise InputError(
            "is stored unscaled, and nothing says what one unit is worth",
            field="gain",
            value=entry["unit"],
            allowed=f"a number: {STANDING_FOR_RAW} for one of {entry['unit']}",
            remedy='write "gain" (and the "unit" it leads to) into the JSON beside the file '
            "(identify, init: or --gain, with --unit)",
        )
    if gain == 0.0:
        raise InputError(
            "makes every sample zero",
            field="gain",
            value=gain,
            allowed="any number but zero",
            remedy="give what one stored number is worth in the channel's unit",
        )
    if could_vibrate and (not unit or raw) and (defaults.unit is not None or gain is not None):
        if defaults.unit is not None or raw:
            unit = plain_unit(defaults.unit or STANDING_FOR_RAW)
        if unit:
            kind = vibration_of(unit) if kind == "other" else kind
    return kind, unit, 1.0 if gain is None else float(gain)


def _from_name(read: Reading, entry: Mapping[str, Any], kind: str) -> Reading:
    """Return what is taken from a vibration channel's name because its entry lacks it."""
    if kind not in VIBRATIONS:
        return Reading()
    placed = entry.get("node") is not None or "height_m" in entry
    return Reading(
        direction=None if entry.get("direction") else read.direction,
        direction_word=read.direction_word,
        height_m=None if placed else read.height_m,
        datum=read.datum,
        level=read.level,
    )


def _factor(kind: str, unit: str) -> tuple[float, str]:
    if kind == "other":  # no SI unit to bring it to: numbers and unit stay as they are
        return 1.0, unit or "-"
    si_unit = quantity(kind).unit
    if not unit and si_unit != "-":
        raise InputError(
            "unit is missing",
            field="unit",
            allowed=f"{si_unit} or another unit of {kind}",
            remedy="state the unit of the stored numbers in the JSON beside it (identify, init: or --unit)",
        )
    return to_si(kind, unit or si_unit), si_unit


def _unit_vector(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    largest = max(map(abs, direction))
    if not largest < float("inf"):
        raise InputError(
            "is not a direction",
            field="direction",
            value=direction,
            allowed="three finite numbers",
            remedy="write e.g. [1, 0, 0]",
        )
    if largest == 0.0:
        return (0.0, 0.0, 0.0)
    length = float(np.linalg.norm(np.array(direction) / largest))
    x, y, z = (float(part) / largest / length for part in direction)
    return (x, y, z)


FLOW_RATIO = 2.0
"""Ratio of the mean of a speed to its standard deviation above which it is that of wind or water: a structure
stays where it is, and wind of such turbulence is not measured."""


def without_flows(
    described: tuple[DescribedChannel, ...], data: FloatArray
) -> tuple[tuple[DescribedChannel, ...], tuple[str, ...]]:
    """Return the channels, those no velocities that stand for a flow, and a remark on each of them.

    Only channels are judged that are velocities for their unit alone.

    Parameters
    ----------
    data : (n_channels, n_samples)
        In SI units; NaN marks a missing sample.
    """
    out, remarks = [], []
    for one, y in zip(described, data, strict=True):
        there = y[np.isfinite(y)]
        mean, size = (float(np.abs(there.mean())), float(there.std())) if there.size else (0.0, 0.0)
        if one.by_unit and mean > FLOW_RATIO * size > 0.0:
            channel = replace(one.channel, quantity="other")
            one = replace(one, channel=channel, from_name=Reading())
            remarks.append(
                f"{channel.name}: a speed whose mean is {mean / size:.2g} times its deviation, so not of the "
                'structure; "quantity" in the JSON beside the file overrules this'
            )
        out.append(one)
    return tuple(out), tuple(remarks)


SENTINELS = np.array(
    [
        *(-99.9, -999.0, -999.25, -999.9, -9999.0, -9999.25, -99999.0, -999999.0, 9999.0, 99999.0, 999999.0),
        *(32767.0, -32767.0, -32768.0, 65535.0, 2147483647.0, -2147483648.0),
        *(1e20, 1e30, -1e30, 1e35, 1e37, np.float64(np.float32(9.96921e36)), 1e38),
    ]
)
"""Placeholders for missing values, in the file's own unit."""
MIN_DISTANCE = 2.0
"""Smallest distance of a placeholder from all other values, over their range."""
MIN_OCCURRENCES = 2
"""Fewest occurrences of a placeholder."""


def without_sentinels(y: FloatArray) -> tuple[FloatArray, float | None, int]:
    """Return a channel with placeholders made missing, the placeholder, and its number.

    A placeholder is exactly one of ``SENTINELS``, occurs at least twice, and is far from all other values,
    so that a power of 9999 kW or a signal clipped at the end of a range is kept.

    Examples
    --------
    >>> y, value, count = without_sentinels(np.array([0.1, -9999.0, 0.3, -9999.0, 0.2]))
    >>> y.tolist(), value, count
    ([0.1, nan, 0.3, nan, 0.2], -9999.0, 2)
    """
    hits = np.isin(y, SENTINELS)
    if np.count_nonzero(hits) < MIN_OCCURRENCES:
        return y, None, 0
    values, counts = np.unique(y[hits], return_counts=True)
    value, count = float(values[np.argmax(counts)]), int(counts.max())
    rest = y[np.isfinite(y) & ~np.isin(y, SENTINELS)]
    if count < MIN_OCCURRENCES or not rest.size:
        return y, None, 0
    low, high = float(rest.min()), float(rest.max())
    if max(low - value, value - high) <= MIN_DISTANCE * (high - low):
        return y, None, 0
    return np.where(y == value, np.nan, y), value, count
