"""Structures with one property changed: marine growth weighs what it is."""

from __future__ import annotations

from math import pi

import pytest

from jackettwin.errors import InputError
from jackettwin.structure import (
    Material,
    Member,
    Reaction,
    Section,
    Structure,
    adjusted,
    assemble,
    check,
)


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
