"""``jackettwin run``: the files it leaves, the keys it prints, and what an interruption leaves: nothing."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin import report
from jackettwin.cli import main


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict]:
    folder = tmp_path_factory.mktemp("run") / "deep" / "out"
    result = CliRunner().invoke(main, ["run", "thesis_table_6_1", "--out", str(folder), "--json"])
    assert result.exit_code == 0, result.stderr
    return folder, json.loads(result.stdout)


def test_result_and_report_are_left_and_nothing_else(outcome: tuple[Path, dict]) -> None:
    folder, document = outcome
    assert {p.name for p in folder.iterdir()} == {"report.html", "result.json", "figures"}
    assert [p.name for p in folder.parent.iterdir()] == ["out"]
    assert document["report"] == str(folder / "report.html")
    assert json.loads((folder / "result.json").read_text()) == document


def test_the_keys_of_the_contract(outcome: tuple[Path, dict]) -> None:
    document = outcome[1]
    assert {"modes", "updates", "report"} <= set(document)
    assert [u["law"] for u in document["updates"]] == ["kelvin-voigt", "maxwell-3", "zener", "springpot"]
    for update in document["updates"]:
        assert {"law", "parameters", "modes", "solutions", "identifiability", "log_evidence"} <= set(update)
        for parameter in update["parameters"].values():
            assert {"value", "std", "interval_90"} <= set(parameter)
        for solution in update["solutions"]:
            assert {"parameters", "cost", "locked_damper"} <= set(solution)


def test_kelvin_voigt_meets_table_6_1(outcome: tuple[Path, dict]) -> None:
    """Errors no larger than the thesis's: 0.40 % on f, 0.67 % on ζ1."""
    update = outcome[1]["updates"][0]
    for mode in update["modes"]:
        if mode["measured_frequency_hz"] is not None:
            assert mode["frequency_hz"] == pytest.approx(mode["measured_frequency_hz"], rel=0.0040)
    first = update["modes"][0]
    assert first["damping_ratio"] == pytest.approx(first["measured_damping_ratio"], rel=0.0067)


def test_the_report_needs_nothing_from_elsewhere(outcome: tuple[Path, dict]) -> None:
    page = (outcome[0] / "report.html").read_text()
    assert "<script src=" not in page
    assert 'rel="stylesheet"' not in page


def test_a_second_run_replaces_its_own_files_and_keeps_others(outcome: tuple[Path, dict]) -> None:
    folder, _ = outcome
    (folder / "notes.txt").write_text("mine")
    assert CliRunner().invoke(main, ["run", "thesis_table_6_1", "--out", str(folder)]).exit_code == 0
    assert (folder / "notes.txt").read_text() == "mine"


def test_an_interruption_exits_130_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(result: object, folder: Path, **_: object) -> None:
        (folder / "report.html").write_text("half a rep")
        raise KeyboardInterrupt

    monkeypatch.setattr(report, "build_report", interrupted)
    result = CliRunner().invoke(main, ["run", "thesis_table_6_1", "--out", str(tmp_path / "out")])
    assert result.exit_code == 130
    assert list(tmp_path.iterdir()) == []
