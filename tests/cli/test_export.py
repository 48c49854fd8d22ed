"""``jackettwin export``: a deck that the other commands read."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main


def test_a_deck_s_superelement_is_the_structure_s(tmp_path: Path) -> None:
    """The same static stiffness at the interface, whichever way the jacket came in."""
    deck, out = tmp_path / "deck.dat", str(tmp_path / "se.npz")
    run = CliRunner().invoke
    result = run(main, ["export", "jacket15", "--support", "jacket15", "--out", str(deck), "--json"])
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert len(found["files"]) == 2
    assert "no damping of the ground" in found["warnings"][0]
    assert any("tower and turbine" in one["what"] for one in found["left_out"])
    stiffness = []
    for arguments in (["jacket15", "--support", "jacket15"], [str(deck)]):
        result = run(main, ["superelement", *arguments, "--modes", "6", "--out", out, "--json"])
        assert result.exit_code == 0, result.stderr
        stiffness.append(json.loads(result.stdout)["interface_stiffness"][0][0])
    assert stiffness[0] == pytest.approx(stiffness[1], rel=1e-9)


def test_another_ending_is_refused(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["export", "jacket15", "--out", str(tmp_path / "deck.txt")])
    assert result.exit_code == 2
    assert "unknown format of a deck" in result.stderr
