"""Records of a modal system whose truth is known, to judge estimators by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jackettwin.records import Channel, Record

FloatArray = npt.NDArray[np.float64]

REPEAT = 4
"""The periodic signal is this many times longer than what is cut from it: its wrap-around is lost."""


@dataclass(frozen=True)
class ModalSystem:
    """Modes driven by stationary Gaussian modal forces, and noise at the sensors.

    Attributes
    ----------
    frequency_hz, damping_ratio : (n_modes,)
    mode_shapes : (n_modes, n_channels)
        Real.
    force : (n_modes, n_modes)
        Spectral density of the modal forces per unit modal mass [1/Hz], symmetric positive definite.
    noise_ratio : float
        Root mean square of the white noise over that of the signal, each channel.
    force_slope : float
        The force density falls with frequency to this power: 0 is white.
    """

    frequency_hz: FloatArray
    damping_ratio: FloatArray
    mode_shapes: FloatArray
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

    so the samples have the covariance of the continuous system band-limited at Nyquist: no time
    integration, no error of a step.
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
