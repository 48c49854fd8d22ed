"""The signal-processing functions are those of ``scipy.signal``, to rounding."""

from typing import Literal

import numpy as np
import pytest
from scipy import fft, signal

from jackettwin.signals import (
    convolution,
    hann,
    local_peaks,
    lowpass_taps,
    next_fast_len,
    prev_fast_len,
    resample,
    running_median,
    tukey,
)

ROUNDING = 1e-13
"""A few hundred sums of numbers near 1."""


@pytest.mark.parametrize("n", [16, 17, 1000])
def test_windows(n: int) -> None:
    np.testing.assert_allclose(hann(n), signal.get_window("hann", n), atol=ROUNDING)
    np.testing.assert_allclose(tukey(n, 0.1), signal.windows.tukey(n, 0.1), atol=ROUNDING)


@pytest.mark.parametrize("edges", [(0.1, 0.12), (0.02, 0.05)])
def test_a_low_pass_filter(edges: tuple[float, float]) -> None:
    low, high = edges
    n, beta = signal.kaiserord(80.0, 2.0 * (high - low))
    expected = signal.firwin(n | 1, low + high, window=("kaiser", beta))
    np.testing.assert_allclose(lowpass_taps(low, high, 80.0), expected, atol=ROUNDING)


def test_a_convolution(rng: np.random.Generator) -> None:
    y, taps = rng.standard_normal((3, 1001)), rng.standard_normal(65)
    expected = signal.oaconvolve(y, taps[None, :], axes=1)
    np.testing.assert_allclose([convolution(taps, y.shape[1])(row) for row in y], expected, atol=ROUNDING)


@pytest.mark.parametrize(("up", "down"), [(1, 5), (2, 5), (3, 2), (7, 1), (4, 6)])
@pytest.mark.parametrize("first", [0, 11])
def test_another_rate(rng: np.random.Generator, up: int, down: int, first: int) -> None:
    y, taps = rng.standard_normal((2, 503)), rng.standard_normal(101)
    expected = signal.upfirdn(taps, y, up, down, axis=1)[:, first : first + 40]
    found = resample(y, y.shape[1], taps, up, down, first=first, n_out=40)
    np.testing.assert_allclose(found, expected, atol=ROUNDING)


@pytest.mark.parametrize("prominence", [0.0, 0.3, 1.0])
def test_peaks(rng: np.random.Generator, prominence: float) -> None:
    for values in (rng.standard_normal(500), np.round(rng.standard_normal(500)), np.zeros(5), np.arange(3.0)):
        expected, _ = signal.find_peaks(values, prominence=prominence or None)
        np.testing.assert_array_equal(local_peaks(values, prominence), expected)


def test_fast_lengths() -> None:
    for n in (1, 7, 13, 1001, 59_999):
        assert next_fast_len(n) == fft.next_fast_len(n)
        assert next_fast_len(n, real=True) == fft.next_fast_len(n, real=True)
        assert prev_fast_len(n) == fft.prev_fast_len(n)


@pytest.mark.parametrize("ends", ["nearest", "reflect"])
def test_running_medians_are_those_of_every_row(ends: Literal["nearest", "reflect"]) -> None:
    """Against the definition: the median of the values around each, with the ends continued."""
    x = np.random.default_rng(7).standard_normal((2, 3, 40))
    pad: Literal["edge", "symmetric"] = "edge" if ends == "nearest" else "symmetric"
    padded = np.pad(x, [(0, 0), (0, 0), (5, 5)], mode=pad)
    wanted = np.median(np.lib.stride_tricks.sliding_window_view(padded, 11, axis=-1), axis=-1)
    np.testing.assert_array_equal(running_median(x, 10, ends=ends), wanted)
