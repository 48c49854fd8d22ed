"""Simulated turbulence: σ, spectrum and coherence against the standard; means over pieces of line."""

import numpy as np
import pytest
from tests.support.wind_spectrum import kaimal

from jackettwin.loads.aerodynamics.turbulence import turbulence
from jackettwin.loads.aerodynamics.wind import Wind, coherence

WIND = Wind(12.0, 150.0, "B")


def test_simulated_turbulence_has_sigma_spectrum_and_coherence() -> None:
    """24 seeds of 600 s at three points; bounds are multiples of the sampling error."""
    points = np.array([[0.0, 0.0], [0.0, 20.0], [60.0, 0.0]])
    fields = np.array(
        [turbulence(WIND, points, duration=600.0, sample_rate_hz=4.0, seed=seed) for seed in range(24)]
    )
    variance = fields.var(axis=1)  # (seed, point, component)
    for component in range(3):
        got = variance[:, 0, component]
        error = got.std() / np.sqrt(24)
        # what lies beyond the Nyquist frequency of 2 Hz is not in the record: 11 % of w; nor what is slower
        # than its first line: 9 % of u
        f = np.linspace(0.5 / 600.0, 2.0, 100_000)
        wanted = np.trapezoid(kaimal(WIND, f, component), f)
        assert abs(got.mean() - wanted) < 4 * error
    spectra = np.fft.rfft(fields[..., 0], axis=1)
    f = np.fft.rfftfreq(2400, 0.25)
    power = (np.abs(spectra) ** 2).mean(axis=0) * 2 * 0.25 / 2400
    for low, high in ((0.01, 0.03), (0.1, 0.3), (0.5, 1.5)):
        band = (f >= low) & (f < high)
        # 24 seeds × lines in the band, three points: 4 standard errors
        bound = 4.0 / np.sqrt(24 * band.sum())
        np.testing.assert_allclose(power[band].mean(axis=0), kaimal(WIND, f[band]).mean(), rtol=bound)
    cross = (spectra[:, :, 0] * spectra[:, :, 1].conj()).mean(axis=0)
    band = (f >= 0.01) & (f < 0.05)
    got = cross[band].real.sum() / np.sqrt(
        (np.abs(spectra[:, band, 0]) ** 2).mean(0).sum() * (np.abs(spectra[:, band, 1]) ** 2).mean(0).sum()
    )
    S = kaimal(WIND, f[band])
    assert got == pytest.approx(float(S @ coherence(WIND, f[band], 20.0) / S.sum()), abs=4 / np.sqrt(24 * 24))


def test_the_slowest_gusts_are_no_stronger_than_the_spectrum() -> None:
    """Of one seed in two winds, amplitudes of a line are as the roots of its densities."""
    slow, fast = (Wind(speed, 150.0, 0.1) for speed in (6.0, 24.0))
    series = [
        turbulence(wind, np.zeros((1, 2)), duration=600.0, sample_rate_hz=2.0, seed=1)[:, 0]
        for wind in (slow, fast)
    ]
    f = np.fft.rfftfreq(1200, 0.5)
    power = [np.abs(np.fft.rfft(one, axis=0)) ** 2 for one in series]
    for component in range(3):
        got = power[0][1:200, component] / power[1][1:200, component]
        wanted = kaimal(slow, f[1:200], component) / kaimal(fast, f[1:200], component)
        # the mean over a line's band is 2.5 % more than what is at its middle in 6 m/s, 0.3 % in 24
        np.testing.assert_allclose(got, wanted, rtol=0.023)
        np.testing.assert_allclose(got[3:], wanted[3:], rtol=0.008)


def test_seeds_repeat() -> None:
    one, again, other = (
        turbulence(WIND, np.zeros((1, 2)), duration=60.0, sample_rate_hz=4.0, seed=seed) for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(one, again)
    assert np.abs(one - other).max() > 0.1


def test_means_over_a_piece_lose_what_is_short_against_it() -> None:
    """U over 10 m at f: the double integral of exp(−κ|s − s'|), 2(a − 1 + e^{−a})/a² with a = κ·10 m."""
    points = np.stack([np.zeros(20), (np.arange(20) + 0.5) * 1.0], axis=1)
    fields = np.array(
        [
            turbulence(
                WIND, points, duration=600.0, sample_rate_hz=4.0, seed=seed, pieces=np.arange(20) // 10
            )
            for seed in range(12)
        ]
    )
    power = (np.abs(np.fft.rfft(fields[..., 0], axis=1)) ** 2).mean(axis=(0, 2)) * 2 * 0.25 / 2400
    f = np.fft.rfftfreq(2400, 0.25)
    for low, high in ((0.02, 0.06), (0.2, 0.6)):
        band = (f >= low) & (f < high)
        a = -10.0 * np.log(coherence(WIND, f[band], 1.0))
        wanted = (kaimal(WIND, f[band]) * 2.0 * (a - 1.0 + np.exp(-a)) / a**2).mean()
        # ten points stand for the line: within 1 %; 12 seeds, two places: 4 standard errors
        assert power[band].mean() == pytest.approx(wanted, rel=0.01 + 4.0 / np.sqrt(24 * band.sum()))


def test_all_components_may_be_coherent() -> None:
    points = np.array([[0.0, 0.0], [0.0, 0.5]])
    for coherent, alike in (("u", False), ("all", True)):
        field = turbulence(WIND, points, duration=600.0, sample_rate_hz=2.0, seed=1, coherent=coherent)
        for component in (1, 2):
            # at half a metre the coherence is above 0.6 up to 1 Hz; 1200 samples: 0.1 is three errors
            correlation = np.corrcoef(field[..., component].T)[0, 1]
            assert (correlation > 0.8) == alike
            assert alike or abs(correlation) < 0.15
