"""How much each tolerance moves each parameter, what the data say of it, and what settling it would give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.model_error.directions import Tolerance
from jackettwin.updating.model_error.marginal import covariance
from jackettwin.updating.problem import Problem

_ALIKE = 0.95
"""Cosine between what two tolerances do to the data, the parameters refitted, from which the data cannot tell
them apart: 0.95 leaves a third of either's effect."""
_FELT = 0.05
"""Standard deviations of the data below which a tolerance moves nothing, so that it is like no other."""


@dataclass(frozen=True)
class Influence:
    """One tolerance in one fit.

    Attributes
    ----------
    tolerance : Tolerance
    mean, std : float
        After the data, in its standard deviations before; of several unknowns that are alike, each foot's,
        the one that the data say most of.
    effect : (n_parameters,)
        Change of ln θ where it is one standard deviation more than stated.
    settled : (n_parameters,)
        Standard deviation of ln θ if it were known, over that now.
    alike : names of tolerances that the data cannot tell it from: only their sum is known
    """

    tolerance: Tolerance
    mean: float
    std: float
    effect: FloatArray
    settled: FloatArray
    alike: tuple[str, ...]


def influences(problem: Problem, z: FloatArray) -> tuple[Influence, ...]:
    """Return the influence of every tolerance of a problem's error model about a point (d,) of ln θ.

    To first order in parameters and tolerances. Empty without an error model, or where a mode is lost.
    """
    found = None if problem.error_model is None else problem.anchor(z)
    if problem.error_model is None or found is None:
        return ()
    gains = problem.gains(found)[0]
    r, J, _ = problem.plain.evaluate(z, found)
    r, J = r[: problem.n_data], J[: problem.n_data]
    precision = np.diag(problem.prior.std**-2.0)
    tolerances = problem.error_model.tolerances
    columns: dict[str, list[int]] = {}
    for place, tolerance in enumerate(tolerances):
        columns.setdefault(tolerance.name, []).append(place)
    now = _deviation(gains, J, precision)
    mean, std = errors_after(gains, J, precision, r)
    seen = _seen(gains[:, : len(tolerances)], J, precision)
    result = []
    for name, own in columns.items():
        rest = np.delete(gains, own, axis=1)
        inverse = np.linalg.inv(covariance(rest))
        per_unit = -np.linalg.solve(J.T @ inverse @ J + precision, J.T @ inverse @ gains[:, own])
        told = own[int(np.argmin(std[own]))]
        alike = [tolerances[place].name for place in _alike(seen, own)]
        result.append(
            Influence(
                tolerances[own[0]],
                float(mean[told]),
                float(std[told]),
                per_unit[np.arange(len(z)), np.argmax(np.abs(per_unit), axis=1)],
                _deviation(rest, J, precision) / now,
                tuple(dict.fromkeys(other for other in alike if other != name)),
            )
        )
    return tuple(result)


def _deviation(gains: FloatArray, J: FloatArray, precision: FloatArray) -> FloatArray:
    """Return the standard deviation (d,) of ln θ with some errors open."""
    information = J.T @ np.linalg.solve(covariance(gains), J) + precision
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information))))


def errors_after(
    gains: FloatArray, J: FloatArray, precision: FloatArray, r: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of every error after the data, parameters and errors together.

    To first order: residuals r + J δz + Γφ are standard normal, δz has a precision before, φ variance one.

    Parameters
    ----------
    gains : (n_data, n_errors) Γ
    J : (n_data, d)
    precision : (d, d)
    r : (n_data,)
    """
    both = np.concatenate([J, gains], axis=1)
    d = J.shape[1]
    prior = np.eye(both.shape[1])
    prior[:d, :d] = precision
    variance = np.linalg.inv(both.T @ both + prior)
    return -(variance @ both.T @ r)[d:], np.sqrt(np.diag(variance))[d:]


def _seen(gains: FloatArray, J: FloatArray, precision: FloatArray) -> FloatArray:
    """Return what the tolerances do to the data once the parameters are refitted, (n_data, n)."""
    return np.asarray(gains - J @ np.linalg.solve(J.T @ J + precision, J.T @ gains))


def _alike(seen: FloatArray, own: list[int]) -> list[int]:
    """Return the tolerances that act on the data as these do."""
    size = np.linalg.norm(seen, axis=0)
    felt = size > _FELT
    cosine = np.abs(seen.T @ seen) / np.outer(np.maximum(size, 1e-12), np.maximum(size, 1e-12))
    return [
        int(place)
        for place in np.flatnonzero(felt)
        if place not in own and any(felt[i] and cosine[i, place] > _ALIKE for i in own)
    ]
