"""The model of the spectral matrix against the exact expected periodogram of simulated records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification.maximum_likelihood.parameters import Parameters, coherent_pairs
from jackettwin.identification.maximum_likelihood.periodogram import Periodogram
from jackettwin.identification.maximum_likelihood.spectral_model import expected

RATE, DURATION = 20.0, 600.0


def exact(system):
    """Covariance of the coloured process by FFT over sixteen records, weighted by 1 − τ/T, transformed."""
    n = round(RATE * DURATION)
    f = np.fft.rfftfreq(16 * n, 1.0 / RATE)
    f_i, zeta = system.frequency_hz[:, None], system.damping_ratio[:, None]
    h = -(f**2) / (f_i**2 - f**2 + 2j * zeta * f_i * f) * np.maximum(f, f[1]) ** (-0.5 * system.force_slope)
    g = np.einsum("ia,if,im->afm", system.mode_shapes, h, np.linalg.cholesky(system.force), optimize=True)
    lag = np.arange(16 * n)
    weight = np.maximum(1.0 - np.minimum(lag, 16 * n - lag) / n, 0.0)
    covariance = np.fft.irfft(0.5 * np.einsum("afm,bfm->abf", g, g.conj(), optimize=True), 16 * n)
    return f[::16], np.fft.rfft(covariance * weight)[..., ::16].transpose(2, 0, 1)


@pytest.mark.parametrize("slope", [0.0, 1.0, 2.0])
def test_expected_periodogram_of_coloured_forces(tower, slope):
    """What leaks follows the force at the peak: coloured too, the model is wrong by a half below it."""
    system = replace(tower, force_slope=slope)
    f, matrix = exact(system)
    lines = np.arange(90, 1800, 7)
    n_channels = system.mode_shapes.shape[1]
    none = np.zeros((len(lines), n_channels))
    data = Periodogram(
        2.0 * np.pi * f[lines], np.ones(len(lines)), matrix[lines], none, none, DURATION, DURATION
    )
    root = np.sqrt(0.5 * np.diag(system.force) * system.frequency_hz**-slope)
    pairs = coherent_pairs(np.log(system.frequency_hz))
    coherence = system.force / np.sqrt(np.outer(np.diag(system.force), np.diag(system.force)))
    p = Parameters(
        log_f=np.log(system.frequency_hz),
        log_zeta=np.log(system.damping_ratio),
        colour=np.full(len(root), slope),
        shapes=system.mode_shapes * root[:, None],
        coherence=coherence[pairs[:, 0], pairs[:, 1]].astype(complex),
        noise=np.full((2, n_channels), -40.0) * np.array([[1.0], [0.0]]),
        pairs=pairs,
    )
    power = np.einsum("kaa->ka", matrix[lines]).real
    model = np.einsum("kaa->ka", expected(data, p).matrix).real
    # the force is as at the peak only to first order in the half bandwidth, ζα/2 of the leak
    np.testing.assert_allclose(model, power, rtol=0.02)
