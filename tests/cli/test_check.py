"""``jackettwin check``: statics and refusals."""

import json

import pytest
from click.testing import CliRunner

from jackettwin.cli import main


def run(*arguments: str):
    return CliRunner().invoke(main, ["check", *arguments])


def test_thrust_uses_the_tower_s_foot_most() -> None:
    """Linear in the load once the weight is left out."""
    worst = []
    for thrust in (1e6, 2e6):
        found = json.loads(
            run("jacket15", "--force", f"tower_top={thrust},0,0", "--no-weight", "--json").stdout
        )
        rows = {row["member"]: row for row in found["members"]}
        worst.append(rows["tower_1"]["by_check"]["bending"])
        assert rows["tower_1"]["utilisation"] > rows["tower_12"]["utilisation"]
        assert found["members"][0]["clause"].startswith("axial")
    assert worst[1] == pytest.approx(2.0 * worst[0], rel=1e-9)


def test_forces_and_lengths_are_shown() -> None:
    """jacket15's tower is a cantilever of 116 m; its top carries the thrust across and no more."""
    arguments = ("jacket15", "--force", "tower_top=1e6,0,0", "--no-weight")
    rows = {row["member"]: row for row in json.loads(run(*arguments, "--json").stdout)["members"]}
    tower = rows["tower_12"]
    assert (tower["effective_length_factor"], tower["column_length_m"]) == (2.0, pytest.approx(116.0))
    assert tower["end"]["shear_z_n"] == pytest.approx(1e6, rel=1e-6)
    assert abs(tower["end"]["bending_y_nm"]) < 1.0  # of some 1e8 at the foot
    text = run(*arguments).stdout
    assert "K" in text
    assert "116.00" in text
    assert "kN·m" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--force", "tower_top"], "not NODE=FX,FY,FZ"),
        (["--force", "tower_tip=1,2,3"], "no such node"),
        (["--force", "tower_top=1,2"], "3 or 6 components"),
        (["--support", "kelvin-voigt:k=0,c=1e6"], "cannot stand on its support"),
    ],
)
def test_bad_input_exits_2(arguments: list[str], message: str) -> None:
    result = run("jacket15", *arguments)
    assert result.exit_code == 2, result.stderr
    assert message in result.stderr.replace("\n", " ")
