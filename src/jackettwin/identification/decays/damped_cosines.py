r"""Damped cosines in noise, by maximum likelihood: the modes of a free decay.

After a structure is released, all channels have the same poles but different amplitudes,

.. math:: y_c(t) = b_c + \mathrm{Re} \sum_m a_{cm} e^{\lambda_m t} + e_c(t), \qquad
          \lambda = -\zeta\omega + i\omega\sqrt{1 - \zeta^2},

so that the amplitudes :math:`a_{cm}`, which are the shapes, are linear parameters and can be
eliminated (variable projection: Golub & Pereyra 1973, with the derivative of Kaufman 1975).
Only ln ω and ln ζ of each mode are searched. In white noise of a different strength in each channel, least
squares of the whitened residual are the maximum likelihood, and their information gives the Cramér–Rao bound.
For one mode that dies out within the record it is

.. math:: \mathrm{var}(\hat\omega) = \mathrm{var}(\hat\alpha) = 16\,\alpha^3\sigma^2\Delta t / A^2,
          \qquad \alpha = \zeta\omega

(Yao & Pandit 1995, in the limit of many samples per decay).
The response to wind and waves during a decay is not white: it is strongest at the mode itself.
The covariance is therefore the sandwich estimate :math:`I^{-1} V I^{-1}`, where V is the variance of the
score in noise with the spectrum of the residual, or of the record after the decay.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy  # scipy.optimize and scipy.special are loaded where they are used
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.signals import next_fast_len

REWEIGHTINGS = 2
"""Number of times that the noise of each channel is re-estimated."""
MAX_DAMPING_RATIO = 0.5
"""At it a motion falls to 3 % within a cycle: beyond, it is a relaxation or a trend."""
GRADIENT_TOLERANCE = 1e-3
"""Gradient at which a fit has converged, with parameters in units of their standard deviations."""
MAX_ITERATIONS = 40
"""Most iterations of a fit; one that needs more is at its bounds."""
MAX_FREQUENCY_CHANGE = 0.2
"""Largest change of ln ω from the start of a fit; a frequency farther away belongs to another mode."""
MIN_NOISE_LENGTH = 0.125
"""Smallest ratio of the length of the record after a decay to that of the decay for the noise to be estimated
from that part; otherwise the residual of the fit is used."""
MIN_NOISE = 1e-6
"""Smallest noise of a channel, as a share of its rms."""
MIN_DEGREES_OF_FREEDOM = 2.0
"""Degrees of freedom of a variance estimated from one line of noise, the smallest used."""


@dataclass(frozen=True)
class DampedCosines:
    """A fitted sum of damped cosines.

    Attributes
    ----------
    frequency_hz, damping_ratio : (n_modes,)
        |λ|/2π and −Re λ/|λ|.
    amplitudes : (n_modes, n_channels) complex
        Amplitudes at the first sample, in the units of the samples.
    residual : (n_channels, n_samples)
    log_covariance : (2 n_modes, 2 n_modes)
        Covariance of (ln f, …, ln ζ, …) in the actual noise.
    cramer_rao : (2 n_modes, 2 n_modes)
        The same in white noise of the residual's variance.
    explained : float
        Share of the channels' whitened power that the cosines explain.
    """

    frequency_hz: FloatArray
    damping_ratio: FloatArray
    amplitudes: ComplexArray
    residual: FloatArray
    log_covariance: FloatArray
    cramer_rao: FloatArray
    explained: float


def damped_cosines(
    y: FloatArray,
    sample_rate_hz: float,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    *,
    noise: FloatArray | None = None,
) -> DampedCosines:
    """Fit damped cosines to a decay, from a first estimate of their frequencies and damping ratios.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Samples of the decay, none missing.
    frequency_hz, damping_ratio : (n_modes,)
    noise : (n_channels, n_more), optional
        The same channels after the decay; the spectrum of the noise is theirs after subtraction of the rest
        of the decay.

    Examples
    --------
    >>> t = np.arange(2000) / 10.0
    >>> y = np.exp(-0.02 * t) * np.cos(2 * np.pi * 0.3 * t)
    >>> fit = damped_cosines(y[None] + 1e-3 * np.sin(1e3 * t**2), 10.0, np.array([0.29]), np.array([0.02]))
    >>> [round(float(v), 4) for v in (fit.frequency_hz[0], fit.damping_ratio[0])]
    [0.3, 0.0106]
    """
    t = np.arange(y.shape[1]) / sample_rate_hz
    start = np.concatenate([np.log(2.0 * np.pi * frequency_hz), np.log(damping_ratio)])
    n = len(frequency_hz)
    low = np.concatenate([start[:n] - MAX_FREQUENCY_CHANGE, np.full(n, np.log(1e-5))])
    high = np.concatenate([start[:n] + MAX_FREQUENCY_CHANGE, np.full(n, np.log(MAX_DAMPING_RATIO))])
    least = MIN_NOISE * y.std(axis=1) + 1e-300
    sigma, p = y.std(axis=1) + least, np.clip(start, low + 1e-9, high - 1e-9)
    for _ in range(REWEIGHTINGS):
        white = y / sigma[:, None]
        p = _least_squares(white, t, p, (low, high))
        residual = _project(y, t, p).residual
        free = max(len(t) - 2 * n - 1, 1)
        sigma = np.sqrt(np.sum(residual**2, axis=1) / free) + least
    white = y / sigma[:, None]
    fit = _project(white, t, p)
    bound = np.linalg.pinv(_products(fit)[2])
    background = fit.residual
    if noise is not None and noise.shape[1] >= MIN_NOISE_LENGTH * len(t):
        later = t[-1] + np.arange(1, noise.shape[1] + 1) / sample_rate_hz
        background = noise / sigma[:, None] - _decays_at(p, fit.amplitudes, later)
    variance, freedom = _score_variance(_jacobian(fit), background)
    # a variance from few lines of noise is itself uncertain: intervals follow Student's t distribution
    wider = scipy.special.stdtrit(freedom, QUANTILES[-1]) / NORMAL_90
    covariance = bound @ variance @ bound * np.outer(wider, wider)
    about = white - white.mean(axis=1, keepdims=True)
    return DampedCosines(
        frequency_hz=np.exp(p[:n]) / (2.0 * np.pi),
        damping_ratio=np.exp(p[n:]),
        amplitudes=fit.amplitudes * sigma,
        residual=fit.residual * sigma[:, None],
        log_covariance=np.asarray(covariance),
        cramer_rao=np.asarray(bound),
        explained=1.0 - float(np.sum(fit.residual**2) / np.sum(about**2)),
    )


def _least_squares(
    y: FloatArray, t: FloatArray, p: FloatArray, bounds: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return the parameters within bounds that minimise the residual, starting from p, by Gauss–Newton steps.

    The amplitudes are eliminated by projection (variable projection: Golub & Pereyra 1973; slopes after
    Kaufman 1975). Only products of the slopes are formed, at the same cost for any number of channels.
    """
    low, high = bounds
    # parameters are scaled by their information
    unit = 1.0 / np.sqrt(np.diag(_products(_project(y, t, p))[2]) + 1e-300)
    nowhere = (np.inf, np.zeros(len(p)), np.eye(len(p)))

    @lru_cache(maxsize=1)
    def at(scaled: bytes) -> tuple[float, FloatArray, FloatArray]:
        q = unit * np.frombuffer(scaled)
        return _products(_project(y, t, q)) if np.all((q > low) & (q < high)) else nowhere

    found = scipy.optimize.minimize(  # type: ignore[call-overload]
        lambda q: at(q.tobytes())[0],
        p / unit,
        method="trust-exact",
        jac=lambda q: unit * at(q.tobytes())[1],
        hess=lambda q: np.outer(unit, unit) * at(q.tobytes())[2],
        options={"gtol": GRADIENT_TOLERANCE, "maxiter": MAX_ITERATIONS},
    )
    return np.asarray(unit * found.x)


def _products(fit: _Projection) -> tuple[float, FloatArray, FloatArray]:
    """Return half the sum of squares of the residual, its gradient, and its Gauss–Newton Hessian."""
    residual, amplitudes, q, moved = fit
    parts = np.concatenate([moved.real, -moved.imag], axis=1)
    parts -= q @ (q.T @ parts)
    twice = np.concatenate([amplitudes, amplitudes])
    weight = np.concatenate([twice.real, twice.imag])
    slope = -np.sum(weight * (residual @ parts).T, axis=1)
    second = (parts.T @ parts) * (weight @ weight.T)
    n = moved.shape[1]
    return (
        0.5 * float(np.sum(residual**2)),
        slope[:n] + slope[n:],
        second[:n, :n] + second[:n, n:] + second[n:, :n] + second[n:, n:],
    )


def _pole_slopes(p: FloatArray) -> ComplexArray:
    """Return the derivatives of the poles by their ln ω, and by their ln ζ."""
    omega, zeta = np.exp(p[: len(p) // 2]), np.exp(p[len(p) // 2 :])
    by_log_zeta = omega * zeta * (-1.0 - 1j * zeta / np.sqrt(1.0 - zeta**2))
    return np.concatenate([_poles(p), by_log_zeta])


def _decays_at(p: FloatArray, amplitudes: ComplexArray, t: FloatArray) -> FloatArray:
    """Return decays of given amplitudes (n_modes, n_channels) at later times, (n_channels, n_times)."""
    return np.asarray((amplitudes.T @ np.exp(np.outer(_poles(p), t))).real)


def _poles(p: FloatArray) -> ComplexArray:
    omega, zeta = np.exp(p[: len(p) // 2]), np.exp(p[len(p) // 2 :])
    return np.asarray(omega * (-zeta + 1j * np.sqrt(1.0 - zeta**2)))


class _Projection(NamedTuple):
    """Residual after the best amplitudes and a constant, with the parts of its derivatives.

    Attributes
    ----------
    left : (n_channels, n_samples)
    amplitudes : (n_modes, n_channels)
    q : (n_samples, 2 n_modes + 1)
        Orthonormal basis of Re and −Im of the decays and of the constant.
    moved : (n_samples, 2 n_modes)
        Derivatives of the decays by ln ω, then by ln ζ.
    """

    residual: FloatArray
    amplitudes: ComplexArray
    q: FloatArray
    moved: ComplexArray


def _project(y: FloatArray, t: FloatArray, p: FloatArray) -> _Projection:
    """Project out the best amplitudes and a constant."""
    decays = np.exp(np.outer(t, _poles(p)))
    basis = np.concatenate([decays.real, -decays.imag, np.ones((len(t), 1))], axis=1)
    q, r = np.linalg.qr(basis)
    linear = np.linalg.solve(r + 1e-12 * np.trace(np.abs(r)) / len(r) * np.eye(len(r)), q.T @ y.T)
    n = decays.shape[1]
    moved = t[:, None] * np.concatenate([decays, decays], axis=1) * _pole_slopes(p)
    return _Projection(y - (y @ q) @ q.T, linear[:n] + 1j * linear[n : 2 * n], q, moved)


def _jacobian(fit: _Projection) -> FloatArray:
    """Return the residual's derivatives by ln ω and ln ζ, (2 n_modes, n_channels, n_samples)."""
    residual, amplitudes, q, moved = fit
    n = len(amplitudes)
    out = np.empty((2 * n, *residual.shape))
    for i in range(2 * n):
        change = np.outer(moved[:, i], amplitudes[i % n]).real.T
        out[i] = -(change - (change @ q) @ q.T)
    return out


def _score_variance(jacobian: FloatArray, noise: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the variance of Jᵀe for noise e with the spectrum of a given sample, and its degrees of freedom.

    The variance is averaged over all time shifts of the sample, and at least that of white noise of its
    power.

    Returns
    -------
    variance : (n_parameters, n_parameters)
    freedom : (n_parameters,)
        Degrees of freedom of each variance: two per line of the sample on which it rests (Welch &
        Satterthwaite).
    """
    n_parameters, n_channels, n_samples = jacobian.shape
    length = noise.shape[1]
    size = next_fast_len(length + n_samples)
    lines = fft.rfft(noise - noise.mean(axis=1, keepdims=True), size, axis=1) / np.sqrt(length)
    moved = fft.rfft(jacobian, size, axis=2)
    score = np.sum(moved.conj() * lines, axis=1)
    weight = np.full(score.shape[1], 2.0)
    weight[0] = 1.0
    variance = (score * weight) @ score.conj().T / size
    power = np.mean(noise**2, axis=1)
    white = np.einsum("pct,qct,c->pq", jacobian, jacobian, power)
    values, vectors = _generalised(variance.real, white)
    # two per line; zero padding spreads a line over several
    each = np.abs(score) ** 2
    freedom = 2.0 * each.sum(axis=1) ** 2 / np.sum(each**2, axis=1) * length / size
    return vectors @ np.diag(np.maximum(values, 1.0)) @ vectors.T, np.maximum(freedom, MIN_DEGREES_OF_FREEDOM)


def _generalised(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return generalised eigenvalues of A, B, and vectors V with A = V diag(values) Vᵀ and B = V Vᵀ."""
    root = np.linalg.cholesky(b + 1e-12 * np.trace(b) / len(b) * np.eye(len(b)))
    inner = np.linalg.solve(root, np.linalg.solve(root, a).T)
    values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
    return np.asarray(values), np.asarray(root @ vectors)
