"""Every member of a structure against ISO 19902, from static or time-domain displacements."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from jackettwin.structure.assemble import Assembly
from jackettwin.structure.forces import section_forces
from jackettwin.structure.iso19902 import (
    CHECKS,
    MOST_SLENDER_WALL,
    Stress,
    Tube,
    strength,
    utilisation,
)
from jackettwin.structure.model import Structure

FloatArray = npt.NDArray[np.float64]

_STRAIGHT = 0.9998
"""Cosine of the angle (about 1°) up to which two members in a row are one column."""
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
        On the length between joints that hold a member; a tower is a cantilever, everything else 1 unless
        given (table 13.5-1 allows 0.7 to 0.8 for braces).
    """

    yield_strength_pa: float = 355e6
    edition: str = "2007"
    C_m: float = 1.0
    K: Mapping[str, float] = field(default_factory=lambda: {"tower": 2.0})


@dataclass(frozen=True)
class MemberUse:
    """The worst check of a member over both ends of its elements and all instants."""

    member: str
    part: str
    utilisation: float
    check: str
    by_check: Mapping[str, float]
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
    tube = _tubes(assembly, basis)
    cases = displacement.reshape(-1, assembly.n_dof)
    worst = np.zeros((len(CHECKS), tube.D.size))
    spread = None if along is None else along.reshape(-1, *along.shape[-2:])
    for first in range(0, len(cases), _BLOCK):  # records are long
        here = slice(first, first + _BLOCK)
        held = spread if spread is None or len(spread) == 1 else spread[here]
        stress = section_stress(assembly, cases[here], along=held)
        U = utilisation(strength(tube), stress, C_m=basis.C_m, edition=basis.edition)
        worst = np.maximum(worst, np.stack([u.max(axis=(0, 2)) for u in U]))
    slender = (tube.D / tube.t)[:, 0]
    uses = []
    for index, member in enumerate(assembly.structure.members):
        mine = assembly.mesh.member == index
        by_check = dict(zip(CHECKS, map(float, worst[:, mine].max(axis=1)), strict=True))
        covered = bool((slender[mine] <= MOST_SLENDER_WALL).all())
        uses.append(_use(member.name, member.part, by_check, covered))
    return tuple(uses)


def worst_uses(first: tuple[MemberUse, ...], second: tuple[MemberUse, ...]) -> tuple[MemberUse, ...]:
    """Return the use of every member over two sets of cases."""
    return tuple(
        _use(a.member, a.part, {name: max(a.by_check[name], b.by_check[name]) for name in CHECKS}, a.covered)
        for a, b in zip(first, second, strict=True)
    )


def _use(member: str, part: str, by_check: dict[str, float], covered: bool) -> MemberUse:
    governing = max(by_check, key=lambda name: by_check[name])
    return MemberUse(member, part, by_check[governing], governing, by_check, covered)


def section_stress(
    assembly: Assembly, displacement: FloatArray, *, along: FloatArray | None = None
) -> Stress:
    """Return nominal stresses at both ends of every element, each (..., n_elements, 2) [Pa]."""
    forces = section_forces(assembly, displacement, along=along)
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


def column_lengths(structure: Structure) -> dict[str, float]:
    """Return the length of the straight run each member belongs to [m].

    Members in a row are one column where nothing else holds their common node, as the pieces of a tower.
    """
    ends = Counter(node for m in structure.members for node in (m.start, m.end))
    held = {r.node for r in structure.reactions} | {
        n for k in structure.rigid_links for n in (k.leader, k.follower)
    }
    axis = {m.name: _axis(structure, m.start, m.end) for m in structure.members}
    run = {m.name: m.name for m in structure.members}

    def root(name: str) -> str:
        while run[name] != name:
            name = run[name]
        return name

    at: dict[str, str] = {}
    for m in structure.members:
        for node in (m.start, m.end):
            other = at.setdefault(node, m.name)
            if other == m.name or ends[node] != 2 or node in held:
                continue
            if abs(axis[m.name][0] @ axis[other][0]) > _STRAIGHT:
                run[root(m.name)] = root(other)
    total: dict[str, float] = defaultdict(float)
    for name, (_, length) in axis.items():
        total[root(name)] += length
    return {name: total[root(name)] for name in run}


def _axis(structure: Structure, start: str, end: str) -> tuple[FloatArray, float]:
    along = np.subtract(structure.nodes[end], structure.nodes[start])
    length = float(np.linalg.norm(along))
    return along / length, length


def _dimensions(assembly: Assembly) -> tuple[FloatArray, FloatArray]:
    """Return outer diameter and wall of every element from its area and second moment."""
    p = assembly.mesh.properties
    outer, inner = 8.0 * p.I / p.A + 2.0 * p.A / np.pi, 8.0 * p.I / p.A - 2.0 * p.A / np.pi
    D = np.sqrt(outer)
    return D, 0.5 * (D - np.sqrt(np.maximum(inner, 0.0)))


def _tubes(assembly: Assembly, basis: DesignBasis) -> Tube:
    """Return every element's tube, (n_elements, 1)."""
    members = assembly.structure.members
    lengths = column_lengths(assembly.structure)
    K = [basis.K.get(m.name, basis.K.get(m.part, 1.0)) for m in members]
    KL = np.array([k * lengths[m.name] for k, m in zip(K, members, strict=True)])[assembly.mesh.member]
    D, t = _dimensions(assembly)
    columns = (D, t, assembly.mesh.properties.E, np.full_like(D, basis.yield_strength_pa), KL)
    return Tube(*(column[:, None] for column in columns))
