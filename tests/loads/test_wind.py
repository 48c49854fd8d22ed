"""IEC wind: σ, spectrum and coherence against the standard; tower drag against closed forms."""

import numpy as np
import pytest
from tests.support.wind_spectrum import kaimal

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3
from jackettwin.loads.aerodynamics.wind import Wind, coherence, tower_drag, tower_drag_damping
from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.members.morison import morison_points, nodal_loads
from jackettwin.structure import assemble

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


def test_tower_drag_and_its_damping() -> None:
    """Uniform wind on the tower: F = ½ρC_D V²∫D dz; damping 2F/V along, F/V across the wind."""
    assembly = assemble(read_structure("jacket15"))
    coefficients = Coefficients(drag=0.5, added_mass=0.0, pressure=0.0, density_kg_m3=AIR_KG_M3)
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


def test_coherence_is_that_of_the_standard() -> None:
    """IEC 61400-1 ed. 3 (B.16): exp(−12 √((f r/V)² + (0.12 r/L_c)²)) with L_c = 8.1 Λ_1 = 340.2 m."""
    wind = Wind(10.0, 150.0, "B")
    by_hand = np.exp(-12.0 * np.sqrt((0.05 * 30.0 / 10.0) ** 2 + (0.12 * 30.0 / 340.2) ** 2))
    assert float(coherence(wind, 0.05, 30.0)) == pytest.approx(by_hand, rel=1e-12)
    assert float(coherence(wind, 0.05, 0.0)) == 1.0
