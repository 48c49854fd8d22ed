"""A peak without skirts is no mode's: that of a rotor's order whose speed wanders."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.tones.skirts import (
    LESS_LIKELY,
    are_orders,
    missing_skirts,
    peak_near,
    through_window,
)

DURATION_S, F, HALF, NUMBER = 600.0, 0.9, 4.0, 60
"""Half width of the peaks in lines."""


def peaks(rng: np.random.Generator, *, mode: bool, level: float, slope: float = 0.0) -> int:
    """Return how many of some random peaks have no skirts, in two channels."""
    k = np.arange(1500)
    x = (k - F * DURATION_S) / HALF
    density = ((1.0 / (1.0 + x**2) if mode else 2.0 ** -(x**2)) + level) * np.exp(-slope * x)
    found = 0
    for _ in range(NUMBER):
        drawn = np.sqrt(density) * (rng.standard_normal(k.size) + 1j * rng.standard_normal(k.size))
        lines, shape = np.outer([1.0, 0.4], drawn), np.array([1.0 + 0j, 0.4])
        zeta = HALF / (F * DURATION_S)
        missing = missing_skirts(lines, DURATION_S, F, zeta, shape, np.array([0.3]))
        found += missing is not None and missing > LESS_LIKELY
    return found


def test_orders_are_told_from_modes_where_their_skirts_would_show(rng: np.random.Generator) -> None:
    """Of 120 modes two would have no skirts by chance once in seventy times."""
    assert peaks(rng, mode=True, level=1e-3) + peaks(rng, mode=True, level=1e-2) <= 1
    assert peaks(rng, mode=False, level=1e-3) > 0.9 * NUMBER
    assert peaks(rng, mode=False, level=0.1) <= 2  # where nothing can be known, nothing is said


def test_a_mode_with_more_force_on_one_side_keeps_its_skirts(rng: np.random.Generator) -> None:
    """Ten times as much at five half widths below as above, as in a turbine at sea; 4 of 60 had none."""
    assert peaks(rng, mode=True, level=1e-3, slope=0.25) <= 1


@pytest.mark.parametrize(("zeta", "other"), [(0.05, 0.3), (0.0074, 0.92)])
def test_a_broad_peak_and_one_beside_another_are_not_judged(zeta, other, rng: np.random.Generator) -> None:
    x = (np.arange(1500) - F * DURATION_S) / HALF
    lines = np.sqrt(2.0 ** -(x**2) + 1e-4) * np.exp(2j * np.pi * rng.random(1500))
    shape, others = np.ones(1, dtype=complex), np.array([other])
    assert missing_skirts(lines[None], DURATION_S, F, zeta, shape, others) is None


def test_what_lies_at_a_multiple_of_an_order_is_one_unless_it_shows_skirts() -> None:
    """An order, its double as it is and with skirts, a mode elsewhere, and a peak too broad to judge."""
    f, zeta = np.array([0.5, 1.006, 1.0, 1.3, 1.5]), np.full(5, 0.006)
    missing = np.array([8.0, 0.5, -3.0, 0.5, np.nan])
    assert are_orders(f, zeta, missing, 6).tolist() == [True, True, False, False, False]
    # what is too close to others to be judged is an order if its half has no skirts, not if it is undecided
    missing[1] = np.nan
    assert are_orders(f, zeta, missing, 6)[1]
    assert not are_orders(f, zeta, np.append(4.0, missing[1:]), 2).any()
    # neither is without skirts by itself; the middles of broad peaks are known to half a per cent
    both = np.array([2.5, 1.0, -3.0, 0.5, np.nan])
    assert are_orders(f, 0.2 * zeta, both, 6).tolist() == [True, True, *3 * [False]]
    assert not are_orders(np.array([0.5, 1.012, 1.1, 1.3, 1.5]), 0.2 * zeta, both, 6).any()
    # no rotor turns so fast that these are its orders
    assert not are_orders(4.0 * f, zeta, both, 2).any()
    # what does not show in two sensors is no evidence of modes, as it is in six
    undecided, shown = np.array([-0.6, 0.3, -3.0, 0.5, np.nan]), np.array([-0.6, -0.5, -3.0, 0.5, np.nan])
    assert are_orders(f, zeta, undecided, 2).tolist() == [True, True, *3 * [False]]
    assert not are_orders(f, zeta, undecided, 6).any()
    assert not are_orders(f, zeta, shown, 2).any()


def test_a_peak_that_is_no_mode_is_found_where_it_is(rng: np.random.Generator) -> None:
    """Between two Welch lines, beside a stronger one out of reach: its frequency and its shape."""
    lines = 0.1 * (rng.standard_normal((2, 600)) + 1j * rng.standard_normal((2, 600)))
    lines[:, 251:256] += np.outer([1.0, -0.5], [1.0, 2.0, 3.0, -2.0, 1.0])
    lines[1, 266:269] += 9.0
    f, zeta, shape = peak_near(lines, DURATION_S, 0.42, 8.0 / DURATION_S)
    assert f == 253 / DURATION_S
    assert 16 / 6 == pytest.approx(zeta * f * DURATION_S)
    # noise of a tenth in four lines of the peak's rms of two
    assert shape[1] / shape[0] == pytest.approx(-0.5, abs=0.1)


@pytest.mark.parametrize("half_lines", [0.5, 1.0, 3.0])
def test_a_window_takes_the_skirts_that_the_ends_of_a_record_give(half_lines: float) -> None:
    """An order that goes on before and after the record, whose lines as they are look like a mode's."""
    rng, n = np.random.default_rng(8), 6000
    k = np.arange(2 * n // 2 + 1) / 2.0
    found = []
    for _ in range(20):
        drawn = rng.standard_normal(k.size) + 1j * rng.standard_normal(k.size)
        whole = np.fft.irfft(drawn * 2.0 ** (-0.5 * ((k - 540.0) / half_lines) ** 2), 2 * n)
        lines = np.fft.rfft(whole[:n])[None, :1500]
        lines += 2e-4 * np.abs(lines).max() * (rng.standard_normal(1500) + 1j * rng.standard_normal(1500))
        shape, others = np.ones(1, dtype=complex), np.array([0.3])
        found.append(missing_skirts(lines, DURATION_S, F, half_lines / 540.0, shape, others))
    assert np.sum(np.array(found) > LESS_LIKELY) > 11


def test_the_mean_through_the_window_is_that_of_simulated_lines(rng: np.random.Generator) -> None:
    """A mode of one line half width, by the exact recursion; three standard errors of 3000 lines."""
    n, number = 256, 3000
    pole = np.exp(-2.0 * np.pi / n)
    z = np.empty((number, n), complex)
    drawn = (rng.standard_normal((n, number)) + 1j * rng.standard_normal((n, number))) / np.sqrt(2.0)
    z[:, 0] = drawn[0] / np.sqrt(1.0 - pole**2)
    for j in range(1, n):
        z[:, j] = pole * z[:, j - 1] + drawn[j]
    lines = np.fft.fft(z * np.hanning(n + 1)[:n], axis=1)
    power = np.mean(np.abs(lines) ** 2, axis=0)
    expected = through_window(1.0, True)[[0, 16, 32, 80]]
    np.testing.assert_allclose(power[[0, 1, 2, 5]] / power[0], expected, rtol=5.0 / np.sqrt(number))
