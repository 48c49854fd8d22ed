"""Poles of all model orders in one table, with the soft criteria of a stabilisation diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jackettwin.identification.estimate import Stabilisation
from jackettwin.identification.mac import mac, normalised
from jackettwin.identification.ssi_cov import frequency_and_damping

if TYPE_CHECKING:
    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.identification.ssi_cov import OrderPoles

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]


def stabilisation(
    poles: list[OrderPoles],
    settings: IdentificationSettings,
    *,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    scale: FloatArray,
) -> Stabilisation:
    """Collect the poles inside the band that pass the hard limit on damping, and flag the stable ones.

    Parameters
    ----------
    scale : (n_channels,)
        Standard deviations by which the channels were divided: shapes come back in channel units.
    """
    table = [_order_table(p, settings, sample_rate_hz, band_hz) for p in poles]
    n_channels = len(scale)
    flags = [np.zeros((len(table[0][0]), 3), dtype=bool)] if table else []
    flags += [_stable(now, before, settings) for before, now in zip(table, table[1:], strict=False)]
    order = [np.full(len(f), p.order) for p, (f, _, _) in zip(poles, table, strict=True)]
    shapes = np.concatenate([s for _, _, s in table]) if table else np.empty((0, n_channels), dtype=complex)
    stable = np.concatenate(flags) if flags else np.empty((0, 3), dtype=bool)
    flat_order = np.concatenate(order) if order else np.empty(0, dtype=int)
    return Stabilisation(
        order=flat_order.astype(np.int64),
        frequency_hz=np.concatenate([f for f, _, _ in table]) if table else np.empty(0),
        damping_ratio=np.concatenate([z for _, z, _ in table]) if table else np.empty(0),
        mode_shape=normalised(np.asarray(shapes * scale, dtype=complex)),
        stable_frequency=stable[:, 0],
        stable_damping=stable[:, 1],
        stable_shape=stable[:, 2],
        cluster=np.full(len(flat_order), -1, dtype=np.int64),
    )


def _order_table(
    poles: OrderPoles,
    settings: IdentificationSettings,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
) -> tuple[FloatArray, FloatArray, ComplexArray]:
    f, zeta = frequency_and_damping(poles.eigenvalues, sample_rate_hz)
    keep = (zeta > 0.0) & (zeta < settings.max_damping_ratio) & (f > band_hz[0]) & (f < band_hz[1])
    keep &= np.abs(poles.shapes).max(axis=1, initial=0.0) > 0.0
    return f[keep], zeta[keep], poles.shapes[keep]


def _stable(
    now: tuple[FloatArray, FloatArray, ComplexArray],
    before: tuple[FloatArray, FloatArray, ComplexArray],
    settings: IdentificationSettings,
) -> BoolArray:
    """Return the three soft criteria of each pole towards the most similar pole of the order before."""
    f, zeta, shapes = now
    f0, zeta0, shapes0 = before
    out = np.zeros((len(f), 3), dtype=bool)
    if not len(f) or not len(f0):
        return out
    change_f = np.abs(f[:, None] - f0) / f[:, None]
    similarity = mac(shapes, shapes0)
    nearest = np.argmin(change_f + 1.0 - similarity, axis=1)
    row = np.arange(len(f))
    out[:, 0] = change_f[row, nearest] < settings.frequency_tolerance
    out[:, 1] = np.abs(zeta - zeta0[nearest]) / zeta < settings.damping_tolerance
    out[:, 2] = 1.0 - similarity[row, nearest] < settings.mac_tolerance
    return out
