"""``jackettwin soil``: keys, page, refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli.main import main


def run(*arguments: str) -> object:
    return CliRunner().invoke(main, ["soil", *arguments])


def test_tables_json_and_page(tmp_path: Path) -> None:
    page = tmp_path / "ground.html"
    result = run("jacket15", "--steps", "3", "--out", str(page), "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    K = np.array(document["head_stiffness"])
    assert K.shape == (6, 6) and (np.linalg.eigvalsh(K) > 0.0).all()
    assert np.array(document["head_loss"]).shape == (6, 6)
    capacity = document["capacity"]
    assert capacity["axial_compression_n"] == pytest.approx(
        capacity["shaft_n"] + capacity["inner_shaft_n"] + capacity["tip_n"]
    )
    assert len(document["pushover"]["load_n"]) == 3
    assert document["pushover"]["load_n"][-1] == pytest.approx(capacity["lateral_n"])
    # f_y D/2 ≥ M D/2I: the steel of this pile yields on the way
    assert 0.0 < capacity["steel_yields_at_n"] < capacity["lateral_n"] <= capacity["highest_lateral_n"]
    assert any("steel yields" in text for text in document["warnings"])
    assert document["left_out"]
    first = document["curves"]["stations"][0]["py"]
    assert len(first["y_m"]) == len(first["reaction"])
    assert "Capacity" in page.read_text(encoding="utf-8")


def test_columns_have_their_units_on_the_terminal(tmp_path: Path) -> None:
    """What stands in brackets is no markup."""
    result = run("jacket15", "--steps", "2", "--out", str(tmp_path / "ground.html"))
    for unit in ("load [MN]", "head [mm]", "rotation [mrad]", "largest moment [MN·m]"):
        assert unit in result.stdout


def test_linear_ground_has_a_head_but_no_capacity(tmp_path: Path) -> None:
    result = run("jacket15_records", "--out", str(tmp_path / "page.html"))
    assert result.exit_code == 0, result.output
    assert "linear ground has no curves" in result.stderr


def test_an_unknown_foundation_is_refused() -> None:
    result = run("sands")
    assert result.exit_code == 2
    assert "jacket15_records" in result.stderr


@pytest.mark.parametrize(
    ("option", "value"), [("--frequency-hz", "nan"), ("--arm", "nan"), ("--arm", "inf"), ("--arm", "1e9")]
)
def test_numbers_that_are_none_and_far_arms_are_refused(option: str, value: str, tmp_path: Path) -> None:
    result = run("jacket15", option, value, "--out", str(tmp_path / "page.html"))
    assert result.exit_code == 2
    assert option in result.stderr
    assert not list(tmp_path.iterdir())
