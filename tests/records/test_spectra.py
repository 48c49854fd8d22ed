"""Welch's estimate against closed forms, with all samples and with some missing."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal

from jackettwin.arrays import BoolArray
from jackettwin.records import spectral_matrix, welch_densities

RATE = 20.0
N = 60_000


def _scattered(rng: np.random.Generator) -> BoolArray:
    return np.asarray(rng.random(N) < 0.31)


def _one_gap(rng: np.random.Generator) -> BoolArray:
    start = int(rng.integers(0, int(0.69 * N)))
    return np.asarray((np.arange(N) >= start) & (np.arange(N) < start + int(0.31 * N)))


@pytest.mark.parametrize("lost", [_scattered, _one_gap])
def test_white_noise_with_samples_missing_has_its_level(lost: object, rng: np.random.Generator) -> None:
    """One-sided density of white noise of variance 1 at 20 Hz: 2 / 20 = 0.100; zeros for gaps read 0.069."""
    y = rng.standard_normal((1, N))
    y[0, lost(rng)] = np.nan  # type: ignore[operator]
    _, density = welch_densities(y, RATE, 1200)
    # the mean over all lines is a variance over 41 400 samples, whose standard deviation is 0.7 %; half
    # overlapping Hann windows weight them unevenly, which makes it 0.8 %: four of them
    np.testing.assert_allclose(density[0, 1:-1].mean(), 0.100, rtol=0.032)


@pytest.mark.parametrize("lost", [None, _scattered, _one_gap])
def test_a_sine_has_its_power(lost: object, rng: np.random.Generator) -> None:
    """The density of a sine of amplitude 3 integrates to 3² / 2."""
    y = 3.0 * np.sin(2.0 * np.pi * 0.313 * np.arange(N) / RATE)[None]
    if lost is not None:
        y[0, lost(rng)] = np.nan  # type: ignore[operator]
    f, density = welch_densities(y, RATE, 1200)
    # by Parseval the weighted mean of sin² over the samples that are there, 41 400 of them drawn from its
    # range of 0 to 1: 0.5 ± 0.0017, and four of that
    np.testing.assert_allclose(density[0].sum() * f[1], 4.5, rtol=0.014)


@pytest.mark.parametrize("length", [600, 601])
def test_without_gaps_it_is_scipys(length: int, rng: np.random.Generator) -> None:
    y = rng.standard_normal((2, 5000))
    f, density = welch_densities(y, RATE, length)
    expected = scipy.signal.welch(y, RATE, nperseg=length, noverlap=length - length // 2, detrend=False)
    np.testing.assert_allclose(f, expected[0])
    np.testing.assert_allclose(density, expected[1], rtol=1e-10)


def test_the_matrix_has_the_densities_on_its_diagonal(rng: np.random.Generator) -> None:
    y = rng.standard_normal((3, 4000))
    y[1, 500:900] = np.nan
    _, density = welch_densities(y, RATE, 500)
    _, matrix = spectral_matrix(y, RATE, 500)
    np.testing.assert_allclose(np.einsum("faa->af", matrix).real, density, rtol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > -1e-12


def test_a_channel_without_samples_has_no_power() -> None:
    y = np.full((1, 400), np.nan)
    assert not welch_densities(y, RATE, 100)[1].any()
