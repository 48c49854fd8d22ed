"""``jackettwin stages`` beside the thesis, another structure and itself."""

import json

import pytest
from click.testing import CliRunner

from jackettwin.cli import main


def document(*arguments: str) -> dict:
    result = CliRunner().invoke(main, ["stages", *arguments, "--json"])
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_against_the_thesis() -> None:
    """Table 5.4: 0.3 %; table 5.2 needs drawings; table 5.3 repeats it and is left out."""
    jacket, piece, full = document("jacket15", "--against", "thesis")["stages"]
    assert all(abs(row["relative_error"]) < 3e-3 for row in full["modes"])
    assert jacket["modes"][0]["reference_frequency_hz"] == 0.901
    assert piece["modes"][0]["reference_frequency_hz"] is None


def test_against_a_structure() -> None:
    for stage in document("jacket15", "--against", "jacket15", "--number", "2")["stages"]:
        assert [row["relative_error"] for row in stage["modes"]] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_the_table_is_for_people() -> None:
    result = CliRunner().invoke(main, ["stages", "jacket15", "--against", "rosap", "--number", "2"])
    assert "rosap f [Hz]" in result.stdout
    assert CliRunner().invoke(main, ["stages", "jacket15", "--against", "gone.yaml"]).exit_code == 2
