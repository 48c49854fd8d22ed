r"""The directions in which many channels move in a narrow band.

A fit grows with the square of the channels and that of its parameters, most of which are shapes. In a narrow
band a few modes act, and what is orthogonal to them is noise: with an orthonormal basis B of the shapes that
are sought and of what else moves most,

.. math:: z = B^T y, \qquad \phi = B \phi_z .

Channels are of comparable size and so is their noise: that of z is uncorrelated as well.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.refined import Refined


BESIDE_THE_MODES = 3
"""Directions more than modes that are sought: forces act in two, and what is beside the band adds one."""
FEW_LINES = 150
"""A band of fewer lines costs little, and there all channels together tell a close pair apart."""
FEWEST_MODES = 2
"""Beside a mode alone there may be a doubtful one of another direction."""


def directions(
    y: FloatArray, sample_rate_hz: float, band_hz: tuple[float, float], shapes: FloatArray
) -> FloatArray | None:
    """Return an orthonormal basis (n_channels, n_directions), None if that saves nothing.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample.
    shapes : (n_modes, n_channels)
        Of the modes that are sought; they lie in the span.
    """
    n_channels, n_samples = y.shape
    wanted = max(len(shapes), FEWEST_MODES) + BESIDE_THE_MODES
    lines = (band_hz[1] - band_hz[0]) * n_samples / sample_rate_hz
    if wanted >= n_channels or lines < FEW_LINES:
        return None
    x = np.fft.rfft(np.nan_to_num(y), axis=1)
    line = np.arange(x.shape[1]) * sample_rate_hz / n_samples
    x = x[:, (line >= band_hz[0]) & (line <= band_hz[1])]
    x = x / np.linalg.norm(x, axis=0)  # the ratios of every line count alike, loud or quiet
    unit = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    q, s, _ = np.linalg.svd(unit.T, full_matrices=False)
    own = q[:, s > 1e-3 * s[0]]
    rest = x - own @ (own.T @ x)
    _, vectors = np.linalg.eigh((rest @ rest.conj().T).real)
    return np.asarray(np.hstack([own, vectors[:, ::-1][:, : wanted - own.shape[1]]]))


def projected(y: FloatArray, basis: FloatArray) -> FloatArray:
    """Return the samples along each direction, (n_directions, n_samples); one gap is one of all."""
    whole = np.isfinite(y).all(axis=0)
    return np.asarray(np.where(whole, basis.T @ np.where(whole, y, 0.0), np.nan))


def at_channels(fit: Refined, basis: FloatArray) -> Refined:
    """Return a fit along directions with the shapes of all channels.

    What the shape does outside the span is as uncertain as its best known direction.
    """
    across = np.eye(len(basis)) - basis @ basis.T
    covariance = basis @ fit.shape_covariance @ basis.T
    if len(fit.shape_covariance):
        least = np.linalg.eigvalsh(fit.shape_covariance)[:, 0]
        covariance = covariance + np.maximum(least, 0.0)[:, None, None] * across
    return replace(fit, shapes=fit.shapes @ basis.T, shape_covariance=covariance)
