"""``jackettwin check``: statics and refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.checks.iso19902 import Tube
from jackettwin.checks.iso19902_pressure import hoop_strength
from jackettwin.cli import main
from jackettwin.decks import read_structure


def run(*arguments: str):
    return CliRunner().invoke(main, ["check", *arguments])


def test_thrust_uses_the_tower_s_foot_most() -> None:
    """Linear in the load once the weight is left out."""
    worst = []
    for thrust in (1e6, 2e6):
        found = json.loads(
            run("jacket15", "--force", f"tower_top={thrust},0,0", "--no-weight", "--json").stdout
        )
        rows = {row["member"]: row for row in found["members"]}
        worst.append(rows["tower_1"]["by_check"]["bending"])
        assert rows["tower_1"]["utilisation"] > rows["tower_12"]["utilisation"]
        assert found["members"][0]["clause"].startswith("axial")
    assert worst[1] == pytest.approx(2.0 * worst[0], rel=1e-9)


def test_forces_and_lengths_are_shown() -> None:
    """jacket15's tower is a cantilever of 116 m; its top carries the thrust across and no more."""
    arguments = ("jacket15", "--force", "tower_top=1e6,0,0", "--no-weight")
    rows = {row["member"]: row for row in json.loads(run(*arguments, "--json").stdout)["members"]}
    tower = rows["tower_12"]
    assert (tower["effective_length_factor"], tower["column_length_m"]) == (2.0, pytest.approx(116.0))
    assert tower["end"]["shear_z_n"] == pytest.approx(1e6, rel=1e-6)
    assert abs(tower["end"]["bending_y_nm"]) < 1.0  # of some 1e8 at the foot
    text = run(*arguments).stdout
    assert "K" in text
    # the tower's walls are beyond the standard's range: it is in the warnings, and no headline
    assert not tower["covered"]
    assert "tower_12" not in text
    assert "beyond ISO 19902 13.1: tower_1 (D/t = " in text
    assert "kN·m" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--force", "tower_top"], "not NODE=FX,FY,FZ"),
        (["--force", "tower_tip=1,2,3"], "no such node"),
        (["--force", "tower_top=1,2"], "3 or 6 numbers"),
        (["--support", "kelvin-voigt:k=0,c=1e6"], "cannot stand on its support"),
    ],
)
def test_bad_input_exits_2(arguments: list[str], message: str) -> None:
    result = run("jacket15", *arguments)
    assert result.exit_code == 2, result.stderr
    assert message in result.stderr.replace("\n", " ")


def test_water_presses_what_is_not_flooded() -> None:
    """The lowest leg, D/t from the file: U = 1.25·pD/2t/f_h; flooded it has none, and buoyancy lifts it."""
    rows = []
    for flooded in ((), ("--flooded", "jacket")):
        found = json.loads(run("jacket15", "--still-water", *flooded, "--json").stdout)
        rows.append({row["member"]: row for row in found["members"]}["leg_1_bay_1"])
    dry, wet = rows
    section = next(m for m in read_structure("jacket15").members if m.name == "leg_1_bay_1").section_start
    D, t, L = section.outer_diameter_m, section.thickness_m, dry["column_length_m"]
    depth = read_structure("jacket15").sea_level_z_m
    tube = Tube(*(np.array(v) for v in (D, t, 210e9, 355e6, L)))
    f_h = float(hoop_strength(tube, np.array(L)).f_h)
    wanted = 1.25 * 1025.0 * 9.80665 * depth * D / (2.0 * t) / f_h
    assert dry["by_check"]["hoop"] == pytest.approx(wanted, rel=2e-3)
    assert "hoop" not in wet["by_check"]
    assert dry["by_check"]["compression"] < wet["by_check"]["compression"]


def test_joints_are_listed() -> None:
    """Weakest kinds use no joint less; the terminal and --json name them."""
    uses = []
    for how in ("load-path", "conservative"):
        found = json.loads(run("jacket15", "--joints", how, "--json").stdout)
        uses.append({(row["node"], row["brace"]): row["utilisation"] for row in found["joints"]})
        assert sum(found["joints"][0]["shares"].values()) == pytest.approx(1.0)
    path, weakest = uses
    assert path.keys() == weakest.keys() and len(path) > 50
    assert all(weakest[key] >= 0.999 * path[key] for key in path)
    text = run("jacket15").stdout
    assert "tubular joints, ISO 19902 14.3" in text


def test_water_is_asked_for_once() -> None:
    result = run("jacket15", "--flooded", "jacket")
    assert result.exit_code == 2 and "needs --still-water" in result.stderr.replace("\n", " ")
    result = run("--scenario", "parked", "--still-water")
    assert result.exit_code == 2 and "own water" in result.stderr.replace("\n", " ")


def test_decks_without_tubes_are_drawn_but_not_checked(tmp_path: Path) -> None:
    """A post of arbitrary sections (MType 4): no code checks it, `view` and `stages` take it as it is."""
    deck = tmp_path / "post.dat"
    deck.write_text(
        "1 FEMMod\n2 NDiv\n"
        "2 NJoints\nJointID JointXss JointYss JointZss JointType\n(-)\n1 0 0 0 1\n2 0 0 30 1\n"
        "1 NReact\nRJointID RctTDXss RctTDYss RctTDZss RctRDXss RctRDYss RctRDZss\n(-)\n1 1 1 1 1 1 1\n"
        "1 NInterf\nIJointID ItfTDXss ItfTDYss ItfTDZss ItfRDXss ItfRDYss ItfRDZss\n(-)\n2 1 1 1 1 1 1\n"
        "1 NMembers\nMemberID MJointID1 MJointID2 MPropSetID1 MPropSetID2 MType\n(-)\n1 1 2 1 1 4\n"
        "1 NXPropSets\nPropSetID YoungE ShearG MatDens XsecA XsecAsx XsecAsy XsecJxx XsecJyy XsecJ0\n(-)\n"
        "1 2.1e11 8.1e10 7850 0.3 0.15 0.15 0.14 0.14 0.28\n---- END\n"
    )
    result = CliRunner().invoke(main, ["check", str(deck)])
    assert result.exit_code == 2
    assert "no member is a tube" in result.stderr
    page = tmp_path / "page.html"
    assert CliRunner().invoke(main, ["view", str(deck), "--out", str(page)]).exit_code == 0
    assert page.exists()
    result = CliRunner().invoke(main, ["stages", str(deck)])
    assert result.exit_code == 0 and "whole structure" in result.stdout


def test_vortices_are_screened_where_a_flow_is_given() -> None:
    """EN 1991-1-4 E.1.2(2) of the tower at 0.183 Hz; what is not asked for is in left_out."""
    found = json.loads(run("jacket15", "--wind", "30", "--json").stdout)
    tower = next(row for row in found["vortices"] if row["member"] == "tower_12")
    assert tower["reduced_velocity"] == pytest.approx(30.0 / (tower["frequency_hz"] * tower["diameter_m"]))
    assert tower["onset_m_s"] == pytest.approx(tower["frequency_hz"] * tower["diameter_m"] / 0.18 / 1.25)
    assert (tower["excites"], tower["clause"]) == ("across", "EN 1991-1-4 E.1.2(2)")
    assert any("excite" in text for text in found["warnings"])
    assert any("--current" in one["what"] for one in found["left_out"])
    assert any("earthquakes" in one["what"] for one in found["left_out"])
    assert json.loads(run("jacket15", "--json").stdout)["vortices"] == []
    assert run("jacket15", "--wind", "-1").exit_code == 2
    refused = run("--scenario", "parked", "--current", "1")
    assert refused.exit_code == 2
    assert "name the structure" in refused.stderr


def test_piles_are_checked_and_carry_what_stands_on_them() -> None:
    """The forces of the heads balance the thrust; without it the weight is the same."""
    found = json.loads(
        run("jacket15", "--support", "jacket15", "--force", "tower_top=3e6,0,0", "--json").stdout
    )
    heads = [row["head_force"] for row in found["piles"]]
    assert sum(head["x_n"] for head in heads) == pytest.approx(3e6, rel=1e-6)
    assert sum(head["y_n"] for head in heads) == pytest.approx(0.0, abs=1.0)
    unused = json.loads(run("jacket15", "--support", "jacket15", "--json").stdout)["piles"]
    weight = [sum(row["head_force"]["z_n"] for row in rows) for rows in (found["piles"], unused)]
    assert weight[0] == pytest.approx(weight[1], rel=1e-6)
    worst = found["piles"][0]
    assert worst["axial_utilisation"] == pytest.approx(
        1.25 * -worst["head_force"]["z_n"] / worst["capacity_compression_n"]
    )
    assert all(row["stands"] and 0.0 < row["lateral_utilisation"] < 1.0 for row in found["piles"])
    assert any("group effects" in one["what"] for one in found["left_out"])


def test_piles_that_the_ground_does_not_carry_are_said() -> None:
    found = json.loads(
        run("jacket15", "--support", "jacket15", "--force", "tower_top=0,0,2e9", "--json").stdout
    )
    assert not any(row["stands"] for row in found["piles"])
    assert found["piles"][0]["steel_utilisation"] is None
    assert any("cannot carry the piles" in text for text in found["warnings"])
    assert "piles, ISO 19902 17" in run("jacket15", "--support", "jacket15", "--no-weight").stdout


def test_piles_need_a_foundation_of_layers() -> None:
    found = json.loads(run("jacket15", "--json").stdout)
    assert found["piles"] == []
    assert any("--support FOUNDATION" in one["what"] for one in found["left_out"])


def test_the_calculation_of_a_member_is_shown() -> None:
    found = json.loads(run("jacket15", "--sheet", "leg_1_bay_1", "--json").stdout)
    use = next(row for row in found["members"] if row["member"] == "leg_1_bay_1")
    lines = {line["symbol"]: line for line in found["sheet"]}
    assert lines[f"U {use['check']}"]["value"] == pytest.approx(use["utilisation"])
    assert lines["f_c"]["clause"].startswith("13.2.3")
    assert "calculation, ISO 19902" in run("jacket15", "--sheet", "leg_1_bay_1").stdout
    worst = found["joints"][0]
    name = f"{worst['node']}:{worst['brace']}"
    sheet = json.loads(run("jacket15", "--sheet", name, "--json").stdout)["sheet"]
    assert sheet[-1]["symbol"] == "U joint"
    assert sheet[-1]["value"] == pytest.approx(worst["utilisation"])
    refused = run("jacket15", "--sheet", "leg_1_bay_9")
    assert refused.exit_code == 2
    assert "leg_1_bay" in refused.stderr
