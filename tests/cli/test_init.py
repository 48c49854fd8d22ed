"""A twin file from a deck and a folder of files: what names say is taken, what nobody says is asked for."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.errors import InputError
from jackettwin.twin import read_twin


def written(path: Path, header: str, n: int = 400) -> Path:
    """Write a CSV of a clock without zone, at 10 Hz."""
    y = np.random.default_rng(1).normal(size=(n, header.count(",") + 1))
    rows = [
        f"2025-06-01 14:00:{k / 10:06.3f}," + ",".join(f"{v:.4f}" for v in row)
        for k, row in enumerate(y[: min(n, 590)])
    ]
    path.write_text(f"time,{header}\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def run(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, ["init", "jacket15", *arguments])
    return result.exit_code, result.stdout, result.stderr


def test_a_german_logger_becomes_a_twin_that_reads(tmp_path: Path) -> None:
    record = written(tmp_path / "A1.csv", "ACC_088m_E [g],ACC_088m_N [g],TT_FA [g],ACC_leg_a [g]")
    out = tmp_path / "twins" / "twin.yaml"
    code, text, _ = run(str(record), "--out", str(out), "--timezone", "Europe/Berlin", "--json")
    assert code == 0
    document = json.loads(text)
    assert document["complete"]
    assert [(s["height_m"], s["direction"], s["lacks"]) for s in document["sensors"][:2]] == [
        (88.0, [1.0, 0.0, 0.0], None),
        (88.0, [0.0, 1.0, 0.0], None),
    ]
    assert document["sensors"][2]["node"] is not None  # the tower's top has a node
    assert "height_m" in document["sensors"][3]["lacks"]
    config = read_twin(out)
    assert [sensor.channel for sensor in config.sensors] == ["ACC_088m_E", "ACC_088m_N", "TT_FA"]
    assert config.records[0].resolve() == record
    assert config.defaults.timezone == "Europe/Berlin"
    written_text = out.read_text()
    assert "from 2025-06-01T12:00:00Z" in written_text
    assert "# - {channel: ACC_leg_a" in written_text


def test_parts_that_names_speak_of_have_their_nodes(tmp_path: Path) -> None:
    record = written(tmp_path / "A1.csv", "TT_AX [g],TP_AX [g],TowerBottom_AY [g],TM_AX [g]")
    code, text, _ = run(str(record), "--out", str(tmp_path / "twin.yaml"), "--json")
    assert code == 0
    nodes = [(s["node"], bool(s["lacks"])) for s in json.loads(text)["sensors"]]
    assert nodes == [("tower_top", False), ("tp_top", False), ("tp_top", False), (None, True)]
    assert "tower is at 86 m" in json.loads(text)["sensors"][3]["lacks"]


def test_a_deck_that_ends_at_its_interface_has_no_tower_top(tmp_path: Path) -> None:
    """Its top sensors were put on the interface, and no measured mode was like any of the model's."""
    deck = tmp_path / "deck.dat"
    assert CliRunner().invoke(main, ["export", "jacket15", "--out", str(deck)]).exit_code == 0
    record = written(tmp_path / "A1.csv", "TT_AX [g],TP_AX [g]")
    arguments = ["init", str(deck), str(record), "--out", str(tmp_path / "twin.yaml"), "--json"]
    document = json.loads(CliRunner().invoke(main, arguments).stdout)
    assert [bool(s["lacks"]) for s in document["sensors"]] == [True, False]
    assert document["missing"][1].startswith("the tower: the structure ends at its interface, 28 m above")


def test_what_nobody_says_is_missing(tmp_path: Path) -> None:
    record = written(tmp_path / "A1.csv", "ACC_088m_E [g],ACC_400m_N [g]")
    code, text, _ = run(str(record), "--out", str(tmp_path / "twin.yaml"))
    assert code == 0
    assert "ACC_400m_N: 400 m, [0, 1, 0]: lacks a place on the structure" in text
    assert "missing: the clock does not say its zone" in text
    assert "conditions of the records" in text
    twin = tmp_path / "twin.yaml"
    assert f"complete the 1 sensors commented out in {twin}, then jackettwin run {twin}" in text


def test_what_lies_in_a_folder_and_is_no_record_is_left_out_and_said(tmp_path: Path) -> None:
    folder = tmp_path / "data"
    folder.mkdir()
    good = written(folder / "b.csv", "ACC_088m_E [g]")
    (folder / "a.csv").write_text("")
    (folder / "README.txt").write_text("Measured by Bob on turbine 7. Call 0800.\n")
    (folder / "._b.csv").write_bytes(b"\0\x05\x16\x07")
    out = tmp_path / "twin.yaml"
    code, answer, said = run(str(folder), "--out", str(out), "--json")
    assert code == 0
    assert [p.resolve() for p in read_twin(out).records] == [good]
    document = json.loads(answer)
    assert document["records"] == [str(good)]
    (why,) = [one["what"] for one in document["left_out"] if "a.csv" in one["what"]]
    assert "is empty" in why and f"# left out: {why}" in out.read_text()
    assert "a.csv: is empty" in said
    assert "README.txt" in said
    code, _, error = run(str(folder / "a.csv"), str(good), "--out", str(out), "--force")
    assert code == 2
    assert "a.csv: is empty; export the record again" in error


def test_units_come_by_option_or_are_refused(tmp_path: Path) -> None:
    record = written(tmp_path / "A1.csv", "ACC_088m_E,ACC_088m_N")
    out = tmp_path / "twin.yaml"
    code, _, error = run(str(record), "--out", str(out))
    assert code == 2
    assert "unit is missing" in error
    assert not out.exists()
    assert run(str(record), "--out", str(out), "--unit", "mg")[0] == 0
    assert "logger: {unit: mg}" in out.read_text()
    assert read_twin(out).defaults.unit == "mg"


def test_more_records_than_are_read_are_listed_all_the_same(tmp_path: Path) -> None:
    for i in range(22):
        written(tmp_path / f"r{i:02d}.csv", "ACC_088m_E [g]", n=100)
    out = tmp_path / "twin.yaml"
    assert run(str(tmp_path), "--out", str(out), "--timezone", "UTC")[0] == 0
    assert [path.name for path in read_twin(out).records] == [f"r{i:02d}.csv" for i in range(22)]


def test_the_draft_leaves_tolerances_open_and_asks_for_the_rotors_speeds(tmp_path: Path) -> None:
    """Without any a run calls a foundation known to a few per cent from a model that misses by as much."""
    record = written(tmp_path / "A1.csv", "ACC_088m_E [g]")
    out = tmp_path / "twin.yaml"
    text = run(str(record), "--out", str(out))[1]
    stated = read_twin(out).tolerances
    assert stated.std("rna_mass", 1.0) == 0.015 and stated.std("growth", 1.0) == 0.04
    assert stated.std("tower_stiffness", 0.015) == 0.015
    assert "missing: rotor_speed_rpm: [lowest, highest]" in text
    asked = out.read_text().replace("# rotor_speed_rpm", "rotor_speed_rpm").replace("  # priors", "  priors")
    out.write_text(asked)  # what stands there as a comment reads as it stands
    assert read_twin(out).rotor_speed_rpm == (5.0, 7.6)


def test_nothing_is_written_over(tmp_path: Path) -> None:
    record = written(tmp_path / "A1.csv", "ACC_088m_E [g],ACC_088m_N [g]")
    out = tmp_path / "twin.yaml"
    out.write_text("mine")
    code, _, error = run(str(record), "--out", str(out))
    assert (code, out.read_text()) == (2, "mine")
    assert "exists already" in error
    assert run(str(record), "--out", str(out), "--force")[0] == 0


@pytest.mark.parametrize("name", ["first: 1", "no", "Ä 1 [x]"])
def test_names_that_yaml_would_misread_are_quoted(tmp_path: Path, name: str) -> None:
    record = written(tmp_path / "A1.csv", f'"{name} 88m_x [g]",ACC_088m_N [g]')
    out = tmp_path / "twin.yaml"
    assert run(str(record), "--out", str(out))[0] == 0
    assert read_twin(out).sensors[0].channel == f"{name} 88m_x"


def test_heights_from_the_bed_and_a_forgotten_sea_level_are_asked_after(tmp_path: Path) -> None:
    """jacket15 stands in 72 m of water: 190 m above the bed are on its tower, above the sea they are not."""
    record = written(tmp_path / "A1.csv", "ACC_190m_E [g],ACC_120m_E [g]")
    code, text, _ = run(str(record), "--out", str(tmp_path / "twin.yaml"))
    assert code == 0
    assert "up to 190 m, may be measured from the sea bed" in text and "72 m less" in text
    source = Path(__file__).parents[2] / "examples" / "three_leg_jacket.yaml"
    dry = tmp_path / "dry.yaml"
    dry.write_text(source.read_text().replace("sea_level_z_m: 45.0", "sea_level_z_m: 0.0"))
    result = CliRunner().invoke(main, ["init", str(dry), str(record), "--out", str(tmp_path / "b.yaml")])
    assert "sea_level_z_m of the structure: its feet are at z = 0 m" in result.stdout
    dry.write_text(source.read_text().replace("sea_level_z_m: 45.0", "sea_level_z_m: 450.0"))
    result = CliRunner().invoke(main, ["init", str(dry), str(record), "--out", str(tmp_path / "c.yaml")])
    assert "below still water (sea_level_z_m: 450" in result.stdout


def test_a_structure_or_a_record_in_place_of_a_twin_is_told_how_one_is_made(tmp_path: Path) -> None:
    record = written(tmp_path / "A1.csv", "ACC_088m_E [g]")
    structure = Path(__file__).parents[2] / "examples" / "three_leg_jacket.yaml"
    modes = tmp_path / "consultant_modes.csv"
    modes.write_text("mode;f [Hz];std\n1;0,18;0,001\n2;0,8;0,01\n")
    told = ((record, "init STRUCTURE"), (structure, f"init {structure} RECORD…"), (modes, "targets: cons"))
    for given, said in told:
        with pytest.raises(InputError, match="not a twin") as refused:
            read_twin(given)
        assert said in str(refused.value)
