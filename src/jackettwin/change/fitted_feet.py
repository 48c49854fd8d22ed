"""The feet that a structure's measured modes tell of: a posterior, or a fit to the frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.optimize import least_squares

from jackettwin.arrays import FloatArray
from jackettwin.change.changed_structures import Standing
from jackettwin.change.standing_modes import NEAR, Modes, on_feet
from jackettwin.errors import InputError
from jackettwin.response import track_modes, undamped_modes
from jackettwin.structure import Assembly

_NAMED_ON = (-1.2, 4.0)
"""ln of softer and stiffer feet over the typical ones: of a soft ground, and nearly rigid."""
_FEET_APART = 0.15
"""Standard deviation of ln stiffness between feet: no site is uniform,
and in a nearly round structure that rotates the axes of a pair."""
_MODEL_ERROR = 0.01
"""Prior relative error of a model's frequencies, with the weight of one mode."""


def on_its_feet(
    typical: Standing,
    assembly: Assembly,
    labels: Sequence[str],
    frequency_hz: FloatArray,
    stiffness: FloatArray | None,
    draws: int,
    rng: np.random.Generator,
) -> tuple[Modes, list[int], list[Standing], Standing, float]:
    """Return the modes as the labels name them, each label's place among them (−1: none), and the feet.

    The feet are draws, the likeliest, and the model's relative error of frequencies on it: of a posterior of
    the stiffness if there is one, else fitted to the frequencies.
    """
    every = [
        (named, [named.labels.index(label) if label in named.labels else -1 for label in labels])
        for named in namings(typical, assembly)
    ]
    most = max(sum(place >= 0 for place in places) for _, places in every)
    if most == 0:
        raise InputError(
            "no mode of the model has such a label", field="label", value=", ".join(labels),
            allowed=", ".join(every[0][0].labels), remedy="label modes as `jackettwin modes` does",
        )  # fmt: skip
    every = [one for one in every if sum(place >= 0 for place in one[1]) == most]
    if stiffness is None:
        fits = [fitted_feet(typical, *one, frequency_hz, assembly) for one in every]
        feet, (named, places) = min(zip(fits, every, strict=True), key=lambda pair: pair[0].error)
        return named, places, feet.drawn(typical, draws, rng), feet.best(typical), feet.error
    stands, best = drawn_standings(typical, stiffness, draws)
    errors = [_model_error(Modes.of(best, assembly, like=one), at, frequency_hz) for one, at in every]
    error, (named, places) = min(zip(errors, every, strict=True), key=lambda pair: pair[0])
    return named, places, stands, best, error


def drawn_standings(typical: Standing, stiffness: FloatArray, draws: int) -> tuple[list[Standing], Standing]:
    """Return draws of the feet's stiffness from a posterior, (n, 2, n_feet), and their median."""
    chosen = stiffness[np.linspace(0, len(stiffness) - 1, draws).astype(int)]
    stands = [replace(typical, horizontal=h, vertical=v) for h, v in chosen]
    horizontal, vertical = np.median(stiffness, axis=0)
    return stands, replace(typical, horizontal=horizontal, vertical=vertical)


def _model_error(fit: Modes, places: Sequence[int], frequency_hz: FloatArray) -> float:
    """Return the relative error of a model's frequencies, combined with the prior of one mode's weight."""
    known = [(place, f) for place, f in zip(places, frequency_hz, strict=True) if place >= 0]
    off = np.array([np.log(fit.modes.frequency_hz[place] / f) for place, f in known])
    return float(np.sqrt((off @ off + _MODEL_ERROR**2) / (len(known) + 1)))


@dataclass(frozen=True)
class FittedFeet:
    """Stiffness of the feet that fits measured frequencies.

    Attributes
    ----------
    log_factor : (2,)
        ln of the likeliest horizontal and vertical stiffness over the typical one.
    covariance : (2, 2)
        Of these.
    error : float
        By how much the model misses frequencies: what the fit leaves over, with one mode's worth of what is
        usual.
    """

    log_factor: FloatArray
    covariance: FloatArray
    error: float

    def best(self, typical: Standing) -> Standing:
        """Return the structure on its likeliest feet."""
        return _on_softer(typical, self.log_factor)

    def drawn(self, typical: Standing, draws: int, rng: np.random.Generator) -> list[Standing]:
        """Return draws of feet that agree with the measured frequencies."""
        points = rng.multivariate_normal(self.log_factor, self.covariance, draws).clip(-3.5, 3.5)
        drawn = [_on_softer(typical, x) for x in points]
        apart = np.exp(_FEET_APART * rng.standard_normal((draws, 2, typical.horizontal.size)))
        return [
            replace(s, horizontal=s.horizontal * h, vertical=s.vertical * v)
            for s, (h, v) in zip(drawn, apart, strict=True)
        ]


def fitted_feet(
    typical: Standing, named: Modes, places: Sequence[int], frequency_hz: FloatArray, assembly: Assembly
) -> FittedFeet:
    """Return the stiffness of the feet that fits measured frequencies.

    Parameters
    ----------
    places, frequency_hz : of measured modes among the named ones, −1 for none of them
    """
    known = [(place, f) for place, f in zip(places, frequency_hz, strict=True) if place >= 0]
    near = undamped_modes(on_feet(typical, assembly), NEAR).shapes

    def residual(x: FloatArray) -> FloatArray:
        omega = Modes.of_each([_on_softer(typical, x)], assembly, [named], near)[0].modes.omega
        off = [np.log(omega[place] / (2.0 * pi * f)) / _MODEL_ERROR for place, f in known]
        return np.array([*off, *x])

    fit = least_squares(residual, np.zeros(2), diff_step=[1e-3, 1e-3], max_nfev=12, bounds=(-3.0, 3.0))
    slope, left = np.asarray(fit.jac), fit.fun[: len(known)]
    error = np.sqrt((left @ left + 1.0) / (max(len(known) - 2, 0) + 1))  # in units of the usual
    slope[: len(known)] /= error
    return FittedFeet(fit.x, np.linalg.inv(slope.T @ slope), float(error) * _MODEL_ERROR)


def namings(typical: Standing, assembly: Assembly) -> list[Modes]:
    """Return the modes on typical feet by each of the names that they have there, on softer or stiffer feet.

    On some feet the torsion of a tower crosses its second bending, and a mode that is both has the name of
    either; measured modes are named on the feet that the structure has.
    """
    base = Modes.of(typical, assembly)
    found = {base.labels: base}
    for log_factor in _NAMED_ON:
        other = Modes.of(_on_softer(typical, np.full(2, log_factor)), assembly)
        order = track_modes(base.mass, base.modes.omega, base.modes.shapes, other.modes.shapes)
        names = tuple(
            other.labels[place] if place >= 0 else name
            for place, name in zip(order, base.labels, strict=True)
        )
        if len({*names}) == len(names):
            found.setdefault(names, replace(base, labels=names))
    return list(found.values())


def _on_softer(standing: Standing, log_factor: FloatArray) -> Standing:
    """Return a structure on feet whose horizontal and vertical stiffness is changed by factors."""
    h, v = np.exp(log_factor)
    return replace(standing, horizontal=standing.horizontal * h, vertical=standing.vertical * v)
