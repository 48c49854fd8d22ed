r"""How poles move with what drawings do not fix, to first order.

A tolerance φ changes the mass and the stiffness of the structure by φ∂M and φ∂K, and a pole by

.. math:: \frac{∂λ}{∂φ} = -\frac{x^T [(λ^2 + aλ)\,∂M + (1 + bλ)\,∂K]\, x}{x^T F'(λ)\, x},

F symmetric (Adhikari 2001): the slope that :func:`jackettwin.response.numbered_poles` has for the parameters
of the supports, here from the shapes that it returns, for matrices that are spread over the whole structure.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.response import Condensed, Matrix, NumberedModes
from jackettwin.soil import law_slope, law_stiffness
from jackettwin.structure import Assembly

_SPLIT = 0.5
"""Relative distance of squares within which a mode and a mass on springs split, so that the mass no longer
counts by x/(1 − x), x = (ω/ω_b)², which has no bound there, but by x(1 − x)/((1 − x)² + 0.5²)."""


@dataclass(frozen=True)
class Tolerance:
    """Something that drawings, weighing or the sea leave open.

    Attributes
    ----------
    name : str
        As a twin file calls it, ``rna_mass``.
    words : str
        As a sentence calls it, "mass of the rotor–nacelle assembly".
    std : float
        Standard deviation about what the twin states.
    unit : str
        Of ``std``; ``-`` for a share of what is stated.
    source : str
        Where the size comes from.
    settled_by : str
        What would settle it, as an imperative.
    beyond : str
        Of a suspect, the tolerance that allows for some of the same: whether the data ask for the suspect, or
        would show it, is judged as if nobody had allowed for it.
    """

    name: str
    words: str
    std: float
    unit: str
    source: str
    settled_by: str
    beyond: str = ""


@dataclass(frozen=True)
class Direction:
    """What one standard deviation of a tolerance does to a structure.

    Attributes
    ----------
    mass, stiffness : (assembly.n_dof, assembly.n_dof), or None where nothing changes
    feet : (n_feet, 6), optional
        Share by which the stiffness of each foot's DOFs changes, in the order of the reaction nodes.
    loss_growth : float
        Power p of the frequency by which the ground's loss grows faster than its law says. What is not lost
        at the frequencies below stiffens the less (Kramers and Kronig, for slow changes: d ln Re D/d ln ω =
        2/π · Im D/Re D), so that ∂D = p (i − 2/π) Im D ln(ω/ω₁), ω₁ the first pinned frequency.
    resonance_hz : float
        Where the mass sits on springs of its own, as blades do: below their frequency it counts as if there
        were more of it, above as if it were missing. Zero of a mass that moves along.
    """

    tolerance: Tolerance
    mass: Matrix | None = None
    stiffness: Matrix | None = None
    feet: FloatArray | None = None
    loss_growth: float = 0.0
    resonance_hz: float = 0.0


@dataclass(frozen=True, eq=False)
class ToleranceDirections:
    """ToleranceDirections on a condensed structure.

    Attributes
    ----------
    assembly : Assembly
    condensed : Condensed
        Of that assembly.
    each : tuple of Direction
    n_soil : int
        How many of the condensed model's groups, the first ones, are the ground's.
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
        """Rows and columns of an upper triangle, and how often each entry counts in a quadratic form."""
        i, j = np.triu_indices(self.condensed.n)
        return i, j, np.where(i == j, 1.0, 2.0)

    def _columns(self, mode: int) -> FloatArray:
        """Return M, the supports' patterns, then ∂M, ∂K and the feet's patterns on a mode's coordinates.

        The coordinates' shapes are those at the mode's frequency on pinned feet, which is near all of its
        poles, so that the truncated modes move along; (n(n + 1)/2, n_columns).
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
        """Return by how much feet that change by these shares change the patterns of the support's groups."""
        condensed, factor = self.condensed, np.zeros(self.condensed.n)
        for node, share in zip(self.assembly.structure.reaction_nodes, shares, strict=True):
            for dof, own in zip(self.assembly.dofs(node), share, strict=True):
                factor[np.flatnonzero(condensed.boundary == dof)] = own
        # a foot's pattern touches its own DOFs alone
        return [group.S * 0.5 * (factor[:, None] + factor[None, :]) for group in condensed.pencil.groups]

    def slopes(self, found: NumberedModes) -> ComplexArray:
        """Return dλ/dφ (n_sets, n_modes, n_directions), each φ in its standard deviations."""
        i, j, _ = self._upper
        x = found.shapes
        forms = self._forms(found.modes, x[:, :, i] * x[:, :, j])
        above, below = self._changes(found, found.poles, forms)
        return np.asarray(-above / below[..., None])

    def coupling(self, found: NumberedModes) -> ComplexArray:
        """Return what each φ adds to the rate between two modes, x₂ᵀ∂F x₁/x₂ᵀF′x₂ (n_sets, n_directions).

        Both forms are taken at the mean of the two poles: the modes of a pair are close.

        Parameters
        ----------
        found : of two modes, x₁ and x₂
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
        """Return by how much each mass counts at poles, (n_sets, n_modes, n_directions)."""
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
