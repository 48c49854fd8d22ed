"""Mode shapes: similarity, collinearity and the normalisation used everywhere in this package."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import ComplexArray, FloatArray


def mac(a: npt.ArrayLike, b: npt.ArrayLike) -> FloatArray:
    r"""Return the modal assurance criterion between two sets of shapes.

    .. math:: \mathrm{MAC} = \frac{|\phi_a^H \phi_b|^2}{(\phi_a^H\phi_a)(\phi_b^H\phi_b)}

    Thesis eq. (6.26).

    Parameters
    ----------
    a : (n_channels,) or (n_a, n_channels) complex
    b : (n_channels,) or (n_b, n_channels) complex

    Returns
    -------
    (n_a, n_b) float; a dimension is dropped for every single shape given.

    Examples
    --------
    >>> float(mac([1.0, 2.0], [2.0j, 4.0j]))
    1.0
    """
    phi_a, phi_b = np.asarray(a, dtype=complex), np.asarray(b, dtype=complex)
    cross = np.abs(phi_a.conj() @ phi_b.T) ** 2
    power_a = np.sum(np.abs(phi_a) ** 2, axis=-1)
    power_b = np.sum(np.abs(phi_b) ** 2, axis=-1)
    return np.asarray(cross / np.multiply.outer(power_a, power_b))


def normalised(shapes: ComplexArray) -> ComplexArray:
    """Return shapes (…, n_channels) scaled to exactly 1 at their largest entry."""
    largest = np.argmax(np.abs(shapes), axis=-1)
    scale = np.take_along_axis(shapes, largest[..., None], axis=-1)
    return np.asarray(shapes / scale)


def mpc(shapes: ComplexArray) -> FloatArray:
    """Return the modal phase collinearity of shapes (…, n_channels): 1 for a real shape, 0 for a circle.

    Pappa, Elliott & Schenk 1993: the squared ratio of difference to sum of the eigenvalues of the
    scatter of real against imaginary parts.
    """
    re, im = shapes.real, shapes.imag
    s_xx, s_yy, s_xy = (re * re).sum(-1), (im * im).sum(-1), (re * im).sum(-1)
    return np.asarray(((s_xx - s_yy) ** 2 + 4.0 * s_xy**2) / (s_xx + s_yy) ** 2)


def mean_phase(shapes: ComplexArray) -> FloatArray:
    """Return the phase [rad] of the line through the origin that fits the entries best."""
    return np.asarray(0.5 * np.angle((shapes**2).sum(-1)))


def mpd_rad(shapes: ComplexArray) -> FloatArray:
    """Return the mean phase deviation [rad] of shapes (…, n_channels) from their mean phase.

    Weighted by the size of each entry (Reynders 2012): 0 for a real shape, at most π/2.
    """
    turned = shapes * np.exp(-1j * mean_phase(shapes))[..., None]
    deviation = np.arctan2(np.abs(turned.imag), np.abs(turned.real))
    weight = np.abs(shapes)
    return np.asarray((weight * deviation).sum(-1) / weight.sum(-1))


def aligned(shapes: ComplexArray) -> ComplexArray:
    """Return shapes turned onto the real axis with their largest entry positive."""
    turned = shapes * np.exp(-1j * mean_phase(shapes))[..., None]
    largest = np.argmax(np.abs(turned), axis=-1)
    sign = np.sign(np.take_along_axis(turned.real, largest[..., None], axis=-1))
    return np.asarray(turned * np.where(sign == 0.0, 1.0, sign))
