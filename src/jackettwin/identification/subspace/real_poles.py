r"""Real poles: relaxations, that is motion that decays without oscillating, of a damper or a creeping soil.

The discrete eigenvalue of :math:`\lambda = -a` is :math:`e^{-a\Delta t}`, real between 0 and 1. Since
subspace models fit noise with many such poles, a relaxation is reported only if several model orders agree on
its rate and the uncertainty of the rate is known and moderate. The smallest attainable uncertainty is
:math:`\sigma_{\ln a} = \sqrt{2/(aT)}`, that of a first-order process observed without noise for a time T.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.identification.estimate import RealPole
from jackettwin.identification.linkage import average_linkage
from jackettwin.identification.mode_shapes import aligned, mac, normalised
from jackettwin.intervals import log_interval_90

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.identification.subspace.ssi_cov import OrderPoles


JOINED = 0.3
"""Poles whose average distance |Δ ln a| + 1 − MAC is below this are one relaxation."""
MOST_LOG_STD = 0.5
"""Largest standard deviation of ln a of a relaxation that is reported."""
FEWEST_ORDERS = 5


@dataclass(frozen=True)
class _Table:
    """Real poles of all orders: (n_poles,) each, shapes (n_poles, n_channels)."""

    order: Int64Array
    log_rate: FloatArray
    log_std: FloatArray
    shape: ComplexArray


def real_poles(
    poles: Sequence[OrderPoles],
    settings: IdentificationSettings,
    *,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    scale: FloatArray,
) -> tuple[RealPole, ...]:
    """Return the relaxations on which the model orders agree, slowest first.

    Parameters
    ----------
    poles : sequence of OrderPoles
        Real eigenvalues between 0 and 1 with their deviations, one entry an order.
    scale : (n_channels,)
        Standard deviations by which the channels were divided.
    """
    table = _table(poles, sample_rate_hz, band_hz, scale)
    orders = np.array([p.order for p in poles])
    found = [_relaxation(table, members, orders, settings) for members in _groups(table, scale)]
    return tuple(sorted((r for r in found if r is not None), key=lambda r: r.rate_rad_s))


def _table(
    poles: Sequence[OrderPoles], rate: float, band_hz: tuple[float, float], scale: FloatArray
) -> _Table:
    order, log_rate, log_std, shape = [], [], [], []
    for p in poles:
        a = -np.log(p.eigenvalues.real) * rate
        inside = (a > 2.0 * np.pi * band_hz[0]) & (a < 2.0 * np.pi * band_hz[1])
        if not inside.any() or p.eigenvalue_deviations is None:
            continue
        # δλ = δμ/μ · rate, and λ = −a
        delta = (p.eigenvalue_deviations.real / p.eigenvalues.real * rate)[:, inside] / a[inside]
        order += [p.order] * int(inside.sum())
        log_rate += np.log(a[inside]).tolist()
        log_std += np.sqrt(np.sum(delta**2, axis=0)).tolist()
        shape += list(p.shapes[inside] * scale)
    return _Table(
        np.array(order, dtype=np.int64),
        np.array(log_rate),
        np.array(log_std),
        np.array(shape, dtype=complex).reshape(-1, len(scale)),
    )


def _groups(table: _Table, scale: FloatArray) -> list[Int64Array]:
    if len(table.order) < 2:
        return []
    unit = table.shape / scale
    apart = np.abs(np.subtract.outer(table.log_rate, table.log_rate)) + 1.0 - mac(unit, unit)
    return average_linkage(apart, JOINED)


def _relaxation(
    table: _Table, members: Int64Array, orders: Int64Array, settings: IdentificationSettings
) -> RealPole | None:
    """Return the most certain pole of a group; its variance includes the scatter over the orders."""
    held = len(np.unique(table.order[members]))
    share = held / int(np.sum(orders >= table.order[members].min()))
    if held < FEWEST_ORDERS or share < settings.min_order_share:
        return None
    core = members[np.argsort(table.log_std[members], kind="stable")[: (len(members) + 1) // 2]]
    k = core[np.argmin(np.abs(table.log_rate[core] - np.median(table.log_rate[core])))]
    log_std = float(np.hypot(table.log_std[k], table.log_rate[core].std()))
    if log_std > MOST_LOG_STD:
        return None
    a = float(np.exp(table.log_rate[k]))
    return RealPole(
        rate_rad_s=a,
        rate_std_rad_s=a * log_std,
        rate_interval_90=log_interval_90(a, log_std),
        mode_shape=normalised(aligned(table.shape[k])),
        order_share=share,
    )
