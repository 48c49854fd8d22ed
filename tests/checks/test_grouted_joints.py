"""Grouted connections by hand, and in ``check``."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.checks import GroutedConnection, GroutUse, read_grouted
from jackettwin.cli import main
from jackettwin.errors import InputError

SLEEVE = {
    "pile_diameter_m": 2.0, "pile_wall_m": 0.05, "sleeve_diameter_m": 2.2, "sleeve_wall_m": 0.05,
    "length_m": 6.0, "key_height_m": 0.008, "key_spacing_m": 0.3, "cube_strength_pa": 50e6,
}  # fmt: skip


def connection(**changes: object) -> GroutedConnection:
    return GroutedConnection.model_validate(SLEEVE | changes)


def test_radial_stiffness_of_a_published_calculation() -> None:
    """HSE OTR 2001/016 as worked for this pile and sleeve: m 18, D_g/t_g 42, K = 0.013 (0.013228)."""
    assert connection().radial_stiffness == pytest.approx(1.0 / 84.0 + 1.0 / (18.0 * 42.0), rel=1e-12)
    assert round(connection().radial_stiffness, 3) == 0.013


def test_strengths_by_hand() -> None:
    """(h/s)^0.8 = 0.05505, K^0.6 = 0.07463, 50^0.3 = 3.2336: 9.707 · 0.07463 · 3.2336 = 2.3425 MPa.

    Shear of the grout: (0.75 − 1.4 · 0.02667) · 7.0711 = 5.0393 MPa.
    """
    one = connection()
    assert one.sliding_pa == pytest.approx(2.3425e6, rel=2e-4)
    assert one.shear_pa == pytest.approx(5.0393e6, rel=1e-4)
    # 20 MN on π · 2 m · (6 − 0.3) m: 0.5584 MPa, twice over 2.3425
    use = GroutUse("foot", -20e6, one)
    assert use.stress_pa == pytest.approx(0.55842e6, rel=1e-4)
    assert use.utilisation == pytest.approx(2.0 * 0.55842 / 2.3425, rel=1e-3)
    assert use.governs == "sliding"
    early = GroutUse("foot", -20e6, connection(moves_early=True))
    assert early.utilisation == pytest.approx(use.utilisation / 0.75)
    # without keys it slides at 2 K^0.6 f_cu^0.3, and its length is less by twice the grout
    plain = connection(key_height_m=0.0, key_spacing_m=None)
    assert plain.sliding_pa == pytest.approx(0.48263e6, rel=2e-4)
    assert plain.effective_length_m == pytest.approx(5.9)
    assert one.beyond_validity == ()
    assert connection(cube_strength_pa=120e6).beyond_validity == ("f_cu [MPa] = 120 outside 20 to 80",)


def test_small_piles_are_stronger_for_their_size() -> None:
    """C_p = (D/1000)² − D/500 + 2: 1.25 at 500 mm, 1 from 1 m on."""
    small = connection(pile_diameter_m=0.5, sleeve_diameter_m=0.7, pile_wall_m=0.02)
    assert small.scale_factor == pytest.approx(1.25)
    assert connection(pile_diameter_m=1.0, sleeve_diameter_m=1.2).scale_factor == 1.0


def test_the_command_checks_the_grout_of_feet(tmp_path: Path) -> None:
    path = tmp_path / "grout.yaml"
    path.write_text("connections:\n  - " + json.dumps(SLEEVE) + "\n")
    arguments = ["check", "jacket15", "--support", "kelvin-voigt:k=2.5e9,c=0", "--force", "tower_top=2e6,0,0"]
    answer = CliRunner().invoke(main, [*arguments, "--grout", str(path), "--json"])
    assert answer.exit_code == 0, answer.output
    rows = json.loads(answer.stdout)["grouted"]
    assert len(rows) == 4
    assert all(row["governs"] == "sliding" for row in rows)
    # weight in all, and the moment parts lee from luff
    assert sum(row["axial_n"] for row in rows) < -2e7
    assert rows[0]["axial_n"] < rows[-1]["axial_n"]
    # outside the range of the tests a connection is last and no headline, however much it is used
    wide, rest = (
        SLEEVE | {"feet": ["foot_1"], "length_m": 1.0},
        SLEEVE | {"feet": ["foot_2", "foot_3", "foot_4"]},
    )
    path.write_text("connections:\n" + "".join(f"  - {json.dumps(one)}\n" for one in (rest, wide)))
    found = json.loads(CliRunner().invoke(main, [*arguments, "--grout", str(path), "--json"]).stdout)
    rows = found["grouted"]
    assert rows[-1]["foot"] == "foot_1" and rows[-1]["beyond_validity"]
    assert rows[-1]["utilisation"] > max(1.0, rows[0]["utilisation"])
    assert not any("grout used above 1" in text and "foot_1" in text for text in found["warnings"])
    pinned = CliRunner().invoke(main, ["check", "jacket15", "--grout", str(path)])
    assert pinned.exit_code == 2
    assert "put the feet on springs" in pinned.output


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"sleeve_diameter_m": 2.05}, "no room for grout"),
        ({"length_m": 0.2}, "no effective length"),
        ({"key_spacing_m": None}, "height and spacing"),
        ({"feet": ["nowhere"]}, "foot"),
    ],
)
def test_connections_that_do_not_fit_are_refused(tmp_path: Path, changes: dict, said: str) -> None:
    path = tmp_path / "grout.yaml"
    path.write_text("connections:\n  - " + json.dumps(SLEEVE | changes) + "\n")
    with pytest.raises(InputError, match=said):
        read_grouted(path, ("foot_1", "foot_2"))
