"""What a structure refuses to be."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.structure import Material, Section, Structure
from jackettwin.structure.model import STEEL, Member, PointMass, Reaction, RigidLink

TUBE = Section(1.0, 0.02)
NODES = {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 5.0), "c": (1.0, 0.0, 5.0)}


def member(name: str, start: str, end: str) -> Member:
    return Member(name, start, end, TUBE, TUBE, STEEL, part="leg")


def structure(**changes: object) -> Structure:
    given = {"name": "s", "nodes": NODES, "members": (member("m1", "a", "b"), member("m2", "b", "c"))}
    return Structure(**(given | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"members": (member("m1", "a", "b"),)}, "nodes.c: node is not connected.*got 'c'.*join it"),
        ({"members": (member("m1", "a", "x"),)}, "members.m1: no such node .got 'x'"),
        ({"members": (member("m1", "a", "b"), member("m1", "b", "c"))}, "members.m1: two members have"),
        ({"members": ()}, "a structure needs members"),
        ({"nodes": NODES | {"b": (0.0, 0.0, 0.0)}}, "members.m1: member has zero length"),
        ({"nodes": NODES | {"b": (0.0, 0.0, np.nan)}}, "nodes.b.coordinate: out of range .got nan"),
        ({"nodes": NODES | {"b": (0.0, 0.0, 1e9)}}, "nodes.b.coordinate: out of range"),
        ({"rigid_links": (RigidLink("a", "b"), RigidLink("b", "c"))}, "rigid_links: .*chain.*got 'b'"),
        (
            {"rigid_links": (RigidLink("a", "c"), RigidLink("b", "c"))},
            "rigid_links: .*share a follower",
        ),
        ({"rigid_links": (RigidLink("a", "a"),)}, "rigid_links: .*loop"),
        ({"rigid_links": (RigidLink("a", "x"),)}, "rigid_links: no such node"),
        (
            {"rigid_links": (RigidLink("b", "a"),), "reactions": (Reaction("a"),)},
            "reaction_nodes: .*follows another.*got 'a'",
        ),
        ({"reactions": (Reaction("a"), Reaction("a"))}, "reaction_nodes: reaction node is given twice"),
        ({"reactions": (Reaction("x"),)}, "reaction_nodes: no such node"),
        ({"interface_nodes": ("x",)}, "interface_nodes: no such node"),
        ({"masses": (PointMass("x", 1.0),)}, "masses: no such node"),
    ],
)
def test_bad_structures_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        structure(**changes)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Section(-1.0, 0.01), "outer_diameter_m: out of range .got -1.0."),
        (lambda: Section(1.0, 0.0), "thickness_m: thickness must be positive and at most the radius"),
        (lambda: Section(1.0, 0.6), "allowed: 0 < thickness_m ≤ 0.5"),
        (lambda: Section(np.nan, 0.1), "outer_diameter_m: out of range .got nan"),
        (lambda: Section(1.0, np.nan), "thickness_m: "),
        (lambda: Section(1e200, 1.0), "outer_diameter_m: out of range"),
        (lambda: Material(0.0, 1e9, 7850.0), "youngs_modulus_pa: out of range"),
        (lambda: Material(2e11, 8e10, -1.0), "density_kg_m3: out of range"),
        (lambda: PointMass("a", -1.0), "mass_kg: out of range"),
        (lambda: PointMass("a", np.inf), "mass_kg: out of range"),
        (lambda: PointMass("a", 1.0, (np.nan, 0.0, 0.0)), "cg_offset_m: out of range"),
        (
            lambda: PointMass("a", 1.0, inertia_kg_m2=(1.0, 1.0, -1.0, 0, 0, 0)),
            "inertia_kg_m2: .*not be negative",
        ),
        (lambda: PointMass("a", 1.0, inertia_kg_m2=(1.0, 1.0, 1.0, 2.0, 0, 0)), "inertia_kg_m2"),
        (lambda: PointMass("a", 1.0, inertia_kg_m2=(np.nan, 1.0, 1.0, 0, 0, 0)), "inertia_kg_m2"),
    ],
)
def test_bad_parts_are_refused(make, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_a_rigid_link_connects() -> None:
    s = structure(members=(member("m1", "a", "b"),), rigid_links=(RigidLink("b", "c"),))
    assert s.top_node == "b"


def test_a_structure_is_a_value() -> None:
    s = structure()
    soft = s.with_material("leg", youngs_modulus=0.5, density=2.0)
    assert s.members[0].material == STEEL
    changed = soft.members[0].material
    assert changed.youngs_modulus_pa == 0.5 * STEEL.youngs_modulus_pa
    assert changed.density_kg_m3 == 2.0 * STEEL.density_kg_m3
    assert changed.poisson_ratio == pytest.approx(0.3)
    with pytest.raises(InputError, match="no such part .got 'arm'.; allowed: leg"):
        s.with_material("arm")
