"""Whatever is wrong with what the user brings: exit 2, one message with file, field, value and remedy."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from jackettwin.cli import main

from .conftest import Case


def zero_length_member(c: Case) -> None:
    c.structure["nodes"]["top"] = c.structure["nodes"]["hip"]


def unconnected_node(c: Case) -> None:
    c.structure["nodes"]["lost"] = [1, 2, 3]


def detached_part(c: Case) -> None:
    c.structure["nodes"] |= {"p": [50, 0, 0], "q": [50, 0, 9]}
    c.structure["members"].append({"name": "stray", "nodes": ["p", "q"], "section": "tube"})


def negative_thickness(c: Case) -> None:
    c.structure["sections"]["tube"]["thickness_m"] = -0.04


def wrong_unit(c: Case) -> None:
    c.record["channels"]["top_x"]["unit"] = "furlong/s^2"


def dead_channels(c: Case) -> None:
    for number, name in enumerate(c.signals):
        c.signals[name] = np.full(12000, np.nan if number else 9.81)


def no_sample_rate(c: Case) -> None:
    del c.record["sample_rate_hz"]


def short_record(c: Case) -> None:
    c.signals = {name: signal[:60] for name, signal in c.signals.items()}


def missing_record(c: Case) -> None:
    c.twin["records"] = ["night.parquet"]


def missing_structure(c: Case) -> None:
    c.twin["structure"] = "gone.yaml"


def unknown_law(c: Case) -> None:
    c.twin["update"]["laws"] = ["kelvinvoigt"]


def bounds_reversed(c: Case) -> None:
    c.twin["update"]["bounds"] = {"k": [1e10, 1e8]}


def typo_in_key(c: Case) -> None:
    c.twin["update"]["metod"] = "nelder-mead"


def typo_in_settings(c: Case) -> None:
    c.twin["identification"]["lowest_freqency_hz"] = 0.2


def typo_in_structure(c: Case) -> None:
    c.structure["nods"] = c.structure.pop("nodes")


def unknown_channel(c: Case) -> None:
    c.twin["sensors"] = [{"channel": "top_z", "node": "top", "direction": [0, 0, 1]}]


def unknown_node(c: Case) -> None:
    c.twin["sensors"] = [{"channel": "top_x", "node": "topp", "direction": [1, 0, 0]}]


MISTAKES: dict[Callable[[Case], None], tuple[str, ...]] = {
    missing_structure: ("gone.yaml", "no such structure file"),
    missing_record: ("night.parquet", "no such"),
    zero_length_member: ("frame.yaml", "members.tower", "zero length"),
    unconnected_node: ("frame.yaml", "lost", "not connected"),
    detached_part: ("frame.yaml", "p", "not connected"),
    negative_thickness: ("frame.yaml", "thickness_m", "-0.04"),
    wrong_unit: ("day", "channels.top_x", "furlong/s^2"),
    dead_channels: ("day.parquet", "channels", "no channel carries a signal"),
    no_sample_rate: ("day.json", "sample_rate_hz"),
    short_record: ("day.parquet", "short"),
    unknown_law: ("twin.yaml", "update.laws.0:", "did you mean 'kelvin-voigt'"),
    bounds_reversed: ("twin.yaml", "update.bounds.k", "10000000000.0"),
    typo_in_key: ("twin.yaml", "update.metod", "did you mean 'method'"),
    typo_in_settings: ("twin.yaml", "lowest_freqency_hz", "did you mean 'lowest_frequency_hz'"),
    typo_in_structure: ("frame.yaml", "nods", "did you mean 'nodes'"),
    unknown_channel: ("day.parquet", "channels", "top_z"),
    unknown_node: ("twin.yaml", "sensors", "topp"),
}


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda m: m.__name__)
def test_run_refuses_and_leaves_nothing(case: Case, tmp_path: Path, mistake: Callable[[Case], None]) -> None:
    mistake(case)
    twin = case.write()
    before = sorted(tmp_path.rglob("*"))
    result = CliRunner().invoke(main, ["run", str(twin), "--out", str(tmp_path / "out")])
    refused(result, MISTAKES[mistake])
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "mistake",
    [wrong_unit, dead_channels, no_sample_rate, short_record],
    ids=lambda m: m.__name__,
)
def test_identify_refuses(case: Case, mistake: Callable[[Case], None]) -> None:
    mistake(case)
    case.write()
    result = CliRunner().invoke(main, ["identify", str(case.folder / "day.parquet")])
    refused(result, MISTAKES[mistake])


@pytest.mark.parametrize("command", ["run", "update", "identify", "modes"])
def test_a_missing_file_is_named(command: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(main, [command, str(tmp_path / "gone.yaml")])
    refused(result, ("gone.yaml",))


def test_update_refuses_an_unknown_law() -> None:
    result = CliRunner().invoke(main, ["update", "thesis_table_6_1", "--law", "zenner"])
    refused(result, ("--law:", "zenner", "did you mean 'zener'"))


OPTIONS: dict[tuple[str, ...], tuple[str, ...]] = {
    ("follow", "{twin}", "--law", "zenner"): ("--law:", "did you mean 'zener'"),
    ("modes", "jacket15", "--rayleigh", "1.27,0.18"): ("--rayleigh.ratio:", "1.27"),
    ("identify", "{counts}", "--unit", "furlong"): ("--unit:", "furlong"),
    ("identify", "{counts}", "--gain", "0"): ("counts.csv", "channels.acc_x.gain:", "but zero"),
    ("identify", "{counts}", "--gain", "none"): ("--gain", "'none' is not a valid number"),
}


@pytest.mark.parametrize("arguments", OPTIONS, ids=lambda a: f"{a[0]} {a[2]} {a[3]}")
def test_a_wrong_option_is_named_as_it_was_written(
    case: Case, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    counts = tmp_path / "counts.csv"
    rows = "\n".join(f"{i / 20},{i % 7}" for i in range(200))
    counts.write_text(f"time [s],acc_x [counts]\n{rows}\n")
    places = {"twin": case.write(), "counts": counts}
    result = CliRunner().invoke(main, [a.format(**places) for a in arguments])
    refused(result, OPTIONS[arguments])


def test_the_help_shows_no_range_where_there_is_none() -> None:
    assert "None" not in CliRunner().invoke(main, ["identify", "--help"]).output


def test_out_that_is_a_file_is_refused(case: Case, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    result = CliRunner().invoke(main, ["run", "thesis_table_6_1", "--out", str(tmp_path / "out")])
    refused(result, ("out", "--out"))
    assert (tmp_path / "out").read_text() == "mine"


def refused(result: Result, words: tuple[str, ...]) -> None:
    """Assert exit code 2 and one message that holds the words."""
    assert result.exit_code == 2, result.output
    message = result.stderr.replace("\n", " ")
    assert [word for word in words if word not in message] == [], message
    assert "Traceback" not in result.output
    assert result.stdout == ""
