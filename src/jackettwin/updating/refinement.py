"""Fit of a structure, stage by stage, to known frequencies of its parts (thesis 5.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, require
from jackettwin.response import UndampedModes, build_system, track_modes, undamped_modes
from jackettwin.soil import own_support, standing
from jackettwin.structure import PROPERTIES, Assembly, Structure, adjusted, assemble, foot_stiffness
from jackettwin.updating.refined_quantity import Factor
from jackettwin.updating.steel import only_parts

_STEP = 1e-4
"""Step of the search variable for derivatives of the matrices, which are exact for linear quantities."""
_INSIDE = 0.01
"""Initial distance of the search from a bound, as a share of the range; on a bound it would not move."""
_NOTHING = 1e-12
"""Relative change of a matrix below which it is rounding."""


@dataclass(frozen=True)
class StageFit:
    """A refined structure and the agreement with its frequencies on pinned feet.

    Attributes
    ----------
    factors : mapping of the quantity's name to its value, a factor or an addition
    std : mapping of the quantity's name to the standard deviation of ln of a factor, or of an addition
        Posterior from tolerances and frequencies; infinite if they do not determine it.
    at_bound : names of the quantities that ended on a bound
    modes : mode numbers
    target_hz, before_hz, after_hz : (n_modes,)
    """

    structure: Structure
    factors: Mapping[str, float]
    std: Mapping[str, float]
    at_bound: tuple[str, ...]
    modes: tuple[int, ...]
    target_hz: FloatArray
    before_hz: FloatArray
    after_hz: FloatArray


def fit_stage(
    structure: Structure,
    factors: tuple[Factor, ...],
    target_hz: Mapping[int, float],
    *,
    frequency_std: float = 0.005,
    gravity: bool = False,
    own_feet: bool = False,
) -> StageFit:
    r"""Return the structure with free quantities fitted to the target frequencies on pinned feet.

    Bounded least squares of :math:`\ln(f/f_t)/σ_f` and of the changes of quantities in units of their
    tolerances, with :math:`∂\ln f/∂p = φ^T(∂K/∂p − ω² ∂M/∂p)φ/2ω²`; modes are tracked by shape from the
    start.

    Parameters
    ----------
    frequency_std : float
        Relative standard deviation σ_f of the targets.
    own_feet : bool
        Whether the feet have the stiffness given in the structure's file, instead of being pinned.

    Raises
    ------
    InputError
        If a quantity has no effect, or there are more free quantities without tolerance than frequencies.
        Without quantities the frequencies are only compared.
    """
    modes = tuple(sorted(target_hz))
    free = [f.name for f in factors if f.tolerance is None]
    require(
        len(free) <= len(modes),
        "there are more factors than frequencies",
        field="free",
        value=free,
        allowed=f"up to {len(modes)} factors without tolerance",
        remedy="give them a tolerance",
    )
    problem = _Problem(structure, factors, target_hz, frequency_std, gravity, own_feet)
    low, high = problem.limits
    z = np.clip(0.0, low + _INSIDE * (high - low), high - _INSIDE * (high - low))
    if factors:
        fit = least_squares(
            problem.residuals, z, jac=problem.jacobian, bounds=tuple(problem.limits), xtol=1e-10, x_scale=1.0
        )
        z = fit.x
    low_end, high_end = (np.isclose(z, limit, rtol=0.0, atol=1e-6) for limit in (low, high))
    z, near = np.where(low_end, low, np.where(high_end, high, z)), low_end | high_end
    std = problem.std(z)
    values = [factor.value(place) for factor, place in zip(factors, z, strict=True)]
    return StageFit(
        structure=problem.at(z),
        factors={factor.name: value for factor, value in zip(factors, values, strict=True)},
        std={f.name: float(s * f.scale) for f, s in zip(factors, std, strict=True)},
        at_bound=tuple(f.name for f, on in zip(factors, near, strict=True) if on),
        modes=modes,
        target_hz=problem.target,
        before_hz=problem.frequency_hz(np.zeros(len(factors))),
        after_hz=problem.frequency_hz(z),
    )


class _Problem:
    """Residuals of a stage and their derivatives by the search variables z."""

    def __init__(
        self,
        structure: Structure,
        factors: tuple[Factor, ...],
        target_hz: Mapping[int, float],
        frequency_std: float,
        gravity: bool,
        own_feet: bool,
    ) -> None:
        self.structure, self.factors = structure, factors
        self._gravity, self._own_feet = gravity, own_feet
        modes = sorted(target_hz)
        self.target: FloatArray = np.array([target_hz[mode] for mode in modes])
        self._rows, self._number = [mode - 1 for mode in modes], max(modes) + 3
        self._start = self._assembled(np.zeros(len(factors)))
        self._reference = self._modes(self._start)
        places = [[f.place(bound) for bound in f.bounds] for f in factors]
        self.limits: FloatArray = np.array(places).reshape(-1, 2).T
        self._weights: FloatArray = np.array([f.scale / f.tolerance if f.tolerance else 0.0 for f in factors])
        self._frequency_std = frequency_std
        for i, factor in enumerate(factors):
            with located(field=f"free.{i}"):
                self._require_effect(i, factor)

    def at(self, z: FloatArray) -> Structure:
        """Return the structure at a point z."""
        structure = self.structure
        for factor, place in zip(self.factors, z, strict=True):
            if place != 0.0:
                structure = factor.on(structure, factor.value(float(place)))
        return structure

    def frequency_hz(self, z: FloatArray) -> FloatArray:
        """Return the frequencies of the targets' modes."""
        return self._followed(z)[0] / (2.0 * np.pi)

    def residuals(self, z: FloatArray) -> FloatArray:
        """Return ln(f/target) in standard deviations, then the quantities in their tolerances."""
        off = np.log(self.frequency_hz(z) / self.target) / self._frequency_std
        return np.concatenate([off, self._weights * z])

    def jacobian(self, z: FloatArray) -> FloatArray:
        """Return the derivatives of the residuals by z."""
        omega, phi = self._followed(z)
        slopes = np.empty((omega.size, z.size))
        for j in range(z.size):
            dK, dM = self._slopes_of_matrices(z, j)
            stiffness = np.einsum("ij,ij->j", phi, dK @ phi)
            slopes[:, j] = (stiffness - omega**2 * np.einsum("ij,ij->j", phi, dM @ phi)) / (2.0 * omega**2)
        return np.vstack([slopes / self._frequency_std, np.diag(self._weights)])

    def std(self, z: FloatArray) -> FloatArray:
        """Return standard deviations of z; infinite where neither targets nor tolerances determine it."""
        if not z.size:
            return z
        J = self.jacobian(z)
        values, vectors = np.linalg.eigh(J.T @ J)
        told = values > _NOTHING * values[-1]
        variance = vectors[:, told] ** 2 @ (1.0 / values[told])
        untold = (vectors[:, ~told] ** 2).sum(axis=1) > _NOTHING
        return np.where(untold, np.inf, np.sqrt(variance))

    def _assembled(self, z: FloatArray) -> Assembly:
        return assemble(self.at(z), gravity=self._gravity)

    def _modes(self, assembly: Assembly) -> UndampedModes:
        feet = own_support if self._own_feet else standing
        return undamped_modes(build_system(assembly, feet(assembly.structure)), self._number)

    def _followed(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ω and φ of the targets' modes, tracked by shape from the start."""
        found = self._modes(self._assembled(z))
        reference, mass = self._reference, self._start.mass
        order = track_modes(mass, reference.omega, reference.shapes, found.shapes)[self._rows]
        return found.omega[order], found.shapes[:, order]

    def _slopes_of_matrices(self, z: FloatArray, j: int) -> tuple[Any, Any]:
        """Return ∂K/∂z_j and ∂M/∂z_j, including those of the feet's stiffness."""
        low, high = self.limits[:, j]
        ends = [np.array(z, dtype=np.float64) for _ in range(2)]
        for end, sign in zip(ends, (-_STEP, _STEP), strict=True):
            end[j] = np.clip(z[j] + sign, low, high)
        width = ends[1][j] - ends[0][j]
        K, M = zip(*(self._matrices(end) for end in ends), strict=True)
        return (K[1] - K[0]) / width, (M[1] - M[0]) / width

    def _matrices(self, z: FloatArray) -> tuple[Any, Any]:
        assembly = self._assembled(z)
        if not self._own_feet:
            return assembly.stiffness, assembly.mass
        return assembly.stiffness + foot_stiffness(assembly), assembly.mass

    def _require_effect(self, index: int, factor: Factor) -> None:
        """Raise an error for a quantity without effect, e.g. the density of a massless part."""
        z = np.zeros(len(self.factors))
        slopes, matrices = self._slopes_of_matrices(z, index), self._matrices(z)
        if any(abs(s).max() > _NOTHING * abs(m).max() for s, m in zip(slopes, matrices, strict=True)):
            return
        require(
            False,
            "has no effect: its present value is zero",
            field="property",
            value=factor.name,
            allowed=", ".join(self._effective(factor)),
            remedy="use added_mass_kg for a part without density, or the mass of a body on one of its nodes",
        )

    def _effective(self, factor: Factor) -> list[str]:
        """Return the properties of the same part that have an effect."""
        before = self._matrices(np.zeros(len(self.factors)))
        found = []
        for what, kind in PROPERTIES[factor.of].items():
            try:
                changed = adjusted(
                    self.structure, factor.of, factor.name_of, what, 1.01 if kind.is_factor else 1.0
                )
            except InputError:
                continue
            after = assemble(changed, gravity=self._gravity)
            if any(
                abs(a - b).max() > 0.0 for a, b in zip((after.stiffness, after.mass), before, strict=True)
            ):
                found.append(what)
        return found


@dataclass(frozen=True)
class RefinementStage:
    """One stage: parts on pinned feet, with their measured frequencies and free quantities.

    Attributes
    ----------
    parts : tuple of str
        Parts of this stage; empty for the whole structure.
    target_hz : mapping of mode number to frequency
    factors : tuple of Factor
        Free quantities; empty for a stage that only compares.
    frequency_std : float
        Relative standard deviation of the targets.
    """

    parts: tuple[str, ...]
    target_hz: Mapping[int, float]
    factors: tuple[Factor, ...]
    frequency_std: float = 0.005

    def of(self, structure: Structure) -> Structure:
        """Return the part of the structure in this stage."""
        return only_parts(structure, self.parts) if self.parts else structure


@dataclass(frozen=True)
class Refinement:
    """The refined structure and the result of each stage.

    Attributes
    ----------
    final_hz : one array per stage
        Frequencies of its modes after all stages.
    changes : tuple of (factor, value)
        Products of the factors and sums of the additions of all stages, in order of first appearance.
    """

    structure: Structure
    stages: tuple[StageFit, ...]
    final_hz: tuple[FloatArray, ...]
    changes: tuple[tuple[Factor, float], ...]


def refine(
    structure: Structure,
    stages: tuple[RefinementStage, ...],
    *,
    gravity: bool = False,
    own_feet: bool = False,
) -> Refinement:
    """Fit the stages in sequence; each starts from the result of the previous one.

    Raises
    ------
    InputError
        If a stage names an unknown part or has more factors than frequencies; the field names the stage.
    """
    for i, stage in enumerate(stages):  # a mistake in a later stage is not found after minutes
        with located(field=f"stages.{i}"):
            of_stage = stage.of(structure)
            for j, factor in enumerate(stage.factors):
                with located(field=f"free.{j}"):
                    factor.on(of_stage, factor.value(0.0))
    fits: list[StageFit] = []
    changes: dict[str, tuple[Factor, float]] = {}
    for i, stage in enumerate(stages):
        with located(field=f"stages.{i}"):
            fit = fit_stage(
                stage.of(structure),
                stage.factors,
                stage.target_hz,
                frequency_std=stage.frequency_std,
                gravity=gravity,
                own_feet=own_feet,
            )
        for factor in stage.factors:
            value = fit.factors[factor.name]
            structure = factor.on(structure, value)
            _, before = changes.get(factor.key, (factor, 1.0 if factor.is_factor else 0.0))
            changes[factor.key] = factor, before * value if factor.is_factor else before + value
        fits.append(fit)
    final = []
    for stage in stages:
        done = fit_stage(stage.of(structure), (), stage.target_hz, gravity=gravity, own_feet=own_feet)
        final.append(done.after_hz)
    return Refinement(structure, tuple(fits), tuple(final), tuple(changes.values()))
