"""IEC wind: σ, spectrum and coherence against the standard; tower drag against closed forms."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.morison import Coefficients, morison_points, nodal_loads
from jackettwin.loads.rotor import AIR_KG_M3
from jackettwin.loads.wind import Wind, coherence, kaimal, tower_drag, tower_drag_damping, turbulence
from jackettwin.structure import assemble, read_structure

WIND = Wind(12.0, 150.0, "B")


def test_normal_turbulence_model() -> None:
    """IEC 61400-1 eq. (10): class B at 12 m/s: 0.14 (0.75·12 + 5.6)."""
    assert WIND.sigma == pytest.approx(0.14 * 14.6)
    assert Wind(12.0, 150.0, 0.1).sigma == pytest.approx(1.2)
    assert float(WIND.mean(75.0)) == pytest.approx(12.0 * 0.5**0.14)
    with pytest.raises(InputError, match="A\\+, A, B, C"):
        Wind(12.0, 150.0, "D")


@pytest.mark.parametrize("component", [0, 1, 2])
def test_kaimal_integrates_to_its_variance(component: int) -> None:
    f = np.concatenate([[0.0], np.geomspace(1e-7, 1e4, 400_000)])
    variance = np.trapezoid(kaimal(WIND, f, component), f)
    assert variance == pytest.approx((WIND.sigma * (1.0, 0.8, 0.5)[component]) ** 2, rel=1e-3)


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
        # what lies beyond the Nyquist frequency of 2 Hz is not in the record: 11 % of w
        f = np.linspace(0.0, 2.0, 100_000)
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


def test_seeds_repeat() -> None:
    one, again, other = (
        turbulence(WIND, np.zeros((1, 2)), duration=60.0, sample_rate_hz=4.0, seed=seed) for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(one, again)
    assert np.abs(one - other).max() > 0.1


def test_tower_drag_and_its_damping() -> None:
    """Uniform wind on the tower: F = ½ρC_D V²∫D dz; damping 2F/V along, F/V across the wind."""
    assembly = assemble(read_structure("jacket15"))
    coefficients = Coefficients(drag=0.5, inertia=0.0, density_kg_m3=AIR_KG_M3)
    grid = morison_points(
        assembly, lowest_z=28.5, coefficients=coefficients, exclude_parts=("jacket", "transition_piece")
    )
    wind = np.zeros_like(grid.points)
    wind[:, 0] = 30.0
    loads = nodal_loads(grid, tower_drag(grid, wind)).reshape(-1, 6)
    shadow = 116.0 * 0.5 * (7.500085738299807 + 6.442351515803518)
    F = 0.5 * AIR_KG_M3 * 0.5 * 900.0 * shadow
    assert loads[:, 0].sum() == pytest.approx(F, rel=1e-6)
    C = tower_drag_damping(grid, wind)
    for direction, factor in ((0, 2.0), (1, 1.0)):
        shift = np.tile(np.eye(6)[direction], assembly.n_dof // 6)
        assert shift @ (C @ shift) == pytest.approx(factor * F / 30.0, rel=1e-6)
