"""Jackets as people have them: any origin, sections bay by bay, bodies and what hangs on the legs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.structure import Structure, assemble
from jackettwin.updating import numbered_modes

TUBE = "{outer_diameter_m: 0.8, thickness_m: 0.02}"


def jacket(
    folder: Path, *, base: float = 0.0, brace: str = TUBE, more: str = "", around: str = ""
) -> Structure:
    path = folder / "jacket.yaml"
    path.write_text(f"""
sea_level_z_m: {45.0 + base}
{around}
jacket:
  lattice: {{legs: 3, bays: 2, base_width_m: 28, top_width_m: 14, height_m: 62, leg_diameter_m: 1.4,
    base_z_m: {base}, leg_thickness_bottom_m: 0.045, leg_thickness_top_m: 0.035, brace: {brace}}}
  transition_piece: {{top_z_m: {70.0 + base}, tube: {{outer_diameter_m: 2.0, thickness_m: 0.06}},
    column: {{outer_diameter_m: 7.5, thickness_m: 0.08}}}}
  tower: {{height_m: 95, elements: 3, bottom: {{outer_diameter_m: 7.5, thickness_m: 0.045}},
    top: {{outer_diameter_m: 5.5, thickness_m: 0.025}}}}
  rna: {{mass_kg: 675000.0, cg_offset_m: [-2.5, 0.0, 3.0]}}
{more}
""")
    return read_structure(str(path))


def frequencies(structure: Structure) -> np.ndarray:
    return numbered_modes(assemble(structure, gravity=True), 5).frequency_hz


def test_the_origin_is_where_one_likes(tmp_path: Path) -> None:
    """Z = 0 at still water instead of at the feet moves every node and no frequency."""
    at_feet, at_sea = jacket(tmp_path), jacket(tmp_path, base=-45.0)
    assert at_sea.sea_level_z_m == 0.0
    for name, (x, y, z) in at_feet.nodes.items():
        assert_allclose(at_sea.nodes[name], (x, y, z - 45.0), atol=1e-9)
    # the same matrices but for the rounding of differences of coordinates
    assert_allclose(frequencies(at_sea), frequencies(at_feet), rtol=1e-9)


def test_braces_bay_by_bay(tmp_path: Path) -> None:
    thick = "{outer_diameter_m: 0.9, thickness_m: 0.03}"
    members = {m.name: m for m in jacket(tmp_path, brace=f"[{thick}, {TUBE}]").members}
    assert members["brace_1_1_1"].section_start.outer_diameter_m == 0.9
    assert members["mud_brace_1"].section_start.outer_diameter_m == 0.9
    assert members["brace_1_2_1"].section_start.outer_diameter_m == 0.8
    same = jacket(tmp_path, brace=f"[{TUBE}, {TUBE}]")
    assert same.members == jacket(tmp_path).members
    with pytest.raises(InputError, match="one a bay") as refused:
        jacket(tmp_path, brace=f"[{TUBE}]")
    assert refused.value.field == "jacket.lattice.brace"


def test_what_hangs_on_the_legs_keeps_its_mass_and_its_centre(tmp_path: Path) -> None:
    landing_of_leg_1 = "{mass_kg: 60000, bottom_z_m: 40, top_z_m: 52, legs: [1]}"
    anodes_of_all = "{mass_kg: 9000, bottom_z_m: 0, top_z_m: 62}"
    hung = f"  appurtenances: {{landing: {landing_of_leg_1}, anodes: {anodes_of_all}}}"
    structure = jacket(tmp_path, more=hung)
    landing = [m for m in structure.masses if m.part == "landing"]
    assert all(m.node.startswith("leg_1_") for m in landing)
    total = sum(m.mass_kg for m in landing)
    assert total == pytest.approx(60000.0)
    centre = sum(m.mass_kg * structure.nodes[m.node][2] for m in landing) / total
    assert centre == pytest.approx(46.0)
    assert sum(m.mass_kg for m in structure.masses if m.part == "anodes") == pytest.approx(9000.0)
    assert sum(m.mass_kg for m in structure.masses if m.part == "rna") == 675000.0
    assert frequencies(structure)[0] < frequencies(jacket(tmp_path))[0]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("{mass_kg: 1, bottom_z_m: 5, top_z_m: 1}", "levels are reversed"),
        ("{mass_kg: 1, bottom_z_m: -90, top_z_m: -80}", "lies beyond the legs"),
        ("{mass_kg: 1, bottom_z_m: 0, top_z_m: 9, legs: [4]}", "no such leg"),
    ],
)
def test_what_cannot_hang_there_is_refused(tmp_path: Path, given: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        jacket(tmp_path, more=f"  appurtenances: {{it: {given}}}")
    assert str(refused.value.field).startswith("jacket.appurtenances.it")


def test_bodies_and_settings_around_a_jacket_count(tmp_path: Path) -> None:
    around = "masses: [{node: tp_top, mass_kg: 50000}]\nsubdivide: 2\nbeam: timoshenko"
    structure = jacket(tmp_path, around=around)
    assert [m.mass_kg for m in structure.masses if m.node == "tp_top"] == [50000.0]
    assert (structure.subdivide, structure.beam) == (2, "timoshenko")
