"""Channels whose clock is not that of the others: late, jumping, or running too fast.

Channels of one logger share its clock. Delays of all pairs (``delays.py``) are brought down to one a channel
and window; channels that go together are one group, the largest group keeps the time. What groups do in time
is told apart: a delay that stays is a shift, one that grows is a clock that runs too slow, one that jumps
parts the record, of which the longest stretch without a jump is judged. A sensitivity that jumps shows in
the same pairs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.clocks.results import LoggerClocks
from jackettwin.records.processing.filters import bridge
from jackettwin.records.quality.faults import is_constant

if TYPE_CHECKING:
    from jackettwin.records.record import Record

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from jackettwin.arrays import IntArray
from jackettwin.records.clocks.another_time import may_be_compared, spanning_pairs, strangers
from jackettwin.records.clocks.channel_delays import (
    EXPLAINED,
    REACH_RAD,
    Network,
    against_main,
    by_channel,
    drifts,
    late_clocks,
    per_channel,
    ties,
    without_gaps,
)
from jackettwin.records.clocks.correction import rejoined
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
from jackettwin.records.clocks.results import ClockJump, Strangers

LEAST_WEIGHT = 20.0
"""Sum of the weights of a pair that says anything: two bins of full coherence, or twenty of half."""
MOSTLY_DELAY = 0.6
"""Share of the weight that must have moved on by a delay."""
NEAR_S, NEAR = 2.0, 0.6
"""Delays up to this, and up to this share of the longest they are sought to, are left to the phases."""
FEWEST_WINDOWS = 4
"""Of a stretch that is judged."""


LEAST_PRESENT = 0.75
"""Share of the samples of a channel whose clock can be judged: a longer gap, bridged, looks like another
time."""


@dataclass(frozen=True)
class _Seen:
    """Phases, and which channels they hold against each other."""

    phases: Phases
    network: Network


def clocks_of(record: Record, slow_free: FloatArray) -> LoggerClocks:
    """Return what the vibrations of a record say of the clocks of its loggers.

    Parameters
    ----------
    slow_free : (n_channels, n_samples)
        Its samples without mean and drift; NaN marks missing ones.
    """
    rows = [
        i
        for i, channel in enumerate(record.channels)
        if channel.quantity in VIBRATIONS
        and np.isfinite(slow_free[i]).mean() > LEAST_PRESENT
        and not is_constant(slow_free[i])
    ]
    if len(rows) < 2:
        return LoggerClocks(stop=record.data.shape[1])
    found = logger_clocks(
        np.array([bridge(slow_free[i]) for i in rows]),
        record.sample_rate_hz,
        velocity=[record.channels[i].quantity == "velocity" for i in rows],
        places=[record.channels[i].node or record.channels[i].height_m for i in rows],
        directions=[record.channels[i].direction for i in rows],
    )
    return found.of_rows(rows)


def logger_clocks(
    y: FloatArray,
    sample_rate_hz: float,
    *,
    velocity: Sequence[bool],
    places: Sequence[object],
    directions: Sequence[Sequence[float]] = (),
    losses: int = 2,
) -> LoggerClocks:
    """Return which channels are late, jump or drift against the others, or are of another time.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Vibrations of zero mean, without gaps.
    velocity : (n_channels,) bool
        Channels that are a quarter of a turn off, as velocities are.
    places : (n_channels,)
        Where each channel sits; None if it is not known.
    directions : (n_channels, 3), optional
        Which way it points; zeros if that is not known.
    losses : int
        Of seconds, that are given back at most.
    """
    whole = LoggerClocks(stop=y.shape[1])
    if len(y) < 2:
        return whole
    turn = np.where(np.asarray(velocity, dtype=bool), 1j, 1.0 + 0.0j)
    first_look, same_place = phases(y, sample_rate_hz, turn), ties(places)
    if first_look is None:
        return whole
    tree = spanning_pairs(first_look)
    compared = may_be_compared(directions, len(y))
    again = partial(logger_clocks, sample_rate_hz=sample_rate_hz)
    apart = strangers(y, sample_rate_hz, first_look, tree, compared)
    if apart:
        return _without_strangers(y, apart, again, velocity, places, directions)
    lost, parted = lost_time(y, sample_rate_hz, first_look, same_place)
    if parted and (lost is None or not losses):
        return replace(whole, judged=False)
    if lost is not None:
        moved = y.copy()
        for i in lost.rows:
            moved[i] = bridge(rejoined(y[i], lost))
        found = again(moved, velocity=velocity, places=places, directions=directions, losses=losses - 1)
        return replace(found, lost=(lost, *found.lost))
    far = _long_delays(y, sample_rate_hz, first_look, same_place)
    near = phases(_moved(y, far, sample_rate_hz), sample_rate_hz, turn) if far.any() else first_look
    seen = _seen(near, len(y), same_place)
    if seen is None:
        return whole
    length = y.shape[1] // len(seen.phases.coherency)
    window_s = length / sample_rate_hz
    weight, series, sign = _series(seen)
    jumping, growing = gain_changes(seen.phases, seen.network, weight, length)
    # the sign of a motion in x against one in y is the wind's
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
    if last - first < FEWEST_WINDOWS:
        return replace(whole, jumps=jumps, judged=False)
    start, stop = (first * length, last * length) if jumps else (0, y.shape[1])
    stop = y.shape[1] if last == len(series) else stop
    slope, slope_std = drifts(series[first:last], seen.network)
    model = slope * (np.arange(first, last) - first)[:, None]
    within = replace(seen.phases, coherency=seen.phases.coherency[first:last])
    still = aligned(within, model)
    late = late_clocks(
        still, seen.network, far, (slope / window_s, slope_std / window_s), (first + 0.5) * window_s
    )
    return replace(whole, late=late, jumps=jumps, start=start, stop=stop)


def _without_strangers(
    y: FloatArray,
    apart: tuple[Strangers, ...],
    again: Callable[..., LoggerClocks],
    velocity: Sequence[bool],
    places: Sequence[object],
    directions: Sequence[Sequence[float]],
) -> LoggerClocks:
    """Judge the channels again, those stored backwards turned, those of another time left out."""
    turned = [i for one in apart if one.backwards for i in one.rows]
    out = {i for one in apart if not one.backwards for i in one.rows}
    rows = [i for i in range(len(y)) if i not in out]
    y = y.copy()
    y[turned] = y[turned, ::-1]
    found = again(
        y[rows],
        velocity=[velocity[i] for i in rows],
        places=[places[i] for i in rows],
        directions=[directions[i] for i in rows] if len(directions) else (),
    ).of_rows(rows)
    return replace(found, strangers=(*apart, *found.strangers))


def _long_delays(y: FloatArray, sample_rate_hz: float, seen: Phases, same_place: IntArray) -> FloatArray:
    """Return delays too long for phases to show, in whole samples [s], (n_channels,)."""
    near_s = _near_s(seen)
    explained = objective(seen, doubled(seen), seen.search_s).max(axis=0)
    unknown = (seen.total <= LEAST_WEIGHT) | (explained < EXPLAINED * seen.total)
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
    """Return the delay up to which the phases tell it."""
    return min(NEAR_S, NEAR * float(seen.search_s[-1]))


def _moved(y: FloatArray, by_s: FloatArray, sample_rate_hz: float) -> FloatArray:
    """Return the samples so much earlier, zeros where there are none."""
    out = np.zeros_like(y)
    for row, new, by in zip(y, out, np.round(by_s * sample_rate_hz).astype(int), strict=True):
        new[max(-by, 0) : len(new) - max(by, 0)] = row[max(by, 0) : len(row) - max(-by, 0)]
    return out


def _seen(found: Phases | None, n: int, same_place: IntArray) -> _Seen | None:
    """Return the phases, the pairs that say something and the least delay they can tell."""
    if found is None:
        return None
    informative = found.total > LEAST_WEIGHT
    if not informative.any():
        return None
    weight = found.weight[:, informative].sum(axis=1)
    rms_hz = float(np.sqrt(weight @ found.frequency_hz**2 / weight.sum()))
    reach_s = REACH_RAD / (2.0 * np.pi * rms_hz)
    return _Seen(found, Network(n, found.pairs, informative, same_place, reach_s))


def _series(seen: _Seen) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the weights of the pairs, how much later each channel is than in the first window, and signs.

    Returns
    -------
    weight : (n_windows, n_pairs)
    delay_s : (n_windows, n_channels)
    sign : (n_windows, n_pairs)
    """
    delay, explained, sign = trajectories(seen.phases)
    weight = np.where(seen.network.informative & (explained > MOSTLY_DELAY), seen.phases.total, 0.0)
    return weight, by_channel(seen.network, delay, weight), sign
