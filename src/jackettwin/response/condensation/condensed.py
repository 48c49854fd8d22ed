r"""A structure condensed to its support DOFs, exactly.

Every DOF that a support law or dashpot acts on is retained (the boundary b). The fixed-interface modes, with
b fixed, are

* retained as unknowns in the band of interest: a mode in which the supports hardly move would otherwise be a
  cancelling pole and zero of the condensed matrix and could not be found;
* summed in closed form up to several times the band;
* represented above that by moments, a power series in μ that converges to machine precision.

.. math::

    F(λ) = (1+bλ) \begin{bmatrix} S_0(μ) & μP \\ μP^T & Ω^2+μ \end{bmatrix} + D(λ), \qquad
    μ = \frac{λ^2+aλ}{1+bλ}

    S_0(μ) = K_B + μM_B - μ^2 \sum_j \frac{p_j p_j^T}{ω_j^2+μ}
             - μ^2 \sum_k (-μ)^k R_{k+1}

with Rayleigh damping aM + bK of the steel and :math:`R_k = \sum_{trunc} p_j p_j^T / ω_j^{2k}`, computed from
static solutions without the truncated modes. Only the tail of the series is neglected.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, pi
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.axes import TRANSLATIONS
from jackettwin.errors import InputError, NumericalError, require
from jackettwin.response.modes.modal import UndampedModes
from jackettwin.response.modes.multiple import aligned_coordinates
from jackettwin.response.system import Group, Matrix, Pencil, System
from jackettwin.soil import Prony, standing
from jackettwin.structure import lowest_modes

_RETAINED = 1.2
"""Modes up to this multiple of the band are retained as unknowns."""
_SUMMED = 2.5
"""Modes up to this multiple of the band are summed in closed form; higher ones are represented by moments."""
_MOST_MOMENTS = 24
"""Terms after which the series counts as divergent: each ought to be (2.5/1.05)² = 5.7 times smaller."""
_TAIL = 1e-13
"""The series of moments ends where its next term is smaller than this share of the boundary's mass."""
_STEEPEST = 0.3
"""Largest b·|λ|; beyond it the steel is overdamped and μ leaves the range of convergence."""


@dataclass(frozen=True)
class Condensed:
    """A structure condensed to its boundary, on which any support law acts exactly.

    Coordinates are the boundary DOFs, scaled to unit mass, then the retained modes.

    Attributes
    ----------
    pencil : Pencil
        Mass and stiffness of the coordinates without the other modes (Craig–Bampton), dense; its groups are
        the support's, then the patterns distributed over the structure.
    basis : (assembly.n_dof, n) shapes of the coordinates
    boundary : (n_boundary,) DOFs of the assembly
    pinned : UndampedModes
        Modes with the supports' translations fixed (a monopile's rotations too), in these coordinates; they
        define the mode numbers. Other boundary DOFs (a nacelle's dashpot) are free in them.
    radius : float
        Largest |λ| for which F is exact [rad/s].
    terms : (n_terms, n_pairs) K_B, M_B, moments R_k, then p_j p_jᵀ of the summed modes; upper triangles
    mid : (n_mid,) ω_j² of the summed modes
    P : (n_boundary, n_retained) coupling of the retained modes
    w2 : (n_retained,) their ω_j²
    entries : (group, row, column, weight) of the support patterns
    basis_mid : (assembly.n_dof, n_mid) shapes of the summed modes
    coupling_mid : (n_boundary, n_mid) their p_j
    basis_rest : (assembly.n_dof, n_boundary) first moment of the truncated modes' shapes
    """

    pencil: Pencil
    basis: FloatArray
    boundary: IntArray
    pinned: UndampedModes
    radius: float
    terms: FloatArray
    mid: FloatArray
    P: FloatArray
    w2: FloatArray
    entries: tuple[IntArray, IntArray, IntArray, FloatArray]
    basis_mid: FloatArray
    coupling_mid: FloatArray
    basis_rest: FloatArray

    @cached_property
    def cache(self) -> dict[Any, Any]:
        """Results that depend on the structure alone: families by mode numbers."""
        return {}

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self.pencil.n

    @property
    def ranks(self) -> tuple[int, ...]:
        """Rank of each group's pattern, equal to the number of poles of F due to one Maxwell branch."""
        return tuple(int(np.linalg.matrix_rank(group.S)) for group in self.pencil.groups)

    def arrays(self) -> tuple[Any, ...]:
        """Return the tuple ``model`` of :mod:`jackettwin.response.condensation.kernels`."""
        n_moments = self.terms.shape[0] - self.mid.size
        return (self.terms, n_moments, self.mid, self.P, self.w2, *self.entries)

    def expand(self, pole: complex, x: ComplexArray) -> ComplexArray:
        """Return the shape (assembly.n_dof,) of a mode from its coordinates (n,)."""
        return np.asarray(self.expansion(pole) @ x)

    def expansion(self, pole: complex) -> ComplexArray:
        """Return the shape of each coordinate at a pole, truncated modes included, (assembly.n_dof, n)."""
        a, b = self.pencil.rayleigh.alpha, self.pencil.rayleigh.beta
        mu = (pole * pole + a * pole) / (1.0 + b * pole)
        shapes = self.basis.astype(np.complex128)
        mid = (-mu / (self.mid + mu))[:, None] * self.coupling_mid.T
        shapes[:, : self.boundary.size] += self.basis_mid @ mid - mu * self.basis_rest
        return shapes


def condense(system: System, *, below_hz: float, spread: tuple[Matrix, ...] = ()) -> Condensed:
    """Return the structure condensed to the DOFs that a support law or dashpot acts on.

    Parameters
    ----------
    below_hz : float
        Largest |λ|/2π of the poles that will be requested.
    spread : tuple of (assembly.n_dof, assembly.n_dof)
        Patterns distributed over the structure (mass and damping of water). Their laws act on the coordinates
        without the truncated modes; the error is 4e-5 of f4 for 30 % more water.

    Raises
    ------
    InputError
        If no support has a law, or the steel is overdamped inside the band.
    NumericalError
        If the truncated modes lie too near the band for their moments to converge.
    """
    full = system.pencil
    require(full.groups, "no support has a law", field="support", value="pinned", remedy="give it a law")
    radius = 2.0 * pi * below_hz
    check_rayleigh(np.array([[full.rayleigh.alpha, full.rayleigh.beta]]), radius)
    b = np.unique(np.concatenate([group.dofs for group in full.groups]))
    inside = _Inside(full, b, radius)
    scale = 1.0 / np.sqrt(np.diag(inside.mass))
    # distributed patterns act on retained coordinates only: more of them make up for the truncated modes
    n_retained = int(np.searchsorted(inside.omega, (_SUMMED if spread else _RETAINED) * radius))
    P = scale[:, None] * inside.P[:, :n_retained]
    terms, mid = inside.terms(scale, n_retained, radius)
    T = np.zeros((full.n, b.size + n_retained))
    T[b, np.arange(b.size)] = scale
    T[inside.i, : b.size], T[inside.i, b.size :] = (inside.constraint * scale, inside.phi[:, :n_retained])
    pencil = Pencil(
        _symmetric(T.T @ (full.M @ T)),
        _symmetric(T.T @ (full.K @ T)),
        full.rayleigh,
        tuple(
            replace(group, S=_pattern(group.S, b, scale, T.shape[1]), dofs=np.searchsorted(b, group.dofs))
            for group in full.groups
        )
        + tuple(Group(Prony(c=1.0), _on(system.expand(T), S), np.arange(T.shape[1])) for S in spread),
    )
    return Condensed(
        pencil=pencil,
        basis=system.expand(T),
        boundary=system.free[b],
        pinned=_pinned(pencil, _held(system, system.free[b]), system, system.expand(T)),
        radius=radius,
        terms=terms,
        mid=mid,
        P=P,
        w2=inside.omega[:n_retained] ** 2,
        entries=_entries(pencil),
        basis_mid=_placed(system, inside.i, inside.phi[:, n_retained:]),
        coupling_mid=scale[:, None] * inside.P[:, n_retained:],
        basis_rest=_placed(system, inside.i, inside.rest * scale),
    )


def widest_band_hz(beta: float) -> float:
    """Return the highest upper limit of a band [Hz] for stiffness-proportional damping β [s] of the steel."""
    return _STEEPEST / (2.0 * pi * beta) if beta > 0.0 else inf


def strongest_beta(radius: float) -> float:
    """Return the largest stiffness-proportional damping β [s] for a band of this radius [rad/s]."""
    return _STEEPEST / radius


def check_rayleigh(rayleigh: FloatArray, radius: float) -> None:
    """Raise an error if the steel is overdamped inside the band.

    Parameters
    ----------
    rayleigh : (n_sets, 2) a and b

    Raises
    ------
    InputError
        If b·|λ| exceeds what the moments of the truncated modes allow.
    """
    worst = float(rayleigh[:, 1].max(initial=0.0))
    if radius > 2.0 * pi * widest_band_hz(worst):
        raise InputError(
            "stiffness-proportional damping of the steel is too strong for the band of the requested modes",
            field="damping.rayleigh",
            value=worst,
            allowed=f"β ≤ {strongest_beta(radius):.3g} s",
            remedy=f"leave out the highest modes, which extend the band to {radius / (2.0 * np.pi):.3g} Hz, "
            "or state less damping",
        )


class _Inside:
    """The interior with the boundary fixed: static shapes, modes, couplings and the truncated remainder."""

    def __init__(self, full: Pencil, b: IntArray, radius: float) -> None:
        K, M = sp.csc_array(full.K), sp.csc_array(full.M)
        self.i = i = np.setdiff1d(np.arange(full.n), b)
        K_ii, self.M_ii = sp.csc_array(K[i][:, i]), sp.csc_array(M[i][:, i])
        self.solve = spla.splu(sp.csc_matrix(K_ii)).solve
        K_ib, M_ib = K[i][:, b].toarray(), M[i][:, b].toarray()
        self.constraint = Psi = -self.solve(K_ib)
        self.stiffness = _symmetric(K[b][:, b].toarray() + K_ib.T @ Psi)
        load = self.M_ii @ Psi + M_ib
        self.mass = _symmetric(M[b][:, b].toarray() + M_ib.T @ Psi + Psi.T @ load)
        self.omega, self.phi = _modes_up_to(K_ii, self.M_ii, _SUMMED * radius)
        self.P = load.T @ self.phi
        self.load = load - self.M_ii @ (self.phi @ self.P.T)
        self.rest = self._clean(self.solve(self.load))
        """First moment of the truncated modes' shapes, K⁻¹ load without the known modes."""

    def _clean(self, Z: FloatArray) -> FloatArray:
        """Return Z without the known modes, whose rounding errors would grow from moment to moment."""
        return np.asarray(Z - self.phi @ (self.phi.T @ (self.M_ii @ Z)))

    def terms(self, scale: FloatArray, n_retained: int, radius: float) -> tuple[FloatArray, FloatArray]:
        """Return the packed terms of S0 and ω_j² of the summed modes."""
        outer = np.outer(scale, scale)
        upper = np.triu_indices(scale.size)
        packed = [(outer * self.stiffness)[upper], (outer * self.mass)[upper]]
        Z, size = self.rest, 1.0
        while True:
            R = (outer * _symmetric(self.load.T @ Z))[upper]
            # relative to M_B, whose diagonal is one after scaling
            size = float(np.abs(R).max(initial=0.0)) * (1.05 * radius) ** (2 * (len(packed) - 1))
            if size < _TAIL:
                break
            if len(packed) > _MOST_MOMENTS:
                raise NumericalError(
                    f"the moments of the truncated modes do not converge below {radius / (2.0 * pi):.3g} Hz"
                )
            packed.append(R)
            Z = self._clean(self.solve(self.M_ii @ Z))
        mid = self.P[:, n_retained:]
        products = [(outer * np.outer(p, p))[upper] for p in mid.T]
        return np.array(packed + products), self.omega[n_retained:] ** 2


def _modes_up_to(K: sp.csc_array, M: sp.csc_array, limit: float) -> tuple[FloatArray, FloatArray]:
    """Return all fixed-interface modes with ω below ``limit``."""
    number = 40
    while True:
        omega, phi = lowest_modes(K, M, number)
        if omega[-1] >= limit or omega.size < number or number >= K.shape[0]:
            keep = omega < limit
            return omega[keep], phi[:, keep]
        number *= 2


def _on(basis: FloatArray, S: Matrix) -> FloatArray:
    return _symmetric(basis.T @ (S @ basis))


def _pattern(S: Any, b: IntArray, scale: FloatArray, n: int) -> FloatArray:
    full = np.zeros((n, n))
    full[: b.size, : b.size] = sp.csc_array(S)[b][:, b].toarray() * np.outer(scale, scale)
    return full


def _entries(pencil: Pencil) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    parts = []
    for g, group in enumerate(pencil.groups):
        rows, columns = np.nonzero(group.S)
        parts.append((np.full(rows.size, g), rows, columns, group.S[rows, columns]))
    group_, row, column, weight = (np.concatenate(part) for part in zip(*parts, strict=True))
    return group_, row, column, weight


def _held(system: System, boundary: IntArray) -> IntArray:
    """Return the boundary coordinates that are fixed by the pinned feet on which modes are numbered."""
    held = dict(standing(system.assembly.structure).fixed)
    pins = [
        system.assembly.dofs(spring.node)[list(held.get(spring.node, TRANSLATIONS))]
        for spring in system.support.springs
    ]
    return np.flatnonzero(np.isin(boundary, pins))


def _pinned(pencil: Pencil, held: IntArray, system: System, basis: FloatArray) -> UndampedModes:
    free = np.setdiff1d(np.arange(pencil.n), held)
    w, x = la.eigh(pencil.K[np.ix_(free, free)], pencil.M[np.ix_(free, free)])
    shapes = np.zeros((pencil.n, free.size))
    shapes[free] = x
    omega = np.sqrt(np.maximum(w, 0.0))
    return UndampedModes(omega, aligned_coordinates(system.assembly, basis, omega, shapes))


def _placed(system: System, i: IntArray, x: FloatArray) -> FloatArray:
    full = np.zeros((system.pencil.n, x.shape[1]))
    full[i] = x
    return system.expand(full)


def _symmetric(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)
