"""``jackettwin update``: every solution, how sure it is that these are all, why there are no intervals."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main

FREQUENCIES = """\
structure: jacket15
gravity: false
damping:
  rayleigh:
    ratio: 0.01
    frequency_hz: 0.1832
targets:
  - {mode: 1, frequency_hz: 0.182396}
  - {mode: 2, frequency_hz: 0.185047}
  - {mode: 4, frequency_hz: 0.735126}
update:
  laws: [kelvin-voigt]
  starts: 8
"""


@pytest.fixture
def twin(tmp_path: Path) -> Path:
    path = tmp_path / "t.yaml"
    path.write_text(FREQUENCIES)
    return path


def test_the_terminal_shows_every_solution_and_how_complete_the_list_is(twin: Path) -> None:
    """A stiff spring, or a soft one with a locked damper: frequencies do not tell (thesis table 8.3)."""
    result = CliRunner().invoke(main, ["update", str(twin)])
    assert result.exit_code == 0, result.output
    words = " ".join(result.stdout.split())
    assert "distinct solution" in words and "(95 % confidence)" in words
    assert "starts ┃ damper" in words and "locked" in words
    assert "No intervals: they need the standard deviation of every target." in words
    assert "undamped" in words


def test_a_target_of_another_mode_is_refused_naming_that_one(twin: Path) -> None:
    """Pinned feet give mode 1 0.183 Hz."""
    twin.write_text(FREQUENCIES.replace("0.182396", "0.9"))
    result = CliRunner().invoke(main, ["update", str(twin)])
    assert result.exit_code == 2, result.output
    message = " ".join(result.stderr.split())
    for word in (
        "t.yaml: targets.0.frequency_hz:",
        "(got 0.9)",
        "0.1832 Hz or less for mode 1",
        "write mode: 6",
    ):
        assert word in message
    assert result.stdout == ""


def test_a_label_no_mode_has_is_refused(twin: Path) -> None:
    twin.write_text(FREQUENCIES + "  damping_of: [fore-aft_1]\n")
    result = CliRunner().invoke(main, ["update", str(twin)])
    assert result.exit_code == 2, result.output
    message = " ".join(result.stderr.split())
    for word in ("update.damping_of", "fore-aft_1", "allowed: side_side_1, fore_aft_1", "did you mean"):
        assert word in message
