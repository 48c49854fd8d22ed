"""Levels of the grouped periodogram against white noise and against the samples' power."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.maximum_likelihood.periodogram import periodogram

MODES = (np.array([1.0]), np.array([0.02]))


def test_white_noise_has_its_density(rng):
    y = rng.standard_normal((2, 20_000))
    data = periodogram(y, 10.0, (0.2, 4.0), modes=MODES, derivatives=[0, 0])
    level = np.average(data.density[:, [0, 1], [0, 1]].real, axis=0, weights=data.count)
    # variance 1 over a two-sided band of 10 Hz; 7600 lines: standard error 1.2 %
    np.testing.assert_allclose(level, 0.1, rtol=0.05)
    # a median of about 100 correlated lines scatters by about 15 %
    np.testing.assert_allclose(np.mean(data.floor, axis=0), 0.1, rtol=0.1)


def test_groups_hold_every_line_once():
    data = periodogram(np.ones((1, 6000)), 10.0, (0.2, 4.0), modes=MODES, derivatives=[0])
    # lines 120 … 2400 of 600 s
    assert data.count.sum() == 2281
    assert np.all(np.diff(data.omega) > 0.0)


def test_displacements_count_as_accelerations(rng):
    y = rng.standard_normal((1, 4000))
    plain, twice = (periodogram(y, 10.0, (0.2, 4.0), modes=MODES, derivatives=[order]) for order in (0, 2))
    single = plain.count == 1.0
    ratio = (twice.density / plain.density)[single, 0, 0].real
    np.testing.assert_allclose(ratio, plain.omega[single] ** 4, rtol=1e-9)


def test_parts_beside_a_gap_have_their_own_lines(rng):
    """Two times are independent: the likelihood is the product of those of the parts."""
    y = rng.standard_normal((2, 9000))
    parts = [y[:, :3500].copy(), y[:, 4100:].copy()]
    y[:, 3500:4100] = np.nan
    both, first, second = (
        periodogram(part, 10.0, (0.2, 4.0), modes=MODES, derivatives=[0, 0]) for part in (y, *parts)
    )
    assert both.duration_s == first.duration_s + second.duration_s == 840.0
    for one in (first, second):
        own = both.length_s == one.duration_s
        for name in ("omega", "count", "density", "dither", "variance"):
            np.testing.assert_array_equal(getattr(both, name)[own], getattr(one, name))
    assert len(both.omega) == len(first.omega) + len(second.omega)


def test_missing_samples_keep_the_level(rng):
    y = rng.standard_normal((1, 40_000))
    y[0, ::5] = np.nan
    data = periodogram(y, 10.0, (0.2, 4.0), modes=MODES, derivatives=[0])
    level = np.average(data.density[:, 0, 0].real, weights=data.count)
    assert level == pytest.approx(0.1, rel=0.05)
