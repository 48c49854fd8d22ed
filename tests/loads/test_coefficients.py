"""Coefficients and growth over the height, of some members, with and without growth; tapered members."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import Coefficients, GrowthBand, Strip, StripTable
from jackettwin.loads.members.morison import added_mass, morison_points, point_forces
from jackettwin.loads.members.water import Water, still_water, water_mass
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member

NAMES = [("a", "leg"), ("b", "brace")]


def column(bottom: Section, top: Section, *, z0: float = -30.0, z1: float = 10.0):
    """A column between two heights from still water, member m of part leg."""
    return assemble(
        Structure(
            "column",
            {"a": (0.0, 0.0, z0), "b": (0.0, 0.0, z1)},
            (Member("m", "a", "b", bottom, top, STEEL, "leg"),),
            sea_level_z_m=0.0,
        )
    )


def test_growth_runs_straight_between_heights() -> None:
    """HydroDyn's table 2.0 m: 0, 0 m: 0.1, −40 m: 0.05; nothing beyond."""
    bands = (
        GrowthBand(2.0, 0.0, 0.0, 0.1, 1300.0, 1200.0),
        GrowthBand(0.0, -40.0, 0.1, 0.05, 1200.0, 1400.0),
    )
    c = Coefficients(growth=bands)
    z = np.array([2.1, 1.0, 0.0, -10.0, -40.0, -40.1])
    np.testing.assert_allclose(c.thickness(z), [0.0, 0.05, 0.1, 0.0875, 0.05, 0.0], atol=1e-15)
    np.testing.assert_allclose(c.growth_density(z), [0.0, 1250.0, 1200.0, 1250.0, 1400.0, 0.0])


def test_tables_over_height_and_of_members() -> None:
    """Later tables win; straight in between, constant beyond; the grown set where growth is."""
    rough, smooth = Strip(1.2, 0.9, 1.0), Strip(0.6, 1.0, 1.0)
    c = Coefficients(
        drag=0.7,
        growth=(GrowthBand(0.0, -10.0, 0.1),),
        grown=Strip(1.05, 0.8, 0.9),
        tables=(StripTable((-20.0, 0.0), (smooth, rough), (rough, rough), ("brace",)),),
    )
    z, member = np.array([5.0, -5.0, -15.0, 5.0, -5.0, -15.0, -30.0]), np.array([0, 0, 0, 1, 1, 1, 1])
    drag, added, pressure = c.at(z, member, NAMES)
    np.testing.assert_allclose(drag, [0.7, 1.05, 0.7, 1.2, 1.2, 0.75, 0.6])
    np.testing.assert_allclose(added, [1.0, 0.8, 1.0, 0.9, 0.9, 0.975, 1.0])
    np.testing.assert_allclose(pressure, [1.0, 0.9, 1.0, 1.0, 1.0, 1.0, 1.0])
    with pytest.raises(InputError, match="no such member or part.*legs"):
        Coefficients(tables=(StripTable((0.0,), (rough,), (rough,), ("legs",)),)).at(z, member, NAMES)


def test_inertia_is_of_pressure_and_added_mass_but_motion_feels_added_mass_alone() -> None:
    """C_M = C_p + C_a with C_p = 0.6, C_a = 1.1 per metre of a column 2 m wide."""
    tube = Section(2.0, 0.05)
    assembly = column(tube, tube)
    grid = morison_points(
        assembly, highest_z=0.0, coefficients=Coefficients(drag=0.0, added_mass=1.1, pressure=0.6)
    )
    du = np.tile([1.0, 0.0, 0.0], (grid.weight.size, 1))
    np.testing.assert_allclose(
        point_forces(grid, 0 * du, du)[:, 0] / grid.weight, 1025.0 * 1.7 * np.pi, rtol=1e-12
    )
    shift = np.tile([1.0, 0, 0, 0, 0, 0], assembly.n_dof // 6)
    wanted = 1025.0 * 1.1 * np.pi * 30.0
    assert shift @ (added_mass(grid) @ shift) == pytest.approx(wanted, rel=1e-9)


def test_a_cone_is_loaded_by_its_own_diameter() -> None:
    """One element 9.0 to 8.9 m wide, of HydroDyn's tapered cylinder: buoyancy 1.902464e7 N (r-test)."""
    assembly = column(Section(9.0, 0.05), Section(8.9, 0.05))
    grid = morison_points(assembly)
    lift = still_water(assembly, grid, Water()).load.reshape(-1, 6)[:, 2].sum()
    assert lift == pytest.approx(1.902464e7, rel=1e-6)
    steep = column(Section(6.0, 0.05), Section(2.0, 0.05), z0=-40.0, z1=0.0)
    points = morison_points(steep, highest_z=0.0)
    du = np.tile([1.0, 0.0, 0.0], (points.weight.size, 1))
    volume = np.pi / 12.0 * 40.0 * (36.0 + 12.0 + 4.0)
    force = point_forces(points, 0 * du, du)[:, 0].sum()
    assert force == pytest.approx(2.0 * 1025.0 * volume, rel=1e-9)  # Gauss's rule is exact for D²


def test_water_inside_a_cone_and_growth_of_two_densities() -> None:
    """Closed forms of truncated cones; 4 cm of growth, 1100 kg/m³ at the surface, 1500 at −30 m."""
    assembly = column(Section(4.0, 0.1), Section(2.0, 0.1), z0=-30.0, z1=0.0)
    growth = (GrowthBand(0.0, -30.0, 0.04, None, 1100.0, 1500.0),)
    grid = morison_points(assembly, coefficients=Coefficients(growth=growth), spacing=0.5)
    lift = np.tile([0, 0, 1.0, 0, 0, 0], assembly.n_dof // 6)
    mass = lift @ (water_mass(assembly, grid, Water(("leg",))) @ lift)
    inside = 1025.0 * np.pi / 12.0 * 30.0 * (3.8**2 + 3.8 * 1.8 + 1.8**2)
    # ∫ρ(s) π t (D(s) + t) ds, s from the bottom: both run straight
    D, rho = (4.0, 2.0), (1500.0, 1100.0)
    mean = sum(a * b for a, b in zip(D, rho, strict=True)) / 3 + (D[0] * rho[1] + D[1] * rho[0]) / 6
    grown = np.pi * 0.04 * 30.0 * (mean + 0.04 * 0.5 * sum(rho))
    assert mass == pytest.approx(inside + grown, rel=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Strip(drag=-1.0), "drag"),
        (lambda: Coefficients(pressure=float("nan")), "pressure"),
        (lambda: GrowthBand(-5.0, 2.0, 0.1), "top of growth must lie above its bottom"),
        (lambda: GrowthBand(2.0, -5.0, 0.1, -0.1), "bottom_thickness_m"),
        (lambda: StripTable((0.0, 0.0), (Strip(),) * 2, (Strip(),) * 2), "heights must differ"),
    ],
)
def test_what_is_refused(make, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()
