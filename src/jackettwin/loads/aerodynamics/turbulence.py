"""Turbulent wind at many points, or averaged over line segments, as periodic time series."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.fft import irfft

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.loads.aerodynamics.wind import SCALE_RATIOS, SIGMA_RATIOS, Wind, coherence

Coherent = Literal["all", "u"]
"""Components that are coherent between places: all with the same law, or u only, as in the standard."""

_KNOTS = 64
"""Number of frequencies at which the coherence is factorised; between them factors are interpolated linearly
(error 0.2 % of a variance)."""


def turbulence(
    wind: Wind,
    points: FloatArray,
    *,
    duration: float,
    sample_rate_hz: float,
    seed: int,
    pieces: IntArray | None = None,
    coherent: Coherent = "u",
) -> FloatArray:
    """Return fluctuations u, v, w about the mean, (n_times, n, 3) [m/s], periodic.

    Independent complex Gaussian amplitudes are multiplied by the Cholesky factor of the coherence matrix at
    each frequency (Veers 1988).

    Parameters
    ----------
    points : (n_points, 2) y and z [m]
    pieces : (n_points,), optional
        Index, 0 to n − 1, of the place that each point belongs to; the wind at a place is the mean over its
        points. Gusts that are small compared with a blade segment average out over it, so that the load does
        not depend on the number of segments. By default every point is a place.
    coherent : {"u", "all"}
        IEC 61400-1 gives a coherence for u only. With independent v and w the load on a feathered rotor
        depends on the number of places; ``all`` gives them the coherence of u.
    """
    n_times = round(duration * sample_rate_hz)
    f = np.asarray(np.fft.rfftfreq(n_times, 1.0 / sample_rate_hz)[1:], dtype=np.float64)
    pieces = np.arange(len(points)) if pieces is None else pieces
    rng = np.random.default_rng(seed)
    shape = (3, f.size, int(pieces.max()) + 1)
    white = np.empty(shape, dtype=np.complex128)
    white.real, white.imag = rng.standard_normal(shape), rng.standard_normal(shape)
    white *= np.sqrt(0.5)
    count = 3 if coherent == "all" else 1
    white[:count] = _coloured(wind, points, pieces, f, white[:count])
    spectrum = np.zeros((3, shape[2], n_times // 2 + 1), dtype=np.complex128)
    for component in range(3):
        amplitude = np.sqrt(0.5 * _band_mean(wind, f, component) / duration)
        spectrum[component, :, 1:] = (amplitude[:, None] * white[component]).T
    return np.ascontiguousarray(irfft(spectrum, n=n_times, axis=-1, norm="forward", overwrite_x=True).T)


def _coloured(
    wind: Wind, points: FloatArray, pieces: IntArray, f: FloatArray, white: ComplexArray
) -> ComplexArray:
    """Return amplitudes (n_components, n_f, n) with the coherence between places."""
    distance = np.linalg.norm(points[:, None] - points[None], axis=-1)
    knots = np.geomspace(f[0], f[-1], _KNOTS)
    factors = (_factor(coherence(wind, knot, distance), pieces) for knot in knots)
    out = np.empty_like(white)
    edges = np.searchsorted(f, knots)
    edges[-1] = f.size
    for k, (low, high) in enumerate(pairwise(factors)):
        here = slice(edges[k], edges[k + 1])
        share = np.log(f[here] / knots[k])[:, None] / np.log(knots[k + 1] / knots[k])
        out[:, here] = (1.0 - share) * _times(white[:, here], low) + share * _times(white[:, here], high)
    return out


def _times(white: ComplexArray, factor: FloatArray) -> ComplexArray:
    """Return white noise (..., n) times a real factor, at half the work of a complex product."""
    return np.asarray(white.real @ factor.T + 1j * (white.imag @ factor.T))


def _factor(matrix: FloatArray, pieces: IntArray) -> FloatArray:
    """Return the Cholesky factor of the coherence of means over segments."""
    order = np.argsort(pieces, kind="stable")
    first = np.flatnonzero(np.diff(pieces[order], prepend=-1))
    size = np.diff(np.append(first, pieces.size))
    means = np.add.reduceat(np.add.reduceat(matrix[np.ix_(order, order)], first, axis=0), first, axis=1)
    means /= np.outer(size, size)
    return np.asarray(np.linalg.cholesky(means + 1e-9 * np.eye(first.size)), dtype=np.float64)


def _band_mean(wind: Wind, f: FloatArray, component: int) -> FloatArray:
    """Return the Kaimal spectrum averaged over each line's band (n_frequencies,), half a line to each side.

    The integral of S = 4σ²L/V / (1 + 6fL/V)^{5/3}, IEC 61400-1 (2019) eq. (C.14), has a closed form. What is
    slower than the first band is the mean of a record and no part of it, as in the field's generators, which
    sample S at the lines: a window of T cut from gusts that never end has the variance
    ∫ S (1 − sinc²(πfT)) df, which is that from 1/2T on within 1 % (6 to 24 m/s, ten minutes).
    """
    df = f[1] - f[0]
    L = SCALE_RATIOS[component] * wind.scale_m / wind.speed_m_s
    sigma = SIGMA_RATIOS[component] * wind.sigma

    def beyond(x: FloatArray) -> FloatArray:
        return np.asarray(sigma**2 * (1.0 + 6.0 * x * L) ** (-2.0 / 3.0))

    return np.asarray((beyond(f - 0.5 * df) - beyond(f + 0.5 * df)) / df)
