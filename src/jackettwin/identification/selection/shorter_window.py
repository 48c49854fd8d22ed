"""Subspace identification with a shorter lag window: it finds the modes again, and noise modes elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.identification.subspace.covariances import covariances
from jackettwin.identification.subspace.ssi_cov import order_poles, ssi_cov

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import ModalEstimate
    from jackettwin.identification.preparation.prepare import Prepared

SHORTER = 0.6
"""Length of the lag window, as a share of that of the first identification."""
FEW_ORDERS = 10
"""Number of model orders."""
SAME_SHAPE = 0.7
"""Least MAC of the poles of one mode by the two lag windows, or of two candidates that are one mode …"""
SAME_FREQUENCY = 2.0
"""… and their largest distance in half bandwidths or standard deviations of the frequency: the larger."""


@dataclass(frozen=True)
class HigherBand:
    """The samples freed of louder, slower modes, and the range [Hz] in which modes are taken from them."""

    ready: Prepared
    taken_hz: tuple[float, float]


@dataclass(frozen=True)
class ShorterWindowPoles:
    """Poles by the shorter lag window: flat arrays of the same length.

    Attributes
    ----------
    order : (n_poles,)
    frequency_hz : (n_poles,)
    shape : (n_poles, n_channels)
        In the scaling of the samples.
    orders : tuple of int
        All of them.
    scale : (n_channels,)
        Standard deviations by which the channels were divided.
    band_hz : (low, high)
        Range of frequency in which these poles are compared with modes [Hz].
    """

    order: Int64Array
    frequency_hz: FloatArray
    shape: ComplexArray
    orders: tuple[int, ...]
    scale: FloatArray
    band_hz: tuple[float, float]


def shorter_window_poles(
    y: FloatArray, ready: Prepared, band_hz: tuple[float, float] = (0.0, np.inf)
) -> ShorterWindowPoles:
    """Return the poles by a shorter lag window, without their uncertainty."""
    rate = ready.settings.sample_rate_hz
    rows = max(int(SHORTER * ready.settings.block_rows), 3)
    top = min(ready.settings.orders[-1], (rows - 1) * len(ready.references), (rows - 1) * len(y))
    step = max(2 * round(0.5 * top / FEW_ORDERS), 2)
    lags = covariances(y, 2 * rows)[:, :, ready.references]
    subspace = ssi_cov(lags, block_rows=rows, max_order=top, factors=False)
    orders = tuple(subspace.orders(range(step, top + 1, step)))
    number, f, shapes = [], [], []
    for poles in order_poles(subspace, orders):
        pole = np.log(poles.eigenvalues) * rate
        number.append(np.full(len(pole), poles.order))
        f.append(np.abs(pole) / (2.0 * np.pi))
        shapes.append(poles.shapes)
    return ShorterWindowPoles(
        np.concatenate(number), np.concatenate(f), np.concatenate(shapes), orders, ready.scale, band_hz
    )


def seen_again(
    windows: Sequence[ShorterWindowPoles], mode: ModalEstimate, others: Sequence[ModalEstimate]
) -> float:
    """Return the share of model orders that find the mode again, counted from the first order that does.

    For a close pair any shape in the plane of the two counts. Where several bands cover the mode's frequency,
    the one with the largest share counts.
    """
    there = (w for w in windows if w.band_hz[0] < mode.frequency_hz < w.band_hz[1])
    return max((_share_of_orders(window, mode, others) for window in there), default=0.0)


def _share_of_orders(
    window: ShorterWindowPoles, mode: ModalEstimate, others: Sequence[ModalEstimate]
) -> float:
    shapes = np.array([mode.mode_shape, *(m.mode_shape for m in others)]) / window.scale
    reach = SAME_FREQUENCY * max(mode.damping_ratio, (mode.frequency_std_hz or 0.0) / mode.frequency_hz)
    near = np.abs(window.frequency_hz / mode.frequency_hz - 1.0) < reach
    q, _ = np.linalg.qr(shapes.T)
    inside = np.sum(np.abs(window.shape @ q.conj()) ** 2, axis=1) / np.sum(np.abs(window.shape) ** 2, axis=1)
    orders = np.unique(window.order[near & (inside > SAME_SHAPE)])
    if not len(orders):
        return 0.0
    return len(orders) / sum(order >= int(orders[0]) for order in window.orders)
