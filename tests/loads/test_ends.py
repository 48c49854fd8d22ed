"""Loads on member ends against closed forms, and against what they leave of a short member."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import SEA_WATER_KG_M3, Coefficients, GrowthBand
from jackettwin.loads.members.ends import EndCoefficients, end_forces, member_ends
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.regular_waves import RegularWave
from jackettwin.loads.sea.waves import airy_wave, irregular_sea
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member, Reaction

DEPTH, T, D = 50.0, 10.0, 2.0
TUBE = Section(D, 0.05)
WAVE = airy_wave(height=4.0, period=T, depth=DEPTH)
TIMES = np.linspace(0.0, T, 41)


def ends_of(*members: tuple[tuple[float, ...], tuple[float, ...]], growth=(), **coefficients: float):
    """Ends of tubes between points given in z from still water; equal points are one joint."""
    nodes: dict[tuple[float, ...], str] = {}
    for pair in members:
        for point in pair:
            nodes.setdefault(point, f"n{len(nodes)}")
    structure = Structure(
        "ends",
        {name: point for point, name in nodes.items()},
        tuple(Member(f"m{i}", nodes[a], nodes[b], TUBE, TUBE, STEEL) for i, (a, b) in enumerate(members)),
        sea_level_z_m=0.0,
    )
    water = Coefficients(growth=growth)
    return member_ends(
        assemble(structure), EndCoefficients(**coefficients), water, highest_z=0.0, lowest_z=-DEPTH
    )


def test_pressure_on_a_standing_tube() -> None:
    """−pA up on its top, +pA on its bottom; p = ρ g a cosh k(z+d)/cosh kd cos ωt."""
    ends = ends_of(((0.0, 0.0, -40.0), (0.0, 0.0, -10.0)), pressure=1.0)
    forces = end_forces(ends, WAVE, TIMES)
    k = float(WAVE.k[0])
    for i, (z, sign) in enumerate(((-40.0, 1.0), (-10.0, -1.0))):
        p = SEA_WATER_KG_M3 * 9.80665 * 2.0 * np.cosh(k * (z + DEPTH)) / np.cosh(k * DEPTH)
        wanted = sign * p * 0.25 * np.pi * D**2 * np.cos(2.0 * np.pi * TIMES / T)
        np.testing.assert_allclose(forces[:, i, 2], wanted, atol=1e-9 * p)
    np.testing.assert_allclose(forces[..., :2], 0.0, atol=1e-9)


def test_pressure_on_both_ends_is_the_froude_krylov_force_along_a_short_member() -> None:
    """−A dp = ρ A L u̇ along the member: Euler's equation, in any of the linear theories."""
    ends = ends_of(((0.0, 0.0, -12.0), (0.1, 0.0, -12.05)), pressure=1.0)
    middle, along = ends.points.mean(axis=0)[None], np.array([0.1, 0.0, -0.05])
    for wave in (WAVE, irregular_sea(Hs=3.0, Tp=9.0, depth=DEPTH, duration=200.0, seed=1, stretching="none")):
        total = end_forces(ends, wave, TIMES).sum(axis=1)
        du = wave.motion(middle, TIMES)[1][:, 0]
        wanted = SEA_WATER_KG_M3 * 0.25 * np.pi * D**2 * np.outer(du @ along, along / np.linalg.norm(along))
        # 0.1 m of 10 s waves: differences of p to 1e-5 of the force
        np.testing.assert_allclose(total, wanted, atol=1e-4 * np.abs(wanted).max())


def test_legs_run_through_and_braces_do_not() -> None:
    """A leg in two pieces has no end at the joint; two braces meeting it at 45° leave 2A cos 45° = √2 A."""
    joint = (0.0, 0.0, -20.0)
    ends = ends_of(
        ((0.0, 0.0, -30.0), joint),
        (joint, (0.0, 0.0, -10.0)),
        (joint, (10.0, 0.0, -10.0)),
        (joint, (10.0, 0.0, -30.0)),
        pressure=1.0,
    )
    at = int(np.flatnonzero(ends.points[:, 2] == -20.0)[0])
    A = 0.25 * np.pi * D**2
    np.testing.assert_allclose(ends.area[at], [-np.sqrt(2.0) * A, 0.0, 0.0], atol=1e-12)


def test_acceleration_and_drag_at_an_end() -> None:
    """ρ C_a (2π/3)R³ u̇ across a free end along x, and ¼ρC_d A|u|u in a current; growth widens both."""
    R = 0.5 * D + 0.1
    growth = (GrowthBand(0.0, -50.0, 0.1),)
    line = ((0.0, 0.0, -20.0), (8.0, 0.0, -20.0))
    ends = ends_of(line, growth=growth, added_mass=0.7)
    du = WAVE.motion(ends.points, TIMES)[1]
    wanted = SEA_WATER_KG_M3 * 0.7 * 2.0 * np.pi / 3.0 * R**3 * du[..., 0]
    np.testing.assert_allclose(end_forces(ends, WAVE, TIMES)[..., 0], wanted, rtol=1e-9, atol=1e-6)
    calm = airy_wave(height=0.0, period=T, depth=DEPTH)
    ends = ends_of(line, growth=growth, drag=0.8)
    force = end_forces(ends, calm, np.zeros(1), current=Current(DEPTH, subsurface_m_s=2.0))[0, :, 0]
    u = 2.0 * (30.0 / 50.0) ** (1.0 / 7.0)
    np.testing.assert_allclose(force, 0.25 * SEA_WATER_KG_M3 * 0.8 * np.pi * R**2 * u**2, rtol=1e-9)


def test_bodies_are_closed() -> None:
    """Σ A = 0 of what lies under water, cones and bands of growth included; the ring of a cone by hand."""
    nodes = {"a": (0.0, 0.0, -40.0), "b": (1.0, 0.0, -25.0), "c": (2.0, 3.0, -10.0)}
    wide, narrow = Section(3.0, 0.05), Section(1.0, 0.05)
    structure = Structure(
        "cone",
        nodes,
        (Member("lower", "a", "b", wide, wide, STEEL), Member("upper", "b", "c", wide, narrow, STEEL)),
        sea_level_z_m=0.0,
    )
    for growth in ((), (GrowthBand(0.0, -20.0, 0.1), GrowthBand(-20.0, -30.0, 0.1, 0.0))):
        ends = member_ends(
            assemble(structure, subdivide=3),
            EndCoefficients(1.0, 1.0, 1.0),
            Coefficients(growth=growth),
            highest_z=0.0,
            lowest_z=-DEPTH,
        )
        np.testing.assert_allclose(ends.area.sum(axis=0), 0.0, atol=1e-9)
    cone = ends.points[3:, 2] > -20.0  # the joints come first; above the change of growth
    assert cone.any() and (ends.area[3:][cone, 2] > 0.0).all()  # what narrows upwards looks up


def test_waves_on_a_cone_do_work_where_it_stands() -> None:
    """Loads of rings go to the nodes of their element: force kept, moment as at the ring."""
    structure = Structure(
        "cone",
        {"a": (0.0, 0.0, -30.0), "b": (0.0, 0.0, -5.0)},
        (Member("m", "a", "b", Section(4.0, 0.05), Section(2.0, 0.05), STEEL),),
        sea_level_z_m=0.0,
    )
    assembly = assemble(structure, subdivide=2)
    ends = member_ends(
        assembly, EndCoefficients(pressure=1.0), Coefficients(), highest_z=0.0, lowest_z=-DEPTH
    )
    forces = end_forces(ends, WAVE, TIMES)
    lift = np.tile([0, 0, 1.0, 0, 0, 0], assembly.n_dof // 6)
    nodal = (ends.N @ forces.reshape(TIMES.size, -1).T).T
    np.testing.assert_allclose(nodal @ lift, forces[..., 2].sum(axis=1), atol=1e-6)
    # −∫p n dA by hand: p down the cone, its bottom and its top
    k = float(WAVE.k[0])
    z = np.linspace(-30.0, -5.0, 2001)
    p = SEA_WATER_KG_M3 * 9.80665 * 2.0 * np.cosh(k * (z + DEPTH)) / np.cosh(k * DEPTH)
    R = 2.0 - (z + 30.0) / 25.0
    wanted = p[0] * np.pi * R[0] ** 2 - p[-1] * np.pi * R[-1] ** 2
    wanted += np.trapezoid(p * 2.0 * np.pi * R * np.gradient(R, z), z)
    # rings of half a metre
    assert forces[0, :, 2].sum() == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize("bed", [-30.0, -29.999, -30.001, -29.99, -30.01])
def test_a_foot_in_the_ground_is_not_pressed_from_below(bed: float) -> None:
    """The top alone is, to the centimetre of the stated depth; a free end on the bed is open."""
    leg = Structure(
        "leg",
        {"foot": (0.0, 0.0, -30.0), "top": (0.0, 0.0, -5.0)},
        (Member("m", "foot", "top", TUBE, TUBE, STEEL),),
        reactions=(Reaction("foot"),),
        sea_level_z_m=0.0,
    )
    for structure, wanted in ((leg, 1), (replace(leg, reactions=()), 2 if bed <= -30.0 else 1)):
        ends = member_ends(
            assemble(structure), EndCoefficients(1.0), Coefficients(), highest_z=0.0, lowest_z=bed
        )
        assert ends.points.shape == (wanted, 3)
        assert ends.points[-1, 2] == -5.0


def test_joints_above_the_surface_are_dry() -> None:
    ends = ends_of(((0.0, 0.0, -5.0), (0.0, 0.0, 5.0)), pressure=1.0)
    assert ends.points.shape == (1, 3)


def test_pressure_of_a_steep_wave_is_that_of_a_small_one_when_it_is_small() -> None:
    """A single harmonic of 2 mm: Bernoulli's square is 1e-4 of the pressure."""
    k, omega, a = float(WAVE.k[0]), 2.0 * np.pi / T, 1e-3
    small = airy_wave(height=2.0 * a, period=T, depth=DEPTH)
    u = a * omega / np.tanh(k * DEPTH)
    steep = RegularWave(k, omega, DEPTH, np.array([a]), np.array([u]))
    points = np.array([[0.0, 0.0, -10.0], [3.0, 1.0, -30.0]])
    p = small.pressure(points, TIMES)
    np.testing.assert_allclose(steep.pressure(points, TIMES), p, atol=1e-3 * np.abs(p).max())


def test_negative_coefficients_are_refused() -> None:
    with pytest.raises(InputError, match="pressure"):
        EndCoefficients(pressure=-1.0)
