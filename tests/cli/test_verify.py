"""``jackettwin verify``: keys, verdict and exit code."""

from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.verify import Row

ROWS = (
    Row("a", "Table 1", "f [Hz]", published=1.0, computed=1.001, tolerance=0.002),
    Row("b", "Table 1", "mass [kg]", published=1.0, computed=1.3, tolerance=None, note="no drawings"),
)


@pytest.fixture
def two_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("jackettwin.verify.published_rows", lambda step: ROWS)


@pytest.mark.usefixtures("two_rows")
def test_nothing_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["verify"])
    assert result.exit_code == 0
    assert "1 of 1 checked rows hold; 1 rows are not checked" in result.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_failed_row_exits_1(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = replace(ROWS[0], computed=1.01)
    monkeypatch.setattr("jackettwin.verify.published_rows", lambda step: (wrong,))
    result = CliRunner().invoke(main, ["verify"])
    assert result.exit_code == 1
    assert "FAILED" in result.stdout


def test_benchmarks_of_others_show_misses_and_exit_0(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = (
        ROWS[0],
        replace(ROWS[0], id="c", computed=1.1, note="two digits", missed="another rotor"),
        ROWS[1],
    )
    monkeypatch.setattr("jackettwin.verify.benchmark_rows", lambda step: rows)
    result = CliRunner().invoke(main, ["verify", "--published"])
    assert result.exit_code == 0
    assert "misses: f [Hz], Table 1: another rotor" in result.stdout
    assert "1 of 2 checked rows hold, median error 5 %; 1 rows are not checked" in result.stdout
    monkeypatch.setattr("jackettwin.verify.benchmark_rows", lambda step: (replace(rows[1], missed=""),))
    assert CliRunner().invoke(main, ["verify", "--published", "--json"]).exit_code == 1
