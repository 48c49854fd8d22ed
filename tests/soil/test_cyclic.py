"""A pile in ground that unloads: against the linear pile, the pushed pile, and the books of energy."""

import numpy as np
import pytest

from jackettwin.soil.ground.curves import Tanh
from jackettwin.soil.ground.profile import Clay, Layer, Sand, SoilProfile
from jackettwin.soil.piles.capacity import push
from jackettwin.soil.piles.cyclic import CyclicPile, Sliders, advance, cyclic_pile, drive, loop
from jackettwin.soil.piles.impedance import head_impedance
from jackettwin.soil.piles.piles import Pile, stations
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised, pile_curves

PILE = Pile(30.0, 2.0, 0.05, element_m=2.0)
GROUND = SoilProfile((Layer(10.0, 8e3, clay=Clay((60e3, 80e3), 0.01)), Layer(40.0, 10e3, Sand(35.0))))


@pytest.fixture(scope="module")
def curves() -> PileCurves:
    return pile_curves(PILE, GROUND)


@pytest.fixture(scope="module")
def pile(curves) -> CyclicPile:
    return cyclic_pile(PILE, curves)


def test_small_motions_meet_the_initial_stiffness(pile, curves) -> None:
    """A micrometre: below where the first slider of p-y yields (20 µm), so linear."""
    K = head_impedance(PILE, linearised(curves), 0.0)[0].real
    for direction in np.eye(6)[[0, 1, 2]]:
        force, _ = advance(pile, pile.at_rest(), 1e-6 * direction)
        np.testing.assert_allclose(force / 1e-6, K @ direction, atol=0.005 * np.abs(K @ direction).max())


def test_first_loading_is_the_pushed_pile(pile, curves) -> None:
    """Head of ``push`` along its own path; springs act along each axis, so one lateral direction only."""
    load = np.array([1.5e6, 0.0, -2.0e6, 0.0, 0.0, 0.0])
    heads = np.array(
        [push(PILE, curves, share * load, steps=4).displacement[0] for share in (0.25, 0.5, 0.75, 1.0)]
    )
    # chords between 24 sliders in geometric progression lie up to 3 % below the curve
    np.testing.assert_allclose(drive(pile, heads)[-1][[0, 2]], load[[0, 2]], rtol=0.03)


def test_a_cycle_closes_and_its_area_is_what_the_sliders_lose(pile) -> None:
    """∮F·dq of the head = Σ ∮p dy of the ground: steel keeps nothing."""
    path = 0.03 * np.sin(np.linspace(0.0, 4.5 * np.pi, 181))[:, None] * np.array([1.0, 0, 0.2, 0, 0, 0])
    held, forces, moved, reaction = pile.at_rest(), [], [], []
    for head in path:
        force, held = advance(pile, held, head)
        forces.append(force)
        moved.append(held.u[pile.dof])
        stretch = held.u[pile.dof][:, None] - held.sliders
        reaction.append((pile.springs.stiffness * stretch).sum(axis=1))
    F, y, p = np.array(forces), np.array(moved), np.array(reaction)
    np.testing.assert_allclose(F[180], F[100], rtol=1e-6, atol=1e-6 * np.abs(F).max())
    cycle = slice(100, 181)
    head = np.trapezoid(F[cycle], path[cycle], axis=0).sum()
    ground = np.trapezoid(p[cycle], y[cycle], axis=0).sum()
    assert head > 0.0
    # chords of both sides over 80 steps: they agree step by step, as equilibrium holds at each
    assert head == pytest.approx(ground, rel=1e-6)


def test_the_ground_softens_and_loses_more_as_it_moves_more(pile) -> None:
    loops = [loop(pile, A * np.eye(6)[0]) for A in (1e-4, 1e-3, 1e-2, 1e-1)]
    stiffness, eta = np.array(loops).T
    assert (np.diff(stiffness) < 0.0).all()
    assert (np.diff(eta) > 0.0).all()
    assert 0.0 <= eta[0] < 0.1 < eta[-1] < 2.0 / np.pi  # a rigid-plastic loop: 4/(2π)


def test_a_stiff_short_pile_is_the_sum_of_its_springs() -> None:
    """Translation without rotation of a rigid pile: F = L p(y), loss by Masing's integral of one tanh."""
    curve = Tanh(capacity=1e5, initial_stiffness=1e7)
    short = Pile(4.0, 3.0, 1.5, element_m=2.0)
    at = stations(short)
    every = (curve,) * at.depth.size
    springs = cyclic_pile(short, PileCurves(at, every, every, curve, 3.0))
    A = 0.02
    found = loop(springs, A * np.eye(6)[0], steps=400)
    integral = 1e5**2 / 1e7 * np.log(np.cosh(1e7 * A / 1e5))
    p = float(curve.force(A))
    # solid steel 3 m thick bends by 1e-4 of the motion; chords of the sliders and of 400 steps
    assert found.stiffness == pytest.approx(4.0 * p / A, rel=0.01)
    assert found.loss_factor == pytest.approx(8.0 * (integral - 0.5 * p * A) / (np.pi * p * A), rel=0.02)


def test_sliders_of_every_family_are_there(pile, curves) -> None:
    n = curves.at.depth.size
    assert isinstance(pile.springs, Sliders)
    assert pile.dof.size == 3 * n + 1
    assert pile.dof[-1] == 6 * (curves.at.node_depth.size - 1) + 2
