"""Channels whose clock is not that of the others: late, jumping, or running too fast.

Channels of one logger share its clock. Delays of all pairs (``delays.py``) are brought down to one a channel
and window; channels that go together are one group, the largest group keeps the time. What groups do in time
is told apart: a delay that stays is a shift, one that grows is a clock that runs too slow, one that jumps
parts the record, of which the longest stretch without a jump is judged. A sensitivity that jumps shows in
the same pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.records.channel_delays import (
    Network,
    against_main,
    joined,
    largest,
    per_channel,
    ties,
    without_gaps,
)
from jackettwin.records.delays import (
    Phases,
    aligned,
    doubled,
    gain_trajectories,
    long_delays,
    objective,
    phases,
    refined_peak,
    trajectories,
)
from jackettwin.records.jumps import SIGMAS, lines, runs, scatter, steps

LEAST_WEIGHT = 20.0
"""Sum of the weights of a pair that says anything: two bins of full coherence, or twenty of half."""
MOSTLY_DELAY = 0.6
"""Share of the weight that must have moved on by a delay."""
REACH_RAD = 0.25
"""Phase, at the root mean square frequency of the pairs, of the least delay that parts two channels: those of
a damped structure in wind scatter by up to this."""
DRIFT_RAD = 0.1
"""The same of a drift over the whole record: changes are free of what the modes do."""
PARTED = 0.1
"""Share of the spread of the slopes of all channels within which that of a sharp one is known."""
LEAST_FACTOR = 1.15
"""Least change of sensitivity that counts."""
PASSED = 0.2
"""Share of a jump beyond which a window is not of the sensitivity before."""
EARLIER = 0.9
"""Share of its duration that the earlier part needs for its sensitivity to be taken for the right one."""
MARGIN = 0.15
"""Share of a window beside a jump that may be of the other sensitivity and not show."""
LEAST_GAIN = 0.04
"""Rise of the explained share of the phases: they must come nearer to 0 or π by 8° (rms) at least …"""
OVER_NOTHING, OVER_PHASE = 1.5, 0.7
"""… and by so many times what is left unexplained; and so much more than one phase for all bands does."""
EXPLAINED = 0.75
"""Share of the phases a delay must explain."""
CERTAIN_RAD = {False: 1.2, True: 0.4}
"""Phase at the upper end of the band from which a delay is certain: of one channel, whose few modes may be
complex by chance as a delay would make them, and of several that agree."""
BLOCKS = 6
"""Of the bins, left out in turn: the delay must be that of all bands."""
DELAY_SIGMAS = 4.0
"""Standard deviations, by that, of the least delay believed."""
OCTAVE = 1.6
"""Upper over lower frequency of the middle 80 % of the weight, at least."""
NEAR_S, NEAR = 2.0, 0.6
"""Delays up to this, and up to this share of the longest they are sought to, are left to the phases."""
FEWEST_WINDOWS = 4
"""Of a stretch that is judged."""


@dataclass(frozen=True)
class LateClock:
    """Channels that are late by a delay that stays or grows.

    Attributes
    ----------
    rows : tuple of int
    delay_s, delay_std_s : float
        At the beginning of the record; negative if they are early.
    drift, drift_std : float
        Seconds a second by which the delay grows; 0 if it does not.
    certain : bool
        Whether no complex modes could look like it.
    """

    rows: tuple[int, ...]
    delay_s: float
    delay_std_s: float
    drift: float = 0.0
    drift_std: float = 0.0
    certain: bool = True


@dataclass(frozen=True)
class ClockJump:
    """Channels whose delay jumps by so much between two samples."""

    rows: tuple[int, ...]
    start: int
    stop: int
    by_s: float


@dataclass(frozen=True)
class GainJump:
    """Channels so many times as sensitive before ``start`` (factor[0]) or from ``stop`` on (factor[1]).

    One of the factors is 1; what lies between is not known.
    """

    rows: tuple[int, ...]
    start: int
    stop: int
    factor: tuple[float, float]


@dataclass(frozen=True)
class LoggerClocks:
    """What the phases say of the clocks.

    Attributes
    ----------
    late : tuple of LateClock
    jumps : tuple of ClockJump
    start, stop : int
        Samples of the longest stretch without a jump, for which ``late`` holds.
    judged : bool
        False if no stretch between jumps is long enough to be judged.
    gains : tuple of GainJump
        Channels whose sensitivity jumps.
    """

    late: tuple[LateClock, ...] = ()
    jumps: tuple[ClockJump, ...] = ()
    start: int = 0
    stop: int = 0
    judged: bool = True
    gains: tuple[GainJump, ...] = ()

    def of_rows(self, rows: Sequence[int]) -> LoggerClocks:
        """Return the same of channels that are these rows of a larger record."""
        return replace(
            self,
            late=tuple(replace(one, rows=tuple(rows[i] for i in one.rows)) for one in self.late),
            jumps=tuple(replace(one, rows=tuple(rows[i] for i in one.rows)) for one in self.jumps),
            gains=tuple(replace(one, rows=tuple(rows[i] for i in one.rows)) for one in self.gains),
        )


@dataclass(frozen=True)
class _Seen:
    """Phases, and which channels they hold against each other."""

    phases: Phases
    network: Network


def logger_clocks(
    y: FloatArray,
    sample_rate_hz: float,
    *,
    velocity: Sequence[bool],
    places: Sequence[object],
) -> LoggerClocks:
    """Return which channels are late, jump or drift against the others.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Vibrations of zero mean, without gaps.
    velocity : (n_channels,) bool
        Channels that are a quarter of a turn off, as velocities are.
    places : (n_channels,)
        Where each channel sits; None if it is not known.
    """
    whole = LoggerClocks(stop=y.shape[1])
    if len(y) < 2:
        return whole
    turn = np.where(np.asarray(velocity, dtype=bool), 1j, 1.0 + 0.0j)
    first_look, same_place = phases(y, sample_rate_hz, turn), ties(places)
    if first_look is None:
        return whole
    far = _long_delays(y, sample_rate_hz, first_look, same_place)
    near = phases(_moved(y, far, sample_rate_hz), sample_rate_hz, turn) if far.any() else first_look
    seen = _seen(near, len(y), same_place)
    if seen is None:
        return whole
    length = y.shape[1] // len(seen.phases.coherency)
    window_s = length / sample_rate_hz
    weight, series = _series(seen)
    whole = replace(whole, gains=_gain_jumps(seen, weight, length))
    between = runs(series, seen.network.reach_s)
    jumps = tuple(
        ClockJump(
            step.rows,
            max(step.before - 1, 0) * length,
            min(step.after + 1, len(series)) * length,
            float(np.median(step.by[list(step.rows)])),
        )
        for step in steps(series, between, seen.network.reach_s)
    )
    first, last = max(between, key=lambda run: run[1] - run[0]) if jumps else (0, len(series))
    if last - first < FEWEST_WINDOWS:
        return replace(whole, jumps=jumps, judged=False)
    start, stop = (first * length, last * length) if jumps else (0, y.shape[1])
    stop = y.shape[1] if last == len(series) else stop
    slope, slope_std = _drifts(series[first:last], seen)
    model = slope * (np.arange(first, last) - first)[:, None]
    within = replace(seen.phases, coherency=seen.phases.coherency[first:last])
    still = replace(seen, phases=aligned(within, model))
    late = _late(still, far, (slope / window_s, slope_std / window_s), (first + 0.5) * window_s)
    return replace(whole, late=late, jumps=jumps, start=start, stop=stop)


def _long_delays(y: FloatArray, sample_rate_hz: float, seen: Phases, same_place: IntArray) -> FloatArray:
    """Return delays too long for phases to show, in whole samples [s], (n_channels,)."""
    near_s = min(NEAR_S, NEAR * float(seen.search_s[-1]))
    explained = objective(seen, doubled(seen), seen.search_s).max(axis=0)
    unknown = (seen.total <= LEAST_WEIGHT) | (explained < EXPLAINED * seen.total)
    delay, weight = np.zeros(len(seen.pairs)), np.where(unknown, 0.0, seen.total)
    delay[unknown], weight[unknown] = long_delays(y, sample_rate_hz, seen.pairs[unknown], near_s)
    if not delay.any():
        return np.zeros(len(y))
    network = Network(len(y), seen.pairs, weight > 0.0, same_place, near_s)
    each = against_main(network, per_channel(network, delay, weight)[None, :])[0]
    for group in without_gaps(each, 0.5 * near_s):
        each[group] = np.round(np.median(each[group]) * sample_rate_hz) / sample_rate_hz
    return np.where(np.abs(each) < near_s, 0.0, each)


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


def _series(seen: _Seen) -> tuple[FloatArray, FloatArray]:
    """Return the weights of the pairs and how much later each channel is than in the first window.

    Returns
    -------
    weight : (n_windows, n_pairs)
    delay_s : (n_windows, n_channels)
    """
    delay, explained = trajectories(seen.phases)
    weight = np.where(seen.network.informative & (explained > MOSTLY_DELAY), seen.phases.total, 0.0)
    return weight, _by_channel(seen.network, delay, weight)


def _by_channel(network: Network, of_pairs: FloatArray, weight: FloatArray) -> FloatArray:
    """Return what each channel does against the main group in every window, (n_windows, n_channels)."""
    each = np.array([per_channel(network, d, w) for d, w in zip(of_pairs, weight, strict=True)])
    time = np.arange(len(each))
    for i in range(network.n):
        # a channel that was silent, or shook by itself, kept its clock
        told = weight[:, (network.pairs == i).any(axis=1)].any(axis=1)
        if told.any():
            each[:, i] = np.interp(time, time[told], each[told, i])
    return against_main(network, each)


def _gain_jumps(seen: _Seen, weight: FloatArray, length: int) -> tuple[GainJump, ...]:
    """Return the channels whose sensitivity against the others jumps once, those that jump alike together."""
    network = replace(seen.network, reach_s=float(np.log(LEAST_FACTOR)))
    series = _by_channel(network, gain_trajectories(seen.phases), weight)
    found = steps(series, runs(series, network.reach_s), network.reach_s)
    if len(found) != 1:
        return ()
    step = found[0]
    jumping = list(step.rows)
    level = np.median(series[: step.before, jumping], axis=0)
    passed = np.median((series[:, jumping] - level) / step.by[jumping], axis=1)
    before = int(np.argmax(passed > PASSED))
    after = len(series) - int(np.argmax(passed[::-1] < 1.0 - PASSED))
    out = []
    for group in without_gaps(step.by[jumping], 0.5 * network.reach_s):
        rows = [step.rows[i] for i in group]
        by = float(np.exp(np.mean(step.by[rows])))
        others = [i for i in range(len(step.by)) if i not in step.rows]
        if _is_others(seen.phases.log_amplitude, rows, others, before, after):
            rows, by = others, 1.0 / by
        start, stop = int((before - MARGIN) * length), int((after + MARGIN) * length)
        later = start + stop >= EARLIER * length * len(series)
        out.append(GainJump(tuple(rows), start, stop, (1.0, by) if later else (1.0 / by, 1.0)))
    return tuple(out)


def _is_others(
    log_amplitude: FloatArray, rows: list[int], others: list[int], before: int, after: int
) -> bool:
    """Tell whether the others are what changes: of two halves, those whose own amplitudes jump more."""
    if len(others) > len(rows) or not others:
        return False
    own = np.median(log_amplitude[after:].mean(axis=0) - log_amplitude[:before].mean(axis=0), axis=0)
    return bool(np.abs(own[others]).mean() > np.abs(own[rows]).mean())


def _drifts(series: FloatArray, seen: _Seen) -> tuple[FloatArray, FloatArray]:
    """Return the slope of each channel [s a window], 0 for the main group's, and its deviation.

    Channels whose slopes are alike are of one logger and share their mean; one whose slope is hardly known
    goes with the nearest.
    """
    n = len(series)
    slope, rest = lines(series)
    power = float(np.sum((np.arange(n) - 0.5 * (n - 1)) ** 2))
    std = np.maximum(scatter(series), rest.std(axis=0)) / np.sqrt(power)
    least = DRIFT_RAD / REACH_RAD * seen.network.reach_s / n
    out, spread = np.zeros(len(slope)), np.zeros(len(slope))
    for part in joined(seen.network):
        clear = max(0.4 * least, PARTED * float(np.ptp(slope[part])))
        sharp = [i for i in part if std[i] < clear]
        if len(sharp) < 2:
            continue
        groups = [[sharp[i] for i in g] for g in without_gaps(slope[sharp], least)]
        middle = np.array([np.average(slope[g], weights=1.0 / np.maximum(std[g], 1e-9) ** 2) for g in groups])
        own = {i: int(np.argmin(np.abs(middle - slope[i]))) for i in part}
        sizes = [sorted(i for i in part if own[i] == k) for k in range(len(groups))]
        main = sizes.index(largest(sizes))
        known = np.array([1.0 / np.sqrt(np.sum(1.0 / np.maximum(std[g], 1e-9) ** 2)) for g in groups])
        for i, k in own.items():
            apart, error = middle[k] - middle[main], float(np.hypot(known[k], known[main]))
            if abs(apart) > max(least, SIGMAS * error):
                out[i], spread[i] = apart, error
    return out, spread


def _late(
    seen: _Seen, far_s: FloatArray, drift: tuple[FloatArray, FloatArray], middle_s: float
) -> tuple[LateClock, ...]:
    """Return the groups that are late by a delay that all bands and pairs agree on, or that drift.

    Parameters
    ----------
    far_s : (n_channels,)
        Delays that were taken back before.
    drift : (n_channels,), (n_channels,)
        Slopes, which were taken back as well, and their deviations.
    middle_s : float
        Time for which the delays of the phases hold.
    """
    network = seen.network
    z = doubled(seen.phases)
    search = seen.phases.search_s
    delay, value = refined_peak(search, objective(seen.phases, z, search))
    weight = np.where(network.informative, np.maximum(value, 0.0), 0.0)
    each = against_main(network, per_channel(network, delay, weight)[None, :])[0]
    main = np.flatnonzero((np.abs(each) <= network.reach_s) & (far_s == 0.0))
    found: list[LateClock] = []
    for rows in _alike(each, far_s, drift[0], network.reach_s):
        before, grows = float(far_s[rows[0]]), float(drift[0][rows[0]])
        known = None if np.isin(main, rows).any() else _confirmed(seen, z, rows, main, before)
        if known is None and grows == 0.0 and before == 0.0:
            continue
        late, std, certain = known or (0.0, 0.0, True)
        late += before - grows * middle_s
        spread = float(np.max(drift[1][rows])) if grows else 0.0
        found.append(LateClock(tuple(rows), late, std, grows, spread, certain))
    return tuple(found)


def _alike(delay_s: FloatArray, far_s: FloatArray, drift: FloatArray, reach_s: float) -> list[list[int]]:
    """Return the channels of one delay and one drift."""
    out: list[list[int]] = []
    for group in without_gaps(delay_s + far_s, reach_s):
        for value in np.unique(drift[group]):
            out.append([i for i in group if drift[i] == value])
    return out


def _confirmed(
    seen: _Seen, z: ComplexArray, rows: list[int], main: IntArray, before_s: float
) -> tuple[float, float, bool] | None:
    """Return delay, deviation and certainty of a group behind the main one, None if not all bands say so."""
    i, j = seen.phases.pairs.T
    ahead = np.isin(i, rows) & np.isin(j, main) & seen.network.informative
    behind = np.isin(j, rows) & np.isin(i, main) & seen.network.informative
    if not (ahead | behind).any():
        return None
    both = z[:, ahead].sum(axis=1) + z[:, behind].sum(axis=1).conj()
    weight = seen.phases.weight[:, ahead | behind].sum(axis=1)
    search = seen.phases.search_s
    turns = np.exp(4j * np.pi * np.outer(search, seen.phases.frequency_hz))
    passed = np.cumsum(weight) / weight.sum()
    block = np.minimum((passed * BLOCKS).astype(int), BLOCKS - 1)
    columns = np.stack([both, *(np.where(block == b, 0.0, both) for b in range(BLOCKS))], axis=1)
    delay, value = refined_peak(search, np.asarray((turns @ columns).real))
    std = float(np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((delay[1:] - delay[1:].mean()) ** 2)))
    explained, before = float(value[0] / weight.sum()), float(both.real.sum() / weight.sum())
    one_phase = float(np.abs(both.sum()) / weight.sum())
    low, high = seen.phases.frequency_hz[np.searchsorted(passed, (0.1, 0.9))]
    left = 1.0 - explained
    if before_s != 0.0:
        # that the clock is another is known already
        return (float(delay[0]), std, True) if explained > EXPLAINED else None
    believed = (
        explained > EXPLAINED
        and explained - before > max(LEAST_GAIN, OVER_NOTHING * left)
        and explained - one_phase > OVER_PHASE * left
        and abs(delay[0]) > DELAY_SIGMAS * std
        and high > OCTAVE * low
    )
    certain = 2.0 * np.pi * high * abs(delay[0]) > CERTAIN_RAD[len(rows) > 1]
    return (float(delay[0]), std, bool(certain)) if believed else None
