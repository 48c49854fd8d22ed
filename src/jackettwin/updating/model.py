"""The updated model: poles of numbered modes and their gradients as functions of support parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import pi
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.response import (
    Condensed,
    DampedModes,
    NumberedModes,
    Points,
    System,
    build_system,
    damped_modes,
    damping_ratio,
    law_response,
    numbered_poles,
    track_modes,
    undamped_modes,
)
from jackettwin.soil import Family, Law, Parameter
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating.band import condensed_for, numbered_modes
from jackettwin.updating.model_error.directions import ToleranceDirections, moved_along, on_unlike_feet
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.tie_groups import TieGroups


@dataclass(frozen=True)
class Prediction:
    """Prediction of some modes at one parameter vector.

    Attributes
    ----------
    poles : (n_modes,) λ, NaN where a mode has no successor
    slopes : (n_modes, n_parameters) dλ/d ln θ
    numbered : NumberedModes
        The same as one set, from which neighbouring vectors can start.
    """

    poles: ComplexArray
    slopes: ComplexArray
    numbered: NumberedModes


@dataclass(frozen=True)
class SupportModel:
    """A structure whose reaction nodes are supported by one family of laws.

    Attributes
    ----------
    assembly, rayleigh
        Structure and damping of the steel.
    family : Family
    parameters : tuple of Parameter
        Parameters of the family for each tie group, then the nuisance parameters.
    tie_groups : TieGroups
        The tie groups.
    condensed : Condensed
        The structure condensed to its support DOFs; its groups are the tie groups.
    reference_hz : float
        Frequency at which storage stiffness and loss factor are stated: the first pinned frequency.
    highest_mode : int
        Highest mode number in the condensed model's band.
    nuisance : NuisanceParameters
        Free parameters in addition to those of the law, which they follow in ``parameters``.
    fastest_rate : float
        Largest rate [rad/s] of relaxations inside the band.
    directions : ToleranceDirections, optional
        Effects of the structure's tolerances on the condensed model.
    """

    assembly: Assembly
    rayleigh: Rayleigh
    family: Family
    parameters: tuple[Parameter, ...]
    tie_groups: TieGroups
    condensed: Condensed
    reference_hz: float
    highest_mode: int
    nuisance: NuisanceParameters = NuisanceParameters()
    fastest_rate: float = 0.0
    directions: ToleranceDirections | None = None

    def reaching(self, mode: int) -> SupportModel:
        """Return the model with a band up to a numbered mode; the same object if the mode is in its band."""
        if mode <= self.highest_mode:
            return self
        pinned_hz = numbered_modes(self.assembly, mode).frequency_hz
        condensed = condensed_for(
            self.assembly, self.tie_groups, self.rayleigh, self.nuisance, pinned_hz, mode, self.fastest_rate
        )
        own = None if self.directions is None else replace(self.directions, condensed=condensed)
        return replace(self, condensed=condensed, highest_mode=mode, directions=own)

    def laws(self, theta: FloatArray) -> list[Law]:
        """Return the law of each tie group."""
        numbers = self._numbers(self._split(theta)[0])
        per_group = np.reshape(numbers, (len(self.tie_groups.suffixes), -1))
        return [self.family.build(values, self.reference_hz) for values in per_group]

    @cached_property
    def n_of_law(self) -> int:
        """Number of parameters of the law on all tie groups."""
        return len(self.tie_groups.parameters(self.family))

    def _numbers(self, own: FloatArray) -> FloatArray:
        """Return the laws' numbers, group by group, from the parameters of the laws (..., n_of_law)."""
        if not self.tie_groups.one_loss:
            return own
        return np.asarray(np.exp(np.log(own) @ self.tie_groups.exponents(self.family).T))

    def _split(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the parameters of the laws and the extra ones of one vector or many."""
        n = self.n_of_law
        return theta[..., :n], theta[..., n:]

    def points(self, theta: FloatArray) -> Points:
        """Return parameter vectors (n_sets, n_parameters) as input of the condensed model."""
        own, extra = self._split(theta)
        n_sets, n_groups, p = len(theta), len(self.tie_groups.suffixes), len(self.family.parameters)
        numbers, powers = self._numbers(own), self.tie_groups.exponents(self.family)
        rows, slopes = self.family.rows(np.reshape(numbers, (-1, p)), self.reference_hz)
        soil, slopes = rows.reshape(n_sets, n_groups, -1), slopes.reshape(n_sets, n_groups, -1, p)
        rotor, rotor_slopes = self.nuisance.rows(extra, soil.shape[2])
        rows = np.concatenate([soil, rotor], axis=1)
        jacobian = np.zeros((*rows.shape, theta.shape[1]))
        for g in range(n_groups):
            jacobian[:, g, :, : own.shape[1]] = slopes[:, g] @ powers[g * p : (g + 1) * p]
        jacobian[:, n_groups:, :, own.shape[1] :] = rotor_slopes
        ab, ab_slopes = self.nuisance.rayleigh_rows(self.rayleigh, extra)
        by_all = np.zeros((n_sets, 2, theta.shape[1]))
        by_all[:, :, own.shape[1] :] = ab_slopes
        return Points(rows, ab, jacobian, by_all)

    def law_response(self, theta: FloatArray, s: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the laws' complex stiffness at one vector, and its derivatives by ln θ of their parameters.

        Parameters
        ----------
        theta : (n_parameters,)
        s : (n_s,) Laplace variable [rad/s]

        Returns
        -------
        (n_groups · n_s,) D [N/m], group after group, and (n_groups · n_s, n_law_parameters)
        """
        p = len(self.family.parameters)
        numbers = self._numbers(self._split(theta)[0]).reshape(-1, p)
        D, dD = law_response(*self.family.rows(numbers, self.reference_hz), s)
        if len(numbers) == 1:
            return D[0], dD[0]
        powers = self.tie_groups.exponents(self.family).reshape(len(numbers), p, -1)
        return D.ravel(), (dD @ powers).reshape(D.size, -1)

    def predict_many(
        self,
        theta: FloatArray,
        modes: tuple[int, ...],
        *,
        near: NumberedModes | None = None,
        slopes: bool = True,
        shape_slopes: bool = False,
    ) -> NumberedModes:
        """Return numbered modes at many parameter vectors (n_sets, n_parameters), with slopes or without.

        Raises
        ------
        InputError
            If a mode lies outside the band the model was condensed for.
        """
        if max(modes) > self.highest_mode:
            raise InputError(
                "mode outside the model's band",
                field="mode",
                value=max(modes),
                allowed=f"1 to {self.highest_mode}",
                remedy="build the support model with a higher highest_mode",
            )
        points = self.points(theta)
        points = points if slopes else points.plain()
        return numbered_poles(self.condensed, points, modes, near=near, shape_slopes=shape_slopes)

    def predict(
        self, theta: FloatArray, modes: tuple[int, ...], *, near: Prediction | None = None
    ) -> Prediction:
        """Return the poles of numbered modes and their gradients at one parameter vector.

        Parameters
        ----------
        near : Prediction, optional
            Prediction of the same modes at a neighbouring vector, which makes the search ten times faster.
        """
        found = self.predict_many(theta[None], modes, near=None if near is None else near.numbered)
        return Prediction(found.poles[0], found.slopes[0], found)

    def undamped_hz(self, theta: FloatArray, modes: tuple[int, ...]) -> FloatArray:
        """Return the undamped frequencies of numbered modes (NaN if not found)."""
        found = numbered_poles(self.condensed, self.points(theta[None]).undamped(), modes)
        return np.asarray(np.abs(found.poles[0]) / (2.0 * pi))

    def system(self, theta: FloatArray, errors: FloatArray | None = None) -> System:
        """Return the full model at ``theta``.

        Parameters
        ----------
        errors : (n_directions,), optional
            By how much the structure differs along ``directions``, in their standard deviations.
        """
        extra = self._split(theta)[1]
        mass, spread = self.nuisance.effects(extra)
        assembly, support = self.assembly, self.tie_groups.support(self.laws(theta))
        if errors is not None and self.directions is not None:
            assembly, shares = moved_along(assembly, self.directions.each, errors)
            support = on_unlike_feet(support, assembly.structure, shares)
        return build_system(
            assembly if mass is None else replace(assembly, mass=assembly.mass + mass),
            support,
            rayleigh=self.nuisance.steel(self.rayleigh, extra),
            dashpots=self.nuisance.springs(self.assembly.structure.top_node, extra),
            spread=spread,
        )

    def exact_modes(self, theta: FloatArray, modes: tuple[int, ...]) -> ExactModes:
        """Return numbered modes of the full model, damped and undamped."""
        system = self.system(theta)
        reference = numbered_modes(self.assembly, max(modes) + 2)
        M = self.assembly.mass
        damped = damped_modes(system, below_hz=1.2 * float(reference.frequency_hz[-1]))
        undamped = undamped_modes(system, len(damped.eigenvalues) + 6)
        rows = [m - 1 for m in modes]
        d = track_modes(M, reference.omega, reference.shapes, damped.shapes)[rows]
        u = track_modes(M, reference.omega, reference.shapes, undamped.shapes)[rows]
        return ExactModes(
            poles=_taken(damped.eigenvalues, d),
            shapes=_taken(damped.shapes, d),
            undamped_hz=_taken(undamped.frequency_hz, u),
            damped=damped,
        )


def _taken(values: npt.NDArray[Any], which: IntArray) -> npt.NDArray[Any]:
    """Return values[..., which], NaN where ``which`` is −1; ``values`` may be empty."""
    padded = np.concatenate([values, np.full((*values.shape[:-1], 1), np.nan, values.dtype)], axis=-1)
    return np.asarray(padded[..., which])


@dataclass(frozen=True)
class ExactModes:
    """Numbered modes of the full model; NaN where a mode has no successor.

    Attributes
    ----------
    poles : (n_modes,) λ [rad/s]
    shapes : (assembly.n_dof, n_modes)
    undamped_hz : (n_modes,)
    damped : DampedModes
        All damped modes, with the real poles.
    """

    poles: ComplexArray
    shapes: ComplexArray
    undamped_hz: FloatArray
    damped: DampedModes

    @property
    def frequency_hz(self) -> FloatArray:
        """|λ|/2π [Hz]."""
        return np.asarray(np.abs(self.poles) / (2.0 * pi))

    @property
    def damping_ratio(self) -> FloatArray:
        """−Re λ/|λ|."""
        return damping_ratio(self.poles)
