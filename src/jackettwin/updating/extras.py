"""What else may damp a mode, as free parameters: the rotor through dashpots at the nacelle, and the steel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.soil.coefficients import OMEGA0, C
from jackettwin.soil.support import Spring
from jackettwin.soil.viscoelastic import Prony
from jackettwin.structure.damping import Rayleigh
from jackettwin.updating.families import Parameter

FloatArray = npt.NDArray[np.float64]

DASHPOTS = {"c_fore_aft": 0, "c_side_side": 1}
"""Dashpots on the top node and the direction each acts in: x, y, the nacelle at zero yaw."""
_DASHPOT_BOUNDS = (1e2, 1e7, "N·s/m")
# wide, and still inside what the condensed model takes as stiffness-proportional damping
_STEEL = (Parameter("rayleigh_ratio", 1e-4, 0.03, "-"), Parameter("rayleigh_frequency_hz", 0.1, 1.0, "Hz"))


@dataclass(frozen=True)
class Extras:
    """Free parameters beside those of the support law.

    Attributes
    ----------
    dashpots : tuple of str
        Of ``DASHPOTS``.
    rayleigh : bool
        Whether ratio and frequency of the steel's smallest damping are free.
    patterns : {dashpot: (6, 6)}
        What a dashpot of 1 N·s/m is on the top node's translations and rotations; without, a translation's.
    """

    dashpots: tuple[str, ...] = ()
    rayleigh: bool = False
    patterns: Mapping[str, FloatArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.dashpots:
            if name not in DASHPOTS:
                raise InputError(
                    "no such dashpot", field="update.dashpots", value=name, allowed=", ".join(DASHPOTS)
                )

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters in the order of the vector: dashpots, then the steel's."""
        steel = _STEEL if self.rayleigh else ()
        return (*(Parameter(name, *_DASHPOT_BOUNDS) for name in self.dashpots), *steel)

    def springs(self, node: str, values: FloatArray) -> tuple[Spring, ...]:
        """Return the dashpots on a node at these values of the extra parameters."""
        springs = []
        for name, c in zip(self.dashpots, values, strict=False):
            direction = np.zeros((6, 6))
            direction[DASHPOTS[name], DASHPOTS[name]] = 1.0
            springs.append(Spring(node, self.patterns.get(name, direction), Prony(c=float(c))))
        return tuple(springs)

    def steel(self, fixed: Rayleigh, values: FloatArray) -> Rayleigh:
        """Return the steel's damping at these values of the extra parameters."""
        return Rayleigh.minimum(float(values[-2]), float(values[-1])) if self.rayleigh else fixed

    def rows(self, values: FloatArray, width: int) -> tuple[FloatArray, FloatArray]:
        """Return the dashpots' law rows (n_sets, n_dashpots, width) and d rows/d ln θ (…, n_extra).

        Parameters
        ----------
        values : (n_sets, n_extra)
        """
        n_sets, n_extra = values.shape
        rows = np.zeros((n_sets, len(self.dashpots), width))
        rows[..., OMEGA0] = 1.0
        jacobian = np.zeros((*rows.shape, n_extra))
        for j in range(len(self.dashpots)):
            rows[:, j, C] = jacobian[:, j, C, j] = values[:, j]
        return rows, jacobian

    def rayleigh_rows(self, fixed: Rayleigh, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return α = ζω, β = ζ/ω, (n_sets, 2), and their derivatives by ln θ, (n_sets, 2, n_extra)."""
        n_sets, n_extra = values.shape
        jacobian = np.zeros((n_sets, 2, n_extra))
        if not self.rayleigh:
            return np.tile([fixed.alpha, fixed.beta], (n_sets, 1)), jacobian
        ratio, omega = values[:, -2], 2.0 * pi * values[:, -1]
        ab = np.stack([ratio * omega, ratio / omega], axis=1)
        jacobian[:, :, -2] = ab
        jacobian[:, :, -1] = ab * np.array([1.0, -1.0])
        return ab, jacobian
