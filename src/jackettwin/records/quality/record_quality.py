"""Quality of a record: its faults, in words, and whether they can be repaired."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.clocks import LoggerClocks, clock_findings, clocks_of, in_step
from jackettwin.records.processing import filters
from jackettwin.records.quality import faults, sensor_polarity
from jackettwin.records.quality.aliasing import PEAKS, not_filtered
from jackettwin.records.quality.faults import ChannelQuality, channel_findings
from jackettwin.records.quality.sensor_changes import SensorChange, changes, described
from jackettwin.records.quality.unit_errors import wrong_units
from jackettwin.records.quality.unused import Unused, unused
from jackettwin.records.record import LARGEST
from jackettwin.signals import runs

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.records.record import Channel, Record


STUCK_S = 1.0
"""Shortest frozen reading [s]."""
MAX_SPIKE_SHARE = 0.02
"""Largest share of outliers that are removed as spikes; more of them are part of the signal."""
MAX_MISSING_SHARE = 0.9
"""Share of missing samples above which a channel counts as empty."""
DRIFT_CYCLES = 5.0
"""Cycles in the record below which motion is drift."""
MAX_DRIFT = 1e9
"""Ratio of drift to rms above which a channel contains only drift and its rounding, no vibration."""
PARTS = 10
"""Parts of a record whose rms are compared."""
WEAK_RATIO = 1.0 / 300.0
"""Ratio of a channel's rms to the median of its quantity below which the sensor is nearly dead,
and above whose inverse its unit is wrong."""
MIN_PARALLEL_COSINE = 0.5
"""Cosine of the angle between two channels below which their sizes are not compared."""
JITTER = 0.05
"""Clock jitter, as a share of the step, above which a finding is given."""


@dataclass(frozen=True)
class Quality:
    """The quality of a record.

    Attributes
    ----------
    score : float
        Mean score of the vibration channels: 1 is faultless, 0 is empty.
    channels : tuple of ChannelQuality
        In the record's order.
    findings : tuple of Finding
    suspect : (n_channels, n_samples) bool array
        Samples that ``repair`` makes missing: spikes, frozen and unreadable ones,
        and the shorter side of a change.
    clocks : LoggerClocks
        Clock errors that ``repair`` corrects, and the part of the record without a jump of a clock.
    unused : tuple of Unused
        Where samples are missing, or suspect.
    """

    score: float
    channels: tuple[ChannelQuality, ...]
    findings: tuple[Finding, ...]
    suspect: BoolArray
    clocks: LoggerClocks
    unused: tuple[Unused, ...]

    def summary(self) -> dict[str, Any]:
        """Return everything but the samples as plain JSON data."""
        return {
            "score": self.score,
            "findings": [f.document for f in self.findings],
            "channels": [asdict(channel) for channel in self.channels],
            "unused": [asdict(stretches) for stretches in self.unused],
        }


def assess(record: Record, *, thorough: bool = True) -> Quality:
    """Look for gaps, spikes, clipping, frozen and dead channels, drift, swapped signs and a bad clock.

    Never fails, whatever the samples are.

    Parameters
    ----------
    thorough : bool
        Whether clocks are compared and changes within the record and missing filters are sought: two thirds
        of the time.
    """
    read, unreadable = record, (record.data > LARGEST) | (record.data < -LARGEST)
    if unreadable.any():
        record = replace(record, data=np.where(unreadable, np.nan, record.data))
    held = [faults.hold_length(row) for row in record.data]
    spikes = [faults.spikes(row, hold=hold) for row, hold in zip(record.data, held, strict=True)]
    frozen = [_frozen(record, i) for i in range(len(record.data))]
    slow_free = _without_slow(record, [a | b for a, b in zip(spikes, frozen, strict=True)])
    known = clocks_of(record, slow_free) if thorough else LoggerClocks(stop=record.data.shape[1])
    # channels are compared after correction of their clocks
    together = in_step(slow_free, known, record.sample_rate_hz)
    groups = list(sensor_polarity.parallel_groups(record, together[:, known.start : known.stop]))
    reversed_channels = sensor_polarity.reversed_channels(record, groups)
    changed = _changed(record, together) if thorough else {}
    judged = [
        _judge(
            record,
            i,
            held[i],
            spikes[i],
            frozen[i],
            slow_free[i],
            reversed_channels.get(channel.name),
            changed.get(i),
        )
        for i, channel in enumerate(record.channels)
    ]
    channels = tuple(quality for quality, _, _ in judged)
    findings = [finding for _, _, found in judged for finding in found]
    units = wrong_units(record, groups)
    findings += [Finding("unit", name, wrong.words) for name, wrong in units.items()]
    findings += [Finding("file", params={"text": str(text)}) for text in record.metadata.get("remarks", ())]
    findings += [*_unreadable(record, unreadable), *_weak(record, channels), *_clock(record)]
    findings += _folded(record, channels, slow_free) if thorough else []
    findings += clock_findings(record, known)
    vibrating = [q.score for q, c in zip(channels, record.channels, strict=True) if c.quantity in VIBRATIONS]
    scores = vibrating or [q.score for q in channels]
    suspect = np.array([mask for _, mask, _ in judged], dtype=np.bool_).reshape(record.data.shape)
    suspect |= unreadable
    score = float(np.mean(scores)) if scores else 0.0
    return Quality(score, channels, tuple(findings), suspect, known, unused(read, suspect))


def shortest_stuck(sample_rate_hz: float) -> int:
    """Return the samples of the shortest frozen reading."""
    return max(int(STUCK_S * sample_rate_hz), 20)


def _frozen(record: Record, i: int) -> BoolArray:
    """Mark the frozen readings of a vibration."""
    y = record.data[i]
    if record.channels[i].quantity not in VIBRATIONS:
        return np.zeros(len(y), dtype=np.bool_)
    return faults.stuck(y, shortest_stuck(record.sample_rate_hz))


def _without_slow(record: Record, spoilt: list[BoolArray]) -> FloatArray:
    """Return the data without mean and drift.

    Spikes and frozen readings are removed first: the drift would hide behind the one, and the other would be
    compared with the motion of other channels.
    """
    data = record.data
    if any(mask.any() for mask in spoilt):
        data = np.where(spoilt, np.nan, data)
    return filters.remove_slow(data, DRIFT_CYCLES / max(data.shape[1], 1))


def _changed(record: Record, slow_free: FloatArray) -> dict[int, SensorChange]:
    """Return, by row, vibration channels that change during the record."""
    rows = [i for i, channel in enumerate(record.channels) if channel.quantity in VIBRATIONS]
    vibrating = slow_free if len(rows) == len(slow_free) else slow_free[rows]
    return {rows[c.row]: replace(c, row=rows[c.row]) for c in changes(vibrating)}


def _judge(
    record: Record,
    i: int,
    hold: int,
    spikes: BoolArray,
    frozen: BoolArray,
    slow_free: FloatArray,
    sign: bool | None,
    change: SensorChange | None,
) -> tuple[ChannelQuality, BoolArray, list[Finding]]:
    """Return the quality of one channel, its suspect samples and its findings."""
    channel, y = record.channels[i], record.data[i]
    n, vibrates = max(len(y), 1), channel.quantity in VIBRATIONS
    missing = ~np.isfinite(y)
    longest = runs(missing)[:, 1].max(initial=0)
    empty = bool(missing.mean() > MAX_MISSING_SHARE) if len(y) else True
    dead = empty or (vibrates and faults.is_constant(y))
    none = np.zeros(len(y), dtype=np.bool_)
    look = vibrates and not dead
    held = hold if look else 1
    spikes = spikes if look else none
    clipped = faults.clipped(y) if look else none
    stuck = frozen if look else none
    outliers = bool(spikes.mean() > MAX_SPIKE_SHARE) if look else False
    # a frozen reading has been reported already
    change = None if stuck.any() or not look else change
    changed = none.copy()
    if change is not None and change.certain:
        changed[change.start : change.stop] = True
    kept = np.isfinite(slow_free)
    drift = faults.drift_ratio(np.where(kept, y - slow_free, np.nan), slow_free) if look else 0.0
    quality = ChannelQuality(
        name=channel.name,
        score=0.0,
        dead=dead or drift > MAX_DRIFT,
        gap_share=float(missing.sum()) / n,
        longest_gap_s=float(longest) / record.sample_rate_hz,
        spike_share=float(spikes.sum()) / n,
        clipped_share=float(clipped.sum()) / n,
        stuck_share=float(stuck.sum()) / n,
        changed_share=float(changed.sum()) / n,
        hold_length=held,
        drift_ratio=drift,
        unsteadiness=faults.unsteadiness(np.where(spikes, np.nan, slow_free), PARTS) if look else 1.0,
        swapped_sign=bool(sign),
        quantiser_steps=_steps(y, slow_free) if look else 0.0,
    )
    findings = list(channel_findings(channel, quality, empty=empty, outliers=outliers, sign=sign))
    if change is not None and not quality.dead:
        code, what = (
            "changed" if change.certain else "changed_unclear",
            described(change, 1.0 / record.sample_rate_hz),
        )
        findings.append(Finding(code, channel.name, {"what": what}, repaired=change.certain))
    suspect = (none if outliers else spikes) | stuck | changed
    return replace(quality, score=_score(quality, sign)), suspect, findings


def _steps(y: FloatArray, slow_free: FloatArray) -> float:
    """Return the quantisation step over the rms of the vibration."""
    size = float(np.nanstd(slow_free)) if np.isfinite(slow_free).any() else 0.0
    return faults.quantiser_step(y) / size if size > 0.0 else 0.0


def _score(q: ChannelQuality, sign: bool | None) -> float:
    """Return 1 for a faultless channel, less for every fault, 0 for a dead one."""
    if q.dead:
        return 0.0
    lost = 1.0 - min(
        1.0, q.gap_share + q.changed_share + 10.0 * (q.spike_share + q.clipped_share + q.stuck_share)
    )
    doubt = (0.5 if sign is False else 1.0) * (0.9 if sign else 1.0) * (0.7 if q.hold_length > 1 else 1.0)
    return lost * doubt


def _unreadable(record: Record, unreadable: BoolArray) -> Iterator[Finding]:
    """Yield channels with infinite or absurdly large samples."""
    for channel, row in zip(record.channels, unreadable, strict=True):
        if row.any():
            params = {"samples": int(row.sum()), "limit": LARGEST}
            yield Finding("unreadable", channel.name, params, repaired=True)


def _weak(record: Record, channels: tuple[ChannelQuality, ...]) -> Iterator[Finding]:
    """Yield channels whose rms differs from that of similar, parallel channels by a very large factor."""
    live = [i for i, q in enumerate(channels) if not q.dead and record.channels[i].quantity in VIBRATIONS]
    rms = {i: float(np.nanstd(record.data[i])) for i in live}
    for i in live:
        like = [rms[j] for j in live if _similar(record.channels[i], record.channels[j])]
        ratio = rms[i] / float(np.median(like))
        if not WEAK_RATIO <= ratio <= 1.0 / WEAK_RATIO:
            yield Finding("weak" if ratio < 1.0 else "strong", channels[i].name, {"ratio": float(ratio)})


def _similar(one: Channel, other: Channel) -> bool:
    """Tell whether two channels measure the same quantity and are not known to lie across."""
    known = any(one.direction) and any(other.direction)
    cosine = abs(float(np.dot(one.direction, other.direction))) if known else 1.0
    return one.quantity == other.quantity and cosine > MIN_PARALLEL_COSINE


def _folded(record: Record, channels: tuple[ChannelQuality, ...], slow_free: FloatArray) -> Iterator[Finding]:
    """Yield one finding on the channels that no filter seems to have passed."""
    rows = [
        i
        for i, q in enumerate(channels)
        if record.channels[i].quantity in VIBRATIONS and not q.dead and q.hold_length == 1
    ]
    flat, share, peak = not_filtered(slow_free[rows])
    if flat.any():
        names = ", ".join(channels[i].name for i, one in zip(rows, flat, strict=True) if one)
        half_hz = 0.5 * record.sample_rate_hz
        most = int(np.argmax(np.where(flat, share, 0.0)))
        where = {"half_hz": half_hz, "peak_hz": float(peak[most]) * half_hz, "from_hz": PEAKS[0] * half_hz}
        yield Finding("not_filtered", params={"channels": names, "share": float(share[most]), **where})


def _clock(record: Record) -> Iterator[Finding]:
    """Yield findings on the time stamps of the file, if it had any."""
    clock = record.metadata.get("clock")
    if not isinstance(clock, dict):
        return
    jitter = float(clock.get("jitter_s") or 0.0) * record.sample_rate_hz
    if jitter > JITTER:
        yield Finding("stamps_jitter", params={"share": jitter})
    for what in ("missing", "disordered"):
        if clock.get(what):
            yield Finding(f"stamps_{what}", params={"samples": int(clock[what])})
