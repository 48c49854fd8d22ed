"""Everything that a command leaves out is under ``left_out`` of its output, with the clause."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.cli.console import with_omissions
from jackettwin.cli.fatigue import fatigue_command
from jackettwin.cli.main import GROUPS
from jackettwin.cli.omissions import ALWAYS, omitted_by

BY_OPTIONS = {"modes", "superelement", "export", "simulate", "loads", "check", "soil", "operation", "recover"}
"""Commands whose options decide what they leave out."""
OF_WELDS = {"stress", "scenario", "record", "site", "strain", "forces"}
COMPUTES_NOTHING = {"init", "compare", "verify", "fatigue", *GROUPS["Living"]}
"""They keep books, write a file to fill in, or set two results side by side."""
JOINT = """
{class: y, chord_diameter_m: 1.2, chord_thickness_m: 0.05, chord_length_m: 12, fixity: 0.7,
 braces: [{diameter_m: 0.8, thickness_m: 0.02, angle_deg: 50}]}
"""
SEA = """
structure: jacket15
support: pinned
wind: {speed_m_s: 9.0, seed: 1}
time: {duration_s: 20, step_s: 0.1}
"""


def test_every_command_says_what_it_leaves_out_or_computes_nothing() -> None:
    commands = {name for group in GROUPS.values() for name in group}
    commands |= set(fatigue_command.commands)
    assert commands == BY_OPTIONS | OF_WELDS | COMPUTES_NOTHING | set(ALWAYS)
    known = [*BY_OPTIONS, *OF_WELDS, *COMPUTES_NOTHING, *ALWAYS]
    assert len(known) == len(set(known))


@pytest.mark.parametrize(
    "words",
    [
        "modes jacket15", "stages jacket15 --number 1", "law zener:k0=2.62e9,c=8.65e8,k1=9.99e9",
        "soil jacket15", "view jacket15 --modes 1 --out {0}/a.html", "fatigue scf {0}/joint.yaml",
        "loads {0}/sea.yaml",
        "superelement jacket15 --modes 4 --out {0}/a.npz", "export jacket15 --out {0}/a.dat",
        "check jacket15 --support pinned", "operation jacket15 --support clamped --wind 12 --turbulence none",
    ],
)  # fmt: skip
def test_it_is_in_the_output(words: str, tmp_path: Path) -> None:
    (tmp_path / "joint.yaml").write_text(JOINT, encoding="utf-8")
    (tmp_path / "sea.yaml").write_text(SEA, encoding="utf-8")
    done = CliRunner().invoke(main, [*words.format(tmp_path).split(), "--json"])
    assert done.exit_code == 0, done.stderr
    left = json.loads(done.stdout)["left_out"]
    assert left and all(one["what"] and set(one) == {"what", "clause"} for one in left)


@pytest.mark.parametrize("command", sorted(ALWAYS))
def test_a_command_s_own_entry_counts(command: str) -> None:
    assert with_omissions({"a": 1}, command) == {"a": 1, "left_out": omitted_by(command)}
    own = [{"what": "rain", "clause": None}]
    assert with_omissions({"left_out": own}, command) == {"left_out": own}


def test_wind_alone_leaves_out_ice_and_earthquakes(tmp_path: Path) -> None:
    (tmp_path / "sea.yaml").write_text(SEA, encoding="utf-8")
    done = CliRunner().invoke(main, ["loads", str(tmp_path / "sea.yaml"), "--json"])
    assert {"ISO 19906", "ISO 19901-2"} <= {one["clause"] for one in json.loads(done.stdout)["left_out"]}
