"""Channels in m/s are velocities of the structure, however the unit is said; wind and water are not."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from jackettwin.records import FileDefaults, read_record

RATE_HZ = 20.0


def write(path: Path, names: str, *, mean: float = 0.0) -> Path:
    y = np.random.default_rng(1).standard_normal((400, 2)) + mean
    np.savetxt(path, y, delimiter=",", header=f"# sample_rate_hz: {RATE_HZ:g}\n{names}", comments="")
    return path


@pytest.mark.parametrize("said", ["header", "option", "json"])
def test_a_speed_is_a_velocity_however_its_unit_is_said(said: str, tmp_path: Path) -> None:
    names = "laser_1 [m/s],ref_y [m/s]" if said == "header" else "laser_1,ref_y"
    path = write(tmp_path / "r.csv", names)
    if said == "json":
        channels = {name: {"unit": "m/s"} for name in ("laser_1", "ref_y")}
        path.with_suffix(".json").write_text(json.dumps({"channels": channels}))
    record = read_record(path, FileDefaults(unit="m/s") if said == "option" else None)
    assert [(c.quantity, c.unit) for c in record.channels] == [("velocity", "m/s")] * 2


def test_a_speed_far_from_zero_is_none_of_the_structure(tmp_path: Path) -> None:
    record = read_record(write(tmp_path / "r.csv", "U_100 [m/s],laser [mm/s]", mean=9.0))
    assert [c.quantity for c in record.channels] == ["other", "other"]
    (remark, _) = [text for text in record.metadata["remarks"] if "times its deviation" in text]
    assert remark.startswith("U_100: a speed whose mean is")


def test_a_stated_velocity_stays_one(tmp_path: Path) -> None:
    path = write(tmp_path / "r.csv", "vel_1 [m/s],b", mean=9.0)
    path.with_suffix(".json").write_text(
        json.dumps({"channels": {"vel_1": {}, "b": {"unit": "m/s", "quantity": "velocity"}}})
    )
    assert [c.quantity for c in read_record(path).channels] == ["velocity", "velocity"]
