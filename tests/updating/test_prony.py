"""Free Prony series: a planted one comes back, from every start, and branches that are not there are said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.soil import Prony, family
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import Residuals, SupportModel, Target, single, support_model
from jackettwin.updating.search.solutions import search

OC4 = Path(__file__).parents[2] / "qualify" / "decks" / "oc4_jacket.dat"
MODES = (1, 2, 3, 4, 5)


@pytest.fixture(scope="module")
def oc4() -> Assembly:
    return assemble(read_structure(OC4))


def model(assembly: Assembly, law: str, **options: object) -> SupportModel:
    steel = Rayleigh.minimum(0.005, 0.3)
    return support_model(assembly, family=family(law), rayleigh=steel, highest_mode=5, **options)  # type: ignore[arg-type]


def planted(assembly: Assembly, law: str, theta: list[float]) -> tuple[Target, ...]:
    """What a structure on a law shows, from the eigenvalues of the full model."""
    exact = model(assembly, law).exact_modes(np.array(theta), MODES)
    return tuple(
        Target(m, float(f), damping_ratio=float(z))
        for m, f, z in zip(MODES, exact.frequency_hz, exact.damping_ratio, strict=True)
    )


def test_a_series_is_its_relaxation_modulus() -> None:
    """k(t) = k0 (1 + Σ g_j exp(−t/τ_j)), by hand; the times fall by the spacings."""
    law = family("prony-3").build(np.array([2.0, 0.5, 4.0, 0.25, 8.0, 1.0, 5.0]), 0.2)
    assert isinstance(law, Prony)
    assert law.tau == pytest.approx((4.0, 0.5, 0.1))
    t = np.array([0.0, 0.3, 2.0])
    by_hand = 2.0 * (1 + 0.5 * np.exp(-t / 4.0) + 0.25 * np.exp(-t / 0.5) + np.exp(-t / 0.1))
    np.testing.assert_allclose(law.relaxation(t), by_hand, rtol=1e-12)


@pytest.mark.parametrize("theta", [[5e8, 0.2, 0.5, 0.3, 8.0], [2e9, 0.05, 2.0, 0.4, 30.0]])
def test_two_branches_planted_on_oc4_come_back_to_four_digits(oc4: Assembly, theta: list[float]) -> None:
    """The OC4 jacket is symmetric but for its nacelle: pairs of modes 0.4 % apart."""
    problem = single(model(oc4, "prony-2"), Residuals(planted(oc4, "prony-2", theta), relative=True))
    found = search(problem, starts=8)
    assert len(found.solutions) == 1 and found.solutions[0].found >= 8
    # targets are the full model's; the condensed one agrees with it to 1e-8, the weakest branch is 1e4 weaker
    np.testing.assert_allclose(found.solutions[0].theta, theta, rtol=5e-5)


def test_a_zener_truth_leaves_one_branch_at_its_bound(oc4: Assembly) -> None:
    """No data tell a second branch where there is none: whichever it is, it is nearly nothing."""
    targets = planted(oc4, "zener", [5e8, 1e8, 3e8])
    found = search(single(model(oc4, "prony-2"), Residuals(targets, relative=True)), starts=4)
    for solution in found.solutions:
        if solution.cost < 1e-8:
            assert min(solution.theta[[1, 3]]) < 0.01
            assert max(solution.theta[[1, 3]]) == pytest.approx(0.6, rel=0.02)


def test_the_law_is_regularised_by_lognormal_priors_where_data_have_deviations(oc4: Assembly) -> None:
    """Three values cannot tell five parameters; with the priors one solution is left."""
    plain = model(oc4, "prony-2")
    informed = model(oc4, "prony-2", informed=True)
    assert all(p.median is None for p in plain.parameters)
    assert [p.name for p in informed.parameters if p.median is not None] == ["g1", "tau1", "g2", "spacing2"]
    for p in informed.parameters[1:]:
        assert p.median is not None and p.low < p.median < p.high
    full = planted(oc4, "prony-2", [5e8, 0.2, 0.5, 0.3, 8.0])
    few = (
        Target(1, full[0].frequency_hz, 0.002 * full[0].frequency_hz, full[0].damping_ratio, 0.003),
        Target(4, full[3].frequency_hz, 0.002 * full[3].frequency_hz),
    )
    found = search(single(informed, Residuals(few, relative=False)), starts=4)
    assert len(found.solutions) == 1
    assert not found.solutions[0].at_bound and not found.solutions[0].locked_damper
