"""Vortices: the frequency of a run by the structure's own beams, the code's limits on both sides."""

from dataclasses import replace
from math import pi, sqrt

import pytest

from jackettwin.checks import VortexUse, vortex_uses
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import Support, clamped
from jackettwin.structure import STEEL, Member, Reaction, Section, Structure, assemble

TUBE = Section(0.5, 0.02)


def portal(sea_level_z_m: float) -> Structure:
    """Two stiff legs, and between them a brace in two pieces: one run of 20 m."""
    leg = Section(2.0, 0.1)
    nodes = {"a": (0.0, 0.0, 0.0), "A": (0.0, 0.0, 10.0), "b": (20.0, 0.0, 0.0), "B": (20.0, 0.0, 10.0)}
    nodes["m"] = (10.0, 0.0, 10.0)
    members = (
        Member("left", "a", "A", leg, leg, STEEL),
        Member("right", "b", "B", leg, leg, STEEL),
        Member("brace_1", "A", "m", TUBE, TUBE, STEEL),
        Member("brace_2", "m", "B", TUBE, TUBE, STEEL),
    )
    return Structure(
        "portal", nodes, members, reactions=(Reaction("a"), Reaction("b")), sea_level_z_m=sea_level_z_m
    )


def brace(uses):
    return next(use for use in uses if use.member == "brace_1")


def test_frequency_is_that_of_a_pinned_beam_of_the_whole_run() -> None:
    use = brace(vortex_uses(portal(-1.0), wind_m_s=10.0, first_frequency_hz=1.0))
    nodes = {f"n{k}": (20.0 * k / 8, 0.0, 0.0) for k in range(9)}
    members = tuple(Member(f"m{k}", f"n{k}", f"n{k + 1}", TUBE, TUBE, STEEL) for k in range(8))
    held = Support(fixed=(("n0", (0, 1, 2, 3)), ("n8", (1, 2))))
    f = undamped_modes(build_system(assemble(Structure("beam", nodes, members)), held), 1).frequency_hz[0]
    assert use.frequency_hz == pytest.approx(float(f), rel=3e-5)  # (π/8)⁴/1440 of eight elements


def test_water_slows_it_by_its_mass_and_the_water_inside() -> None:
    dry = brace(vortex_uses(portal(-1.0), wind_m_s=1.0, first_frequency_hz=1.0))
    wet = brace(vortex_uses(portal(30.0), current_m_s=1.0, first_frequency_hz=1.0))
    steel = 7850.0 * (0.5**2 - 0.46**2)
    water = 1025.0 * (0.5**2 + 0.46**2)
    assert dry.frequency_hz / wet.frequency_hz == pytest.approx(sqrt(1.0 + water / steel), rel=1e-12)
    assert (dry.medium, wet.medium) == ("air", "water")


@pytest.mark.parametrize(("share", "excites"), [(0.999, "none"), (1.001, "across")])
def test_limit_in_air(share: float, excites: str) -> None:
    """EN 1991-1-4:2005 E.1.2(2): nothing to be shown where v_crit = fD/0.18 > 1.25 v_m."""
    at_one = brace(vortex_uses(portal(-1.0), wind_m_s=1.0, first_frequency_hz=1.0))
    critical = at_one.frequency_hz * 0.5 / 0.18
    use = brace(vortex_uses(portal(-1.0), wind_m_s=share * critical / 1.25, first_frequency_hz=1.0))
    assert use.direction == excites
    assert use.onset_m_s == pytest.approx(critical / 1.25)


@pytest.mark.parametrize(
    ("V_R", "excites"), [(0.99, "none"), (1.01, "in line"), (2.9, "in line"), (3.1, "across")]
)
def test_limits_in_water(V_R: float, excites: str) -> None:
    """DNV-RP-C205 (2010), section 9: in line from a reduced velocity of 1, across from 3."""
    f = brace(vortex_uses(portal(30.0), current_m_s=1.0, first_frequency_hz=1.0)).frequency_hz
    use = brace(vortex_uses(portal(30.0), current_m_s=V_R * f * 0.5, first_frequency_hz=1.0))
    assert use.direction == excites
    assert use.reduced_velocity == pytest.approx(V_R)


@pytest.mark.parametrize(
    ("medium", "V_R", "ways"),
    [
        ("water", 0.9, ()), ("water", 2.0, ("in line",)), ("water", 4.0, ("in line", "across")),
        ("water", 5.0, ("across",)), ("water", 17.0, ()),
        ("air", 1.6, ()), ("air", 2.5, ("in line",)), ("air", 4.0, ()), ("air", 6.0, ("across",)),
    ],
)  # fmt: skip
def test_lock_in_by_reduced_velocity(medium: str, V_R: float, ways: tuple[str, ...]) -> None:
    use = VortexUse("m", "", medium, 0.5, 2.0, V_R, 1.0)
    assert use.locks_in == ways
    low, high = use.lock_in_m_s
    assert low < high
    assert ("across" in ways) is (low <= V_R <= high)  # f D is 1 m/s


def test_tower_has_the_frequency_of_the_structure_and_media_are_left_out_one_by_one() -> None:
    structure = read_structure("jacket15")
    f = float(undamped_modes(build_system(assemble(structure), clamped(structure)), 1).frequency_hz[0])
    dry = vortex_uses(structure, wind_m_s=20.0, first_frequency_hz=f)
    wet = vortex_uses(structure, current_m_s=1.0, first_frequency_hz=f)
    towers = [use for use in dry if use.part == "tower"]
    assert towers
    assert all(use.frequency_hz == f for use in towers)
    assert {use.medium for use in dry} == {"air"}
    assert {use.medium for use in wet} == {"water"}
    assert len(dry) + len(wet) == len(structure.members)
    assert [use.ratio for use in wet] == sorted((use.ratio for use in wet), reverse=True)


def test_stretching_all_lengths_and_speeds_changes_nothing() -> None:
    """V_R of geometrically similar structures in the same flow is the same: f D is unchanged."""
    small, scale = portal(-1.0), 3.0
    nodes = {name: tuple(scale * x for x in xyz) for name, xyz in small.nodes.items()}
    tube = {name: Section(scale * D, scale * t) for name, D, t in (("leg", 2.0, 0.1), ("brace", 0.5, 0.02))}
    grown = []
    for m in small.members:
        section = tube["brace" if m.name.startswith("brace") else "leg"]
        grown.append(replace(m, section_start=section, section_end=section))
    large = replace(small, nodes=nodes, members=tuple(grown), sea_level_z_m=-3.0)
    one, other = (brace(vortex_uses(s, wind_m_s=9.0, first_frequency_hz=1.0)) for s in (small, large))
    assert other.reduced_velocity == pytest.approx(one.reduced_velocity, rel=1e-12)
    assert one.reduced_velocity == pytest.approx(9.0 / (one.frequency_hz * 0.5))


def test_mode_formula_by_hand() -> None:
    """π/(2L²) √(EI/m) of a solid bar of 20 m: I/A = D²/16."""
    structure = portal(-1.0)
    solid = Section(0.5, 0.25)
    bars = tuple(
        replace(m, section_start=solid, section_end=solid) if m.name.startswith("brace") else m
        for m in structure.members
    )
    use = brace(vortex_uses(replace(structure, members=bars), wind_m_s=1.0, first_frequency_hz=1.0))
    assert use.frequency_hz == pytest.approx(pi / 800.0 * sqrt(210e9 / 7850.0) * 0.5 / 4.0)


@pytest.mark.parametrize(
    ("flow", "field"), [({"wind_m_s": -1.0}, "wind"), ({"current_m_s": 11.0}, "current")]
)
def test_speeds_out_of_range(flow: dict[str, float], field: str) -> None:
    with pytest.raises(InputError, match="out of range") as failure:
        vortex_uses(portal(0.0), **flow, first_frequency_hz=1.0)
    assert failure.value.field == field
