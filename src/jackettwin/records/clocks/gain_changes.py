"""Changes of sensitivity or sign of channels relative to the others during a record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.records.clocks.channel_delays import Network, by_channel, without_gaps
from jackettwin.records.clocks.delays import Phases, gain_trajectories
from jackettwin.records.clocks.jumps import SIGMAS, lines, runs, series_jumps
from jackettwin.records.clocks.results import GainJump, GrowingGain

MIN_FACTOR = 1.15
"""Smallest change of sensitivity that counts."""
JUMP_SHARE = 0.2
"""Share of a jump above which a window no longer has the previous sensitivity."""
MIN_EARLIER_SHARE = 0.9
"""Share of the record before a jump from which the earlier sensitivity is taken as correct."""
MAX_UNKNOWN_SHARE = 0.5
"""Largest share of the windows that may have neither the old nor the new sensitivity: a jump is short."""
MARGIN = 0.15
"""Share of a window next to a jump that may have the other sensitivity unnoticed."""
MIN_INFORMATIVE_WINDOWS = 2
"""Fewest informative windows of the channel on each side of a jump; one may be part of a gap."""
MIN_GROWTH = 1.25
"""Smallest growth of a sensitivity over the record that counts."""
MIN_REVERSED_SHARE = 0.1
"""Smallest share of the windows on each side of a sign change."""
MIN_CONSISTENT_SHARE = 0.9
"""Smallest share of the windows that agree with it."""
SAME_CHANGE_SHARE = 0.1
"""Share of the windows within which changes of several pairs are one change."""


def gain_changes(
    seen: Phases, network: Network, weight: FloatArray, length: int
) -> tuple[tuple[GainJump, ...], tuple[GrowingGain, ...]]:
    """Return the channels whose sensitivity against the others jumps once, and those in which it grows."""
    network = replace(network, reach_s=float(np.log(MIN_FACTOR)))
    series = by_channel(network, gain_trajectories(seen), weight)
    informative = np.array(
        [(weight[:, (network.pairs == i).any(axis=1)] > 0.0).any(axis=1) for i in range(network.n)]
    )
    jumps = _jumps(seen, network, series, informative, length)
    return jumps, () if jumps else _growing(series)


def _growing(series: FloatArray) -> tuple[GrowingGain, ...]:
    """Return the channels whose sensitivity grows or falls steadily."""
    n = len(series)
    slope, rest = lines(series)
    power = float(np.sum((np.arange(n) - 0.5 * (n - 1)) ** 2))
    std = np.sqrt(np.sum(rest**2, axis=0) / (n - 2) / power)
    clear = (np.abs(n * slope) > np.log(MIN_GROWTH)) & (np.abs(slope) > SIGMAS * std)
    return tuple(GrowingGain((int(i),), float(n * slope[i])) for i in np.flatnonzero(clear))


def _jumps(
    seen: Phases, network: Network, series: FloatArray, informative: BoolArray, length: int
) -> tuple[GainJump, ...]:
    """Return channels whose sensitivity jumps once; equal jumps are grouped.

    Parameters
    ----------
    told : (n_channels, n_windows)
        Windows that are informative for a channel; the others are interpolated.
    """
    found = series_jumps(series, runs(series, network.reach_s), network.reach_s)
    if len(found) != 1:
        return ()
    jump = found[0]
    sides = informative[:, : jump.before].sum(axis=1), informative[:, jump.after :].sum(axis=1)
    jumping = [i for i in jump.rows if min(side[i] for side in sides) >= MIN_INFORMATIVE_WINDOWS]
    if not jumping:
        return ()
    jump = replace(jump, rows=tuple(jumping))
    level = np.median(series[: jump.before, jumping], axis=0)
    passed = np.median((series[:, jumping] - level) / jump.by[jumping], axis=1)
    before = int(np.argmax(passed > JUMP_SHARE))
    after = len(series) - int(np.argmax(passed[::-1] < 1.0 - JUMP_SHARE))
    if after == len(series) or after - before > MAX_UNKNOWN_SHARE * len(series):
        return ()
    out = []
    for group in without_gaps(jump.by[jumping], 0.5 * network.reach_s):
        rows = [jump.rows[i] for i in group]
        by = float(np.exp(np.mean(jump.by[rows])))
        others = [i for i in range(len(jump.by)) if i not in jump.rows]
        if _is_others(seen.log_amplitude, rows, others, before, after):
            rows, by = others, 1.0 / by
        start, stop = int((before - MARGIN) * length), int((after + MARGIN) * length)
        later = start + stop >= MIN_EARLIER_SHARE * length * len(series)
        out.append(GainJump(tuple(rows), start, stop, (1.0, by) if later else (1.0 / by, 1.0)))
    return tuple(out)


def _is_others(
    log_amplitude: FloatArray, rows: list[int], others: list[int], before: int, after: int
) -> bool:
    """Tell whether the other channels change: of two halves, the one whose own amplitudes jump more."""
    if len(others) > len(rows) or not others:
        return False
    own = np.median(log_amplitude[after:].mean(axis=0) - log_amplitude[:before].mean(axis=0), axis=0)
    return bool(np.abs(own[others]).mean() > np.abs(own[rows]).mean())


def sign_turns(
    y: FloatArray, sign: FloatArray, weight: FloatArray, network: Network, length: int
) -> tuple[GainJump, ...]:
    """Return channels that start to move against the others during the record.

    Parameters
    ----------
    y : (n_channels, n_samples)
    sign, weight : (n_windows, n_pairs)
        Signs of the pairs relative to the first window, and their weights.
    """
    informative = np.where(weight > 0.0, sign, 0.0)
    at = np.array([_turn(series) for series in informative.T], dtype=int)
    steady = np.mean(informative, axis=0) > MIN_CONSISTENT_SHARE
    out: list[GainJump] = []
    reach = np.ceil(SAME_CHANGE_SHARE * len(sign))
    # pairs place one change in neighbouring windows; it must be corrected only once
    while at.any():
        k = int(np.argmax(np.bincount(at, minlength=2)[1:])) + 1
        about = (np.abs(at - k) <= reach) & (at > 0)
        rows, others = _sides(network, about, steady, weight.sum(axis=0))
        at[about] = 0
        if rows:
            start, stop = _located(y, rows, others, k, length)
            later = start + stop >= MIN_EARLIER_SHARE * y.shape[1]
            out.append(GainJump(tuple(rows), start, stop, (1.0, -1.0) if later else (-1.0, 1.0)))
    return tuple(out)


def _sides(
    network: Network, turned: BoolArray, steady: BoolArray, weight: FloatArray
) -> tuple[list[int], list[int]]:
    """Return the channels that reverse and the majority that does not; empty if the pairs disagree."""
    matrix = np.zeros((network.n, network.n))
    i, j = network.pairs.T
    matrix[i, j] = np.where(turned, -weight, np.where(steady, weight, 0.0))
    matrix += matrix.T
    side = np.zeros(network.n)
    side[int(np.argmax(np.abs(matrix * (matrix < 0.0)).sum(axis=1)))] = 1.0
    for _ in range(network.n):
        side = np.where(side != 0.0, side, np.sign(matrix @ side))
    agree = float(np.sum(matrix * np.outer(side, side)))
    if agree < MIN_CONSISTENT_SHARE * float(np.abs(matrix[np.ix_(side != 0.0, side != 0.0)]).sum()):
        return [], []
    one, other = ([int(c) for c in np.flatnonzero(side == s)] for s in (-1.0, 1.0))
    return (one, other) if len(one) <= len(other) else (other, one)


def _turn(sign: FloatArray) -> int:
    """Return the first window with the sign reversed, 0 if there is none; windows of 0 are ignored.

    >>> _turn(np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])), _turn(np.ones(6))
    (3, 0)
    """
    n = len(sign)
    least = int(np.ceil(MIN_REVERSED_SHARE * n))
    fits = {k: float(sign[:k].sum() - sign[k:].sum()) / n for k in range(least, n - least + 1)}
    best = max(fits, key=lambda k: fits[k], default=0)
    return best if best and fits[best] >= 2.0 * MIN_CONSISTENT_SHARE - 1.0 and sign[best:].mean() < 0.0 else 0


def _located(y: FloatArray, rows: list[int], others: list[int], window: int, length: int) -> tuple[int, int]:
    """Return the samples between which the sign reverses, from the product with the predicted samples."""
    start, stop = max(window - 2, 0) * length, min((window + 2) * length, y.shape[1])
    before = y[:, :start] if start > length else y[:, : max(window - 1, 1) * length]
    part = y[:, start:stop]
    product = np.zeros(stop - start)
    for i in rows:
        b = np.linalg.lstsq(before[others].T, before[i], rcond=1e-6)[0]
        product += part[i] * (b @ part[others]) / max(float(before[i] @ before[i]), np.finfo(float).tiny)
    at = start + int(np.argmax(np.cumsum(product)))
    margin = max(int(MARGIN * length), 1)
    return max(at - margin, 0), min(at + margin, y.shape[1])
