"""The condensed model against the full one, and gradients against differences."""

import pickle

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import SupportModel, support_model
from jackettwin.updating.nuisance_parameters import STEEL, NuisanceParameters

POINTS = {
    "kelvin-voigt": [2.5e9, 7.6e8],  # thesis table 8.1
    "zener": [2.62e9, 8.65e8, 9.99e9],  # thesis table 8.4, point 2
    "maxwell-3": [3e9, 0.2],
    "springpot": [3e9, 0.06],
}


@pytest.mark.parametrize("law", POINTS)
def test_condensed_poles_are_those_of_the_full_model(models: dict[str, SupportModel], law: str) -> None:
    theta = np.array(POINTS[law])
    exact = models[law].exact_modes(theta, (1, 2, 3, 4, 5))
    condensed = models[law].predict(theta, (1, 2, 3, 4, 5)).poles
    # nothing is truncated; what differs is the rounding of two ways to the same poles
    np.testing.assert_allclose(condensed, exact.poles, rtol=1e-8)
    np.testing.assert_allclose(
        models[law].undamped_hz(theta, (1, 2, 4)), exact.undamped_hz[[0, 1, 3]], rtol=1e-8
    )


@pytest.mark.parametrize("law", POINTS)
def test_slopes_are_differences_of_poles(models: dict[str, SupportModel], law: str) -> None:
    theta = np.array(POINTS[law])
    slopes = models[law].predict(theta, (1, 4)).slopes
    h = 1e-3
    for j in range(theta.size):
        up, down = theta.copy(), theta.copy()
        up[j], down[j] = theta[j] * np.exp(h), theta[j] * np.exp(-h)
        difference = (models[law].predict(up, (1, 4)).poles - models[law].predict(down, (1, 4)).poles) / (
            2 * h
        )
        # second order in h
        np.testing.assert_allclose(slopes[:, j], difference, rtol=1e-6, atol=1e-6 * np.abs(difference).max())


@pytest.mark.parametrize("law", POINTS)
def test_many_rows_are_those_of_the_laws(models: dict[str, SupportModel], law: str) -> None:
    model, theta = models[law], np.array([POINTS[law], POINTS[law]]) * [[1.0], [0.7]]
    rows = model.points(theta).rows
    np.testing.assert_allclose(rows[:, 0], [model.laws(t)[0].row for t in theta], rtol=1e-14)


def test_a_model_reaches_further_with_the_same_poles(models: dict[str, SupportModel]) -> None:
    model, theta = models["zener"], np.array(POINTS["zener"])
    assert model.reaching(8) is model
    wide = model.reaching(12)
    assert wide.highest_mode == 12
    # both are exact: rounding alone
    np.testing.assert_allclose(
        wide.predict(theta, (1, 4)).poles, model.predict(theta, (1, 4)).poles, rtol=1e-9
    )


def test_untied_parameters_carry_their_place(jacket15: Assembly, steel: Rayleigh) -> None:
    kv = family("kelvin-voigt")
    two = support_model(jacket15, family=kv, rayleigh=steel, tie="horizontal-vertical")
    assert [p.name for p in two.parameters] == ["k_horizontal", "c_horizontal", "k_vertical", "c_vertical"]
    four = support_model(jacket15, family=kv, rayleigh=steel, tie="per-leg")
    assert [p.name for p in four.parameters][:3] == ["k_foot_1", "c_foot_1", "k_foot_2"]


def test_tied_and_untied_models_agree_when_the_values_do(
    models: dict[str, SupportModel], jacket15: Assembly
) -> None:
    theta = np.array(POINTS["kelvin-voigt"])
    tied = models["kelvin-voigt"]
    untied = support_model(jacket15, family=tied.family, rayleigh=tied.rayleigh, tie="per-leg")
    np.testing.assert_allclose(
        untied.predict(np.tile(theta, 4), (1, 4)).poles, tied.predict(theta, (1, 4)).poles, rtol=1e-10
    )


def test_tower_modes_feel_the_vertical_springs(jacket15: Assembly, steel: Rayleigh) -> None:
    """A jacket rocks on its legs: evidence gives k_v ±1 % against k_h ±77 %."""
    model = support_model(jacket15, family=family("kelvin-voigt"), rayleigh=steel, tie="horizontal-vertical")
    slopes = np.abs(model.predict(np.array([2.5e9, 7.6e8] * 2), (1, 2)).slopes)
    assert (slopes[:, 2] > 10.0 * slopes[:, 0]).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tie": "per_leg"}, "unknown tie .got 'per_leg'"),
        ({"bounds": {"k": (1e9, 1e8)}}, "bounds are reversed"),
        ({"bounds": {"kk": (1e8, 1e9)}}, "no such parameter of kelvin-voigt"),
    ],
)
def test_bad_options(jacket15: Assembly, steel: Rayleigh, options: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        support_model(jacket15, family=family("kelvin-voigt"), rayleigh=steel, **options)


def test_free_steel_is_bounded_where_it_would_overdamp_the_highest_mode(jacket15: Assembly) -> None:
    """βω = 0.3 at the end of the band; the ratio's and the frequency's bounds give way alike."""

    def bounds(highest: int, **given: tuple[float, float]) -> tuple[float, float, float]:
        nuisance = NuisanceParameters(rayleigh=True)
        model = support_model(
            jacket15, family=family("maxwell-3"), rayleigh=Rayleigh(), highest_mode=highest,
            nuisance=nuisance, bounds=given,
        )  # fmt: skip
        ratio, frequency = model.parameters[-2:]
        return ratio.high, frequency.low, model.condensed.radius

    assert bounds(2)[:2] == (STEEL[0].high, STEEL[1].low)
    ratio, low, radius = bounds(8)
    damping = ratio / (2.0 * np.pi * low) * radius
    assert damping <= 0.3  # a search that stands on both bounds must not be refused for their rounding
    np.testing.assert_allclose(damping, 0.3, rtol=2e-9)
    np.testing.assert_allclose(STEEL[0].high / ratio, low / STEEL[1].low, rtol=1e-12)
    with pytest.raises(InputError, match=r"bounds\.rayleigh_ratio: .*too strong.*got \[0\.2, 0\.1\]"):
        bounds(8, rayleigh_ratio=(1e-4, 0.2))


def test_unknown_law_suggests() -> None:
    with pytest.raises(InputError, match="did you mean 'zener'"):
        family("zenner")


def test_modes_that_the_steel_overdamps_are_named(jacket15: Assembly) -> None:
    """β = 0.05/(2π 0.1832 Hz) = 43 ms; the band may reach βω = 0.3, a relaxation half of that."""
    steel = Rayleigh.minimum(0.05, 0.1832)
    with pytest.raises(
        InputError, match=r"mode: .*too strong for so high a mode \(got 40\); allowed: 1 to \d+ with"
    ):
        support_model(jacket15, family=family("kelvin-voigt"), rayleigh=steel, highest_mode=40)
    with pytest.raises(InputError, match=r"rate_rad_s: .*so fast a relaxation.*up to 3.45 rad/s with"):
        support_model(
            jacket15, family=family("kelvin-voigt"), rayleigh=steel, highest_mode=5, fastest_rate=5.0
        )


def test_modes_that_the_structure_has_not_are_named(jacket15: Assembly) -> None:
    with pytest.raises(InputError, match=r"mode: the structure has fewer modes \(got 2000\)"):
        support_model(jacket15, family=family("kelvin-voigt"), rayleigh=Rayleigh(), highest_mode=2000)


def test_a_model_survives_being_stored(models: dict[str, SupportModel]) -> None:
    for model in models.values():
        again = pickle.loads(pickle.dumps(model))
        theta = np.array([np.sqrt(p.low * p.high) for p in model.parameters])
        np.testing.assert_array_equal(again.predict(theta, (1, 2)).poles, model.predict(theta, (1, 2)).poles)
