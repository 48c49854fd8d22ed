"""A SACS deck in fixed columns: joints in feet and inches, groups with segments, what is not read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.structure import assemble, check, read_structure
from jackettwin.structure.sacs import sacs_remarks


def joint(name: str, x: float, y: float, z: float, dy: float, held: str = "") -> str:
    return f"JOINT {name:>4} {x:7.2f}{y:7.2f}{z:7.2f}{0.0:7.3f}{dy:7.3f}{0.0:7.3f} {held}"


def load(name: str, fz: float) -> str:
    return f"LOAD   {name:>4}     {0.0:7.1f}{0.0:7.1f}{fz:7.1f}".ljust(60) + "GLOB JOIN   DEAD"


DECK = f"""\
OPTIONS      EN  SDUC   2 1
SECT BR1       TUB                               16.0000.625
SECT WF1       WF                                24.0000.500
GRUP
GRUP LG1         42.000 1.375 29.0011.6050.00 1    1.001.00     0.500N490.005.00
GRUP LG1         41.250 1.000 29.0011.6036.00 1    1.001.00     0.500N490.00
GRUP BR1 BR1                  29.0011.6036.00 1    1.001.00     0.500N490.00
GRUP W01 WF1                  29.0011.6036.00 1    1.001.00     0.500N490.00
MEMBER
MEMBER  101 201 LG1
MEMBER  101 301 BR1
MEMBER  301 201 BR1
MEMBER  201 301 W01
MEMBER OFFSETS    1.0
JOINT
{joint("101", -24, -50, -261, -3, "PILEHD")}
{joint("201", -24, -50, -200, -3)}
{joint("301", 24, -50, -261, -3, "111000")}
PGRUP P01 0.3500I29.000 0.25036.000
{load("201", -100.0)}
END
"""


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    path = tmp_path / "sacinp.jacket"
    path.write_text(DECK)
    return path


def test_joints_are_feet_and_inches(deck: Path) -> None:
    x, y, z = read_structure(deck).nodes["101"]
    assert (x, z) == pytest.approx((-24 * 0.3048, -261 * 0.3048))
    assert y == pytest.approx(-50 * 0.3048 - 3 * 0.0254)


def test_a_group_of_two_lines_cuts_its_members(deck: Path) -> None:
    structure = read_structure(deck)
    legs = [m for m in structure.members if m.part == "LG1"]
    assert [m.section_start.outer_diameter_m for m in legs] == pytest.approx([42 * 0.0254, 41.25 * 0.0254])
    ends = [np.array(structure.nodes[n]) for n in (legs[0].start, legs[0].end)]
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(5 * 0.3048)


def test_mass_is_that_of_the_cards(deck: Path) -> None:
    """π(D−t)tρL by hand, and 100 kips on a joint."""
    rho, inch, foot = 490 * 16.01846337, 0.0254, 0.3048

    def tube(D: float, t: float, length: float) -> float:
        return float(np.pi * (D - t) * t * inch**2 * rho * length)

    legs = tube(42.0, 1.375, 5 * foot) + tube(41.25, 1.0, 56 * foot)
    brace = tube(16.0, 0.625, 48 * foot) + tube(16.0, 0.625, float(np.hypot(48, 61)) * foot)
    weight = 100 * 4448.2216152605 / 9.80665
    assert check(assemble(read_structure(deck))).mass_kg == pytest.approx(legs + brace + weight, rel=1e-6)


def test_what_holds_a_joint_is_read(deck: Path) -> None:
    held = {r.node: r.fixed for r in read_structure(deck).reactions}
    assert held == {"101": (True,) * 3 + (False,) * 3, "301": (True,) * 3 + (False,) * 3}


def test_what_is_not_understood_is_listed(deck: Path) -> None:
    said = " ".join(sacs_remarks(deck))
    for word in ("WF1", "PGRUP", "offsets", "W01"):
        assert word in said


def test_a_card_out_of_its_columns_names_line_and_columns(deck: Path) -> None:
    deck.write_text(DECK.replace("LG1         42.000 1.375", "LG1         4x.000 1.375"))
    with pytest.raises(InputError, match="columns 18 to 23"):
        read_structure(deck)
    deck.write_text(DECK.replace("MEMBER  101 201 LG1", "MEMBER  101 999 LG1"))
    with pytest.raises(InputError, match="no joint"):
        read_structure(deck)
