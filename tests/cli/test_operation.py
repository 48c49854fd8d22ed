"""``jackettwin operation``: the rotor at work, by wind."""

import json
from pathlib import Path

import pytest
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
