"""HydroDyn input files: the public IEA 15 MW jacket's tables, and one of every kind of coefficient."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import GrowthBand, Strip, StripTable
from jackettwin.loads.members.ends import EndCoefficients
from jackettwin.loads.members.hydrodyn_deck import HydroDynMembers, read_hydrodyn
from jackettwin.structure import Section, Structure
from jackettwin.structure.model import STEEL, Member

DECK = (Path(__file__).parents[1] / "data/hydrodyn/members.dat").read_text(encoding="utf-8")
TUBE = Section(1.0, 0.02)
STRUCTURE = Structure(
    "two",
    {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 40.0), "c": (8.0, 0.0, 10.0), "d": (0.0, 0.0, 10.0)},
    (
        Member("leg", "a", "b", TUBE, TUBE, STEEL),
        Member("brace", "c", "d", TUBE, TUBE, STEEL),
        Member("other", "c", "a", TUBE, TUBE, STEEL),
    ),
    sea_level_z_m=30.0,
)


def read(folder: Path, text: str = DECK, **options: float) -> HydroDynMembers:
    path = folder / "hydrodyn.dat"
    path.write_text(text, encoding="utf-8")
    return read_hydrodyn(path, STRUCTURE, **{"density_kg_m3": 1025.0, **options})


def test_every_kind_of_coefficient(tmp_path: Path) -> None:
    """Members are those at the same places, whichever way round; feet may reach into the bed."""
    found = read(tmp_path)
    c = found.coefficients
    assert (c.bare, c.grown) == (Strip(0.65, 1.0, 1.0), Strip(1.05, 0.9, 0.95))
    assert c.tables[0] == StripTable(
        (0.0, -30.0),
        (Strip(0.7, 0.8, 1.0), Strip(0.6, 1.0, 1.0)),
        (Strip(1.1, 0.7, 1.0), Strip(1.0, 0.9, 1.0)),
        ("leg",),
    )
    (level,) = c.tables[1].bare  # level brace: the mean of both ends
    assert c.tables[1].members == ("brace",) and level.row() == pytest.approx((0.6, 1.1, 1.0))
    assert c.growth == (
        GrowthBand(2.0, 0.0, 0.0, 0.1, 1300.0, 1300.0),
        GrowthBand(0.0, -30.0, 0.1, 0.05, 1300.0, 1400.0),
    )
    assert found.ends == EndCoefficients(pressure=1.0, added_mass=0.5, drag=0.2)
    assert found.flooded == ("leg",)


BAD = {
    "no file of this kind": ("SimplCd ", "Simple ", "SimplCd.*table is missing"),
    "potential flow": ("        1        FALSE", "        1        TRUE", "potential flow"),
    "no such joint": ("2         4  ", "2         9  ", "no such joint.*9"),
    "not of this structure": ("     8.0  ", "     5.0  ", "no such member"),
    "two kinds of ends": ("10.0      1 ", "10.0      2 ", "different axial"),
    "half filled": ("0.0          default", "-5.0         default", "below still water"),
    "filled with grout": ("0.0          default", "0.0          2400", "something else than this water"),
    "not a number": ("   0.65 ", "   zero ", "not a number"),
    "member without coefficients": ("  3       0.5", "  7       0.5", "member is missing.*3"),
    "short row": ("0.0          default", "", "too short"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_refused(tmp_path: Path, case: str) -> None:
    old, new, message = BAD[case]
    assert old in DECK
    with pytest.raises(InputError, match=message):
        read(tmp_path, DECK.replace(old, new, 1))


def test_lists_of_filled_members_longer_than_their_count(tmp_path: Path) -> None:
    """As in the public IEA 15 MW jacket deck, which numbers its groups."""
    row = " 1        1                     0.0          default"
    assert read(tmp_path, DECK.replace(row, " 1   1 3 2 1   0.0   1025")).flooded == ("leg", "brace")


def test_coefficients_reach_the_points(tmp_path: Path) -> None:
    c = read(tmp_path).coefficients
    z, member = np.array([-15.0, -29.0, -20.0]), np.array([0, 0, 1])
    drag, added, _ = c.at(z, member, [("leg", ""), ("brace", "")])
    np.testing.assert_allclose(drag, [1.05, 1.0 + 0.1 / 30.0, 1.0])  # all under growth
    np.testing.assert_allclose(added, [0.8, 0.9 - 0.2 / 30.0, 1.0])
