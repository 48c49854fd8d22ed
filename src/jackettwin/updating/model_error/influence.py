"""Effect of each tolerance on each parameter, its posterior, and the gain from determining it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.model_error.directions import Tolerance
from jackettwin.updating.model_error.marginal import covariance
from jackettwin.updating.problem import Problem

_ALIKE = 0.95
"""Cosine between the effects of two tolerances on the data, after refitting the parameters, above which the
data do not distinguish them: at 0.95 a third of either's effect is different."""
_FELT = 0.05
"""Effect on the data, in their standard deviations, below which a tolerance is not compared with others."""


@dataclass(frozen=True)
class Influence:
    """Influence of one tolerance in one fit.

    Attributes
    ----------
    tolerance : Tolerance
    mean, std : float
        Posterior, in units of the prior standard deviation; of several unknowns with one name (one per foot),
        the one that the data determine best.
    effect : (n_parameters,)
        Change of ln θ due to one standard deviation.
    settled : (n_parameters,)
        Ratio of the standard deviation of ln θ, if the tolerance were known, to the present one.
    alike : names of tolerances that the data do not distinguish from it
    """

    tolerance: Tolerance
    mean: float
    std: float
    effect: FloatArray
    settled: FloatArray
    alike: tuple[str, ...]


def influences(problem: Problem, z: FloatArray) -> tuple[Influence, ...]:
    """Return the influence of every tolerance of a problem's error model about a point (d,) of ln θ.

    It is of first order in parameters and tolerances. The result is empty without an error model or if a mode
    is lost.
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
    """Return the standard deviation (d,) of ln θ with some errors unknown."""
    information = J.T @ np.linalg.solve(covariance(gains), J) + precision
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information))))


def errors_after(
    gains: FloatArray, J: FloatArray, precision: FloatArray, r: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return posterior mean and standard deviation of every error, with parameters and errors unknown.

    To first order, residuals r + J δz + Γφ are standard normal, δz has a prior precision and φ variance one.

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
    """Return the effects of the tolerances on the data after refitting the parameters, (n_data, n)."""
    return np.asarray(gains - J @ np.linalg.solve(J.T @ J + precision, J.T @ gains))


def _alike(seen: FloatArray, own: list[int]) -> list[int]:
    """Return the tolerances with the same effect on the data as these."""
    size = np.linalg.norm(seen, axis=0)
    felt = size > _FELT
    cosine = np.abs(seen.T @ seen) / np.outer(np.maximum(size, 1e-12), np.maximum(size, 1e-12))
    return [
        int(place)
        for place in np.flatnonzero(felt)
        if place not in own and any(felt[i] and cosine[i, place] > _ALIKE for i in own)
    ]
