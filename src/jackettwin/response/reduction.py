"""A system reduced to the DOFs its supports act on and modes in between (Craig–Bampton).

The support DOFs remain unknowns, so that any law acts on them exactly. The fixed-interface modes are retained
up to a frequency. With these alone the modes of the whole system near that frequency have errors of several
per cent (of the order of (f/f_max)⁴). The part of the undamped modes outside the basis is therefore added
until no frequency error exceeds a limit.

Along piles modelled as members the ground acts on hundreds of DOFs. The basis then includes the ground's
static stiffness, and the law acts on the basis, with an error of second order in D(s) − D(0).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import require
from jackettwin.response.state import factorised
from jackettwin.response.system import Pencil, System
from jackettwin.structure import dense, lowest_modes

_FIRST_GUESS = 40
FREQUENCY_ERROR = 5e-4
"""Largest relative frequency error of the undamped modes: a tenth of the uncertainty from ten minutes of
record."""


@dataclass(frozen=True)
class Reduced:
    """A reduced system.

    Attributes
    ----------
    pencil : Pencil
        Dense pencil; its coordinates are the retained DOFs, then the modes.
    basis : (assembly.n_dof, n) shapes of the coordinates
    """

    pencil: Pencil
    basis: FloatArray

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self.pencil.n


def reduced(
    system: System, *, below_hz: float, keep: tuple[int, ...] = (), error: float = FREQUENCY_ERROR
) -> Reduced:
    """Return the system reduced to its support DOFs, the DOFs ``keep`` of the assembly, and modes.

    Parameters
    ----------
    below_hz : float
        Fixed-interface modes are retained up to this frequency, with as many further shapes as the undamped
        modes of the whole system up to this frequency need.
    error : float
        Largest relative error of the frequencies of these modes.

    Raises
    ------
    InputError
        If ``below_hz`` is not positive, or there is no mode below it.
    """
    require(0.0 < below_hz < np.inf, "must be positive", field="below_hz", value=below_hz, allowed="> 0")
    full = system.pencil
    buried = [dof for node in system.assembly.structure.buried_nodes for dof in system.assembly.dofs(node)]
    along = np.isin(system.free, np.array(buried, dtype=np.intp))
    touched = [group.dofs[~along[group.dofs]] for group in full.groups]
    heads = system.assembly.structure.reaction_nodes if buried else ()
    keep = (*keep, *(int(dof) for node in heads for dof in system.assembly.dofs(node)))
    kept = np.searchsorted(system.free, np.intersect1d(system.free, np.array(keep, dtype=np.intp)))
    b = np.unique(np.concatenate([*touched, kept]).astype(np.intp))
    i = np.setdiff1d(np.arange(full.n), b)
    K, M, static = (sp.csc_array(matrix) for matrix in (full.K, full.M, full.static_stiffness()))
    inner = sp.csc_array(static[i][:, i])
    phi = _modes_below(inner, sp.csc_array(M[i][:, i]), 2.0 * pi * below_hz)
    T = np.zeros((full.n, b.size + phi.shape[1]))
    T[b, np.arange(b.size)] = 1.0
    if b.size and i.size:
        T[i, : b.size] = -factorised(inner).solve(static[i][:, b].toarray())
    T[i, b.size :] = phi
    T = np.hstack([T, _missing(static, M, T, 2.0 * pi * below_hz, error)])
    require(T.shape[1] != 0, "no mode below this frequency", field="below_hz", value=below_hz)
    # scale to unit mass of every coordinate, since units differ
    T /= np.sqrt(np.einsum("ij,ij->j", T, M @ T))
    groups = (replace(g, S=_symmetric(T.T @ (g.S @ T)), dofs=_on(b, g.dofs, T.shape[1])) for g in full.groups)
    pencil = Pencil(_symmetric(T.T @ (M @ T)), _symmetric(T.T @ (K @ T)), full.rayleigh, tuple(groups))
    return Reduced(pencil, system.expand(T))


def _missing(K: sp.csc_array, M: sp.csc_array, T: FloatArray, limit: float, error: float) -> FloatArray:
    """Return the fewest shapes that represent the part of the modes below ω ``limit`` outside a basis.

    By Rayleigh's quotient, the frequency of a mode with the share e of its strain energy outside the basis is
    e/2 too high.
    """
    # interlacing: the modes below the limit are at most the fixed-interface modes plus retained coordinates
    phi = _modes_below(K, M, limit, first=T.shape[1] + 1)
    if phi.shape[1] == 0 or T.shape[1] == 0:
        return phi[:, :0]
    own = T.T @ (K @ T)
    beyond = phi - T @ np.linalg.lstsq(own, T.T @ (K @ phi), rcond=None)[0]
    energy = np.maximum(np.einsum("ij,ij->j", phi, K @ phi), 1e-300)
    beyond /= np.sqrt(energy)
    values, vectors = np.linalg.eigh(_symmetric(beyond.T @ (K @ beyond)))
    values, vectors = values[::-1], vectors[:, ::-1]
    # share of each mode that remains after the first 0, 1, … shapes
    left = np.cumsum((vectors**2 * np.maximum(values, 0.0))[:, ::-1], axis=1)[:, ::-1]
    left = np.hstack([left, np.zeros((left.shape[0], 1))])
    number = int(np.argmax(left.max(axis=0) <= 2.0 * error))
    return np.asarray(beyond @ vectors[:, :number])


def _modes_below(K: sp.csc_array, M: sp.csc_array, limit: float, *, first: int = _FIRST_GUESS) -> FloatArray:
    number = first
    while K.shape[0]:
        omega, phi = lowest_modes(K, M, number)
        if omega[-1] >= limit or number >= K.shape[0] or omega.size < number:
            return np.asarray(phi[:, omega < limit])
        number *= 2
    return np.zeros((0, 0))


def _on(b: IntArray, dofs: IntArray, size: int) -> IntArray:
    """Return the coordinates that a group acts on: retained DOFs, or all if some are not retained."""
    return np.searchsorted(b, dofs) if np.isin(dofs, b).all() else np.arange(size)


def _symmetric(matrix: FloatArray) -> FloatArray:
    full = dense(matrix)
    return np.asarray(0.5 * (full + full.T))
