"""What holds a structure: fixed DOFs, and 6×6 springs scaled by a viscoelastic law."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from jackettwin.soil.viscoelastic import Law, Prony
from jackettwin.structure.model import Structure

FloatArray = npt.NDArray[np.float64]

TRANSLATIONS_ONLY = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
ELASTIC = Prony(k0=1.0)


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


def pinned(structure: Structure) -> Support:
    """Return all reaction nodes with their translations held."""
    return Support(fixed=tuple((node, (0, 1, 2)) for node in structure.reaction_nodes))


def clamped(structure: Structure) -> Support:
    """Return all reaction nodes with every DOF held."""
    return Support(fixed=tuple((node, (0, 1, 2, 3, 4, 5)) for node in structure.reaction_nodes))


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
