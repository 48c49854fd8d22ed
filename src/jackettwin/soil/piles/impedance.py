"""The 6×6 impedance of a pile's head, exact and lumped."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.laws.viscoelastic import Law, Prony
from jackettwin.soil.mudline import feet_of
from jackettwin.soil.piles.pile_head import InnerPile, PileHead
from jackettwin.soil.piles.piles import Pile, PileSprings, pile_beams
from jackettwin.soil.support import ELASTIC, Spring, Support
from jackettwin.structure import Assembly, Structure, assemble

_MOMENTS = 4
"""Orders of moments of the ground; poles are then those of members within 1e-8 up to D(s) − 1 = 1."""
_ALIKE = 1e-6
"""Size of a motion, over the largest, below which it is a sum of others."""


@dataclass(frozen=True)
class PileMatrices:
    """A free pile with its head's six DOFs first: steel, mass, soil springs (unit law), dashpots, sparse."""

    steel: sp.csc_array
    mass: sp.csc_array
    soil: sp.csc_array
    dashpots: sp.csc_array


def pile_matrices(
    pile: Pile,
    springs: PileSprings,
    *,
    dashpots: PileSprings | None = None,
    above: Structure | None = None,
) -> PileMatrices:
    """Return the matrices of one pile, from the same beams as every other member.

    ``dashpots`` are the ground's own [N·s/m], beside what the law says of its springs: radiation. The beam
    theory is that of the structure ``above``, as of piles that are its members; Euler–Bernoulli without one.
    """
    free = pile_assembly(pile, springs.node_depth, above=above)
    soil = _at_nodes(springs)
    lost = sp.csc_array(soil.shape) if dashpots is None else _at_nodes(dashpots)
    return PileMatrices(free.stiffness, free.mass, soil, lost)


def pile_assembly(pile: Pile, node_depth: FloatArray, *, above: Structure | None = None) -> Assembly:
    """Return a free pile with its nodes at these depths, its head first."""
    below, members = pile_beams("head", (0.0, 0.0, 0.0), pile, node_depth)
    alone = Structure("pile", {"head": (0.0, 0.0, 0.0), **below}, tuple(members))
    if above is not None:
        alone = replace(
            alone,
            beam=above.beam,
            rotary_inertia=above.rotary_inertia,
            shear_in_mass=above.shear_in_mass,
        )
    return assemble(alone)


def _at_nodes(springs: PileSprings) -> sp.csc_array:
    return sp.csc_array(sp.diags_array(springs.by_node.ravel()))


def head_impedance(
    pile: Pile,
    springs: PileSprings,
    s: ComplexArray | complex,
    *,
    law: Law = ELASTIC,
    dashpots: PileSprings | None = None,
    above: Structure | None = None,
) -> ComplexArray:
    """Return the head's dynamic stiffness K*(s) of a pile, (n_s, 6, 6); s = iω [rad/s].

    The pile's other DOFs are eliminated exactly at each s: K* = F_hh − F_hi F_ii⁻¹ F_ih with
    F = K + D(s) S + sC + s² M.
    """
    m = pile_matrices(pile, springs, dashpots=dashpots, above=above)
    values = np.atleast_1d(np.asarray(s, dtype=np.complex128))
    result = np.empty((values.size, 6, 6), dtype=np.complex128)
    for i, value in enumerate(values):
        soil = complex(law.stiffness(value)) * m.soil + value * m.dashpots
        F = sp.csc_array(m.steel + soil + value**2 * m.mass)
        result[i] = F[:6, :6].toarray() - F[:6, 6:] @ spla.splu(sp.csc_matrix(F[6:, 6:])).solve(
            F[6:, :6].toarray()
        )
    return 0.5 * (result + result.transpose(0, 2, 1))


def lumped_head(
    pile: Pile,
    springs: PileSprings,
    *,
    law: Law = ELASTIC,
    dashpots: PileSprings | None = None,
    above: Structure | None = None,
) -> PileHead:
    """Return a pile reduced to its head by its static shapes (Guyan), and its motions beside these.

    Rayleigh's principle makes K* of the head right to second order in D(s) − 1 and in (ω/ω_p)², ω_p the
    pile's own first frequency with its head held: well above the structure's modes for any driven pile. With
    the inner motions poles are those of piles as members.
    """
    m = pile_matrices(pile, springs, dashpots=dashpots, above=above)
    static = sp.csc_array(m.steel + m.soil)
    held = spla.splu(sp.csc_matrix(static[6:, 6:]))
    T = np.vstack([np.eye(6), -held.solve(static[6:, :6].toarray())])
    basis = np.hstack([T, _moments(m, held, T)])
    steel, soil, mass, lost = (_reduced(matrix, basis) for matrix in (m.steel, m.soil, m.mass, m.dashpots))
    inner = InnerPile(_beside_head(steel), _beside_head(soil), _beside_head(mass), _beside_head(lost))
    return PileHead(steel[:6, :6], soil[:6, :6], mass[:6, :6], lost[:6, :6], inner, law)


def _moments(m: PileMatrices, held: spla.SuperLU, T: FloatArray) -> FloatArray:
    """Return orthonormal motions (n, k) of a pile with its head held that complete its static shapes T.

    They are its first moments about rest in D(s) − 1, in s², and in the dashpots' s (model reduction by
    Krylov subspaces, Freund 2003). As F is symmetric, poles are right to twice as many orders.
    """
    last = np.hstack([(matrix @ T)[6:] for matrix in (m.soil, m.mass, m.dashpots) if matrix.nnz])
    found = []
    for _ in range(_MOMENTS):
        last = held.solve(last)
        last /= np.maximum(np.linalg.norm(last, axis=0), 1e-300)
        found.append(last)
        last = m.soil[6:, 6:] @ last
    U, size, _ = la.svd(np.hstack(found), full_matrices=False)
    inner = U[:, size > _ALIKE * size[0]]
    return np.vstack([np.zeros((6, inner.shape[1])), inner])


def _reduced(matrix: sp.csc_array, basis: FloatArray) -> FloatArray:
    full = basis.T @ (matrix @ basis)
    return np.asarray(0.5 * (full + full.T))


def _beside_head(matrix: FloatArray) -> FloatArray:
    """Return the matrix without what the head has in its own."""
    beside = matrix.copy()
    beside[:6, :6] = 0.0
    return beside


def on_pile_heads(structure: Structure, head: PileHead) -> Support:
    """Return a lumped pile under every foot: springs, law and mass there.

    Raises
    ------
    InputError
        If the structure has no reaction nodes.
    """
    if not structure.reactions:
        raise InputError("the structure has no reaction nodes to put piles under", field="reaction_nodes")
    springs, feet = [], feet_of(structure)
    for foot in feet:
        springs += [Spring(foot, head.steel), Spring(foot, head.soil, head.law)]
        if head.dashpots.any():
            springs.append(Spring(foot, head.dashpots, Prony(c=1.0)))
    masses = tuple((foot, head.mass) for foot in feet)
    return Support(springs=tuple(springs), masses=masses, piles=tuple((foot, head) for foot in feet))
