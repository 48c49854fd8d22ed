"""Water's mass and drag as parameters: the full model's poles, gradients, and a share of the damping."""

from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse as sp

from jackettwin.errors import InputError
from jackettwin.loads.members.drag_damping import sea_drag_damping
from jackettwin.loads.members.morison import morison_points
from jackettwin.loads.members.water import Water, water_mass
from jackettwin.loads.sea.waves import SeaState
from jackettwin.soil import Parameter
from jackettwin.structure import Assembly
from jackettwin.updating import SupportModel, nuisance_parameters as nuisance_module
from jackettwin.updating.budget import SOURCES, budget_of_draws, damping_budget, damping_sources
from jackettwin.updating.nuisance_parameters import NuisanceParameter, NuisanceParameters, matrix_of

MODES = (1, 2, 3, 4, 5)
TRUTH = np.array([3e9, 0.1, 2e4, 1.2, 1.5])


@pytest.fixture(scope="module")
def wet(jacket15: Assembly, maxwell_3: Callable[..., SupportModel]) -> SupportModel:
    grid = morison_points(jacket15, highest_z=0.0, lowest_z=-72.0, spacing=8.0)
    water = {
        "water_mass": water_mass(jacket15, grid, Water()),
        "water_damping": sea_drag_damping(grid, SeaState(3.0, 8.0), 72.0),
    }
    return maxwell_3(nuisance=NuisanceParameters(("c_side_side",), matrices=water))


def test_factors_are_lognormal_around_one(wet: SupportModel) -> None:
    mass, damping = wet.parameters[-2:]
    assert (mass.name, mass.median, mass.log_std) == ("water_mass", 1.0, 0.2)
    assert (damping.name, damping.median, damping.log_std) == ("water_damping", 1.0, 0.5)


def test_poles_are_those_of_the_full_model(wet: SupportModel) -> None:
    exact, poles = wet.exact_modes(TRUTH, MODES), wet.predict(TRUTH, MODES).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    # the water acts on the retained coordinates: 4e-5 and 1e-3 with 30 % more of it
    np.testing.assert_allclose(f, exact.frequency_hz, rtol=4e-5)
    np.testing.assert_allclose(zeta, exact.damping_ratio, rtol=1e-3)


def test_without_more_mass_and_without_drag_nothing_changes(
    wet: SupportModel, maxwell_3: Callable[..., SupportModel]
) -> None:
    dry = maxwell_3(nuisance=NuisanceParameters(("c_side_side",)))
    still = np.array([*TRUTH[:3], 1.0, 1e-12])
    poles = dry.predict(TRUTH[:3], MODES).poles
    np.testing.assert_allclose(wet.predict(still, MODES).poles, poles, rtol=1e-8)


def test_slopes_are_differences(wet: SupportModel) -> None:
    here, h = wet.predict(TRUTH, MODES), 1e-4
    for j in range(TRUTH.size):
        step = np.exp(h * (np.arange(TRUTH.size) == j))
        up, down = (wet.predict(TRUTH * f, MODES, near=here).poles for f in (step, 1.0 / step))
        scale = np.abs(here.slopes[:, j]).max()
        np.testing.assert_allclose(here.slopes[:, j], (up - down) / (2 * h), atol=1e-6 * scale)


def test_more_water_is_slower_by_the_modal_mass_it_adds(wet: SupportModel, jacket15: Assembly) -> None:
    """Rayleigh's quotient: d ln f/dw = −½ φᵀM_wφ / φᵀMφ."""
    theta = np.array([3e9, 0.1, 1e2, 1.0, 1e-6])
    phi = wet.exact_modes(theta, (4,)).shapes[:, 0]
    mass = wet.nuisance.matrices["water_mass"]
    share = float((phi.conj() @ (mass @ phi)).real / (phi.conj() @ (jacket15.mass @ phi)).real)
    pole, slope = (a[0] for a in (wet.predict(theta, (4,)).poles, wet.predict(theta, (4,)).slopes))
    d_ln_f = float((np.conj(pole) * slope[3]).real / abs(pole) ** 2)
    # damped modes on lossy soil against an undamped quotient
    assert d_ln_f == pytest.approx(-0.5 * share, rel=0.02)


def test_more_water_than_the_structure_weighs_is_refused(
    jacket15: Assembly, maxwell_3: Callable[..., SupportModel]
) -> None:
    heavy = {"water_mass": 2.1 * jacket15.mass}
    with pytest.raises(InputError, match="cannot include that much water"):
        maxwell_3(nuisance=NuisanceParameters((), matrices=heavy))


def test_the_budget_has_a_share_of_water(wet: SupportModel) -> None:
    draws = TRUTH * np.exp(np.array([0.0, 0.0, 0.0, 0.0, 0.5]) * np.linspace(-2, 2, 21)[:, None])
    budget = damping_budget(wet, TRUTH, MODES)
    poles = wet.predict(TRUTH, MODES).poles
    assert budget.damping_ratio.shape == (5, len(SOURCES))
    np.testing.assert_allclose(budget.damping_ratio.sum(axis=1), -poles.real / np.abs(poles), rtol=1e-8)
    # drag twice as strong takes twice as much, and what it took is what is missing without it
    dry = TRUTH * np.array([1, 1, 1, 1, 0.05 / 1.5])
    less = wet.predict(dry, MODES).poles
    lost = -poles.real / np.abs(poles) + less.real / np.abs(less)
    np.testing.assert_allclose(budget.damping_ratio[:, 3] * (1.45 / 1.5), lost, rtol=0.05, atol=1e-6)
    found = wet.predict_many(draws, MODES, slopes=False)
    interval = budget_of_draws(
        MODES, damping_sources(wet, wet.points(draws).plain(), found)
    ).damping_ratio_interval_90
    assert interval is not None
    low, high = interval[3, 3]
    # the 5 and 95 % points of 21 even steps: e^{±0.9} about 1.5
    assert high / low == pytest.approx(np.exp(1.8), rel=0.05)


@pytest.fixture
def spring_on_top(monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed package adds a spring that holds the tower top along x."""

    def matrix(assembly: Assembly) -> sp.csr_array:
        row = sp.csr_array(assembly.expand[assembly.mesh.node_dofs(assembly.structure.top_node)[:1]])
        return sp.csr_array(row.T @ row)

    stay = NuisanceParameter(Parameter("k_stay", 1e3, 1e7, "N/m"), "stiffness", matrix=matrix)
    monkeypatch.setattr(nuisance_module, "plugins_of_type", lambda group, kind: {"stay": stay})


@pytest.mark.usefixtures("spring_on_top")
def test_a_parameter_of_another_package_acts_as_the_full_model_says(
    jacket15: Assembly, maxwell_3: Callable[..., SupportModel]
) -> None:
    model = maxwell_3(nuisance=NuisanceParameters(matrices={"k_stay": matrix_of("k_stay")(jacket15)}))
    assert model.parameters[-1].name == "k_stay"
    soft, stiff = (np.array([*TRUTH[:2], k]) for k in (1e3, 1e6))
    f = [np.abs(model.predict(theta, MODES).poles) / (2 * np.pi) for theta in (soft, stiff)]
    np.testing.assert_allclose(f[1], model.exact_modes(stiff, MODES).frequency_hz, rtol=1e-4)
    assert np.max(f[1] / f[0]) > 1.05
    step = np.array([0.0, 0.0, 1e-4])
    ahead, behind = (model.predict(stiff * np.exp(s * step), MODES).poles for s in (1, -1))
    slopes = model.predict(stiff, MODES).slopes[:, 2]
    np.testing.assert_allclose(slopes, (ahead - behind) / 2e-4, rtol=1e-4, atol=1e-7)


def test_a_parameter_that_nobody_adds_is_refused() -> None:
    with pytest.raises(InputError, match=r"update.parameters: no such parameter.*'k_stay'"):
        matrix_of("k_stay")
