"""Welds of a structure's joints: which joint each brace has by its neighbours."""

from math import radians

import pytest

from jackettwin.checks import joint_plans
from jackettwin.fatigue import BraceTube, TubularJoint, concentration, joint_stresses
from jackettwin.structure import Material, Section, Structure, assemble
from jackettwin.structure.model import Member, Reaction

CHORD, BRACE = Section(2.0, 0.06), Section(0.5, 0.02)


def test_three_braces_in_a_plane_are_a_kt_joint() -> None:
    """Of 45°, 90° and 45° on a chord of 2 m, stated in another order than they stand in.

    Their axes meet the chord's wall 1 m apart; halves of 0.25 and 0.25/sin 45° leave the gaps.
    """
    nodes = {"below": (0.0, 0.0, -9.0), "joint": (0.0, 0.0, 0.0), "above": (0.0, 0.0, 9.0)}
    ends = {"middle": (9.0, 0.0, 0.0), "high": (9.0, 0.0, 9.0), "low": (9.0, 0.0, -9.0)}
    tubes = [("chord_1", "below", "joint", CHORD), ("chord_2", "joint", "above", CHORD)]
    tubes += [(name, "joint", name, BRACE) for name in ends]
    members = tuple(Member(name, a, b, tube, tube, Material(), "jacket") for name, a, b, tube in tubes)
    structure = Structure("kt", nodes | ends, members, reactions=(Reaction("below"),))
    (joint,) = joint_stresses(structure, joint_plans(assemble(structure), 355e6))
    braces = tuple(BraceTube(0.5, 0.02, radians(angle)) for angle in (45.0, 90.0, 45.0))
    gap = 1.0 - 0.25 - 0.25 * 2.0**0.5
    alone = TubularJoint(2.0, 0.06, 9.0, braces, 0.7, gaps_m=(gap, gap))
    (outer, middle, _), _ = concentration(alone, "kt")
    found = {weld.brace: weld.factors["k"] for weld in joint.welds}
    for name, expected in (("low", outer), ("middle", middle), ("high", outer)):
        assert found[name] == pytest.approx(expected, rel=1e-9)
