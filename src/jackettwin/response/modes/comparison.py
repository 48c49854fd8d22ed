"""Comparison of a structure's modes with those of another program, at common nodes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linear_sum_assignment

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.decks import NodalModes
from jackettwin.errors import require
from jackettwin.identification import mac
from jackettwin.response.modes.modal import UndampedModes
from jackettwin.response.state import factorised
from jackettwin.structure import Assembly

NEAREST_M = 0.1
"""Largest distance between a node and that of the other program [m]."""
PAIR = 1e-3
"""Relative difference of frequencies below which modes are a pair; either program may return any rotation of
its shapes."""
_FEWEST = 3
_ALIKE = 0.5
"""Smallest MAC of two modes that are matched."""


class ModePair(NamedTuple):
    """A mode and its counterpart in the other program; MAC of translations and, if known, of rotations."""

    own: int
    other: int
    mac: float
    rotations_mac: float | None


@dataclass(frozen=True)
class ModeComparison:
    """Modes of a structure compared with those of another program.

    Attributes
    ----------
    own : UndampedModes
        Modes of the structure; pairs of one frequency are rotated to those of the other program.
    other : NodalModes
        Modes of the other program at the common nodes, with the structure's node names; its pairs are rotated
        too.
    mac : (n_own, n_other) MAC of the translations at the common nodes
    pairs : matched modes, by mode of the structure; modes with a MAC below one half are left out
    unknown : nodes of the other program that the structure does not have
    """

    own: UndampedModes
    other: NodalModes
    mac: FloatArray
    pairs: tuple[ModePair, ...]
    unknown: tuple[str, ...]


def nodal_modes(assembly: Assembly, modes: UndampedModes) -> NodalModes:
    """Return the modes at the nodes of the structure, as other programs would state them."""
    names = tuple(assembly.structure.nodes)
    moved = np.asarray(assembly.expand @ modes.shapes).T.reshape(modes.omega.size, -1, 6)[:, : len(names)]
    scale = np.abs(moved[:, :, :3]).max(axis=(1, 2), keepdims=True)
    places = np.array([assembly.structure.nodes[name] for name in names])
    return NodalModes(modes.frequency_hz, names, moved / scale, places)


def compare_modes(assembly: Assembly, own: UndampedModes, other: NodalModes) -> ModeComparison:
    """Compare modes with those of another program.

    Nodes are matched by name, or else by position within 0.1 m.

    Raises
    ------
    InputError
        If fewer than three nodes are matched.
    """
    here, which, unknown = _matched(assembly, other)
    require(
        len(here) >= _FEWEST,
        "too few nodes of the other program are nodes of the structure",
        field="node",
        value=list(other.nodes[:5]),
        allowed=f"{_FEWEST} nodes or more, by name or by x_m, y_m, z_m within {NEAREST_M:g} m",
        remedy="name nodes as the structure does, or give their places in its frame",
    )
    places = None if other.places is None else other.places[which]
    shapes = other.shapes[:, which]
    shapes = shapes / np.linalg.norm(_rows(shapes), axis=1)[:, None, None]
    other = replace(other, nodes=here, shapes=shapes, places=places)
    R = _turn(own.frequency_hz, _rows(_at(assembly, own, here)), _rows(other.shapes))
    own = replace(own, shapes=own.shapes @ R.T)
    mine = _at(assembly, own, here)
    R = _turn(other.frequency_hz, _rows(other.shapes), _rows(mine))
    other = replace(other, shapes=np.einsum("ij,jnc->inc", R, other.shapes))
    alike = np.atleast_2d(mac(_rows(mine), _rows(other.shapes)))
    pairs = []
    for i, j in zip(*linear_sum_assignment(-alike), strict=True):
        if alike[i, j] >= _ALIKE:
            both = mine[i, :, 3:].ravel(), other.shapes[j, :, 3:].ravel()
            rotations = float(mac(*both)) if other.has_rotations and both[1].any() else None
            pairs.append(ModePair(int(i), int(j), float(alike[i, j]), rotations))
    return ModeComparison(own, other, alike, tuple(pairs), unknown)


def expanded(assembly: Assembly, other: NodalModes) -> FloatArray:
    """Return another program's shapes on all of the assembly's DOFs, (n_dof, n_modes).

    At other nodes the static shape of least strain energy is taken, given the displacements at the common
    nodes.
    """
    components = range(6 if other.has_rotations else 3)
    known = np.array(
        [(assembly.dofs(node)[c], k, c) for k, node in enumerate(other.nodes) for c in components],
        dtype=np.intp,
    )
    dofs, first = np.unique(known[:, 0], return_index=True)
    given = other.shapes[:, known[first, 1], known[first, 2]].T
    rest = np.setdiff1d(np.arange(assembly.n_dof), dofs)
    u = np.zeros((assembly.n_dof, other.frequency_hz.size))
    u[dofs] = given
    if rest.size:
        K = sp.csc_array(assembly.stiffness)
        u[rest] = -factorised(sp.csc_array(K[rest][:, rest])).solve(K[rest][:, dofs] @ given)
    return u


def _matched(assembly: Assembly, other: NodalModes) -> tuple[tuple[str, ...], IntArray, tuple[str, ...]]:
    """Return names of the common nodes, their rows in the other's table, and names without a match."""
    structure = assembly.structure
    followers = {link.follower for link in structure.rigid_links}
    free = [name for name in structure.nodes if name not in followers]
    points = np.array([structure.nodes[name] for name in free])
    here, which, unknown = [], [], []
    for k, name in enumerate(other.nodes):
        found = name if name in structure.nodes and name not in followers else None
        if found is None and other.places is not None:
            apart = np.linalg.norm(points - other.places[k], axis=1)
            found = free[int(np.argmin(apart))] if apart.min() <= NEAREST_M else None
        if found is None or found in here:
            unknown.append(name)
        else:
            here.append(found)
            which.append(k)
    return tuple(here), np.array(which, dtype=np.intp), tuple(unknown)


def _at(assembly: Assembly, modes: UndampedModes, nodes: tuple[str, ...]) -> FloatArray:
    """Return own shapes at some nodes, (n_modes, n_nodes, 6)."""
    rows = np.concatenate([assembly.mesh.node_dofs(node) for node in nodes])
    return np.asarray(np.asarray(assembly.expand @ modes.shapes)[rows].T).reshape(modes.omega.size, -1, 6)


def _rows(shapes: FloatArray) -> FloatArray:
    """Return the translations of shapes as rows."""
    return shapes[:, :, :3].reshape(shapes.shape[0], -1)


def _turn(frequency_hz: FloatArray, shapes: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the rotation R (n, n) of shapes (n, m) that brings modes of one frequency to wanted ones.

    Within a pair (or more) it is orthogonal (Procrustes problem); single modes are not changed.
    """
    n = frequency_hz.size
    R = np.eye(n)
    order = np.argsort(frequency_hz)
    breaks = np.flatnonzero(np.diff(frequency_hz[order]) > PAIR * frequency_hz[order][1:]) + 1
    for group in np.split(order, breaks):
        if group.size < 2:
            continue
        basis, _ = np.linalg.qr(shapes[group].T)
        share = ((wanted @ basis) ** 2).sum(axis=1) / (wanted**2).sum(axis=1)
        nearest = np.sort(np.argsort(-share)[: group.size])
        if nearest.size < group.size or share[nearest].min() < _ALIKE:
            continue
        aims = wanted[nearest] / np.linalg.norm(wanted[nearest], axis=1, keepdims=True)
        U, _, Vt = np.linalg.svd(aims @ np.linalg.pinv(shapes[group]))
        R[np.ix_(group, group)] = U @ Vt
    return R
