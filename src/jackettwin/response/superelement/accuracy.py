"""Accuracy of a superelement: poles of the full model compared with those of the reduced one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linear_sum_assignment

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.response.modes.poles import damping_ratio, poles_below
from jackettwin.response.superelement.craig_bampton import (
    INTERFACE,
    Superelement,
    interface_centroid,
    interface_motion,
    poles,
)
from jackettwin.response.system import Pencil, System
from jackettwin.structure import AT_REST, Assembly, Rayleigh, dense, lowest_modes

_OVERDAMPED = 0.3
"""Damping ratio above which poles are motions of the supports, for which no superelement is used."""


@dataclass(frozen=True)
class ReducedModes:
    """Poles of the full model and, for each, the nearest pole of the reduced one.

    Attributes
    ----------
    full, reduced : (n_modes,) λ [rad/s], by |λ|
    missing : number of modes of the full model for which the reduced one has no coordinates
    """

    full: ComplexArray
    reduced: ComplexArray
    missing: int = 0

    @property
    def frequency_error(self) -> FloatArray:
        """Relative error of |λ|."""
        return np.asarray(np.abs(self.reduced) / np.abs(self.full) - 1.0)

    @property
    def damping_error(self) -> FloatArray:
        """Error of the damping ratio, as a difference."""
        return damping_ratio(self.reduced) - damping_ratio(self.full)


def reduced_modes(
    element: Superelement, full: System, rest: Assembly | None, *, band_hz: float
) -> ReducedModes:
    """Return the modes of the structure up to ``band_hz``, with the full model and with the superelement.

    Parameters
    ----------
    full : System
        The full structure on its support.
    rest : Assembly, optional
        Structure on the interface.
    """
    exact = np.array([pole for pole, _ in poles_below(tied(full), 2.0 * pi * band_hz)])
    exact = exact[(exact.imag > 0.0) & (damping_ratio(exact) < _OVERDAMPED)]
    found = coupled_poles(element, rest, full.pencil.rayleigh)
    found = found[found.imag > AT_REST * np.abs(exact).max(initial=0.0)]
    rows, columns = linear_sum_assignment(np.abs(exact[:, None] - found) / np.abs(exact)[:, None])
    return ReducedModes(exact[rows], found[columns], exact.size - rows.size)


def tied(system: System) -> Pencil:
    """Return the equations of a whole structure whose interface nodes move as one rigid body."""
    pencil = system.pencil
    b, B = interface_motion(system.assembly, interface_centroid(system.assembly.structure))
    if b.size == INTERFACE:
        return pencil
    b = np.searchsorted(system.free, b)
    others = np.setdiff1d(np.arange(pencil.n), b)
    columns = sp.lil_array((pencil.n, INTERFACE + others.size))
    columns[b, :INTERFACE] = B
    columns[others, INTERFACE + np.arange(others.size)] = 1.0
    T = sp.csc_array(columns)

    def on(matrix: sp.csc_array) -> sp.csc_array:
        return sp.csc_array(T.T @ matrix @ T)

    groups = tuple(
        replace(g, S=on(g.S), dofs=INTERFACE + np.searchsorted(others, g.dofs)) for g in pencil.groups
    )
    return Pencil(on(pencil.M), on(pencil.K), pencil.rayleigh, groups)


def coupled_poles(element: Superelement, rest: Assembly | None, rayleigh: Rayleigh) -> ComplexArray:
    """Return all poles of a superelement together with the structure on its interface."""
    if rest is None:
        return poles(element.M, element.C, element.K)
    b, B = interface_motion(rest, element.reference_m)
    others = np.setdiff1d(np.arange(rest.n_dof), b)
    n = element.n + others.size
    T = np.zeros((rest.n_dof, n))
    T[b, :INTERFACE] = B
    T[others, element.n + np.arange(others.size)] = 1.0

    def joined(own: FloatArray, matrix: FloatArray) -> FloatArray:
        total = np.asarray(T.T @ matrix @ T)
        total[: element.n, : element.n] += own
        return total

    M, K = dense(rest.mass), dense(rest.stiffness)
    C = rayleigh.alpha * M + rayleigh.beta * K
    return poles(joined(element.M, M), joined(element.C, C), joined(element.K, K))


def default_band_hz(full: System) -> float:
    """Return the default band [Hz]: 5 % above the fifth mode with locked dampers.

    The second bending pair of a turbine are modes 4 and 5. Rigid-body motions of a floating structure do not
    count.
    """
    pencil = tied(full)
    locked = [group.dofs for group in pencil.groups if group.law.dissipates]
    free = np.setdiff1d(np.arange(pencil.n), np.concatenate([*locked, np.empty(0, dtype=np.intp)]))
    K, M = (sp.csc_array(matrix)[free][:, free] for matrix in (pencil.static_stiffness(), pencil.M))
    omega = lowest_modes(K, M, 5 + DOFS_PER_NODE)[0]
    oscillating = omega[omega > AT_REST * omega[-1]]
    return float(1.05 * oscillating[:5][-1] / (2.0 * pi))


def hertz(pole: ComplexArray) -> FloatArray:
    """Return |λ|/2π."""
    return np.asarray(np.abs(pole) / (2.0 * pi))
