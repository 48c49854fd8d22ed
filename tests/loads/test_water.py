"""Growth, flooding, added water and buoyancy of a vertical cylinder against closed forms."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import GROWTH_KG_M3, SEA_WATER_KG_M3, Coefficients, GrowthBand
from jackettwin.loads.members.morison import morison_points
from jackettwin.loads.members.water import Water, outside_pressure, still_water, water_mass
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import clamped
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member, Reaction

D, T, DEPTH, RHO = 1.2, 0.03, 40.0, SEA_WATER_KG_M3
GROWTH = Coefficients(growth=(GrowthBand(2.0, -40.0, 0.05),))


@pytest.fixture(scope="module")
def cylinder():
    tube = Section(D, T)
    structure = Structure(
        "cylinder",
        {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 50.0)},
        (Member("m", "a", "b", tube, tube, STEEL, "leg"),),
        reactions=(Reaction("a"),),
        sea_level_z_m=DEPTH,
    )
    assembly = assemble(structure, subdivide=10)
    return assembly, morison_points(assembly, coefficients=GROWTH, spacing=0.5)


def area(outer: float, inner: float = 0.0) -> float:
    return 0.25 * np.pi * (outer**2 - inner**2)


@pytest.mark.parametrize("flooded", [(), ("leg",), ("m",)])
def test_mass_along_and_across(cylinder, flooded: tuple[str, ...]) -> None:
    assembly, grid = cylinder
    M = water_mass(assembly, grid, Water(flooded=flooded))
    growth = GROWTH_KG_M3 * area(D + 0.1, D) * 42.0
    inside = RHO * area(D - 2 * T) * DEPTH if flooded else 0.0
    around = RHO * area(D + 0.1) * DEPTH
    for direction, wanted in ((0, growth + inside + around), (2, growth + inside)):
        shift = np.tile(np.eye(6)[direction], assembly.n_dof // 6)
        assert shift @ (M @ shift) == pytest.approx(wanted, rel=1e-9)


def test_weight_and_buoyancy(cylinder) -> None:
    assembly, grid = cylinder
    load = still_water(assembly, grid, Water()).load.reshape(-1, 6)[:, 2].sum()
    # growth above still water, from 0 to 2 m, displaces nothing
    displaced, growth = RHO * area(D + 0.1) * DEPTH, GROWTH_KG_M3 * area(D + 0.1, D) * 42.0
    assert load == pytest.approx(9.80665 * (displaced - growth), rel=1e-9)


def test_water_lowers_the_frequency_of_a_full_depth_cantilever() -> None:
    """Uniform cantilever wet over its whole length: f falls by √(m/(m + m_water)) exactly."""
    tube = Section(D, T)
    structure = Structure(
        "cantilever",
        {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, DEPTH)},
        (Member("m", "a", "b", tube, tube, STEEL, "leg"),),
        reactions=(Reaction("a"),),
        sea_level_z_m=DEPTH + 10.0,
    )
    dry = assemble(structure, subdivide=10)
    grid = morison_points(dry, spacing=1.0)
    wet = type(dry)(**{**dry.__dict__, "mass": dry.mass + water_mass(dry, grid, Water(flooded=("leg",)))})
    f_dry, f_wet = (
        undamped_modes(build_system(assembly, clamped(structure)), 1).frequency_hz[0]
        for assembly in (dry, wet)
    )
    steel = 7850.0 * area(D, D - 2 * T)
    water = RHO * (area(D - 2 * T) + area(D))
    assert f_wet / f_dry == pytest.approx(
        np.sqrt(steel / (steel + water)), rel=1e-4
    )  # two Gauss points a metre


def test_unknown_members_are_refused(cylinder) -> None:
    assembly, grid = cylinder
    with pytest.raises(InputError, match="no such member or part"):
        water_mass(assembly, grid, Water(flooded=("legs",)))


def test_pressure_is_the_head_of_water_and_wave(cylinder) -> None:
    """ρ g d at the bed; under a crest ρ g H/2 more at still level and ρ g H/(2 cosh kd) at the bed."""
    assembly, _ = cylinder
    mesh, rho, g = assembly.mesh, 1000.0, 9.80665
    calm = outside_pressure(assembly, Water(), density_kg_m3=rho, depth_m=DEPTH)
    z = mesh.coordinates[np.stack([mesh.start, mesh.end], axis=1), 2] - DEPTH
    np.testing.assert_allclose(calm, rho * g * np.maximum(-z, 0.0), atol=1e-6)
    k, H = 0.08, 6.0
    wave = outside_pressure(
        assembly, Water(), density_kg_m3=rho, depth_m=DEPTH, wave_height_m=H, wavenumber=k
    )
    more = rho * g * 0.5 * H * np.cosh(k * (DEPTH + z)) / np.cosh(k * DEPTH)
    np.testing.assert_allclose((wave - calm)[z <= 0.0], more[z <= 0.0], rtol=1e-9)
    assert not outside_pressure(assembly, Water(("leg",)), density_kg_m3=rho, depth_m=DEPTH).any()
    # what stands deeper than the bed is in the ground
    shallow = outside_pressure(assembly, Water(), density_kg_m3=rho, depth_m=20.0)
    assert not shallow[z < -20.1].any()
