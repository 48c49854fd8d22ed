"""``jackettwin verify``: keys, verdict, exit code and gallery."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.cli import verify as verify_module
from jackettwin.verify import Row

KEYS = {"id", "source", "quantity", "published", "computed", "relative_error", "tolerance", "ok"}
ROWS = (
    Row("a", "Table 1", "f [Hz]", published=1.0, computed=1.001, tolerance=0.002),
    Row("b", "Table 1", "mass [kg]", published=1.0, computed=1.3, tolerance=None, note="no drawings"),
)


def test_every_checked_row_holds_and_the_gallery_is_written(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["verify", "--out", str(tmp_path / "g"), "--json"])
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    rows = document["rows"]
    assert all(set(row) >= KEYS for row in rows)
    assert sum(row["ok"] is True for row in rows) >= 60
    assert all((row["ok"] is None) == (row["tolerance"] is None) for row in rows)
    page = Path(document["gallery"]).read_text()
    assert all(f"Figure {number}" in page for number in ("3.2", "5.4", "6.1", "7.1", "8.1", "8.2", "8.7"))


@pytest.fixture
def two_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verify_module, "published_rows", lambda step: ROWS)


@pytest.mark.usefixtures("two_rows")
def test_numbers_alone_write_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["verify", "--no-figures"])
    assert result.exit_code == 0
    assert "1 of 1 checked rows hold; 1 rows only inform" in result.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_failed_row_exits_1(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = replace(ROWS[0], computed=1.01)
    monkeypatch.setattr(verify_module, "published_rows", lambda step: (wrong,))
    result = CliRunner().invoke(main, ["verify", "--no-figures"])
    assert result.exit_code == 1
    assert "FAILED" in result.stdout
