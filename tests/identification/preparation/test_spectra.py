"""Spectra of a record."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.preparation.spectra import densities, lowest_motion_hz, welch
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record, spectral_matrix


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


def test_singular_values_of_more_channels_than_segments_are_those_of_the_matrix() -> None:
    """Twenty channels that seven motions move, in fifteen segments, by the 20 × 20 matrices themselves."""
    rng = np.random.default_rng(2)
    y = rng.standard_normal((20, 7)) @ rng.standard_normal((7, 4000))
    y[3, 100:300] = np.nan
    found, length = welch(y, 10.0), 500
    f, matrix = spectral_matrix(y, 10.0, length)
    scale = np.sqrt(np.nanmean(y**2, axis=1))
    direct = np.linalg.svd(matrix / np.outer(scale, scale), compute_uv=False).T
    np.testing.assert_allclose(found.frequencies_hz, f)
    np.testing.assert_allclose(found.density, np.einsum("faa->af", matrix).real, rtol=1e-10)
    np.testing.assert_allclose(found.singular_values, direct, atol=1e-12 * direct.max())
    assert welch(y, 10.0, below_hz=1.0).singular_values.shape == (20, np.sum(f <= 1.0))


def jacket(seed: int, pair_hz: tuple[float, float], duration_s: float, waves: float = 0.0) -> Record:
    """Return six channels with a bending pair and modes above 1 Hz, in wind and in waves of 8 s.

    ``waves`` is the ratio of the rms of the response to waves to that of the response to wind.
    """
    rng = np.random.default_rng((7, seed))
    first, second, third = [1.0, 0.6, 0.25], [-0.4, 0.6, 0.7], [0.25, -0.5, 0.6]
    x, y = np.array([1.0, 0.05]), np.array([-0.05, 1.0])
    profiles = ((first, x), (first, y), (second, x), (second, y), (third, x))
    shapes = np.array([np.kron(*profile) for profile in profiles])
    f, zeta = np.array([*pair_hz, 1.02, 1.1, 2.3]), np.full(5, 0.012)
    wind = ModalSystem(f, zeta, shapes, np.diag([1.0, 1.0, 0.5, 0.5, 0.3]))
    record = simulate(wind, rng, duration_s=duration_s, sample_rate_hz=20.0)
    line = np.maximum(np.fft.rfftfreq(4 * record.data.shape[1], 0.05), 1e-6)
    sharp = 8.0 * line
    swell = sharp**-5.0 * np.exp(-1.25 * sharp**-4.0) * 3.3 ** np.exp(-0.5 * ((sharp - 1.0) / 0.08) ** 2)
    force = np.sqrt(swell) * (rng.standard_normal((2, len(line))) + 1j * rng.standard_normal((2, len(line))))
    pair = f[:2, None]
    response = line**2 / (pair**2 - line**2 + 2j * zeta[:2, None] * pair * line) * force
    sea = np.fft.irfft(shapes[:2].T @ response)[:, : record.data.shape[1]]
    return replace(record, data=record.data + waves * record.data.std() / sea.std() * sea)


@pytest.mark.parametrize("seed", range(4))
def test_a_band_includes_a_pair_that_few_long_segments_show(seed: int) -> None:
    """Eight segments of 180 s do not resolve 0.17 and 0.185 Hz: the band began at 0.7 Hz, and was silent."""
    record = jacket(seed, (0.17, 0.185), 180.0)
    assert 0.15 < lowest_motion_hz(record.data, record.sample_rate_hz) < 0.21
    found = identify(record, IdentificationSettings(blocks=0, refine=False)).modes
    assert {round(m.frequency_hz, 1) for m in found} >= {0.2, 1.0, 1.1}


@pytest.mark.parametrize(("duration_s", "first_hz"), [(120.0, 0.18), (130.0, 0.2), (180.0, 0.13)])
def test_a_band_that_is_chosen_does_not_refuse_its_record(duration_s: float, first_hz: float) -> None:
    """Of 22 to 26 cycles an edge at 0.65 of the peak leaves fewer than the 20 that an edge must have."""
    found = 0
    for seed in range(4):
        record = jacket(seed, (first_hz, 1.06 * first_hz), duration_s)
        modes = identify(record, IdentificationSettings(blocks=0, refine=False)).modes
        found += any(abs(m.frequency_hz / first_hz - 1.03) < 0.06 for m in modes)
        assert any(abs(m.frequency_hz - 1.06) < 0.1 for m in modes)
    assert found >= 3


@pytest.mark.parametrize(("duration_s", "waves"), [(120.0, 1.0), (180.0, 1.0), (180.0, 3.0), (300.0, 1.0)])
def test_waves_do_not_open_the_band(duration_s: float, waves: float) -> None:
    """A wave spectrum is too broad for a clear peak, in few long segments too."""
    for seed in range(4):
        record = jacket(seed, (0.9, 0.96), duration_s, waves)
        assert 0.8 < lowest_motion_hz(record.data, record.sample_rate_hz) < 1.2


def test_a_first_mode_that_stronger_forces_across_it_hide_is_the_lowest_motion(rng) -> None:
    """A rotor at work: broad motion along x, orders and a tower mode above; across it a light 0.164 Hz."""
    n, rate = 12_000, 20.0
    f = np.fft.rfftfreq(n, 1.0 / rate)[1:]

    def moved(density: np.ndarray) -> np.ndarray:
        drawn = np.sqrt(density) * (rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size))
        y = np.fft.irfft(np.append(0.0, drawn), n)
        return y / y.std()

    def peak(f0: float, zeta: float) -> np.ndarray:
        return 1.0 / ((1.0 - (f / f0) ** 2) ** 2 + (2.0 * zeta * f / f0) ** 2)

    along = moved(peak(0.17, 0.3) + 3.0 * peak(0.38, 0.06) + 20.0 * peak(0.76, 0.01))
    across = moved(peak(0.164, 0.01) + 20.0 * peak(0.82, 0.01))
    both = np.array([along, 0.3 * across])
    assert lowest_motion_hz(both[:1], rate) > 0.3
    assert lowest_motion_hz(both, rate) == pytest.approx(0.164, abs=rate * 8 / n)  # a line of the spectrum
    # without the light mode nothing is sought so low
    still = moved(20.0 * peak(0.82, 0.01))
    assert lowest_motion_hz(np.array([along, 0.3 * still]), rate) > 0.3
