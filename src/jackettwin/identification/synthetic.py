"""Synthetic records of a known modal system, to test estimators."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.maximum_likelihood import accuracy
from jackettwin.identification.maximum_likelihood.parameters import Parameters, coherent_pairs
from jackettwin.identification.maximum_likelihood.periodogram import Periodogram, group_starts
from jackettwin.identification.maximum_likelihood.spectral_model import expected
from jackettwin.records import Channel, Record

REPEAT = 4
"""Length of the periodic signal over that of the record cut from it,
so that its wrap-around has no effect."""

FREQUENCIES = 20_001
"""Number of frequencies in the sum for the variance of a channel."""


@dataclass(frozen=True)
class ModalSystem:
    """Modes driven by stationary Gaussian modal forces, and noise at the sensors.

    Attributes
    ----------
    frequency_hz, damping_ratio : (n_modes,)
    mode_shapes : (n_modes, n_channels)
        Mode shapes; real, or complex with a phase lag.
    force : (n_modes, n_modes)
        Spectral density of the modal forces per unit modal mass [1/Hz], symmetric positive definite.
    noise_ratio : float
        Ratio of the rms of the white noise to that of the signal in each channel.
    force_slope : float
        Exponent of the fall of the force density with frequency; 0 is white.
    """

    frequency_hz: FloatArray
    damping_ratio: FloatArray
    mode_shapes: FloatArray | ComplexArray
    force: FloatArray
    noise_ratio: float = 0.02
    force_slope: float = 0.0


def simulate(
    system: ModalSystem, rng: np.random.Generator, *, duration_s: float = 600.0, sample_rate_hz: float = 20.0
) -> Record:
    r"""Return accelerations of the system as a record.

    Each spectral line of a long periodic Gaussian signal is drawn with the exact covariance

    .. math:: \Phi^T H(f)\, S(f)\, H(f)^H\, \Phi, \qquad
              H_i = \frac{-f^2}{f_i^2 - f^2 + 2 i \zeta_i f_i f},

    so that the samples have the covariance of the continuous system band-limited at Nyquist,
    without error of time integration.
    """
    n_samples = round(duration_s * sample_rate_hz)
    n_modes, n_channels = system.mode_shapes.shape
    f = np.fft.rfftfreq(REPEAT * n_samples, 1.0 / sample_rate_hz)
    lines = rng.standard_normal((2, n_modes, len(f)))
    colour = np.maximum(f, f[1]) ** (-0.5 * system.force_slope)
    amplitude = np.sqrt(REPEAT * n_samples * sample_rate_hz / 4.0)
    force = amplitude * colour * (np.linalg.cholesky(system.force) @ (lines[0] + 1j * lines[1]))
    f_n, zeta = system.frequency_hz[:, None], system.damping_ratio[:, None]
    response = -(f**2) / (f_n**2 - f**2 + 2j * zeta * f_n * f) * force
    y = np.fft.irfft(system.mode_shapes.T @ response, REPEAT * n_samples, axis=1)[:, :n_samples]
    y += system.noise_ratio * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)
    channels = tuple(Channel(f"a{j}") for j in range(n_channels))
    return Record(y, sample_rate_hz, channels, name="simulated")


def cramer_rao(
    system: ModalSystem,
    *,
    duration_s: float,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """Return the smallest standard deviations of ln f and ln ζ of an unbiased method, (n_modes,) each.

    Shapes (real), forces, their coherences and exponents, and the noise of every channel are unknown too,
    as in the refinement. Records are those of ``simulate``, within a band.

    Parameters
    ----------
    sample_rate_hz : float
        Sample rate in ``simulate``, which sets the bandwidth of the noise.
    """
    f, zeta = system.frequency_hz, system.damping_ratio
    lines = np.arange(int(np.ceil(band_hz[0] * duration_s)), int(band_hz[1] * duration_s) + 1) / duration_s
    start = group_starts(lines, duration_s, f, zeta)
    count = np.diff(np.append(start, len(lines))).astype(float)
    omega = 2.0 * np.pi * np.add.reduceat(lines, start) / count
    root = np.sqrt(0.5 * np.diag(system.force) * f**-system.force_slope)
    pairs = coherent_pairs(np.log(f))
    coherence = system.force / np.sqrt(np.outer(np.diag(system.force), np.diag(system.force)))
    shapes = system.mode_shapes.real * root[:, None]
    noise = np.stack([np.log(_noise_density(system, sample_rate_hz)), np.zeros(shapes.shape[1])])
    p = Parameters(
        log_f=np.log(f),
        log_zeta=np.log(zeta),
        colour=np.full(len(f), system.force_slope),
        shapes=shapes,
        coherence=coherence[pairs[:, 0], pairs[:, 1]].astype(complex),
        noise=noise,
        pairs=pairs,
    )
    n = shapes.shape[1]
    none = np.zeros((len(omega), n))
    data = Periodogram(
        omega, count, np.zeros((len(omega), n, n), complex), none, none, duration_s, duration_s
    )
    matrix = expected(data, p).matrix
    power = np.einsum("kaa->ka", matrix).real
    exact = replace(data, density=matrix, floor=power, dither=power)
    bound = accuracy.accuracy_of(exact, p).cramer_rao
    return bound[: len(f)], bound[len(f) : 2 * len(f)]


def _noise_density(system: ModalSystem, sample_rate_hz: float) -> FloatArray:
    """Return the two-sided density of the noise of each channel [1/Hz]."""
    f = np.linspace(0.0, 0.5 * sample_rate_hz, FREQUENCIES)[1:, None]
    f_n, zeta = system.frequency_hz, system.damping_ratio
    response = -(f**2) / (f_n**2 - f**2 + 2j * zeta * f_n * f) * f ** (-0.5 * system.force_slope)
    moved = response * system.mode_shapes.T[:, None, :]
    density = np.sum(moved @ system.force * moved.conj(), axis=2).real
    return np.asarray(0.5 * system.noise_ratio**2 * np.mean(density, axis=1))
