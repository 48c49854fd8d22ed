"""What else the modes depend on, as free parameters: the rotor's dashpots, the water, the steel's damping."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.response.system import Matrix
from jackettwin.soil import Parameter, Spring
from jackettwin.soil.laws.coefficients import MASS, OMEGA0, C
from jackettwin.soil.laws.viscoelastic import Prony
from jackettwin.structure import Rayleigh

DASHPOTS = {"c_fore_aft": 0, "c_side_side": 1}
"""Dashpots on the top node and the direction each acts in: x, y, the nacelle at zero yaw."""
_DASHPOT_BOUNDS = (1e2, 1e7, "N·s/m")
WATER = {
    "water_mass": Parameter("water_mass", 0.5, 2.0, "-", 1.0, 0.2),
    "water_damping": Parameter("water_damping", 0.05, 20.0, "-", 1.0, 0.5),
}
"""Factors on water that moves with the members, and on its linear drag; C_a and growth are known to a fifth,
C_D and the sea to a half."""
STEEL = (Parameter("rayleigh_ratio", 1e-4, 0.03, "-"), Parameter("rayleigh_frequency_hz", 0.1, 1.0, "Hz"))
"""Ratio and frequency of the steel's least damping: wide, and narrowed where they would overdamp a mode."""


@dataclass(frozen=True)
class NuisanceParameters:
    """Free parameters beside those of the support law.

    Attributes
    ----------
    dashpots : tuple of str
        Of ``DASHPOTS``.
    rayleigh : bool
        Whether ratio and frequency of the steel's smallest damping are free.
    patterns : {dashpot: (6, 6)}
        What a dashpot of 1 N·s/m is on the top node's translations and rotations; without, a translation's.
    water : {factor: (assembly.n_dof, assembly.n_dof)}
        Of ``WATER``: mass of water and growth that the assembly holds, and damping, at a factor of one.
    """

    dashpots: tuple[str, ...] = ()
    rayleigh: bool = False
    patterns: Mapping[str, FloatArray] = field(default_factory=dict)
    water: Mapping[str, Matrix] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.dashpots:
            if name not in DASHPOTS:
                raise InputError(
                    "no such dashpot", field="update.dashpots", value=name, allowed=", ".join(DASHPOTS)
                )

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters in the order of the vector: dashpots, water, then the steel's."""
        dashpots = (Parameter(name, *_DASHPOT_BOUNDS) for name in self.dashpots)
        return (*dashpots, *(WATER[name] for name in self.water), *(STEEL if self.rayleigh else ()))

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

    def water_effects(self, values: FloatArray) -> tuple[Matrix | None, Matrix | None]:
        """Return what comes to the assembly's mass, and the drag's damping, at these values; None without."""
        factor = dict(zip(self.water, values[len(self.dashpots) :], strict=False))
        mass, damping = self.water.get("water_mass"), self.water.get("water_damping")
        return (
            None if mass is None else (factor["water_mass"] - 1.0) * mass,
            None if damping is None else factor["water_damping"] * damping,
        )

    def rows(self, values: FloatArray, width: int) -> tuple[FloatArray, FloatArray]:
        """Return the law rows of dashpots and water (n_sets, n_groups, width) and d rows/d ln θ (…, n_extra).

        Parameters
        ----------
        values : (n_sets, n_extra)
        """
        n_sets, n_extra = values.shape
        names = (*self.dashpots, *self.water)
        rows = np.zeros((n_sets, len(names), width))
        rows[..., OMEGA0] = 1.0
        jacobian = np.zeros((*rows.shape, n_extra))
        for j, name in enumerate(names):
            place, at_rest = (MASS, 1.0) if name == "water_mass" else (C, 0.0)
            rows[:, j, place] = values[:, j] - at_rest
            jacobian[:, j, place, j] = values[:, j]
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

    def check_mass(self, mass: FloatArray, patterns: Sequence[FloatArray], low: float) -> None:
        """Refuse water that weighs more than the structure it is said to be part of.

        Parameters
        ----------
        mass : (n, n) of the structure, water included
        patterns : (n, n) of dashpots and water
        low : least factor on the water's mass

        Raises
        ------
        InputError
            If what is left at the least factor is no mass.
        """
        if "water_mass" not in self.water:
            return
        water = patterns[len(self.dashpots) + list(self.water).index("water_mass")]
        if np.linalg.eigvalsh(mass - (1.0 - low) * water)[0] <= 0.0:
            raise InputError(
                "the structure's mass cannot hold that much water",
                field="water.adds_mass",
                value=False,
                remedy="adds_mass: true if the structure has the mass of its steel; else less growth or C_a",
            )
