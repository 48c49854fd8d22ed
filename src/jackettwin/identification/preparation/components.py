r"""Reduction of many channels to a few principal components.

The work of a subspace method grows with the cube of the number of channels, but the information does not: a
structure moves in few modes, and the remaining directions contain noise.
With U the eigenvectors of the channels' covariance of the largest eigenvalues,

.. math:: z(t) = U^T y(t), \qquad \phi = U \phi_z ,

modes are identified from z, and their shapes are expanded to all channels.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.mode_shapes import mpc, mpd_rad, normalised
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.preparation.whitening import as_measured
from jackettwin.records import Channel

if TYPE_CHECKING:
    from jackettwin.identification.estimate import Identification, ModalEstimate, Stabilisation
    from jackettwin.identification.preparation.prepared_record import PreparedRecord
    from jackettwin.identification.settings import IdentificationSettings


MAX_CHANNELS = 24
"""Number of channels of one kind above which they are reduced."""
COMPONENTS = 12
"""Number of components."""


def components(
    ready: PreparedRecord, settings: IdentificationSettings
) -> tuple[PreparedRecord, FloatArray | None]:
    """Return the data to identify from, and the matrix (n_channels, n_components) that expands shapes.

    The channels themselves and None are returned if there are few channels, channels of several kinds, or
    reference channels were chosen.
    """
    kinds = {channel.quantity for channel in ready.channels}
    if len(ready.channels) <= MAX_CHANNELS or len(kinds) > 1 or settings.reference_channels is not None:
        return ready, None
    whole = np.asarray(np.isfinite(ready.y).all(axis=0))
    there = ready.y[:, whole]
    powers, vectors = np.linalg.eigh(there @ there.T)
    U = vectors[:, -COMPONENTS:]
    share = float(powers[-COMPONENTS:].sum() / powers.sum())
    params = {"components": COMPONENTS, "channels": len(U), "share": share}
    fewer = replace(
        ready,
        channels=tuple(Channel(f"component {i}", kinds.copy().pop()) for i in range(COMPONENTS)),
        y=np.where(whole, U.T @ np.where(whole, ready.y, 0.0), np.nan),
        scale=np.ones(COMPONENTS),
        references=list(range(COMPONENTS)),
        differentiated=np.repeat(ready.differentiated[:1], COMPONENTS),
        findings=(*ready.findings, Finding("components", params=params)),
    )
    return fewer, ready.scale[:, None] * U


def expand_to_all_channels(found: Identification, ready: PreparedRecord, basis: FloatArray) -> Identification:
    """Return an identification from components with shapes and spectra at all channels."""
    rate = found.settings.sample_rate_hz
    return replace(
        found,
        channels=ready.channels,
        modes=tuple(_mode(mode, basis) for mode in found.modes),
        stabilisation=_poles(found.stabilisation, basis),
        spectrum=as_measured(welch(ready.y * ready.scale[:, None], rate), ready.differentiated),
        real_poles=tuple(
            replace(pole, mode_shape=normalised(basis @ pole.mode_shape)) for pole in found.real_poles
        ),
    )


def _mode(mode: ModalEstimate, basis: FloatArray) -> ModalEstimate:
    shape = basis @ mode.mode_shape
    return replace(
        mode,
        mode_shape=normalised(shape),
        mode_shape_std=_std(mode.mode_shape_std, shape, basis),
        mpc=float(mpc(shape)),
        mpd_rad=float(mpd_rad(shape)),
        unrefined=None if mode.unrefined is None else _mode(mode.unrefined, basis),
    )


def _poles(poles: Stabilisation, basis: FloatArray) -> Stabilisation:
    if not len(poles.order):
        return replace(poles, mode_shape=np.empty((0, len(basis)), dtype=complex))
    shapes = poles.mode_shape @ basis.T
    return replace(
        poles, mode_shape=normalised(shapes), mode_shape_std=_std(poles.mode_shape_std, shapes, basis)
    )


def _std(std: FloatArray | None, shapes: ComplexArray, basis: FloatArray) -> FloatArray | None:
    """Return standard deviations at all channels, taking the components' errors as independent."""
    if std is None:
        return None
    return np.asarray(np.sqrt(std**2 @ (basis**2).T) / np.abs(shapes).max(axis=-1, keepdims=True))
