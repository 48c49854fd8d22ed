"""Laws on pile heads: 6×6 stiffness scaled, in proportion, with priors from it."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import MUDLINE, family, moved_to_mudline, tied_at_mudline
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.laws.viscoelastic import Prony
from jackettwin.soil.support import Spring, Support, pinned
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.structure.model import STEEL, Member, PointMass, Reaction, Section, Structure
from jackettwin.updating import Residuals, Target, joint, support_model
from jackettwin.updating.model import SupportModel
from jackettwin.updating.tie_groups import TIES, priors_of, tie_groups

F1 = 0.1832
HEAD = np.diag([6e8, 6e8, 4e9, 3e11, 3e11, 6e10])
HEAD[0, 4] = HEAD[4, 0] = -9e9
HEAD[1, 3] = HEAD[3, 1] = 9e9
"""Of a pile of 6 m diameter in medium sand [N/m, N, N·m]."""


@pytest.fixture(scope="module")
def heads(jacket15: Assembly) -> Support:
    return read_foundation("jacket15_records").heads(jacket15.structure)


def on_heads(jacket15: Assembly, heads: Support, tie: str, **options: object) -> SupportModel:
    steel = Rayleigh.minimum(0.0055, F1)
    return support_model(
        jacket15, family=family("maxwell-3"), rayleigh=steel, tie=tie, heads=heads, highest_mode=5, **options
    )


@pytest.mark.parametrize("tie", [tie for tie in TIES if tie != MUDLINE])
def test_at_their_own_stiffness_the_heads_are_themselves(
    jacket15: Assembly, heads: Support, tie: str
) -> None:
    model = on_heads(jacket15, heads, tie)
    theta = np.array([value for k in model.tie_groups.stiffness for value in (k, 1e-4)])
    exact = undamped_modes(build_system(jacket15, heads), 5).frequency_hz
    # a loss factor of 1e-4 and the heads' own 2 % move frequencies by less than 1e-5; with one law for both
    # sides the parts keep their proportion
    np.testing.assert_allclose(np.abs(model.predict(theta, (1, 2)).poles) / (2 * np.pi), exact[:2], rtol=2e-5)
    np.testing.assert_allclose(
        model.exact_modes(theta, (1, 2)).poles, model.predict(theta, (1, 2)).poles, rtol=1e-8
    )


def test_piles_summed_at_the_mudline_are_themselves_at_their_own_stiffness(jacket15: Assembly) -> None:
    tied = assemble(tied_at_mudline(jacket15.structure))
    heads = read_foundation("jacket15_records").heads(tied.structure)
    model = on_heads(tied, heads, MUDLINE)
    assert [p.name for p in model.parameters] == ["k_u", "k_theta", "loss_factor"]
    theta = np.array([*model.tie_groups.stiffness, 1e-4])
    exact = undamped_modes(build_system(tied, moved_to_mudline(tied.structure, heads)), 5).frequency_hz
    # as above, and sway and rocking have one loss where the heads' differ
    np.testing.assert_allclose(np.abs(model.predict(theta, (1, 2)).poles) / (2 * np.pi), exact[:2], rtol=2e-5)
    np.testing.assert_allclose(
        model.exact_modes(theta, (1, 2)).poles, model.predict(theta, (1, 2)).poles, rtol=1e-8
    )


def test_the_axial_stiffness_is_the_closed_form(jacket15: Assembly, heads: Support) -> None:
    """√(k EA)·(tanh λL + κ)/(1 + κ tanh λL) with κ = tip/√(k EA): 4.1e9 N/m."""
    k, tip, EA, L = 1.6e8, 4.0e8, 2.1e11 * np.pi / 4 * (2.8**2 - 2.68**2), 60.0
    root = np.sqrt(k * EA)
    t, kappa = np.tanh(np.sqrt(k / EA) * L), tip / root
    found = tie_groups(jacket15.structure, "horizontal-vertical", heads=heads, reference_hz=F1)
    # finite elements of the pile
    assert found.stiffness[1] == pytest.approx(root * (t + kappa) / (1 + kappa * t), rel=1e-2)
    # dashpots of eq. (5.4) with ζ = 0.02 lose 4 % at the reference frequency in the soil, less in the steel
    assert 0.02 < found.loss_factor[1] < 0.04


def test_heads_give_priors_where_there_are_none(jacket15: Assembly, heads: Support) -> None:
    given = {"k_vertical": (3e9, 0.2)}
    model = on_heads(jacket15, heads, "horizontal-vertical", informed=True, priors=given)
    known = {p.name: (p.median, p.log_std) for p in model.parameters}
    assert known["k_vertical"] == (3e9, 0.2)
    assert known["k_horizontal"][0] == pytest.approx(model.tie_groups.stiffness[0])
    assert known["loss_factor_vertical"][0] == pytest.approx(model.tie_groups.loss_factor[1])
    assert priors_of(tie_groups(jacket15.structure, "all"), F1) == {}


def test_gradients_on_heads_are_differences(jacket15: Assembly, heads: Support) -> None:
    model, theta, h = on_heads(jacket15, heads, "all"), np.array([4e9, 0.1]), 1e-3
    slopes = model.predict(theta, (1, 4)).slopes
    for j in range(2):
        step = np.exp(h * (np.arange(2) == j))
        difference = (
            model.predict(theta * step, (1, 4)).poles - model.predict(theta / step, (1, 4)).poles
        ) / (2 * h)
        # second order in h
        np.testing.assert_allclose(slopes[:, j], difference, rtol=1e-6, atol=1e-6 * np.abs(difference).max())


def test_rigid_heads_are_refused(jacket15: Assembly) -> None:
    with pytest.raises(InputError, match="no stiffness that a law could scale"):
        tie_groups(jacket15.structure, "all", heads=pinned(jacket15.structure))


@pytest.fixture(scope="module")
def monopile() -> Assembly:
    pile, tower = Section(6.0, 0.06), Section(5.0, 0.03)
    return assemble(
        Structure(
            name="monopile",
            nodes={"foot": (0.0, 0.0, 0.0), "tp": (0.0, 0.0, 40.0), "top": (0.0, 0.0, 117.0)},
            members=(
                Member("pile", "foot", "tp", pile, pile, STEEL),
                Member("tower", "tp", "top", tower, tower, STEEL),
            ),
            masses=(PointMass("top", 350e3, (-0.4, 0.0, 2.0)),),
            reactions=(Reaction("foot", (True,) * 6),),
            subdivide=4,
        )
    )


def test_a_monopile_is_numbered_clamped_and_fitted_on_its_pile_head(monopile: Assembly) -> None:
    head = Support(springs=(Spring("foot", HEAD, Prony(k0=1.0)),))
    model = support_model(
        monopile,
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.005, 0.25),
        tie="horizontal-vertical",
        heads=head,
        highest_mode=5,
    )
    exact = undamped_modes(build_system(monopile, head), 5).frequency_hz
    k_h, k_v = model.tie_groups.stiffness
    found = model.predict(np.array([k_h, 1e-4, k_v, 1e-4]), (1, 2, 4)).poles
    # a loss factor of 1e-4 stiffens the head by as much again up to the second bending mode
    np.testing.assert_allclose(np.abs(found) / (2 * np.pi), exact[[0, 1, 3]], rtol=2e-4)


def test_a_monopile_needs_springs_that_hold_rotations(monopile: Assembly) -> None:
    with pytest.raises(InputError, match="support.stiffness: .*is unstable.*6×6"):
        support_model(monopile, family=family("maxwell-3"), rayleigh=Rayleigh.minimum(0.005, 0.25))


def split(jacket15: Assembly, **options: object) -> SupportModel:
    steel, law = Rayleigh.minimum(0.0055, F1), family("maxwell-3")
    tie = "per-leg-horizontal-vertical"
    return support_model(jacket15, family=law, rayleigh=steel, tie=tie, highest_mode=2, **options)


def test_legs_split_into_two_sides_are_the_others_at_equal_values(jacket15: Assembly) -> None:
    """Equal legs are the tie of horizontal and vertical supports; equal sides that of legs."""
    steel, law = Rayleigh.minimum(0.0055, F1), family("maxwell-3")
    model, sides, legs = split(jacket15), np.array([2e9, 0.1, 4e9, 0.05]), np.arange(1.0, 5.0)
    apart = support_model(jacket15, family=law, rayleigh=steel, tie="horizontal-vertical", highest_mode=2)
    own = support_model(jacket15, family=law, rayleigh=steel, tie="per-leg", highest_mode=2)
    by_leg = np.stack([1e9 * legs, 0.05 * legs], axis=1)
    pairs = (
        (np.tile(sides, 4), apart, sides),
        (np.tile(by_leg, 2).ravel(), own, by_leg.ravel()),
    )
    for theta, other, same in pairs:
        poles = model.predict(theta, (1, 2)).poles
        np.testing.assert_allclose(poles, other.predict(same, (1, 2)).poles, rtol=1e-9)


def test_bounds_and_priors_of_a_side_are_every_legs(jacket15: Assembly) -> None:
    model = split(
        jacket15,
        bounds={"k": (1e8, 1e11), "k_vertical": (1e9, 1e10), "k_foot_2_vertical": (2e9, 3e9)},
        priors={"loss_factor_horizontal": (0.1, 0.5)},
    )
    low = {p.name: p.low for p in model.parameters}
    assert (low["k_foot_1_horizontal"], low["k_foot_1_vertical"], low["k_foot_2_vertical"]) == (1e8, 1e9, 2e9)
    medians = {p.name: p.median for p in model.parameters}
    assert medians["loss_factor_foot_3_horizontal"] == 0.1 and medians["loss_factor_foot_3_vertical"] is None


def test_a_side_is_shared_or_scatters_by_itself(jacket15: Assembly) -> None:
    data = Residuals((Target(1, 0.18, 0.001), Target(2, 0.183, 0.001)), relative=False)
    given = joint(
        split(jacket15),
        {"": (data, {})},
        shared=("loss_factor", "k_horizontal"),
        scatter={"k_vertical": 0.3},
    )
    names = [p.name for p in given.parameters]
    assert names == ["k_horizontal", "loss_factor", *(f"k_foot_{i}_vertical" for i in range(1, 5))]
    (legs,) = given.prior.legs
    assert legs.name == "k_vertical" and legs.columns.tolist() == [2, 3, 4, 5]
    both = joint(split(jacket15), {"": (data, {})}, scatter={"k": 0.3}).prior.legs
    assert [group.name for group in both] == ["k_horizontal", "k_vertical"]
    assert [group.columns.tolist() for group in both] == [[0, 4, 8, 12], [2, 6, 10, 14]]
