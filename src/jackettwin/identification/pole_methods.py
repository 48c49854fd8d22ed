"""Poles of every model order by the built-in methods, with their uncertainty where known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pkgutil import resolve_name
from typing import TYPE_CHECKING, cast

import numpy as np

from jackettwin.errors import InputError, look_up
from jackettwin.identification.frequency_domain.plscf import plscf_poles
from jackettwin.identification.methods import PLUGINS, POLE_METHODS
from jackettwin.identification.preparation.resolve import dense_orders, guarded_band_hz
from jackettwin.identification.subspace.covariances import block_covariances, covariances
from jackettwin.identification.subspace.real_poles import real_poles
from jackettwin.identification.subspace.ssi_cov import OrderPoles, Subspace, order_poles, ssi_cov
from jackettwin.identification.subspace.ssi_dat import ssi_dat
from jackettwin.identification.subspace.ssi_uncertainty import (
    Propagation,
    block_deviations,
    order_poles_with_uncertainty,
    propagation,
)
from jackettwin.identification.subspace.stabilisation import admissible, stabilisation
from jackettwin.plugins import plugins

if TYPE_CHECKING:
    from jackettwin.identification.estimate import RealPole, Stabilisation
    from jackettwin.identification.preparation.prepared_record import PreparedRecord
    from jackettwin.identification.settings import IdentificationSettings

FEWEST_BLOCKS = 5
"""Fewest blocks that give a useful standard deviation."""
EVERY = 2
"""Samples between instruments of the past, as neighbours are nearly redundant.
With 2, as many modes of random systems are found as with all, with equal scatter, in half the time."""
ENOUGH_INSTRUMENTS = 2
"""Fewest instruments left by this thinning, over the largest model order."""
PLSCF_WINDOWS = 2
"""Lags of the half spectra, over the lag window of SSI: a resolution of half a line of the lowest mode."""


PoleMethod = Callable[["PreparedRecord", "IdentificationSettings"], list[OrderPoles]]
"""Identification method: function from a prepared record and settings to the poles of every model order."""


def pole_method(name: str) -> PoleMethod:
    """Return the function of a method.

    Raises
    ------
    InputError
        If no method with poles has this name.
    """
    if name in POLE_METHODS:
        return cast(PoleMethod, resolve_name(POLE_METHODS[name]))
    return cast(PoleMethod, look_up(plugins(PLUGINS), name, "identification method", field="method"))


def poles_of(ready: PreparedRecord, settings: IdentificationSettings) -> Stabilisation:
    """Return the poles of all orders, with their uncertainty if the method propagates it."""
    poles = pole_method(settings.method)(ready, settings)
    rate, band = ready.settings.sample_rate_hz, guarded_band_hz(ready.settings)
    return stabilisation(
        poles, settings, sample_rate_hz=rate, duration_s=ready.duration_s, band_hz=band, scale=ready.scale
    )


def by_plscf(ready: PreparedRecord, settings: IdentificationSettings) -> list[OrderPoles]:
    """Return the poles by pLSCF on half spectra."""
    resolved, (low, high) = ready.settings, guarded_band_hz(ready.settings)
    lags = covariances(ready.y, PLSCF_WINDOWS * 2 * resolved.block_rows)[:, :, ready.references]
    rate = resolved.sample_rate_hz
    return plscf_poles(lags, resolved.orders, band=(low / rate, high / rate))


def by_ssi_dat(ready: PreparedRecord, settings: IdentificationSettings) -> list[OrderPoles]:
    """Return the poles by data-driven SSI."""
    resolved = ready.settings
    subspace = ssi_dat(
        ready.y,
        block_rows=resolved.block_rows,
        max_order=resolved.orders[-1],
        references=ready.references,
    )
    return order_poles(subspace, subspace.orders(resolved.orders))


def by_ssi_cov(ready: PreparedRecord, settings: IdentificationSettings) -> list[OrderPoles]:
    """Return the poles by covariance-driven SSI, with their uncertainty unless disabled."""
    rate, band = ready.settings.sample_rate_hz, guarded_band_hz(ready.settings)
    subspace = _subspace(ready, settings)
    orders = subspace.orders(ready.settings.orders)
    if not uncertain(settings):
        return order_poles(subspace, orders)
    shared = _propagation(ready, subspace, settings)
    duration_s = ready.duration_s
    return order_poles_with_uncertainty(
        shared, orders, keep=lambda mu: admissible(mu, settings, rate, duration_s, band)
    )


def relaxations(ready: PreparedRecord, settings: IdentificationSettings) -> tuple[RealPole, ...]:
    """Return the poles that do not oscillate.

    Raises
    ------
    InputError
        If the settings disable the uncertainty that distinguishes them from noise.
    """
    if not uncertain(settings):
        raise InputError(
            "real poles need the uncertainty of ssi-cov",
            field="real_poles",
            value=True,
            allowed=f"method ssi-cov, weighting br, state_matrix shift, blocks ≥ {FEWEST_BLOCKS}",
            remedy="leave these settings at their defaults",
        )
    # more orders and all instruments, only for relaxations, so that the modes do not depend on this option
    ready = replace(ready, settings=dense_orders(ready.settings, settings.order_step))
    resolved, subspace = ready.settings, _subspace(ready, settings, every=1)
    shared = _propagation(ready, subspace, settings, every=1)
    return real_poles(
        order_poles_with_uncertainty(shared, subspace.orders(resolved.orders), real=True),
        settings,
        sample_rate_hz=resolved.sample_rate_hz,
        band_hz=(resolved.lowest_frequency_hz, resolved.highest_frequency_hz),
        scale=ready.scale,
    )


def uncertain(settings: IdentificationSettings) -> bool:
    """Return whether the uncertainty of the poles is requested and available for this variant."""
    variant = (settings.method, settings.weighting, settings.state_matrix)
    return settings.blocks >= FEWEST_BLOCKS and variant == ("ssi-cov", "br", "shift")


def _subspace(ready: PreparedRecord, settings: IdentificationSettings, every: int | None = None) -> Subspace:
    resolved = ready.settings
    return ssi_cov(
        covariances(ready.y, 2 * resolved.block_rows)[:, :, ready.references],
        block_rows=resolved.block_rows,
        max_order=resolved.orders[-1],
        weighting=settings.weighting,
        state_matrix=settings.state_matrix,
        factors=uncertain(settings),
        every=_every(ready) if every is None else every,
    )


def _every(ready: PreparedRecord) -> int:
    """Return the samples between instruments: one if few would be left.

    It is also one for displacements, in which relaxations are strong and would hide modes with half the
    instruments.
    """
    enough = ENOUGH_INSTRUMENTS * max(ready.settings.orders, default=1)
    many = ready.settings.block_rows * len(ready.references) >= EVERY * enough
    relaxing = any(c.quantity == "displacement" for c in ready.channels)
    return EVERY if many and not relaxing else 1


def _propagation(
    ready: PreparedRecord, subspace: Subspace, settings: IdentificationSettings, every: int | None = None
) -> Propagation:
    rows, every = ready.settings.block_rows, _every(ready) if every is None else every
    blocks = block_covariances(ready.y, 2 * rows, settings.blocks)[..., ready.references]
    return propagation(subspace, block_deviations(blocks.astype(np.float32), rows, every), np.float32)
