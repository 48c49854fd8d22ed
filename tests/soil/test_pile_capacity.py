"""Capacity of piles against closed forms: summed friction, Broms's short pile."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil.ground.curves import TabulatedCurve, Tanh
from jackettwin.soil.ground.profile import Clay, Layer, Sand, SoilProfile
from jackettwin.soil.piles.capacity import axial_capacity, push, pushover
from jackettwin.soil.piles.piles import Pile, stations
from jackettwin.soil.piles.reaction_curves import PileCurves, pile_curves
from jackettwin.structure.model import STEEL

D, L = 2.0, 20.0
STUBBY = Pile(L, D, 0.05, 1e4 * STEEL.youngs_modulus_pa)


def plastic(pile: Pile, p_u: float, t_u: float = 1.0, q_u: float = 1.0) -> PileCurves:
    """Ground that resists by the same force everywhere, after a millimetre."""
    at = stations(pile)
    py, tz = (tuple(Tanh(v, 1e3 * v) for _ in at.depth) for v in (p_u, t_u))
    return PileCurves(at, py, tz, Tanh(q_u, 1e3 * q_u), D)


def test_axial_capacity_is_friction_times_length_and_the_tip() -> None:
    """API in clay: α s_u π D L of the outer shaft, 9 s_u A of the tip; α = 0.5/√(s_u/σ'_v) at ψ ≤ 1."""
    found = axial_capacity(STUBBY, plastic(STUBBY, 1e5, 2e5, 3e6))
    assert (found.shaft_n, found.tip_n) == pytest.approx((2e5 * L, 3e6))
    assert found.compression_n == pytest.approx(2e5 * L * (1.0 + 1.9 / 2.0) + 3e6)
    assert found.tension_n == found.shaft_n
    su, gamma = 60e3, 9e3
    curves = pile_curves(STUBBY, SoilProfile((Layer(30.0, gamma, clay=Clay((su, su))),)))
    z = np.linspace(0.0, L, 4001)
    psi = su / np.maximum(gamma * z, 1.0)
    alpha = np.minimum(np.where(psi <= 1.0, 0.5 * psi**-0.5, 0.5 * psi**-0.25), 1.0)
    # Simpson's rule in pieces of a metre on the fourth root of depth at the surface: half a per cent
    assert axial_capacity(STUBBY, curves).shaft_n == pytest.approx(
        np.trapezoid(alpha * su, z) * np.pi * D, rel=6e-3
    )


@pytest.mark.parametrize("declared", [False, True])
def test_an_open_pile_plugs_where_that_is_weaker(declared: bool) -> None:
    """API RP 2GEO 8.1: the smaller of outer friction with the whole base, and both frictions with the steel.

    Whatever the file says of the plug; a soft tip below a rough shaft plugs, a hard one does not.
    """
    pile = Pile(L, D, 0.05, plugged=declared)
    whole, steel = 0.25 * np.pi * D**2, 0.25 * np.pi * (D**2 - 1.9**2)
    for bearing, plugged in ((1e5, True), (1e7, False)):
        found = axial_capacity(pile, plastic(pile, 1e5, 2e5, bearing * pile.tip_area_m2))
        plug, core = 4e6 + bearing * whole, 4e6 * 1.95 + bearing * steel
        assert found.plugged is plugged
        assert found.compression_n == pytest.approx(min(plug, core))
        assert found.tension_n == pytest.approx(4e6)


@pytest.mark.parametrize("arm", [0.0, 10.0])
def test_a_stiff_short_pile_turns_over_as_broms_says(arm: float) -> None:
    """Uniform p, turning about a depth a: H = p (2a − L).

    With a load e above the head, H = p(2a − L) and p(L²/2 − a²) = −H e give
    a² + 2 e a − (L²/2 + e L) = 0 (Broms 1964).
    """
    p = 1e5
    a = -arm + np.sqrt(arm**2 + 0.5 * L**2 + arm * L)
    wanted = p * (2.0 * a - L)
    found = pushover(STUBBY, plastic(STUBBY, p), arm_m=arm, steps=4)
    # the pivot lies between nodes a metre apart
    assert found.ultimate_n == pytest.approx(wanted, rel=2e-3)
    assert (np.diff(found.head_m) > 0.0).all() and (np.diff(found.load_n) > -1e-6 * wanted).all()
    assert found.head_m[-1] <= 0.1 * D


@pytest.mark.parametrize("arm", [300.0, -30.0])
def test_a_far_load_and_a_deep_one_stop_at_the_limit_too(arm: float) -> None:
    """Small beside all that resists, or so deep that the head goes backwards: the load is found to 0.1 %."""
    pile = Pile(40.0, D, 0.05)
    curves = pile_curves(pile, SoilProfile((Layer(60.0, 9e3, clay=Clay((1e5, 1e5))),)))
    found = pushover(pile, curves, arm_m=arm, steps=2)
    more = 1.001 * found.ultimate_n
    beyond = push(pile, curves, np.array([more, 0.0, 0.0, 0.0, arm * more, 0.0])).displacement[0, 0]
    assert abs(found.head_m[-1]) <= 0.1 * D < abs(beyond)


def test_moments_are_those_of_the_loads_below_the_head() -> None:
    """The largest moment of a free head in uniform plastic ground: H e + H²/2p at depth H/p."""
    p, arm = 1e5, 3.0
    slender = Pile(60.0, D, 0.05, element_m=0.5)
    found = pushover(slender, plastic(slender, p), arm_m=arm, steps=3)
    H = found.load_n[-1]
    # the last millimetre of every spring is elastic
    assert found.moment_nm[-1] == pytest.approx(H * arm + H**2 / (2.0 * p), rel=0.05)


def test_ground_that_softens_is_followed_beyond_its_peak() -> None:
    """A stiff pile pushed at half its depth moves without turning: H = p(y) L, up and down."""
    at = stations(STUBBY)
    y, p = (0.0, 0.05, 0.12, 0.3), (0.0, 1e5, 6e4, 2e4)
    py = tuple(TabulatedCurve(y, p) for _ in at.depth)
    curves = PileCurves(at, py, tuple(Tanh(1e5, 1e8) for _ in at.depth), Tanh(1e6, 1e9), D)
    found = pushover(STUBBY, curves, arm_m=-0.5 * L, steps=20)
    np.testing.assert_allclose(found.load_n, L * np.interp(found.head_m, y, p), rtol=1e-4)
    assert found.highest_n == pytest.approx(1e5 * L, rel=1e-4)
    assert found.ultimate_n == pytest.approx(L * np.interp(0.1 * D, y, p), rel=1e-4)
    assert found.ultimate_n < 0.5 * found.highest_n


def test_load_of_a_moment_is_found_between_steps() -> None:
    found = pushover(Pile(60.0, D, 0.05), plastic(Pile(60.0, D, 0.05), 1e5), arm_m=50.0, steps=4)
    moment = 0.5 * (found.moment_nm[0] + found.moment_nm[1])
    assert found.first_load_n(moment) == pytest.approx(0.5 * (found.load_n[0] + found.load_n[1]))
    assert found.first_load_n(2.0 * found.moment_nm[-1]) is None
    assert found.first_load_n(0.5 * found.moment_nm[0]) == pytest.approx(0.5 * found.load_n[0])


def test_ground_that_holds_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="resists no lateral load"):
        pushover(STUBBY, plastic(STUBBY, 0.0))


def test_sand_carries_more_the_deeper() -> None:
    profile = SoilProfile((Layer(80.0, 10e3, Sand(35.0)),))
    piles = [Pile(length, D, 0.05) for length in (20.0, 40.0)]
    shallow, deep = (axial_capacity(pile, pile_curves(pile, profile)) for pile in piles)
    assert deep.shaft_n > 2.0 * shallow.shaft_n
