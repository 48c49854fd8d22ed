"""Channels of another time than the others: of another day, or stored backwards.

Sensors on one structure have something in common at some delay (``delays.long_delays``, whatever their
spectra are). Channels that show the peaks of the others and have nothing in common with them were not taken
together, unless they measure another direction.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # scipy.sparse is loaded where it is used

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.records.clocks.channel_delays import connected
from jackettwin.records.clocks.delays import BandLines, Phases, band_lines, long_delays
from jackettwin.records.clocks.results import Strangers

COMMON = 75.0
"""Sum of ``long_delays`` from which two channels have something in common: that of independent ones is larger
than a gamma variable's, as neighbouring lines behind a Hann window are not independent; it reaches 50."""
TELLING = 3.0
"""So many times that must a channel in question, or the one most like it, reach with some other, else nobody
can tell: in a calm, one mode alone stands out of the noise at some sensors."""
ALL_DELAYS = 0.45
"""Share of the record up to which anything in common is sought."""
CROSSWISE = 0.5
"""Cosine of the angle between channels below which they may have nothing in common."""
ALIKE = 0.5
"""Correlation of the logarithms of two spectra, less their slope and bow, from which they have peaks alike:
noise beside modes reaches 0.3."""
BOW = 3
"""Degree of the polynomial that is the slope and bow of a spectrum."""


def spanning_pairs(seen: Phases) -> IntArray:
    """Return the pairs that join all channels and have most in common, (n_channels − 1, 2)."""
    n = int(seen.pairs.max()) + 1
    cost = np.zeros((n, n))
    # the tree of least cost; zero would be no edge
    cost[seen.pairs[:, 0], seen.pairs[:, 1]] = 1.0 / (1.0 + seen.total)
    return np.asarray(
        np.stack(scipy.sparse.csgraph.minimum_spanning_tree(cost).nonzero(), axis=1), dtype=np.intp
    )


def may_be_compared(directions: Sequence[Sequence[float]], n: int) -> BoolArray:
    """Return which channels must have something in common, (n, n): those not known to be crosswise.

    >>> may_be_compared([[1, 0, 0], [0, 1, 0], [0, 0, 0]], 3).astype(int).tolist()
    [[1, 0, 1], [0, 1, 1], [1, 1, 1]]
    """
    if not len(directions):
        return np.ones((n, n), dtype=bool)
    d = np.asarray(directions, dtype=float)
    known = np.any(d != 0.0, axis=1)
    return np.asarray((np.abs(d @ d.T) > CROSSWISE) | ~np.outer(known, known))


def strangers(
    y: FloatArray, sample_rate_hz: float, seen: Phases, tree: IntArray, compared: BoolArray
) -> tuple[Strangers, ...]:
    """Return the channels that have nothing in common with most others, which they resemble.

    Parameters
    ----------
    y : (n_channels, n_samples)
    tree : (n_channels − 1, 2)
        Pairs that join all channels.
    compared : (n_channels, n_channels)
        Which channels must have something in common.
    """
    looks = _looks(y, sample_rate_hz)
    common = _common(looks, tree)
    reached = np.zeros(len(y))
    np.maximum.at(reached, tree, common[:, None])
    if reached.max(initial=0.0) < TELLING * COMMON:
        return ()
    groups = sorted(_groups(looks, len(y), tree[common > COMMON]), key=lambda rows: (-len(rows), rows))
    alike = _alike(seen)
    out: list[Strangers] = []
    for k, rows in enumerate(groups):
        larger = [i for group in groups[:k] for i in group]
        pairs = np.array([(i, j) for i in larger for j in rows if compared[i, j]], dtype=np.intp)
        if not len(pairs):
            continue
        likest, _ = nearest = pairs[np.argmax(alike[pairs[:, 0], pairs[:, 1]])]
        if alike[tuple(nearest)] < ALIKE or reached[[likest, *rows]].max() < TELLING * COMMON:
            continue
        turned = _looks(np.concatenate([y, y[:, ::-1]]), sample_rate_hz)
        backwards = _common(turned, np.asarray(pairs + [0, len(y)], dtype=np.intp))
        out.append(Strangers(tuple(rows), bool(np.any(backwards > COMMON)), len(rows) < len(groups[0])))
    return tuple(out)


def _looks(y: FloatArray, sample_rate_hz: float) -> list[BandLines | None]:
    """Return the lines of the record and of its halves.

    A sign that turns in the middle leaves nothing in common over the whole.
    """
    half = y.shape[1] // 2
    return [band_lines(part, sample_rate_hz) for part in (y, y[:, :half], y[:, half:])]


def _common(looks: Sequence[BandLines | None], pairs: IntArray) -> FloatArray:
    """Return how much pairs have in common, in the whole record or in half of it."""
    return np.asarray(np.max([long_delays(look, pairs, 0.0, ALL_DELAYS)[1] for look in looks], axis=0))


def _groups(looks: Sequence[BandLines | None], n: int, joined: IntArray) -> list[list[int]]:
    """Return the groups of channels that have something in common, directly or through others."""
    near = np.eye(n, dtype=bool)
    near[joined[:, 0], joined[:, 1]] = near[joined[:, 1], joined[:, 0]] = True
    groups = connected(near)
    if len(groups) > 1:
        group = np.empty(n, dtype=int)
        for k, rows in enumerate(groups):
            group[rows] = k
        apart = np.array([(i, j) for j in range(n) for i in range(j) if group[i] != group[j]], dtype=np.intp)
        for i, j in apart[_common(looks, apart) > COMMON]:
            near[i, j] = near[j, i] = True
        groups = connected(near)
    return groups


def _alike(seen: Phases) -> FloatArray:
    """Return how alike the peaks of the channels' spectra are, (n_channels, n_channels)."""
    level = seen.log_amplitude.mean(axis=0)
    powers = np.vander(np.linspace(-1.0, 1.0, len(level)), BOW + 1)
    rest = level - powers @ np.linalg.lstsq(powers, level, rcond=None)[0]
    size = np.linalg.norm(rest, axis=0)
    rest = rest / np.where(size > 0.0, size, 1.0)
    return np.asarray(rest.T @ rest)
