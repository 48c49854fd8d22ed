"""Real poles as data: gradients, what they add to frequencies and damping, laws that have none."""

from collections.abc import Callable

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.sensors import Sensor
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import Problem, Residuals, SupportModel, Target, joint, support_model
from jackettwin.updating.data.relaxations import RelaxationTarget
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.posterior.predictive import predict_quantities
from jackettwin.updating.problem import NEVER
from jackettwin.updating.search.path import PathEvaluator, constrained

TRUTH, MODES = np.array([2.62e9, 1e9, 3e9]), (1, 2, 4)
WIDE = {"k0": (1e8, 1e11), "c": (1e7, 1e12), "k1": (1e8, 1e11)}


@pytest.fixture(scope="module")
def zener(jacket15: Assembly) -> SupportModel:
    steel = Rayleigh.minimum(0.0055, 0.1832)
    return support_model(
        jacket15, family=family("zener"), rayleigh=steel, highest_mode=5, fastest_rate=3.0, bounds=WIDE
    )


def measured(model: SupportModel, theta: np.ndarray) -> Residuals:
    """Frequencies to 0.4 % and the damping of the first mode to 20 %, as in thesis table 6.1."""
    targets = []
    for mode, pole in zip(MODES, model.predict(theta, MODES).poles, strict=True):
        f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
        targets.append(Target(mode, f, 0.004 * f, *((zeta, 0.2 * zeta) if mode == 1 else ())))
    return Residuals(tuple(targets), relative=False)


def relaxation(model: SupportModel, theta: np.ndarray, near: float) -> RelaxationTarget:
    rate = float(RelaxationTarget("a1", near).nearest(model, theta[None]).rate[0])
    return RelaxationTarget("a1", rate, 0.1)


@pytest.fixture(scope="module")
def problem(zener: SupportModel) -> Problem:
    found = relaxation(zener, TRUTH, 1.4)
    return joint(zener, {"": (measured(zener, TRUTH), {})}, relaxations=(found,))


def test_it_is_a_datum_like_any_other(problem: Problem) -> None:
    assert problem.data_names == ["f1", "ζ1", "f2", "f4", "a1"] and problem.weighted
    r, _, _ = problem.evaluate(np.log(TRUTH), None)
    np.testing.assert_allclose(r, 0.0, atol=1e-6)
    z = np.log(TRUTH) + np.array([[0.0, 0.2, 0.0], [0.1, 0.0, -0.3]])
    each = [float(r @ r) for r, _, _ in (problem.evaluate(point, None) for point in z)]
    # χ² and the normal densities of five logarithms
    expected = -0.5 * np.array(each) - problem.states[0].log_normalisation
    np.testing.assert_allclose(problem.log_likelihood(z, None)[0], expected, rtol=1e-6)


def test_a_real_pole_identifies_the_relaxation_time(problem: Problem, zener: SupportModel) -> None:
    """Frequencies and ζ1 let the dashpot go tenfold, the others following; the pole does not."""
    without = joint(zener, {"": (measured(zener, TRUTH), {})})
    tenfold = np.log(10.0 * TRUTH[1])
    assert constrained(PathEvaluator(without), np.log(TRUTH), 1, tenfold)[1] < 2.0
    assert constrained(PathEvaluator(problem), np.log(TRUTH), 1, tenfold)[1] > 25.0


@pytest.mark.parametrize(
    ("law", "theta", "near"),
    [
        ("kelvin-voigt", [2.5e9, 7.6e8, 4e9, 5e8, 3e5, 0.01, 0.2], 3.5),
        ("zener", [2.6e9, 1e9, 3e9, 4e9, 2e9, 1e9, 3e5, 0.01, 0.2], 1.4),
        ("maxwell-3", [2.5e9, 0.1, 4e9, 0.05, 3e5, 0.01, 0.2], 3.3),
    ],
)
def test_gradients_are_differences(jacket15: Assembly, law: str, theta: list[float], near: float) -> None:
    """For every parameter: separate horizontal and vertical laws, a nacelle dashpot, the steel's damping."""
    model = support_model(
        jacket15,
        family=family(law),
        rayleigh=Rayleigh(),
        tie="horizontal-vertical",
        highest_mode=5,
        nuisance=NuisanceParameters(("c_side_side",), rayleigh=True),
    )
    z, h = np.log(theta), 1e-4
    target = RelaxationTarget("a1", near)
    slopes = target.nearest(model, np.exp(z)[None], slopes=True).slopes[0]
    steps = h * np.eye(z.size)
    rates = target.nearest(model, np.exp(np.concatenate([z + steps, z - steps]))).rate
    differences = (rates[: z.size] - rates[z.size :]) / (2 * h)
    # second order in h, beside the largest
    np.testing.assert_allclose(slopes, differences, rtol=1e-6, atol=1e-6 * np.abs(slopes).max())


def test_a_search_is_led_from_beyond_the_band(problem: Problem) -> None:
    """A relaxation a thousand times too fast lies outside the band: its slope still points home."""
    z = np.log(TRUTH * np.array([1.0, 1e-3, 1.0]))
    r, J, found = problem.evaluate(z, None)
    assert found is not None and r[-1] > 50.0
    assert J[-1, 1] == pytest.approx(-1.0 / 0.1, rel=0.05)


def test_the_band_reaches_a_fast_relaxation(jacket15: Assembly) -> None:
    """Thesis Zener point 2 relaxes at 2.4 to 12 rad/s; asked for up to 11, the pole is the full model's."""
    theta = np.array([2.62e9, 2.4e8, 9.99e9])
    model = support_model(
        jacket15, family=family("zener"), rayleigh=Rayleigh(), highest_mode=5, fastest_rate=10.0
    )
    rate = RelaxationTarget("a1", 9.0).nearest(model, theta[None]).rate[0]
    exact = -model.reaching(12).exact_modes(theta, (1, 20)).damped.real_poles
    assert np.abs(exact / rate - 1.0).min() < 1e-8


def test_shapes_at_sensors_choose_the_pole(zener: SupportModel) -> None:
    """Vertical motion above the legs: the fan's poles in which the jacket heaves, rocks or sways differ."""
    corners = [node for node in zener.assembly.structure.reaction_nodes]
    sensors = tuple(
        Sensor(f"{node}{axis}", direction, node=node)
        for node in corners
        for axis, direction in (("x", (1.0, 0.0, 0.0)), ("z", (0.0, 0.0, 1.0)))
    )
    fast = relaxation(zener, TRUTH, 1.6)
    x = fast.nearest(zener, TRUTH[None]).shapes[0]
    plain = RelaxationTarget("a1", 1.38, 0.1)
    seen = plain.seen(zener, sensors, np.ones(8, complex))
    assert seen.at_sensors is not None
    shaped = plain.seen(zener, sensors, (seen.at_sensors @ x).astype(complex))
    assert shaped.nearest(zener, TRUTH[None]).rate[0] == pytest.approx(fast.rate, rel=1e-6)
    assert plain.nearest(zener, TRUTH[None]).rate[0] < fast.rate - 0.01


def test_a_law_without_relaxations_never_explains_one(
    maxwell_3: Callable[..., SupportModel], jacket15: Assembly
) -> None:
    model = support_model(jacket15, family=family("springpot"), rayleigh=Rayleigh(), highest_mode=5)
    theta = np.array([2.5e9, 0.06])
    targets = joint(
        model, {"": (measured(model, theta), {})}, relaxations=(RelaxationTarget("a1", 1.4, 0.1),)
    )
    assert targets.log_likelihood(np.log(theta)[None], None)[0] == NEVER
    assert targets.evaluate(np.log(theta), None)[2] is None


def test_predictions_say_where_the_pole_may_lie(problem: Problem, zener: SupportModel) -> None:
    (target,) = problem.states[0].relaxations
    theta = TRUTH * np.array([[1.0, 1.0, 1.0], [1.0, 0.5, 1.0]])
    rates = predict_quantities(zener, theta, MODES, (target,)).rates["a1"]
    assert rates[0] == pytest.approx(target.rate, rel=1e-8) and rates[1] == pytest.approx(
        2 * rates[0], rel=0.1
    )


def test_relative_rates_have_no_likelihood(zener: SupportModel) -> None:
    targets = Residuals((Target(1, 0.18),), relative=True)
    found = joint(zener, {"": (targets, {})}, relaxations=(RelaxationTarget("a1", 1.4),))
    assert not found.weighted
    rate = found.states[0].relaxations[0].nearest(zener, TRUTH[None]).rate[0]
    assert found.evaluate(np.log(TRUTH), None)[0][-1] == pytest.approx(rate / 1.4 - 1.0)


@pytest.mark.parametrize(("rate", "log_std"), [(0.0, 0.1), (-1.0, 0.1), (1.0, 0.0), (float("nan"), None)])
def test_what_is_no_rate_is_refused(rate: float, log_std: float | None) -> None:
    with pytest.raises(InputError, match="rate and standard deviation of a relaxation must be positive"):
        RelaxationTarget("a1", rate, log_std)
