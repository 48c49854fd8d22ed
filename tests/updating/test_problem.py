"""One cost for search and sampling: gradients, states that share parameters, priors."""

import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.updating import Problem, Residuals, SupportModel, Target, joint, single
from jackettwin.updating.joint import Growth
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.posterior.smc import sample_posterior
from jackettwin.updating.problem import NEVER

MODES = (1, 2, 4)


@pytest.fixture(scope="module")
def model(maxwell_3: Callable[..., SupportModel]) -> SupportModel:
    return maxwell_3(
        bounds={"k": (1e8, 1e11), "loss_factor": (1e-3, 0.6), "c_side_side": (1e3, 1e6)},
        priors={"loss_factor": (0.05, 1.0)},
        nuisance=NuisanceParameters(("c_side_side",)),
    )


def seen(model: SupportModel, theta: np.ndarray) -> Residuals:
    targets = []
    for mode, pole in zip(MODES, model.predict(theta, MODES).poles, strict=True):
        f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
        targets.append(Target(mode, f, 0.004 * f, zeta, 0.2 * zeta))
    return Residuals(tuple(targets), relative=False)


WIND = {"8 m/s": 8.0, "16 m/s": 16.0}
TRUTH = np.array([3e9, 0.1, 6e3])  # the dashpot a m/s


@pytest.fixture(scope="module")
def windy(model: SupportModel) -> Problem:
    """The rotor's dashpot grows with the wind, the soil does not change."""
    return joint(
        model,
        {
            name: (seen(model, TRUTH * np.array([1.0, 1.0, v])), {"c_side_side": v})
            for name, v in WIND.items()
        },
    )


def test_likelihoods_of_many_points_are_those_of_each(windy: Problem) -> None:
    z = np.log(TRUTH) + 0.2 * np.random.default_rng(3).standard_normal((5, 3))
    data = [windy.evaluate(point, None)[0][: windy.n_data] for point in z]  # the priors' residuals follow
    each = [float(r @ r) for r in data]
    many, _ = windy.log_likelihood(z, windy.anchor(np.log(TRUTH)))
    wanted = -0.5 * np.array(each) - sum(state.log_normalisation for state in windy.states)
    # χ² of residuals over deviations of 0.4 %; poles to 1e-9
    np.testing.assert_allclose(many, wanted, rtol=1e-5)


def test_targets_without_a_value_take_no_part(model: SupportModel) -> None:
    some = Residuals((Target(1, 0.18, 0.001), Target(3), Target(4, 0.75, 0.01)), relative=False)
    assert some.modes == (1, 4) and some.names == ["f1", "f4"]
    r, J, _ = single(model, some).evaluate(np.log(TRUTH), None)
    assert r.size == 3 and J.shape == (3, 3)  # with one normal prior


def test_gradients_are_differences(windy: Problem) -> None:
    z, h = np.log(TRUTH) + 0.1, 1e-4
    _, J, near = windy.evaluate(z, None)
    for j in range(z.size):
        step = h * (np.arange(z.size) == j)
        up, down = (windy.evaluate(z + s, near)[0] for s in (step, -step))
        np.testing.assert_allclose(J[:, j], (up - down) / (2 * h), rtol=1e-5, atol=1e-6)


def test_log_likelihood_is_the_sum_over_states(windy: Problem) -> None:
    z = np.log(TRUTH)[None] + np.array([[0.0], [0.2]])
    both, _ = windy.log_likelihood(z, None)
    each = [replace(windy, states=(state,)).log_likelihood(z, None)[0] for state in windy.states]
    np.testing.assert_allclose(both, sum(each), rtol=1e-12)
    # at the truth nothing is left but the normalisation
    assert both[0] == pytest.approx(-sum(s.residuals.log_normalisation for s in windy.states), abs=1e-9)


def test_a_damper_that_overdamps_the_mode_has_no_likelihood(model: SupportModel) -> None:
    problem = single(model, seen(model, TRUTH * np.array([1.0, 1.0, 10.0])))
    far = replace(model.parameters[2], high=1e9)
    loose = replace(problem, model=replace(model, parameters=(*model.parameters[:2], far)))
    log_l, _ = loose.log_likelihood(np.log([[3e9, 0.1, 3e8]]), None)
    assert log_l[0] <= NEVER


def test_states_tell_rotor_from_soil(windy: Problem, model: SupportModel) -> None:
    posterior = sample_posterior(windy, particles=120, islands=2, seed=3)
    low, high = posterior.interval(0.9).T
    assert (low < TRUTH).all() and (high > TRUTH).all()
    # two winds in a known proportion fix the rotor's share
    assert np.log(high / low)[2] < 1.0


def test_a_parameter_of_each_state(model: SupportModel) -> None:
    residuals = seen(model, TRUTH * np.array([1.0, 1.0, 10.0]))
    problem = joint(model, {"calm": (residuals, {}), "gale": (residuals, {})}, per_state=("c_side_side",))
    assert [p.name for p in problem.parameters] == [
        "k", "loss_factor", "c_side_side@calm", "c_side_side@gale",
    ]  # fmt: skip
    z = np.log([3e9, 0.1, 1e4, 5e4])[None]
    for state, c in zip(problem.states, (1e4, 5e4), strict=True):
        np.testing.assert_allclose(problem.vectors(z, state)[0], [3e9, 0.1, c])
    assert "ζ4 (gale)" in problem.data_names


def test_unknown_names_and_priors_without_weights(model: SupportModel) -> None:
    residuals = seen(model, TRUTH * np.array([1.0, 1.0, 10.0]))
    with pytest.raises(InputError, match="no such parameter"):
        joint(model, {"": (residuals, {})}, per_state=("c_yaw",))
    with pytest.raises(InputError, match="needs data with standard deviations"):
        single(model, Residuals((Target(1, 0.18),), relative=True))


def test_an_error_of_the_model_that_states_share_is_not_averaged_out(model: SupportModel) -> None:
    """Nine days of the same frequency: the closed form of a mean with a common error."""
    day = Residuals((Target(1, 0.18, 0.003 * 0.18),), relative=False)
    problem = joint(model, {str(i): (day, {}) for i in range(9)}, errors={"f1": 0.02})
    assert problem.parameters[-1].name == "error_f1"
    z = np.log([*TRUTH, 1.0])
    r, J, _ = problem.evaluate(z, None)
    assert J[:9, -1] == pytest.approx(np.full(9, 1.0 / 0.003))
    # what is left of ln f1 once the common error is free: 0.02² + 0.003²/9
    information = J.T @ J
    own, cross, rest = information[0, 0], information[0, -1], information[-1, -1]
    slope = J[0, 0] * 0.003
    assert (own - cross**2 / rest) / slope**2 == pytest.approx(1.0 / (0.02**2 + 0.003**2 / 9), rel=1e-6)


def test_parameters_that_grow(model: SupportModel) -> None:
    days = {"first": 0.0, "third": 2.0}
    residuals = seen(model, TRUTH * np.array([1.0, 1.0, 10.0]))
    problem = joint(model, dict.fromkeys(days, (residuals, {})), growth=Growth(("k",), days, 0.05))
    z = np.log([3e9, 0.1, 6e4, 0.9])
    for state, k in zip(problem.states, (3e9, 3e9 * 0.81), strict=True):
        np.testing.assert_allclose(problem.vectors(z[None], state)[0], [k, 0.1, 6e4])
    _, J, near = problem.evaluate(z, None)
    h = 1e-4 * (np.arange(4) == 3)
    up, down = (problem.evaluate(z + s, near)[0] for s in (h, -h))
    # second order in h
    np.testing.assert_allclose(J[:, 3], (up - down) / 2e-4, rtol=1e-5, atol=1e-6)


def test_a_problem_survives_being_stored(windy: Problem) -> None:
    """Another process evaluates it to the last bit."""
    z = windy.prior.low + 0.4 * (windy.prior.high - windy.prior.low)
    again = pickle.loads(pickle.dumps(windy))
    for here, there in zip(windy.evaluate(z, None)[:2], again.evaluate(z, None)[:2], strict=True):
        np.testing.assert_array_equal(here, there)
