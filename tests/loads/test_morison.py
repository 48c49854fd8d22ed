"""Morison's equation against closed forms on a vertical cylinder, and on the reference jacket."""

import numpy as np
import pytest
from tests.support.wave_loads import wave_loads

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import SEA_WATER_KG_M3, Coefficients, GrowthBand
from jackettwin.loads.members.morison import (
    added_mass,
    drag_damping,
    morison_points,
    nodal_loads,
    point_forces,
    wetness,
)
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.waves import airy_wave
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member

D, DEPTH, RHO = 1.2, 40.0, SEA_WATER_KG_M3


def cylinder(top=(0.0, 0.0, 50.0), bottom=(0.0, 0.0, 0.0)):
    """A tube from the bed through the surface; its frame has the bed at z = 0."""
    tube = Section(D, 0.03)
    return assemble(
        Structure(
            "cylinder",
            {"a": bottom, "b": top},
            (Member("m", "a", "b", tube, tube, STEEL),),
            sea_level_z_m=DEPTH,
        ),
        subdivide=10,
    )


def resultant(assembly, loads):
    """Total force and overturning moment about the bed."""
    nodes = assembly.mesh.coordinates
    six = (assembly.expand @ loads).reshape(-1, 6)
    return six[:, :3].sum(0), (np.cross(nodes, six[:, :3]) + six[:, 3:]).sum(0)


def test_inertia_on_a_vertical_cylinder() -> None:
    """F = ρ C_M (π/4)D² g (H/2) tanh kd; moment arm d − (cosh kd − 1)/(k sinh kd) about the bed."""
    assembly = cylinder()
    grid = morison_points(assembly, highest_z=10.0, coefficients=Coefficients(drag=0.0), spacing=1.0)
    wave = airy_wave(height=2.0, period=9.0, depth=DEPTH, phase=-np.pi / 2)  # acceleration at its largest
    force, moment = resultant(assembly, wave_loads(grid, wave, np.zeros(1))[0])
    k = float(wave.k[0])
    F = RHO * 2.0 * 0.25 * np.pi * D**2 * 9.80665 * 1.0 * np.tanh(k * DEPTH)
    arm = DEPTH - (np.cosh(k * DEPTH) - 1.0) / (k * np.sinh(k * DEPTH))
    # two Gauss points a metre
    np.testing.assert_allclose([force[0], moment[1]], [F, F * arm], rtol=1e-4)
    np.testing.assert_allclose([force[1:], moment[[0, 2]]], 0.0, atol=1e-6 * F)


def test_drag_on_a_vertical_cylinder() -> None:
    """F = ½ρ C_D D a²ω² (sinh 2kd + 2kd)/(4k sinh² kd) under the crest."""
    assembly = cylinder()
    grid = morison_points(
        assembly, highest_z=10.0, coefficients=Coefficients(added_mass=0.0, pressure=0.0), spacing=1.0
    )
    wave = airy_wave(height=2.0, period=9.0, depth=DEPTH)
    force, _ = resultant(assembly, wave_loads(grid, wave, np.zeros(1))[0])
    k, omega = float(wave.k[0]), float(wave.omega[0])
    F = (
        0.5
        * RHO
        * D
        * omega**2
        * (np.sinh(2 * k * DEPTH) + 2 * k * DEPTH)
        / (4 * k * np.sinh(k * DEPTH) ** 2)
    )
    assert force[0] == pytest.approx(F, rel=1e-4)


def test_wheeler_loads_the_crest() -> None:
    """Uniform current under a crest 3 m high: the wet length is d + η."""
    assembly = cylinder()
    grid = morison_points(
        assembly, highest_z=10.0, coefficients=Coefficients(added_mass=0.0, pressure=0.0), spacing=0.5
    )
    still = airy_wave(height=1e-9, period=9.0, depth=DEPTH, stretching="wheeler")
    current = Current(depth=DEPTH, subsurface_m_s=1.0)
    force, _ = resultant(assembly, wave_loads(grid, still, np.zeros(1), current=current)[0])
    # ∫(1 + z/d)^(2/7) dz = 7d/9
    assert force[0] == pytest.approx(0.5 * RHO * D * DEPTH * 7 / 9, rel=1e-3)
    for stretching, wet in (("wheeler", DEPTH + 3.0), ("none", DEPTH)):
        wave = airy_wave(height=6.0, period=9.0, depth=DEPTH, stretching=stretching)
        eta = wave.surface(grid.points, np.zeros(1))
        assert float((grid.weight * wetness(grid, eta)).sum()) == pytest.approx(wet, rel=1e-9)


@pytest.mark.parametrize("tilt", [0.0, 0.3, 1.2])
def test_a_current_pushes_an_inclined_cylinder_normally(tilt: float) -> None:
    """Cross-flow principle: F = ½ρ C_D D L U² cos²β, normal to the axis."""
    L = 20.0
    bottom, top = (0.0, 0.0, 5.0), (L * np.sin(tilt), 0.0, 5.0 + L * np.cos(tilt))
    assembly = cylinder(top, bottom)
    grid = morison_points(assembly, highest_z=0.0)
    u = np.zeros((grid.weight.size, 3))
    u[:, 0] = 1.5
    force, _ = resultant(assembly, nodal_loads(grid, point_forces(grid, u, 0 * u)))
    F = 0.5 * RHO * D * L * (1.5 * np.cos(tilt)) ** 2
    np.testing.assert_allclose(force, [F * np.cos(tilt), 0.0, -F * np.sin(tilt)], rtol=1e-9, atol=1e-6 * F)


def test_moving_with_the_water_feels_no_drag() -> None:
    assembly = cylinder()
    grid = morison_points(assembly, highest_z=0.0, coefficients=Coefficients(added_mass=0.0, pressure=0.0))
    u = np.full((grid.weight.size, 3), 0.7)
    np.testing.assert_array_equal(point_forces(grid, u, 0 * u, velocity=u), 0.0)


def test_added_mass_and_displaced_water() -> None:
    assembly = cylinder()
    grid = morison_points(assembly, highest_z=10.0, coefficients=Coefficients(added_mass=0.8))
    shift = np.tile([1.0, 0, 0, 0, 0, 0], assembly.n_dof // 6)
    lift = np.tile([0, 0, 1.0, 0, 0, 0], assembly.n_dof // 6)
    A = added_mass(grid)
    assert shift @ (A @ shift) == pytest.approx(RHO * 0.8 * 0.25 * np.pi * D**2 * DEPTH, rel=1e-9)
    assert abs(lift @ (A @ lift)) < 1e-6


def test_linear_drag_damping_is_borgmans() -> None:
    """The linear coefficient with the least squared error for a Gaussian velocity, by sampling."""
    assembly = cylinder()
    grid = morison_points(assembly, highest_z=10.0)
    sigma = np.full(grid.weight.size, 0.8)
    shift = np.tile([1.0, 0, 0, 0, 0, 0], assembly.n_dof // 6)
    c = shift @ (drag_damping(grid, sigma) @ shift)
    v = 0.8 * np.random.default_rng(0).standard_normal(200_000)
    best = (np.abs(v) * v * v).mean() / (v * v).mean()
    assert c == pytest.approx(0.5 * RHO * D * DEPTH * best, rel=0.01)  # 200 000 samples: 0.3 %


def test_growth_widens_and_dry_structures_are_refused() -> None:
    growth = Coefficients(growth=(GrowthBand(2.0, -10.0, 0.1),))
    grid = morison_points(cylinder(), highest_z=0.0, coefficients=growth)
    z = grid.points[:, 2]
    np.testing.assert_allclose(grid.diameter, np.where((z <= 2.0) & (z >= -10.0), D + 0.2, D), rtol=1e-9)
    with pytest.raises(InputError, match="water"):
        morison_points(cylinder((0, 0, 90.0), (0, 0, 60.0)), highest_z=5.0)


def test_an_airy_wave_on_the_jacket_agrees_with_the_sum_over_its_members() -> None:
    """Nodal loads carry the whole force and moment of the Gauss points."""
    assembly = assemble(read_structure("jacket15"))
    grid = morison_points(assembly, highest_z=5.0)
    wave = airy_wave(height=8.0, period=11.0, depth=72.0, direction=0.4)
    u, du = wave.motion(grid.points, np.array([1.5]))
    at_points = point_forces(grid, u, du)[0]
    force, moment = resultant(assembly, nodal_loads(grid, at_points))
    arms = grid.points + [0.0, 0.0, 72.0]
    np.testing.assert_allclose(force, at_points.sum(0), rtol=1e-9)
    np.testing.assert_allclose(moment, np.cross(arms, at_points).sum(0), rtol=1e-9, atol=1e-3 * abs(force[0]))
