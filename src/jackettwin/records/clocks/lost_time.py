r"""Time lost by a logger: detection by the phases between two groups of channels, and its amount.

While clocks run, the phases of a pair of channels continue from one window to the next except
for a short delay. If a logger loses time, the phases between its channels and the others
change for good and no short delay explains them, while those within each group continue.
The lost time is the delay of the largest coherence between the groups afterwards (``delays.in_common``),
and is accepted if the phases continue once it is corrected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.records.clocks.channel_delays import PLACE_WEIGHT, largest
from jackettwin.records.clocks.correction import with_lost_samples
from jackettwin.records.clocks.delays import Phases, band_lines, in_common, phases, trajectories
from jackettwin.records.clocks.results import LostTime

MIN_CONTINUING_SHARE = 0.75
"""Share of the phases between two groups that short delays explain while clocks run."""
MIN_STEADY_SHARE = 0.9
"""The same over the pairs between the groups for a loss of unknown amount, since the phases of close modes
along two axes fall out of step by themselves."""
MIN_FALL = 0.15
"""Smallest fall of that share after a loss; none of forty intact records of random systems had it."""
MIN_PAIR_WEIGHT = 10.0
"""Sum of weights above which a pair is informative by itself."""
MIN_SIDE_WINDOWS, MIN_SIDE_SHARE = 2, 0.12
"""Fewest windows, and smallest share of them, on each side of the loss."""
MIN_AMPLITUDE_FALL = 0.7
"""Smallest fall of the logarithmic amplitude of a channel with missing samples."""
MAX_LOSS_SHARE = 0.4
"""Longest loss, as a share of the shorter side."""
MAX_LOSSES_TRIED = 6
"""Number of losses tried, in the order of coherence after correction."""
MAX_PAIRS = 20
"""Most pairs between the groups that are used, the most informative ones."""
MARGIN = 0.1
"""Share of a window next to a loss that becomes missing."""


@dataclass(frozen=True)
class _Separation:
    """Channels that separate from the others in a window."""

    rows: tuple[int, ...]
    others: tuple[int, ...]
    window: int
    steady: bool


def lost_time(
    y: FloatArray, sample_rate_hz: float, seen: Phases, same_place: IntArray
) -> tuple[LostTime | None, bool]:
    """Return the time that a group of channels lost, None if there is no loss or its amount is unknown.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Without gaps.
    same_place : (n_ties, 2)
        Pairs of channels at one place, which share a logger unless data contradict.

    Returns
    -------
    lost : LostTime or None
    parted : bool
        Whether the clocks of two groups separate at all.
    """
    parting = _separation(seen, same_place)
    if parting is None:
        return None, False
    length = y.shape[1] // len(seen.coherency)
    best: LostTime | None = None
    go_on, least = MIN_CONTINUING_SHARE, seen.search_s[-1] * sample_rate_hz
    for samples in _likely(y, sample_rate_hz, seen, parting, length):
        tried = _tried(y, sample_rate_hz, parting, samples, length)
        if tried is not None and tried[1] > go_on and abs(tried[0].samples) > least:
            best, go_on = tried
    # a single channel that separates and is not found at another delay may have gone silent
    return best, best is not None or (len(parting.rows) > 1 and parting.steady)


def _separation(seen: Phases, same_place: IntArray) -> _Separation | None:
    """Return where the phases between a group and the largest one part, if they do."""
    explained = _with_silent_windows_filled(seen, trajectories(seen)[1])
    fewest = max(MIN_SIDE_WINDOWS, int(np.ceil(MIN_SIDE_SHARE * len(explained))))
    windows = range(fewest, len(explained) - fewest + 1)
    if not windows:
        return None
    informative = {
        k: np.where(_before(explained, k) > MIN_CONTINUING_SHARE, seen.total, 0.0) for k in windows
    }
    fall = {k: _before(explained, k) - explained[k:].mean(axis=0) for k in windows}
    k = max(windows, key=lambda k: float(informative[k] @ np.maximum(fall[k], 0.0)))
    weight = informative[k]
    pairs = np.vstack([seen.pairs, same_place])
    falls = np.append(fall[k], np.zeros(len(same_place)))
    tied = np.full(len(same_place), PLACE_WEIGHT)
    # channels of little weight join the group that fits them after the others are grouped
    groups = [[i] for i in range(int(seen.pairs.max()) + 1)]
    for least in (MIN_PAIR_WEIGHT, 0.0):
        known = np.append(np.where(weight > least, weight, 0.0), tied)
        groups = _continuing_groups(groups, pairs, known, falls)
    main = largest(groups)
    apart = []
    for group in (g for g in groups if g is not main):
        if np.any(weight[_between(seen.pairs, group, main)] > MIN_PAIR_WEIGHT):
            apart.append(group)
    if not apart:
        return None
    rows = largest(apart)
    across = _between(seen.pairs, rows, main)
    before = float(np.average(_before(explained, k)[across], weights=weight[across]))
    return _Separation(tuple(rows), tuple(main), k, before > MIN_STEADY_SHARE)


def _continuing_groups(
    groups: list[list[int]], pairs: IntArray, weight: FloatArray, fall: FloatArray
) -> list[list[int]]:
    """Return groups of channels with continuing phases, merged in the order of mean fall."""
    member = np.zeros((len(groups), int(pairs.max()) + 1))
    for k, group in enumerate(groups):
        member[k, group] = 1.0
    w, sum_ = (_of_groups(member, pairs, of_pairs) for of_pairs in (weight, weight * fall))
    groups = list(groups)
    while len(groups) > 1:
        mean = np.where(w > 0.0, sum_ / np.where(w > 0.0, w, 1.0), np.inf)
        i, j = sorted(np.unravel_index(int(np.argmin(mean)), mean.shape))
        if mean[i, j] > MIN_FALL:
            break
        groups[i] = sorted(groups[i] + groups.pop(j))
        for total in (w, sum_):
            total[i] += total[j]
            total[:, i] += total[:, j]
            total[i, i] = 0.0
        w, sum_ = (np.delete(np.delete(total, j, axis=0), j, axis=1) for total in (w, sum_))
    return groups


def _of_groups(member: FloatArray, pairs: IntArray, of_pairs: FloatArray) -> FloatArray:
    """Return sums over the pairs between groups, (n_groups, n_groups), zero within one."""
    n = member.shape[1]
    matrix = np.zeros((n, n))
    np.add.at(matrix, (pairs[:, 0], pairs[:, 1]), of_pairs)
    total = np.asarray(member @ (matrix + matrix.T) @ member.T)
    np.fill_diagonal(total, 0.0)
    return total


def _with_silent_windows_filled(seen: Phases, explained: FloatArray) -> FloatArray:
    """Return the explained shares; windows with a silent channel are given the pair's median."""
    level = seen.log_amplitude.mean(axis=1)
    speaks = level > np.median(level, axis=0) - MIN_AMPLITUDE_FALL
    both = speaks[:, seen.pairs[:, 0]] & speaks[:, seen.pairs[:, 1]]
    return np.where(both, explained, np.median(explained, axis=0))


def _before(explained: FloatArray, k: int) -> FloatArray:
    """Return how well the windows before k continue each other."""
    return np.asarray(explained[1:k].mean(axis=0) if k > 1 else explained[0])


def _between(pairs: IntArray, one: Sequence[int], other: Sequence[int]) -> BoolArray:
    i, j = pairs.T
    return np.asarray((np.isin(i, one) & np.isin(j, other)) | (np.isin(j, one) & np.isin(i, other)))


def _likely(
    y: FloatArray, sample_rate_hz: float, seen: Phases, parting: _Separation, length: int
) -> list[int]:
    """Return possible losses in samples, in the order of coherence between the groups afterwards."""
    after = y[:, (parting.window + 1) * length :]
    chosen = np.flatnonzero(_between(seen.pairs, parting.rows, parting.others))
    chosen = chosen[np.argsort(-seen.total[chosen])[:MAX_PAIRS]]
    pairs = seen.pairs[chosen]
    # the second channel of a pair is of the group: it is ahead by the loss
    swap = np.isin(pairs[:, 0], parting.rows)
    pairs = np.where(swap[:, None], pairs[:, ::-1], pairs)
    lines = band_lines(after, sample_rate_hz)
    if lines is None:
        return []
    delay, sums = in_common(lines, pairs)
    far = np.abs(delay) < MAX_LOSS_SHARE * lines.duration_s
    total = np.where(far, np.sum(list(sums), axis=0), 0.0)
    top = (total >= np.roll(total, 1)) & (total >= np.roll(total, -1))
    order = np.argsort(-np.where(top, total, 0.0))[:MAX_LOSSES_TRIED]
    return [round(float(delay[i]) * sample_rate_hz) for i in order]


def _tried(
    y: FloatArray, sample_rate_hz: float, parting: _Separation, samples: int, length: int
) -> tuple[LostTime, float] | None:
    """Return a loss near a number of samples, and how well the phases continue once it is corrected."""
    for _ in range(2):
        lost = _located(y, parting, samples, length)
        moved = y.copy()
        for i in parting.rows:
            moved[i] = np.nan_to_num(with_lost_samples(y[i], lost))
        again = phases(moved, sample_rate_hz, np.ones(len(y), dtype=complex))
        if again is None:
            return None
        delay, explained, _ = trajectories(again)
        own = _between(again.pairs, parting.rows, parting.others)
        first = min(int(np.ceil((lost.stop + abs(samples)) / moved.shape[1] * len(delay))), len(delay) - 1)
        w = again.total[own]
        if not w.any():
            return None
        goes_on = float((explained[first:, own] @ w).mean() / w.sum())
        sense = np.where(np.isin(again.pairs[own, 0], parting.rows), 1.0, -1.0)
        late = float(np.average(np.median(delay[first:, own], axis=0) * sense, weights=w))
        rest = round(late * sample_rate_hz)
        if rest == 0:
            break
        samples -= rest
    return lost, goes_on


def _located(y: FloatArray, parting: _Separation, samples: int, length: int) -> LostTime:
    """Return where samples are lost: before, the group follows the others; after, at a shift."""
    rows, others = list(parting.rows), list(parting.others)
    start, stop = max(parting.window - 2, 0) * length, min((parting.window + 2) * length, y.shape[1])
    before = y[:, : max(parting.window - 1, 1) * length]
    now, then = np.zeros(stop - start), np.zeros(stop - start)
    at = np.arange(start, stop)
    last = y.shape[1] - 1
    # afterwards, a channel without loss records later what the other records now
    own, theirs = np.minimum(at + max(-samples, 0), last), np.minimum(at + max(samples, 0), last)
    for i in rows:
        b = np.linalg.lstsq(before[others].T, before[i], rcond=1e-6)[0]
        size = max(float(before[i] @ before[i]), np.finfo(float).tiny)
        now += y[i, at] * (b @ y[others][:, at]) / size
        then += y[i, own] * (b @ y[others][:, theirs]) / size
    place = start + int(np.argmax(np.cumsum(now - then)))
    margin = max(int(MARGIN * length), 1)
    return LostTime(parting.rows, max(place - margin, 0), min(place + margin, y.shape[1]), samples)
