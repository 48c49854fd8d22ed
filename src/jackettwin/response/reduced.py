r"""Craig–Bampton basis that keeps the support DOFs.

With the support DOFs as boundary, any support law acts on the reduced model exactly; only the bending of the
structure between them is approximated. (Reducing to the interface alone is wrong with strong dashpots.)

.. math:: x = [-K_{ii}^{-1}K_{ib}\; q_b + Φ\, η,\; q_b]
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import numpy.typing as npt
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.axes import TRANSLATIONS
from jackettwin.errors import InputError
from jackettwin.response.modal import UndampedModes
from jackettwin.response.system import Pencil, System
from jackettwin.structure.eigen import lowest_modes

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Reduced:
    """A reduced model: boundary DOFs first, then fixed-interface modal coordinates.

    Attributes
    ----------
    pencil : Pencil
        Dense, (n_boundary + n_modes).
    basis : (assembly.n_dof, n) shapes of the coordinates
    boundary : (n_boundary,) DOFs of the assembly
    fixed_interface_hz : (n_modes,)
    pinned : UndampedModes
        With the supports' translations held, in reduced coordinates: they count the modes. Other boundary
        DOFs (a nacelle's dashpot) are free in them.
    """

    pencil: Pencil
    basis: FloatArray
    boundary: IntArray
    fixed_interface_hz: FloatArray
    pinned: UndampedModes


def craig_bampton(system: System, *, n_modes: int) -> Reduced:
    """Return the reduced model with every DOF a support law touches as boundary.

    Raises
    ------
    InputError
        If nothing is supported by a law, so that there is no boundary to keep.
    """
    full = system.pencil
    if not full.groups:
        raise InputError(
            "no support to keep as boundary", field="support", value="pinned", remedy="give it a law"
        )
    b = np.unique(np.concatenate([group.dofs for group in full.groups]))
    i = np.setdiff1d(np.arange(full.n), b)
    K, M = sp.csc_array(full.K), sp.csc_array(full.M)
    K_ii = sp.csc_array(K[i][:, i])
    constraint = -spla.splu(sp.csc_matrix(K_ii)).solve(K[i][:, b].toarray())
    omega, phi = lowest_modes(K_ii, sp.csc_array(M[i][:, i]), n_modes)
    T = np.zeros((full.n, b.size + omega.size))
    T[b, np.arange(b.size)] = 1.0
    T[i, : b.size], T[i, b.size :] = constraint, phi
    groups = []
    for group in full.groups:
        S = np.zeros((T.shape[1], T.shape[1]))
        S[: b.size, : b.size] = sp.csc_array(group.S)[b][:, b].toarray()
        groups.append(replace(group, S=S, dofs=np.searchsorted(b, group.dofs)))
    pencil = Pencil(_symmetric(T.T @ (M @ T)), _symmetric(T.T @ (K @ T)), full.rayleigh, tuple(groups))
    pinned = _pinned(pencil, _held(system, system.free[b]))
    return Reduced(pencil, system.expand(T), system.free[b], omega / (2.0 * pi), pinned)


def pinned_reference(reduced: Reduced, number: int) -> UndampedModes:
    """Return the lowest ``number`` of the modes that count the modes."""
    return UndampedModes(reduced.pinned.omega[:number], reduced.pinned.shapes[:, :number])


def _held(system: System, boundary: IntArray) -> IntArray:
    """Return the coordinates of the boundary that pinned supports would hold."""
    pins = [system.assembly.dofs(spring.node)[list(TRANSLATIONS)] for spring in system.support.springs]
    return np.flatnonzero(np.isin(boundary, pins))


def _pinned(pencil: Pencil, held: IntArray) -> UndampedModes:
    free = np.setdiff1d(np.arange(pencil.n), held)
    w, x = la.eigh(pencil.K[np.ix_(free, free)], pencil.M[np.ix_(free, free)])
    shapes = np.zeros((pencil.n, free.size))
    shapes[free] = x
    return UndampedModes(np.sqrt(np.maximum(w, 0.0)), shapes)


def undamped_reduced(pencil: Pencil) -> UndampedModes:
    """Return all undamped modes of a dense pencil."""
    w, x = la.eigh(pencil.static_stiffness(), pencil.M)
    return UndampedModes(np.sqrt(np.maximum(w, 0.0)), x)


def _symmetric(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)
