"""One matrix at the mudline for a whole foundation: the feet are tied rigidly to one node on a support law.

The field's joint updates of monopiles have a lateral stiffness k_u, a rocking stiffness k_θ and one damping c
there. With any law D of :mod:`jackettwin.soil.laws.families` the matrix is

    K(s) = D(s)/D₀ · (k_u P_u + k_θ P_θ),

so that sway and rocking lose the same share of their energy at a frequency. P_u is what holds the node
sideways, P_θ what is left against turning where it may sway freely.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.laws.families import Family
from jackettwin.soil.laws.parameter import Parameter
from jackettwin.soil.laws.viscoelastic import Law
from jackettwin.soil.support import Spring, Support
from jackettwin.structure import Reaction, RigidLink, Structure, rigid_transfer

MUDLINE = "mudline"
"""The node in the middle of the feet, unless there is one foot: then that is the mudline."""
MUDLINE_SUFFIXES = ("_u", "_theta")
MUDLINE_PATTERNS = (np.diag([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]), np.diag([0.0, 0.0, 0.0, 1.0, 1.0, 0.0]))
"""Of sway and rocking where no other stiffness is given."""
_HELD = (2, 5)
"""Then the node neither sinks nor turns about the vertical."""
_ROCKING = (1e9, 1e17, "N·m/rad")
"""Bounds of k_θ: those of k (8.6), with an arm of 10 m below and 32 m above."""


def tied_at_mudline(structure: Structure) -> Structure:
    """Return the structure with one reaction node, which all its feet follow as one rigid body.

    Raises
    ------
    InputError
        If it has no feet, or a node of its own is called so.
    """
    feet = structure.reaction_nodes
    if len(feet) == 1:
        return structure
    if not feet or MUDLINE in structure.nodes:
        raise InputError(
            "no feet to tie" if not feet else "the mudline's node has a name that is taken",
            field="reaction_nodes" if not feet else f"nodes.{MUDLINE}",
            value=list(feet) if not feet else MUDLINE,
            remedy="name the feet as reaction_nodes" if not feet else "rename the node",
        )
    x, y, z = np.mean([structure.nodes[foot] for foot in feet], axis=0).tolist()
    led = tuple(
        replace(link, leader=MUDLINE) if link.leader in feet else link for link in structure.rigid_links
    )
    return replace(
        structure,
        nodes={**structure.nodes, MUDLINE: (x, y, z)},
        rigid_links=(*led, *(RigidLink(MUDLINE, foot) for foot in feet)),
        reactions=(_together(structure, np.array([x, y, z])),),
    )


def feet_of(structure: Structure) -> tuple[str, ...]:
    """Return the nodes that piles stand under: the reaction nodes, or the followers of the mudline."""
    if structure.reaction_nodes != (MUDLINE,):
        return structure.reaction_nodes
    return tuple(link.follower for link in structure.rigid_links if link.leader == MUDLINE) or (MUDLINE,)


def _together(structure: Structure, here: FloatArray) -> Reaction:
    """Return the feet's own stiffness and mass as one reaction at a point."""

    def total(matrices: Mapping[str, tuple[tuple[float, ...], ...] | None]) -> tuple[tuple[float, ...], ...]:
        moves = {foot: rigid_transfer(np.array(structure.nodes[foot]) - here) for foot in matrices}
        parts = [moves[foot].T @ np.array(M) @ moves[foot] for foot, M in matrices.items() if M is not None]
        return tuple(map(tuple, np.sum(parts, axis=0).tolist()))

    stiffness = {r.node: r.stiffness for r in structure.reactions if r.stiffness is not None}
    mass = {r.node: r.mass for r in structure.reactions if r.mass is not None}
    return Reaction(
        MUDLINE, stiffness=total(stiffness) if stiffness else None, mass=total(mass) if mass else None
    )


def moved_to_mudline(structure: Structure, support: Support) -> Support:
    """Return the springs and masses of followers of the mudline as they act on its node: Σ Tᵀ K T.

    Parameters
    ----------
    structure : Structure
        With one reaction node (:func:`tied_at_mudline`).
    support : Support
        On that node and on its followers.
    """
    (node,) = structure.reaction_nodes
    here = np.array(structure.nodes[node])

    def moved(at: str, matrix: FloatArray) -> FloatArray:
        T = rigid_transfer(np.array(structure.nodes[at]) - here)
        return np.asarray(T.T @ matrix @ T)

    return replace(
        support,
        springs=tuple(replace(s, node=node, matrix=moved(s.node, s.matrix)) for s in support.springs),
        masses=tuple((node, moved(at, matrix)) for at, matrix in support.masses),
    )


def sway_and_rocking(K: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the part of a matrix (6, 6) that goes with the node's translations, and the rest.

    The rest is the Schur complement on the rotations: moments over rotations of a node that sways freely.
    Both store energy where K does, and add up to K.
    """
    t = slice(0, 3)
    sway = K[:, t] @ np.linalg.solve(K[t, t], K[t, :])
    rocking = np.zeros_like(K)
    rocking[3:, 3:] = (K - sway)[3:, 3:]
    return sway, rocking


def mudline_parameters(law: Family) -> tuple[Parameter, ...]:
    """Return k_u, k_θ and the law's other parameters, which both share.

    >>> from jackettwin.soil import family
    >>> [p.name for p in mudline_parameters(family("kelvin-voigt"))]
    ['k_u', 'k_theta', 'c']
    """
    first, *others = law.parameters
    sway, rocking = (first.name + suffix for suffix in MUDLINE_SUFFIXES)
    return (replace(first, name=sway), Parameter(rocking, *_ROCKING, words=first.words), *others)


def mudline_exponents(law: Family) -> FloatArray:
    """Return by which powers of :func:`mudline_parameters` the numbers of both laws are, (2 p, p + 1).

    The rocking law is the sway law times k_θ/k_u: what has a stiffness in its unit is multiplied, times and
    shares are the same.
    """
    p = len(law.parameters)
    powers = np.zeros((2 * p, p + 1))
    powers[0, 0] = powers[p, 1] = 1.0
    for j, parameter in enumerate(law.parameters[1:], 1):
        powers[[j, p + j], j + 1] = 1.0
        if parameter.unit.startswith("N"):
            powers[p + j, :2] = -1.0, 1.0
    return powers


def mudline_support(
    structure: Structure, law: Family, values: Mapping[str, float], reference_hz: Callable[[], float]
) -> Support:
    """Return the mudline's matrix with a law under a structure of one reaction node.

    Parameters
    ----------
    values : of :func:`mudline_parameters`, by name
    """
    (node,) = structure.reaction_nodes
    given = np.array([values[p.name] for p in mudline_parameters(law)])
    each = np.prod(given ** mudline_exponents(law), axis=1).reshape(2, -1)
    at = reference_hz() if law.needs_frequency else 1.0
    return on_mudline(node, [law.build(row, at) for row in each])


def on_mudline(node: str, laws: list[Law]) -> Support:
    """Return sway and rocking of a node on two laws; it neither sinks nor turns about the vertical."""
    springs = (Spring(node, S, law) for S, law in zip(MUDLINE_PATTERNS, laws, strict=True))
    return Support(tuple(springs), fixed=((node, _HELD),))
