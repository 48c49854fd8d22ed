"""Root loci, sensitivities, costs and ways of searches, against closed forms and the full model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response import NumberedModes
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import (
    NuisanceParameters,
    Residuals,
    SupportModel,
    Target,
    cost_surface,
    numbered_modes,
    root_locus,
    search_paths,
    sensitivity,
    single,
    starting_points,
    support_model,
)
from jackettwin.updating.explore.branches import branches
from jackettwin.updating.search.solutions import search

KV = np.array([2.5e9, 7.6e8])


def sorted_pair(coupling: float):
    """Return the modes of [[i+z, e], [e, i−z]], named by Im λ and by Re λ, as sorting would."""

    def at(z: float, near: NumberedModes | None) -> NumberedModes:
        values, vectors = np.linalg.eigh(np.array([[z, coupling], [coupling, -z]]))
        slopes = vectors[0] ** 2 - vectors[1] ** 2
        empty = np.zeros((1, 0))
        return NumberedModes(
            (1, 2),
            1j * (5.0 + values)[None],
            vectors.T[None].astype(complex),
            1j * slopes[None, :, None],
            np.zeros((0, 1, 2)),
            np.zeros(1, dtype=int),
            (),
            empty,
            np.zeros((1, 0, 2)),
            empty,
            empty,
        )

    return at


def test_branches_that_cross_go_straight_on() -> None:
    """Uncoupled modes keep their shapes; sorted by frequency both would have a kink at z = 0."""
    found = branches(sorted_pair(0.0), -1.0, -1.0, 1.0)
    np.testing.assert_allclose(found.poles[:, 0].imag, 5.0 + found.z, atol=1e-12)
    np.testing.assert_allclose(found.poles[:, 1].imag, 5.0 - found.z, atol=1e-12)
    assert found.origin == 0


@pytest.mark.parametrize("coupling", [0.3, 1e-2, 1e-3])
def test_branches_that_veer_do_not_cross(coupling: float) -> None:
    """Coupled modes exchange their shapes: the poles are ±√(z² + e²), each smooth, however sharp the turn."""
    found = branches(sorted_pair(coupling), 0.5, -1.0, 1.0)
    expected = np.sqrt(found.z**2 + coupling**2)
    np.testing.assert_allclose(found.poles[:, 1].imag - 5.0, expected, atol=1e-12)
    np.testing.assert_allclose(found.poles[:, 0].imag - 5.0, -expected, atol=1e-12)
    assert (np.diff(found.z) > 0.0).all() and found.z[found.origin] == 0.5
    assert (found.z[0], found.z[-1]) == (-1.0, 1.0)


@pytest.mark.parametrize(("k", "free_hz"), [(2.5e9, 0.1814), (1.1e8, 0.1507)])
def test_a_kelvin_voigt_locus_ends_on_rigid_feet(jacket15: Assembly, k: float, free_hz: float) -> None:
    """Thesis figure 8.4: both ends undamped, one hump between; no Rayleigh damping."""
    model = support_model(jacket15, family=family("kelvin-voigt"), rayleigh=Rayleigh())
    locus = root_locus(model, np.array([k, 7.6e8]), "c", (1, 2, 3, 4, 5))
    f, zeta = locus.frequency_hz, locus.damping_ratio
    assert f[0, 0] == pytest.approx(free_hz, rel=6e-3)
    np.testing.assert_allclose(f[-1], numbered_modes(jacket15, 5).frequency_hz, rtol=1e-4)
    assert (zeta[[0, -1]] < 1e-4).all()
    for i, curve in enumerate(zeta.T):
        peak = int(np.argmax(curve))
        assert (np.diff(curve[: peak + 1]) > 0).all() and (np.diff(curve[peak:]) < 0).all()
        assert locus.most_damped(i) == (locus.values[peak], curve[peak])
    steps = np.abs(np.diff(locus.poles[:, 0])) / np.abs(locus.poles[:, 0] - locus.poles[0, 0]).max()
    assert steps.max() < 0.15  # fine enough to be drawn with straight lines


@pytest.mark.parametrize(
    ("law", "parameter"), [("zener", "k1"), ("maxwell-3", "loss_factor"), ("springpot", "k")]
)
def test_a_locus_passes_through_the_full_models_poles(
    models: dict[str, SupportModel], law: str, parameter: str
) -> None:
    """Every law, against an eigenvalue solver of the whole structure that knows no neighbour."""
    model = models[law]
    theta = np.array([np.sqrt(p.low * p.high) for p in model.parameters])
    theta[0] = 3e9
    locus = root_locus(model, theta, parameter, (1, 2, 4))
    column = [p.name for p in model.parameters].index(parameter)
    assert locus.values[locus.origin] == theta[column]
    for place in np.linspace(0, locus.values.size - 1, 4).astype(int):
        moved = theta.copy()
        moved[column] = locus.values[place]
        every = model.exact_modes(moved, (8,)).damped.eigenvalues
        exact = every[np.abs(locus.poles[place][:, None] - every).argmin(axis=1)]
        # the condensed model is as good as 1e-7 on its band
        np.testing.assert_allclose(locus.poles[place], exact, rtol=1e-6)
        assert len(set(exact)) == 3


def test_a_branch_ends_where_it_no_longer_oscillates(jacket15: Assembly) -> None:
    """A dashpot on the nacelle overdamps the first mode in its direction, and none in the other."""
    model = support_model(
        jacket15,
        family=family("kelvin-voigt"),
        rayleigh=Rayleigh.minimum(0.01, 0.1832),
        nuisance=NuisanceParameters(("c_fore_aft",)),
    )
    theta = np.array([2.5e9, 7.6e8, 1e4])
    locus = root_locus(model, theta, "c_fore_aft", (1, 2))
    side_side, fore_aft = locus.poles.T
    assert np.isfinite(side_side).all()
    ended = np.isnan(fore_aft)
    assert ended.any() and not ended[0]
    first = int(np.argmax(ended))
    assert ended[first:].all()
    # just below, it is nearly critical: its damping ratio goes to one
    assert locus.damping_ratio[first - 1, 1] > 0.97


def test_the_pair_of_a_symmetric_structure_stays_one_until_a_leg_differs(jacket15: Assembly) -> None:
    """Without the eccentric rotor the jacket is as stiff along x as along y."""
    symmetric = assemble(replace(jacket15.structure, masses=()))
    together = support_model(symmetric, family=family("kelvin-voigt"), rayleigh=Rayleigh(), highest_mode=2)
    locus = root_locus(together, KV, "c", (1, 2))
    np.testing.assert_allclose(locus.poles[:, 0], locus.poles[:, 1], rtol=1e-7)
    legs = support_model(
        symmetric, family=family("kelvin-voigt"), rayleigh=Rayleigh(), tie="per-leg", highest_mode=2
    )
    one = root_locus(legs, np.tile(KV, 4), legs.parameters[1].name, (1, 2))
    assert np.isfinite(one.poles).all()
    apart = np.abs(one.poles[:, 0] - one.poles[:, 1]) / np.abs(one.poles[:, 0])
    assert apart[one.origin] < 1e-7 and apart.max() > 1e-4
    # leaving the double pole, neither branch takes the other's way: each goes on as it came
    turns = np.angle(np.diff(one.poles, axis=0)[1:] / np.diff(one.poles, axis=0)[:-1])
    apart_here = apart[1:-1] > 1e-6
    assert np.abs(turns[apart_here]).max() < 1.0


def test_a_laws_name_moves_all_tie_groups_by_one_factor(jacket15: Assembly) -> None:
    model = support_model(
        jacket15, family=family("kelvin-voigt"), rayleigh=Rayleigh(), tie="horizontal-vertical"
    )
    theta = np.array([2.5e9, 7.6e8, 5e9, 1.5e8])
    locus = root_locus(model, theta, "c", (1, 2))
    place = locus.origin + 20
    factor = locus.values[place] / theta[1]
    moved = theta * [1.0, factor, 1.0, factor]
    np.testing.assert_allclose(locus.poles[place], model.predict(moved, (1, 2)).poles, rtol=1e-10)
    # the horizontal one may grow further, but the lower of both ends bounds them
    assert locus.values[0] == pytest.approx(7.6e8 * 1e4 / 1.5e8)
    with pytest.raises(InputError, match="no such parameter.*allowed: k_horizontal"):
        root_locus(model, theta, "q", (1,))


@pytest.mark.parametrize("law", ["kelvin-voigt", "zener", "maxwell-3", "springpot"])
def test_sensitivities_are_derivatives_of_the_full_models_modes(
    models: dict[str, SupportModel], law: str
) -> None:
    model = models[law]
    theta = np.array([np.sqrt(p.low * p.high) for p in model.parameters])
    theta[0] = 3e9
    found = sensitivity(model, theta, (1, 2, 4))
    # rounding of the poles, 1e-12, over the step of 1e-4
    assert found.difference < 1e-7
    h = 1e-3
    up, down = (
        model.exact_modes(theta * np.exp(sign * h * np.eye(theta.size)[0]), (1, 2, 4)) for sign in (1, -1)
    )
    by_f = np.log(up.frequency_hz / down.frequency_hz) / (2 * h)
    by_zeta = (up.damping_ratio - down.damping_ratio) / (2 * h)
    # a stiffer foot never slows an undamped mode; tolerance: h² and the eigenvalue solver's 1e-10 over h
    np.testing.assert_allclose(found.frequency[:, 0], by_f, atol=2e-6)
    np.testing.assert_allclose(found.damping[:, 0], by_zeta, atol=2e-6)


def test_costs_are_squares_of_the_residuals_with_their_priors(jacket15: Assembly) -> None:
    targets = (Target(1, 0.1819, 0.0005, 0.0127, 0.001), Target(4, 0.7362, 0.002))
    model = support_model(
        jacket15,
        family=family("kelvin-voigt"),
        rayleigh=Rayleigh.minimum(0.01, 0.1832),
        priors={"k": (2e9, 0.5)},
    )
    problem = single(model, Residuals(targets, relative=False))
    z = np.log(np.array([[2.5e9, 7.6e8], [1e9, 1e8], [1e13, 1e5]]))
    expected = [float(r @ r) for r, _, _ in (problem.evaluate(one, None) for one in z)]
    np.testing.assert_allclose(problem.costs(z, None), expected, rtol=1e-9)
    surface = cost_surface(problem, np.exp(z[0]), (1, 0), np.array([1e8]), np.array([1e9, 3e9]))
    assert surface.cost.shape == (2, 1)
    assert surface.cost[0, 0] == pytest.approx(expected[1], rel=1e-9)


def test_ways_lead_from_their_starts_to_solutions_or_say_where(
    models: dict[str, SupportModel], table_6_1: Residuals
) -> None:
    """The thesis's own points 1 and 2 of Kelvin–Voigt, and the first starts of a search."""
    problem = single(models["kelvin-voigt"], table_6_1)
    solutions = search(problem, starts=4).solutions
    own = np.array([[2.5e9, 7.6e8], [1.1e8, 1e12]])
    starts = np.vstack([own, starting_points(problem, 6, 0)])
    gradient = search_paths(problem, starts, solutions)
    assert [path.fate for path in gradient] == ["solution"] * 8
    np.testing.assert_allclose([path.points[0] for path in gradient], starts, rtol=1e-12)
    for path in gradient:
        assert path.end_cost == pytest.approx(solutions[0].cost, rel=1e-3)
        assert path.points.shape == (path.cost.size, 2)
        assert path.cost.min() <= path.end_cost * (1.0 + 1e-6)
    simplex = search_paths(problem, starts, solutions, method="nelder-mead")
    fates = [path.fate for path in simplex]
    assert fates[:2] == ["solution"] * 2 and "plateau" in fates
    for path in simplex:
        if path.fate == "plateau":
            # rigid feet: the relative error of ζ1 between the steel's 1 % and the 1.27 % measured
            assert path.end_cost == pytest.approx((0.01 / 0.0127 - 1.0) ** 2, rel=0.03)
            assert path.solution is None
        else:
            assert path.solution == 0
