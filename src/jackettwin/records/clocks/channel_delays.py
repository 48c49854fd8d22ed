"""Delays of pairs brought down to one a channel, against the largest group of channels that go together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # scipy.sparse is loaded where it is used

from jackettwin.arrays import BoolArray, FloatArray, IntArray

REACH_RAD = 0.25
"""Phase, at the root mean square frequency of the pairs, of the least delay that parts two channels: those of
a damped structure in wind scatter by up to this."""
TIE = 1.0
"""Weight of the expectation that channels at one place share a logger: any pair that tells weighs more."""
ROUNDS = 12
"""Of the iteratively reweighted least squares that make the median of the pairs."""
SOFT = 0.02
"""Misfit below which all count alike, as a share of the least delay that parts two channels."""
MOST_WINDOWS = 80.0
"""Per cent of the windows in which channels of one group stay together."""


@dataclass(frozen=True)
class Network:
    """Which channels are held against each other.

    Attributes
    ----------
    n : int
        Channels.
    pairs : (n_pairs, 2)
    informative : (n_pairs,) bool
        Pairs that say anything.
    ties : (n_ties, 2)
        Channels at one place.
    reach_s : float
        Least delay that parts two channels.
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
    """Return one delay a channel from those of the pairs: least sum of weighted absolute misfits.

    Channels that nothing joins have a mean of zero each.

    Parameters
    ----------
    delay_s, weight : (n_pairs,)
    """
    pairs = np.vstack([network.pairs, network.ties])
    target = np.append(delay_s, np.zeros(len(network.ties)))
    weight = np.append(weight, np.full(len(network.ties), TIE))
    rows = np.zeros((len(pairs), network.n))
    rows[np.arange(len(pairs)), pairs[:, 0]] = 1.0
    rows[np.arange(len(pairs)), pairs[:, 1]] = -1.0
    scale, out = np.asarray(np.ones(len(pairs))), np.asarray(np.zeros(network.n))
    for _ in range(ROUNDS):
        root = np.sqrt(weight * scale)
        out = np.asarray(np.linalg.lstsq(root[:, None] * rows, root * target, rcond=1e-9)[0])
        scale = 1.0 / np.maximum(np.abs(rows @ out - target), SOFT * network.reach_s)
        scale = np.asarray(scale / scale.max())
    return out


def by_channel(network: Network, of_pairs: FloatArray, weight: FloatArray) -> FloatArray:
    """Return what each channel does against the main group in every window, (n_windows, n_channels)."""
    each = np.array([per_channel(network, d, w) for d, w in zip(of_pairs, weight, strict=True)])
    time = np.arange(len(each))
    for i in range(network.n):
        # a channel that was silent, or shook by itself, kept its clock
        told = weight[:, (network.pairs == i).any(axis=1)].any(axis=1)
        if told.any():
            each[:, i] = np.interp(time, time[told], each[told, i])
    return against_main(network, each)


def against_main(network: Network, delay_s: FloatArray) -> FloatArray:
    """Return delays against the main group among the channels that pairs join, in every window.

    Parameters
    ----------
    delay_s : (n_windows, n_channels)
    """
    out = np.zeros_like(delay_s)
    for part in joined(network):
        own = delay_s[:, part]
        apart = np.percentile(np.abs(own[:, :, None] - own[:, None, :]), MOST_WINDOWS, axis=0)
        main = largest(connected(apart <= network.reach_s))
        out[:, part] = own - np.median(own[:, main], axis=1, keepdims=True)
    return out


def joined(network: Network) -> list[list[int]]:
    """Return the sets of channels that informative pairs and common places join."""
    near = np.eye(network.n, dtype=bool)
    for i, j in [*network.pairs[network.informative], *network.ties]:
        near[i, j] = near[j, i] = True
    return connected(near)


def largest(groups: list[list[int]]) -> list[int]:
    """Return the largest group; of equal ones that of the first channel."""
    return max(groups, key=lambda g: (len(g), -min(g)))


def connected(near: BoolArray) -> list[list[int]]:
    """Return the groups of what is near to each other, directly or through others.

    >>> connected(np.array([[1, 0, 1], [0, 1, 0], [1, 0, 1]], dtype=bool))
    [[0, 2], [1]]
    """
    _, label = scipy.sparse.csgraph.connected_components(near, directed=False)
    return [[int(i) for i in np.flatnonzero(label == k)] for k in np.unique(label)]


def without_gaps(values: FloatArray, reach: float) -> list[list[int]]:
    """Return the groups of values between which there is no gap of the reach.

    >>> without_gaps(np.array([0.0, 0.2, 0.001, 0.203]), 0.02)
    [[0, 2], [1, 3]]
    """
    order = np.argsort(values, kind="stable")
    cuts = np.flatnonzero(np.diff(values[order]) > reach) + 1
    return [sorted(int(i) for i in part) for part in np.split(order, cuts)]
