"""Sets: cases, seeds, resuming, the manifest."""

import json
from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.records import read_record
from jackettwin.simulate.batch import pending_cases, record_path, run_case, run_set
from jackettwin.simulate.scenario.files import scenario_from
from jackettwin.simulate.scenario.sets import read_set, shipped_sets

BASE = """
structure: jacket15
foundation: jacket15_records
wind: {speed_m_s: 5.0, turbulence: C}
time: {duration_s: 20, step_s: 0.05}
"""
SET = """
scenario: base.yaml
bins: [{speed_m_s: 8, hs_m: 1.0, tp_s: 6.0}, {speed_m_s: 12.5}]
misalignment_deg: [-30, 0]
seeds: 2
"""


@pytest.fixture
def set_file(tmp_path: Path) -> Path:
    (tmp_path / "base.yaml").write_text(BASE, encoding="utf-8")
    path = tmp_path / "set.yaml"
    path.write_text(SET, encoding="utf-8")
    return path


def test_every_bin_misalignment_and_seed_is_a_case(set_file: Path) -> None:
    cases = read_set(set_file).cases
    assert len(cases) == 2 * 2 * 2
    assert len({case.name for case in cases}) == 8 and len({case.key for case in cases}) == 8
    first = scenario_from(cases[0].data, cases[0].path)
    assert first.air is not None and first.sea is not None
    assert (first.air.wind.speed_m_s, first.air.wind.turbulence) == (8.0, "C")
    assert first.sea.direction == pytest.approx(-0.5235987755982988)
    assert "waves" not in cases[-1].data
    seeds = [case.data["wind"]["seed"] for case in cases]
    seas = [case.data["waves"]["seed"] for case in cases if "waves" in case.data]
    assert len({*seeds, *seas, *(case.data["sensor_seed"] for case in cases)}) == 8 + 4 + 8


def test_shipped_sets_read_and_their_first_cases_are_scenarios() -> None:
    assert {"demo", "dlc64"} <= set(shipped_sets())
    for name in shipped_sets():
        case = read_set(name).cases[0]
        assert scenario_from(case.data, case.path).clock.duration_s == 600.0
    assert len(read_set("dlc64").cases) == 17 * 3 * 6


def test_a_set_is_resumed(set_file: Path, tmp_path: Path) -> None:
    """What is finished stays; a record of another case or half a record is done again."""
    chosen, folder = read_set(set_file), tmp_path / "out"
    folder.mkdir()
    run_case(chosen.cases[0], folder)
    before = record_path(chosen.cases[0], folder).stat().st_mtime_ns
    record_path(chosen.cases[1], folder).write_bytes(b"half")
    assert [case.name for case in pending_cases(chosen, folder)] == [c.name for c in chosen.cases[1:]]
    seen: list[str] = []
    manifest = run_set(chosen, folder, workers=1, step=seen.append)
    assert seen == [case.name for case in chosen.cases[1:]]
    assert record_path(chosen.cases[0], folder).stat().st_mtime_ns == before
    assert pending_cases(chosen, folder) == ()
    assert json.loads((folder / "manifest.json").read_text()) == manifest
    entry = manifest["cases"][0]
    assert entry["conditions"]["mean_wind_speed_m_s"] == 8.0
    assert entry["true_modes"] == read_record(folder / entry["record"]).metadata["true_modes"]
    changed = set_file.parent / "base.yaml"
    changed.write_text(BASE.replace("duration_s: 20", "duration_s: 30"), encoding="utf-8")
    assert len(pending_cases(read_set(set_file), folder)) == 8


def test_two_processes_write_what_one_does(set_file: Path, tmp_path: Path) -> None:
    set_file.write_text(SET.replace("seeds: 2", "seeds: 1"), encoding="utf-8")
    chosen = read_set(set_file)
    run_set(chosen, tmp_path / "one", workers=1)
    run_set(chosen, tmp_path / "two", workers=2)
    for case in chosen.cases:
        a, b = (read_record(record_path(case, tmp_path / n)) for n in ("one", "two"))
        assert (a.data == b.data).all()


def test_bad_sets_are_refused(set_file: Path) -> None:
    for text, message in (
        (SET.replace("seeds", "sedes"), "sedes.*did you mean 'seeds'"),
        (SET.replace(", tp_s: 6.0", ""), "bins.0.*go together"),
        (SET.replace("base.yaml", "bse.yaml"), "bse.yaml"),
    ):
        set_file.write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=message):
            read_set(set_file)
