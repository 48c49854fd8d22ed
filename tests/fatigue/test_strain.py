"""Stress from strain gauges: rosettes by hand, drift and jumps that leave the cycles as they are."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.errors import InputError
from jackettwin.fatigue import count, equivalent_range, rosette_stress, steady_strain

E, NU = 2.1e11, 0.3


@pytest.mark.parametrize("angles_deg", [(0, 45, 90), (0, 60, 120), (10, 70, 130), (0, 30, 60, 90)])
def test_a_rosette_tells_the_stress_across_the_weld(angles_deg: tuple[float, ...]) -> None:
    """Plane stress σx = 100, σy = 40, τ = 30 MPa: strains by Hooke's law, turned by Mohr's circle."""
    sx, sy, txy = 100e6, 40e6, 30e6
    ex, ey, g = (sx - NU * sy) / E, (sy - NU * sx) / E, 2.0 * (1.0 + NU) / E * txy
    a = np.radians(angles_deg)
    read = ex * np.cos(a) ** 2 + ey * np.sin(a) ** 2 + g * np.sin(a) * np.cos(a)
    assert_allclose(rosette_stress(read[:, None], a), [sx], rtol=1e-12)


def test_one_gauge_is_hookes_bar() -> None:
    assert_allclose(rosette_stress(np.array([[1e-4]]), np.array([0.0])), [21e6], rtol=1e-12)


@pytest.mark.parametrize("angles_deg", [(45,), (0, 90), (0, 0, 90), (0, 180, 90)])
def test_gauges_that_do_not_tell_it_are_refused(angles_deg: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="rosette"):
        rosette_stress(np.ones((len(angles_deg), 2)), np.radians(angles_deg))


def measured(rng: np.random.Generator, n: int = 12_000, rate: float = 20.0) -> np.ndarray:
    """Return ten minutes of a first mode, waves, gusts and noise [strain]."""
    t = np.arange(n) / rate
    slow = np.interp(t, np.arange(0.0, t[-1] + 30.0, 15.0), 2e-5 * rng.standard_normal(42))
    first = 4e-5 * np.sin(2 * np.pi * 0.17 * t + 2.0 * np.sin(0.02 * t))
    return slow + first + 1e-5 * np.sin(2 * np.pi * 0.9 * t) + 5e-7 * rng.standard_normal(n)


def test_a_sound_gauge_is_left_as_it_is(rng: np.random.Generator) -> None:
    """Two-sided: none of fifty sound records is told to jump, coarse sampling and white noise included."""
    for _ in range(40):
        strain = measured(rng)
        found = steady_strain(strain)
        assert found.jumps.size == 0
        assert_allclose(found.strain, strain)
    for _ in range(10):
        assert steady_strain(1e-6 * rng.standard_normal(12_000)).jumps.size == 0
        assert steady_strain(np.round(measured(rng)[::10], 6)).jumps.size == 0


def test_jumps_are_found_and_taken_out(rng: np.random.Generator) -> None:
    strain = measured(rng)
    jumping = strain.copy()
    for at, size in ((2_000, 3e-5), (7_001, -8e-5), (11_000, 1e-4)):
        jumping[at:] += size
    jumping[500] += 2e-4  # a spike returns: it is no jump
    jumping[3_000:3_100] = np.nan
    found = steady_strain(jumping)
    assert found.jumps.tolist() == [2_000, 7_001, 11_000]
    assert_allclose(found.sizes, [3e-5, -8e-5, 1e-4], atol=4e-6)
    clean, kept = (np.delete(x, [500, *range(3_000, 3_100)]) for x in (strain, found.strain))
    assert _damage(kept) == pytest.approx(_damage(clean), rel=0.02)
    assert _damage(np.delete(jumping, [500, *range(3_000, 3_100)])) > 1.2 * _damage(clean)


def test_drift_with_temperature_is_taken_out(rng: np.random.Generator) -> None:
    strain = measured(rng)
    warm = 10.0 + 6.0 * np.linspace(0.0, 1.0, strain.size) ** 2
    drifting = strain + 1.2e-5 * (warm - warm.mean())
    known = steady_strain(drifting, warm, per_kelvin=1.2e-5)
    assert_allclose(known.strain, strain, atol=1e-12)
    fitted = steady_strain(drifting, warm)
    assert fitted.per_kelvin == pytest.approx(1.2e-5, abs=4e-6)
    assert _damage(fitted.strain) == pytest.approx(_damage(strain), rel=0.1)
    at_rest = steady_strain(strain, np.full(strain.size, 12.0))
    assert at_rest.per_kelvin == 0.0
    assert_allclose(at_rest.strain, strain)


def _damage(strain: np.ndarray) -> float:
    return equivalent_range(count(E * strain), 4.0, 1e7) ** 4.0
