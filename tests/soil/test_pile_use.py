"""The use of a pile: capacities by hand, balance of forces, the steel's own check along its length."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.checks import DesignBasis
from jackettwin.soil import head_forces, pile_use
from jackettwin.soil.ground.curves import Tanh
from jackettwin.soil.piles.capacity import pushover
from jackettwin.soil.piles.piles import Pile, stations
from jackettwin.soil.piles.reaction_curves import PileCurves
from jackettwin.soil.support import Spring, Support

PILE = Pile(30.0, 1.5, 0.04)
BASIS = DesignBasis(345e6)


def ground(p_u: float, t_u: float, q_u: float) -> PileCurves:
    """Ground of the same strength everywhere, reached within millimetres."""
    at = stations(PILE)
    py, tz = (tuple(Tanh(v, 300.0 * v) for _ in at.depth) for v in (p_u, t_u))
    return PileCurves(at, py, tz, Tanh(q_u, 300.0 * q_u), PILE.outer_diameter_m)


GROUND = ground(4e5, 2e5, 2e6)


def used(*force: float, resistance: float = 1.25):
    return pile_use("foot", PILE, GROUND, np.array(force), basis=BASIS, resistance=resistance)


@pytest.mark.parametrize(("Fz", "capacity"), [(-4e6, 6e6 * (1.0 + 1.42 / 1.5) + 2e6), (4e6, 6e6)])
def test_axial_use_is_factored_demand_over_capacity(Fz: float, capacity: float) -> None:
    """30 m at 200 kN/m outside, 1.42/1.5 of it inside, 2 MN below; tension has the outside alone."""
    found = used(0.0, 0.0, Fz, 0.0, 0.0, 0.0)
    assert found.axial == pytest.approx(1.25 * 4e6 / capacity)
    assert used(0.0, 0.0, Fz, 0.0, 0.0, 0.0, resistance=1.5).axial == pytest.approx(1.2 * found.axial)


def test_steel_is_used_most_at_the_head_under_axial_force_alone() -> None:
    """γ_c N/A over f_yc, D/t 37.5: f_y; the first element's column is some decimetres long."""
    found = used(0.0, 0.0, -5e6, 0.0, 0.0, 0.0)
    assert found.steel is not None
    A = np.pi / 4.0 * (1.5**2 - 1.42**2)
    # friction takes 0.2 MN a metre: half an element's worth of it acts at the head's own node
    assert found.steel.by_check["compression"] == pytest.approx(1.18 * 5e6 / A / 345e6, rel=0.02)
    assert found.steel_depth_m == 0.0


def test_a_moment_on_the_head_is_the_largest_of_the_pile() -> None:
    found = used(0.0, 0.0, 0.0, 0.0, 3e6, 0.0)
    assert found.steel is not None
    ends = found.steel.worst.end_forces
    assert np.abs(ends[:, 4:]).max() == pytest.approx(3e6, rel=1e-6)
    assert found.steel_depth_m == 0.0


def test_a_lateral_force_is_used_below_the_head_and_any_way_round() -> None:
    """Plastic ground: shear ends after H/p, where the moment is H²/2p; heading does not matter."""
    H = 2e6
    found, turned = used(H, 0.0, 0.0, 0.0, 0.0, 0.0), used(0.0, -H, 0.0, 0.0, 0.0, 0.0)
    assert found.steel is not None and turned.steel is not None
    moment = float(np.hypot(*found.steel.worst.forces[4:]))
    assert moment == pytest.approx(0.5 * H**2 / 4e5, rel=0.15)  # the ground is not plastic all the way down
    assert found.steel_depth_m == pytest.approx(H / 4e5, abs=1.5)
    assert turned.steel.utilisation == pytest.approx(found.steel.utilisation, rel=1e-6)
    assert turned.head_m == pytest.approx(found.head_m, rel=1e-6)


@pytest.mark.parametrize(("arm", "heading"), [(0.0, 0.0), (4.0, 2.1), (-3.0, 4.0)])
def test_lateral_use_is_demand_over_the_load_at_the_same_arm(arm: float, heading: float) -> None:
    """γ_R H over the pushover's load, whichever way the head is pushed; Broms's long pile for its size."""
    c, s = np.cos(heading), np.sin(heading)
    H = 0.5e6
    found = used(H * c, H * s, -1e6, -H * arm * s, H * arm * c, 0.0)
    limit = pushover(PILE, GROUND, arm_m=arm, yield_strength_pa=345e6).ultimate_n
    assert found.lateral == pytest.approx(1.25 * H / limit, rel=1e-3)
    if arm == 0.0:
        M_p = 345e6 * (1.5**3 - 1.42**3) / 6.0
        # the hinge, twelve metres deep, is not whole yet
        assert 0.6 < limit / np.sqrt(2.0 * 4e5 * M_p) < 1.0
    assert used(0.0, 0.0, -1e6, 0.0, 0.0, 0.0).lateral == 0.0
    turned = used(0.0, 0.0, 0.0, 0.0, 1e6, 0.0)
    assert 0.0 < turned.lateral < np.inf
    assert turned.worst >= turned.lateral


def test_beyond_the_ground_nothing_stands() -> None:
    found = used(0.0, 0.0, 9e6, 0.0, 0.0, 0.0)
    assert not found.stands
    assert found.axial == pytest.approx(1.25 * 9e6 / 6e6)
    assert (found.head_m, found.steel, found.steel_depth_m) == (None, None, None)


def test_ground_without_friction_carries_no_tension() -> None:
    bare = replace(GROUND, tz=tuple(Tanh(0.0, 0.0) for _ in GROUND.tz))
    found = pile_use("foot", PILE, bare, np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), basis=BASIS)
    assert found.axial == np.inf


def test_head_forces_are_all_springs_of_a_foot() -> None:
    one, other = np.diag(np.arange(1.0, 7.0)), np.eye(6)
    support = Support(springs=(Spring("a", one), Spring("b", one), Spring("a", other)))
    found = head_forces(support, {"a": np.full(6, 2.0)})
    np.testing.assert_allclose(found["a"], 2.0 * (np.arange(1.0, 7.0) + 1.0))
    assert set(found) == {"a"}
