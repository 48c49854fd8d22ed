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


TUBE_AS_NUMBERS = """sections:
  numbers: {shape: any, area_m2: 0.04900884539600077, second_moment_x_m4: 0.003729573134635659,
    second_moment_y_m4: 0.003729573134635659, torsion_constant_m4: 0.007459146269271318}
"""
"""A = π (D − t) t, I = A ((D/2)² + (D/2 − t)²)/4, J = 2 I of the tube 0.8 × 0.02 m."""


def test_braces_given_by_their_numbers_are_the_tubes_they_are_of(tmp_path: Path) -> None:
    tubes = jacket(tmp_path)
    bars = jacket(tmp_path, around=TUBE_AS_NUMBERS, more="  members: {'*brace_*': {section: numbers}}")
    n = sum("brace" in m.name for m in tubes.members)
    assert len(bars.beams) == n > 0 and {b.part for b in bars.beams} == {"jacket"}
    assert_allclose(
        numbered_modes(assemble(bars), 6).omega, numbered_modes(assemble(tubes), 6).omega, rtol=1e-9
    )


@pytest.mark.parametrize("which", ["leg_*", "brace_*", "tp_*"])
def test_a_section_turned_by_90_degrees_is_one_with_its_axes_exchanged(tmp_path: Path, which: str) -> None:
    """Whatever members they are of; without the turn the frequencies are others."""
    around = """sections:
  upright: {shape: any, area_m2: 0.2, second_moment_x_m4: 0.05, second_moment_y_m4: 0.01,
    torsion_constant_m4: 0.02}
  lying: {shape: any, area_m2: 0.2, second_moment_x_m4: 0.01, second_moment_y_m4: 0.05,
    torsion_constant_m4: 0.02}
"""

    def omega(words: str) -> np.ndarray:
        structure = jacket(tmp_path, around=around, more=f"  members: {{'{which}': {{{words}}}}}")
        return np.asarray(numbered_modes(assemble(structure), 8).omega)

    upright, turned = omega("section: upright"), omega("section: lying, twist_deg: 90")
    assert_allclose(turned, upright, rtol=1e-9)
    assert np.abs(omega("section: lying") / upright - 1.0).max() > 1e-3


def test_the_last_entry_that_names_a_member_counts(tmp_path: Path) -> None:
    around = """sections:
  box: {shape: box, width_m: 0.8, height_m: 0.6, thickness_m: 0.02}
  can: {outer_diameter_m: 1.6, thickness_m: 0.06}
materials: {cast: {youngs_modulus_pa: 2.0e11, density_kg_m3: 7900.0}}
"""
    more = "  members: {'brace_*': {section: box}, brace_1_1_1: {section: can, material: cast}}"
    structure = jacket(tmp_path, around=around, more=more)
    can = next(m for m in structure.members if m.name == "brace_1_1_1")
    assert (can.section_start.outer_diameter_m, can.material.density_kg_m3) == (1.6, 7900.0)
    assert {b.shape for b in structure.beams} == {"box"}


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ("{'bracing_*': {section: box}}", r"jacket\.members\.bracing_\*.*no member is named so.*brace_\*"),
        ("{'brace_*': {section: bocks}}", r"jacket\.members\.brace_\*\.section.*bocks"),
        ("{'brace_*': {}}", r"jacket\.members\.brace_\*.*give section or sections"),
        ("{'brace_*': {section: box, nodes: [a, b]}}", r"jacket\.members\.brace_\*\.nodes"),
    ],
)
def test_members_that_are_not_there_are_refused_by_name(tmp_path: Path, more: str, says: str) -> None:
    around = "sections: {box: {shape: box, width_m: 0.8, height_m: 0.6, thickness_m: 0.02}}"
    with pytest.raises(InputError, match=says):
        jacket(tmp_path, around=around, more=f"  members: {more}")
