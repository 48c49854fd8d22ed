"""Clock errors of loggers: channels that are late, jump or drift relative to the others.

Channels of one logger share its clock. Delays of all pairs (``delays.py``) are reduced to one
per channel and window. Channels that agree form a group, and the largest group is the reference.
A constant delay of a group is an offset, a growing one is a slow clock, a curve one whose rate changes
(as a quartz that warms up), and a jump divides the record,
of which the longest part without jumps is judged. Jumps of sensitivity appear in the same pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.clocks.another_time import (
    channel_axes,
    comparable_channels,
    spanning_pairs,
    strangers,
)
from jackettwin.records.clocks.channel_delays import (
    MIN_EXPLAINED_SHARE,
    REACH_RAD,
    Network,
    against_main,
    by_channel,
    curve,
    growth,
    late_clocks,
    per_channel,
    ties,
    without_gaps,
)
from jackettwin.records.clocks.correction import with_lost_samples
from jackettwin.records.clocks.delays import (
    Phases,
    aligned,
    band_lines,
    doubled,
    long_delays,
    objective,
    phases,
    trajectories,
)
from jackettwin.records.clocks.gain_changes import gain_changes, sign_turns
from jackettwin.records.clocks.jumps import runs, series_jumps
from jackettwin.records.clocks.lost_time import lost_time
from jackettwin.records.clocks.results import ClockJump, LoggerClocks, Strangers
from jackettwin.records.processing.filters import bridge, fade_weight
from jackettwin.records.quality.faults import is_constant

if TYPE_CHECKING:
    from jackettwin.records.record import Record

MIN_WEIGHT = 20.0
"""Smallest sum of the weights of an informative pair: two bins of full coherence, or twenty of half."""
MIN_DELAY_SHARE = 0.6
"""Smallest share of the weight that a change of delay must explain."""
MIN_STEADY_SHARE = 0.9
"""The same for the median window of a pair: the phases of close modes along two axes change as by no clock
and no sign. Of 5,100 parallel pairs of random towers 19 in 20 have more."""
NEAR_S, NEAR_SHARE = 2.0, 0.6
"""Delays up to this, and up to this share of the longest one sought, are determined from phases."""
MIN_WINDOWS = 4
"""Fewest windows of a part that is judged."""


MIN_PRESENT_SHARE = 0.75
"""Smallest share of present samples in a channel whose clock is judged;
a longer bridged gap resembles another time."""

LEAST_LEFT = 0.5
"""Smallest mean weight of the samples beside faded gaps; with more gaps these are bridged."""


@dataclass(frozen=True)
class _Compared:
    """Phases, and the channels they compare."""

    phases: Phases
    network: Network


def clocks_of(record: Record, slow_free: FloatArray) -> LoggerClocks:
    """Return the clock errors of loggers found in the vibrations of a record.

    Parameters
    ----------
    slow_free : (n_channels, n_samples)
        Samples without mean and drift; NaN marks missing ones.
    """
    rows = [
        i
        for i, channel in enumerate(record.channels)
        if channel.quantity in VIBRATIONS
        and np.isfinite(slow_free[i]).mean() > MIN_PRESENT_SHARE
        and not is_constant(slow_free[i])
    ]
    if len(rows) < 2:
        return LoggerClocks(stop=record.data.shape[1])
    complete = len(rows) == len(slow_free) and bool(np.isfinite(slow_free).all())
    found = logger_clocks(
        slow_free if complete else np.array([_without_gaps(slow_free[i]) for i in rows]),
        record.sample_rate_hz,
        velocity=[record.channels[i].quantity == "velocity" for i in rows],
        places=[record.channels[i].node or record.channels[i].height_m for i in rows],
        directions=channel_axes([record.channels[i] for i in rows]),
    )
    return found.of_rows(rows)


def _without_gaps(y: FloatArray) -> FloatArray:
    """Return a channel with its gaps bridged, and faded out beside the long ones if enough is left."""
    fade = fade_weight(y[None, :])
    whole = bridge(y)
    return np.asarray(whole * fade) if fade.mean() > LEAST_LEFT else whole


def logger_clocks(
    y: FloatArray,
    sample_rate_hz: float,
    *,
    velocity: Sequence[bool],
    places: Sequence[object],
    directions: FloatArray,
    losses: int = 2,
) -> LoggerClocks:
    """Return channels that are late, jump or drift relative to the others, or are of another time.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Vibrations of zero mean, without gaps.
    velocity : (n_channels,) bool
        Channels a quarter of a period off, such as velocities.
    places : (n_channels,)
        Place of each channel, None if unknown.
    directions : (n_channels, 5)
        From ``channel_axes``.
    losses : int
        Most losses of time that are corrected.
    """
    whole = LoggerClocks(stop=y.shape[1])
    if len(y) < 2:
        return whole
    turn = np.where(np.asarray(velocity, dtype=bool), 1j, 1.0 + 0.0j)
    first_look, same_place = phases(y, sample_rate_hz, turn), ties(places)
    if first_look is None:
        return whole
    tree = spanning_pairs(first_look)
    compared = comparable_channels(directions)
    again = partial(logger_clocks, sample_rate_hz=sample_rate_hz)
    found_apart = strangers(y, sample_rate_hz, first_look, tree, directions, places)
    apart = tuple(one for one in found_apart if not one.perhaps_across)
    if apart:
        return _without_strangers(y, apart, again, velocity, places, directions)
    whole = replace(whole, strangers=found_apart)
    lost, parted = lost_time(y, sample_rate_hz, first_look, same_place)
    if parted and (lost is None or not losses):
        return replace(whole, judged=False)
    if lost is not None:
        moved = y.copy()
        for i in lost.rows:
            moved[i] = bridge(with_lost_samples(y[i], lost))
        found = again(moved, velocity=velocity, places=places, directions=directions, losses=losses - 1)
        return replace(found, lost=(lost, *found.lost))
    far = _long_delays(y, sample_rate_hz, first_look, same_place)
    near = phases(_shifted(y, far, sample_rate_hz), sample_rate_hz, turn) if far.any() else first_look
    seen = _compared(near, len(y), same_place)
    if seen is None:
        return whole
    length = y.shape[1] // len(seen.phases.coherency)
    window_s = length / sample_rate_hz
    weight, series, sign = _series(seen)
    jumping, growing = gain_changes(seen.phases, seen.network, weight, length)
    # the sign of motion in x relative to y depends on the wind
    along = np.where(compared[seen.network.pairs[:, 0], seen.network.pairs[:, 1]], weight, 0.0)
    turning = sign_turns(y, sign, along, seen.network, length)
    whole = replace(whole, gains=(*jumping, *turning), growing=growing)
    between = runs(series, seen.network.reach_s)
    jumps = tuple(
        ClockJump(
            jump.rows,
            max(jump.before - 1, 0) * length,
            min(jump.after + 1, len(series)) * length,
            float(np.median(jump.by[list(jump.rows)])),
        )
        for jump in series_jumps(series, between, seen.network.reach_s)
    )
    first, last = max(between, key=lambda run: run[1] - run[0]) if jumps else (0, len(series))
    if last - first < MIN_WINDOWS:
        return replace(whole, jumps=jumps, judged=False)
    start, stop = (first * length, last * length) if jumps else (0, y.shape[1])
    stop = y.shape[1] if last == len(series) else stop
    grown = growth(series[first:last], seen.network)
    model = np.outer(np.arange(last - first), grown.slope) + np.outer(curve(last - first), grown.bend)
    model -= model[0]
    within = replace(seen.phases, coherency=seen.phases.coherency[first:last])
    still = aligned(within, model)
    late = late_clocks(still, seen.network, far, grown, first * window_s, window_s)
    return replace(whole, late=late, jumps=jumps, start=start, stop=stop)


def _without_strangers(
    y: FloatArray,
    apart: tuple[Strangers, ...],
    again: Callable[..., LoggerClocks],
    velocity: Sequence[bool],
    places: Sequence[object],
    directions: FloatArray,
) -> LoggerClocks:
    """Repeat the judgement with reversed channels turned and those of another time left out."""
    turned = [i for one in apart if one.backwards for i in one.rows]
    out = {i for one in apart if not one.backwards for i in one.rows}
    rows = [i for i in range(len(y)) if i not in out]
    y = y.copy()
    y[turned] = y[turned, ::-1]
    found = again(
        y[rows],
        velocity=[velocity[i] for i in rows],
        places=[places[i] for i in rows],
        directions=directions[rows],
    ).of_rows(rows)
    return replace(found, strangers=(*apart, *found.strangers))


def _long_delays(y: FloatArray, sample_rate_hz: float, seen: Phases, same_place: IntArray) -> FloatArray:
    """Return delays too long to appear in phases, in whole samples [s], (n_channels,)."""
    near_s = _near_s(seen)
    explained = objective(seen, doubled(seen), seen.search_s).max(axis=0)
    unknown = (seen.total <= MIN_WEIGHT) | (explained < MIN_EXPLAINED_SHARE * seen.total)
    delay, weight = np.zeros(len(seen.pairs)), np.where(unknown, 0.0, seen.total)
    lines = band_lines(y, sample_rate_hz) if unknown.any() else None
    delay[unknown], weight[unknown] = long_delays(lines, seen.pairs[unknown], near_s)
    if not delay.any():
        return np.zeros(len(y))
    network = Network(len(y), seen.pairs, weight > 0.0, same_place, near_s)
    each = against_main(network, per_channel(network, delay, weight)[None, :])[0]
    for group in without_gaps(each, 0.5 * near_s):
        each[group] = np.round(np.median(each[group]) * sample_rate_hz) / sample_rate_hz
    return np.where(np.abs(each) < near_s, 0.0, each)


def _near_s(seen: Phases) -> float:
    """Return the longest delay that the phases determine."""
    return min(NEAR_S, NEAR_SHARE * float(seen.search_s[-1]))


def _shifted(y: FloatArray, by_s: FloatArray, sample_rate_hz: float) -> FloatArray:
    """Return the samples shifted to earlier times, padded by zeros."""
    out = np.zeros_like(y)
    for row, new, by in zip(y, out, np.round(by_s * sample_rate_hz).astype(int), strict=True):
        new[max(-by, 0) : len(new) - max(by, 0)] = row[max(by, 0) : len(row) - max(-by, 0)]
    return out


def _compared(found: Phases | None, n: int, same_place: IntArray) -> _Compared | None:
    """Return phases, informative pairs and the smallest delay that they determine."""
    if found is None:
        return None
    informative = found.total > MIN_WEIGHT
    if not informative.any():
        return None
    weight = found.weight[:, informative].sum(axis=1)
    rms_hz = float(np.sqrt(weight @ found.frequency_hz**2 / weight.sum()))
    reach_s = REACH_RAD / (2.0 * np.pi * rms_hz)
    return _Compared(found, Network(n, found.pairs, informative, same_place, reach_s))


def _series(seen: _Compared) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return weights of pairs, delays of channels relative to the first window, and signs.

    Returns
    -------
    weight : (n_windows, n_pairs)
    delay_s : (n_windows, n_channels)
    sign : (n_windows, n_pairs)
    """
    delay, explained, sign = trajectories(seen.phases)
    steady = seen.network.informative & (np.median(explained[1:], axis=0) > MIN_STEADY_SHARE)
    weight = np.where(steady & (explained > MIN_DELAY_SHARE), seen.phases.total, 0.0)
    return weight, by_channel(seen.network, delay, weight), sign
