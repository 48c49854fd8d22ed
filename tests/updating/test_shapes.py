"""Mode shapes as data: the MAC of the full model, its gradient, and what it adds."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.identification import mac
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.updating import Problem, Residuals, SupportModel, Target, joint
from jackettwin.updating.data.shapes import ProfileTarget, ShapeTarget

TRUTH, MODES = np.array([6e8, 0.1]), (1, 2, 4)
SENSORS = tuple(
    Sensor(f"{height}{axis}", direction, height_m=height)
    for height in (144.0, 77.0, 41.0)
    for axis, direction in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
)


@pytest.fixture(scope="module")
def model(maxwell_3: Callable[..., SupportModel]) -> SupportModel:
    return maxwell_3()


@pytest.fixture(scope="module")
def problem(model: SupportModel) -> Problem:
    """Frequencies, and the shapes of the full model at the truth."""
    exact = model.exact_modes(TRUTH, MODES)
    H = observation_matrix(model.assembly, SENSORS)
    shapes = tuple(
        ShapeTarget.seen(model, mode, f, SENSORS, H @ exact.shapes[:, i], 0.01)
        for i, (mode, f) in enumerate(zip(MODES, exact.frequency_hz, strict=True))
    )
    targets = tuple(Target(m, f, 0.01 * f) for m, f in zip(MODES, exact.frequency_hz, strict=True))
    return joint(model, {"": (Residuals(targets, relative=False), {})}, shapes=shapes)


def test_at_the_truth_every_mac_is_one(problem: Problem) -> None:
    r, _, _ = problem.evaluate(np.log(TRUTH), None)
    assert problem.data_names == ["f1", "f2", "f4", "MAC1", "MAC2", "MAC4"]
    np.testing.assert_allclose(r[:3], 0.0, atol=1e-6)
    # 1 − MAC is 1e-6 at the measured frequency instead of the complex pole, over a deviation of 0.01
    np.testing.assert_allclose(r[3:], 0.0, atol=1e-3)


def test_the_residual_is_the_mac_of_the_full_model(problem: Problem, model: SupportModel) -> None:
    theta = np.array([5e8, 0.2])
    exact = model.exact_modes(theta, MODES)
    H = observation_matrix(model.assembly, SENSORS)
    r, _, _ = problem.evaluate(np.log(theta), None)
    for i, shape in enumerate(problem.states[0].shapes):
        expected = (1.0 - float(mac(shape.shape, H @ exact.shapes[:, i]))) / shape.std
        assert r[3 + i] == pytest.approx(expected, abs=0.02)  # 2e-4 of the MAC


def test_of_a_double_pole_any_shape_of_its_plane_counts(problem: Problem, rng: np.random.Generator) -> None:
    """The solver's two shapes of a symmetric jacket's pair stand at any angle to the measured ones."""
    (state,) = problem.states
    first = state.shapes[0]
    n = first.at_sensors.shape[1]
    x = rng.normal(size=(3, n)) + 1j * rng.normal(size=(3, n))
    turned = replace(first, shape=first.at_sensors @ (0.6 * x[0] - 0.8j * x[1]))
    state = replace(state, shapes=(turned,))
    poles = np.array([[-0.01 + 1.0j, -0.01 + 1.0j, -0.02 + 3.0j], [-0.01 + 1.0j, -0.01 + 1.1j, -0.02 + 3.0j]])
    modes = SimpleNamespace(poles=poles, shapes=np.stack([x, x]))
    of_double, of_two = state.values(np.zeros((2, state.errors.shape[1])), modes, ())[:, -1]  # type: ignore[arg-type]
    assert of_double == pytest.approx(0.0, abs=1e-9)
    assert of_two > 10.0


def test_gradients_are_differences(problem: Problem) -> None:
    z, h = np.log([2e8, 0.3]), 1e-4
    _, J, near = problem.evaluate(z, None)
    for j in range(2):
        step = h * (np.arange(2) == j)
        up, down = (problem.evaluate(z + s, near)[0] for s in (step, -step))
        # second order in h
        np.testing.assert_allclose(
            J[:, j], (up - down) / (2 * h), rtol=1e-5, atol=1e-5 * np.abs(J[:, j]).max()
        )


@pytest.fixture(scope="module")
def profiles(model: SupportModel, problem: Problem) -> Problem:
    """The first pair's frequencies, and how far 41 m moves with 144 m, mixed as one record sees a pair."""
    exact = model.exact_modes(TRUTH, MODES)
    seen = (
        observation_matrix(model.assembly, SENSORS)
        @ exact.shapes[:, :2]
        @ np.array([[1.0, 0.6], [-0.6, 1.0]])
    )
    shapes = tuple(
        ProfileTarget.seen(model, m, exact.frequency_hz[m - 1], SENSORS, seen[:, m - 1], 0.003)
        for m in (1, 2)
    )
    return replace(problem, states=(replace(problem.states[0], shapes=shapes),))


def test_a_profile_is_of_no_direction_and_tells_softer_feet(profiles: Problem) -> None:
    r, J, _ = profiles.evaluate(np.log(TRUTH), None)
    assert profiles.data_names[3:] == ["profile1", "profile2"]
    np.testing.assert_allclose(r[3:], 0.0, atol=0.5)  # alike in both directions to 1e-3
    z, h = np.log([2e8, 0.3]), 1e-4
    near = profiles.evaluate(z, None)[2]
    r, J, _ = profiles.evaluate(z, near)
    assert (r[3:] > 2.0).all()  # a softer foot moves more
    for j in range(2):
        step = h * (np.arange(2) == j)
        up, down = (profiles.evaluate(z + s, near)[0][3:] for s in (step, -step))
        np.testing.assert_allclose(J[3:, j], (up - down) / (2 * h), rtol=1e-4, atol=1e-4)


def test_what_lags_by_a_quarter_of_a_period_is_no_part_of_a_profile(profiles: Problem) -> None:
    """y₂/y₁ = φ₂/φ₁ + 2iζr at resonance, of a mode φ and another's slow motion r: its real part is exact."""
    for one in profiles.states[0].shapes:
        k = one.shape.size // 2
        lags = one.shape + 0.01j * np.append(np.zeros(k), one.shape[:k])
        beside = replace(one, shape=lags)
        x = np.ones((1, one.at_sensors.shape[1]), complex)
        np.testing.assert_allclose(beside.values(x), one.values(x), rtol=1e-12)
        moved = replace(one, shape=one.shape + 0.01 * np.append(np.zeros(k), one.shape[:k]))
        np.testing.assert_allclose(moved.values(x), one.values(x) - 0.01 / one.std, rtol=1e-9)


def test_a_model_that_reaches_further_has_the_same_shapes(problem: Problem, profiles: Problem) -> None:
    for one in (problem, profiles):
        z = np.log([2e8, 0.3])
        r, higher = (p.evaluate(z, None)[0] for p in (one, one.on(one.model.reaching(12))))
        np.testing.assert_allclose(higher[3:5], r[3:5], rtol=3e-3)  # f4 lies at the end of the band


def test_a_profile_needs_two_places(model: SupportModel) -> None:
    with pytest.raises(InputError, match="two places"):
        ProfileTarget.seen(model, 1, 0.2, SENSORS[:2], np.ones(2), 0.003)


def test_shapes_count_in_the_likelihood(problem: Problem) -> None:
    z = np.log([[2e8, 0.3]])
    without = replace(problem, states=(replace(problem.states[0], shapes=()),))
    r = problem.evaluate(z[0], None)[0][3:]
    normalisation = sum(shape.log_normalisation for shape in problem.states[0].shapes)
    difference = problem.log_likelihood(z, None)[0] - without.log_likelihood(z, None)[0]
    assert difference[0] == pytest.approx(-0.5 * float(r @ r) - normalisation)
