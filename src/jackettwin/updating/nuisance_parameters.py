"""Free parameters other than those of the support law: the rotor's dashpots, water, damping of the steel.

An installed package adds one by an entry point in ``jackettwin.parameters`` that is a
:class:`NuisanceParameter` with a ``matrix``; a twin file selects it by name in ``update.parameters``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import look_up, require
from jackettwin.plugins import plugins_of_type
from jackettwin.response import Matrix
from jackettwin.soil import K0, MASS, OMEGA0, C, Law, Parameter, Prony, Spring
from jackettwin.structure import Assembly, Rayleigh

DASHPOTS = {"c_fore_aft": 0, "c_side_side": 1}
"""Dashpots on the top node with their directions: x and y of the nacelle at zero yaw."""
PLUGINS = "jackettwin.parameters"
"""Entry points of packages that add parameters: each is a :class:`NuisanceParameter`."""


@dataclass(frozen=True)
class NuisanceParameter:
    """A free parameter other than those of the support law: the size of a matrix on the structure's DOFs.

    Attributes
    ----------
    parameter : Parameter
        Its name, bounds and prior.
    acts_as : {"stiffness", "damping", "mass"}
        Meaning of the matrix.
    at_rest : float
        Value that is contained in the structure's matrices: 1 for a factor on mass that they include.
    matrix : function of the assembly, optional
        Returns the symmetric matrix for a value of 1, (assembly.n_dof, assembly.n_dof). None if it is given
        by other keys of the twin file (``update.rotor``, ``water``).
    """

    parameter: Parameter
    acts_as: Literal["stiffness", "damping", "mass"]
    at_rest: float = 0.0
    matrix: Callable[[Assembly], Matrix] | None = None


NUISANCE_PARAMETERS = {
    one.parameter.name: one
    for one in (
        NuisanceParameter(Parameter("c_fore_aft", 1e2, 1e7, "N·s/m"), "damping"),
        NuisanceParameter(Parameter("c_side_side", 1e2, 1e7, "N·s/m"), "damping"),
        # factors on the water: C_a and growth are known to 20 %, C_D and the sea to 50 %
        NuisanceParameter(Parameter("water_mass", 0.5, 2.0, "-", 1.0, 0.2), "mass", at_rest=1.0),
        NuisanceParameter(Parameter("water_damping", 0.05, 20.0, "-", 1.0, 0.5), "damping"),
    )
}


def nuisance_parameters() -> dict[str, NuisanceParameter]:
    """Return all nuisance parameters by name, including those of installed packages."""
    added = plugins_of_type(PLUGINS, NuisanceParameter).values()
    return {**NUISANCE_PARAMETERS, **{one.parameter.name: one for one in added}}


def matrix_of(name: str, *, field: str = "update.parameters") -> Callable[[Assembly], Matrix]:
    """Return the function for the matrix of a parameter of an installed package.

    Raises
    ------
    InputError
        If there is no such parameter, or it belongs to another key of the twin file.
    """
    table = {known: one.matrix for known, one in nuisance_parameters().items() if one.matrix is not None}
    remedy = "install the package that adds it; dashpots, water and steel_damping have separate keys"
    return look_up(table, name, "parameter in addition to the law's", field=field, remedy=remedy)


_PLACES = {"stiffness": K0, "damping": C, "mass": MASS}
STEEL = (Parameter("rayleigh_ratio", 1e-4, 0.03, "-"), Parameter("rayleigh_frequency_hz", 0.1, 1.0, "Hz"))
"""Smallest damping ratio of the steel and its frequency: wide bounds, narrowed if they would overdamp a
mode."""


@dataclass(frozen=True)
class NuisanceParameters:
    """Free parameters other than those of the support law.

    Attributes
    ----------
    dashpots : tuple of str
        Names from ``DASHPOTS``.
    rayleigh : bool
        Whether ratio and frequency of the steel's smallest damping are free.
    patterns : {dashpot: (6, 6)}
        Matrix of a dashpot of 1 N·s/m on the top node's translations and rotations; by default on one
        translation.
    matrices : {parameter: (assembly.n_dof, assembly.n_dof)}
        Matrices of the other parameters of :func:`nuisance_parameters` at a value of one: mass of water and
        growth in the assembly, damping by drag.
    given : {name: (assembly.n_dof, assembly.n_dof)}
        Damping that is not free: modal damping of the structure.
    """

    dashpots: tuple[str, ...] = ()
    rayleigh: bool = False
    patterns: Mapping[str, FloatArray] = field(default_factory=dict)
    matrices: Mapping[str, Matrix] = field(default_factory=dict)
    given: Mapping[str, Matrix] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.dashpots:
            look_up(DASHPOTS, name, "dashpot", field="update.dashpots")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters in the order of the vector: dashpots, those with matrices, then the steel's."""
        table = nuisance_parameters()
        own = (table[name].parameter for name in (*self.dashpots, *self.matrices))
        return (*own, *(STEEL if self.rayleigh else ()))

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

    def effects(self, values: FloatArray) -> tuple[Matrix | None, tuple[tuple[Matrix, Law], ...]]:
        """Return the added mass matrix (None if zero), and matrices with their stiffness or damping laws."""
        table = nuisance_parameters()
        mass: Matrix | None = None
        spread: list[tuple[Matrix, Law]] = []
        for (name, matrix), value in zip(self.matrices.items(), values[len(self.dashpots) :], strict=False):
            kind = table[name]
            added = (value - kind.at_rest) * matrix
            if kind.acts_as == "mass":
                mass = added if mass is None else mass + added
            else:
                spread.append((added, Prony(c=1.0) if kind.acts_as == "damping" else Prony(k0=1.0)))
        spread += [(matrix, Prony(c=1.0)) for matrix in self.given.values()]
        return mass, tuple(spread)

    def rows(self, values: FloatArray, width: int) -> tuple[FloatArray, FloatArray]:
        """Return the law rows of dashpots and matrices (n_sets, n_groups, width), d rows/d ln θ (…, n_extra).

        Parameters
        ----------
        values : (n_sets, n_extra)
        """
        n_sets, n_extra = values.shape
        table, names = nuisance_parameters(), (*self.dashpots, *self.matrices)
        rows = np.zeros((n_sets, len(names) + len(self.given), width))
        rows[..., OMEGA0] = 1.0
        rows[:, len(names) :, C] = 1.0
        jacobian = np.zeros((*rows.shape, n_extra))
        for j, name in enumerate(names):
            place = _PLACES[table[name].acts_as]
            rows[:, j, place] = values[:, j] - table[name].at_rest
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
        """Raise an error if the water would have more mass than the structure that includes it.

        Parameters
        ----------
        mass : (n, n) mass of the structure, including water
        patterns : (n, n) matrices of dashpots and parameters
        low : smallest factor on the water's mass

        Raises
        ------
        InputError
            If the mass at the smallest factor is not positive definite.
        """
        if "water_mass" not in self.matrices:
            return
        water = patterns[len(self.dashpots) + list(self.matrices).index("water_mass")]
        require(
            np.linalg.eigvalsh(mass - (1.0 - low) * water)[0] > 0.0,
            "the structure's mass cannot include that much water",
            field="water.adds_mass",
            value=False,
            remedy="adds_mass: true if the structure has the mass of its steel; else less growth or C_a",
        )
