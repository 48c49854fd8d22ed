"""Modes a thousand times as quiet as the first pair are found, and noise makes no band."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from jackettwin.identification import identify, quiet_bands
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.selection.peaks import clear_peaks_hz
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

FREQUENCY_HZ = np.array([0.231, 0.237, 0.912, 1.294, 1.317, 1.90])
DAMPING = np.array([0.01, 0.01, 0.015, 0.017, 0.011, 0.015])
LEVEL = np.array([100.0, 60.0, 8.0, 90.0, 70.0, 26.0])
"""Size of the forces of each mode, which fall with the third power of frequency: the third and the last leave
peaks a ten thousandth of that of the first."""


def parked(seed: int) -> Record:
    """Three levels in two directions for ten minutes, as of a parked turbine."""
    fore = np.array([[0.06, 0.6, 1.0], [0.3, 1.0, 0.8], [0.7, 1.0, 0.12], [0.1, 0.7, -1.0]])
    shapes = np.zeros((6, 6))
    for mode, (row, start) in enumerate([(0, 0), (0, 3), (1, 0), (2, 3), (2, 0), (3, 3)]):
        shapes[mode, start : start + 3] = fore[row]
    force = np.diag(LEVEL**2)
    system = ModalSystem(FREQUENCY_HZ, DAMPING, shapes, force, noise_ratio=2e-3, force_slope=3.0)
    return simulate(system, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=15.0)


@pytest.mark.parametrize("seed", [0, 2])
def test_a_mode_a_ten_thousandth_as_loud_is_found(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found = identify(parked(seed))
    quiet = [m for m in found.modes if abs(m.frequency_hz - FREQUENCY_HZ[2]) < 0.012]
    assert len(quiet) == 1
    low, high = quiet[0].frequency_interval_90 or (0.0, 0.0)
    assert low < FREQUENCY_HZ[2] < high
    told = [m.frequency_hz for m in found.modes if m.status == "ok"]
    assert all(np.abs(FREQUENCY_HZ / f - 1.0).min() < 0.01 for f in told)
    # the poles of the whole band alone do not show it
    monkeypatch.setattr(quiet_bands, "MOST_BANDS", 0)
    assert not any(0.5 < m.frequency_hz < 1.2 for m in identify(parked(seed)).modes)


def test_noise_has_no_clear_peak() -> None:
    """Of 200 ten-minute channels of coloured noise, eight a record."""
    rng = np.random.default_rng(5)
    for noise in signal.lfilter([1.0], [1.0, -0.9], rng.normal(size=(25, 8, 9_000))):
        spectrum = welch(noise, 15.0)
        assert clear_peaks_hz(spectrum.frequencies_hz, spectrum.density) == []


def test_a_line_is_one_clear_peak() -> None:
    t = np.arange(9_000) / 15.0
    y = np.random.default_rng(6).normal(size=(2, 9_000)) + np.sin(2.0 * np.pi * 1.5 * t)
    spectrum = welch(y, 15.0)
    peaks = clear_peaks_hz(spectrum.frequencies_hz, spectrum.density)
    assert peaks
    assert max(abs(f - 1.5) for f in peaks) < 1.5 * spectrum.frequencies_hz[1]
