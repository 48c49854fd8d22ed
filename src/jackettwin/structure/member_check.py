"""Every member of a structure against ISO 19902, from static or time-domain displacements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.structure.assemble import Assembly
from jackettwin.structure.columns import columns
from jackettwin.structure.forces import SectionForces, section_forces, von_mises_stress
from jackettwin.structure.iso19902 import (
    CHECKS,
    MOST_SLENDER_WALL,
    Stress,
    Tube,
    strength,
    utilisation,
)

_BLOCK = 512
"""Instants checked at a time."""


@dataclass(frozen=True)
class DesignBasis:
    """How members are checked.

    Attributes
    ----------
    yield_strength_pa : float
    edition : {"2007", "2020"}
    C_m : float
        Moment reduction factor; table 13.5-1 allows less than 1.
    K : mapping of part or member name to effective length factor
        On the length between joints that hold a member; unless given, 2 for a cantilever and 1 for everything
        else (table 13.5-1 allows 0.7 to 0.8 for braces).
    """

    yield_strength_pa: float = 355e6
    edition: str = "2007"
    C_m: float = 1.0
    K: Mapping[str, float] = field(default_factory=dict)


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
    """

    position: float
    forces: FloatArray
    end_forces: FloatArray


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
    covered: bool
    """Whether D/t ≤ 120, the scope of clause 13."""


def member_uses(
    assembly: Assembly,
    displacement: FloatArray,
    basis: DesignBasis | None = None,
    *,
    along: FloatArray | None = None,
) -> tuple[MemberUse, ...]:
    """Return the use of every member.

    Parameters
    ----------
    displacement : (..., assembly.n_dof) of one load case, many, or every instant of a record [m, rad]
    along : (n_elements, 12) or one for every case, optional
        Loads spread along the elements, as for ``section_forces``.

    Raises
    ------
    InputError
        If the edition is unknown.
    """
    basis = DesignBasis() if basis is None else basis
    lengths = buckling_lengths(assembly, basis)
    tube = _tubes(assembly, basis, lengths)
    cases = displacement.reshape(-1, assembly.n_dof)
    spread = None if along is None else along.reshape(-1, *along.shape[-2:])
    uses: tuple[MemberUse, ...] = ()
    for first in range(0, len(cases), _BLOCK):  # records are long
        here = slice(first, first + _BLOCK)
        held = spread if spread is None or len(spread) == 1 else spread[here]
        forces = section_forces(assembly, cases[here], along=held)
        U = utilisation(
            strength(tube), section_stress(assembly, forces), C_m=basis.C_m, edition=basis.edition
        )
        found = _uses(assembly, np.stack(U), forces, lengths, (tube.D / tube.t)[:, 0])
        uses = worst_uses(uses, found) if uses else found
    return uses


def worst_uses(first: tuple[MemberUse, ...], second: tuple[MemberUse, ...]) -> tuple[MemberUse, ...]:
    """Return the use of every member over two sets of cases."""
    found = []
    for a, b in zip(first, second, strict=True):
        worse = a if a.utilisation >= b.utilisation else b
        by_check = {name: max(a.by_check[name], b.by_check[name]) for name in CHECKS}
        stress = max(a.von_mises_pa, b.von_mises_pa)
        found.append(replace(worse, by_check=by_check, von_mises_pa=stress))
    return tuple(found)


def _uses(
    assembly: Assembly, U: FloatArray, forces: SectionForces, lengths: list[Buckling], slender: FloatArray
) -> tuple[MemberUse, ...]:
    """Return the use of every member from U, (n_checks, n_cases, n_elements, 2)."""
    uses = []
    stress = von_mises_stress(assembly, forces).reshape(-1, assembly.mesh.start.size, 2)
    for index, member in enumerate(assembly.structure.members):
        mine = np.flatnonzero(assembly.mesh.member == index)
        own = U[:, :, mine]
        check, case, element, end = np.unravel_index(int(own.argmax()), own.shape)
        N = np.stack([component[case, mine] for component in forces], axis=-1)
        worst = Worst(float(element + end) / mine.size, N[element, end], np.stack([N[0, 0], N[-1, 1]]))
        uses.append(
            MemberUse(
                member.name,
                member.part,
                float(own.max()),
                list(CHECKS)[check],
                dict(zip(CHECKS, map(float, own.max(axis=(1, 2, 3))), strict=True)),
                lengths[index],
                worst,
                float(stress[:, mine].max()),
                bool((slender[mine] <= MOST_SLENDER_WALL).all()),
            )
        )
    return tuple(uses)


def buckling_lengths(assembly: Assembly, basis: DesignBasis) -> list[Buckling]:
    """Return K and L of every member."""
    runs = columns(assembly.structure)
    found = []
    for m in assembly.structure.members:
        own = 2.0 if runs[m.name].is_cantilever else 1.0
        K = basis.K.get(m.name, basis.K.get(m.part, own))
        found.append(Buckling(K, runs[m.name].length_m))
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
    outer, inner = 8.0 * p.I / p.A + 2.0 * p.A / np.pi, 8.0 * p.I / p.A - 2.0 * p.A / np.pi
    D = np.sqrt(outer)
    return D, 0.5 * (D - np.sqrt(np.maximum(inner, 0.0)))


def _tubes(assembly: Assembly, basis: DesignBasis, lengths: list[Buckling]) -> Tube:
    """Return every element's tube, (n_elements, 1)."""
    KL = np.array([K * L for K, L in lengths])[assembly.mesh.member]
    D, t = _dimensions(assembly)
    rows = (D, t, assembly.mesh.properties.E, np.full_like(D, basis.yield_strength_pa), KL)
    return Tube(*(row[:, None] for row in rows))
