"""Legs that scatter about their mean: the prior's density, its scatter, and a planted weak leg."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import chi2, kstest, multivariate_t, t

from jackettwin.errors import InputError
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.updating import Residuals, SupportModel, Target, joint
from jackettwin.updating.data.shapes import ShapeTarget
from jackettwin.updating.posterior.scatter import FREEDOM, Legs, ScatteredPrior, leg_scatter
from jackettwin.updating.prior import BoxPrior
from jackettwin.updating.search.solutions import search

MODES, S0 = (1, 2, 3, 4, 5), 0.3


NARROW = 0.01
"""A scatter so far below the bounds that they cut nothing off."""


def prior(*, normal: bool = False, scale: float = S0) -> ScatteredPrior:
    """Return four legs and another parameter between them."""
    low, high = np.full(5, -6.0), np.full(5, 6.0)
    box = BoxPrior(low, high, np.zeros(5), np.full(5, 1.0 if normal else np.inf))
    return ScatteredPrior(box, (Legs("k", np.array([0, 2, 3, 4]), scale),))


def test_the_density_is_that_of_a_mean_and_of_student_deviations(rng: np.random.Generator) -> None:
    z = 0.5 * rng.standard_normal((20, 5))
    Q = prior().legs[0].Q
    deviations = z[:, [0, 2, 3, 4]] @ Q
    student = multivariate_t(np.zeros(3), S0**2 * np.eye(3), df=FREEDOM).logpdf(deviations)
    # the mean and the other parameter are flat over 12; the four legs' volume is 2 that of mean × deviations
    expected = student - np.log(2.0) - 2.0 * np.log(12.0) - prior().log_mass
    np.testing.assert_allclose(prior().log_density(z), expected)
    assert prior().log_density(np.full((1, 5), 6.1))[0] == -np.inf


@pytest.mark.parametrize("scale", [NARROW, 1.0])
def test_the_density_makes_up_for_what_the_bounds_cut_off(scale: float) -> None:
    """Two legs m ± y/√2 between ±6, m even and y Student: 1 − |y|/6√2 of all m keep both inside."""
    box = BoxPrior(np.full(2, -6.0), np.full(2, 6.0), np.zeros(2), np.full(2, np.inf))
    p = ScatteredPrior(box, (Legs("k", np.array([0, 1]), scale),))
    y = t(FREEDOM, scale=scale)
    reach = 6.0 * np.sqrt(2.0)
    mass = y.expect(lambda value: 1.0 - abs(value) / reach, -reach, reach)
    # 4,096 Sobol points
    assert p.log_mass == pytest.approx(np.log(mass), abs=2e-3)


def test_draws_have_that_density(rng: np.random.Generator) -> None:
    p = prior(scale=NARROW)
    z = p.draw(4000, rng)
    y = p.legs[0].deviations(z)
    for one in y.T:
        assert kstest(one / NARROW, t(FREEDOM).cdf).pvalue > 1e-3
    # ‖y‖²/3s₀² of three components together: Fisher's F, whose tail a product of three would miss
    assert np.mean((y * y).sum(axis=1) / (3 * NARROW**2) > 5.39) == pytest.approx(0.1, abs=0.02)
    np.testing.assert_allclose(z.std(axis=0), p.std, rtol=0.05)


def test_the_scatter_of_draws_has_its_own_prior(rng: np.random.Generator) -> None:
    """ν s₀²/χ²_ν: drawing the legs and then the scatter given the legs changes nothing."""
    p = prior(scale=NARROW)
    z = p.draw(3000, rng)
    (s,) = (found.draws for found in leg_scatter(p, z))
    assert kstest(FREEDOM * NARROW**2 / s**2, chi2(FREEDOM).cdf).pvalue > 1e-3


@pytest.mark.parametrize("normal", [False, True])
@pytest.mark.parametrize("size", [1e-6, 0.3, 2.0])
def test_rows_are_the_density_and_its_gradient(normal: bool, size: float, rng: np.random.Generator) -> None:
    p, z = prior(normal=normal), size * rng.standard_normal(5)
    r, J = p.rows(z)
    at_zero = p.log_density(np.zeros((1, 5)))[0]
    assert r @ r == pytest.approx(2.0 * (at_zero - p.log_density(z[None])[0]), rel=1e-6, abs=1e-12)
    h = 1e-5
    for j in range(5):
        up, down = (p.rows(z + s * (np.arange(5) == j))[0] for s in (h, -h))
        # second order in h
        np.testing.assert_allclose(J[:, j], (up - down) / (2 * h), atol=1e-6 * np.abs(J).max())


@pytest.fixture(scope="module")
def legs(maxwell_3: Callable[..., SupportModel]) -> SupportModel:
    return maxwell_3(tie="per-leg", bounds={"k": (1e8, 3e10), "loss_factor": (0.01, 0.5)})


def weak_third_leg(legs: SupportModel) -> np.ndarray:
    return np.array([value for k in (3e9, 3e9, 1e9, 3e9) for value in (k, 0.1)])


def seen(legs: SupportModel) -> Residuals:
    """Return f to 0.03 % and ζ to 10 % of five modes."""
    poles = legs.predict(weak_third_leg(legs), MODES).poles
    values = [(abs(pole) / (2 * np.pi), -pole.real / abs(pole)) for pole in poles]
    targets = (Target(m, f, 3e-4 * f, z, 0.1 * z) for m, (f, z) in zip(MODES, values, strict=True))
    return Residuals(tuple(targets), relative=False)


def test_one_loss_factor_for_all_legs(legs: SupportModel) -> None:
    problem = joint(legs, {"": (seen(legs), {})}, shared=("loss_factor",), scatter={"k": S0})
    names = [p.name for p in problem.parameters]
    assert names == ["k_foot_1", "loss_factor", "k_foot_2", "k_foot_3", "k_foot_4"]
    z = np.log([1e9, 0.2, 2e9, 3e9, 4e9])
    expected = [1e9, 0.2, 2e9, 0.2, 3e9, 0.2, 4e9, 0.2]
    np.testing.assert_allclose(problem.vectors(z[None], problem.states[0])[0], expected)
    _, J, near = problem.evaluate(z, None)
    for j in range(5):
        step = 1e-4 * (np.arange(5) == j)
        up, down = (problem.evaluate(z + s, near)[0] for s in (step, -step))
        # second order in h
        np.testing.assert_allclose(J[:, j], (up - down) / 2e-4, atol=1e-5 * np.abs(J[:, j]).max())


def test_frequencies_see_a_weak_diagonal_and_not_which_leg(legs: SupportModel) -> None:
    """The jacket and its rotor are symmetric: there are two mirrored solutions, and both are found."""
    problem = joint(legs, {"": (seen(legs), {})}, shared=("loss_factor",), scatter={"k": S0})
    found = search(problem, starts=6).solutions
    assert len(found) == 2
    k = np.array([s.theta[[0, 2, 3, 4]] for s in found])
    np.testing.assert_allclose(k[0], k[1][[3, 2, 1, 0]], rtol=1e-2)
    assert found[0].cost == pytest.approx(found[1].cost, rel=1e-3)


def test_shapes_at_the_legs_single_the_weak_one_out(legs: SupportModel) -> None:
    exact = legs.exact_modes(weak_third_leg(legs), MODES)
    sensors = tuple(Sensor(f"z{i}", (0.0, 0.0, 1.0), node=f"leg_{i}_1") for i in (1, 2, 3, 4))
    H = observation_matrix(legs.assembly, sensors)
    shapes = tuple(
        ShapeTarget.seen(legs, m, exact.frequency_hz[i], sensors, H @ exact.shapes[:, i], 0.01)
        for i, m in enumerate(MODES)
        if m != 3
    )
    scatter = {"k": S0}
    problem = joint(legs, {"": (seen(legs), {})}, shared=("loss_factor",), scatter=scatter, shapes=shapes)
    (only,) = search(problem, starts=4).solutions
    k = only.theta[[0, 2, 3, 4]]
    assert np.argmin(k) == 2
    # drawn to the mean a little, as the prior says: within a third of the truth, the others within two thirds
    np.testing.assert_allclose(np.log(k / [3e9, 3e9, 1e9, 3e9]), 0.0, atol=0.5)
    assert k[2] == pytest.approx(1e9, rel=0.33)


def test_what_the_law_does_not_have(legs: SupportModel) -> None:
    with pytest.raises(InputError, match="the law has no such parameter"):
        joint(legs, {"": (seen(legs), {})}, shared=("alpha",))
    with pytest.raises(InputError, match="needs data with standard deviations"):
        relative = Residuals((Target(1, 0.18),), relative=True)
        joint(legs, {"": (relative, {})}, scatter={"k": S0})
