"""``jackettwin simulate`` and ``loads``: the contract's keys and refusals."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.decks import read_structure
from jackettwin.records import read_record

CASE = """
structure: jacket15
foundation: jacket15_records
waves: {type: airy, height_m: 6.0, period_s: 10.0}
wind: {speed_m_s: 9.0, seed: 1}
time: {duration_s: 30, step_s: 0.05}
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.yaml"
    path.write_text(CASE, encoding="utf-8")
    return path


def test_simulate_writes_a_record(case: Path) -> None:
    out = case.with_name("record")
    result = CliRunner().invoke(main, ["simulate", str(case), "--out", str(out), "--json"])
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert {"channels", "conditions", "seconds_simulated", "wall_s"} <= set(document)
    assert document["seconds_simulated"] == 30.0
    record = read_record(out.with_suffix(".parquet"))
    assert list(record.channel_names) == document["channels"]
    assert record.sample_rate_hz == pytest.approx(20.0)


def test_people_get_a_table(case: Path) -> None:
    result = CliRunner().invoke(main, ["simulate", str(case), "--out", str(case.with_name("r.parquet"))])
    assert result.exit_code == 0, result.stderr
    assert "acc_top_x" in result.stdout and "times real time" in result.stdout
    # truth reaches as far as the simulation does: 5 Hz, beyond the second pair of any jacket
    truth = read_record(case.with_name("r.parquet")).metadata["true_modes"]
    assert len(truth) > 12
    assert truth[-1]["frequency_hz"] > 4.0
    assert f"and {len(truth) - 12} more up to" in result.stdout


def test_loads_have_the_keys_of_the_contract(case: Path) -> None:
    result = CliRunner().invoke(main, ["loads", str(case), "--json"])
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    for key in ("force_n", "moment_msl_n_m"):
        assert set(document[key]) == {"x", "y", "z"}
        assert {"max", "min", "std"} <= set(document[key]["x"])
    shown = CliRunner().invoke(main, ["loads", str(case)]).stdout
    assert "case: water and wind; M about (0, 0, 72) m" in shown
    assert "water alone" in shown and "wind alone" in shown
    assert "Fx [MN]" in shown and "at the bed, z = -72 m: base shear" in shown and "over one wave" in shown
    first = document["phases"][0]
    assert first["wave_elevation_m"] == pytest.approx(3.0)
    # M about the bed is M about still water + 72 m × F
    assert first["moment_mudline_n_m"][1] == pytest.approx(
        first["moment_msl_n_m"][1] + 72.0 * first["force_n"][0]
    )
    at_bed = document["mudline"]["moment_n_m"]
    assert max(abs(at_bed["y"]["max"]), abs(at_bed["y"]["min"])) <= document["mudline"][
        "overturning_moment_n_m"
    ] * (1 + 1e-12)


def test_bad_scenarios_end_with_two(case: Path) -> None:
    case.write_text(CASE.replace("height_m", "hieght_m"), encoding="utf-8")
    for command in (["simulate", str(case), "--out", "x"], ["loads", str(case)]):
        result = CliRunner().invoke(main, command)
        assert result.exit_code == 2
        assert "waves.hieght_m" in result.stderr and "did you mean" in result.stderr
        assert "Traceback" not in result.stderr
    result = CliRunner().invoke(main, ["simulate", "--out", str(case.parent)])
    assert result.exit_code == 2 and "folder" in result.stderr


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("period_s: 10.0", "period_s: 0.01", "waves.period_s: .*greater than or equal to 0.5"),
        ("period_s: 10.0", "period_s: 10.0, hs_m: 2", "waves.hs_m: does not belong"),
        ("height_m: 6.0", "height_m: 90.0", "waves.height_m: out of range .got 90.0..*check the number"),
        ("speed_m_s: 9.0", "speed_m_s: .nan", "wind.speed_m_s: not a finite number"),
        ("step_s: 0.05", "step_s: 1.0e-9", "time.step_s: .*greater than or equal to 0.0001"),
        ("30, step_s: 0.05", "86400, step_s: 0.0001", "time.step_s: too many samples.*longer steps"),
        ("structure:", "water: {depth_m: 900}\nstructure:", "water.depth_m: the structure does not reach"),
        ("structure:", "water: {flooded: [nobody]}\nstructure:", "water.flooded: no such member or part"),
        (
            "structure:",
            "water: {marine_growth: [{top_z_m: -9, bottom_z_m: 0, thickness_m: 0.1}]}\nstructure:",
            "marine_growth.top_z_m: the top of growth must lie above its bottom",
        ),
        (
            "structure:",
            "sensors: [{channel: a, height_m: 500, direction: [1, 0, 0]}]\nstructure:",
            "sensors.a.height_m: height is not on the tower axis",
        ),
    ],
)
def test_bad_numbers_are_named(case: Path, old: str, new: str, said: str) -> None:
    """File, key, value and what to do: also for what shows only while it is simulated."""
    case.write_text(CASE.replace(old, new, 1), encoding="utf-8")
    result = CliRunner().invoke(main, ["simulate", str(case), "--out", str(case.with_name("r.parquet"))])
    assert result.exit_code == 2
    message = " ".join(result.stderr.split())
    assert "case.yaml" in message and "Traceback" not in message
    assert re.search(said, message), message
    assert not case.with_name("r.parquet").exists()


def test_motion_without_bound_is_a_matter_of_the_scenario(tmp_path: Path) -> None:
    """A river ten metres a second fast, tenfold drag and loads every second: no warning, no traceback."""
    path = tmp_path / "rough.yaml"
    path.write_text(
        "structure: jacket15\nsupport: pinned\nwater: {drag: 10}\ncurrent: {uniform_m_s: 10}\n"
        "waves: {type: airy, height_m: 6, period_s: 10, relative_velocity: full}\n"
        "time: {duration_s: 300, step_s: 0.5, load_step_s: 0.5}\n"
    )
    result = CliRunner().invoke(main, ["simulate", str(path), "--out", str(tmp_path / "r.parquet")])
    assert result.exit_code == 2
    message = " ".join(result.stderr.split())
    assert "rough.yaml: time.load_step_s: the motion grows without bound (got 0.5)" in message
    assert "halve it" in message and not (tmp_path / "r.parquet").exists()


def test_what_is_odd_of_an_asset_is_noted(tmp_path: Path) -> None:
    """A nacelle in tonnes, a pile longer than its layers, damping beyond the literature's."""
    path = tmp_path / "odd.yaml"
    path.write_text(
        "structure: jacket15\n"
        "rna: {mass_kg: 809}\n"
        "piles: {length_m: 50, outer_diameter_m: 2.8, thickness_m: 0.06}\n"
        "soil: {layers: [{thickness_m: 40, effective_weight_n_m3: 9e3, clay: {strength_pa: [20e3, 90e3]}}]}\n"
        "damping: {rayleigh: {ratio: 0.05, frequency_hz: 0.2}}\n"
        "time: {duration_s: 10, step_s: 0.05}\n"
    )
    out = str(tmp_path / "odd.parquet")
    result = CliRunner().invoke(main, ["simulate", str(path), "--out", out, "--json"])
    assert result.exit_code == 0, result.stderr
    notes = " | ".join(json.loads(result.stdout)["notes"])
    for said in ("is it in kg?", "the layers 40 m"):
        assert said in notes
    assert re.search(r"structure gives side_side_1 \d[.\d]* % damping, more than the 1 to 2 %", notes)
    assert "water gives" not in notes  # there is none
    assert "soil gives" not in notes  # nothing in it damps


def test_still_water_is_told_apart(case: Path) -> None:
    """Buoyancy is ρg times the volume of what is under water; conical members within 2 %."""
    document = json.loads(CliRunner().invoke(main, ["loads", str(case), "--json"]).stdout)
    still = document["still_water"]
    assert still["pressure_at_the_bed_pa"] == pytest.approx(1025.0 * 9.80665 * 72.0)
    volume = sum(
        0.25 * np.pi * m.section_start.outer_diameter_m**2 * length
        for m, length in wet_lengths(read_structure("jacket15"))
    )
    assert still["buoyancy_n"] == pytest.approx(1025.0 * 9.80665 * volume, rel=0.02)
    assert -72.0 < still["center_of_buoyancy_m"][2] < 0.0
    assert "still water, not in the loads above" in CliRunner().invoke(main, ["loads", str(case)]).stdout


def wet_lengths(structure):
    for m in structure.members:
        low, high = sorted(structure.nodes[n][2] - structure.sea_level_z_m for n in (m.start, m.end))
        length = np.linalg.norm(np.subtract(structure.nodes[m.end], structure.nodes[m.start]))
        share = 1.0 if high <= 0.0 else max(-low, 0.0) / max(high - low, 1e-9)
        yield m, share * length
