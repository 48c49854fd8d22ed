"""Factored combinations: linear in every factor, enveloped by name."""

import json
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from jackettwin.checks import DesignBasis, frame_use
from jackettwin.cli import main
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, nodal_load, static_displacement
from jackettwin.simulate import combined_uses, read_combinations, read_scenario, scenario_uses
from jackettwin.soil import clamped
from jackettwin.structure import assemble

ACTIONS = {
    "permanent": {"weight": False, "forces": {"tower_top": [0.0, 0.0, -1e7]}},
    "variable": {"forces": {"tower_top": [0.0, 0.0, -2e6]}},
    "environmental": {
        "DLC 6.1, 0°": {"forces": {"tower_top": [2e6, 0.0, 0.0]}},
        "DLC 6.1, 90°": {"forces": {"tower_top": [0.0, 3e6, 0.0]}},
    },
}
COMBINATIONS = [
    {"name": "still", "permanent": 1.3, "variable": 1.5},
    {"name": "extreme", "permanent": 1.1, "variable": 1.1, "environmental": 1.35},
    {"name": "from the side", "permanent": 0.9, "environmental": 1.35, "of": ["DLC 6.1, 90°"]},
]


def written(folder: Path, actions=ACTIONS, combinations=COMBINATIONS) -> Path:
    path = folder / "uls.yaml"
    path.write_text(yaml.safe_dump({"actions": actions, "combinations": combinations}, allow_unicode=True))
    return path


def test_each_combination_is_the_sum_of_its_factored_actions(tmp_path: Path) -> None:
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    system = build_system(assembly, clamped(structure))
    found = combined_uses(read_combinations(written(tmp_path)), DesignBasis(), system)
    by_hand = {
        "still": (0.0, 0.0, -1.3e7 - 3e6),
        "extreme, DLC 6.1, 0°": (2.7e6, 0.0, -1.1e7 - 2.2e6),
        "extreme, DLC 6.1, 90°": (0.0, 4.05e6, -1.1e7 - 2.2e6),
        "from the side, DLC 6.1, 90°": (0.0, 4.05e6, -0.9e7),
    }
    assert set(found.each) == set(by_hand)
    for name, force in by_hand.items():
        u = static_displacement(system, nodal_load(assembly, {"tower_top": force}))
        for a, b in zip(found.each[name].members, frame_use(assembly, u).members, strict=True):
            assert a.utilisation == pytest.approx(b.utilisation, rel=1e-9)
            assert a.case == name
    worst = {name: [one.utilisation for one in use.members] for name, use in found.each.items()}
    for k, one in enumerate(found.envelope.members):
        assert one.utilisation == max(uses[k] for uses in worst.values()) == worst[one.case][k]


def test_water_pressure_has_its_own_factor(tmp_path: Path) -> None:
    structure = read_structure("jacket15")
    system = build_system(assemble(structure), clamped(structure))
    actions = {"permanent": {"weight": False, "still_water": True}}
    hoop = {}
    for name, factors in {
        "own": {"permanent": 1.1},
        "said": {"permanent": 1.1, "water_pressure": 1.3},
        "none": {"permanent": 0.0, "water_pressure": 1.0},
    }.items():
        path = written(tmp_path, actions, [{"name": name, **factors}])
        use = combined_uses(read_combinations(path), DesignBasis(), system).envelope
        hoop[name] = max(one.by_check.get("hoop", 0.0) for one in use.members)
    # the hoop check is linear in the pressure, 13.2.6.2
    assert hoop["own"] == pytest.approx(1.1 * hoop["none"])
    assert hoop["said"] == pytest.approx(1.3 * hoop["none"])


def test_a_scenario_with_factors_of_one_is_the_scenario(tmp_path: Path) -> None:
    scenario = tmp_path / "storm.yaml"
    scenario.write_text(
        "structure: jacket15\nsupport: clamped\nwind: {speed_m_s: 20, seed: 3}\nrotor: {state: parked}\n"
        "time: {duration_s: 20, step_s: 0.1, discard_s: 5}\n"
    )
    plain = scenario_uses(read_scenario(scenario))
    actions = {"environmental": {"gust": {"scenario": "storm.yaml"}}}
    factors = {"unfactored": (1.0, 1.0), "weight alone": (1.0, 1e-9), "twice": (2.0, 2.0)}
    combinations = [{"name": name, "permanent": g, "environmental": e} for name, (g, e) in factors.items()]
    found = combined_uses(
        read_combinations(written(tmp_path, actions, combinations)), DesignBasis(), None
    ).each
    for a, b in zip(found["unfactored, gust"].members, plain.members, strict=True):
        assert a.utilisation == pytest.approx(b.utilisation, rel=1e-9)
    first = plain.members[0].by_check
    twice = found["twice, gust"].members[0].by_check
    # strengths that are linear in the forces
    for check in ("tension", "bending", "shear", "compression"):
        assert twice[check] == pytest.approx(2.0 * first[check], rel=1e-9)
    assert found["weight alone, gust"].members[0].by_check["bending"] < first["bending"]


@pytest.mark.parametrize(
    ("actions", "combinations", "message"),
    [
        (ACTIONS, [], "combinations"),
        (ACTIONS, [{"name": "a", "permanent": 1.0, "of": ["DLC 9"], "environmental": 1.0}], "no such"),
        (ACTIONS, [{"name": "a", "permanent": 1.0, "of": [], "environmental": 1.0}], "no such"),
        (ACTIONS, [{"name": "a", "permanent": 1.0}] * 2, "two of one name"),
        (ACTIONS, [{"name": "a", "permanent": -1.0}], "permanent"),
        (ACTIONS, [{"name": "a", "permanent": 1.0, "enviromental": 1.0}], "enviromental"),
        ({}, [{"name": "a", "permanent": 1.0, "environmental": 1.0}], "no environmental action"),
        ({"environmental": {"x": {}}}, [{"name": "a", "permanent": 1.0}], "exactly one"),
        ({"variable": {"forces": {"top": [1.0]}}}, [{"name": "a", "permanent": 1.0}], "forces"),
    ],
)
def test_wrong_files_are_refused(tmp_path: Path, actions, combinations, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_combinations(written(tmp_path, actions, combinations))


def test_the_command_shows_the_envelope_and_refuses_what_does_not_belong(tmp_path: Path) -> None:
    path = str(written(tmp_path))

    def run(*arguments: str):
        return CliRunner().invoke(main, ["check", *arguments])

    arguments = ["jacket15", "--support", "clamped", "--combinations", path]
    found = json.loads(run(*arguments, "--sheet", "leg_1_bay_1", "--json").stdout)
    # the sheet is of the worst combination
    leg = next(row for row in found["members"] if row["member"] == "leg_1_bay_1")
    lines = {line["symbol"]: line["value"] for line in found["sheet"]}
    assert lines[f"U {leg['check']}"] == pytest.approx(leg["utilisation"])
    assert {row["combination"] for row in found["combinations"]} >= {"still", "extreme, DLC 6.1, 0°"}
    assert found["members"][0]["combination"] in {row["combination"] for row in found["combinations"]}
    assert not any("partial action factors" in one["what"] for one in found["left_out"])
    # the tower's walls are beyond clause 13: they are no combination's headline
    assert all("tower" not in (row["member"] or "") for row in found["combinations"])
    for arguments, message in (
        (["--combinations", path], "need a structure"),
        (["jacket15", "--combinations", path, "--force", "tower_top=1,0,0"], "not combined"),
        (["jacket15", "--combinations", path, "--scenario", "parked"], "not combined"),
        (["jacket15", "--combinations", str(tmp_path / "none.yaml")], "none.yaml"),
    ):
        refused = run(*arguments)
        assert refused.exit_code == 2, refused.output
        assert message in refused.stderr


def test_piles_are_checked_in_every_combination_at_rest(tmp_path: Path) -> None:
    """Each pile's row is its worst combination's: the forces on the heads are the factored actions'."""
    actions = {
        "permanent": {"weight": False, "forces": {"tower_top": [0.0, 0.0, -1e7]}},
        "environmental": {"push": {"forces": {"tower_top": [2e6, 0.0, 0.0]}}},
    }
    combinations = [
        {"name": "still", "permanent": 1.0},
        {"name": "extreme", "permanent": 1.1, "environmental": 1.35},
    ]
    path = str(written(tmp_path, actions, combinations))
    arguments = ["check", "jacket15", "--support", "jacket15", "--combinations", path, "--json"]
    found = json.loads(CliRunner().invoke(main, arguments).stdout)
    piles = found["piles"]
    assert {row["combination"] for row in piles} == {"extreme, push"}
    assert sum(row["head_force"]["z_n"] for row in piles) == pytest.approx(-1.1e7, rel=1e-6)
    assert sum(row["head_force"]["x_n"] for row in piles) == pytest.approx(2.7e6, rel=1e-6)
    assert not any("--support FOUNDATION" in one["what"] for one in found["left_out"])
