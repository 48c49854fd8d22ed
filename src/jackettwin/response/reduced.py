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

from jackettwin.errors import InputError
from jackettwin.response.modal import UndampedModes
from jackettwin.response.system import Pencil, System

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
    """

    pencil: Pencil
    basis: FloatArray
    boundary: IntArray
    fixed_interface_hz: FloatArray


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
    n_modes = min(n_modes, i.size - 2)
    K, M = sp.csc_array(full.K), sp.csc_array(full.M)
    K_ii, M_ii = sp.csc_matrix(K[i][:, i]), sp.csc_matrix(M[i][:, i])
    constraint = -spla.splu(K_ii).solve(K[i][:, b].toarray())
    w, phi = spla.eigsh(K_ii, k=n_modes, M=M_ii, sigma=0.0, v0=np.ones(i.size), tol=0.0)
    order = np.argsort(w)
    T = np.zeros((full.n, b.size + n_modes))
    T[b, np.arange(b.size)] = 1.0
    T[i, : b.size], T[i, b.size :] = constraint, phi[:, order]
    groups = []
    for group in full.groups:
        S = np.zeros((T.shape[1], T.shape[1]))
        S[: b.size, : b.size] = sp.csc_array(group.S)[b][:, b].toarray()
        groups.append(replace(group, S=S, dofs=np.searchsorted(b, group.dofs)))
    pencil = Pencil(_symmetric(T.T @ (M @ T)), _symmetric(T.T @ (K @ T)), full.rayleigh, tuple(groups))
    return Reduced(pencil, system.expand(T), system.free[b], np.sqrt(w[order]) / (2.0 * pi))


def pinned_reference(reduced: Reduced, number: int) -> UndampedModes:
    """Return the lowest modes with every boundary DOF held, in reduced coordinates: they count the modes."""
    n_boundary, n = reduced.boundary.size, reduced.pencil.n
    number = min(number, n - n_boundary)
    shapes = np.zeros((n, number))
    shapes[n_boundary + np.arange(number), np.arange(number)] = 1.0
    return UndampedModes(2.0 * pi * reduced.fixed_interface_hz[:number], shapes)


def undamped_reduced(pencil: Pencil) -> UndampedModes:
    """Return all undamped modes of a dense pencil."""
    w, x = la.eigh(pencil.static_stiffness(), pencil.M)
    return UndampedModes(np.sqrt(np.maximum(w, 0.0)), x)


def _symmetric(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)
