r"""Projection of many channels onto the few directions in which they move in a narrow band.

The cost of a fit grows with the square of the number of channels and of parameters, most of which are shape
components. In a narrow band few modes act, and the motion normal to them is noise. B is an orthonormal basis
of the shapes of these modes and of the largest other motions:

.. math:: z = B^T y, \qquad \phi = B \phi_z .

Channels are scaled to comparable size and so is their noise; hence the noise of z is nearly uncorrelated too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.band_fit import BandFit


EXTRA_DIRECTIONS = 3
"""Directions beyond the number of modes: two for the forces and one for modes just outside the band."""
MIN_LINES = 150
"""A band with fewer lines is fitted in all channels: that is cheap, and separates close pairs better."""
MIN_MODES = 2
"""Smallest number of modes assumed: a single mode may have a doubtful neighbour in another direction."""


def directions(
    y: FloatArray, sample_rate_hz: float, band_hz: tuple[float, float], shapes: FloatArray
) -> FloatArray | None:
    """Return an orthonormal basis (n_channels, n_directions), or None if projection saves no work.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample.
    shapes : (n_modes, n_channels)
        Shapes of the modes to be fitted; the basis spans them.
    """
    n_channels, n_samples = y.shape
    wanted = max(len(shapes), MIN_MODES) + EXTRA_DIRECTIONS
    lines = (band_hz[1] - band_hz[0]) * n_samples / sample_rate_hz
    if wanted >= n_channels or lines < MIN_LINES:
        return None
    line = np.arange(n_samples // 2 + 1) * sample_rate_hz / n_samples
    inside = (line >= band_hz[0]) & (line <= band_hz[1])
    x = np.empty((n_channels, int(inside.sum())), dtype=complex)
    for row, own in zip(y, x, strict=True):
        own[:] = np.fft.rfft(np.nan_to_num(row))[inside]
    x /= np.linalg.norm(x, axis=0)  # every line has the same weight, whatever its power
    unit = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    q, s, _ = np.linalg.svd(unit.T, full_matrices=False)
    own = q[:, s > 1e-3 * s[0]]
    rest = x - own @ (own.T @ x)
    _, vectors = np.linalg.eigh((rest @ rest.conj().T).real)
    return np.asarray(np.hstack([own, vectors[:, ::-1][:, : wanted - own.shape[1]]]))


def project(y: FloatArray, basis: FloatArray) -> FloatArray:
    """Return samples along each direction, (n_directions, n_samples).

    A sample that is missing in one channel is missing in all directions.
    """
    whole = np.isfinite(y).all(axis=0)
    if whole.all():
        return np.asarray(basis.T @ y)
    return np.asarray(np.where(whole, basis.T @ np.where(whole, y, 0.0), np.nan))


def expand_to_channels(fit: BandFit, basis: FloatArray) -> BandFit:
    """Return a projected fit with its shapes expanded to all channels.

    Outside the span of the basis, the variance of a shape is set to that of its most certain direction.
    """
    across = np.eye(len(basis)) - basis @ basis.T
    covariance = basis @ fit.shape_covariance @ basis.T
    if len(fit.shape_covariance):
        least = np.linalg.eigvalsh(fit.shape_covariance)[:, 0]
        covariance = covariance + np.maximum(least, 0.0)[:, None, None] * across
    return replace(fit, shapes=fit.shapes @ basis.T, shape_covariance=covariance)
