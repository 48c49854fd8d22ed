"""Second subspace identification with a shorter lag window, to check whether modes are found again."""

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
    from jackettwin.identification.preparation.prepared_record import PreparedRecord

WINDOW_RATIO = 0.6
"""Lag window of the second look over that of the first."""
SECOND_ORDERS = 10
"""Model orders of the second look."""
SAME_SHAPE = 0.7
"""Smallest MAC of a mode in both looks, or of two modes that are one."""
SAME_FREQUENCY = 2.0
"""Largest distance of their frequencies, in half bandwidths or standard deviations, whichever is larger."""


@dataclass(frozen=True)
class SecondLook:
    """Poles of the second look, as flat arrays of equal length.

    Attributes
    ----------
    order : (n_poles,)
    frequency_hz : (n_poles,)
    shape : (n_poles, n_channels)
        Shapes in the scaling of the samples.
    orders : tuple of int
        All model orders.
    scale : (n_channels,)
        Standard deviations by which the channels were divided.
    band_hz : (low, high)
        Frequency range for which this identification is used [Hz].
    """

    order: Int64Array
    frequency_hz: FloatArray
    shape: ComplexArray
    orders: tuple[int, ...]
    scale: FloatArray
    band_hz: tuple[float, float]


def second_look(
    y: FloatArray, ready: PreparedRecord, band_hz: tuple[float, float] = (0.0, np.inf)
) -> SecondLook:
    """Return the poles of a shorter lag window, without their uncertainty."""
    rate = ready.settings.sample_rate_hz
    rows = max(int(WINDOW_RATIO * ready.settings.block_rows), 3)
    top = min(ready.settings.orders[-1], (rows - 1) * len(ready.references), (rows - 1) * len(y))
    step = max(2 * round(0.5 * top / SECOND_ORDERS), 2)
    lags = covariances(y, 2 * rows)[:, :, ready.references]
    subspace = ssi_cov(lags, block_rows=rows, max_order=top, factors=False)
    orders = tuple(subspace.orders(range(step, top + 1, step)))
    number, f, shapes = [], [], []
    for poles in order_poles(subspace, orders):
        pole = np.log(poles.eigenvalues) * rate
        number.append(np.full(len(pole), poles.order))
        f.append(np.abs(pole) / (2.0 * np.pi))
        shapes.append(poles.shapes)
    return SecondLook(
        np.concatenate(number), np.concatenate(f), np.concatenate(shapes), orders, ready.scale, band_hz
    )


def seen_again(looks: Sequence[SecondLook], mode: ModalEstimate, others: Sequence[ModalEstimate]) -> float:
    """Return the share of a second look's orders, from the first that contains the mode, that contain it.

    In a close pair, any shape in the plane of the two counts. Of several looks at its frequency,
    the one with the largest share is used.
    """
    there = (look for look in looks if look.band_hz[0] < mode.frequency_hz < look.band_hz[1])
    return max((_share(look, mode, others) for look in there), default=0.0)


def _share(look: SecondLook, mode: ModalEstimate, others: Sequence[ModalEstimate]) -> float:
    shapes = np.array([mode.mode_shape, *(m.mode_shape for m in others)]) / look.scale
    reach = SAME_FREQUENCY * max(mode.damping_ratio, (mode.frequency_std_hz or 0.0) / mode.frequency_hz)
    near = np.abs(look.frequency_hz / mode.frequency_hz - 1.0) < reach
    q, _ = np.linalg.qr(shapes.T)
    inside = np.sum(np.abs(look.shape @ q.conj()) ** 2, axis=1) / np.sum(np.abs(look.shape) ** 2, axis=1)
    held = np.unique(look.order[near & (inside > SAME_SHAPE)])
    if not len(held):
        return 0.0
    return len(held) / sum(order >= int(held[0]) for order in look.orders)
