"""Structures with one property changed: marine growth weighs what it is."""

from __future__ import annotations

from math import pi

import pytest

from jackettwin.errors import InputError
from jackettwin.structure import (
    Beam,
    Material,
    Member,
    Reaction,
    Section,
    Structure,
    adjusted,
    assemble,
    check,
)
from jackettwin.structure.sections import rectangular_section


def mast(*, sea_level_z_m: float) -> Structure:
    """A tube of 2 m from the bed to 40 m, upside down in its file, and a beam across its top."""
    tube, steel = Section(2.0, 0.05), Material()
    members = (
        Member("leg", "top", "foot", tube, tube, steel, "jacket"),
        Member("arm", "top", "end", tube, tube, steel, "jacket"),
    )
    nodes = {"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 40.0), "end": (10.0, 0.0, 40.0)}
    return Structure("mast", nodes, members, reactions=(Reaction("foot"),), sea_level_z_m=sea_level_z_m)


@pytest.mark.parametrize(("sea_level_z_m", "wet_m"), [(-1.0, 0.0), (25.0, 25.0), (40.0, 50.0), (90.0, 50.0)])
def test_growth_is_a_ring_on_what_stands_in_water(sea_level_z_m: float, wet_m: float) -> None:
    """1325 kg/m³ · π t (D + t) of every metre below still water, by hand."""
    bare = mast(sea_level_z_m=sea_level_z_m)
    grown = adjusted(bare, "part", "jacket", "growth_m", 0.1)
    added = check(assemble(grown)).mass_kg - check(assemble(bare)).mass_kg
    assert added == pytest.approx(1325.0 * pi * 0.1 * 2.1 * wet_m, rel=1e-9, abs=1e-6)


def test_growth_is_not_negative() -> None:
    with pytest.raises(InputError, match=r"growth_m: growth is not negative \(got -0.1\); allowed: >= 0 m"):
        adjusted(mast(sea_level_z_m=25.0), "part", "jacket", "growth_m", -0.1)


def box_frame(*, density_kg_m3: float = 0.0) -> Structure:
    """A leg of two elements under a girder of box section and a tube beside it, both ``deck``."""
    steel, plate = Material(), Material(density_kg_m3=density_kg_m3)
    tube = Section(2.0, 0.05)
    box = rectangular_section(1.0, 2.0, 0.05, poisson_ratio=0.3)
    nodes = {"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 20.0), "end": (6.0, 0.0, 20.0)}
    nodes["far"] = (0.0, 4.0, 20.0)
    return Structure(
        "frame",
        nodes,
        (
            Member("leg", "foot", "top", tube, Section(1.0, 0.04), steel, "leg", elements=2),
            Member("strut", "top", "far", tube, tube, plate, "deck"),
        ),
        reactions=(Reaction("foot", (True,) * 6),),
        beams=(Beam("girder", "top", "end", box, plate, part="deck"),),
    )


@pytest.mark.parametrize(("part", "density"), [("deck", 0.0), ("deck", 7850.0), ("leg", 0.0)])
def test_added_mass_weighs_what_it_is_on_tubes_and_other_sections(part: str, density: float) -> None:
    """Members of a number of elements of their own, cones and boxes alike; both of the deck take some."""
    bare = box_frame(density_kg_m3=density)
    loaded = adjusted(bare, "part", part, "added_mass_kg", 5000.0)
    added = check(assemble(loaded)).mass_kg - check(assemble(bare)).mass_kg
    assert added == pytest.approx(5000.0, rel=1e-9)
    for old, new in zip(bare.bars, loaded.bars, strict=True):
        assert (new.material.density_kg_m3 > old.material.density_kg_m3) == (old.part == part)


@pytest.mark.parametrize(("what", "value"), [("wall_thickness", 1.1), ("growth_m", 0.05)])
def test_what_only_tubes_have_is_refused_and_what_can_change_is_named(what: str, value: float) -> None:
    with pytest.raises(InputError, match=r"of another section \(got 'girder'\)") as refused:
        adjusted(box_frame(density_kg_m3=7850.0), "part", "deck", what, value)
    for named in str(refused.value.allowed).split(", "):
        adjusted(box_frame(density_kg_m3=7850.0), "part", "deck", named, 1.1)
