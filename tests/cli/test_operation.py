"""``jackettwin operation``: the rotor at work, by wind."""

import json
from importlib.resources import files
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from jackettwin.cli import main


def run(*arguments: str):
    return CliRunner().invoke(main, ["operation", *arguments])


def test_damping_thrust_and_passing_by_wind() -> None:
    found = json.loads(run("jacket15", "--support", "clamped", "--wind", "8,20", "--json").stdout)
    low, high = found["winds"]
    # thrust peaks at rated power; IEA 15 MW table: 1.42 MN at 8.4 m/s, 0.9 MN at 20 m/s
    assert low["thrust_n"] > high["thrust_n"]
    assert low["passing_hz"] == pytest.approx(3.0 * low["rotor_speed_rpm"] / 60.0)
    for row in (low, high):
        side, along = row["side_side"], row["fore_aft"]
        assert along["damping_ratio"] > 5.0 * side["damping_ratio"] > 0.0
        # undamped steel on clamped feet: the rotor is all there is
        assert along["damping_ratio"] == pytest.approx(along["rotor_damping_ratio"], rel=1e-3)
        least, most = along["rotor_damping_ratio_interval_90"]
        assert least < along["rotor_damping_ratio"] < most
        assert row["turbulent"]["whole"]["x_n"] > row["turbulent"]["passing"]["x_n"] > 0.0
    assert any("controller" in one["what"] for one in found["left_out"])


def test_a_schedule_is_followed_and_modes_near_the_passing_are_said(tmp_path: Path) -> None:
    path = tmp_path / "schedule.csv"
    path.write_text("wind_speed_m_s,rotor_speed_rpm,pitch_deg\n5,3.7,0\n30,3.7,20\n")
    arguments = ("jacket15", "--support", "clamped", "--turbulence", "none", "--wind", "28")
    found = json.loads(run(*arguments, "--schedule", str(path), "--json").stdout)
    (row,) = found["winds"]
    assert row["rotor_speed_rpm"] == pytest.approx(3.7)
    assert row["turbulent"] is None
    assert any("blades' passing" in text for text in found["warnings"])
    assert any("cut-out" in text for text in found["warnings"])
    shown = run(*arguments, "--schedule", str(path))
    assert "in operation" in shown.stdout


def test_a_file_without_blades_structure_has_rigid_ones_and_it_is_said(tmp_path: Path) -> None:
    data = yaml.safe_load(files("jackettwin").joinpath("data/rotors/iea15.yaml").read_text("utf-8"))
    del data["components"]["blade"]["elastic_properties_mb"]
    path = tmp_path / "bare.yaml"
    path.write_text(yaml.safe_dump(data))
    arguments = ("jacket15", "--support", "clamped", "--turbulence", "none", "--wind", "12", "--json")
    bare, whole = (json.loads(run(*arguments, "--rotor", name).stdout) for name in (str(path), "iea15"))
    assert any("rigid" in text for text in bare["warnings"])
    assert not any("rigid" in text for text in whole["warnings"])
    rigid, bent = (found["winds"][0]["fore_aft"] for found in (bare, whole))
    # 14.7 and 11.9 % on jacket15's feet (docs/verification/operation.md)
    assert rigid["damping_ratio"] > 1.15 * bent["damping_ratio"]
    assert bent["frequency_hz"] > 1.02 * rigid["frequency_hz"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--wind", "0"], "out of range"),
        (["--wind", "calm"], "not V,V"),
        (["--turbulence", "D"], "unknown turbulence class"),
        (["--turbulence", "7"], "out of range"),
        (["--rotor", "none.yaml"], "none.yaml"),
        (["--schedule", "none.csv"], "none.csv"),
    ],
)
def test_bad_input_exits_2(arguments: list[str], message: str) -> None:
    found = run("jacket15", "--support", "clamped", *arguments)
    assert found.exit_code == 2, found.output
    assert message in found.stderr
