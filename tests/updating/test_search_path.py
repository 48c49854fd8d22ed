"""The way of one search: a surrogate near a point, steps bent along a valley, and where both lead."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.arrays import FloatArray
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import NuisanceParameters, Problem, Residuals, Target, joint, support_model
from jackettwin.updating.search.levenberg_marquardt import damped_least_squares
from jackettwin.updating.search.path import PathEvaluator, creep, minimum, squares
from jackettwin.updating.search.surrogate import Surrogate


def banana(z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rosenbrock's valley, its minimum at (1, 1), a hundred times as narrow as usual."""
    r = np.array([1e3 * (z[1] - z[0] ** 2), 1.0 - z[0]])
    return r, np.array([[-2e3 * z[0], 1e3], [-1.0, 0.0]])


def test_steps_bent_along_a_valley_end_at_its_lowest_point() -> None:
    low, high = np.full(2, -3.0), np.full(2, 3.0)
    evaluations = 0

    def counted(z: FloatArray) -> tuple[FloatArray, FloatArray]:
        nonlocal evaluations
        evaluations += 1
        return banana(z)

    end = damped_least_squares(counted, np.array([-1.2, 1.0]), low, high)
    np.testing.assert_allclose(end, 1.0, rtol=1e-9)
    assert evaluations < 200  # straight steps take some thousand in so narrow a valley


def test_bounds_and_held_coordinates_are_kept() -> None:
    low, high = np.full(2, -3.0), np.array([0.5, 3.0])
    np.testing.assert_allclose(damped_least_squares(banana, np.zeros(2), low, high), [0.5, 0.25], rtol=1e-6)
    held = damped_least_squares(banana, np.array([0.2, 2.0]), low, high, held=(0,))
    np.testing.assert_allclose(held, [0.2, 0.04], rtol=1e-9)
    start = np.array([0.4, 0.16])
    assert damped_least_squares(banana, start, low, high, enough=1.0) is start


@pytest.fixture(scope="module")
def problem(jacket15: Assembly) -> Problem:
    """Two laws, two dashpots and two winds: whatever a surrogate has a part for."""
    model = support_model(
        jacket15,
        family=family("zener"),
        tie="horizontal-vertical",
        rayleigh=Rayleigh.minimum(0.005, 0.2),
        highest_mode=5,
        nuisance=NuisanceParameters(dashpots=("c_fore_aft", "c_side_side")),
    )
    targets = (
        Target(1, 0.176, 0.001, 0.02, 0.002),
        Target(2, 0.178, 0.001, 0.01, 0.002),
        Target(4, 0.74, 0.004, 0.015, 0.002),
        Target(5, 0.76, 0.004, 0.012, 0.002),
    )
    data = Residuals(targets, relative=False)
    return joint(model, {"calm": (data, {}), "windy": (data, {"c_side_side": 2.0})})


def test_a_surrogate_is_the_problem_at_its_point_and_leaves_it_with_the_square_of_the_way(
    problem: Problem,
) -> None:
    """Residuals and slopes agree to rounding; half the way leaves a quarter of the error, not a half."""
    prior = problem.prior
    rng = np.random.default_rng(0)
    names = [p.name for p in problem.parameters]
    z = np.array([np.log(2e9) if n[0] == "k" else np.log(2e8) for n in names])
    z[[n in ("c_fore_aft", "c_side_side") for n in names]] = np.log(3e4)
    r, J, found = problem.evaluate(z, None)
    assert found is not None
    near = Surrogate(problem, z, (r, J), found)
    np.testing.assert_allclose(near(z)[0], r, atol=1e-9)
    np.testing.assert_allclose(near(z)[1], J, atol=1e-9 * np.abs(J).max())
    way = rng.choice([-1.0, 1.0], z.size)
    error = []
    for step in (0.04, 0.02):
        there = np.clip(z + step * way, prior.low, prior.high)
        error.append(np.abs(near(there)[0] - problem.evaluate(there, found)[0]).max())
    assert error[1] == pytest.approx(0.25 * error[0], rel=0.2)
    slopes = (near(z + 1e-6 * way)[0] - near(z - 1e-6 * way)[0]) / 2e-6
    np.testing.assert_allclose(slopes, J @ way, rtol=1e-5, atol=1e-6 * np.abs(J).max())


def test_surrogates_end_where_steps_on_the_structure_do(problem: Problem) -> None:
    middle = 0.5 * (problem.prior.low + problem.prior.high)
    start = creep(PathEvaluator(problem), middle, PathEvaluator(problem), tolerance=1e-2)
    slow, fast = PathEvaluator(problem), PathEvaluator(problem)
    pull = slow.pull(1.0)
    far = creep(slow, start, pull(slow), tolerance=1e-10)
    near, arrived = minimum(fast, start, pull)
    assert arrived
    # what is nearly open may lie apart; the pulled cost is lowest all the same
    assert squares(pull(fast)(near)[0]) <= (1.0 + 1e-6) * squares(pull(slow)(far)[0])
    assert fast.evaluations <= slow.evaluations
