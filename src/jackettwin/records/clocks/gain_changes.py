"""Channels whose sensitivity or sign changes against the others' while a record runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.records.clocks.channel_delays import Network, by_channel, without_gaps
from jackettwin.records.clocks.delays import Phases, gain_trajectories
from jackettwin.records.clocks.jumps import SIGMAS, lines, runs, series_jumps
from jackettwin.records.clocks.results import GainJump, GrowingGain

LEAST_FACTOR = 1.15
"""Least change of sensitivity that counts."""
PASSED = 0.2
"""Share of a jump beyond which a window is not of the sensitivity before."""
EARLIER = 0.9
"""Share of its duration that the earlier part needs for its sensitivity to be taken for the right one."""
MARGIN = 0.15
"""Share of a window beside a jump that may be of the other sensitivity and not show."""
FEWEST_TOLD = 2
"""Windows on either side of a jump that tell of the channel: one may be half of a gap."""
LEAST_GROWTH = 1.25
"""Least growth of a sensitivity over the record that counts."""
FEWEST_TURNED = 0.1
"""Share of the windows on either side of a turn of a sign, at least …"""
CONSISTENT = 0.9
"""… and the share of the windows that must agree with it."""
ONE_TURN = 0.1
"""Share of the windows within which pairs tell the same turn."""


def gain_changes(
    seen: Phases, network: Network, weight: FloatArray, length: int
) -> tuple[tuple[GainJump, ...], tuple[GrowingGain, ...]]:
    """Return the channels whose sensitivity against the others jumps once, and those in which it grows."""
    network = replace(network, reach_s=float(np.log(LEAST_FACTOR)))
    series = by_channel(network, gain_trajectories(seen), weight)
    told = np.array(
        [(weight[:, (network.pairs == i).any(axis=1)] > 0.0).any(axis=1) for i in range(network.n)]
    )
    jumps = _jumps(seen, network, series, told, length)
    return jumps, () if jumps else _growing(series)


def _growing(series: FloatArray) -> tuple[GrowingGain, ...]:
    """Return the channels whose sensitivity grows or falls steadily."""
    n = len(series)
    slope, rest = lines(series)
    power = float(np.sum((np.arange(n) - 0.5 * (n - 1)) ** 2))
    std = np.sqrt(np.sum(rest**2, axis=0) / (n - 2) / power)
    clear = (np.abs(n * slope) > np.log(LEAST_GROWTH)) & (np.abs(slope) > SIGMAS * std)
    return tuple(GrowingGain((int(i),), float(n * slope[i])) for i in np.flatnonzero(clear))


def _jumps(
    seen: Phases, network: Network, series: FloatArray, told: BoolArray, length: int
) -> tuple[GainJump, ...]:
    """Return the channels whose sensitivity against the others jumps once, those that jump alike together.

    Parameters
    ----------
    told : (n_channels, n_windows)
        Which windows tell of a channel; others are filled from those beside them.
    """
    found = series_jumps(series, runs(series, network.reach_s), network.reach_s)
    if len(found) != 1:
        return ()
    jump = found[0]
    sides = told[:, : jump.before].sum(axis=1), told[:, jump.after :].sum(axis=1)
    jumping = [i for i in jump.rows if min(side[i] for side in sides) >= FEWEST_TOLD]
    if not jumping:
        return ()
    jump = replace(jump, rows=tuple(jumping))
    level = np.median(series[: jump.before, jumping], axis=0)
    passed = np.median((series[:, jumping] - level) / jump.by[jumping], axis=1)
    before = int(np.argmax(passed > PASSED))
    after = len(series) - int(np.argmax(passed[::-1] < 1.0 - PASSED))
    out = []
    for group in without_gaps(jump.by[jumping], 0.5 * network.reach_s):
        rows = [jump.rows[i] for i in group]
        by = float(np.exp(np.mean(jump.by[rows])))
        others = [i for i in range(len(jump.by)) if i not in jump.rows]
        if _is_others(seen.log_amplitude, rows, others, before, after):
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


def sign_turns(
    y: FloatArray, sign: FloatArray, weight: FloatArray, network: Network, length: int
) -> tuple[GainJump, ...]:
    """Return the channels that move against the others from some time on, if they did not before.

    Parameters
    ----------
    y : (n_channels, n_samples)
    sign, weight : (n_windows, n_pairs)
        Of the pairs, against the first window; weight zero where a pair says nothing.
    """
    told = np.where(weight > 0.0, sign, 0.0)
    at = np.array([_turn(series) for series in told.T], dtype=int)
    steady = np.mean(told, axis=0) > CONSISTENT
    out: list[GainJump] = []
    reach = np.ceil(ONE_TURN * len(sign))
    # pairs tell one turn in neighbouring windows: it must not be taken back twice
    while at.any():
        k = int(np.argmax(np.bincount(at, minlength=2)[1:])) + 1
        about = (np.abs(at - k) <= reach) & (at > 0)
        rows, others = _sides(network, about, steady, weight.sum(axis=0))
        at[about] = 0
        if rows:
            start, stop = _located(y, rows, others, k, length)
            later = start + stop >= EARLIER * y.shape[1]
            out.append(GainJump(tuple(rows), start, stop, (1.0, -1.0) if later else (-1.0, 1.0)))
    return tuple(out)


def _sides(
    network: Network, turned: BoolArray, steady: BoolArray, weight: FloatArray
) -> tuple[list[int], list[int]]:
    """Return the channels that turn, and those they turn against, the more; empty if the pairs disagree."""
    matrix = np.zeros((network.n, network.n))
    i, j = network.pairs.T
    matrix[i, j] = np.where(turned, -weight, np.where(steady, weight, 0.0))
    matrix += matrix.T
    side = np.zeros(network.n)
    side[int(np.argmax(np.abs(matrix * (matrix < 0.0)).sum(axis=1)))] = 1.0
    for _ in range(network.n):
        side = np.where(side != 0.0, side, np.sign(matrix @ side))
    agree = float(np.sum(matrix * np.outer(side, side)))
    if agree < CONSISTENT * float(np.abs(matrix[np.ix_(side != 0.0, side != 0.0)]).sum()):
        return [], []
    one, other = ([int(c) for c in np.flatnonzero(side == s)] for s in (-1.0, 1.0))
    return (one, other) if len(one) <= len(other) else (other, one)


def _turn(sign: FloatArray) -> int:
    """Return the window from which the sign of a pair is turned, 0 if it is not; windows of 0 do not tell.

    >>> _turn(np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])), _turn(np.ones(6))
    (3, 0)
    """
    n = len(sign)
    least = int(np.ceil(FEWEST_TURNED * n))
    fits = {k: float(sign[:k].sum() - sign[k:].sum()) / n for k in range(least, n - least + 1)}
    best = max(fits, key=lambda k: fits[k], default=0)
    return best if best and fits[best] >= 2.0 * CONSISTENT - 1.0 and sign[best:].mean() < 0.0 else 0


def _located(y: FloatArray, rows: list[int], others: list[int], window: int, length: int) -> tuple[int, int]:
    """Return the samples between which the sign turns: where the product with what is predicted turns."""
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
