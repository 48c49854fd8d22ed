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
