"""Speed and pitch by wind from a table."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.turbine_files import read_rotor
from jackettwin.loads.operation.bem import operating_point
from jackettwin.loads.operation.schedule import read_schedule

HEAD = "wind_speed_m_s,rotor_speed_rpm,pitch_deg\n"


def test_the_table_is_followed(tmp_path: Path) -> None:
    path = tmp_path / "schedule.csv"
    path.write_text(HEAD + "5,5,0\n10,7,2\n")
    rotor, control = read_rotor("iea15")
    at = operating_point(rotor, replace(control, schedule=read_schedule(path)), 7.5)
    assert at.rotor_speed == pytest.approx(6.0 * np.pi / 30.0)
    assert np.degrees(at.pitch) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("wind,rpm\n5,5\n", "no schedule"),
        (HEAD, "no schedule"),
        (HEAD + "5,5,zero\n", "no number"),
        (HEAD + "5,nan,0\n", "no number"),
        (HEAD + "5,5\n", "no number"),
        (HEAD + "10,5,0\n5,5,0\n", "out of range"),
        (HEAD + "5,0,0\n", "out of range"),
    ],
)
def test_wrong_tables_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "schedule.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_schedule(path)


def test_a_wind_beyond_the_table_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "schedule.csv"
    path.write_text(HEAD + "5,5,0\n10,7,2\n")
    with pytest.raises(InputError, match="does not reach"):
        read_schedule(path).at(12.0)
    with pytest.raises(InputError, match="cannot be read"):
        read_schedule(tmp_path / "none.csv")
