"""Life of an asset's welds from what its days say."""

from __future__ import annotations

import json
from datetime import UTC, date, datetime

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.constants import YEAR_S
from jackettwin.decks import read_structure
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study import LIFE_SO_FAR, LifeSoFar, asset_life
from jackettwin.twin import DAMAGE_UNIT, Day, LifeSettings, RestingLoads, SensedTime, StressModel, WeldSums
from jackettwin.twin.life.damage_sums import PointSums
from jackettwin.twin.state import Operation
from jackettwin.updating import numbered_modes

BUDGET = 0.04
RATE = 0.02
"""Of damage a year that drawn days have in the mean."""
FIRST = date(2024, 1, 1).toordinal()


def day(damage: dict[int, float], *, records: int = 144, op: str = "parked") -> Day:
    """Return a day with this damage of a year at the third point of each side."""
    share = records * 600 / YEAR_S
    welds = {
        side: WeldSums(records, PointSums(0, 0, round(rate * share / DAMAGE_UNIT)))
        for side, rate in damage.items()
    }
    at = datetime(2024, 1, 1, tzinfo=UTC)
    return Day(
        {"r": (0, 600)}, at, at, {op: Operation(sensed=SensedTime(records, records * 600, 0), welds=welds)}
    )


def folded(days: list[Day]) -> LifeSoFar:
    so_far = LifeSoFar()
    for k, one in enumerate(days):
        so_far = so_far.plus(date.fromordinal(FIRST + k).isoformat(), one, BUDGET)
    return so_far


def weather(n: int, rng: np.random.Generator, *, sides: int = 12, cov: float = 1.0) -> list[dict[int, float]]:
    """Return daily damage of some sides that weather moves alike, and each a little by itself."""
    s = np.sqrt(np.log(1.0 + cov**2))
    return [
        {
            k: RATE * float(np.exp(s * common - 0.5 * s**2 + 0.15 * own))
            for k, own in enumerate(rng.standard_normal(sides))
        }
        for common in rng.standard_normal(n)
    ]


@pytest.fixture(scope="module")
def model() -> StressModel:
    structure = read_structure("jacket15")
    assembly = assemble(structure, gravity=True)
    settings = LifeSettings(design_factor=1.0, years=25.0)
    return StressModel(
        settings,
        assembly,
        RestingLoads.of(assemble(structure)),
        Rayleigh.minimum(0.005, 0.3),
        numbered_modes(assembly, 12),
    )


def test_the_rate_of_equal_days_is_theirs_and_has_no_scatter(model: StressModel) -> None:
    so_far = folded([day({5: 0.02, 8: 0.03})] * 40)
    found = asset_life(model, so_far)
    assert [one.number for one in found.welds] == [8, 5]
    row = found.rows()[0]
    assert row["rate_per_year"] == pytest.approx(0.03, rel=1e-6)
    assert row["life_years"] == pytest.approx(1.0 / 0.03, rel=1e-6)
    assert row["damage"] == pytest.approx(0.03 * 40.0 / 365.25, rel=1e-6)
    assert row["position"] == "saddle 90°" and row["side"] == "chord"
    assert row["age_years"] == pytest.approx(40.0 / 365.25)
    assert row["variance_shares"]["weather sampled"] < 1e-9
    assert sum(row["variance_shares"].values()) == pytest.approx(1.0)
    assert row["damage_by_state"] == {"parked": 1.0}


def test_the_interval_of_the_rate_holds_the_true_one_in_nine_of_ten() -> None:
    """Two hundred assets, sixty days of skewed weather: two standard errors, and what skewness takes."""
    inside = []
    for seed in range(200):
        so_far = folded([day(d) for d in weather(60, np.random.default_rng(seed), sides=1)])
        time, welds = so_far.total
        std = np.sqrt(so_far.variances(0, time, welds[0])["weather sampled"])
        rate = DAMAGE_UNIT * welds[0].worst * YEAR_S / time.seconds
        true = RATE * np.exp(0.5 * 0.15**2)
        inside.append(abs(np.log(rate / true)) < 1.645 * std)
    assert 0.82 < np.mean(inside) < 0.95


def test_a_weld_that_takes_another_share_is_told_and_others_are_not() -> None:
    """Three years of weather; one weld takes 2.5 times its share in the last hundred days."""
    days = weather(1100, np.random.default_rng(7))
    quiet = folded([day(d) for d in days])
    assert quiet.departed == {}
    for d in days[1000:]:
        d[3] *= 2.5
    loud = folded([day(d) for d in days])
    assert set(loud.departed) == {3}
    since, ratio = loud.departed[3]
    assert 0 < date.fromisoformat(since).toordinal() - FIRST - 1000 < 40
    assert 1.5 < ratio < 2.8


def test_a_rate_beyond_the_budget_is_told_once_it_is_sure() -> None:
    rng = np.random.default_rng(1)
    sure = folded([day({k: 6.0 * x for k, x in d.items()}) for d in weather(60, rng)])
    doubtful = folded([day({k: 2.1 * x for k, x in d.items()}) for d in weather(60, rng, cov=4.0)])
    assert len(sure.over_budget) == 12
    assert doubtful.over_budget == {}
    (_, ratio, low), *_ = sure.over_budget.values()
    assert ratio > low > 1.0


def test_findings_keep_their_day_and_spare_welds_without_factors(model: StressModel) -> None:
    n = 2 * sum(len(joint.welds) for joint in model.joints)
    days = [day({k: 0.4 for k in range(n + len(model.tubes))})] * 45
    early, late = asset_life(model, folded(days[:35])), asset_life(model, folded(days))
    assert [(d, str(f)) for d, f in early.findings()] == [(d, str(f)) for d, f in late.findings()]
    over = {one.number for one in late.welds if not one.weld.warnings}
    assert len(late.findings()) == len(over) < len(late.welds)


def test_what_is_kept_does_not_grow_with_days_and_is_read_again() -> None:
    days = [day(d) for d in weather(400, np.random.default_rng(2))]
    sizes = [len(json.dumps(LIFE_SO_FAR.dump(folded(days[:n])))) for n in (100, 400)]
    assert sizes[1] < 1.05 * sizes[0]
    so_far = folded(days[:57])
    assert LIFE_SO_FAR.load(json.loads(json.dumps(LIFE_SO_FAR.dump(so_far)))) == so_far


def test_welds_around_tubes_have_a_life_and_alarms(model: StressModel) -> None:
    """Numbered behind the sides of joints: a name, a place on their tube, a curve of butt welds."""
    n = 2 * sum(len(joint.welds) for joint in model.joints)
    found = asset_life(model, folded([day({5: 0.02, n + 1: 0.4})] * 45))
    row, tube = found.rows()[0], model.tubes[1]
    assert (row["joint"], row["side"], row["position"]) == (tube.name, "tube", "90°")
    assert row["node_m"][2] == row["z_m"] == pytest.approx(tube.z_m)
    assert row["above_sea_m"] == pytest.approx(tube.z_m - model.assembly.structure.sea_level_z_m)
    assert row["rate_per_year"] == pytest.approx(0.4, rel=1e-6)
    assert [f.subject for _, f in found.findings()] == [f"{tube.name}, tube"]


def test_states_of_operation_share_the_damage(model: StressModel) -> None:
    so_far = folded([day({5: 0.02}), day({5: 0.06}, op="operating")])
    (row,) = asset_life(model, so_far).rows()
    assert_allclose([row["damage_by_state"][op] for op in ("parked", "operating")], [0.25, 0.75], rtol=1e-6)


def test_an_asset_without_damage_has_no_welds(model: StressModel) -> None:
    assert asset_life(model, LifeSoFar()).rows() == []
