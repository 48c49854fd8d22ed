"""``jackettwin update``: every solution, how sure it is that these are all, why there are no intervals."""

import json
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
    assert "There are no intervals, which need the standard deviation of every target." in words
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


def test_points_to_start_from_are_given_on_the_command_line_or_in_the_file(twin: Path) -> None:
    given = ["update", str(twin), "--json", "--start", "k=5.7e9,c=1e8", "--start", "k=1e8,c=1e12"]
    by_option = CliRunner().invoke(main, given)
    assert by_option.exit_code == 0, by_option.output
    twin.write_text(
        FREQUENCIES.replace("starts: 8", "starts: [{k: 5.7e+9, c: 1.0e+8}, {k: 1.0e+8, c: 1.0e+12}]")
    )
    by_file = CliRunner().invoke(main, ["update", str(twin), "--json"])
    assert by_file.exit_code == 0, by_file.output
    one, other = json.loads(by_option.stdout), json.loads(by_file.stdout)
    assert one["begun"] == other["begun"] and len(one["begun"]) == 2
    assert one["begun"][0]["from"] == {"k": pytest.approx(5.7e9), "c": pytest.approx(1e8)}
    assert one["completeness"]["missed_share_95"] is None


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("k=abc", "--start: not NAME=VALUE"),
        ("k=-1", "--start: not positive"),
        ("kk=1e9", "--start: a starting point has no parameter of the law"),
        ("k=1e3", "starts[0].k: a start is outside the bounds"),
    ],
)
def test_a_wrong_point_is_refused(twin: Path, option: str, message: str) -> None:
    result = CliRunner().invoke(main, ["update", str(twin), "--start", option])
    assert result.exit_code == 2, result.output
    assert message in " ".join(result.stderr.split())
    assert result.stdout == ""


def test_a_point_of_no_law_is_refused_in_the_file(twin: Path) -> None:
    twin.write_text(FREQUENCIES.replace("starts: 8", "starts: [{k: 5.7e+9, k1: 1.0e+8}]"))
    result = CliRunner().invoke(main, ["update", str(twin)])
    assert result.exit_code == 2, result.output
    assert "update.starts[0]: no fitted law has all parameters of this starting point" in " ".join(
        result.stderr.split()
    )
    assert "allowed: kelvin-voigt: k, c\n" in result.stderr  # the law that is fitted, no other


def test_all_laws_are_ranked_by_cost(tmp_path: Path) -> None:
    """Table 6.1: Zener contains Kelvin-Voigt and ends there; the others cannot reach its cost."""
    path = tmp_path / "t.yaml"
    more = "  - {mode: 4, frequency_hz: 0.7362, damping_ratio: 0.0281}\n"
    text = FREQUENCIES.replace("[kelvin-voigt]", "[kelvin-voigt, maxwell-3]")
    path.write_text(text.replace("  - {mode: 4, frequency_hz: 0.735126}\n", more))
    shown = CliRunner().invoke(main, ["update", str(path), "--all-laws"])
    assert shown.exit_code == 0, shown.output
    assert "cost (8.4)" in " ".join(shown.stdout.split())
    plain = json.loads(CliRunner().invoke(main, ["update", str(path), "--all-laws", "--json"]).stdout)
    costs = [r["cost"] for r in plain["law_ranking"]]
    assert costs == sorted(costs) and len(plain["updates"]) == 2
    both = CliRunner().invoke(main, ["update", str(path), "--all-laws", "--law", "zener"])
    assert both.exit_code == 2


def test_weights_are_refused_where_standard_deviations_weigh(twin: Path) -> None:
    weighed = FREQUENCIES.replace("  starts: 8", "  starts: 8\n  weights: {frequency: {1: 2.0, 4: 0}}")
    twin.write_text(weighed)
    plain = json.loads(CliRunner().invoke(main, ["update", str(twin), "--json"]).stdout)
    assert plain["solutions"][0]["modes"] == [1, 2]  # a weight of zero leaves a value out
    text = weighed
    for f in ("0.182396", "0.185047", "0.735126"):
        text = text.replace(f"{f}}}", f"{f}, frequency_std_hz: 0.001}}")
    twin.write_text(text)
    result = CliRunner().invoke(main, ["update", str(twin)])
    assert result.exit_code == 2, result.output
    assert "update.weights: weights apply to the relative cost (8.4)" in " ".join(result.stderr.split())
