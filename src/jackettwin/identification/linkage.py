"""Average-linkage clustering."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray, Int64Array


def average_linkage(apart: FloatArray, farthest: float) -> list[Int64Array]:
    """Return clusters, merged while the average distance between two of them is within the limit.

    Two clusters that are each other's nearest can be merged at once, whatever the others:
    average linkage never brings a third one closer than either was (Murtagh 1983).
    All such pairs are therefore merged together.

    Parameters
    ----------
    apart : (n, n) distances; asymmetry and negative values by rounding are corrected

    Examples
    --------
    >>> at = np.array([0.0, 5.0, 0.1, 5.3, 9.0])
    >>> [group.tolist() for group in average_linkage(np.abs(np.subtract.outer(at, at)), 1.0)]
    [[0, 2], [1, 3], [4]]
    """
    apart = np.maximum(0.5 * (apart + apart.T), 0.0)
    size = np.ones(len(apart))
    label = np.arange(len(apart))
    while True:
        np.fill_diagonal(apart, np.inf)
        own, nearest = np.arange(len(apart)), apart.argmin(axis=1)
        joined = (nearest[nearest] == own) & (own < nearest) & (apart[own, nearest] <= farthest)
        if not joined.any():
            return [np.flatnonzero(label == k) for k in np.unique(label)]
        first, second = own[joined], nearest[joined]
        share = size[second] / (size[first] + size[second])
        np.fill_diagonal(apart, 0.0)
        for _ in range(2):  # rows, then columns
            apart[first] += share[:, None] * (apart[second] - apart[first])
            apart = apart.T
        size[first] += size[second]
        stays = np.ones(len(apart), dtype=np.bool_)
        stays[second] = False
        place = np.cumsum(stays) - 1
        place[second] = place[first]
        label = place[label]
        apart, size = apart[np.ix_(stays, stays)], size[stays]
