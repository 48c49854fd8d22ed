"""Damping by radiated waves, against closed forms of one cylinder."""

import numpy as np
import pytest
from scipy.special import h1vp

from jackettwin.loads import radiation_damping, wave_number
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
