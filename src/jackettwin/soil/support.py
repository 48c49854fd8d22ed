"""Supports of a structure: fixed DOFs, and 6×6 springs scaled by a viscoelastic law."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.laws.viscoelastic import Law, Prony
from jackettwin.structure import Reaction, Structure

if TYPE_CHECKING:
    from jackettwin.soil.piles.pile_head import PileHead

TRANSLATIONS_ONLY = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
ELASTIC = Prony(k0=1.0)
_DOF_NAMES = ("x", "y", "z", "rotation x", "rotation y", "rotation z")


@dataclass(frozen=True)
class Spring:
    """A support on one node: ``matrix`` (6×6) times the law's complex stiffness.

    Either the matrix carries the units (N/m, N, N·m/rad) and the law is a number, or the matrix is a
    pattern of ones and the law carries them.
    """

    node: str
    matrix: FloatArray
    law: Law = ELASTIC


@dataclass(frozen=True)
class Support:
    """All that holds a structure."""

    springs: tuple[Spring, ...] = ()
    fixed: tuple[tuple[str, tuple[int, ...]], ...] = field(default=())
    """(node, held DOFs 0–5) pairs."""
    masses: tuple[tuple[str, FloatArray], ...] = ()
    """(node, 6×6 mass that moves with it) pairs: piles."""
    notes: tuple[str, ...] = ()
    """Assumptions behind it, one sentence each."""
    piles: tuple[tuple[str, PileHead], ...] = ()
    """(node, pile lumped there by springs and mass) pairs, of which its own motions are known, too."""

    def __repr__(self) -> str:
        held = ", ".join(node for node, _ in self.fixed) or "nothing"
        laws = ", ".join(dict.fromkeys(str(spring.law) for spring in self.springs)) or "none"
        return f"Support(held: {held}; {len(self.springs)} springs: {laws})"


def pinned(structure: Structure) -> Support:
    """Return all reaction nodes with their translations held."""
    return Support(fixed=tuple((node, (0, 1, 2)) for node in structure.reaction_nodes))


def clamped(structure: Structure) -> Support:
    """Return all reaction nodes with every DOF held."""
    return Support(fixed=tuple((node, (0, 1, 2, 3, 4, 5)) for node in structure.reaction_nodes))


def standing(structure: Structure) -> Support:
    """Return the support that modes are numbered on: pinned feet.

    Clamped feet where pins would let the structure turn over: one foot, or feet in a line.
    """
    return clamped(structure) if feet_in_line(structure) else pinned(structure)


def feet_in_line(structure: Structure) -> bool:
    """Tell whether a structure would turn over on translations alone: one foot, or feet in a line."""
    feet = np.array([structure.nodes[node] for node in structure.reaction_nodes])
    if feet.size == 0:
        return False
    spread = np.linalg.svd(feet - feet.mean(axis=0), compute_uv=False)
    return len(feet) < 3 or bool(spread[1] <= 1e-6 * spread[0])


def on_translations(structure: Structure, law: Law) -> Support:
    """Return the same law on the three translations of every reaction node (thesis (7.2) and (7.5))."""
    return Support(springs=tuple(Spring(node, TRANSLATIONS_ONLY, law) for node in structure.reaction_nodes))


def own_support(structure: Structure) -> Support:
    """Return what the structure's own file says of its reaction nodes."""
    springs, fixed = [], []
    for reaction in structure.reactions:
        held = tuple(dof for dof, flag in enumerate(reaction.fixed) if flag)
        if held:
            fixed.append((reaction.node, held))
        if reaction.stiffness is not None:
            springs.append(Spring(reaction.node, np.array(reaction.stiffness)))
    return Support(tuple(springs), tuple(fixed))


def described(support: Support) -> str:
    """Return in words what holds a structure.

    >>> described(Support(fixed=(("a", (0, 1, 2)), ("b", (0, 1, 2)))))
    '2 nodes held in x, y, z'
    """
    kinds = Counter(dofs for _, dofs in support.fixed)
    parts = [
        f"{count} nodes held in {', '.join(_DOF_NAMES[dof] for dof in dofs)}" for dofs, count in kinds.items()
    ]
    sprung = len({spring.node for spring in support.springs})
    if sprung:
        parts.append(f"{sprung} nodes on springs")
    return "; ".join(parts) or "nothing"


def held_where_sprung(structure: Structure, support: Support) -> Structure:
    """Return the structure with every node along piles that a spring holds as a reaction node, too."""
    along = {*structure.buried_nodes} & {spring.node for spring in support.springs}
    nothing = (False,) * 6
    more = tuple(Reaction(node, nothing) for node in structure.nodes if node in along)
    return replace(structure, reactions=(*structure.reactions, *more))


def with_static_reactions(structure: Structure, support: Support) -> Structure:
    """Return the structure with a support as its own reactions: held DOFs, static stiffness and mass.

    Raises
    ------
    InputError
        If the support acts on nodes that are not reaction nodes.
    """
    nodes = structure.reaction_nodes
    stiffness = {node: np.zeros((6, 6)) for node in nodes}
    mass = {r.node: np.zeros((6, 6)) if r.mass is None else np.array(r.mass) for r in structure.reactions}
    fixed = dict.fromkeys(nodes, (False,) * 6)
    touched = (
        [s.node for s in support.springs] + [n for n, _ in support.fixed] + [n for n, _ in support.masses]
    )
    for node in touched:
        if node not in stiffness:
            raise InputError(
                "the support acts on a node that is no reaction node",
                field="support",
                value=node,
                allowed=", ".join(nodes),
            )
    for spring in support.springs:
        stiffness[spring.node] += spring.law.static_stiffness * spring.matrix
    for node, matrix in support.masses:
        mass[node] += matrix
    for node, dofs in support.fixed:
        x, y, z, rx, ry, rz = (held or dof in dofs for dof, held in enumerate(fixed[node]))
        fixed[node] = (x, y, z, rx, ry, rz)
    reactions = tuple(
        Reaction(node, fixed[node], _as_tuple(stiffness[node]), _as_tuple(mass[node])) for node in nodes
    )
    return replace(structure, reactions=reactions)


def _as_tuple(matrix: FloatArray) -> tuple[tuple[float, ...], ...] | None:
    return tuple(tuple(float(v) for v in row) for row in matrix) if matrix.any() else None
