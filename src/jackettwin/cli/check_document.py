"""The document of ``jackettwin check``: uses of members, joints and piles, and what to beware of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.caveats import Omission, omission_documents

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.checks import BraceUse, FrameUse, GroutUse, MemberUse, SheetLine, VortexUse
    from jackettwin.soil import PileUse

FORCES_OF_SECTION = ("axial_n", "shear_y_n", "shear_z_n", "torsion_nm", "bending_y_nm", "bending_z_nm")
_HEAD = ("x_n", "y_n", "z_n", "x_nm", "y_nm", "z_nm")


def check_document(
    name: str,
    use: FrameUse,
    notes: list[str],
    missing: tuple[Omission, ...],
    *,
    piles: tuple[PileUse, ...] = (),
    grouted: tuple[GroutUse, ...] = (),
    vortices: tuple[VortexUse, ...] = (),
    sheet: tuple[SheetLine, ...] | None = None,
    combinations: Mapping[str, FrameUse] | None = None,
) -> dict[str, Any]:
    """Return the document of ``jackettwin check``, the largest uses within their rules' ranges first."""
    members = sorted(use.members, key=lambda one: (not one.covered, -one.utilisation))
    joints = sorted(use.joints, key=lambda one: (bool(one.joint.beyond_validity), -one.utilisation))
    return {
        "structure": name,
        "largest_von_mises_stress_pa": max(one.von_mises_pa for one in use.members),
        "members": [_row(one) for one in members],
        "joints": [_joint_row(one) for one in joints],
        "combinations": [_combination_row(case, one) for case, one in (combinations or {}).items()],
        "sheet": None if sheet is None else [line._asdict() for line in sheet],
        "piles": [_pile_row(one) for one in sorted(piles, key=lambda one: -max(one.axial, one.lateral))],
        "grouted": [
            _grout_row(one)
            for one in sorted(
                grouted, key=lambda one: (bool(one.connection.beyond_validity), -one.utilisation)
            )
        ],
        "vortices": [_vortex_row(one) for one in vortices],
        "warnings": [
            *_warnings(use),
            *_pile_warnings(piles),
            *_grout_warnings(grouted),
            *_vortex_warnings(vortices),
            *notes,
        ],
        "left_out": omission_documents(missing),
    }


def _combination_row(case: str, use: FrameUse) -> dict[str, Any]:
    """Return the largest uses of a combination within the ranges of their rules."""
    members = [one for one in use.members if one.covered]
    joints = [one for one in use.joints if not one.joint.beyond_validity]
    member = max(members, key=lambda one: one.utilisation, default=None)
    joint = max(joints, key=lambda one: one.utilisation, default=None)
    return {
        "combination": case,
        "member": None if member is None else member.member,
        "utilisation": None if member is None else member.utilisation,
        "joint": None if joint is None else f"{joint.brace} at {joint.node}",
        "joint_utilisation": None if joint is None else joint.utilisation,
    }


def _row(use: MemberUse) -> dict[str, Any]:
    from jackettwin.checks import ALL_CHECKS

    worst = use.worst
    return {
        "member": use.member,
        "part": use.part,
        "utilisation": use.utilisation,
        "check": use.check,
        "clause": ALL_CHECKS[use.check],
        "by_check": dict(use.by_check),
        "effective_length_factor": use.buckling.K,
        "column_length_m": use.buckling.L,
        "governing": {"position": worst.position} | _forces(worst.forces),
        "start": _forces(worst.end_forces[0]),
        "end": _forces(worst.end_forces[1]),
        "von_mises_stress_pa": use.von_mises_pa,
        "covered": use.covered,
        "beyond_validity": list(use.beyond_validity),
        "combination": use.case or None,
    }


def _forces(six: FloatArray) -> dict[str, float]:
    return dict(zip(FORCES_OF_SECTION, map(float, six), strict=True))


def _joint_row(use: BraceUse) -> dict[str, Any]:
    from jackettwin.checks import KINDS

    joint = use.joint
    return {
        "node": use.node,
        "chord": use.chord,
        "brace": use.brace,
        "utilisation": use.utilisation,
        "kind": use.kind,
        "shares": dict(zip(KINDS, use.shares, strict=True)),
        "axial_n": use.forces[0],
        "in_plane_nm": use.forces[1],
        "out_of_plane_nm": use.forces[2],
        "strength_factor": use.Q_u,
        "chord_factor": use.Q_f,
        "beta": joint.beta,
        "gamma": joint.gamma,
        "tau": joint.t / joint.T,
        "theta_deg": float(np.degrees(joint.theta)),
        "gap_m": joint.gap if np.isfinite(joint.gap) else None,
        "beyond_validity": list(joint.beyond_validity),
        "can_factor": joint.can_factor,
        "can_short_m": joint.can_short_m,
        "to_brace": use.to_brace if np.isfinite(use.to_brace) else None,
        "combination": use.case or None,
    }


def _pile_row(use: PileUse) -> dict[str, Any]:
    steel, capacity = use.steel, use.capacity
    return {
        "foot": use.foot,
        "axial_utilisation": use.axial,
        "lateral_utilisation": use.lateral,
        "capacity_compression_n": capacity.compression_n,
        "capacity_tension_n": capacity.tension_n,
        "plugged": capacity.plugged,
        "stands": use.stands,
        "head_displacement_m": use.head_m,
        "head_rotation_rad": use.rotation_rad,
        "steel_utilisation": None if steel is None else steel.utilisation,
        "steel_check": None if steel is None else steel.check,
        "steel_depth_m": use.steel_depth_m,
        "steel_forces": None if steel is None else _forces(steel.worst.forces),
        "head_force": dict(zip(_HEAD, map(float, use.force), strict=True)),
        "combination": use.case or None,
    }


def _pile_warnings(uses: tuple[PileUse, ...]) -> list[str]:
    from jackettwin.structure import few

    over = [use.foot for use in uses if use.stands and use.worst > 1.0]
    fallen = [use.foot for use in uses if not use.stands]
    found = [f"piles used above 1: {few(over)}"] if over else []
    return found + ([f"the ground cannot carry the piles of {few(fallen)}"] if fallen else [])


def _grout_row(use: GroutUse) -> dict[str, Any]:
    one = use.connection
    return {
        "foot": use.foot,
        "utilisation": use.utilisation,
        "governs": use.governs,
        "axial_n": use.axial_n,
        "stress_pa": use.stress_pa,
        "sliding_pa": one.sliding_pa,
        "shear_pa": one.shear_pa,
        "radial_stiffness": one.radial_stiffness,
        "effective_length_m": one.effective_length_m,
        "beyond_validity": list(one.beyond_validity),
        "combination": use.case or None,
    }


def _grout_warnings(uses: tuple[GroutUse, ...]) -> list[str]:
    from jackettwin.structure import few

    over = [use.foot for use in uses if use.utilisation > 1.0 and not use.connection.beyond_validity]
    beyond = list(dict.fromkeys(why for use in uses for why in use.connection.beyond_validity))
    found = [f"grout used above 1: {few(over)}"] if over else []
    return found + ([f"grout beyond the tests of ISO 19902 15.1: {few(beyond)}"] if beyond else [])


def _vortex_row(use: VortexUse) -> dict[str, Any]:
    from jackettwin.checks import CLAUSES

    return {
        **use._asdict(),
        "onset_m_s": use.onset_m_s,
        "locks_in": list(use.locks_in),
        "lock_in_m_s": list(use.lock_in_m_s),
        "ratio": use.ratio,
        "excites": use.direction,
        "clause": CLAUSES[use.medium],
    }


def _vortex_warnings(uses: tuple[VortexUse, ...]) -> list[str]:
    from jackettwin.checks import CLAUSES
    from jackettwin.structure import few

    found = []
    for medium, clause in CLAUSES.items():
        names = [use.member for use in uses if use.medium == medium and use.ratio >= 1.0]
        if names:
            found.append(f"vortices may excite members in {medium} ({clause}): {few(names)}")
    return found


def _warnings(use: FrameUse) -> list[str]:
    from jackettwin.structure import few

    # rows beyond a rule's range are last in the tables and not in the headline
    outside = [one for one in use.members if not one.covered]
    over = [one.member for one in use.members if one.covered and one.utilisation > 1.0]
    joints = [
        f"{one.brace} at {one.node}"
        for one in use.joints
        if one.utilisation > 1.0 and not one.joint.beyond_validity
    ]
    short = [f"{one.brace} at {one.node}" for one in use.joints if one.joint.can_short_m > 0.0]
    beyond = [(f"{one.brace} at {one.node}", why) for one in use.joints for why in one.joint.beyond_validity]
    found = []
    if outside:
        found.append(
            f"beyond ISO 19902 13.1: {few([f'{one.member} ({one.beyond_validity[0]})' for one in outside])}"
        )
    if over:
        found.append(f"used above 1: {few(over)}")
    if joints:
        found.append(f"joints used above 1: {few(joints)}")
    if short:
        found.append(f"cans shorter than ISO 19902 14.2.2 asks: {few(short)}")
    if beyond:
        named = few(list(dict.fromkeys(name for name, _ in beyond)))
        found.append(f"joints beyond the ranges of ISO 19902 14.3.1 ({beyond[0][1]}, …): {named}")
    return found
