"""``jackettwin identify``: JSON on stdout, files where asked, one clear message for bad input."""

from __future__ import annotations

import importlib
import json
import re
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.cli.identify_tables import _print_findings, _print_methods, _print_quality, show_one
from jackettwin.findings import Finding
from jackettwin.records import read_record, write_record

RECORDS = Path(str(files("jackettwin") / "data" / "records"))


def run(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, ["identify", *arguments])
    return result.exit_code, result.stdout, result.stderr


def test_one_record_as_json() -> None:
    code, out, _ = run(str(RECORDS / "pile_U12_s301.parquet"), "--json")
    document = json.loads(out)
    assert code == 0
    assert document["records"] == ["pile_U12_s301"]
    assert set(document["modes"][0]["mode_shape"]) == {
        f"acc_{place}_{axis}" for place in ("top", "g77", "g41", "tp") for axis in "xy"
    }
    assert all(set(r) == {"frequency_hz", "damping_ratio", "reason", "status"} for r in document["rejected"])


def test_another_method_prints_a_table_and_few_lines() -> None:
    code, out, err = run(str(RECORDS / "pile_U12_s301.parquet"), "--method", "plscf")
    assert code == 0
    assert "plscf: modes are not checked" in err
    assert "unchecked" in out
    assert "0.17" in out
    # rejected candidates are counted by reason, not listed
    rejected = [line for line in out.splitlines() if line.startswith("rejected")]
    assert 0 < len(rejected) < 5
    assert any(re.search(r"in 1 to \d+ model orders, \d+ needed", line) for line in rejected)


def test_two_records_are_fused_and_kept(tmp_path: Path) -> None:
    paths = [str(RECORDS / f"{name}.parquet") for name in ("pile_U12_s301", "pile_U12_s308")]
    code, out, _ = run(*paths, "--out", str(tmp_path / "day"), "--json")
    assert code == 0
    document = json.loads(out)
    assert document["groups"][0]["wind_speed_m_s"] == [11.0, 13.0]
    assert document["modes"][0]["records_with_mode"] == 2
    assert sorted(p.name for p in (tmp_path / "day").iterdir()) == [
        "modes.csv", "modes.json", "modes.nc", "picks.json", "records",
    ]  # fmt: skip
    assert len(list((tmp_path / "day" / "records").iterdir())) == 2
    code, out, _ = run(*paths, "--out", str(tmp_path / "day"))
    assert code == 0
    assert "2 records fused" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["gone.parquet"], "no such file"),
        (["gone.parquet", "--out", "m.xlsx"], "cannot export to this format"),
        (["gone.parquet", "--method", "fft"], "Invalid value for '--method'"),
        (["gone.parquet", "gone2.parquet"], "no such file"),
    ],
)
def test_bad_input_is_one_message(arguments: list[str], message: str) -> None:
    code, out, err = run(*arguments)
    assert code == 2
    assert out == ""
    assert message in err


def test_picks_of_a_result_replay(tmp_path: Path) -> None:
    record, out = str(RECORDS / "pile_U12_s301.parquet"), tmp_path / "day"
    (tmp_path / "quick.yaml").write_text("{refine: false, blocks: 0}")
    settings = ("--settings", str(tmp_path / "quick.yaml"))
    _, first, _ = run(record, *settings, "--out", str(out), "--json")
    for file in ("modes.json", "picks.json"):
        code, again, _ = run(record, *settings, "--picks", str(out / file), "--json")
        assert code == 0
        assert json.loads(again)["modes"] == json.loads(first)["modes"]
    (tmp_path / "mine.yaml").write_text("picks: [{frequency_hz: 9.0}]")
    code, _, err = run(record, *settings, "--picks", str(tmp_path / "mine.yaml"))
    assert code == 2
    assert "no pole near the pick" in err


def test_methods_side_by_side(tmp_path: Path) -> None:
    record = str(RECORDS / "pile_U12_s301.parquet")
    (tmp_path / "quick.yaml").write_text("{refine: false}")
    settings = ("--settings", str(tmp_path / "quick.yaml"))
    code, out, _ = run(record, *settings, "--compare", "--json")
    assert code == 0
    document = json.loads(out)
    methods = document["methods"]["modes"]
    assert list(methods) == ["ssi-cov", "ssi-dat", "plscf", "efdd", "bayoma"]
    assert all(len(modes) == len(document["modes"]) for modes in methods.values())
    code, _, err = run(record, record, "--compare")
    assert code == 2
    assert "--compare: takes one record" in err


def test_findings_of_many_records_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    def record(*findings: tuple[str | None, str, str]) -> dict[str, object]:
        keys = ("subject", "code", "text")
        return {"quality": {"findings": [dict(zip(keys, f, strict=True)) for f in findings]}}

    left = (None, "file", "vectors of another length are left out: wind (6)")
    unit = ("acc_20_y", "unit", "it is 9.81 times too small")
    _print_findings([record(left, unit), record(unit), record()], 3)
    assert capsys.readouterr().out.splitlines() == [
        "quality: acc_20_y, 2 of 3 records: it is 9.81 times too small",
        "quality: record, 1 of 3 records: vectors of another length are left out: wind (6)",
    ]


def test_a_fault_of_the_whole_record_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    """The resolution of every channel was said for it, as a warning, and as the doubt of every mode."""
    found = [Finding("coarse_quantiser", name, {"steps": steps}) for name, steps in (("a", 1.4), ("b", 2.1))]
    mode = dict.fromkeys(("frequency_interval_90", "damping_ratio_interval_90", "damping_ratio"))
    mode |= {"frequency_hz": 0.32, "mpc": 1.0, "status": "doubtful", "status_reason": found[0].text}
    show_one(
        {
            **dict.fromkeys(("modes", "real_poles", "rejected", "notes"), ()),
            "records": ["r"],
            "modes": [mode],
            "warnings": [f"{f.subject}: {f.text}" for f in found],
            "findings": [f.document for f in found],
            "quality": {"findings": [f.document for f in found]},
        }
    )
    said = capsys.readouterr().out
    assert said.count("the resolution is") == 1
    assert "quality: a, b: the resolution is 1.4 to 2.1 times its rms" in said
    assert "0.3200 Hz is doubtful: the record's quality, below" in said


def test_words_that_cannot_be_read_are_refused_in_json_too() -> None:
    """Those of a command, whatever stands before --json, and a command that does not exist."""
    for words in (("--min-share", "much", "--json"), ("--json",), ("--json", "--no-such-option")):
        code, text, err = run(*words)
        error = json.loads(text)["error"]
        assert code == 2 and error["problem"] == error["message"] in err
    assert run("--no-such-option")[1] == ""


def test_a_report_under_another_name_than_that_of_a_page_is_refused(tmp_path: Path) -> None:
    page = tmp_path / "modes.txt"
    code, _, err = run(str(RECORDS / "pile_U12_s301.parquet"), "--report", str(page))
    assert code == 2 and "'modes.txt' is not the name of a page" in err and not page.exists()


def test_modes_are_laid_beside_a_structure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The record is read once, though shapes in UFF need its directions before the computation."""
    # what tells long files apart has its own: whether it is imported already depends on the tests before
    long_records = importlib.import_module("jackettwin.study.many_records.long_records")
    assert long_records.read_record_pieces is not None
    monkeypatch.setattr("jackettwin.records.read_record_pieces", None)
    record, out = str(RECORDS / "kv_U12_s311.parquet"), tmp_path / "m.uff"
    code, text, _ = run(record, "--quick", "--model", "jacket15", "--json", "--out", str(out))
    assert code == 0 and out.read_text("ascii").count("\n    55\n") == len(json.loads(text)["modes"])
    best = {pair["label"] for pair in json.loads(text)["model"]["pairs"] if pair["mac"] > 0.95}
    assert {"side_side_1", "fore_aft_1"} <= best
    code, _, message = run(record, "--quick", "--model", "no_such_structure")
    assert code == 2 and "no_such_structure" in message


def without_directions(folder: Path) -> Path:
    """Return a record whose channels do not say where they point."""
    record = read_record(RECORDS / "kv_U12_s311.parquet")
    bare = tuple(
        replace(channel, name=f"a{i}", direction=(0.0, 0.0, 0.0)) for i, channel in enumerate(record.channels)
    )
    write_record(replace(record, channels=bare), folder / "bare.parquet")
    return folder / "bare.parquet"


def test_shapes_without_directions_are_refused_before_the_computation(tmp_path: Path) -> None:
    record, out = without_directions(tmp_path), tmp_path / "m.uff"
    code, text, err = run(str(record), "--band", "90,91", "--json", "--out", str(out))
    assert code == 2 and "shapes in UFF need channels" in err
    assert "shapes in UFF need channels" in json.loads(text)["error"]["problem"]
    assert not out.exists()


def test_what_cannot_be_written_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Directions may be found wanting after the computation, whose result was lost with them."""
    record, out = without_directions(tmp_path), tmp_path / "m.uff"
    monkeypatch.setattr("jackettwin.cli.identify._refuse_shapes", lambda *_: None)
    code, text, err = run(str(record), "--quick", "--json", "--out", str(out))
    assert code == 2 and "shapes in UFF need channels" in err
    assert json.loads(text)["modes"] and not out.exists()


def test_a_table_gives_95_percent_intervals_of_frequency_and_damping() -> None:
    """One standard deviation of the frequency stood beside an interval of 95 % (90 % now) of the damping."""
    code, out, _ = run(str(RECORDS / "pile_U12_s301.parquet"))
    _, text, _ = run(str(RECORDS / "pile_U12_s301.parquet"), "--json")
    low, high = json.loads(text)["modes"][0]["frequency_interval_90"]
    assert code == 0 and f"{low:.4f} – {high:.4f}" in out
    assert "90 % of f [Hz]" in out and "90 % of ζ [%]" in out and "±" not in out


def test_setups_are_joined_before_the_identification(tmp_path: Path) -> None:
    whole = str(RECORDS / "pile_U12_s301.parquet")
    other = str(RECORDS / "pile_U12_s308.parquet")
    code, out, err = run(whole, other, "--merge", "preger", "--json")
    assert code == 0, err
    document = json.loads(out)
    assert document["merge"] == "preger"
    assert document["records"] == ["pile_U12_s301", "pile_U12_s308"]
    assert document["modes"][0]["method"] == "preger"
    assert document["modes"][0]["frequency_std_hz"] is None
    assert min(abs(mode["frequency_hz"] - 0.174) for mode in document["modes"]) < 0.004
    for arguments in ((whole,), (whole, other, "--compare"), (whole, other, "--method", "plscf")):
        code, _, err = run(*arguments, "--merge", "preger")
        assert code == 2
        assert "Traceback" not in err


def test_what_several_setups_say_names_them_once(capsys: pytest.CaptureFixture[str]) -> None:
    """It stood as "record, record", and the numbers of names as ranges: "acc_30 to 60m"."""
    told = {"code": "file", "subject": None}
    first, second = (f"read from the channel names: {m} m (acc_{m}m)" for m in (60, 30))
    _print_quality([
        {**told, "record": "a", "text": first},
        {**told, "record": "a", "text": first},
        {**told, "record": "b", "text": second},
        {"code": "gaps", "subject": "acc_x", "text": "1.00% missing"},
        {"code": "gaps", "subject": "acc_y", "text": "2.00% missing"},
    ])  # fmt: skip
    assert capsys.readouterr().out.splitlines() == [
        f"quality: a: {first}",
        f"quality: b: {second}",
        "quality: acc_x, acc_y: 1.00 to 2.00% missing",
    ]


def test_a_method_that_does_not_know_a_damping_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    mode = {"frequency_hz": 0.3159, "damping_ratio": None}
    _print_methods(
        {"modes": [mode], "methods": {"modes": {"ssi-cov": [mode], "efdd": [None]}, "refused": {}}}
    )
    assert "0.3159 / unknown" in capsys.readouterr().out
