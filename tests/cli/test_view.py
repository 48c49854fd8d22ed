"""``jackettwin view``: a page, or one message."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main

RECORD = Path(__file__).parents[1] / "records" / "data" / "pile_U12_s301.parquet"


def run(*arguments: str):
    return CliRunner().invoke(main, ["view", "jacket15", *arguments])


def test_everything_at_once(tmp_path: Path) -> None:
    out = tmp_path / "view.html"
    result = run(
        "--out", str(out), "--support", "jacket15", "--modes", "2", "--subdivide", "1",
        "--growth", "2,-40,0.1",
        "--flooded", "jacket", "--wave", "8,9,30", "--record", str(RECORD), "--force", "tower_top=1e6,0,0",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert "tower: z +28.00 to +144.00 m, on one vertical axis, tubes" in result.stdout.replace("\n", " ")
    page = out.read_text()
    for word in ("undamped modes", "damped modes", "regular wave", "record pile_U12_s301", "ISO 19902"):
        assert word in page


def test_feet_on_a_slope_and_a_part_of_girders(tmp_path: Path) -> None:
    deck = Path(__file__).parents[2] / "qualify" / "decks" / "uneven_legs.yaml"
    out = ["--modes", "0", "--out", str(tmp_path / "view.html"), "--json"]
    result = CliRunner().invoke(main, ["view", str(deck), *out])
    assert result.exit_code == 0, result.stderr
    lines = json.loads(result.stdout)["dimensions"]
    assert lines[1].startswith("4 feet at z -41.00 to -36.50 m")
    assert "transition piece: z +11.00 to +16.00 m, 12.00 × 10.90 m in plan, 8 beams" in lines


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--out", "view.pdf"], "ends in .html"),
        (["--out", "not/there/view.html"], "there is no folder 'not/there'"),
        (["--out", "v.html", "--growth", "2,-40"], "not TOP,BOTTOM,THICKNESS"),
        (["--out", "v.html", "--flooded", "jackett"], "no such member or part"),
        (["--out", "v.html", "--wave", "80,9"], "height"),
        (["--out", "v.html", "--record", "gone.parquet"], "gone.parquet"),
    ],
)
def test_bad_input_exits_2(arguments: list[str], message: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments, "--modes", "1", "--subdivide", "1")
    assert result.exit_code == 2, result.output
    assert message in result.stderr.replace("\n", " ")
    assert list(tmp_path.iterdir()) == []
