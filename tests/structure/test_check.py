"""The model check."""

from dataclasses import replace

import numpy as np
import pytest
from tests.response.conftest import DECK, monopile_structure

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.structure import Section, assemble, check
from jackettwin.structure.check import posture, rigid_body_motion
from jackettwin.structure.model import STEEL, Beam, Material, PointMass
from jackettwin.structure.two_node import BeamSection


def test_reference_jacket() -> None:
    """Total mass 3578 t (four digits); nothing to complain about; gravity changes no count."""
    for gravity in (False, True):
        found = check(assemble(read_structure("jacket15"), gravity=gravity))
        assert found.mass_kg == pytest.approx(3578e3, rel=2e-4)
        assert found.rigid_body_modes == 6
        assert found.warnings == ()


def test_deck_has_the_centre_of_gravity_that_subdyn_prints() -> None:
    """OpenFAST v5.0.0: mass 1977742 kg, CM (0, −1.850090E-04, −6.946016E+00) m."""
    found = check(assemble(read_structure(DECK)))
    assert found.mass_kg == pytest.approx(1977742.0, rel=1e-6)
    np.testing.assert_allclose(found.center_of_mass_m, [0.0, -1.850090e-4, -6.946016], rtol=1e-4, atol=1e-6)


def test_mass_of_a_support_is_told_apart() -> None:
    """An SSI file's matrix belongs to the ground: neither the mass nor its centre is the steel's."""
    structure = monopile_structure()
    alone = check(assemble(structure))
    ground = tuple(tuple(row) for row in np.diag([3e5, 3e5, 2e5, 1e6, 1e6, 1e6]).tolist())
    foot = replace(structure.reactions[0], mass=ground)
    found = check(assemble(replace(structure, reactions=(foot,))))
    assert alone.support_mass_kg == 0.0
    assert found.support_mass_kg == pytest.approx(2e5)
    assert found.mass_kg == pytest.approx(alone.mass_kg, rel=1e-12)
    np.testing.assert_allclose(found.center_of_mass_m, alone.center_of_mass_m, rtol=1e-9, atol=1e-9)


def test_centre_of_gravity_in_closed_form() -> None:
    structure = monopile_structure()
    found = check(assemble(structure))
    pile = np.pi * (7.0 - 0.07) * 0.07 * 7850.0 * 120.0
    total = pile + 5e5
    assert found.mass_kg == pytest.approx(total, rel=1e-12)
    expected = (-3.0 * 5e5 / total, 0.0, (60.0 * pile + 122.0 * 5e5) / total)
    np.testing.assert_allclose(found.center_of_mass_m, expected, rtol=1e-12, atol=1e-12)


def test_rigid_motion_stores_no_energy_with_rigid_links_too() -> None:
    for structure in (read_structure("jacket15"), read_structure(DECK), monopile_structure()):
        assembly = assemble(structure)
        motion = rigid_body_motion(assembly)
        force = assembly.stiffness @ motion
        # rounding of K times metres of lever arm
        assert np.abs(force).max() < 1e-9 * np.abs(assembly.stiffness).max() * np.abs(motion).max()


@pytest.mark.parametrize(
    ("section", "material", "message"),
    [
        (Section(1.0, 0.2), STEEL, r"diameter over wall thickness outside 10 to 300: m0, m1.*and 1 more"),
        (Section(7.0, 0.01), STEEL, "diameter over wall thickness"),
        (Section(50.0, 0.5), STEEL, "shorter than half the diameter"),
        (Section(7.0, 0.07), Material(210e9, 81e9, 0.0), "without mass"),
        (Section(7.0, 0.07), Material(210e6, 81e6, 7850.0), "Young's modulus below 1 GPa"),
        (Section(7.0, 0.07), Material(210e9, 81e9, 7.85), "density below 500"),
        (Section(7.0, 0.07), Material(210e9, 210e9, 7850.0), "Poisson's ratio outside 0 to 0.5"),
    ],
)
def test_absurd_sections_are_named(section: Section, material: Material, message: str) -> None:
    import re

    base = monopile_structure()
    members = tuple(
        replace(m, section_start=section, section_end=section, material=material) for m in base.members
    )
    warnings = check(assemble(replace(base, members=members))).warnings
    assert len(warnings) == 1 and re.match(message, warnings[0])


def test_a_structure_without_mass_is_refused() -> None:
    base = monopile_structure()
    members = tuple(replace(m, material=Material(210e9, 81e9, 0.0)) for m in base.members)
    weightless = replace(base, members=members, masses=(PointMass("n6", 0.0),))
    with pytest.raises(InputError, match="the structure has no mass"):
        check(assemble(weightless))


@pytest.mark.parametrize(
    ("turned", "sea", "said"), [(-1.0, 0.0, "upside down"), (1.0, 480.0, "below still water"), (1.0, 0.0, "")]
)
def test_what_hangs_or_is_drowned_is_said(turned: float, sea: float, said: str) -> None:
    base = monopile_structure()
    nodes = {name: (x, y, turned * z) for name, (x, y, z) in base.nodes.items()}
    found = posture(replace(base, nodes=nodes, sea_level_z_m=sea))
    assert len(found) == bool(said) and all(said in text for text in found)


def test_a_nacelle_in_tonnes_is_noticed() -> None:
    """430 where kilograms belong: √(9e7/430) = 457 m, and nothing beside a jacket."""
    structure = read_structure("jacket15")
    light = PointMass(structure.top_node, 430.0, inertia_kg_m2=(9e7, 5e7, 5e7, 0.0, 0.0, 0.0))
    first, second = check(assemble(structure.with_masses((light,)))).warnings
    assert first.startswith("radius of gyration of 457 m")
    assert "next to nothing" in second


def test_a_member_given_twice_is_named_with_its_twin() -> None:
    base = monopile_structure()
    first = base.members[0]
    again = replace(first, name="again", start=first.end, end=first.start)
    (warning,) = check(assemble(replace(base, members=(*base.members, again)))).warnings
    assert warning == f"between the same two nodes (is it given twice?): {first.name} and again"


@pytest.mark.parametrize(("I_x", "odd"), [(500.0, True), (0.4, False), (1e-7, True)])
def test_a_section_that_cannot_be_is_named(I_x: float, *, odd: bool) -> None:
    """0.3 m² with 500 m⁴ has a radius of gyration of 41 m, with 0.4 m⁴ one of 1.2 m."""
    base = monopile_structure()
    first = base.members[0]
    section = BeamSection(0.3, 0.1, 0.1, I_x, 0.04, I_x + 0.04, 0.08)
    beam = Beam("girder", first.start, first.end, section, STEEL)
    warnings = check(assemble(replace(base, members=base.members[1:], beams=(beam,)))).warnings
    assert bool(warnings) == odd
    assert all("radius of gyration of the section" in w and w.endswith(": girder") for w in warnings)


@pytest.mark.parametrize(("I_xx", "odd"), [(9.0e7, True), (4.0e7, False)])
def test_an_inertia_that_no_mass_has_is_named(I_xx: float, *, odd: bool) -> None:
    """About its principal axes: one moment is at most the sum of the others, as of a plate."""
    structure = monopile_structure()
    body = PointMass(structure.top_node, 2.6e5, inertia_kg_m2=(I_xx, 2.0e7, 2.0e7, 0.0, 0.0, 0.0))
    warnings = check(assemble(structure.with_masses((body,)))).warnings
    assert [w.startswith(f"inertia of the body on {structure.top_node}") for w in warnings] == [True] * odd
