"""Undamped and damped modes of the full model, by sparse methods."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import require
from jackettwin.response.modes.multiple import aligned
from jackettwin.response.modes.poles import REAL, damping_ratio, poles_below
from jackettwin.response.system import System
from jackettwin.structure import AT_REST, below_zero, lowest_modes, refined_modes

_SHOWN = 6
"""Number of modes named when a result is printed."""


@dataclass(frozen=True)
class UndampedModes:
    """Real modes of (K + D(0)) φ = ω² M φ; modes of one frequency are aligned with the global axes.

    Attributes
    ----------
    omega : (n_modes,) [rad/s], ascending
    shapes : (assembly.n_dof, n_modes) mass-normalised
    """

    omega: FloatArray
    shapes: FloatArray

    def __repr__(self) -> str:
        shown = ", ".join(f"{f:.4f}" for f in self.frequency_hz[:_SHOWN])
        return f"UndampedModes({self.omega.size} modes: {shown} Hz)"

    @property
    def frequency_hz(self) -> FloatArray:
        """Natural frequencies [Hz]."""
        return self.omega / (2.0 * pi)

    @property
    def n_at_rest(self) -> int:
        """Number of leading modes that are rigid-body motions of a floating structure, or a mechanism."""
        return int(np.count_nonzero(self.omega <= AT_REST * self.omega.max(initial=0.0)))


@dataclass(frozen=True)
class DampedModes:
    """Complex modes F(λ)x = 0; modes of one pole are aligned with the global axes.

    Attributes
    ----------
    eigenvalues : (n_modes,) λ with Im λ > 0 [rad/s], by |λ|
    shapes : (assembly.n_dof, n_modes)
    real_poles : (n_real,) [rad/s], by |λ|
    """

    eigenvalues: ComplexArray
    shapes: ComplexArray
    real_poles: FloatArray

    def __repr__(self) -> str:
        pairs = zip(self.frequency_hz[:_SHOWN], np.round(self.damping_ratio, 4) + 0.0, strict=False)
        modes = ", ".join(f"{f:.4f} Hz {100 * zeta:.2f} %" for f, zeta in pairs)
        return f"DampedModes({self.eigenvalues.size} modes: {modes}; {self.real_poles.size} real poles)"

    @property
    def frequency_hz(self) -> FloatArray:
        """|λ|/2π [Hz], thesis (4.17)."""
        return np.abs(self.eigenvalues) / (2.0 * pi)

    @property
    def damping_ratio(self) -> FloatArray:
        """−Re λ/|λ|."""
        return damping_ratio(self.eigenvalues)


def undamped_modes(system: System, number: int, *, near: UndampedModes | None = None) -> UndampedModes:
    """Return the ``number`` lowest undamped modes, by sparse shift-invert Lanczos.

    Parameters
    ----------
    near : modes of a similar structure, as many or more, which one step of inverse iteration refines

    Raises
    ------
    InputError
        If the structure is not stable under its own weight.
    NumericalError
        If the iteration does not converge.
    """
    pencil, shift = system.pencil, below_zero(system.pencil.K, system.pencil.M)
    if near is None:
        w, x = lowest_modes(pencil.static_stiffness(), pencil.M, number, shift=shift)
    else:
        x0 = near.shapes[system.free]
        w, x = refined_modes(pencil.static_stiffness(), pencil.M, x0, number, shift=shift)
    return UndampedModes(w, aligned(system.assembly, w, system.expand(x)))


def damped_modes(system: System, *, below_hz: float) -> DampedModes:
    """Return all poles with |λ|/2π below ``below_hz``: oscillating modes and real poles.

    A springpot has a branch cut instead of real poles, so that none is listed.

    Raises
    ------
    InputError
        If ``below_hz`` is not positive.
    NumericalError
        If the iteration or the refinement of a pole does not converge.
    """
    require(0.0 < below_hz < np.inf, "must be positive", field="below_hz", value=below_hz, allowed="> 0")
    pairs = poles_below(system.pencil, 2.0 * pi * below_hz)
    oscillating = [pair for pair in pairs if pair[0].imag > REAL * abs(pair[0])]
    values = np.array([value for value, _ in oscillating], dtype=np.complex128)
    shapes = np.array([x for _, x in oscillating], dtype=np.complex128).reshape(-1, system.pencil.n).T
    return DampedModes(
        values,
        aligned(system.assembly, values, system.expand(shapes)),
        np.array([value.real for value, _ in pairs if abs(value.imag) <= REAL * abs(value)]),
    )
