"""The model that is updated: free support parameters in, followed poles and their gradients out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.response.condensed import Condensed, condense, widest_band_hz
from jackettwin.response.follow import follow
from jackettwin.response.modal import DampedModes, UndampedModes, damped_modes, undamped_modes
from jackettwin.response.numbered import NumberedModes, Points, numbered_poles
from jackettwin.response.system import System, build_system
from jackettwin.soil.support import Support, standing
from jackettwin.soil.viscoelastic import Law, Prony
from jackettwin.structure.assemble import Assembly
from jackettwin.structure.damping import Rayleigh
from jackettwin.updating.extras import Extras
from jackettwin.updating.families import Family, Parameter
from jackettwin.updating.feet import Feet, feet, priors_of

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

Lognormal = tuple[float, float]
"""Median and standard deviation of ln θ."""

_ROOM = 1.2
"""The band ends this much above the highest mode on pinned supports, which supports can only lower."""
_BEYOND = 2.0
"""And this much above the fastest measured relaxation."""


@dataclass(frozen=True)
class Prediction:
    """What the model says of some modes at one parameter vector.

    Attributes
    ----------
    poles : (n_modes,) λ, NaN where a mode has no successor
    slopes : (n_modes, n_parameters) dλ/d ln θ
    numbered : NumberedModes
        The same as one set, to start neighbours from.
    """

    poles: ComplexArray
    slopes: ComplexArray
    numbered: NumberedModes


@dataclass(frozen=True)
class SupportModel:
    """A structure whose reaction nodes stand on one family of laws.

    Attributes
    ----------
    assembly, rayleigh
        The steel.
    family : Family
    parameters : tuple of Parameter
        One set of the family's for each tie group.
    feet : Feet
        The tie groups.
    condensed : Condensed
        The structure on its support DOFs; its groups are the tie groups.
    reference_hz : float
        Where storage stiffness and loss factor are stated: the first pinned frequency.
    highest_mode : int
        The last numbered mode inside the condensed model's band.
    extras : Extras
        Free parameters beside those of the law: they follow them in ``parameters``.
    fastest_rate : float
        Relaxations up to this rate [rad/s] are well inside the band, too.
    """

    assembly: Assembly
    rayleigh: Rayleigh
    family: Family
    parameters: tuple[Parameter, ...]
    feet: Feet
    condensed: Condensed
    reference_hz: float
    highest_mode: int
    extras: Extras = Extras()
    fastest_rate: float = 0.0

    def reaching(self, mode: int) -> SupportModel:
        """Return the model with a band up to a numbered mode; itself if it reaches there."""
        if mode <= self.highest_mode:
            return self
        condensed = _condensed(self.assembly, self.feet, self.rayleigh, self.extras, mode, self.fastest_rate)
        return replace(self, condensed=condensed, highest_mode=mode)

    def laws(self, theta: FloatArray) -> list[Law]:
        """Return the law of each tie group."""
        per_group = np.reshape(self._split(theta)[0], (len(self.feet.suffixes), -1))
        return [self.family.build(values, self.reference_hz) for values in per_group]

    def _split(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the parameters of the laws and the extra ones of one vector or many."""
        n = len(self.feet.suffixes) * len(self.family.parameters)
        return theta[..., :n], theta[..., n:]

    def points(self, theta: FloatArray) -> Points:
        """Return parameter vectors (n_sets, n_parameters) as what the condensed model takes."""
        own, extra = self._split(theta)
        n_sets, n_groups, p = len(theta), len(self.feet.suffixes), len(self.family.parameters)
        rows, slopes = self.family.rows(np.reshape(own, (-1, p)), self.reference_hz)
        soil, slopes = rows.reshape(n_sets, n_groups, -1), slopes.reshape(n_sets, n_groups, -1, p)
        rotor, rotor_slopes = self.extras.rows(extra, soil.shape[2])
        rows = np.concatenate([soil, rotor], axis=1)
        jacobian = np.zeros((*rows.shape, theta.shape[1]))
        for g in range(n_groups):
            jacobian[:, g, :, g * p : (g + 1) * p] = slopes[:, g]
        jacobian[:, n_groups:, :, own.shape[1] :] = rotor_slopes
        ab, ab_slopes = self.extras.rayleigh_rows(self.rayleigh, extra)
        by_all = np.zeros((n_sets, 2, theta.shape[1]))
        by_all[:, :, own.shape[1] :] = ab_slopes
        return Points(rows, ab, jacobian, by_all)

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
            Of the same modes at a neighbouring vector: ten times faster if it is close.
        """
        found = self.predict_many(theta[None], modes, near=None if near is None else near.numbered)
        return Prediction(found.poles[0], found.slopes[0], found)

    def undamped_hz(self, theta: FloatArray, modes: tuple[int, ...]) -> FloatArray:
        """Return the undamped frequencies of numbered modes (NaN if not followed)."""
        found = numbered_poles(self.condensed, self.points(theta[None]).undamped(), modes)
        return np.asarray(np.abs(found.poles[0]) / (2.0 * pi))

    def system(self, theta: FloatArray) -> System:
        """Return the full model at ``theta``."""
        extra = self._split(theta)[1]
        mass, damping = self.extras.water_effects(extra)
        return build_system(
            self.assembly if mass is None else replace(self.assembly, mass=self.assembly.mass + mass),
            self.feet.support(self.laws(theta)),
            rayleigh=self.extras.steel(self.rayleigh, extra),
            dashpots=self.extras.springs(self.assembly.structure.top_node, extra),
            spread=() if damping is None else ((damping, Prony(c=1.0)),),
        )

    def exact_modes(self, theta: FloatArray, modes: tuple[int, ...]) -> ExactModes:
        """Return numbered modes of the full model, damped and undamped."""
        system = self.system(theta)
        reference = numbered_modes(self.assembly, max(modes) + 2)
        M = self.assembly.mass
        damped = damped_modes(system, below_hz=1.2 * float(reference.frequency_hz[-1]))
        undamped = undamped_modes(system, len(damped.eigenvalues) + 6)
        rows = [m - 1 for m in modes]
        d = follow(M, reference.omega, reference.shapes, damped.shapes)[rows]
        u = follow(M, reference.omega, reference.shapes, undamped.shapes)[rows]
        return ExactModes(
            poles=_taken(damped.eigenvalues, d),
            shapes=_taken(damped.shapes, d),
            undamped_hz=_taken(undamped.frequency_hz, u),
            damped=damped,
        )


def _taken(values: npt.NDArray[Any], which: IntArray) -> npt.NDArray[Any]:
    """Return values[..., which], NaN where ``which`` is −1; there may be no value at all."""
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
        All of them, with the real poles.
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
        return np.asarray(-self.poles.real / np.abs(self.poles))


def numbered_modes(assembly: Assembly, number: int) -> UndampedModes:
    """Return the undamped modes whose order numbers all modes: on pinned feet, a monopile's clamped."""
    return undamped_modes(build_system(assembly, standing(assembly.structure)), number)


def support_model(
    assembly: Assembly,
    *,
    family: Family,
    rayleigh: Rayleigh,
    tie: str = "all",
    bounds: Mapping[str, tuple[float, float]] | None = None,
    priors: Mapping[str, Lognormal] | None = None,
    highest_mode: int = 8,
    fastest_rate: float = 0.0,
    extras: Extras | None = None,
    heads: Support | None = None,
    head_priors: bool = False,
) -> SupportModel:
    """Return the model with one law on the feet: their three translations, or what pile heads hold.

    Parameters
    ----------
    tie : {"all", "horizontal-vertical", "per-leg", "per-leg-horizontal-vertical"}
        Which translations share parameters.
    bounds : dict, optional
        Narrower or wider bounds by parameter name: with the tie's suffix, that of its side, or none.
    priors : dict, optional
        Lognormal priors by parameter name, as for the bounds; the others are flat in ln θ.
    highest_mode : int
        The last numbered mode that will be asked for.
    fastest_rate : float
        Of the real poles that will be asked for [rad/s].
    extras : Extras, optional
        Nacelle dashpots and steel damping to update as well.
    heads : Support, optional
        Pile heads whose 6×6 stiffness the laws scale (:func:`jackettwin.updating.feet.feet`).
    head_priors : bool
        Whether the heads give priors to the parameters that have none.

    Raises
    ------
    InputError
        If the tie is unknown, the structure has no reaction nodes, or a bound is wrong.
    """
    first_hz = float(numbered_modes(assembly, 1).frequency_hz[0])
    groups = feet(assembly.structure, tie, heads=heads, reference_hz=first_hz)
    suffixes, extras, bounds, priors = groups.suffixes, extras or Extras(), bounds or {}, priors or {}
    derived = priors_of(groups, first_hz) if head_priors else {}
    parameters = tuple(
        _informed(replace(p, name=p.name + suffix), (p.name + side, p.name), bounds, priors, derived)
        for suffix, side in zip(suffixes, groups.sides, strict=True)
        for p in family.parameters
    ) + tuple(_informed(p, (), bounds, priors, {}) for p in extras.parameters)
    known = {p.name + suffix for p in family.parameters for suffix in ("", *groups.sides, *suffixes)}
    known |= {p.name for p in extras.parameters}
    for field, names in (("bounds", bounds), ("priors", priors)):
        _no_unknown(field, names, known, family)
    condensed = _condensed(assembly, groups, rayleigh, extras, highest_mode, fastest_rate)
    low = next((p.low for p in parameters if p.name == "water_mass"), 1.0)
    extras.check_mass(condensed.pencil.M, [g.S for g in condensed.pencil.groups[len(suffixes) :]], low)
    return SupportModel(
        assembly,
        rayleigh,
        family,
        parameters,
        groups,
        condensed,
        first_hz,
        highest_mode,
        extras,
        fastest_rate,
    )


def _condensed(
    assembly: Assembly,
    groups: Feet,
    rayleigh: Rayleigh,
    extras: Extras,
    highest_mode: int,
    fastest_rate: float,
) -> Condensed:
    # distinct stand-in laws, so that every tie group stays a group of its own
    stand_ins: list[Law] = [Prony(k0=1e9 + i) for i in range(len(groups.suffixes))]
    system = build_system(
        assembly,
        groups.support(stand_ins),
        rayleigh=rayleigh,
        dashpots=extras.springs(
            assembly.structure.top_node, np.array([1e3 + i for i in range(len(extras.dashpots))])
        ),
    )
    pinned_hz = numbered_modes(assembly, highest_mode).frequency_hz
    below_hz = max(_ROOM * float(pinned_hz[-1]), _BEYOND * fastest_rate / (2.0 * pi))
    _check_band(rayleigh, pinned_hz, highest_mode, fastest_rate)
    return condense(system, below_hz=below_hz, spread=tuple(extras.water.values()))


def _check_band(rayleigh: Rayleigh, pinned_hz: FloatArray, highest_mode: int, fastest_rate: float) -> None:
    """Refuse modes that the structure has not, and modes and rates that its steel would overdamp."""
    if len(pinned_hz) < highest_mode:
        raise InputError(
            "the structure has fewer modes",
            field="mode",
            value=highest_mode,
            allowed=f"1 to {len(pinned_hz)}",
            remedy="leave the higher ones out, or divide its members (subdivide)",
        )
    widest = widest_band_hz(rayleigh.beta)
    reached = int(np.searchsorted(_ROOM * pinned_hz, widest))
    remedy = "leave them out, or state less damping (damping.rayleigh)"
    if reached < highest_mode:
        raise InputError(
            "the steel's damping grows with frequency, too strong for so high a mode",
            field="mode",
            value=highest_mode,
            allowed=f"1 to {reached} with this damping",
            remedy=remedy,
        )
    fastest = 2.0 * pi * widest / _BEYOND
    if fastest_rate > fastest:
        raise InputError(
            "the steel's damping grows with frequency, too strong for so fast a relaxation",
            field="rate_rad_s",
            value=fastest_rate,
            allowed=f"up to {fastest:.3g} rad/s with this damping",
            remedy=remedy,
        )


def _informed(
    p: Parameter,
    also_known_as: tuple[str, ...],
    bounds: Mapping[str, tuple[float, float]],
    priors: Mapping[str, Lognormal],
    derived: Mapping[str, Lognormal],
) -> Parameter:
    names = (p.name, *also_known_as)
    low, high = next((bounds[name] for name in names if name in bounds), (p.low, p.high))
    median, log_std = next((priors[name] for name in names if name in priors), (p.median, p.log_std))
    if median is None and p.name in derived and low <= derived[p.name][0] <= high:
        median, log_std = derived[p.name]
    return Parameter(p.name, low, high, p.unit, median, log_std)


def _no_unknown(field: str, given: Mapping[str, object], known: set[str], family: Family) -> None:
    for name in given:
        if name not in known:
            raise InputError(
                f"no such parameter of {family.name}",
                field=f"{field}.{name}",
                value=name,
                allowed=", ".join(sorted(known)),
            )
