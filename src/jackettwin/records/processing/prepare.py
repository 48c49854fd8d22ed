"""Preparation of a record for identification: ``Record`` in, ``Record`` out, phase untouched.

Trends and slow parts are taken from vibrations only (acceleration, velocity, displacement, strain,
inclination); wind, yaw, rotor speed and the like keep their mean. What was done, and how much of
either end rests on reflected samples, is appended to ``metadata["preparation"]``.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.processing import filters

if TYPE_CHECKING:
    from collections.abc import Callable

    from jackettwin.records.record import Record

PASS_SHARE = 0.8
"""Pass-band edge of a low-pass filter as a share of its stop edge."""


def detrend(record: Record) -> Record:
    """Remove the mean and the line from every vibration channel; gaps stay gaps."""
    return _done(_on_vibrations(record, filters.remove_line), "detrend")


def highpass(record: Record, *, cutoff_hz: float) -> Record:
    """Remove what is slower than ``cutoff_hz`` from every vibration channel.

    Zero phase; the gain is 0.707 at the cutoff, 0.993 at twice the cutoff. Gaps stay exactly as
    they are, and no samples are lost at the ends.

    Raises
    ------
    InputError
        If the cutoff is not between one cycle a record and the Nyquist frequency.
    """
    _check_band(record, "cutoff_hz", cutoff_hz, 1.0 / record.duration_s)
    cutoff = cutoff_hz / record.sample_rate_hz
    out = _on_vibrations(record, lambda y: filters.remove_slow(y, cutoff))
    return _done(out, "highpass", cutoff_hz=cutoff_hz)


def bandpass(record: Record, *, low_hz: float, high_hz: float) -> Record:
    """Keep ``low_hz`` to ``high_hz`` of every vibration channel.

    The lower edge is that of ``highpass``; above, the gain is 1 up to ``high_hz`` and 1e-4 from
    1.25 ``high_hz`` on. Zero phase. An output sample is missing when missing input carries more
    than a tenth of its filter weight.

    Raises
    ------
    InputError
        If the edges are reversed, beyond Nyquist, the record is shorter than half the filter, or gaps
        leave nothing of a channel.
    """
    _check_band(record, "high_hz", high_hz, low_hz)
    out = highpass(record, cutoff_hz=low_hz)
    stop = min(high_hz / PASS_SHARE / record.sample_rate_hz, 0.5)
    taps = filters.lowpass_taps(min(high_hz / record.sample_rate_hz, PASS_SHARE * stop), stop)
    edge_s = _check_length(record, filters.half_length(taps))
    out = _on_vibrations(out, lambda y: filters.resample(y, taps))
    _refuse_emptied(record, out.data)
    return _done(out, "lowpass", pass_hz=high_hz, edge_s=edge_s)


def decimate(record: Record, *, sample_rate_hz: float) -> Record:
    """Lower the sample rate behind a zero-phase anti-alias filter; the start time is kept.

    The gain is 1 up to 0.8 of the new Nyquist frequency and 1e-4 from the new Nyquist frequency on,
    so nothing folds back. Every channel is treated. About 25 new samples at either end rest on
    point-reflected data. Gaps of up to half a new step, and longer ones with less than a tenth of
    the filter's weight, are closed; others stay gaps.

    Raises
    ------
    InputError
        If the new rate is higher, not a ratio of whole numbers up to 1000 of the old, the record is
        shorter than half the filter, or gaps leave nothing of a channel.

    Examples
    --------
    >>> import numpy as np
    >>> from jackettwin.records import Channel, Record
    >>> record = Record(np.ones((1, 6000)), 100.0, (Channel("a"),))
    >>> decimate(record, sample_rate_hz=12.5).data.shape
    (1, 750)
    """
    if sample_rate_hz == record.sample_rate_hz:
        return record
    ratio = _ratio(record, sample_rate_hz)
    up, down = ratio.numerator, ratio.denominator
    stop = 0.5 / down
    taps = filters.lowpass_taps(PASS_SHARE * stop, stop)
    edge_s = _check_length(record, filters.half_length(taps, up))
    data = filters.resample(_unwrapped(record), taps, up, down)
    _refuse_emptied(record, data)
    out = replace(record, data=data, sample_rate_hz=float(record.sample_rate_hz * ratio))
    return _done(out, "decimate", from_hz=record.sample_rate_hz, to_hz=out.sample_rate_hz, edge_s=edge_s)


def _on_vibrations(record: Record, function: Callable[[FloatArray], FloatArray]) -> Record:
    rows = [i for i, channel in enumerate(record.channels) if channel.quantity in VIBRATIONS]
    if not rows or not record.data.shape[1]:
        return record
    if len(rows) == len(record.channels):
        return replace(record, data=function(record.data))
    data = record.data.copy()
    data[rows] = function(data[rows])
    return replace(record, data=data)


def _unwrapped(record: Record) -> FloatArray:
    """Return the data with yaw free of jumps by a turn, which a filter would smear."""
    data = record.data.copy()
    for i, channel in enumerate(record.channels):
        if channel.quantity == "yaw":
            finite = np.isfinite(data[i])
            data[i, finite] = np.unwrap(data[i, finite])
    return data


def _ratio(record: Record, sample_rate_hz: float) -> Fraction:
    if np.isfinite(sample_rate_hz) and 0.0 < sample_rate_hz < record.sample_rate_hz:
        exact = sample_rate_hz / record.sample_rate_hz
        ratio = Fraction(exact).limit_denominator(1000)
        if ratio and abs(float(ratio) - exact) <= 1e-9 * exact:
            return ratio
    raise InputError(
        "cannot decimate to this rate",
        file=record.name,
        field="sample_rate_hz",
        value=sample_rate_hz,
        allowed=f"p/q · {record.sample_rate_hz:g} Hz with whole p < q ≤ 1000",
        remedy=f"try {record.sample_rate_hz / 5:g} Hz",
    )


def _check_band(record: Record, field: str, value: float, lowest: float) -> None:
    nyquist = 0.5 * record.sample_rate_hz
    if not lowest < value < nyquist:
        raise InputError(
            "filter edge outside its range",
            file=record.name,
            field=field,
            value=value,
            allowed=f"{lowest:g} to {nyquist:g} Hz",
            remedy="choose an edge between the lower edge (or one cycle a record) and half the sample rate",
        )


def _check_length(record: Record, half_length: int) -> float:
    """Return the length of either edge [s], or refuse a record shorter than that."""
    if record.data.shape[1] <= half_length:
        raise InputError(
            "record is shorter than half the filter",
            file=record.name,
            field="duration_s",
            value=record.duration_s,
            allowed=f"> {half_length / record.sample_rate_hz:g} s",
            remedy="use a longer record or a higher rate",
        )
    return half_length / record.sample_rate_hz


def _refuse_emptied(record: Record, filtered: FloatArray) -> None:
    """Refuse to turn a channel with data into one without."""
    emptied = np.isfinite(record.data).any(axis=1) & ~np.isfinite(filtered).any(axis=1)
    if emptied.any():
        raise InputError(
            "gaps leave nothing of the channel behind the filter",
            file=record.name,
            field="channels",
            value=", ".join(np.array(record.channel_names)[emptied]),
            allowed="stretches without gaps longer than the filter",
            remedy="leave the channel out, or keep the sample rate",
        )


def _done(record: Record, step: str, **settings: Any) -> Record:
    """Append what was done to the record's metadata."""
    steps = [*record.metadata.get("preparation", []), {"step": step, **settings}]
    return replace(record, metadata={**record.metadata, "preparation": steps})
