"""Structures as users write them, and what they mistype."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure, shipped_structures
from jackettwin.errors import InputError

FRAME = """
name: frame
sea_level_z_m: 3.0
materials:
  dense: {youngs_modulus_pa: 2.1e11, poisson_ratio: 0.3, density_kg_m3: 8500}
sections:
  leg: {outer_diameter_m: 1.2, thickness_m: 0.04}
  top: {outer_diameter_m: 0.8, thickness_m: 0.03}
nodes:
  a: [0, 0, 0]
  b: [0, 0, 10]
  c: [4, 0, 10]
members:
  - {name: post, nodes: [a, b], sections: [leg, top], material: dense, part: jacket}
masses:
  - {node: c, mass_kg: 1e4, cg_offset_m: [0, 0, 1], inertia_about_cg_kg_m2: [1e3, 1e3, 1e3, 0, 0, 0]}
rigid_links:
  - {leader: b, follower: c}
reaction_nodes: [a]
interface_nodes: [c]
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "frame.yaml"
    path.write_text(text)
    return path


def test_explicit_form(tmp_path: Path) -> None:
    s = read_structure(written(tmp_path, FRAME))
    assert (s.name, s.sea_level_z_m, s.reaction_nodes, s.interface_nodes) == ("frame", 3.0, ("a",), ("c",))
    post = s.members[0]
    assert (post.section_start.outer_diameter_m, post.section_end.outer_diameter_m) == (1.2, 0.8)
    assert post.material.density_kg_m3 == 8500.0
    assert s.masses[0].cg_offset_m == (0.0, 0.0, 1.0)


def test_relative_path_is_relative_to_the_folder(tmp_path: Path) -> None:
    written(tmp_path, FRAME)
    assert read_structure("frame.yaml", folder=tmp_path).name == "frame"


def test_shipped_structures_read() -> None:
    assert "jacket15" in shipped_structures()
    for name in shipped_structures():
        assert read_structure(name).members


def test_body_by_moments_about_its_node(tmp_path: Path) -> None:
    old = "cg_offset_m: [0, 0, 1], inertia_about_cg_kg_m2: [1e3, 1e3, 1e3, 0, 0, 0]"
    new = "static_moment_kg_m: [0, 0, 1e4], inertia_about_node_kg_m2: [1.1e4, 1.1e4, 1e3, 0, 0, 0]"
    a = read_structure(written(tmp_path, FRAME)).masses[0]
    b = read_structure(written(tmp_path, FRAME.replace(old, new))).masses[0]
    np.testing.assert_allclose(b.cg_offset_m, a.cg_offset_m)
    np.testing.assert_allclose(b.inertia_kg_m2, a.inertia_kg_m2)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("thickness_m: 0.04", "thickness_m: -0.04", r"sections.leg.thickness_m: .*-0.04.*0 < .*metres"),
        ("thickness_m: 0.04", "thickness_m: .nan", r"sections.leg.thickness_m.*finite"),
        ("thickness_m: 0.04", "thickness_m: thick", r"sections.leg.thickness_m.*got 'thick'"),
        ("thickness_m: 0.04", "thicknes_m: 0.04", r"unknown key .*did you mean 'thickness_m'"),
        ("outer_diameter_m: 1.2", "outer_diameter_m: 1e300", "sections.leg.outer_diameter_m: out of range"),
        ("b: [0, 0, 10]", "b: [0, 0, 0]", r"members.post: member has zero length .got \['a', 'b'\]"),
        ("b: [0, 0, 10]", "b: [0, 0, 1e999]", "nodes.b"),
        ("b: [0, 0, 10]", "b: [0, 0, 10000]", "members.post: member is too long .got 10000.*a and b.*metres"),
        ("b: [0, 0, 10]", "b: [0, 0]", "nodes.b"),
        ("c: [4, 0, 10]", "c: [4, 0, 10]\n  d: [9, 9, 9]", "nodes.d: node is not connected.*'d'.*join it"),
        ("nodes: [a, b]", "nodes: [a, z]", "members.post: no such node .got 'z'"),
        ("sections: [leg, top]", "sections: [leg, tip]", "members.0.section: no such section .*'top'"),
        ("sections: [leg, top], ", "", "members.0: give section or sections"),
        ("material: dense", "material: dens", "members.0.material: no such material .got 'dens'.*'dense'"),
        ("mass_kg: 1e4", "mass_kg: -1e4", r"masses.0.mass_kg.*≥ 0|masses.0.mass_kg.*greater"),
        ("[1e3, 1e3, 1e3, 0, 0, 0]", "[1e3, 1e3, -1e3, 0, 0, 0]", "masses.0.inertia_about_cg_kg_m2"),
        ("node: c, mass_kg: 1e4", "node: q, mass_kg: 1e4", "masses: no such node .got 'q'"),
        ("follower: c", "follower: a", "reaction_nodes|nodes.c"),
        ("reaction_nodes: [a]", "reaction_nodes: [a, a]", "reaction_nodes: reaction node is given twice"),
        ("poisson_ratio: 0.3", "poisson_ratio: 0.7", "materials.dense.poisson_ratio.*0.7.*< 0.5"),
        ("density_kg_m3: 8500", "density_kg_m3: 8.5", "too small to be in this unit .got 8.5.*has 7850"),
        ("density_kg_m3: 8500", "density_kg_m3: 1e30", "materials.dense.density_kg_m3: out of range"),
        ("name: frame", "name: frame\nname: again", "line 3.*'name' is given twice"),
        ("name: frame", "name: [", "mend the YAML"),
        ("name: frame", "jacket: {}", "jacket"),
        ("name: frame", "subdivide: 0", "subdivide"),
        ("name: frame", "beam: bernoulli", "beam"),
    ],
)  # fmt: skip
def test_mistakes_name_file_field_value_and_remedy(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in FRAME
    with pytest.raises(InputError, match=message) as caught:
        read_structure(written(tmp_path, FRAME.replace(old, new, 1)))
    assert "frame.yaml" in str(caught.value)


@pytest.mark.parametrize("text", ["", "- a\n- b\n", "3", "name: empty\n"])
def test_files_that_hold_no_structure_are_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match="frame.yaml"):
        read_structure(written(tmp_path, text))


def test_missing_files_and_names(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such structure file"):
        read_structure(tmp_path / "gone.yaml")
    with pytest.raises(InputError, match="no such structure .got 'jacket51'.*did you mean 'jacket15'"):
        read_structure("jacket51")
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(InputError, match="not UTF-8 text"):
        read_structure(tmp_path / "binary.yaml")
    with pytest.raises(InputError, match="cannot read|no such"):
        read_structure(tmp_path)


JACKET = """
jacket:
  lattice:
    base_width_m: 28
    top_width_m: 14
    height_m: 62
    bays: 2
    leg_diameter_m: 1.4
    leg_thickness_bottom_m: 0.045
    leg_thickness_top_m: 0.035
    brace: [{outer_diameter_m: 0.81, thickness_m: 0.021}, {outer_diameter_m: 0.82, thickness_m: 0.022}]
  transition_piece:
    top_z_m: 70
    tube: {outer_diameter_m: 2.0, thickness_m: 0.06}
    column: {outer_diameter_m: 7.5, thickness_m: 0.08}
    material: {density_kg_m3: 7850}
  tower:
    height_m: 95
    bottom: {outer_diameter_m: 7.5, thickness_m: 0.046}
    top: {outer_diameter_m: 5.5, thickness_m: 0.025}
  appurtenances:
    landing: {mass_kg: 2e4, bottom_z_m: 40, top_z_m: 50, legs: [1]}
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("leg_thickness_bottom_m: 0", "leg_thickness_bottom_m: -0", "lattice.leg_thickness_bottom_m: .*-0.0"),
        ("leg_thickness_top_m: 0", "leg_thickness_top_m: -0", "lattice.leg_thickness_top_m: .*-0.035"),
        ("thickness_m: 0.022", "thickness_m: -0.022", "lattice.brace.1.thickness_m: .*-0.022"),
        ("thickness_m: 0.022", "thicknes_m: 0.022", "lattice.brace.1.thicknes_m: unknown key.*'thickness_m'"),
        ("thickness_m: 0.06}", "thickness_m: -0.06}", "transition_piece.tube.thickness_m: .*-0.06"),
        ("thickness_m: 0.08}", "thickness_m: -0.08}", "transition_piece.column.thickness_m: .*-0.08"),
        ("density_kg_m3: 7850", "density_kg_m3: 7.85", "transition_piece.material.density_kg_m3.*has 7850"),
        ("thickness_m: 0.046", "thickness_m: -0.046", "tower.bottom.thickness_m: .*-0.046"),
        ("thickness_m: 0.025", "thickness_m: -0.025", "tower.top.thickness_m: .*-0.025"),
        ("height_m: 95", "elements: 0\n    height_m: 95", "tower.elements: out of range .got 0.*1 to 1000"),
        ("bays: 2", "bays: 3", "lattice.brace: out of range .got 2.*one section, or 3"),
        ("height_m: 62", "height_m: tall", "lattice.height_m: not a number .got 'tall'"),
        ("height_m: 62", "heigth_m: 62", "lattice.heigth_m: unknown key.*did you mean 'height_m'"),
        ("base_width_m: 28\n", "legs: 4\n", "lattice.base_width_m: required key is missing"),
        ("top_z_m: 70", "top_z_m: 60", "transition_piece.top_z_m: out of range .got 60.*= 62"),
        ("top_z_m: 50", "top_z_m: 30", "appurtenances.landing.bottom_z_m: levels are reversed"),
        ("legs: [1]", "legs: [5]", "appurtenances.landing.legs: no such leg .got 5.; allowed: 1 to 4"),
        ("legs: [1]", "legs: [0]", "appurtenances.landing.legs.0: .*allowed: ≥ 1"),
        ("mass_kg: 2e4", "mass_kg: -2e4", "appurtenances.landing.mass_kg: .*allowed: 0 to 1e.09"),
        ("mass_kg: 2e4", "mass_kg: true", "appurtenances.landing.mass_kg: not a number .got True"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_jacket_names_the_key_as_it_was_written(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    assert old in JACKET
    assert read_structure(written(tmp_path, JACKET)).reactions
    with pytest.raises(InputError, match=f"frame.yaml: jacket.{message}"):
        read_structure(written(tmp_path, JACKET.replace(old, new, 1)))
