"""Check of a structure's tubular joints by ISO 19902, clause 14: their geometry and utilisation."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.checks.iso19902_joints import (
    GAMMA_Z,
    IN_PLANE,
    KINDS,
    BraceForces,
    Joint,
    JointUse,
    joint_use,
    load_path,
)
from jackettwin.structure import PILES, Assembly, Member, Section, SectionForces, Structure

_STRAIGHT = float(np.cos(np.radians(10.0)))
"""Tubes within 10° of one line carry on as a chord: a leg may break its batter at a node."""
_SHARPEST = float(np.radians(5.0))
"""Tubes at a smaller angle to a chord run beside it and make no joint of clause 14."""


class MemberEnd(NamedTuple):
    """A member's end at a node: its section there, its direction away from the node, and its mesh element."""

    member: Member
    section: Section
    away: FloatArray
    element: int
    at_end: int


@dataclass(frozen=True)
class JointPlan:
    """A node where braces meet a chord.

    Attributes
    ----------
    chord : one or two ends in line
    braces : the ends that stand on it
    across : (n_braces, 3) unit vectors from the chord, normal to it
    joints : shape of each brace's joint
    centre_m, half_m : (n_braces,) where braces meet the chord's wall, along the chord from the node, and half
        the length over which they do
    """

    node: str
    chord: tuple[MemberEnd, ...]
    braces: tuple[MemberEnd, ...]
    across: FloatArray
    joints: tuple[Joint, ...]
    centre_m: FloatArray
    half_m: FloatArray


@dataclass(frozen=True)
class BraceUse:
    """Utilisation of a joint by a brace at the worst instant.

    Attributes
    ----------
    shares : of its axial force as a K, Y and X joint
    forces : axial (tension positive), in-plane, out-of-plane [N, N·m], at the node
    """

    node: str
    chord: str
    brace: str
    joint: Joint
    utilisation: float
    shares: tuple[float, float, float]
    forces: tuple[float, float, float]
    Q_u: float
    Q_f: float
    to_brace: float = np.nan
    """γ_z U_j over the use of the brace's own section there, (14.3-13): at most 1 at a critical joint."""
    case: str = ""
    """The combination of actions it is of."""
    chord_sides: tuple[tuple[float, float], ...] = ()
    """Axial force and resultant moment of the chord on every side of the node at that instant [N, N·m]."""

    @property
    def kind(self) -> str:
        """K, Y or X by the largest share."""
        return KINDS[int(np.argmax(self.shares))]


def joint_plans(assembly: Assembly, yield_strength_pa: float) -> tuple[JointPlan, ...]:
    """Return the tubular joints of a structure.

    The chord is the straight run through a node with the widest, then thickest tube, or else the widest tube
    that ends there. Axes that meet in the node make the gap between braces.
    """
    found = []
    for node, ends in _ends(assembly).items():
        chord = _chord(ends)
        braces = tuple(e for e in ends if all(e is not c for c in chord))
        if not chord or not braces:
            continue
        plan = _plan(node, chord, braces, yield_strength_pa)
        if plan is not None:
            found.append(plan)
    return tuple(found)


def _ends(assembly: Assembly) -> dict[str, list[MemberEnd]]:
    """Return the ends of members by node."""
    structure, mesh = assembly.structure, assembly.mesh
    of: dict[str, list[MemberEnd]] = defaultdict(list)
    for k, m in enumerate(structure.members):
        if m.part == PILES:  # grouted to a leg or sleeve: no welded joint of tubes
            continue
        mine = np.flatnonzero(mesh.member == k)
        along = _unit(structure, m)
        of[m.start].append(MemberEnd(m, m.section_start, along, int(mine[0]), 0))
        of[m.end].append(MemberEnd(m, m.section_end, -along, int(mine[-1]), 1))
    return of


def _unit(structure: Structure, m: Member) -> FloatArray:
    along = np.subtract(structure.nodes[m.end], structure.nodes[m.start])
    return np.asarray(along / np.linalg.norm(along))


def _chord(ends: list[MemberEnd]) -> tuple[MemberEnd, ...]:
    """Return one or two ends that are the chord; none where no tube is the widest."""
    pairs = [(a, b) for i, a in enumerate(ends) for b in ends[i + 1 :] if float(a.away @ b.away) < -_STRAIGHT]
    if pairs:
        return max(pairs, key=lambda pair: min(_size(e) for e in pair))
    widest = sorted(ends, key=_size, reverse=True)
    return (widest[0],) if len(widest) > 1 and _size(widest[0]) > _size(widest[1]) else ()


def _size(end: MemberEnd) -> tuple[float, float]:
    return end.section.outer_diameter_m, end.section.thickness_m


def _plan(
    node: str, chord: tuple[MemberEnd, ...], braces: tuple[MemberEnd, ...], f_y: float
) -> JointPlan | None:
    line = chord[0].away
    cosine = np.array([float(e.away @ line) for e in braces])
    theta = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    kept = np.flatnonzero(theta > _SHARPEST)
    if kept.size == 0:
        return None
    braces, cosine, theta = tuple(braces[i] for i in kept), cosine[kept], theta[kept]
    across = np.array([e.away - c * line for e, c in zip(braces, cosine, strict=True)])
    across /= np.linalg.norm(across, axis=1)[:, None]
    D = max(e.section.outer_diameter_m for e in chord)
    T = min(e.section.thickness_m for e in chord)
    half = np.array([0.5 * e.section.outer_diameter_m for e in braces]) / np.sin(theta)
    centre = 0.5 * D / np.tan(theta) * np.sign(cosine)
    joints = []
    for i, e in enumerate(braces):
        beside = (across @ across[i] > IN_PLANE) & (np.arange(len(braces)) != i)
        gaps = np.abs(centre - centre[i]) - half - half[i]
        gap = float(gaps[beside].max()) if beside.any() else np.nan
        shape = e.section.outer_diameter_m, e.section.thickness_m, float(theta[i])
        joints.append(Joint(D, T, *shape, f_y, f_y, gap))
    return JointPlan(node, chord, braces, across, tuple(joints), centre, half)


def joint_uses(
    assembly: Assembly,
    plans: tuple[JointPlan, ...],
    forces: SectionForces,
    *,
    conservative: bool = False,
    at_face: bool = False,
    section_use: FloatArray | None = None,
) -> tuple[BraceUse, ...]:
    """Return the worst use of every brace's joint over all instants (n_cases, n_elements, 2) of forces.

    Parameters
    ----------
    at_face : bool
        Take the braces' forces where they meet the chord's wall instead of at the node.
    section_use : (n_cases, n_elements, 2), optional
        Of the members' own sections, by clause 13.
    """
    uses = []
    for plan in plans:
        own, shares = joint_forces(assembly, plan, forces, at_face=at_face)
        sides = [(e.element, e.at_end) for e in plan.chord]
        chord_axial = np.array([forces.axial[:, k, end] for k, end in sides])
        chord_bending = np.array([forces.bending[:, k, end] for k, end in sides])
        for i, (end, joint) in enumerate(zip(plan.braces, plan.joints, strict=True)):
            mine = shares[:, i]
            found = joint_use(joint, own[i], mine, chord_axial, chord_bending, conservative=conservative)
            brace = None if section_use is None else section_use[:, end.element, end.at_end]
            worst = _worst(plan, end, joint, own[i], mine, found, brace)
            at = int(found.utilisation.argmax())
            beside = zip(chord_axial[:, at], chord_bending[:, at], strict=True)
            uses.append(replace(worst, chord_sides=tuple((float(P), float(M)) for P, M in beside)))
    return tuple(uses)


def joint_forces(
    assembly: Assembly, plan: JointPlan, forces: SectionForces, *, at_face: bool = False
) -> tuple[tuple[BraceForces, ...], FloatArray]:
    """Return every brace's forces at its joint (n_cases,), and how much of them is a K, Y and X joint's.

    The shares are (3, n_braces, n_cases), by the balance of axial forces of 14.2.4.
    """
    own = brace_forces(assembly, plan, forces, at_face=at_face)
    return own, joint_shares(plan, np.array([one.axial for one in own]))


def brace_forces(
    assembly: Assembly, plan: JointPlan, forces: SectionForces, *, at_face: bool = False
) -> tuple[BraceForces, ...]:
    """Return every brace's forces at node or chord wall (n_cases,): linear in the section forces."""
    return tuple(
        _brace_forces(
            assembly, forces, end, plan.chord[0].away, 0.5 * joint.D / np.sin(joint.theta) if at_face else 0.0
        )
        for end, joint in zip(plan.braces, plan.joints, strict=True)
    )


def joint_shares(plan: JointPlan, axial: FloatArray, of: Sequence[int] | None = None) -> FloatArray:
    """Return how much of the axial forces (n_braces, n_cases) [N] of braces is a K, Y and X joint's.

    Parameters
    ----------
    of : braces whose shares are returned; all of them without it
    """
    return load_path(axial, np.array([joint.theta for joint in plan.joints]), plan.across, of)


def _brace_forces(
    assembly: Assembly, forces: SectionForces, end: MemberEnd, line: FloatArray, offset: float
) -> BraceForces:
    """Return a brace's forces ``offset`` [m] from its node: moments in their plane and out of it.

    Moments run straight from the node on, as the shear at its end makes them.
    """
    k, at = end.element, end.at_end
    mesh = assembly.mesh
    axes = mesh.axes[k]
    length = float(np.linalg.norm(mesh.coordinates[mesh.end[k]] - mesh.coordinates[mesh.start[k]]))
    share = offset / length

    def there(component: FloatArray) -> FloatArray:
        near, far = component[:, k, at], component[:, k, 1 - at]
        return np.asarray(near + share * (far - near))

    moment = np.outer(there(forces.bending_y), axes[1]) + np.outer(there(forces.bending_z), axes[2])
    normal = np.cross(line, end.away)
    normal /= np.linalg.norm(normal)
    return BraceForces(forces.axial[:, k, at], moment @ normal, moment @ np.cross(normal, end.away))


def _worst(
    plan: JointPlan,
    end: MemberEnd,
    joint: Joint,
    own: BraceForces,
    shares: FloatArray,
    found: JointUse,
    brace: FloatArray | None,
) -> BraceUse:
    at = int(found.utilisation.argmax())
    K, Y, X = (float(v) for v in shares[:, at])
    N, in_plane, out_of_plane = (float(v[at]) for v in own)
    return BraceUse(
        plan.node,
        plan.chord[0].member.name,
        end.member.name,
        joint,
        float(found.utilisation[at]),
        (K, Y, X),
        (N, in_plane, out_of_plane),
        float(found.Q_u[at]),
        float(found.Q_f[0, at]),
        np.nan if brace is None else GAMMA_Z * float(found.utilisation[at]) / max(float(brace[at]), 1e-12),
    )


def worst_joints(first: tuple[BraceUse, ...], second: tuple[BraceUse, ...]) -> tuple[BraceUse, ...]:
    """Return the worse use of every joint over two sets of cases."""
    return tuple(a if a.utilisation >= b.utilisation else b for a, b in zip(first, second, strict=True))
