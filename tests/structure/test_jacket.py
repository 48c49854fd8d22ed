"""The parametric jacket."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import pinned
from jackettwin.structure import Section, Structure, assemble, check, jacket
from jackettwin.structure.jacket import Lattice, Tower, TransitionPiece
from jackettwin.structure.model import PointMass

LATTICE = Lattice(30.0, 12.0, 60.0, 1.4, 0.06, 0.04, Section(0.7, 0.02), legs=3, bays=3)
PIECE = TransitionPiece(66.0, Section(1.5, 0.05), Section(6.0, 0.08))
TOWER = Tower(90.0, Section(6.0, 0.05), Section(4.0, 0.03), elements=9)


def build(lattice: Lattice = LATTICE, piece: TransitionPiece = PIECE, tower: Tower = TOWER) -> Structure:
    rna = PointMass("tower_top", 4e5)
    return jacket(name="j", lattice=lattice, transition_piece=piece, tower=tower, rna=rna, sea_level_z_m=40.0)


@pytest.mark.parametrize("legs", [3, 4, 6])
def test_any_number_of_legs_stands(legs: int) -> None:
    """A regular polygon bends alike in every direction: the first two modes are equal to the last digit."""
    structure = build(replace(LATTICE, legs=legs))
    assert len(structure.reactions) == legs
    assembly = assemble(structure)
    assert check(assembly).rigid_body_modes == 6
    f = undamped_modes(build_system(assembly, pinned(structure)), 4).frequency_hz
    assert f[0] == pytest.approx(f[1], rel=1e-9)
    assert 0.05 < f[0] < 1.0


def test_feet_stand_base_width_apart_and_bays_are_similar() -> None:
    structure = build()
    feet = np.array([structure.nodes[n] for n in structure.reaction_nodes])
    assert np.linalg.norm(feet[0] - feet[1]) == pytest.approx(30.0)
    assert (feet[:, 2] == 0.0).all()
    z = [structure.nodes[f"leg_1_{k}"][2] if k else 0.0 for k in range(4)]
    heights = np.diff(z)
    np.testing.assert_allclose(heights[1:] / heights[:-1], (12.0 / 30.0) ** (1 / 3), rtol=1e-12)
    assert z[-1] == pytest.approx(60.0)


def test_braces_meet_where_the_diagonals_cross() -> None:
    nodes = build().nodes
    a, b = np.array(nodes["foot_1"]), np.array(nodes["leg_2_1"])
    centre = np.array(nodes["cross_1_1"])
    assert np.linalg.norm(np.cross(centre - a, b - a)) < 1e-9 * np.linalg.norm(b - a) ** 2


@pytest.mark.parametrize(
    ("part", "change", "message"),
    [
        (LATTICE, {"legs": 2}, "legs: out of range .got 2."),
        (LATTICE, {"legs": 10**9}, "legs: out of range"),
        (LATTICE, {"bays": 0}, "bays: out of range"),
        (LATTICE, {"top_width_m": 0.0}, "top_width_m: out of range"),
        (
            LATTICE,
            {"leg_thickness_top_m": -0.01},
            "leg_thickness_top_m: .*positive.*0 < leg_.*≤ 0.7",
        ),
        (LATTICE, {"leg_thickness_bottom_m": 0.8}, "leg_thickness_bottom_m: .*at most the radius .got 0.8."),
        (LATTICE, {"brace": (Section(0.7, 0.02),) * 2}, "brace: out of range .got 2.*one section, or 3"),
        (TOWER, {"elements": 0}, "elements: out of range"),
        (TOWER, {"height_m": -1.0}, "height_m: out of range"),
    ],
)
def test_bad_parts_are_refused(part: Lattice | Tower, change: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(part, **change)


def test_a_transition_piece_stands_above_the_legs() -> None:
    with pytest.raises(InputError, match="transition_piece.top_z_m: out of range .got 60.0."):
        build(piece=replace(PIECE, top_z_m=60.0))
