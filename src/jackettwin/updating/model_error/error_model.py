"""Errors of a model: tolerances that affect all modes together, and a small remainder of each mode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response import Condensed, NumberedModes
from jackettwin.updating.data.targets import Residuals
from jackettwin.updating.model_error.directions import Tolerance, ToleranceDirections
from jackettwin.updating.model_error.measured_axes import PairDirection, on_measured_axes


@dataclass(frozen=True, eq=False)
class DrawnErrors:
    """Draws of the model's errors given the data.

    Attributes
    ----------
    errors : (n_sets, n) errors in their stated standard deviations; NaN where a mode is lost
        Tolerances first, then the remainders of the data.
    scale : (n_sets,) common factor on all standard deviations
    """

    errors: FloatArray
    scale: FloatArray


@dataclass(frozen=True, eq=False)
class ErrorModel:
    """Errors of a model, independent and in units of their standard deviations.

    The first are the tolerances of ``directions``, the others a remainder of each datum by its name, ``f1``
    or ``ζ4``. They are common to all operating states, so that more records do not average them out.
    Tolerances may also be common to turbines of one design, by their name.

    Attributes
    ----------
    directions : ToleranceDirections
    remainder : {datum: standard deviation of its logarithm}
        Remainders that differ from the usual one.
    usual_frequency, usual_damping : float
        Standard deviation of the logarithm of any other mode's frequency and damping ratio.
    scales : tuple of float
        Equally likely common factors on all of these standard deviations, which are themselves estimates. The
        posterior and the predictions weight the factors by the data; χ², the search and the objections use
        the stated sizes.
    pairs : tuple of PairDirection
        Measured axes of bending pairs, on which the errors of a symmetric structure act.
    """

    directions: ToleranceDirections
    remainder: Mapping[str, float] = field(default_factory=dict)
    usual_frequency: float = 0.0
    usual_damping: float = 0.0
    scales: tuple[float, ...] = (1.0,)
    pairs: tuple[PairDirection, ...] = ()

    @property
    def tolerances(self) -> tuple[Tolerance, ...]:
        """The tolerances of the directions, in their order."""
        return tuple(one.tolerance for one in self.directions.each)

    def on(self, condensed: Condensed) -> ErrorModel:
        """Return the same errors on another condensed model of the structure, with a wider band."""
        if condensed is self.directions.condensed:
            return self
        return replace(self, directions=replace(self.directions, condensed=condensed))

    def own(self, datum: str) -> float:
        """Return the standard deviation of the remainder of a datum."""
        usual = {"f": self.usual_frequency, "ζ": self.usual_damping}.get(datum[:1], 0.0)
        return self.remainder.get(datum, usual)

    def gains(self, residuals: Residuals, found: NumberedModes, data: tuple[str, ...]) -> FloatArray:
        """Return Γ (n_sets, count, n): tolerances, then remainders of ``data``.

        Parameters
        ----------
        found : the residuals' modes
        data : names of all data with a remainder, including those of other operating states
        """
        common = residuals.gains(found.poles, self._slopes(found))
        own = np.zeros((residuals.count, len(data)))
        for row, name in enumerate(residuals.names):
            own[row, data.index(name)] = self.own(name)
        remainder = residuals.shift_jacobian(own)
        return np.concatenate([common, np.broadcast_to(remainder, (len(common), *remainder.shape))], axis=2)

    def factors(
        self, found: NumberedModes, drawn: DrawnErrors, data: tuple[str, ...], rng: np.random.Generator
    ) -> FloatArray:
        """Return the factors of drawn errors on frequencies and damping ratios, (3, n_sets, n_modes).

        The third is the part of the factors on damping ratios that is due to errors of the ground's loss.

        Parameters
        ----------
        found : any modes; the remainder of a mode without data is drawn here
        drawn : n_sets draws of :meth:`jackettwin.updating.Problem.drawn_errors`
        data : names of the data whose remainders follow the tolerances
        """
        n, errors = len(self.tolerances), drawn.errors
        shifts, loss = self.shifts(found), [bool(one.loss_growth) for one in self.directions.each]
        shift = np.einsum("vkmn,kn->vkm", shifts, errors[:, :n])
        by_loss = np.einsum("kmn,kn->km", shifts[1], np.where(loss, errors[:, :n], 0.0))
        for v, letter in enumerate(("f", "ζ")):
            for m, mode in enumerate(found.modes):
                name = f"{letter}{mode}"
                fresh = drawn.scale * rng.standard_normal(len(errors))
                own = errors[:, n + data.index(name)] if name in data else fresh
                shift[v, :, m] += self.own(name) * own
        return np.asarray(np.exp(np.concatenate([shift, by_loss[None]])))

    def shifts(self, found: NumberedModes) -> FloatArray:
        """Return d ln f and d ln ζ of any modes by the tolerances, (2, n_sets, n_modes, n_tolerances)."""
        pole, slopes = found.poles[..., None], self._slopes(found)
        size = np.abs(pole)
        radial = (np.conj(pole) * slopes).real / size**2
        return np.stack([radial, slopes.real / pole.real - radial])

    def _slopes(self, found: NumberedModes) -> ComplexArray:
        """Return dλ/dφ (n_sets, n_modes, n_tolerances), of symmetric pairs on their measured axes."""
        return self.directions.slopes(on_measured_axes(found, self.directions.condensed, self.pairs))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the tolerances."""
        return tuple(tolerance.name for tolerance in self.tolerances)
