"""Check of every member of a structure by ISO 19902, from static or time-domain displacements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.checks.cans import with_cans
from jackettwin.checks.columns import columns
from jackettwin.checks.iso19902 import (
    CHECKS,
    HIGHEST_YIELD_PA,
    HIGHEST_YIELD_RATIO,
    MOST_SLENDER_WALL,
    THINNEST_WALL_M,
    Strength,
    Stress,
    Tube,
    strength,
    utilisation,
)
from jackettwin.checks.iso19902_joints import YIELD_OF_TENSILE
from jackettwin.checks.iso19902_pressure import PRESSURE_CHECKS, HoopStrength, hoop_strength, pressure_use
from jackettwin.checks.joint_check import BraceUse, JointPlan, joint_plans, joint_uses, worst_joints
from jackettwin.checks.member_classes import K_OF_CLASS, OTHER, column_lengths, member_classes
from jackettwin.errors import InputError
from jackettwin.structure import Assembly, SectionForces, section_forces, tube_radius, von_mises_stress

ALL_CHECKS = CHECKS | PRESSURE_CHECKS
"""Checks of a member and their clauses; those under pressure only where there is some."""
_BLOCK = 512
"""Instants checked at a time."""


@dataclass(frozen=True)
class DesignBasis:
    """Settings of the check of members.

    Attributes
    ----------
    yield_strength_pa : float
    edition : {"2007", "2020"}
    C_m : float
        Moment reduction factor; table 13.5-1 allows less than 1.
    K : mapping of part or member name to effective length factor
        On the length between joints that hold a member; unless given, 2 for a cantilever and 1 for everything
        else (table 13.5-1 allows 0.7 to 0.8 for braces).
    conservative_joints : bool
        Take the weakest of K, Y and X for every brace instead of its load path.
    tensile_strength_pa : float or None
        Of the chords, whose yield strength counts up to 0.8 of it at joints (14.2.3).
    by_class : bool
        Give braces the effective lengths of their class (table 13.5-1) where ``K`` says nothing.
    joints_at_face : bool
        Take the braces' forces where they meet the chord's wall instead of at the node.
    """

    yield_strength_pa: float = 355e6
    edition: str = "2007"
    C_m: float = 1.0
    K: Mapping[str, float] = field(default_factory=dict)
    conservative_joints: bool = False
    tensile_strength_pa: float | None = None
    by_class: bool = False
    joints_at_face: bool = False

    @property
    def chord_yield_pa(self) -> float:
        """Yield strength of a chord at its joints [Pa]."""
        if self.tensile_strength_pa is None:
            return self.yield_strength_pa
        return min(self.yield_strength_pa, YIELD_OF_TENSILE * self.tensile_strength_pa)


class Buckling(NamedTuple):
    """Effective length factor, and length [m] of the column a member is part of."""

    K: float
    L: float


@dataclass(frozen=True)
class Worst:
    """Where along a member, and under which forces, its governing check is worst.

    Attributes
    ----------
    position : float
        0 at the member's start, 1 at its end.
    forces : (6,) array
        N, Vy, Vz, T, My, Mz there [N, N·m].
    end_forces : (2, 6) array
        The same at the member's start and end at that instant.
    tube : Tube
        The section that is checked there; of a cone the middle of its element.
    pressure_pa : float
        Of the water outside over what is inside.
    """

    position: float
    forces: FloatArray
    end_forces: FloatArray
    tube: Tube
    pressure_pa: float


@dataclass(frozen=True)
class MemberUse:
    """The worst check of a member over both ends of its elements and all instants."""

    member: str
    part: str
    utilisation: float
    check: str
    by_check: Mapping[str, float]
    buckling: Buckling
    worst: Worst
    von_mises_pa: float
    """Largest von Mises stress, whatever the governing check [Pa]."""
    beyond_validity: tuple[str, ...] = ()
    """In which respects it is outside the scope of clause 13 (13.1)."""
    case: str = ""
    """The combination of actions it is of."""

    @property
    def covered(self) -> bool:
        """Whether clause 13 covers it: otherwise its use is no headline."""
        return not self.beyond_validity


@dataclass(frozen=True)
class FrameUse:
    """The worst use of every member and of every brace's joint."""

    members: tuple[MemberUse, ...] = ()
    joints: tuple[BraceUse, ...] = ()

    def named(self, case: str) -> FrameUse:
        """Return the same uses, of a combination of actions with this name."""
        return FrameUse(
            tuple(replace(one, case=case) for one in self.members),
            tuple(replace(one, case=case) for one in self.joints),
        )

    def worse(self, other: FrameUse) -> FrameUse:
        """Return the worst use over both sets of cases."""
        if not self.members:
            return other
        return FrameUse(worst_uses(self.members, other.members), worst_joints(self.joints, other.joints))


def frame_use(
    assembly: Assembly,
    displacement: FloatArray,
    basis: DesignBasis | None = None,
    *,
    along: FloatArray | None = None,
    pressure: FloatArray | None = None,
) -> FrameUse:
    """Return the use of every member and of every brace's joint.

    Parameters
    ----------
    displacement : (..., assembly.n_dof) of one load case, many, or every instant of a record [m, rad]
    along : (n_elements, 12) or one for every case, optional
        Loads spread along the elements, as for ``section_forces``.
    pressure : (n_elements, 2), optional
        Of water outside over what is inside, at both ends of the elements [Pa].

    Raises
    ------
    InputError
        If the edition is unknown, or nothing is a tube.
    """
    basis = DesignBasis() if basis is None else basis
    if not assembly.structure.members:
        raise InputError(
            "no member is a tube",
            field="members",
            allowed="circular tubes (MType 1c)",
            remedy="check other sections by their own code",
        )
    plans = joint_plans(assembly, basis.chord_yield_pa)
    check = _MemberCheck(assembly, basis, pressure, plans)
    plans = tuple(with_cans(assembly.structure, plan) for plan in plans)
    cases = displacement.reshape(-1, assembly.n_dof)
    spread = None if along is None else along.reshape(-1, *along.shape[-2:])
    worst = FrameUse()
    for first in range(0, len(cases), _BLOCK):  # records are long
        here = slice(first, first + _BLOCK)
        loads = spread if spread is None or len(spread) == 1 else spread[here]
        forces = section_forces(assembly, cases[here], along=loads)
        members, section = check.uses(forces)
        joints = joint_uses(
            assembly,
            plans,
            forces,
            conservative=basis.conservative_joints,
            at_face=basis.joints_at_face,
            section_use=section,
        )
        worst = worst.worse(FrameUse(members, joints))
    return worst


class _MemberCheck:
    """Tubes, strengths and pressure of all members, which are the same at every instant."""

    def __init__(
        self,
        assembly: Assembly,
        basis: DesignBasis,
        pressure: FloatArray | None,
        plans: tuple[JointPlan, ...],
    ) -> None:
        self.assembly, self.basis = assembly, basis
        self.lengths = buckling_lengths(assembly, basis, plans)
        self.tube = _tubes(assembly, basis, self.lengths)
        self.strength: Strength = strength(self.tube)
        self.pressure = pressure if pressure is not None and (pressure > 0.0).any() else None
        spacing = np.array([L for _, L in self.lengths])[assembly.mesh.member][:, None]
        self.hoop: HoopStrength = hoop_strength(self.tube, spacing)

    def uses(self, forces: SectionForces) -> tuple[tuple[MemberUse, ...], FloatArray]:
        """Return the use of members under section forces, and of all sections (n_cases, n_elements, 2)."""
        stress, basis = section_stress(self.assembly, forces), self.basis
        U = [*utilisation(self.strength, stress, C_m=basis.C_m, edition=basis.edition)]
        if self.pressure is not None:
            under = pressure_use(
                self.tube, self.strength, self.hoop, stress, self.pressure[None], C_m=basis.C_m
            )
            U += [np.broadcast_to(one, U[0].shape) for one in under]
        section = U[list(CHECKS).index("section")]
        return self._uses(np.stack(U), forces), section

    def _uses(self, U: FloatArray, forces: SectionForces) -> tuple[MemberUse, ...]:
        """Return the use of every member from U, (n_checks, n_cases, n_elements, 2)."""
        uses, mesh = [], self.assembly.mesh
        stress = von_mises_stress(self.assembly, forces).reshape(-1, mesh.start.size, 2)
        for index, member in enumerate(self.assembly.structure.members):
            mine = np.flatnonzero(mesh.member == index)
            own = U[:, :, mine]
            check, case, element, end = np.unravel_index(int(own.argmax()), own.shape)
            N = np.stack([component[case, mine] for component in forces], axis=-1)
            at = mine[element]
            worst = Worst(
                float(element + end) / mine.size,
                N[element, end],
                np.stack([N[0, 0], N[-1, 1]]),
                Tube(*(row[at, 0] for row in self.tube)),
                0.0 if self.pressure is None else float(self.pressure[at, end]),
            )
            uses.append(
                MemberUse(
                    member.name,
                    member.part,
                    float(own.max()),
                    list(ALL_CHECKS)[check],
                    dict(zip(ALL_CHECKS, map(float, own.max(axis=(1, 2, 3))), strict=False)),
                    self.lengths[index],
                    worst,
                    float(stress[:, mine].max()),
                    self._beyond(mine),
                )
            )
        return tuple(uses)

    def _beyond(self, elements: IntArray) -> tuple[str, ...]:
        """Return in which respects some elements are outside the scope of clause 13 (13.1)."""
        basis = self.basis
        slender, wall = float((self.tube.D / self.tube.t)[elements].max()), float(self.tube.t[elements].min())
        f_y, f_u = basis.yield_strength_pa, basis.tensile_strength_pa
        ranges = (
            (slender <= MOST_SLENDER_WALL, f"D/t = {slender:.0f} is above {MOST_SLENDER_WALL:.0f}"),
            (wall >= THINNEST_WALL_M, f"t = {1e3 * wall:.1f} mm is below {1e3 * THINNEST_WALL_M:.0f} mm"),
            (f_y <= HIGHEST_YIELD_PA, f"f_y = {f_y / 1e6:.0f} MPa is above {HIGHEST_YIELD_PA / 1e6:.0f} MPa"),
            (f_u is None or f_y <= HIGHEST_YIELD_RATIO * f_u, f"f_y is above {HIGHEST_YIELD_RATIO:g} f_u"),
        )
        return tuple(words for holds, words in ranges if not holds)


def worst_uses(first: tuple[MemberUse, ...], second: tuple[MemberUse, ...]) -> tuple[MemberUse, ...]:
    """Return the use of every member over two sets of cases."""
    found = []
    for a, b in zip(first, second, strict=True):
        worse = a if a.utilisation >= b.utilisation else b
        by_check = {name: max(a.by_check[name], b.by_check[name]) for name in a.by_check}
        stress = max(a.von_mises_pa, b.von_mises_pa)
        found.append(replace(worse, by_check=by_check, von_mises_pa=stress))
    return tuple(found)


def buckling_lengths(assembly: Assembly, basis: DesignBasis, plans: tuple[JointPlan, ...]) -> list[Buckling]:
    """Return K and L of every member."""
    runs = columns(assembly.structure)
    classes = member_classes(plans) if basis.by_class else {}
    length = column_lengths(plans, runs) if basis.by_class else {}
    found = []
    for m in assembly.structure.members:
        own = 2.0 if runs[m.name].is_cantilever else K_OF_CLASS.get(classes.get(m.name, OTHER), 1.0)
        K = basis.K.get(m.name, basis.K.get(m.part, own))
        found.append(Buckling(K, length.get(m.name, runs[m.name].length_m)))
    return found


def section_stress(assembly: Assembly, forces: SectionForces) -> Stress:
    """Return nominal stresses at both ends of every element, each (..., n_elements, 2) [Pa]."""
    p = assembly.mesh.properties
    D, _ = _dimensions(assembly)
    Z_e = (2.0 * p.I / D)[:, None]
    return Stress(
        forces.axial / p.A[:, None],
        forces.bending_y / Z_e,
        forces.bending_z / Z_e,
        2.0 * forces.shear / p.A[:, None],
        forces.torsion * (0.5 * D / p.J)[:, None],
    )


def _dimensions(assembly: Assembly) -> tuple[FloatArray, FloatArray]:
    """Return outer diameter and wall of every element from its area and second moment."""
    p = assembly.mesh.properties
    D, inner = 2.0 * tube_radius(p), 8.0 * p.I / p.A - 2.0 * p.A / np.pi
    return D, 0.5 * (D - np.sqrt(np.maximum(inner, 0.0)))


def _tubes(assembly: Assembly, basis: DesignBasis, lengths: list[Buckling]) -> Tube:
    """Return every element's tube, (n_elements, 1)."""
    KL = np.array([K * L for K, L in lengths])[assembly.mesh.member]
    D, t = _dimensions(assembly)
    rows = (D, t, assembly.mesh.properties.E, np.full_like(D, basis.yield_strength_pa), KL)
    return Tube(*(row[:, None] for row in rows))
