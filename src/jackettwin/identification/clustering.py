"""Groups of poles that belong to one mode, found without a random start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.cluster import hierarchy
from scipy.spatial.distance import squareform

from jackettwin.identification.mac import mac

if TYPE_CHECKING:
    from jackettwin.identification.estimate import Stabilisation

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Cluster:
    """Poles of one mode, at most one from each model order."""

    poles: IntArray
    """Positions in the stabilisation table."""
    representative: int
    """The pole nearest to the median of frequency and damping."""
    order_share: float
    damping_cov: float


def clusters(poles: Stabilisation, *, distance: float, n_orders: int, scale: FloatArray) -> list[Cluster]:
    r"""Group poles by average-linkage clustering, frequency ascending.

    .. math:: d_{ij} = \frac{|\lambda_i-\lambda_j|}{\max(|\lambda_i|,|\lambda_j|)} + 1 - \mathrm{MAC}_{ij}

    (Reynders, Houbrechts & De Roeck 2012). Two poles of the same order are never one mode: where a
    group holds both, the one nearer to the group's median stays.

    Parameters
    ----------
    scale : (n_channels,)
        Standard deviations of the channels; MAC is taken of shapes scaled by it, so that a channel in
        other units or at a quiet place counts.
    """
    n_poles = len(poles.order)
    if n_poles < 2:
        return []
    apart = _distances(poles, scale)
    tree = hierarchy.linkage(squareform(apart, checks=False), method="average")
    label = hierarchy.fcluster(tree, distance, criterion="distance")
    found = [_cluster(poles, np.flatnonzero(label == k), n_orders) for k in np.unique(label)]
    return sorted(found, key=lambda c: float(poles.frequency_hz[c.representative]))


def _distances(poles: Stabilisation, scale: FloatArray) -> FloatArray:
    zeta = poles.damping_ratio
    lam = poles.frequency_hz * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    size = np.maximum.outer(np.abs(lam), np.abs(lam))
    shapes = poles.mode_shape / scale
    apart = np.abs(lam[:, None] - lam) / size + 1.0 - mac(shapes, shapes)
    apart = np.maximum(0.5 * (apart + apart.T), 0.0)
    np.fill_diagonal(apart, 0.0)
    return apart


def _cluster(poles: Stabilisation, members: IntArray, n_orders: int) -> Cluster:
    log_f, log_zeta = np.log(poles.frequency_hz[members]), np.log(poles.damping_ratio[members])
    spread_f, spread_zeta = max(float(np.std(log_f)), 1e-9), max(float(np.std(log_zeta)), 1e-9)
    away = np.hypot((log_f - np.median(log_f)) / spread_f, (log_zeta - np.median(log_zeta)) / spread_zeta)
    order = np.lexsort((away, poles.order[members]))
    _, first = np.unique(poles.order[members][order], return_index=True)
    kept = order[first]
    zeta = poles.damping_ratio[members[kept]]
    return Cluster(
        poles=members[kept],
        representative=int(members[kept[np.argmin(away[kept])]]),
        order_share=len(kept) / n_orders,
        damping_cov=float(np.std(zeta) / np.mean(zeta)),
    )
