"""Bays of a jacket braced as X, K and Z, with horizontals and levels of one's own."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import pinned
from jackettwin.structure import Structure, assemble, at_interface, check

EXAMPLE = Path(__file__).parents[2] / "examples" / "three_leg_jacket.yaml"
SUBDYN = Path(__file__).parents[1] / "data" / "subdyn" / "members.json"
PLAIN = read_structure(EXAMPLE)


def braced(folder: Path, lines: str) -> Structure:
    """Return the example with further keys of its lattice."""
    path = folder / "jacket.yaml"
    path.write_text(EXAMPLE.read_text().replace("  lattice:\n", f"  lattice:\n    {lines}\n"))
    return read_structure(path)


def frequencies(structure: Structure, number: int) -> np.ndarray:
    return undamped_modes(build_system(assemble(structure), pinned(structure)), number).frequency_hz


@pytest.mark.parametrize(
    ("lines", "per_face", "horizontals"),
    [
        ("bracing: X", [4, 4, 4, 4], 0),
        ("bracing: K", [2, 2, 2, 2], 3 * 2),
        ("bracing: Z", [1, 1, 1, 1], 0),
        ("{bracing: [K, X, Z, K], horizontals: [2]}", [2, 4, 1, 2], 2 + 1),
    ],
)
def test_each_bay_has_its_braces(tmp_path: Path, lines: str, per_face: list[int], horizontals: int) -> None:
    """Every face alike; each structure in one piece, with six rigid-body modes."""
    structure = braced(tmp_path, lines.strip("{}").replace(", horizontals", "\n    horizontals"))
    for face in (1, 2, 3):
        found = [
            sum(m.name.startswith(f"brace_{face}_{bay}_") for m in structure.members) for bay in (1, 2, 3, 4)
        ]
        assert found == per_face
        assert sum(m.name.startswith(f"horizontal_{face}_") for m in structure.members) == horizontals
    assert check(assemble(structure)).rigid_body_modes == 6


def test_x_is_what_it_was(tmp_path: Path) -> None:
    assert replace(braced(tmp_path, "bracing: X"), name=PLAIN.name) == PLAIN


def test_the_braces_of_a_k_meet_the_middle_of_the_horizontal(tmp_path: Path) -> None:
    structure = braced(tmp_path, "bracing: K")
    left, right, apex = (np.array(structure.nodes[n]) for n in ("leg_1_1", "leg_2_1", "mid_1_1"))
    np.testing.assert_allclose(apex, 0.5 * (left + right))
    ends = {m.name: {m.start, m.end} for m in structure.members}
    assert ends["brace_1_1_1"] == {"foot_1", "mid_1_1"}
    assert ends["brace_1_1_2"] == {"foot_2", "mid_1_1"}
    assert ends["horizontal_1_1_1"] | ends["horizontal_1_1_2"] == {"leg_1_1", "mid_1_1", "leg_2_1"}
    # at the leg tops it is the ring of the transition piece that they meet
    assert ends["tp_ring_1_1"] | ends["tp_ring_1_2"] == {"leg_1_4", "mid_1_4", "leg_2_4"}


def test_z_goes_up_a_face_in_a_zigzag(tmp_path: Path) -> None:
    structure = braced(tmp_path, "bracing: Z")
    ends = {m.name: (m.start, m.end) for m in structure.members}
    path = [ends[f"brace_1_{bay}_1"] for bay in (1, 2, 3, 4)]
    nodes = ("foot_1", "leg_2_1", "leg_1_2", "leg_2_3", "leg_1_4")
    assert path == [*zip(nodes[:-1], nodes[1:], strict=True)]


def test_levels_of_ones_own(tmp_path: Path) -> None:
    structure = braced(tmp_path, "levels_z_m: [20.0, 35.0, 50.0]")
    assert [structure.nodes[f"leg_1_{k}"][2] for k in (1, 2, 3, 4)] == [20.0, 35.0, 50.0, 62.0]
    # legs stay straight
    foot, mid, top = (np.array(structure.nodes[n]) for n in ("foot_1", "leg_1_2", "leg_1_4"))
    assert np.abs(np.cross(top - foot, mid - foot)).max() < 1e-9


@pytest.mark.parametrize("pattern", ["K", "Z"])
def test_faces_alike_have_pairs(tmp_path: Path, pattern: str) -> None:
    """Turned by a third of a turn the foundation is itself: its bending modes come in pairs."""
    base, _ = at_interface(braced(tmp_path, f"bracing: {pattern}"))
    f = frequencies(base, 2)
    assert f[1] == pytest.approx(f[0], rel=1e-8)


def test_frequencies_of_subdyn(tmp_path: Path) -> None:
    """SubDyn (OpenFAST 5) on the deck that `export` writes of a mixed foundation; seven figures."""
    recorded = json.loads(SUBDYN.read_text())["braced"]
    base, _ = at_interface(braced(tmp_path, "bracing: [K, X, Z, K]\n    horizontals: [2]"))
    base = replace(base, rotary_inertia=True)
    np.testing.assert_allclose(frequencies(base, 20), recorded["frequency_hz"], rtol=6e-7)
    assert check(assemble(base)).mass_kg == pytest.approx(recorded["mass_kg"], rel=1e-6)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("bracing: V", r"lattice.bracing.*'X', 'K' or 'Z'"),
        ("bracing: [K, X]", r"lattice.bracing.*4, one a bay"),
        ("levels_z_m: [20.0, 35.0]", r"lattice.levels_z_m.*3 levels between 4 bays"),
        ("levels_z_m: [20.0, 50.0, 35.0]", r"lattice.levels_z_m.*rising, between 0 and 62 m"),
        ("levels_z_m: [20.0, .nan, 35.0]", r"lattice.levels_z_m.*finite"),
        ("horizontals: [4]", r"lattice.horizontals.*got 4.*1 to 3.*ring"),
        ("horizontals: [0]", r"lattice.horizontals.*mud_braces"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, lines: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        braced(tmp_path, lines)
