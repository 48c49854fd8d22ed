"""Loops of soil springs: backbone, Masing's rule, energy."""

import numpy as np
import pytest

from jackettwin.soil.ground.curves import TabulatedCurve, Tanh
from jackettwin.soil.piles.cyclic import move, sliders

CURVE = Tanh(capacity=1e6, initial_stiffness=1e8)
ONE = np.ones(1)


def trace(springs, path: np.ndarray, state=None) -> tuple[np.ndarray, np.ndarray]:
    state = springs.at_rest() if state is None else state
    forces = []
    for y in path:
        step = move(springs, state, np.array([y]))
        state = step.state
        forces.append(step.force[0])
    return np.array(forces), state


def test_virgin_loading_follows_the_backbone() -> None:
    springs = sliders((CURVE,), ONE, largest_m=0.1, number=60)
    y = np.geomspace(1e-4, 0.09, 50)
    force, _ = trace(springs, y)
    np.testing.assert_allclose(force, CURVE.force(y), rtol=0.01)  # chords of 60 points


def test_a_loop_obeys_masing_and_loses_his_energy() -> None:
    """Unloading is the backbone twice as large; ΔW = 8 (∫₀^Y p dy − ½ p Y)."""
    springs = sliders((CURVE,), ONE, largest_m=0.1, number=60)
    Y = 0.02
    _, state = trace(springs, np.linspace(0.0, Y, 400))
    down = np.linspace(Y, -Y, 2001)
    force_down, state = trace(springs, down, state)
    wanted = CURVE.force(Y) - 2.0 * CURVE.force(0.5 * (Y - down))
    np.testing.assert_allclose(force_down, wanted, atol=0.005 * 1e6)
    force_up, _ = trace(springs, down[::-1], state)
    loss = np.trapezoid(force_up, down[::-1]) + np.trapezoid(force_down, down)
    integral = 1e6**2 / 1e8 * np.log(np.cosh(1e8 * Y / 1e6))
    assert loss == pytest.approx(8.0 * (integral - 0.5 * float(CURVE.force(Y)) * Y), rel=0.01)


def test_small_cycles_are_elastic_and_the_tangent_is_the_slope() -> None:
    springs = sliders((CURVE,), ONE, largest_m=0.1)
    first = move(springs, springs.at_rest(), np.array([1e-6]))
    assert first.force[0] == pytest.approx(1e8 * 1e-6, rel=1e-3)
    assert first.tangent[0] == pytest.approx(1e8, rel=1e-3)
    back = move(springs, move(springs, springs.at_rest(), np.array([0.03])).state, np.array([0.03 - 1e-6]))
    assert back.tangent[0] == pytest.approx(1e8, rel=1e-3)


def test_softening_holds_its_peak_and_springs_scale_with_length() -> None:
    brittle = TabulatedCurve((0.0, 0.01, 0.02), (0.0, 1e5, 7e4))
    springs = sliders((brittle, brittle), np.array([1.0, 2.5]), largest_m=0.1, number=80)
    step = move(springs, springs.at_rest(), np.array([0.05, 0.05]))
    assert step.force[1] == pytest.approx(2.5 * step.force[0])
    assert step.force[0] == pytest.approx(1e5, rel=0.05)  # the peak falls between two samples
