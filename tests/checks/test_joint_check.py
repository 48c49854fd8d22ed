"""Which tubes are chord and brace, and what forces reach their joint."""

import numpy as np
import pytest

from jackettwin.checks.iso19902_joints import BraceForces, Joint, joint_use
from jackettwin.checks.joint_check import joint_plans
from jackettwin.checks.member_check import DesignBasis, frame_use
from jackettwin.decks import read_structure
from jackettwin.response.motion.static import nodal_load, static_displacement
from jackettwin.response.system import build_system
from jackettwin.soil.support import clamped
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member, Reaction

LEG, BRACE = Section(1.0, 0.025), Section(0.5, 0.015)


def frame(**tips: tuple[float, float, float]) -> Structure:
    """Return a leg of 20 m with braces from its middle to the tips."""
    nodes = {"foot": (0.0, 0.0, 0.0), "mid": (0.0, 0.0, 10.0), "top": (0.0, 0.0, 20.0), **tips}
    members = [
        Member("low", "foot", "mid", LEG, LEG, STEEL, "jacket"),
        Member("high", "mid", "top", LEG, LEG, STEEL, "jacket"),
        *(Member(f"to_{tip}", "mid", tip, BRACE, BRACE, STEEL, "jacket") for tip in tips),
    ]
    return Structure("frame", nodes, tuple(members), reactions=(Reaction("foot"),))


def used(structure: Structure, basis: DesignBasis | None = None, **forces: tuple[float, ...]):
    assembly = assemble(structure)
    load = nodal_load(assembly, forces)
    u = static_displacement(build_system(assembly, clamped(structure)), load)
    return {use.brace: use for use in frame_use(assembly, u, basis).joints}


def test_a_t_joint_from_statics_to_use() -> None:
    """1 MN along a cantilever brace across the leg, and 10 kN across it at 5 m: out of plane or in plane.

    The leg below carries nothing of the first but its moment, the leg above nothing.
    """
    structure = frame(tip=(5.0, 0.0, 10.0))
    joint = Joint(1.0, 0.025, 0.5, 0.015, 0.5 * np.pi, 355e6, 355e6)
    for load, in_plane, out_of_plane in (((1e6, 0.0, 1e4), 5e4, 0.0), ((1e6, 1e4, 0.0), 0.0, 5e4)):
        use = used(structure, tip=load)["to_tip"]
        assert use.joint.theta == pytest.approx(0.5 * np.pi)
        assert (use.node, use.chord, use.shares) == ("mid", "low", (0.0, 1.0, 0.0))
        np.testing.assert_allclose(np.abs(use.forces), (1e6, in_plane, out_of_plane), atol=1.0)
        chord_axial = np.array([load[2]])
        chord_bending = np.array([np.hypot(5.0 * load[1], 5.0 * load[2])])
        if load[1]:
            # what turns the leg about its own axis does not bend it
            chord_bending = np.zeros(1)
        own = BraceForces(*(np.array([v]) for v in (1e6, in_plane, out_of_plane)))
        wanted = joint_use(joint, own, np.array([[0.0], [1.0], [0.0]]), chord_axial, chord_bending)
        assert use.utilisation == pytest.approx(float(wanted.utilisation[0]), rel=1e-6)


def test_a_k_joint_and_its_gap() -> None:
    """Braces at 45° up and down, axes meeting: g = 2·(R cot θ) − d/sin θ = 1 − 0.70711 = 0.29289 m."""
    structure = frame(up=(5.0, 0.0, 15.0), down=(5.0, 0.0, 5.0))
    uses = used(structure, up=(1e5, 0.0, 1e5), down=(-1e5, 0.0, 1e5))
    for name in ("to_up", "to_down"):
        assert uses[name].joint.gap == pytest.approx(0.29289, abs=1e-5)
        assert uses[name].kind == "K"
        assert uses[name].shares[0] == pytest.approx(1.0)
    # conservative: X is weaker than K for any β, and the use grows
    weakest = used(
        structure, DesignBasis(conservative_joints=True), up=(1e5, 0.0, 1e5), down=(-1e5, 0.0, 1e5)
    )
    assert weakest["to_up"].utilisation > uses["to_up"].utilisation


def test_braces_on_both_sides_cross() -> None:
    """Both pull from opposite sides: X; the widest run is the chord, whatever its order."""
    structure = frame(left=(-5.0, 0.0, 10.0), right=(5.0, 0.0, 10.0))
    uses = used(structure, left=(-1e6, 0.0, 0.0), right=(1e6, 0.0, 0.0))
    assert set(uses) == {"to_left", "to_right"}
    for use in uses.values():
        assert use.shares == pytest.approx((0.0, 0.0, 1.0), abs=1e-6)
        assert np.isnan(use.joint.gap)


def test_the_jacket_s_joints() -> None:
    """jacket15: X braces cross in 16 nodes; its tower, one tube on another, has no joint of clause 14."""
    plans = joint_plans(assemble(read_structure("jacket15")), 355e6)
    crossings = [plan for plan in plans if plan.node.startswith("cross")]
    assert len(crossings) == 16
    for plan in crossings:
        assert len(plan.chord) == len(plan.braces) == 2
        np.testing.assert_allclose(plan.across[0], -plan.across[1], atol=1e-9)
    assert not any("tower" in plan.node for plan in plans)


def test_the_worst_instant_of_every_joint() -> None:
    """Over a history the worst is that of its worst case alone."""
    structure = frame(tip=(5.0, 0.0, 10.0))
    assembly = assemble(structure)
    load = nodal_load(assembly, {"tip": (1e6, 1e4, 0.0)})
    u = static_displacement(build_system(assembly, clamped(structure)), load)
    history = np.array([0.5, -1.0, 0.2])[:, None] * u
    worst, alone = frame_use(assembly, history).joints[0], frame_use(assembly, -u).joints[0]
    assert worst.utilisation == pytest.approx(alone.utilisation)
