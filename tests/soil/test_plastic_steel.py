"""Steel that yields in a pushover, and multipliers of curves."""

import numpy as np
import pytest
from scipy.integrate import quad

from jackettwin.soil.ground.curves import Tanh
from jackettwin.soil.ground.profile import Clay, Layer, Sand, SoilProfile
from jackettwin.soil.piles.capacity import axial_capacity, pushover
from jackettwin.soil.piles.piles import Pile, stations
from jackettwin.soil.piles.plastic_steel import YieldingTube
from jackettwin.soil.piles.reaction_curves import PileCurves, pile_curves
from jackettwin.soil.piles.soil_curves import CurveOptions

TUBE = YieldingTube(2.0, 1.9, 210e9, 355e6)


def test_moment_and_curvature_are_integrals_of_stress() -> None:
    for ratio in (0.5, 1.0, 1.03, 1.5, 4.0, 100.0):
        kappa = ratio * TUBE.yield_curvature

        def stress(y: float, k: float = kappa) -> float:
            return float(np.clip(TUBE.E * k * y, -TUBE.f_y, TUBE.f_y))

        def width(y: float) -> float:
            return 2.0 * sum(sign * np.sqrt(max(R**2 - y**2, 0.0)) for sign, R in ((1.0, 1.0), (-1.0, 0.95)))

        breaks = [y for y in (0.95, TUBE.f_y / TUBE.E / kappa) if y < 1.0]
        wanted = 2.0 * quad(lambda y: stress(y) * width(y) * y, 0.0, 1.0, points=breaks, limit=200)[0]
        assert TUBE.moment(np.array([kappa]))[0][0] == pytest.approx(wanted, rel=1e-6)
        assert TUBE.moment(np.array([-kappa]))[0][0] == pytest.approx(-wanted, rel=1e-6)
    assert TUBE.moment(np.array([1e4 * TUBE.yield_curvature]))[0][0] == pytest.approx(
        TUBE.plastic_moment, rel=1e-6
    )


def test_the_slope_is_the_moment_s_derivative() -> None:
    kappa = TUBE.yield_curvature * np.array([0.3, 1.2, 2.0])
    h = 1e-6 * kappa
    slope = (TUBE.moment(kappa + h)[0] - TUBE.moment(kappa - h)[0]) / (2.0 * h)
    np.testing.assert_allclose(TUBE.moment(kappa)[1], slope, rtol=1e-5)


def test_a_long_pile_fails_by_a_hinge_as_broms_has_it() -> None:
    """Uniform plastic p, free head: H = √(2 p M_p), the hinge H/p deep (Broms 1964)."""
    pile, p, f_y = Pile(60.0, 2.0, 0.05, element_m=0.5), 8e5, 100e6
    at = stations(pile)
    curves = PileCurves(
        at,
        tuple(Tanh(p, 1e3 * p) for _ in at.depth),
        tuple(Tanh(1e5, 1e8) for _ in at.depth),
        Tanh(1e6, 1e9),
        2.0,
    )
    elastic, found = (pushover(pile, curves, steps=10, yield_strength_pa=f) for f in (None, f_y))
    M_p = YieldingTube(2.0, 1.9, pile.youngs_modulus_pa, f_y).plastic_moment
    H = np.sqrt(2.0 * p * M_p)
    # a tenth of a diameter leaves a part of the section elastic
    assert 0.95 * H < found.ultimate_n < 1.001 * H
    assert found.moment_nm.max() <= M_p
    assert found.hinge_m == pytest.approx(found.ultimate_n / p, abs=1.0)
    assert found.ductility is not None and found.ductility > 1.2
    assert elastic.ultimate_n > found.ultimate_n
    assert elastic.ductility is None


def test_strong_steel_is_elastic_steel() -> None:
    pile = Pile(40.0, 2.0, 0.05)
    curves = pile_curves(pile, SoilProfile((Layer(60.0, 9e3, clay=Clay((1e5, 1e5))),)))
    elastic, strong = (pushover(pile, curves, steps=4, yield_strength_pa=f) for f in (None, 1e11))
    np.testing.assert_allclose(strong.load_n, elastic.load_n, rtol=1e-6)
    np.testing.assert_allclose(strong.moment_nm, elastic.moment_nm, rtol=1e-6)


def test_multipliers_scale_reactions_and_leave_displacements() -> None:
    pile, profile = Pile(30.0, 2.0, 0.05), SoilProfile((Layer(60.0, 9e3, Sand(35.0)),))
    plain, group = (
        pile_curves(pile, profile, CurveOptions(p_multiplier=p, t_multiplier=t))
        for p, t in ((1.0, 1.0), (0.4, 0.8))
    )
    for one, other in zip(plain.py, group.py, strict=True):
        assert other.force(0.02) == pytest.approx(0.4 * one.force(0.02))
        assert other.initial_stiffness == pytest.approx(0.4 * one.initial_stiffness)
    a, b = (axial_capacity(pile, curves) for curves in (plain, group))
    assert b.shaft_n == pytest.approx(0.8 * a.shaft_n)
    assert b.tension_n == pytest.approx(0.8 * a.tension_n)
