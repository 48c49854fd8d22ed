"""Equivalent depths of layers (Georgiadis 1983)."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil.ground.layering import equivalent_depths, equivalent_points
from jackettwin.soil.ground.profile import Clay, Layer, Point, Sand, Scour, SoilProfile
from jackettwin.soil.ground.py_curves import sand_coefficients
from jackettwin.soil.piles.piles import Pile
from jackettwin.soil.piles.reaction_curves import CurveOptions, linearised, pile_curves

PILE = Pile(40.0, 2.0, 0.05)
GEORGIADIS = CurveOptions(layering="georgiadis")
# two hundred trapezoids a layer, whose force has a kink
TRAPEZOIDS = 1e-3


@pytest.mark.parametrize(
    "soil",
    [
        {"sand": Sand(35.0)},
        {"clay": Clay((40e3, 40e3))},
        {"clay": Clay((120e3, 120e3), 0.005, stiff=True)},
    ],
    ids=["sand", "soft", "stiff"],
)
def test_a_cut_through_one_soil_changes_nothing(soil: dict[str, Sand | Clay]) -> None:
    cut = tuple(Layer(height, 9e3, **soil) for height in (5.0, 11.0, 24.0))
    for scour in (0.0, 3.0):
        ground = SoilProfile(cut, Scour(general_m=scour))
        plain, layered = (pile_curves(PILE, ground, options).py for options in (CurveOptions(), GEORGIADIS))
        for one, other in zip(plain, layered, strict=True):
            assert other.capacity == pytest.approx(one.capacity, rel=TRAPEZOIDS)
            assert other.initial_stiffness == pytest.approx(one.initial_stiffness, rel=TRAPEZOIDS)


def test_loose_sand_over_dense_in_closed_form() -> None:
    """Cyclic wedges, A = 0.9: γ1 (C1 H³/3 + C2 D H²/2) = γ2 (C1' h³/3 + C2' D h²/2)."""
    H, D, weights = 6.0, 2.0, (8e3, 10e3)
    (a1, a2, _), (b1, b2, _) = (sand_coefficients(phi) for phi in (30.0, 38.0))
    force = weights[0] * (a1 * H**3 / 3 + a2 * D * H**2 / 2)
    roots = np.roots([weights[1] * b1 / 3, weights[1] * b2 * D / 2, 0.0, -force])
    wanted = float(roots[np.abs(roots.imag) < 1e-9].real.max())
    ground = SoilProfile((Layer(H, weights[0], Sand(30.0)), Layer(40.0, weights[1], Sand(38.0))))

    def resistance(point: Point) -> float:
        assert isinstance(point.soil, Sand)
        C1, C2, C3 = sand_coefficients(point.soil.friction_angle_deg)
        return 0.9 * min(C1 * point.depth_m + C2 * D, C3 * D) * point.stress_pa

    assert equivalent_depths(ground, resistance) == [0.0, pytest.approx(wanted, rel=TRAPEZOIDS)]
    curves = pile_curves(PILE, ground, CurveOptions(cyclic=True, layering="georgiadis"))
    # a metre and a half into the dense sand
    z = float(curves.at.depth[np.flatnonzero(curves.at.layer == 1)[2]])
    zeta = wanted + z - H
    p_u = 0.9 * (b1 * zeta + b2 * D) * weights[1] * zeta
    at = int(np.flatnonzero((curves.at.layer == 1) & (curves.at.depth == z))[0])
    assert curves.py[at].capacity == pytest.approx(p_u, rel=TRAPEZOIDS)


def test_soft_clay_holds_the_sand_below_it_less_than_its_weight_tells() -> None:
    ground = SoilProfile((Layer(8.0, 6e3, clay=Clay((5e3, 15e3), 0.02)), Layer(40.0, 10e3, Sand(38.0))))
    plain, layered = (pile_curves(PILE, ground, options) for options in (CurveOptions(), GEORGIADIS))
    sand = plain.at.layer == 1
    capacities = np.array([[c.capacity for c in curves.py] for curves in (plain, layered)])
    np.testing.assert_array_equal(capacities[0, ~sand], capacities[1, ~sand])
    assert (capacities[1, sand] < capacities[0, sand]).all()
    # shafts and tips know nothing of it
    np.testing.assert_array_equal(linearised(plain).axial, linearised(layered).axial)


def test_what_has_no_equivalent_depth_is_refused() -> None:
    ground = (Layer(5.0, 9e3, Sand(35.0)), Layer(40.0, 9e3, clay=Clay((20e3, 20e3))))
    with pytest.raises(InputError, match="local scour"):
        pile_curves(PILE, SoilProfile(ground, Scour(local_m=1.0)), GEORGIADIS)
    with pytest.raises(InputError, match="overburden, georgiadis"):
        pile_curves(PILE, SoilProfile(ground), CurveOptions(layering="api"))
    nothing = (Layer(5.0, 9e3, Sand(35.0)), Layer(40.0, 0.0, clay=Clay((0.0, 0.0))))
    with pytest.raises(InputError, match="no equivalent depth"):
        pile_curves(PILE, SoilProfile(nothing), GEORGIADIS)


def test_the_mean_strength_counts_from_the_equivalent_surface() -> None:
    """Above the layer's top its clay is as strong as there: (s h + ∫ s_u dz)/(h + z − top)."""
    upper, lower, H, t = 100e3, 220e3, 5.0, 12.0
    soft = Layer(H, 8e3, clay=Clay((15e3, 15e3)))
    ground = SoilProfile((soft, Layer(t, 9e3, clay=Clay((upper, lower), 0.005, stiff=True))))

    def resistance(point: Point) -> float:
        return point.strength_pa * point.depth_m

    _, h = equivalent_depths(ground, resistance)
    points = [
        one for one in equivalent_points(ground, np.array([9.0, 14.0]), [1, 1], resistance) if one is not None
    ]
    for z, point in zip((9.0, 14.0), points, strict=True):
        here = upper + (lower - upper) * (z - H) / t
        assert point.depth_m == pytest.approx(h + z - H)
        assert point.strength_pa == pytest.approx(here)
        wanted = (upper * h + 0.5 * (upper + here) * (z - H)) / (h + z - H)
        assert point.mean_strength_pa == pytest.approx(wanted)
