r"""Poles of all model orders in one table, with the soft criteria of a stabilisation diagram.

A mode whose decay lasts longer than a record may happen to grow within it: the real part of its pole is then
positive. Without such poles the mode would be missing just where its damping looks lowest, and the mean over
records would be too high. A pole that grows by less than one e-fold within the record is therefore given the
real part −1/T, the least damping that a record of the duration T shows; its deviations are unchanged.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import stdtrit

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.identification.estimate import Stabilisation
from jackettwin.identification.mode_shapes import mac, normalised
from jackettwin.identification.subspace.ssi_cov import OrderPoles, frequency_and_damping
from jackettwin.intervals import NORMAL_90

if TYPE_CHECKING:
    from jackettwin.identification.settings import IdentificationSettings

MOST_GROWTH = 1.0
"""Growth within the record, in e-folds, above which a pole is none of a mode that varies by chance."""


def stabilisation(
    poles: list[OrderPoles],
    settings: IdentificationSettings,
    *,
    sample_rate_hz: float,
    duration_s: float,
    band_hz: tuple[float, float],
    scale: FloatArray,
) -> Stabilisation:
    """Collect the poles inside the band that pass the hard limit on damping, and flag the stable ones.

    Parameters
    ----------
    scale : (n_channels,)
        Standard deviations by which the channels were divided; returned shapes are in channel units.
    """
    poles = [_inside(p, settings, sample_rate_hz, duration_s, band_hz) for p in poles]
    table = [(*frequency_and_damping(p.eigenvalues, sample_rate_hz), p.shapes) for p in poles]
    n_channels = len(scale)
    flags = [np.zeros((len(table[0][0]), 3), dtype=bool)] if table else []
    flags += [_stable(now, before, settings) for before, now in zip(table, table[1:], strict=False)]
    order = [np.full(len(f), p.order) for p, (f, _, _) in zip(poles, table, strict=True)]
    shapes = np.concatenate([s for _, _, s in table]) if table else np.empty((0, n_channels), dtype=complex)
    stable = np.concatenate(flags) if flags else np.empty((0, 3), dtype=bool)
    flat_order = np.concatenate(order) if order else np.empty(0, dtype=int)
    both = _both_deviations(poles, sample_rate_hz)
    return Stabilisation(
        order=flat_order.astype(np.int64),
        frequency_hz=np.concatenate([f for f, _, _ in table]) if table else np.empty(0),
        damping_ratio=np.concatenate([z for _, z, _ in table]) if table else np.empty(0),
        mode_shape=normalised(np.asarray(shapes * scale, dtype=complex)),
        stable_frequency=stable[:, 0],
        stable_damping=stable[:, 1],
        stable_shape=stable[:, 2],
        cluster=np.full(len(flat_order), -1, dtype=np.int64),
        log_covariance=None if both is None else np.concatenate([_covariance(one) for one in both]),
        mode_shape_std=_shape_stds(poles, scale),
        few_blocks=None if both is None else np.concatenate([few_block_widening(one).T for one in both]),
    )


def admissible(
    eigenvalues: ComplexArray,
    settings: IdentificationSettings,
    sample_rate_hz: float,
    duration_s: float,
    band_hz: tuple[float, float],
) -> BoolArray:
    """Return which poles lie in the band, hardly grow and are below the limit on damping, (n_poles,) bool."""
    f, zeta = frequency_and_damping(eigenvalues, sample_rate_hz)
    inside = (f > band_hz[0]) & (f < band_hz[1])
    grown = -zeta * 2.0 * np.pi * f * duration_s
    return np.asarray(inside & (grown < MOST_GROWTH) & (zeta < settings.max_damping_ratio))


def log_deviations(
    eigenvalues: ComplexArray, deviations: ComplexArray, sample_rate_hz: float
) -> tuple[FloatArray, FloatArray]:
    r"""Return the deviations of ln f and ln ζ that follow from those of discrete eigenvalues.

    .. math:: \delta\ln f = \mathrm{Re}(\bar\lambda\,\delta\lambda)/|\lambda|^2, \quad
              \delta\ln\zeta = -\mathrm{Re}\,\delta\lambda/(\zeta|\lambda|) - \delta\ln f

    Parameters
    ----------
    eigenvalues : (n_poles,)
    deviations : (n_blocks, n_poles)
    """
    lam = np.log(eigenvalues) * sample_rate_hz
    delta = deviations / eigenvalues * sample_rate_hz
    log_f = np.asarray((lam.conj() * delta).real / np.abs(lam) ** 2)
    return log_f, np.asarray(delta.real / lam.real - log_f)


def _inside(
    poles: OrderPoles,
    settings: IdentificationSettings,
    sample_rate_hz: float,
    duration_s: float,
    band_hz: tuple[float, float],
) -> OrderPoles:
    keep = admissible(poles.eigenvalues, settings, sample_rate_hz, duration_s, band_hz)
    deviations, shapes = poles.eigenvalue_deviations, poles.shape_deviations
    mu = poles.eigenvalues[keep]
    size = np.where(np.abs(mu) < 1.0, np.abs(mu), np.exp(-1.0 / (duration_s * sample_rate_hz)))
    decaying = size / np.abs(mu)
    return OrderPoles(
        poles.order,
        mu * decaying,
        poles.shapes[keep],
        None if deviations is None else deviations[:, keep] * decaying,
        None if shapes is None else shapes[:, keep],
    )


def _both_deviations(poles: list[OrderPoles], sample_rate_hz: float) -> list[FloatArray] | None:
    """Return the deviations of ln f and ln ζ of each order's poles, (2, n_blocks, n_poles); None without."""
    if any(p.eigenvalue_deviations is None and len(p.eigenvalues) for p in poles):
        return None
    return [
        np.stack(log_deviations(p.eigenvalues, p.eigenvalue_deviations, sample_rate_hz))
        for p in poles
        if p.eigenvalue_deviations is not None
    ] or None


def _covariance(both: FloatArray) -> FloatArray:
    """Return the covariance of (ln f, ln ζ) of every pole, (n_poles, 2, 2)."""
    return np.asarray(np.einsum("ibp,jbp->pij", both, both))


def few_block_widening(deviations: FloatArray) -> FloatArray:
    r"""Return the ratio of the 90 % interval of Student's t to the normal one for sums over blocks.

    Where gusts put the motion into few blocks, a variance is as uncertain as from so few. Its degrees of
    freedom are those of Satterthwaite (1946, eq. 17),

    .. math:: \nu = \frac{(\sum_b s_b^2)^2}{\sum_b s_b^4} \approx
              3\,\frac{(\sum_b d_b^2)^2}{\sum_b d_b^4} - 2,

    the second form with normal deviations :math:`d_b` for their variances; at most those of equal blocks.

    Parameters
    ----------
    deviations : (…, n_blocks, n_poles)

    Returns
    -------
    (…, n_poles)

    Examples
    --------
    >>> one_of_thirty = np.where(np.arange(30) == 4, 1.0, 0.01)[:, None]
    >>> few_block_widening(one_of_thirty).round(1), few_block_widening(np.ones((30, 1))).round(2)
    (array([3.7]), array([1.03]))
    """
    square = deviations**2
    fourth = np.sum(square**2, axis=-2)
    freedom = 3.0 * square.sum(axis=-2) ** 2 / np.where(fourth > 0.0, fourth, 1.0) - 2.0
    freedom = np.clip(freedom, 1.0, max(deviations.shape[-2] - 1, 1))
    return np.asarray(stdtrit(freedom, 0.95) / NORMAL_90)


def _shape_stds(poles: list[OrderPoles], scale: FloatArray) -> FloatArray | None:
    """Return the standard deviation of every entry of the shapes in channel units, (n_poles, n_channels)."""
    out = []
    for p in poles:
        if p.shape_deviations is None:
            if len(p.eigenvalues):
                return None
            continue
        raw, delta = p.shapes * scale, p.shape_deviations * scale
        largest = np.argmax(np.abs(raw), axis=1)[:, None]
        top = np.take_along_axis(raw, largest, axis=1)
        at_top = np.take_along_axis(delta, largest[None], axis=2)
        relative = (delta - raw / top * at_top) / top
        out.append(np.sqrt(np.sum(np.abs(relative) ** 2, axis=0)))
    return np.concatenate(out) if out else None


def _stable(
    now: tuple[FloatArray, FloatArray, ComplexArray],
    before: tuple[FloatArray, FloatArray, ComplexArray],
    settings: IdentificationSettings,
) -> BoolArray:
    """Return which poles meet the three soft criteria with the most similar pole of the order before."""
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
