"""Damping by radiated waves, against closed forms of one cylinder."""

import numpy as np
import pytest
from scipy.special import h1vp

from jackettwin.loads import airy_wave, nodal_loads, point_forces, radiation_damping, wave_number
from jackettwin.loads.members.morison import MorisonPoints, morison_points
from jackettwin.structure import Assembly, Material, Member, Reaction, Section, Structure, assemble

G, RHO, DEPTH = 9.80665, 1025.0, 20.0


def cylinder(diameter: float, *, away: float = 0.0) -> tuple[Assembly, MorisonPoints]:
    """Return a column from the bed to 10 m above the water."""
    tube = Section(diameter, 0.02 * diameter)
    member = Member("column", "foot", "top", tube, tube, Material(), "tower")
    nodes = {"foot": (away, 0.0, -DEPTH), "top": (away, 0.0, 10.0)}
    assembly = assemble(Structure("column", nodes, (member,), reactions=(Reaction("foot"),)))
    return assembly, morison_points(assembly, highest_z=0.0, spacing=0.1)


def surge(assembly: Assembly) -> np.ndarray:
    return np.tile([1.0, 0, 0, 0, 0, 0], assembly.n_dof // 6)


@pytest.mark.parametrize(("omega", "diameter"), [(0.9, 1.0), (2.0, 4.0)])
def test_surge_of_a_cylinder(omega: float, diameter: float) -> None:
    """MacCamy and Fuchs: X = 4ρg/k² · tanh kd/|H₁′(ka)|, and ∫ cos²β dβ = π in Haskind's relation."""
    assembly, grid = cylinder(diameter)
    k = float(wave_number(omega, DEPTH))
    group = 0.5 * omega / k * (1.0 + 2.0 * k * DEPTH / np.sinh(2.0 * k * DEPTH))
    X = 4.0 * RHO * G / k**2 * np.tanh(k * DEPTH) / abs(h1vp(1, 0.5 * k * diameter))
    found = radiation_damping(grid, surge(assembly), omega, DEPTH)
    # Gauss points of 0.1 m under e^{kz}
    assert found == pytest.approx(k * X**2 / (8.0 * RHO * G * group), rel=2e-3)


def test_it_depends_on_the_motion_and_not_on_the_place() -> None:
    here, there = cylinder(2.0), cylinder(2.0, away=70.0)
    one, other = (radiation_damping(grid, surge(a), 1.5, DEPTH) for a, grid in (here, there))
    assert other == pytest.approx(one, rel=1e-6)
    assert radiation_damping(here[1], 2.0 * surge(here[0]), 1.5, DEPTH) == pytest.approx(4.0 * one)
    # a column that turns about its own axis moves no water
    yaw = np.tile([0, 0, 0, 0, 0, 1.0], here[0].n_dof // 6)
    assert radiation_damping(here[1], yaw, 1.5, DEPTH) == 0.0


def test_heave_beside_sway_by_the_forces_of_waves() -> None:
    """Haskind's relation with the inertia forces that the sea's own waves exert, a quarter of a period apart.

    A slender column sways towards a level brace that heaves some 7 m away: waves of one add to those of the
    other with the quarter of a wave by which the water's two components differ.
    """
    tube = Section(0.2, 0.01)
    column = Member("column", "low", "knee", tube, tube, Material(), "jacket")
    brace = Member("brace", "knee", "far", tube, tube, Material(), "jacket")
    nodes = {"low": (0.0, 0.0, -8.0), "knee": (0.0, 0.0, -2.0), "far": (10.0, 0.0, -2.0)}
    assembly = assemble(Structure("knee", nodes, (column, brace), reactions=(Reaction("low"),)))
    grid = morison_points(assembly, highest_z=0.0, spacing=0.2)
    shape = np.zeros(assembly.n_dof)
    for node, moved in (("low", (1.0, 0.0, 0.0)), ("knee", (1.0, 0.0, 0.0)), ("far", (1.0, 0.0, 1.0))):
        shape[assembly.dofs(node)[:3]] = moved
    omega = 1.3
    k = float(wave_number(omega, DEPTH))
    group = 0.5 * omega / k * (1.0 + 2.0 * k * DEPTH / np.sinh(2.0 * k * DEPTH))
    square = []
    for heading in np.arange(72) * 2.0 * np.pi / 72:
        wave = airy_wave(height=2.0, period=2.0 * np.pi / omega, depth=DEPTH, direction=float(heading))
        _, du = wave.motion(grid.points, np.array([0.0, 0.5 * np.pi / omega]))
        square.append(np.sum((nodal_loads(grid, point_forces(grid, 0.0 * du, du)) @ shape) ** 2))
    found = radiation_damping(grid, shape, omega, DEPTH)
    # the factor of MacCamy and Fuchs at ka = 0.02
    assert found == pytest.approx(k / (4.0 * RHO * G * group) * np.mean(square), rel=5e-3)
