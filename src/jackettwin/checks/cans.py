r"""Chord cans: length of the thick tube at a joint, the required length, and the reduction for a short one.

ISO 19902 (2007), 14.2.2: a can reaches a quarter of the chord's diameter or 300 mm beyond the braces. 14.3.5:
of a short can the axial strength of Y and X joints is

.. math:: P_d = \left[r + (1 - r)(T_n/T_c)^2\right] P_{d,can}, \qquad r = \frac{L_c}{2.5 D},\;
   \frac{(4β - 3) L_c}{1.5 D} \text{ from } β = 0.9, \text{ at most } 1
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jackettwin.checks.joint_check import JointPlan, MemberEnd
from jackettwin.errors import require
from jackettwin.structure import Member, Structure

_LEAST_M = 0.3
"""Reach beyond a brace that 14.2.2 asks of a narrow chord."""
_SAME = 1e-6
"""Relative difference of walls that are one drawn thickness."""


class Can(NamedTuple):
    """Reach of the thick tube from the node to its nearer end, and wall of the thinner one beyond [m].

    Without a thinner tube beyond, ``reach`` is infinite and ``wall`` that of the chord.
    """

    reach: float
    wall: float


def chord_can(structure: Structure, plan: JointPlan) -> Can:
    """Return the can of a joint: tubes in line with the chord until the wall gets thinner."""
    T = plan.joints[0].T
    sides = [_reach(structure, end, plan.node, T) for end in plan.chord]
    thinner = [side for side in sides if np.isfinite(side.reach)]
    if not thinner:
        return Can(np.inf, T)
    return Can(min(side.reach for side in thinner), min(side.wall for side in thinner))


def _reach(structure: Structure, end: MemberEnd, node: str, T: float) -> Can:
    """Return how far one side of a chord keeps its wall, and the wall beyond."""
    member, here, reached = end.member, node, 0.0
    seen = {member.name}
    while True:
        away, near, far = _oriented(structure, member, here)
        if min(near, far) < T * (1.0 - _SAME):
            return Can(reached, min(near, far))
        reached += float(np.linalg.norm(away))
        here = member.end if member.start == here else member.start
        following = _next(structure, member, here, away, seen)
        if following is None:
            return Can(np.inf, T)
        member = following
        seen.add(member.name)


def _oriented(structure: Structure, member: Member, node: str) -> tuple[np.ndarray, float, float]:
    """Return a member's way from a node [m] and its walls there and at its other end [m]."""
    starts = member.start == node
    a, b = (member.start, member.end) if starts else (member.end, member.start)
    walls = member.section_start.thickness_m, member.section_end.thickness_m
    near, far = walls if starts else walls[::-1]
    return np.subtract(structure.nodes[b], structure.nodes[a]), near, far


def _next(structure: Structure, member: Member, node: str, away: np.ndarray, seen: set[str]) -> Member | None:
    """Return the tube that goes on in line from a node."""
    for other in structure.members:
        if node in (other.start, other.end) and other.name not in seen:
            on = _oriented(structure, other, node)[0]
            if float(on @ away) > 0.99 * float(np.linalg.norm(on) * np.linalg.norm(away)):
                return other
    return None


def can_factor(*, D: float, beta: float, length: float, thinner: float) -> float:
    """Return what a can of ``length`` [m] leaves of Y and X joints' axial strength; ``thinner`` is T_n/T_c.

    >>> can_factor(D=1.0, beta=0.5, length=1.25, thinner=0.5)
    0.625
    """
    require(0.0 < thinner <= 1.0, "out of range", field="thinner", value=thinner, allowed="above 0, to 1")
    share = length / (2.5 * D) if beta <= 0.9 else (4.0 * beta - 3.0) * length / (1.5 * D)
    r = float(np.clip(share, 0.0, 1.0)) if np.isfinite(length) else 1.0
    return r + (1.0 - r) * thinner**2


def with_cans(structure: Structure, plan: JointPlan) -> JointPlan:
    """Return a joint whose braces know their can: what it costs, and how much longer it ought to be [m]."""
    can = chord_can(structure, plan)
    joints = []
    for joint in plan.joints:
        # the part about a brace's own axis, as long on both sides as on the shorter one
        factor = can_factor(D=joint.D, beta=joint.beta, length=2.0 * can.reach, thinner=can.wall / joint.T)
        beyond = can.reach - 0.5 * joint.d / np.sin(joint.theta)
        wanted = max(0.25 * joint.D, _LEAST_M)
        joints.append(replace(joint, can_factor=factor, can_short_m=max(0.0, wanted - beyond)))
    return replace(plan, joints=tuple(joints))
