"""``jackettwin stages`` beside the thesis, another structure and itself."""

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main

MAST = """
sections: {tube: {outer_diameter_m: 2.0, thickness_m: 0.04}}
nodes: {a: [0, 0, 0], b: [12, 0, 0], c: [0, 12, 0], d: [4, 4, 20], e: [4, 4, 50]}
members:
  - {nodes: [a, d], section: tube, part: jacket}
  - {nodes: [b, d], section: tube, part: jacket}
  - {nodes: [c, d], section: tube, part: jacket}
  - {nodes: [d, e], section: tube, part: tower}
reaction_nodes: [a, b, c]
"""


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


def test_against_a_deck_without_parts(tmp_path: Path) -> None:
    """A SubDyn deck names no parts: the whole is compared, and the rest is said not to be."""
    own, plain = tmp_path / "own.yaml", tmp_path / "plain.yaml"
    own.write_text(MAST)
    plain.write_text(re.sub(r", part: \w+", "", MAST))
    found = document(str(own), "--against", str(plain), "--number", "2")
    assert [row["relative_error"] for row in found["stages"][-1]["modes"]] == pytest.approx(
        [0.0] * 2, abs=1e-9
    )
    assert found["stages"][0]["modes"][0]["relative_error"] is None
    assert found["not_compared"] == ["jacket"]
    shown = CliRunner().invoke(main, ["stages", str(own), "--against", str(plain)]).stdout
    assert "not compared" in shown
    assert "whole structure: " in CliRunner().invoke(main, ["stages", str(plain)]).stdout


def test_the_table_is_for_people() -> None:
    result = CliRunner().invoke(main, ["stages", "jacket15", "--against", "rosap", "--number", "2"])
    assert "rosap f [Hz]" in result.stdout
    assert CliRunner().invoke(main, ["stages", "jacket15", "--against", "gone.yaml"]).exit_code == 2
