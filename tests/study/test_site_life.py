"""Life over a site: damage of bins by their share, at points apart, with what the bins leave open."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from math import log
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from jackettwin.constants import YEAR_S
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.fatigue import (
    Cycles,
    RemainingLife,
    WeldLife,
    basis_page,
    design_basis,
    models_at_height,
    read_details,
)
from jackettwin.intervals import NORMAL_90
from jackettwin.structure import assemble
from jackettwin.study import SiteLife, read_site, site_life
from jackettwin.twin import planned_joints

BINS = [
    {"share": 0.6, "state": "operating", "speed_m_s": 9.0, "hs_m": 1.0, "tp_s": 6.0},
    {"share": 0.1, "state": "parked", "speed_m_s": 20.0, "hs_m": 5.0, "tp_s": 10.0},
]
DURATION_S = 600.0


def written(folder: Path, **changed: object) -> Path:
    scenario = {"structure": "jacket15", "water": {"depth_m": 72}, "rotor": {"data": "iea15"}}
    (folder / "scenario.yaml").write_text(yaml.safe_dump(scenario))
    path = folder / "site.yaml"
    path.write_text(yaml.safe_dump({"scenario": "scenario.yaml", "bins": BINS} | changed))
    return path


@pytest.fixture(scope="module")
def template() -> WeldLife:
    weld = planned_joints(assemble(read_structure("jacket15")))[0].welds[0]
    environment, model = models_at_height("T")(20.0)
    life = model.life(Cycles(np.array([50e6]), np.zeros(0)), DURATION_S)
    return WeldLife(weld, "chord", "crown 0°", 20.0, environment, np.zeros(8), 50e6, life)


def lived(template: WeldLife, damage: np.ndarray) -> WeldLife:
    life = replace(template.life, damage=float(damage.max()), life_years=DURATION_S / YEAR_S / damage.max())
    scale = damage.max() / template.life.damage
    median = template.life.median_damage * scale
    low, high = (bound * scale for bound in template.life.damage_interval_90)
    life = replace(life, median_damage=median, damage_interval_90=(low, high))
    return replace(template, damage_by_point=damage, life=life)


def over(
    monkeypatch: pytest.MonkeyPatch,
    path: Path,
    template: WeldLife,
    damage: dict[tuple[float, int], np.ndarray],
) -> SiteLife:
    """Return the life over a site whose simulations do the damage {(wind, seed of its bin): by point}."""
    said: list[dict] = []

    def scenario_life(content: dict, *_: object) -> SimpleNamespace:
        said.append(content)
        wind = content["wind"]
        factor = 0.5 if "support" in content else 1.0
        one = lived(template, factor * damage[wind["speed_m_s"], wind["seed"] % 100])
        return SimpleNamespace(joints=(one,), duration_s=DURATION_S)

    monkeypatch.setattr("jackettwin.study.life.site_life.scenario_life", scenario_life)
    monkeypatch.setattr("jackettwin.study.life.site_life.scenario_from", lambda content, path: content)
    models = models_at_height("T")
    return site_life(read_site(path), models, read_details(None, lambda curve: models))


def test_points_are_summed_over_bins_before_the_worst_is_taken(
    tmp_path: Path, template: WeldLife, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = np.full(8, 1e-9), np.full(8, 1e-9)
    first[0], first[3], second[3], second[5] = 5e-7, 4e-7, 2e-6, 2.1e-6
    damage = {(9.0, 1): first, (9.0, 2): 3.0 * first, (20.0, 1): second, (20.0, 2): second}
    found = over(monkeypatch, written(tmp_path), template, damage)
    (one,) = found.welds
    # point 3 is the worst of neither bin
    by_hand = (0.6 * 2.0 * 4e-7 + 0.1 * 2e-6) * YEAR_S / DURATION_S
    assert one.rate == pytest.approx(by_hand, rel=1e-12)
    assert one.life_years == pytest.approx(1.0 / by_hand, rel=1e-12)
    assert one.by_bin == pytest.approx([4.8e-7 / 6.8e-7, 2e-7 / 6.8e-7], rel=1e-12)
    # scatter of 1 and 3 about 2 is 1/2, of equal ones none: in the mean 1/4, over two records of each bin
    weather = 0.5 * 0.25 * (4.8**2 + 2.0**2) / 6.8**2
    assert one.variances["weather of the bins"] == pytest.approx(weather, rel=1e-9)
    own = log(template.life.damage_interval_90[1] / template.life.median_damage) / NORMAL_90
    assert one.remaining.log_std**2 == pytest.approx(own**2 + weather, rel=1e-9)
    assert found.numbers == (2, 2)


def test_variants_have_the_same_weather(
    tmp_path: Path, template: WeldLife, monkeypatch: pytest.MonkeyPatch
) -> None:
    damage = {(wind, seed): np.full(8, 1e-7) for wind in (9.0, 20.0) for seed in (1, 2)}
    path = written(tmp_path, variants={"pinned": {"support": "pinned"}})
    found = over(monkeypatch, path, template, damage)
    (side,) = found.variants["as stated"]
    assert found.variants["pinned"][side] == pytest.approx(2.0 * found.variants["as stated"][side])
    site = read_site(path)
    stated, pinned = (site.simulations(1, o)[0] for o in ({}, site.variants["pinned"]))
    assert stated["wind"] == pinned["wind"] and stated["waves"] == pinned["waves"]
    assert stated["rotor"]["state"] == "parked" and pinned["support"] == "pinned"
    seeds = [c["wind"]["seed"] for i in (0, 1) for c in site.simulations(i, {})]
    assert len(set(seeds)) == 4


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"bins": [BINS[0], BINS[0] | {"share": 0.5}]}, "more than all time"),
        ({"bins": [{k: v for k, v in BINS[0].items() if k != "tp_s"}]}, "go together"),
        ({"bins": [BINS[0] | {"records": ["r.parquet"]}]}, "need a twin"),
        ({"bins": [BINS[0] | {"share": -0.1}]}, "share"),
        ({"bins": [BINS[0] | {"state": "flying"}]}, "state"),
        ({"twin": "t.yaml", "bins": [BINS[0] | {"records": ["r.parquet"]}]}, "no such file"),
        ({"scenario": "none.yaml"}, "none.yaml"),
    ],
)
def test_a_site_that_does_not_fit_is_refused(tmp_path: Path, changed: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_site(written(tmp_path, **changed))


def test_what_is_left_later_is_that_of_a_greater_age() -> None:
    now = RemainingLife(0.01, 1.0, 5.0)
    assert now.later(10.0) == RemainingLife(0.01, 1.0, 15.0)
    assert now.later(10.0).reliability_index < now.reliability_index


def test_the_design_basis_names_its_inputs_by_their_content(tmp_path: Path) -> None:
    file = tmp_path / "scenario.yaml"
    file.write_bytes(b"structure: jacket15\n")
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "feet.yaml").write_text("law: {file: curve.csv}\n")
    (tmp_path / "sub" / "curve.csv").write_text("1,2\n")
    file.write_bytes(b"structure: jacket15\nsupport: sub/feet.yaml\nname: scenario.yaml\n")
    basis = design_basis([file], models_at_height("T", design_factor=2.0), [{"what": "ice", "clause": "X 1"}])
    # the scenario names itself, its feet, and these a table: each once
    assert [Path(one["file"]).name for one in basis["inputs"]] == ["scenario.yaml", "feet.yaml", "curve.csv"]
    assert basis["inputs"][0]["sha256"] == hashlib.sha256(file.read_bytes()).hexdigest()
    assert basis["curves"]["free-corrosion"]["m"] == [3.0, 3.0]
    assert basis["curves"]["cathodic"]["log_a"][0] == 12.180
    page = basis_page("site", basis, [("joint", "life"), ("j1", "30")])
    for text in ("ice (X 1)", "design fatigue factor: 2", "| j1 | 30 |", basis["inputs"][0]["sha256"]):
        assert text in page
