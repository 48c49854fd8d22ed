"""Detection of channels recorded at another time than the others, or stored backwards.

Sensors on one structure are coherent at some delay (``delays.long_delays``, whatever their spectra).
Channels with the same spectral peaks as the others but without coherence were not recorded together with
them, unless they measure another direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.sparse is loaded where it is used

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.records.clocks.channel_delays import connected
from jackettwin.records.clocks.delays import BandLines, Phases, band_lines, long_delays
from jackettwin.records.clocks.results import Strangers

if TYPE_CHECKING:
    from jackettwin.records.record import Channel

MIN_COHERENCE_SUM = 75.0
"""Sum of ``long_delays`` above which two channels are coherent. That of independent channels exceeds a gamma
variable, since neighbouring lines of a Hann window are correlated; it reaches 50."""
DECISIVE_FACTOR = 3.0
"""Factor on that sum which a questionable channel, or the one most like it, must reach with some other
channel for a decision: in a calm, only one mode may exceed the noise at some sensors."""
ALL_DELAYS = 0.45
"""Largest delay that is searched, as a share of the record."""
MIN_PARALLEL_COSINE = 0.5
"""Cosine of the angle between channels below which they need not be coherent."""
MIN_SPECTRAL_CORRELATION = 0.5
"""Correlation of the logarithms of two spectra, without their polynomial trend,
above which their peaks agree; noise beside modes reaches 0.3."""
DIRECTIONS = 3
"""Most groups of channels that are incoherent because they measure different directions."""
TREND_DEGREE = 3
"""Degree of the polynomial trend of a logarithmic spectrum."""


def spanning_pairs(seen: Phases) -> IntArray:
    """Return the spanning tree of channel pairs with the largest coherence, (n_channels − 1, 2)."""
    n = int(seen.pairs.max()) + 1
    cost = np.zeros((n, n))
    # the tree of least cost; a cost of zero would be no edge
    cost[seen.pairs[:, 0], seen.pairs[:, 1]] = 1.0 / (1.0 + seen.total)
    return np.asarray(
        np.stack(scipy.sparse.csgraph.minimum_spanning_tree(cost).nonzero(), axis=1), dtype=np.intp
    )


def channel_axes(channels: Sequence[Channel]) -> FloatArray:
    """Return the directions of channels, (n, 5), zeros where unknown: x, y, z, and x, y of the nacelle.

    The nacelle's horizontal axes are two of their own: at which angle they stand to the others is not known.

    >>> from jackettwin.records.record import Channel
    >>> channel_axes([Channel("a", direction=(0, 1, 0), frame="nacelle")]).tolist()
    [[0.0, 0.0, 0.0, 0.0, 1.0]]
    """
    out = np.zeros((len(channels), 5))
    for row, channel in zip(out, channels, strict=True):
        x, y, row[2] = channel.direction
        row[[3, 4] if channel.frame == "nacelle" else [0, 1]] = x, y
    return out


def comparable_channels(directions: FloatArray) -> BoolArray:
    """Return which channels must be coherent, (n, n): those not known to be perpendicular.

    >>> comparable_channels(np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])).astype(int).tolist()
    [[1, 0, 1], [0, 1, 1], [1, 1, 1]]
    """
    known = np.any(directions != 0.0, axis=1)
    return np.asarray((np.abs(directions @ directions.T) > MIN_PARALLEL_COSINE) | ~np.outer(known, known))


def strangers(
    y: FloatArray,
    sample_rate_hz: float,
    seen: Phases,
    tree: IntArray,
    directions: FloatArray,
    places: Sequence[object],
) -> tuple[Strangers, ...]:
    """Return channels that resemble the others but are not coherent with most of them.

    Where each shares its place with one of the others, or no place is known and they are not few, no two of
    them are stated to be parallel, and there are no more groups than directions in space, they may as well
    measure across. Channels along both horizontal axes of one frame see what those of another frame see.

    Parameters
    ----------
    y : (n_channels, n_samples)
    tree : (n_channels − 1, 2)
        Pairs that connect all channels.
    directions : (n_channels, 5)
        From ``channel_axes``.
    places : (n_channels,)
        Place of each channel, None if unknown.
    """
    whole = band_lines(y, sample_rate_hz)
    common = _common([whole], tree)
    if np.all(common > MIN_COHERENCE_SUM):
        return ()
    halves = _halves(y, sample_rate_hz)
    looks, common = [whole, *halves], np.maximum(common, _common(halves, tree))
    reached = np.zeros(len(y))
    np.maximum.at(reached, tree, common[:, None])
    if reached.max(initial=0.0) < DECISIVE_FACTOR * MIN_COHERENCE_SUM:
        return ()
    groups = sorted(
        _groups(looks, len(y), tree[common > MIN_COHERENCE_SUM]), key=lambda rows: (-len(rows), rows)
    )
    alike, stated = _alike(seen), np.asarray(directions.any(axis=1))
    compared = comparable_channels(directions) | _between_frames(directions, groups)
    out: list[Strangers] = []
    for k, rows in enumerate(groups):
        larger = [i for group in groups[:k] for i in group]
        pairs = np.array([(i, j) for i in larger for j in rows if compared[i, j]], dtype=np.intp)
        if not len(pairs):
            continue
        likest, _ = nearest = pairs[np.argmax(alike[pairs[:, 0], pairs[:, 1]])]
        if (
            alike[tuple(nearest)] < MIN_SPECTRAL_CORRELATION
            or reached[[likest, *rows]].max() < DECISIVE_FACTOR * MIN_COHERENCE_SUM
        ):
            continue
        both = np.concatenate([y, y[:, ::-1]])
        turned = [band_lines(both, sample_rate_hz), *_halves(both, sample_rate_hz)]
        backwards = _common(turned, np.asarray(pairs + [0, len(y)], dtype=np.intp))
        turns = bool(np.any(backwards > MIN_COHERENCE_SUM))
        parallel = pairs[stated[pairs].all(axis=1)]
        theirs, own = {places[i] for i in larger} - {None}, {places[j] for j in rows}
        # of channels without places, two at each would be half of them
        beside = 2 * len(rows) >= len(groups[0]) if own == {None} else theirs.issuperset(own)
        blamed = (
            turns
            or not beside
            or len(groups) > DIRECTIONS
            or bool(np.any(alike[parallel[:, 0], parallel[:, 1]] >= MIN_SPECTRAL_CORRELATION))
        )
        out.append(Strangers(tuple(rows), turns, len(rows) < len(groups[0]), not blamed))
    return tuple(out)


def _between_frames(directions: FloatArray, groups: Sequence[Sequence[int]]) -> BoolArray:
    """Return which channels of fixed frame and nacelle must be coherent although their angle is unknown.

    They must where groups of one frame alone measure along both of its horizontal axes.
    """
    fixed, turning = (np.asarray(directions[:, axes].any(axis=1)) for axes in ([0, 1], [3, 4]))
    out = np.zeros((len(directions), len(directions)), dtype=bool)
    for axes, own, others in (([0, 1], fixed, turning), ([3, 4], turning, fixed)):
        alone = [i for rows in groups if not others[list(rows)].any() for i in rows if own[i]]
        if np.linalg.matrix_rank(directions[np.ix_(alone, axes)]) == len(axes):
            out |= np.outer(own, others) | np.outer(others, own)
    return out


def _halves(y: FloatArray, sample_rate_hz: float) -> list[BandLines | None]:
    """Return the lines of the halves of the record.

    A sign reversal in the middle destroys the coherence over the whole record.
    """
    half = y.shape[1] // 2
    return [band_lines(part, sample_rate_hz) for part in (y[:, :half], y[:, half:])]


def _common(looks: Sequence[BandLines | None], pairs: IntArray) -> FloatArray:
    """Return the coherence sums of pairs, the larger of those of the whole record and its halves."""
    return np.asarray(np.max([long_delays(look, pairs, 0.0, ALL_DELAYS)[1] for look in looks], axis=0))


def _groups(looks: Sequence[BandLines | None], n: int, joined: IntArray) -> list[list[int]]:
    """Return the groups of channels that are coherent, directly or through others."""
    near = np.eye(n, dtype=bool)
    near[joined[:, 0], joined[:, 1]] = near[joined[:, 1], joined[:, 0]] = True
    groups = connected(near)
    if len(groups) > 1:
        group = np.empty(n, dtype=int)
        for k, rows in enumerate(groups):
            group[rows] = k
        apart = np.array([(i, j) for j in range(n) for i in range(j) if group[i] != group[j]], dtype=np.intp)
        for i, j in apart[_common(looks, apart) > MIN_COHERENCE_SUM]:
            near[i, j] = near[j, i] = True
        groups = connected(near)
    return groups


def _alike(seen: Phases) -> FloatArray:
    """Return the correlation of the spectral peaks of channels, (n_channels, n_channels)."""
    level = seen.log_amplitude.mean(axis=0)
    powers = np.vander(np.linspace(-1.0, 1.0, len(level)), TREND_DEGREE + 1)
    rest = level - powers @ np.linalg.lstsq(powers, level, rcond=None)[0]
    size = np.linalg.norm(rest, axis=0)
    rest = rest / np.where(size > 0.0, size, 1.0)
    return np.asarray(rest.T @ rest)
