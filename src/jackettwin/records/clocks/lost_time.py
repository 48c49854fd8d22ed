r"""Seconds that a logger lost: found where the phases between two groups of channels part, and given back.

As long as clocks run, the phases of a pair of channels go on from one stretch of time to the next, but for a
short delay. Where a logger loses seconds, those between its channels and the others' part for good, and no
short delay explains them, while those within either group go on. How much was lost is where both groups have
most in common afterwards (``delays.in_common``), and it is believed if, moved by it, the phases go on again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.records.clocks.channel_delays import TIE, largest
from jackettwin.records.clocks.correction import rejoined
from jackettwin.records.clocks.delays import Phases, band_lines, in_common, phases, trajectories
from jackettwin.records.clocks.results import LostTime

GO_ON = 0.75
"""Share of the phases of two groups that short delays explain while their clocks go on."""
FALL = 0.15
"""By so much less do they explain from a loss on; in none of forty sound records of random systems did it."""
TELLS = 10.0
"""Sum of the weights of a pair that tells by itself."""
FEWEST_AFTER, LEAST_AFTER = 2, 0.12
"""Windows, and share of them, on either side of the loss."""
SILENT = 0.7
"""Logarithm of the amplitude by which a channel in which samples are missing falls at least."""
LONGEST = 0.4
"""Share of the shorter side up to which a loss is sought."""
TRIED = 6
"""Losses tried, those first after which most is in common."""
MOST_PAIRS = 20
"""Between the groups, those that tell most."""
MARGIN = 0.1
"""Share of a window beside a loss that is declared missing."""


@dataclass(frozen=True)
class _Parting:
    """Channels that part from the others in a window."""

    rows: tuple[int, ...]
    others: tuple[int, ...]
    window: int


def lost_time(
    y: FloatArray, sample_rate_hz: float, seen: Phases, same_place: IntArray
) -> tuple[LostTime | None, bool]:
    """Return the seconds that a group of channels lost, None if none or if nobody can say how many.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Without gaps.
    same_place : (n_ties, 2)
        Channels at one place share a logger, unless they tell otherwise.

    Returns
    -------
    lost : LostTime or None
    parted : bool
        Whether the clocks of two groups part at all.
    """
    parting = _parting(seen, same_place)
    if parting is None:
        return None, False
    length = y.shape[1] // len(seen.coherency)
    best: LostTime | None = None
    go_on, least = GO_ON, seen.search_s[-1] * sample_rate_hz
    for samples in _likely(y, sample_rate_hz, seen, parting, length):
        tried = _tried(y, sample_rate_hz, parting, samples, length)
        if tried is not None and tried[1] > go_on and abs(tried[0].samples) > least:
            best, go_on = tried
    # one channel that parts and is nowhere found again may have fallen silent
    return best, best is not None or len(parting.rows) > 1


def _parting(seen: Phases, same_place: IntArray) -> _Parting | None:
    """Return where the phases between a group and the largest one part, if they do."""
    explained = _where_both_speak(seen, trajectories(seen)[1])
    fewest = max(FEWEST_AFTER, int(np.ceil(LEAST_AFTER * len(explained))))
    windows = range(fewest, len(explained) - fewest + 1)
    if not windows:
        return None
    told = {k: np.where(_before(explained, k) > GO_ON, seen.total, 0.0) for k in windows}
    fall = {k: _before(explained, k) - explained[k:].mean(axis=0) for k in windows}
    k = max(windows, key=lambda k: float(told[k] @ np.maximum(fall[k], 0.0)))
    weight = told[k]
    pairs = np.vstack([seen.pairs, same_place])
    falls = np.append(fall[k], np.zeros(len(same_place)))
    tied = np.full(len(same_place), TIE)
    # who tells little goes where it fits when the others are grouped
    groups = [[i] for i in range(int(seen.pairs.max()) + 1)]
    for least in (TELLS, 0.0):
        known = np.append(np.where(weight > least, weight, 0.0), tied)
        groups = _going_on(groups, pairs, known, falls)
    main = largest(groups)
    apart = []
    for group in (g for g in groups if g is not main):
        if np.any(weight[_between(seen.pairs, group, main)] > TELLS):
            apart.append(group)
    return _Parting(tuple(largest(apart)), tuple(main), k) if apart else None


def _going_on(
    groups: list[list[int]], pairs: IntArray, weight: FloatArray, fall: FloatArray
) -> list[list[int]]:
    """Return the groups of channels whose phases go on, joined from the best on by their mean falls."""
    member = np.zeros((len(groups), int(pairs.max()) + 1))
    for k, group in enumerate(groups):
        member[k, group] = 1.0
    w, sum_ = (_of_groups(member, pairs, of_pairs) for of_pairs in (weight, weight * fall))
    groups = list(groups)
    while len(groups) > 1:
        mean = np.where(w > 0.0, sum_ / np.where(w > 0.0, w, 1.0), np.inf)
        i, j = sorted(np.unravel_index(int(np.argmin(mean)), mean.shape))
        if mean[i, j] > FALL:
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


def _where_both_speak(seen: Phases, explained: FloatArray) -> FloatArray:
    """Return the explained shares, those of windows in which a channel is silent as of the pair's median."""
    level = seen.log_amplitude.mean(axis=1)
    speaks = level > np.median(level, axis=0) - SILENT
    both = speaks[:, seen.pairs[:, 0]] & speaks[:, seen.pairs[:, 1]]
    return np.where(both, explained, np.median(explained, axis=0))


def _before(explained: FloatArray, k: int) -> FloatArray:
    """Return how well the windows up to the one before k go on from each other."""
    return np.asarray(explained[1:k].mean(axis=0) if k > 1 else explained[0])


def _between(pairs: IntArray, one: Sequence[int], other: Sequence[int]) -> BoolArray:
    i, j = pairs.T
    return np.asarray((np.isin(i, one) & np.isin(j, other)) | (np.isin(j, one) & np.isin(i, other)))


def _likely(y: FloatArray, sample_rate_hz: float, seen: Phases, parting: _Parting, length: int) -> list[int]:
    """Return the samples that may be lost, those first after which the groups have most in common."""
    after = y[:, (parting.window + 1) * length :]
    chosen = np.flatnonzero(_between(seen.pairs, parting.rows, parting.others))
    chosen = chosen[np.argsort(-seen.total[chosen])[:MOST_PAIRS]]
    pairs = seen.pairs[chosen]
    # the second of a pair is of the group: it is ahead by what was lost
    swap = np.isin(pairs[:, 0], parting.rows)
    pairs = np.where(swap[:, None], pairs[:, ::-1], pairs)
    lines = band_lines(after, sample_rate_hz)
    if lines is None:
        return []
    delay, sums = in_common(lines, pairs)
    far = np.abs(delay) < LONGEST * lines.duration_s
    total = np.where(far, np.sum(list(sums), axis=0), 0.0)
    top = (total >= np.roll(total, 1)) & (total >= np.roll(total, -1))
    order = np.argsort(-np.where(top, total, 0.0))[:TRIED]
    return [round(float(delay[i]) * sample_rate_hz) for i in order]


def _tried(
    y: FloatArray, sample_rate_hz: float, parting: _Parting, samples: int, length: int
) -> tuple[LostTime, float] | None:
    """Return a loss of about so many samples, and how well the phases go on if it is given back."""
    for _ in range(2):
        lost = _located(y, parting, samples, length)
        moved = y.copy()
        for i in parting.rows:
            moved[i] = np.nan_to_num(rejoined(y[i], lost))
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


def _located(y: FloatArray, parting: _Parting, samples: int, length: int) -> LostTime:
    """Return where the samples are lost: up to there the group follows the others, then moved."""
    rows, others = list(parting.rows), list(parting.others)
    start, stop = max(parting.window - 2, 0) * length, min((parting.window + 2) * length, y.shape[1])
    before = y[:, : max(parting.window - 1, 1) * length]
    now, then = np.zeros(stop - start), np.zeros(stop - start)
    at = np.arange(start, stop)
    last = y.shape[1] - 1
    # afterwards, who lost nothing reads later what the other reads now
    own, theirs = np.minimum(at + max(-samples, 0), last), np.minimum(at + max(samples, 0), last)
    for i in rows:
        b = np.linalg.lstsq(before[others].T, before[i], rcond=1e-6)[0]
        size = max(float(before[i] @ before[i]), np.finfo(float).tiny)
        now += y[i, at] * (b @ y[others][:, at]) / size
        then += y[i, own] * (b @ y[others][:, theirs]) / size
    place = start + int(np.argmax(np.cumsum(now - then)))
    margin = max(int(MARGIN * length), 1)
    return LostTime(parting.rows, max(place - margin, 0), min(place + margin, y.shape[1]), samples)
