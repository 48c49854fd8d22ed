"""Cans, classes of braces, forces at the chord's wall, and the other rules of clause 14."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.checks import DesignBasis, frame_use, joint_plans
from jackettwin.checks.cans import can_factor, chord_can
from jackettwin.checks.columns import columns
from jackettwin.checks.iso19902_joints import GAMMA_Z
from jackettwin.checks.joint_check import brace_forces
from jackettwin.checks.member_classes import BRACE, CROSSED, column_lengths, member_classes
from jackettwin.decks import read_structure
from jackettwin.response import build_system, nodal_load, static_displacement
from jackettwin.soil import clamped
from jackettwin.structure import Material, Member, Reaction, Section, Structure, assemble, section_forces

STEEL = Material(210e9, poisson_ratio=0.3, density_kg_m3=7850.0)
THICK, THIN, TUBE = Section(1.0, 0.05), Section(1.0, 0.025), Section(0.5, 0.02)


def tee(*, can_m: float | None = None) -> Structure:
    """Return a chord along x with a brace upwards; its can reaches ``can_m`` to both sides, or has no end."""
    nodes = {"a": (-10.0, 0.0, 0.0), "b": (10.0, 0.0, 0.0), "o": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 8.0)}
    if can_m is None:
        chord = [
            Member("left", "a", "o", THICK, THICK, STEEL),
            Member("right", "o", "b", THICK, THICK, STEEL),
        ]
    else:
        nodes |= {"c": (-can_m, 0.0, 0.0), "d": (can_m, 0.0, 0.0)}
        chord = [
            Member("left", "a", "c", THIN, THIN, STEEL),
            Member("can_left", "c", "o", THICK, THICK, STEEL),
            Member("can_right", "o", "d", THICK, THICK, STEEL),
            Member("right", "d", "b", THIN, THIN, STEEL),
        ]
    brace = Member("brace", "o", "top", TUBE, TUBE, STEEL)
    return Structure("tee", nodes, (*chord, brace), reactions=(Reaction("a"), Reaction("b")))


def use(structure: Structure, force: tuple[float, ...], basis: DesignBasis):
    assembly = assemble(structure)
    u = static_displacement(build_system(assembly, clamped(structure)), nodal_load(assembly, {"top": force}))
    return frame_use(assembly, u, basis)


@pytest.mark.parametrize(
    ("length", "beta", "factor"),
    [
        (2.5, 0.5, 1.0),
        (9.9, 0.5, 1.0),
        (0.0, 0.5, 0.25),
        (1.25, 0.9, 0.625),  # r = 1/2
        (1.5 / 0.8 / 2.0, 0.95, 0.625),  # (4·0.95 − 3)/1.5 = 0.8/1.5
    ],
)
def test_a_short_can_costs_strength_as_the_standard_says(length: float, beta: float, factor: float) -> None:
    """ISO 19902, 14.3.5, by hand, for a wall of half the can's beyond it."""
    assert can_factor(D=1.0, beta=beta, length=length, thinner=0.5) == pytest.approx(factor)


def test_cans_are_measured_along_the_chord() -> None:
    for can_m, reach, wall in ((None, np.inf, 0.05), (0.6, 0.6, 0.025), (3.0, 3.0, 0.025)):
        structure = tee(can_m=can_m)
        (plan,) = joint_plans(assemble(structure), 355e6)
        assert chord_can(structure, plan) == (pytest.approx(reach), wall)
    long, short = (use(tee(can_m=m), (0.0, 0.0, -1e6), DesignBasis()).joints[0] for m in (3.0, 0.5))
    # the brace takes 0.25 m to each side: 0.3 m beyond that are asked for
    assert (long.joint.can_short_m, short.joint.can_short_m) == (0.0, pytest.approx(0.05))
    assert short.joint.can_factor == pytest.approx(0.4 + 0.6 * 0.25)
    # chord forces differ little; a Y joint's axial strength is the factor's
    assert short.Q_u == pytest.approx(long.Q_u * short.joint.can_factor)


def test_forces_at_the_wall_are_the_moment_less_shear_times_radius() -> None:
    structure = tee()
    assembly = assemble(structure, subdivide=4)
    system = build_system(assembly, clamped(structure))
    u = static_displacement(system, nodal_load(assembly, {"top": (1e5, 0.0, 0.0)}))
    forces = section_forces(assembly, u[None])
    (plan,) = joint_plans(assembly, 355e6)
    (node,), (face,) = (brace_forces(assembly, plan, forces, at_face=at) for at in (False, True))
    assert abs(node.in_plane[0]) == pytest.approx(8e5)
    assert abs(face.in_plane[0]) == pytest.approx(7.5e5)
    assert face.axial[0] == node.axial[0]


def test_yield_counts_up_to_four_fifths_of_the_tensile_strength() -> None:
    force = (0.0, 0.0, -1e6)
    plain, brittle, ductile = (
        use(tee(), force, DesignBasis(tensile_strength_pa=f_u)).joints[0].joint.f_y
        for f_u in (None, 400e6, 500e6)
    )
    assert (plain, brittle, ductile) == (355e6, pytest.approx(320e6), 355e6)


def test_a_joint_is_compared_with_its_brace() -> None:
    """(14.3-13): γ_z U_j over the use of the brace's section at the joint."""
    found = use(tee(), (0.0, 0.0, -1e6), DesignBasis())
    brace = next(one for one in found.members if one.member == "brace")
    (joint,) = found.joints
    assert joint.to_brace == pytest.approx(GAMMA_Z * joint.utilisation / brace.by_check["section"], rel=1e-9)
    twice = use(tee(), (0.0, 0.0, -2e6), DesignBasis()).joints[0]
    assert twice.to_brace == pytest.approx(joint.to_brace, rel=0.05)


def test_braces_of_an_x_braced_jacket_are_crossed() -> None:
    """jacket15: legs and tower keep their factors, X-braces have 0.8 on the longer segment (table 13.5-1)."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    plans = joint_plans(assembly, 355e6)
    classes = member_classes(plans)
    runs = columns(structure)
    lengths = column_lengths(plans, runs)
    crossed = [name for name, kind in classes.items() if kind == CROSSED]
    assert len(crossed) >= 32
    legs = [m.name for m in structure.members if "leg" in m.name]
    assert legs and not set(legs) & set(classes)
    assert all(lengths[name] >= runs[name].length_m for name in crossed)
    assert max(lengths[name] / runs[name].length_m for name in crossed) > 1.01
    loaded = nodal_load(assembly, {structure.top_node: (2e6, 0.0, 0.0)})
    u = static_displacement(build_system(assembly, clamped(structure)), loaded)
    by_class = {one.member: one for one in frame_use(assembly, u, DesignBasis(by_class=True)).members}
    one = {o.member: o for o in frame_use(assembly, u, DesignBasis()).members}
    assert {by_class[name].buckling.K for name in crossed} == {0.8}
    assert {by_class[name].buckling.K for name in legs} == {1.0}
    for name in crossed:
        assert by_class[name].buckling.K * by_class[name].buckling.L < one[name].buckling.L * 1.2


def test_a_single_brace_on_a_chord_is_one() -> None:
    assert member_classes(joint_plans(assemble(tee()), 355e6)) == {"brace": BRACE}


def test_k_given_by_name_goes_before_the_class() -> None:
    found = use(tee(), (0.0, 0.0, -1e6), DesignBasis(by_class=True, K={"brace": 1.3}))
    assert next(o for o in found.members if o.member == "brace").buckling.K == 1.3
    assert replace(DesignBasis(), by_class=True).by_class
