"""Delays of single channels from those of pairs, and groups of late channels.

The largest group of channels with a common clock is taken as correct. A channel is late if its delay behind
that group is constant or drifts, as that of a logger with its own clock does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # scipy.sparse is loaded where it is used

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.records.clocks.delays import Phases, doubled, objective, refined_peak
from jackettwin.records.clocks.jumps import SIGMAS, lines, scatter
from jackettwin.records.clocks.results import LateClock

REACH_RAD = 0.25
"""Phase at the rms frequency of the pairs of the smallest delay that separates two channels;
phases of a damped structure in wind scatter by up to this."""
PLACE_WEIGHT = 1.0
"""Weight of the assumption that channels at one place share a logger; any informative pair weighs more."""
LEAST_EIGENVALUE = 1e-12
"""Eigenvalue of a network's Laplacian, over the largest, below which two parts of it are not connected."""
ROUNDS = 12
"""Iterations of the reweighted least squares that give the median of the pairs."""
SOFT_MISFIT = 0.02
"""Misfit below which all weights are equal, as a share of the smallest separating delay."""
MIN_WINDOW_PERCENT = 80.0
"""Percentage of the windows in which channels of one group agree."""


@dataclass(frozen=True)
class Network:
    """Network of channels whose delays are compared.

    Attributes
    ----------
    n : int
        Channels.
    pairs : (n_pairs, 2)
    informative : (n_pairs,) bool
        Informative pairs.
    ties : (n_ties, 2)
        Channels at one place.
    reach_s : float
        Smallest delay that separates two channels.
    """

    n: int
    pairs: IntArray
    informative: BoolArray
    ties: IntArray
    reach_s: float


def ties(places: Sequence[object]) -> IntArray:
    """Return the pairs of channels at one known place, (n_ties, 2).

    >>> ties([77.0, None, 77.0, None]).tolist()
    [[0, 2]]
    """
    same = [
        (i, j) for j, place in enumerate(places) for i in range(j) if place is not None and places[i] == place
    ]
    return np.array(same, dtype=np.intp).reshape(-1, 2)


def per_channel(network: Network, delay_s: FloatArray, weight: FloatArray) -> FloatArray:
    """Return one delay per channel from those of pairs, by weighted least absolute deviations.

    Each connected set of channels has a mean delay of zero.

    Parameters
    ----------
    delay_s, weight : (n_pairs,)
    """
    pairs = np.vstack([network.pairs, network.ties])
    target = np.append(delay_s, np.zeros(len(network.ties)))
    weight = np.append(weight, np.full(len(network.ties), PLACE_WEIGHT))
    i, j = pairs.T
    scale, out = np.asarray(np.ones(len(pairs))), np.asarray(np.zeros(network.n))
    for _ in range(ROUNDS):
        out = _balanced(i, j, weight * scale, target, network.n)
        scale = 1.0 / np.maximum(np.abs(out[i] - out[j] - target), SOFT_MISFIT * network.reach_s)
        scale = np.asarray(scale / scale.max())
    return out


def _balanced(i: IntArray, j: IntArray, weight: FloatArray, target: FloatArray, n: int) -> FloatArray:
    """Return the n values of least size whose weighted squared differences x_i − x_j from targets are least.

    By the normal equations, which are the Laplacian of the network: sixty channels have 1770 pairs.

    >>> i, j = np.array([[0, 1], [0, 2], [1, 2]]).T
    >>> _balanced(i, j, np.ones(3), np.array([1.0, 3.0, 2.0]), 4).round(12).tolist()
    [1.333333333333, 0.333333333333, -1.666666666667, 0.0]
    """
    between = np.bincount(i * n + j, weight, n * n).reshape(n, n)
    between = between + between.T
    flow = np.bincount(i, weight * target, n) - np.bincount(j, weight * target, n)
    laplacian = np.diag(between.sum(axis=1)) - between
    return np.asarray(np.linalg.lstsq(laplacian, flow, rcond=LEAST_EIGENVALUE)[0])


def by_channel(network: Network, of_pairs: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the delay of each channel behind the main group in every window, (n_windows, n_channels)."""
    each = np.array([per_channel(network, d, w) for d, w in zip(of_pairs, weight, strict=True)])
    time = np.arange(len(each))
    for i in range(network.n):
        # a channel that was missing, or moved independently, kept its clock
        informative = weight[:, (network.pairs == i).any(axis=1)].any(axis=1)
        if informative.any():
            each[:, i] = np.interp(time, time[informative], each[informative, i])
    return against_main(network, each)


def against_main(network: Network, delay_s: FloatArray) -> FloatArray:
    """Return delays behind the main group among connected channels, in every window.

    Parameters
    ----------
    delay_s : (n_windows, n_channels)
    """
    out = np.zeros_like(delay_s)
    for part in joined(network):
        own = delay_s[:, part]
        apart = np.percentile(np.abs(own[:, :, None] - own[:, None, :]), MIN_WINDOW_PERCENT, axis=0)
        main = largest(connected(apart <= network.reach_s))
        out[:, part] = own - np.median(own[:, main], axis=1, keepdims=True)
    return out


def joined(network: Network) -> list[list[int]]:
    """Return the sets of channels connected by informative pairs and common places."""
    near = np.eye(network.n, dtype=bool)
    for i, j in [*network.pairs[network.informative], *network.ties]:
        near[i, j] = near[j, i] = True
    return connected(near)


def largest(groups: list[list[int]]) -> list[int]:
    """Return the largest group; of equal ones, that of the first channel."""
    return max(groups, key=lambda g: (len(g), -min(g)))


def connected(near: BoolArray) -> list[list[int]]:
    """Return groups of channels that agree, directly or through others.

    >>> connected(np.array([[1, 0, 1], [0, 1, 0], [1, 0, 1]], dtype=bool))
    [[0, 2], [1]]
    """
    _, label = scipy.sparse.csgraph.connected_components(near, directed=False)
    return [[int(i) for i in np.flatnonzero(label == k)] for k in np.unique(label)]


def without_gaps(values: FloatArray, reach: float) -> list[list[int]]:
    """Return groups of values separated by gaps of at least ``reach``.

    >>> without_gaps(np.array([0.0, 0.2, 0.001, 0.203]), 0.02)
    [[0, 2], [1, 3]]
    """
    order = np.argsort(values, kind="stable")
    cuts = np.flatnonzero(np.diff(values[order]) > reach) + 1
    return [sorted(int(i) for i in part) for part in np.split(order, cuts)]


DRIFT_RAD = 0.1
"""The same for a drift over the whole record; changes of phase are independent of the modes."""
MIN_GAP_RATIO = 1.5
"""Ratio of the gap between the slopes of two groups to the spread within either that makes them distinct:
channels of one logger drift alike, whereas modes that alternate cause different slopes."""
MIN_DRIFT_WINDOWS = 6
"""Fewest windows for a drift; with fewer, the scatter about the line is too uncertain."""
MIN_CURVE_WINDOWS = 8
"""The same for a drift that is not a line."""
SLOPE_TOLERANCE = 0.1
"""Share of the spread of all slopes within which a precise slope is known."""
MIN_RISE = 0.04
"""Smallest rise of the explained share of the phases; they must come nearer to 0 or π by 8° (rms)."""
MIN_RISE_RATIO, MIN_RISE_OVER_PHASE = 1.5, 0.7
"""Smallest rise over what is left unexplained, and over the rise that one common phase achieves."""
MIN_EXPLAINED_SHARE = 0.75
"""Smallest share of the phases that a delay must explain."""
CERTAIN_RAD = {False: 1.2, True: 0.4}
"""Phase at the upper end of the band above which a delay is certain, for one channel (False),
whose few modes may be complex by chance, and for several that agree (True)."""
BLOCKS = 6
"""Blocks of frequency bins left out in turn, since a delay must be common to all bands."""
MIN_DELAY_SIGMAS = 4.0
"""Smallest accepted delay, in standard deviations from these blocks."""
MIN_BAND_RATIO = 1.6
"""Smallest ratio of upper to lower frequency of the middle 80 % of the weight."""


@dataclass(frozen=True)
class DelayGrowth:
    """Growth of the channels' delays over the windows; 0 for the main group.

    Attributes
    ----------
    slope, slope_std : (n_channels,)
        [s per window]
    bend, bend_std : (n_channels,)
        [s per window squared], along :func:`curve`.
    """

    slope: FloatArray
    slope_std: FloatArray
    bend: FloatArray
    bend_std: FloatArray


def growth(series: FloatArray, network: Network) -> DelayGrowth:
    """Return how the delays of channels grow, in a line and in a curve.

    Parameters
    ----------
    series : (n_windows, n_channels)
    """
    n = len(series)
    least = DRIFT_RAD / REACH_RAD * network.reach_s
    slope, rest = lines(series)
    time = np.arange(n) - 0.5 * (n - 1)
    std = np.maximum(scatter(series), rest.std(axis=0)) / np.sqrt(float(np.sum(time**2)))
    none = np.zeros(len(slope))
    if n < MIN_DRIFT_WINDOWS:
        return DelayGrowth(none, none, none, none)
    drift = _of_loggers(slope, std, network, least / n)
    if n < MIN_CURVE_WINDOWS:
        return DelayGrowth(*drift, none, none)
    over = curve(n)
    power = float(np.sum(over**2))
    bend = over @ rest / power
    left = rest - np.outer(over, bend)
    std = np.maximum(scatter(left), left.std(axis=0)) / np.sqrt(power)
    return DelayGrowth(*drift, *_of_loggers(bend, std, network, least / float(np.ptp(over))))


def curve(n: int) -> FloatArray:
    """Return the square of the time from the middle of some windows, of zero mean, (n_windows,).

    >>> curve(3).round(3).tolist()
    [0.333, -0.667, 0.333]
    """
    square = (np.arange(n) - 0.5 * (n - 1)) ** 2
    return np.asarray(square - square.mean())


def _of_loggers(
    slope: FloatArray, std: FloatArray, network: Network, least: float
) -> tuple[FloatArray, FloatArray]:
    """Return the growth of each channel, 0 for the main group and where it is below ``least``, and its std.

    Channels that grow alike belong to one logger and share their mean; one of uncertain growth joins the
    nearest group.
    """
    out, spread = np.zeros(len(slope)), np.zeros(len(slope))
    for part in joined(network):
        clear = max(0.4 * least, SLOPE_TOLERANCE * float(np.ptp(slope[part])))
        sharp = [i for i in part if std[i] < clear]
        if len(sharp) < 2:
            continue
        groups = [[sharp[i] for i in g] for g in without_gaps(slope[sharp], least)]
        middle = np.array([np.average(slope[g], weights=1.0 / np.maximum(std[g], 1e-9) ** 2) for g in groups])
        own = {i: int(np.argmin(np.abs(middle - slope[i]))) for i in part}
        sizes = [sorted(i for i in part if own[i] == k) for k in range(len(groups))]
        main = sizes.index(largest(sizes))
        spread_in = np.array([np.ptp(slope[g]) for g in groups])
        known = np.array([1.0 / np.sqrt(np.sum(1.0 / np.maximum(std[g], 1e-9) ** 2)) for g in groups])
        for i, k in own.items():
            apart, error = middle[k] - middle[main], float(np.hypot(known[k], known[main]))
            gap = np.abs(slope[groups[k]][:, None] - slope[groups[main]]).min()
            alike = gap > MIN_GAP_RATIO * max(spread_in[k], spread_in[main])
            if alike and abs(apart) > max(least, SIGMAS * error):
                out[i], spread[i] = apart, error
    return out, spread


def late_clocks(
    seen: Phases, network: Network, far_s: FloatArray, grown: DelayGrowth, begin_s: float, window_s: float
) -> tuple[LateClock, ...]:
    """Return the groups that drift, or are late by a delay consistent over all bands and pairs.

    Parameters
    ----------
    far_s : (n_channels,)
        Delays already corrected.
    grown : DelayGrowth
        Also already corrected, relative to the first window.
    begin_s, window_s : float
        Beginning of the first window, and length of each.
    """
    z = doubled(seen)
    search = seen.search_s
    delay, value = refined_peak(search, objective(seen, z, search))
    weight = np.where(network.informative, np.maximum(value, 0.0), 0.0)
    each = against_main(network, per_channel(network, delay, weight)[None, :])[0]
    main = np.flatnonzero((np.abs(each) <= network.reach_s) & (far_s == 0.0))
    n = len(seen.coherency)
    first_s, middle_s = begin_s + 0.5 * window_s, begin_s + 0.5 * n * window_s
    found: list[LateClock] = []
    for rows in _alike(each, far_s, grown, network.reach_s):
        before, first = float(far_s[rows[0]]), rows[0]
        slope, bend = float(grown.slope[first]) / window_s, float(grown.bend[first]) / window_s**2
        grows = slope != 0.0 or bend != 0.0
        known = None if np.isin(main, rows).any() else _confirmed(seen, network, z, rows, main, before)
        if known is None and not grows and before == 0.0:
            continue
        late, std, certain = known or (0.0, 0.0, True)
        late += before - slope * first_s + bend * (middle_s**2 - (first_s - middle_s) ** 2)
        spread = float(np.max(grown.slope_std[rows])) / window_s if grows else 0.0
        found.append(LateClock(tuple(rows), late, std, slope - 2.0 * bend * middle_s, spread, certain, bend))
    return tuple(found)


def _alike(delay_s: FloatArray, far_s: FloatArray, grown: DelayGrowth, reach_s: float) -> list[list[int]]:
    """Return groups of channels of equal delay and growth."""
    out: list[list[int]] = []
    both = np.column_stack([grown.slope, grown.bend])
    for group in without_gaps(delay_s + far_s, reach_s):
        for value in np.unique(both[group], axis=0):
            out.append([i for i in group if np.array_equal(both[i], value)])
    return out


def _confirmed(
    seen: Phases, network: Network, z: ComplexArray, rows: list[int], main: IntArray, before_s: float
) -> tuple[float, float, bool] | None:
    """Return delay, standard deviation and certainty of a group, None if not all bands agree."""
    i, j = seen.pairs.T
    ahead = np.isin(i, rows) & np.isin(j, main) & network.informative
    behind = np.isin(j, rows) & np.isin(i, main) & network.informative
    if not (ahead | behind).any():
        return None
    both = z[:, ahead].sum(axis=1) + z[:, behind].sum(axis=1).conj()
    weight = seen.weight[:, ahead | behind].sum(axis=1)
    search = seen.search_s
    turns = np.exp(4j * np.pi * np.outer(search, seen.frequency_hz))
    passed = np.cumsum(weight) / weight.sum()
    block = np.minimum((passed * BLOCKS).astype(int), BLOCKS - 1)
    columns = np.stack([both, *(np.where(block == b, 0.0, both) for b in range(BLOCKS))], axis=1)
    delay, value = refined_peak(search, np.asarray((turns @ columns).real))
    std = float(np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((delay[1:] - delay[1:].mean()) ** 2)))
    explained, before = float(value[0] / weight.sum()), float(both.real.sum() / weight.sum())
    one_phase = float(np.abs(both.sum()) / weight.sum())
    low, high = seen.frequency_hz[np.searchsorted(passed, (0.1, 0.9))]
    left = 1.0 - explained
    if before_s != 0.0:
        # the drift has shown already that the clock is another
        return (float(delay[0]), std, True) if explained > MIN_EXPLAINED_SHARE else None
    believed = (
        explained > MIN_EXPLAINED_SHARE
        and explained - before > max(MIN_RISE, MIN_RISE_RATIO * left)
        and explained - one_phase > MIN_RISE_OVER_PHASE * left
        and abs(delay[0]) > MIN_DELAY_SIGMAS * std
        and high > MIN_BAND_RATIO * low
    )
    certain = 2.0 * np.pi * high * abs(delay[0]) > CERTAIN_RAD[len(rows) > 1]
    return (float(delay[0]), std, bool(certain)) if believed else None
