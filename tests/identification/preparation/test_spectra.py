"""Spectra of a record."""

import numpy as np

from jackettwin.identification.preparation.spectra import densities, welch


def test_densities_alone_are_those_of_the_matrices() -> None:
    """With a tenth of one channel missing, and a variance that is the density's integral."""
    rng = np.random.default_rng(1)
    y = rng.standard_normal((3, 8000)) * np.array([[1.0], [2.0], [0.1]])
    y[1, 100:900] = np.nan
    alone, all_ = densities(y, 10.0), welch(y, 10.0)
    np.testing.assert_array_equal(alone.frequencies_hz, all_.frequencies_hz)
    np.testing.assert_allclose(alone.density, all_.density, rtol=1e-12)
    # fifteen segments of noise: the integral is right to a few per cent
    power = alone.density.sum(axis=1) * alone.frequencies_hz[1]
    np.testing.assert_allclose(power, np.nanvar(y, axis=1), rtol=0.1)
