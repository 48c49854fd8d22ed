"""Damage from spectra: the narrow band's closed form, and series that are counted."""

from math import gamma

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.fatigue import count, dirlik, tovo_benasciutti

BY = {"dirlik": dirlik, "tovo_benasciutti": tovo_benasciutti}


def series(f: np.ndarray, S: np.ndarray, rate: float, rng: np.random.Generator) -> np.ndarray:
    """Return a Gaussian series with a one-sided density, which repeats at its end."""
    n = 2 * (f.size - 1)
    z = rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size)
    return np.fft.irfft(z * np.sqrt(0.25 * S * n * rate), n)


@pytest.mark.parametrize("method", BY)
@pytest.mark.parametrize("m", [3.0, 5.0])
def test_a_narrow_band_has_rayleigh_ranges(method: str, m: float) -> None:
    """f₀ (2√2 σ)^m Γ(1 + m/2); Dirlik's fit is a few per cent off it."""
    f = np.linspace(0.0, 2.0, 40_001)
    S = np.where(np.abs(f - 0.4) < 2e-3, 1.0, 0.0)
    sigma = np.sqrt(np.trapezoid(S, f))
    exact = 0.4 * (2.0 * np.sqrt(2.0) * sigma) ** m * gamma(1.0 + 0.5 * m)
    assert BY[method](f, S, m) == pytest.approx(exact, rel=0.03)
    line = np.where(np.arange(f.size) == 8000, 1.0, 0.0)  # one frequency, of which the widths are 0/0
    exact = 0.4 * (2.0 * np.sqrt(2.0) * np.sqrt(np.trapezoid(line, f))) ** m * gamma(1.0 + 0.5 * m)
    assert BY[method](f, line, m) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("method", BY)
@pytest.mark.parametrize("slow", [0.0, 1.0])
def test_a_counted_series_has_the_damage_of_its_spectrum(
    method: str, slow: float, rng: np.random.Generator
) -> None:
    """Two resonances, with slow motion or without: nine hours, whose damage scatters by some per cent."""
    rate, n = 20.0, 2**19
    f = np.fft.rfftfreq(n, 1.0 / rate)
    bands = ((0.18, 0.01, 1.0), (0.76, 0.02, 0.05), (0.05, 0.03, slow))
    S = sum(a * np.exp(-0.5 * ((f - c) / w) ** 2) for c, w, a in bands)
    cycles = count(series(f, S, rate, rng))
    counted = (cycles.numbers * cycles.ranges**3).sum() / (n / rate)
    found = BY[method](f, S, 3.0)
    # the methods' own error is up to a tenth; one that took λ₁ for λ₂ would be far off
    assert found == pytest.approx(counted, rel=0.12)


def test_ranges_scale_with_stress() -> None:
    f = np.linspace(0.0, 1.0, 1001)
    S = np.exp(-f / 0.2)
    for method in BY.values():
        assert method(f, 4.0 * S, 3.0) == pytest.approx(8.0 * method(f, S, 3.0), rel=1e-12)


def test_what_is_no_spectrum_is_refused() -> None:
    f = np.linspace(0.0, 1.0, 11)
    with pytest.raises(InputError, match="no spectral density"):
        dirlik(f, -np.ones(11), 3.0)
    with pytest.raises(InputError, match="must rise"):
        tovo_benasciutti(f[::-1], np.ones(11), 3.0)
