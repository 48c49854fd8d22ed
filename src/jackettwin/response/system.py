r"""Structure and support as one dynamic system.

In the Laplace domain :math:`F(s)\,x = f` with

.. math:: F(s) = s^2 M + s(αM + βK) + K + \sum_g D_g(s) S_g

where each support law :math:`D_g` scales its own pattern matrix :math:`S_g`. F is symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.errors import require
from jackettwin.soil import Prony
from jackettwin.structure import Rayleigh

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.soil import Law, Spring, Support
    from jackettwin.structure import Assembly

Matrix = Any
"""A NumPy array or a SciPy sparse array."""


@dataclass(frozen=True)
class Group:
    """All springs with one law: pattern matrix S (n, n) and the DOFs it acts on."""

    law: Law
    S: Matrix
    dofs: IntArray


@dataclass(frozen=True)
class Pencil:
    """M, K, Rayleigh damping and support groups, sparse (full model) or dense (reduced)."""

    M: Matrix
    K: Matrix
    rayleigh: Rayleigh
    groups: tuple[Group, ...]

    @property
    def n(self) -> int:
        """Number of DOFs."""
        return int(self.M.shape[0])

    def F(self, s: complex) -> Matrix:
        """Return F(s)."""
        a, b = self.rayleigh.alpha, self.rayleigh.beta
        total = (s * s + a * s) * self.M + (1.0 + b * s) * self.K
        for group in self.groups:
            total = total + complex(group.law.stiffness(s)) * group.S
        return total

    def dF(self, s: complex) -> Matrix:
        """Return dF/ds."""
        total = (2.0 * s + self.rayleigh.alpha) * self.M + self.rayleigh.beta * self.K
        for group in self.groups:
            total = total + complex(group.law.slope(s)) * group.S
        return total

    def static_stiffness(self) -> Matrix:
        """Return K plus the static stiffness of every law, for the undamped structure."""
        total = self.K
        for group in self.groups:
            total = total + group.law.static_stiffness * group.S
        return total

    def with_laws(self, laws: Sequence[Law]) -> Pencil:
        """Return the pencil with other laws on the same groups."""
        groups = tuple(replace(group, law=law) for group, law in zip(self.groups, laws, strict=True))
        return replace(self, groups=groups)


@dataclass(frozen=True)
class System:
    """A supported structure.

    Attributes
    ----------
    assembly : Assembly
        The free structure.
    support : Support
    pencil : Pencil
        Equations of the free DOFs.
    free : (n,) DOFs of the assembly that are not fixed
    """

    assembly: Assembly
    support: Support
    pencil: Pencil
    free: IntArray

    def __repr__(self) -> str:
        return f"System({self.assembly!r} on {self.support!r}, {self.free.size} free DOFs)"

    def expand(self, x: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return shapes (assembly.n_dof, ...) from shapes at the free DOFs; fixed DOFs are zero.

        Coordinates inside piles, which follow the free DOFs, are left out.
        """
        full = np.zeros((self.assembly.n_dof, *x.shape[1:]), dtype=x.dtype)
        full[self.free] = x[: self.free.size]
        return full


def build_system(
    assembly: Assembly,
    support: Support,
    *,
    rayleigh: Rayleigh | None = None,
    dashpots: tuple[Spring, ...] = (),
    spread: tuple[tuple[Matrix, Law], ...] = (),
) -> System:
    """Return the structure on its support.

    Parameters
    ----------
    assembly : Assembly
    support : Support
    rayleigh : Rayleigh, optional
        Damping of the steel.
    dashpots : tuple of Spring
        Further springs and dashpots, e.g. a nacelle's aerodynamic damping.
    spread : (pattern on the assembly's DOFs, law)
        Matrices that act on the whole structure, e.g. drag in water.

    Raises
    ------
    InputError
        If a spring acts on fixed DOFs only, or a node does not exist.
    """
    held: list[int] = []
    for node, dofs in support.fixed:
        held += list(assembly.dofs(node)[list(dofs)])
    free = np.setdiff1d(np.arange(assembly.n_dof), np.array(held, dtype=np.intp))
    require(free.size != 0, "every degree of freedom is fixed", field="support", remedy="fix fewer nodes")
    number = np.full(assembly.n_dof, -1, dtype=np.intp)
    number[free] = np.arange(free.size)
    M = sp.csc_array((assembly.mass + _ground_mass(assembly, support))[free][:, free])
    K = sp.csc_array(assembly.stiffness[free][:, free])
    groups = _groups(assembly, (*support.springs, *dashpots), number, free.size)
    everywhere = tuple(_spread(sp.csc_array(sp.csc_array(S)[free][:, free]), law) for S, law in spread)
    return System(assembly, support, Pencil(M, K, rayleigh or Rayleigh(), groups + everywhere), free)


def with_inner_piles(system: System) -> System:
    """Return the system with the own motions of the piles that its support lumps at their heads.

    Its poles are those of piles as members. The coordinates inside the piles follow the free DOFs; loads and
    motions in time are those of the system as it was.
    """
    piles, pencil = system.support.piles, system.pencil
    if not piles:
        return system
    number = np.full(system.assembly.n_dof, -1, dtype=np.intp)
    number[system.free] = np.arange(system.free.size)
    n, places = pencil.n, []
    for node, head in piles:
        inside = np.arange(n, n + len(head.inner.steel) - DOFS_PER_NODE)
        places.append(np.concatenate([number[system.assembly.dofs(node)], inside]))
        n += inside.size

    def placed(matrices: Sequence[FloatArray]) -> sp.csc_array:
        blocks = [(at[: len(matrix)], matrix) for at, matrix in zip(places, matrices, strict=True)]
        return _from_blocks(blocks, n)

    inner = [head.inner for _, head in piles]
    # steel is damped as that of members is, by its part of the Rayleigh damping
    steel = placed([head.steel for _, head in piles])
    K = _grown(pencil.K, n) + steel + placed([one.steel for one in inner])
    M = _grown(pencil.M, n) + placed([one.mass for one in inner])
    groups = [replace(group, S=_grown(group.S, n)) for group in pencil.groups]
    groups += [
        _spread(-steel, Prony(k0=1.0)),
        _spread(placed([one.soil for one in inner]), piles[0][1].law),
        _spread(placed([one.dashpots for one in inner]), Prony(c=1.0)),
    ]
    live = tuple(group for group in groups if group.S.nnz)
    return replace(system, pencil=replace(pencil, M=M, K=K, groups=live))


def _grown(matrix: Matrix, n: int) -> sp.csc_array:
    """Return the matrix with zero rows and columns behind it, (n, n)."""
    entries = sp.coo_array(matrix)
    return sp.coo_array((entries.data, entries.coords), shape=(n, n)).tocsc()


def _spread(S: sp.csc_array, law: Law) -> Group:
    return Group(law, S, np.unique(S.nonzero()[0]))


def _ground_mass(assembly: Assembly, support: Support) -> sp.csc_array:
    """Return the mass of bodies of the ground (piles) on the assembly's DOFs."""
    blocks = [(assembly.dofs(node), matrix) for node, matrix in support.masses]
    return _from_blocks(blocks, assembly.n_dof)


def _from_blocks(blocks: Sequence[tuple[IntArray, FloatArray]], n: int) -> sp.csc_array:
    """Return the sum (n, n) of square matrices, each on its own DOFs."""
    if not blocks:
        return sp.csc_array((n, n))
    rows = np.concatenate([np.repeat(dofs, dofs.size) for dofs, _ in blocks])
    columns = np.concatenate([np.tile(dofs, dofs.size) for dofs, _ in blocks])
    values = np.concatenate([matrix.ravel() for _, matrix in blocks])
    return sp.coo_array((values, (rows, columns)), shape=(n, n)).tocsc()


def _groups(assembly: Assembly, springs: tuple[Spring, ...], number: IntArray, n: int) -> tuple[Group, ...]:
    """Return one group for each distinct law, in order of first appearance."""
    entries: dict[Law, list[tuple[IntArray, IntArray, FloatArray]]] = {}
    for spring in springs:
        dofs = number[assembly.dofs(spring.node)]
        rows, columns = np.nonzero(spring.matrix)
        live = (dofs[rows] >= 0) & (dofs[columns] >= 0)
        rows, columns = rows[live], columns[live]
        block = (dofs[rows], dofs[columns], spring.matrix[rows, columns])
        entries.setdefault(spring.law, []).append(block)
    groups = []
    for law, blocks in entries.items():
        i, j, v = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
        if v.size:
            S = sp.coo_array((v, (i, j)), shape=(n, n)).tocsc()
            groups.append(Group(law, S, np.unique(i)))
    return tuple(groups)
