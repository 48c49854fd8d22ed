r"""First-order effects of the structure's tolerances on poles.

A tolerance φ changes the mass and the stiffness of the structure by φ∂M and φ∂K, and a pole by

.. math:: \frac{∂λ}{∂φ} = -\frac{x^T [(λ^2 + aλ)\,∂M + (1 + bλ)\,∂K]\, x}{x^T F'(λ)\, x},

for symmetric F (Adhikari 2001). It is computed from the shapes that
:func:`jackettwin.response.numbered_poles` returns, for matrices that are distributed over the whole
structure.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError, NumericalError
from jackettwin.response import Condensed, Matrix, NumberedModes, System, UndampedModes, undamped_modes
from jackettwin.soil import Support, law_slope, law_stiffness
from jackettwin.structure import Assembly, Structure

_CHECKED = 30
"""Number of modes that a drawn structure must have."""
_SPLIT = 0.5
"""Regularisation near the resonance of a mass on springs: its effect is x(1 − x)/((1 − x)² + 0.5²), x =
(ω/ω_b)², instead of x/(1 − x), which is unbounded there."""


@dataclass(frozen=True)
class Tolerance:
    """A property of the structure that drawings, weighing or the sea leave uncertain.

    Attributes
    ----------
    name : str
        Name in a twin file, e.g. ``rna_mass``.
    words : str
        Name in sentences, e.g. "mass of the rotor–nacelle assembly".
    std : float
        Standard deviation about the value in the twin.
    unit : str
        Unit of ``std``; ``-`` for a share of the stated value.
    source : str
        Source of the size.
    settled_by : str
        Action that would determine it, as an imperative.
    beyond : str
        Of a suspect, the tolerance that allows for some of the same: whether the data ask for the suspect, or
        would show it, is judged as if nobody had allowed for it.
    one_sided : bool
        Whether only a positive size is possible: blades are not stiffer than rigid.
    """

    name: str
    words: str
    std: float
    unit: str
    source: str
    settled_by: str
    beyond: str = ""
    one_sided: bool = False


@dataclass(frozen=True)
class Direction:
    """Change of a structure due to one standard deviation of a tolerance.

    Attributes
    ----------
    mass, stiffness : (assembly.n_dof, assembly.n_dof), or None without a change
    feet : (n_feet, 6), optional
        Relative change of the stiffness of each foot's DOFs, in the order of the reaction nodes.
    loss_growth : float
        Power p of the frequency by which the ground's loss increases in addition to its law. The storage
        stiffness changes accordingly (Kramers–Kronig relation for slow changes: d ln Re D/d ln ω = 2/π · Im
        D/Re D), so that ∂D = p (i − 2/π) Im D ln(ω/ω₁), with ω₁ the first pinned frequency.
    resonance_hz : float
        Resonance frequency of a mass on springs, as of blades: below it the effective mass is larger, above
        it negative. Zero for a rigidly attached mass.
    """

    tolerance: Tolerance
    mass: Matrix | None = None
    stiffness: Matrix | None = None
    feet: FloatArray | None = None
    loss_growth: float = 0.0
    resonance_hz: float = 0.0


def moved_along(
    assembly: Assembly, directions: Sequence[Direction], amounts: FloatArray
) -> tuple[Assembly, FloatArray]:
    """Return a structure that differs along directions, and by which share its feet do, (n_feet, 6).

    Loss that grows otherwise changes neither; a mass on springs of its own is left as it is.

    Parameters
    ----------
    amounts : (n_directions,) in their standard deviations
    """
    mass, stiffness = assembly.mass, assembly.stiffness
    shares = np.zeros((len(assembly.structure.reaction_nodes), 6))
    for amount, one in zip(amounts, directions, strict=True):
        mass = mass if one.mass is None or one.resonance_hz else mass + amount * one.mass
        stiffness = stiffness if one.stiffness is None else stiffness + amount * one.stiffness
        shares += 0.0 if one.feet is None else amount * one.feet
    return replace(assembly, mass=mass, stiffness=stiffness), shares


def possible(
    make: Callable[[FloatArray], System], amounts: FloatArray, *, near: UndampedModes | None = None
) -> System:
    """Return the structure at drawn amounts, or at half of them, until it has modes.

    Drawn to first order, growth that is not there may take more mass from a thin brace than it has.

    Parameters
    ----------
    near : modes of a similar structure, from which those of this one are found soon
    """
    for share in (1.0, 0.5, 0.25) if amounts.any() else ():
        system = make(share * amounts)
        try:
            number = min(_CHECKED, system.free.size) if near is None else near.omega.size
            undamped_modes(system, number, near=near)
        except (InputError, NumericalError):
            continue
        return system
    return make(0.0 * amounts)


def on_unlike_feet(support: Support, structure: Structure, shares: FloatArray) -> Support:
    """Return a support whose feet are stiffer by these shares (n_feet, 6) of their logarithms."""
    factors = {
        node: np.exp(0.5 * (own[:, None] + own))
        for node, own in zip(structure.reaction_nodes, shares, strict=True)
    }
    springs = tuple(replace(s, matrix=s.matrix * factors.get(s.node, 1.0)) for s in support.springs)
    return replace(support, springs=springs)


@dataclass(frozen=True, eq=False)
class ToleranceDirections:
    """Effects of tolerances on a condensed structure.

    Attributes
    ----------
    assembly : Assembly
    condensed : Condensed
        Condensed model of that assembly.
    each : tuple of Direction
    n_soil : int
        Number of leading groups of the condensed model that belong to the ground.
    """

    assembly: Assembly
    condensed: Condensed
    each: tuple[Direction, ...]
    n_soil: int = 0

    @cached_property
    def _patterns(self) -> dict[int, FloatArray]:
        """Columns of :meth:`_columns` by mode number."""
        return {}

    @cached_property
    def _upper(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Rows and columns of an upper triangle, and the factor of each entry in a quadratic form."""
        i, j = np.triu_indices(self.condensed.n)
        return i, j, np.where(i == j, 1.0, 2.0)

    def _columns(self, mode: int) -> FloatArray:
        """Return M, the supports' patterns, then ∂M, ∂K and the feet's patterns on a mode's coordinates.

        Shape (n(n + 1)/2, n_columns). The coordinates' shapes include truncated modes at the mode's frequency
        on pinned feet, which is near all of its poles.
        """
        if mode not in self._patterns:
            condensed = self.condensed
            shapes = condensed.expansion(1j * condensed.pinned.omega[mode - 1]).real
            n, (i, j, weight) = condensed.n, self._upper

            def packed(matrix: FloatArray) -> FloatArray:
                return np.asarray(weight * matrix[i, j])

            def spread(matrix: Matrix | None) -> FloatArray:
                return packed(np.zeros((n, n)) if matrix is None else shapes.T @ (matrix @ shapes))

            columns = [spread(self.assembly.mass), packed(condensed.pencil.K)]
            columns += [packed(group.S) for group in condensed.pencil.groups]
            columns += [spread(one.mass) for one in self.each]
            columns += [spread(one.stiffness) for one in self.each]
            shares = [one.feet for one in self.each if one.feet is not None]
            columns += [packed(S) for share in shares for S in self._on_feet(share)]
            self._patterns[mode] = np.array(columns).T
        return self._patterns[mode]

    def _on_feet(self, shares: FloatArray) -> list[FloatArray]:
        """Return the changes of the support groups' patterns due to relative changes of the feet."""
        condensed, factor = self.condensed, np.zeros(self.condensed.n)
        for node, share in zip(self.assembly.structure.reaction_nodes, shares, strict=True):
            for dof, own in zip(self.assembly.dofs(node), share, strict=True):
                factor[np.flatnonzero(condensed.boundary == dof)] = own
        # a foot's pattern acts on the DOFs of that foot only
        return [group.S * 0.5 * (factor[:, None] + factor[None, :]) for group in condensed.pencil.groups]

    def slopes(self, found: NumberedModes) -> ComplexArray:
        """Return dλ/dφ (n_sets, n_modes, n_directions), with φ in standard deviations."""
        i, j, _ = self._upper
        x = found.shapes
        forms = self._forms(found.modes, x[:, :, i] * x[:, :, j])
        above, below = self._changes(found, found.poles, forms)
        return np.asarray(-above / below[..., None])

    def coupling(self, found: NumberedModes) -> ComplexArray:
        """Return the coupling of two modes by each φ, x₂ᵀ∂F x₁/x₂ᵀF′x₂ (n_sets, n_directions).

        Both forms are taken at the mean of the two poles: the modes of a pair are close.

        Parameters
        ----------
        found : two modes, x₁ and x₂
        """
        i, j, _ = self._upper
        first, second = found.shapes[:, 0], found.shapes[:, 1]
        between = 0.5 * (first[:, i] * second[:, j] + second[:, i] * first[:, j])
        pole = np.repeat(found.poles.mean(axis=1, keepdims=True), 2, axis=1)
        products = np.stack([between, second[:, i] * second[:, j]], axis=1)
        forms = self._forms((found.modes[0],) * 2, products)
        above, below = self._changes(found, pole, forms)
        return np.asarray(above[:, 0] / below[:, 1, None])

    def _forms(self, modes: tuple[int, ...], products: ComplexArray) -> ComplexArray:
        """Return xᵀSy of every column S of :meth:`_columns` from the packed xyᵀ (n_sets, n_modes, ...)."""
        patterns = [self._columns(mode) for mode in modes]
        forms = np.empty((*products.shape[:2], patterns[0].shape[1]), dtype=np.complex128)
        for m, pattern in enumerate(patterns):
            forms[:, m].real = products[:, m].real @ pattern
            forms[:, m].imag = products[:, m].imag @ pattern
        return forms

    def _on_springs(self, pole: ComplexArray) -> FloatArray:
        """Return the factor on each mass at poles, (n_sets, n_modes, n_directions)."""
        own = 2.0 * pi * np.array([one.resonance_hz or np.inf for one in self.each])
        x = (np.abs(pole)[..., None] / own) ** 2
        return np.where(np.isinf(own), 1.0, x * (1.0 - x) / ((1.0 - x) ** 2 + _SPLIT**2))

    def _changes(
        self, found: NumberedModes, pole: ComplexArray, forms: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """Return the forms of ∂F (n_sets, n_modes, n_directions) and of F′ (n_sets, n_modes) at poles."""
        n_groups, n = len(self.condensed.pencil.groups), len(self.each)
        on_feet = [place for place, one in enumerate(self.each) if one.feet is not None]
        a, b = found.rayleigh[:, :1], found.rayleigh[:, 1:]
        below = (2.0 * pole + a) * forms[..., 0] + b * forms[..., 1]
        by_mass, by_stiffness, by_feet = np.split(forms[..., 2 + n_groups :], [n, 2 * n], axis=-1)
        by_mass = by_mass * self._on_springs(pole)
        above = (pole**2 + a * pole)[..., None] * by_mass + (1.0 + b * pole)[..., None] * by_stiffness
        by_feet = by_feet.reshape(*pole.shape, len(on_feet), n_groups)
        powers = np.array([one.loss_growth for one in self.each])
        growth = powers * np.log(np.abs(pole) / self.condensed.pinned.omega[0])[..., None]
        for g in range(n_groups):
            rows = found.rows[:, g, None]
            below = below + law_slope(rows, pole) * forms[..., 2 + g]
            D = law_stiffness(rows, pole)[..., None]
            above[..., on_feet] += D * by_feet[..., g]
            if g < self.n_soil:
                above += (1j - 2.0 / pi) * D.imag * growth * forms[..., 2 + g, None]
        return above, below
