"""Deterministic clustering of poles that belong to one mode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray, Int64Array
from jackettwin.identification.linkage import average_linkage
from jackettwin.identification.mode_shapes import mac

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Stabilisation


SAME_FREQUENCY = 4.0
"""Distance of two clusters, in half bandwidths of the larger, within which they may be of a double mode."""
SAME_DAMPING = 4.0
"""Ratio of damping within which they may be."""
OFTEN = 0.8
"""Share of the model orders in which both members of a pair appear."""
IN_PLANE = 0.95
"""Least share of the shapes of a double mode, squared, that lies in one plane."""
ACROSS = 0.1
"""Least share along the second axis of the plane; shapes of one mode have one axis."""
DIGITS = 9
"""Decimals of the distance of a pole from the median of its group."""


@dataclass(frozen=True)
class Cluster:
    """Poles of one mode, at most one from each model order."""

    poles: Int64Array
    """Positions in the stabilisation table."""
    representative: int
    """The pole nearest to the median of frequency and damping of the core."""
    core: Int64Array
    """The half of the poles of least uncertain damping; all of them if the uncertainty is unknown."""
    order_share: float
    """Share of the model orders, from the first that contains the mode, in which it appears."""
    damping_cov: float
    """Standard deviation of ln ζ: that of the representative pole and the scatter over the core combined."""


def clusters(
    poles: Stabilisation, *, distance: float, orders: Sequence[int], scale: FloatArray, share: float = 0.5
) -> list[Cluster]:
    r"""Group poles by average-linkage clustering, frequency ascending.

    .. math:: d_{ij} = \frac{|\lambda_i-\lambda_j|}{\max(|\lambda_i|,|\lambda_j|)} + 1 - \mathrm{MAC}_{ij}

    (Reynders, Houbrechts & De Roeck 2012). Two poles of the same order are never one mode: if a group
    contains several, only the one nearest to the group's median is retained.

    Parameters
    ----------
    orders : sequence of int
        All model orders, ascending.
    scale : (n_channels,)
        Standard deviations of the channels. The MAC is computed with shapes divided by them, so that channels
        in other units or at places of little motion have the same weight.
    share : float
        Share of the model orders in which a mode appears.

    Two modes of one frequency, as symmetric structures have, share a plane of shapes: each model order has
    two poles with directions of its own in it, so that groups by shape are fragments. They become two.
    """
    n_poles = len(poles.order)
    if n_poles < 2:
        return []
    apart = _distances(poles, scale)
    found = [_cluster(poles, members, orders) for members in average_linkage(apart, distance)]
    found = _double_modes_joined(poles, found, orders, scale, share)
    return sorted(found, key=lambda c: float(poles.frequency_hz[c.representative]))


def _distances(poles: Stabilisation, scale: FloatArray) -> FloatArray:
    zeta = poles.damping_ratio
    lam = poles.frequency_hz * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    size = np.maximum.outer(np.abs(lam), np.abs(lam))
    shapes = poles.mode_shape / scale
    return np.asarray(np.abs(lam[:, None] - lam) / size + 1.0 - mac(shapes, shapes))


def _double_modes_joined(
    poles: Stabilisation, found: list[Cluster], orders: Sequence[int], scale: FloatArray, share: float
) -> list[Cluster]:
    """Return the clusters with the fragments of every double mode joined into two, by frequency."""
    left, out = sorted(found, key=lambda c: -len(c.poles)), list[Cluster]()
    f, zeta = poles.frequency_hz, poles.damping_ratio
    while left:
        k = left[0].representative
        at = np.array([c.representative for c in left])
        near = np.abs(f[at] - f[k]) < SAME_FREQUENCY * zeta[k] * f[k]
        near &= np.abs(np.log(zeta[at] / zeta[k])) < np.log(SAME_DAMPING)
        family = [c for c, is_near in zip(left, near, strict=True) if is_near]
        pair = _pair(poles, family, orders, scale, share) if len(family) > 2 else []
        out += pair or family
        left = [c for c, is_near in zip(left, near, strict=True) if not is_near]
    return out


def _pair(
    poles: Stabilisation, family: list[Cluster], orders: Sequence[int], scale: FloatArray, share: float
) -> list[Cluster]:
    """Return both members of the double mode that neighbouring clusters are fragments of.

    They are of none ([]) if two of them last, largest first: then their directions are their own.
    """
    members = np.concatenate([c.poles for c in family])
    by_order = [members[poles.order[members] == order] for order in orders]
    twice = [k for k, own in enumerate(by_order) if len(own) > 1]
    if not twice:
        return []
    since = [int(order) for order in orders[twice[0] :]]
    lasts = all(c.order_share >= share and len(c.poles) >= share * len(since) for c in family[:2])
    if lasts or len(twice) < OFTEN * len(since):
        return []
    shapes = poles.mode_shape[members] / scale
    shapes = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    along = np.linalg.svd(shapes, compute_uv=False) ** 2 / len(members)
    if along[:2].sum() < IN_PLANE or along[1:2].sum() < ACROSS:  # one channel has no plane
        return []
    away = dict(zip(members.tolist(), _away(poles, members).tolist(), strict=True))
    nearest = [sorted(by_order[k].tolist(), key=away.__getitem__)[:2] for k in twice]
    both = [sorted(two, key=lambda pole: float(poles.frequency_hz[pole])) for two in nearest]
    return [_cluster(poles, np.array(one), orders) for one in zip(*both, strict=True)]


def _cluster(poles: Stabilisation, members: Int64Array, orders: Sequence[int]) -> Cluster:
    kept = _one_an_order(poles, members)
    core = kept
    own = np.zeros(len(poles.order))
    if poles.log_covariance is not None:
        own = poles.log_covariance[:, 1, 1]
        core = kept[np.argsort(own[kept], kind="stable")[: (len(kept) + 1) // 2]]
    representative = int(core[np.argmin(_away(poles, core))])
    scatter = float(np.var(np.log(poles.damping_ratio[core])))
    return Cluster(
        poles=kept,
        representative=representative,
        core=core,
        order_share=len(kept) / int(np.sum(np.asarray(orders) >= poles.order[kept].min())),
        damping_cov=float(np.sqrt(own[representative] + scatter)),
    )


def _one_an_order(poles: Stabilisation, members: Int64Array) -> Int64Array:
    """Return, for every model order, the pole nearest to the median of the group."""
    order = np.lexsort((_away(poles, members), poles.order[members]))
    _, first = np.unique(poles.order[members][order], return_index=True)
    return np.asarray(members[order[first]])


def _away(poles: Stabilisation, members: Int64Array) -> FloatArray:
    """Return the distance of each pole from the median of ln f and ln ζ, in standard deviations.

    Both of two poles are equally far from their median, so that the last digits are dropped: rounding would
    decide between them.
    """
    values = np.log([poles.frequency_hz[members], poles.damping_ratio[members]])
    spread = np.maximum(values.std(axis=1, keepdims=True), 1e-9)
    away = np.linalg.norm((values - np.median(values, axis=1, keepdims=True)) / spread, axis=0)
    return np.asarray(away.round(DIGITS))
