"""What the data say about each parameter, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90
from jackettwin.updating.data.misfit import Misfit
from jackettwin.updating.problem import Found, Problem

Decider = Literal["data", "bounds", "prior", "misfit", "no posterior"]

USABLE = 2.0
"""Longest interval of an identified parameter, upper end of the 90 % over the lower: a stiffness known to a
factor of √2 either way. Beyond it two foundations that differ as much as designs do fit the same data."""
BY_DATA, WEAK = 0.5, 0.8
"""Posterior over prior standard deviation of ln θ up to which the data outweigh a prior three to one in
precision, and from which they tell nothing."""
_NEAR_BOUND = 0.5
"""An end of the interval that is nearer to a bound than this times its distance to the median is set by the
bound."""
_TRADES = 0.7
"""Correlation from which two parameters are said to compensate for each other."""
_UNSEEN = 0.5
"""Standard deviations of the data that a prior standard deviation of a parameter moves, at the median."""
_LARGEST_LOG = 700.0
"""Larger exponents overflow."""
_DESIGN_POINTS = 48
"""Points of the prior at which the precision to expect is computed."""


@dataclass(frozen=True)
class Verdict:
    """What the data tell of one parameter.

    Attributes
    ----------
    verdict : ``identified``, ``weak`` or ``unidentified``
        Identified: the data alone made the interval, and it is short enough to use (``USABLE``).
    ratio : float
        Posterior over prior standard deviation of ln θ.
    ratio_before : float
        The same, expected from the precision of the measurements alone: the median over the prior.
    verdict_before : str
    reason : str
    decided_by : {"data", "bounds", "prior", "misfit", "no posterior"}
        What the interval comes from. Without convergence it is not known, and if the model cannot meet the
        data the interval is too short.
    interval_factor : float
        Upper over lower end of the 90 % interval.
    """

    name: str
    verdict: str
    ratio: float
    ratio_before: float
    verdict_before: str
    reason: str
    decided_by: Decider = "data"
    interval_factor: float = 1.0


def verdict_of(ratio: float, factor: float, decided_by: Decider = "data") -> str:
    """Return the word for what the data say about a parameter.

    Parameters
    ----------
    ratio : float
        Posterior over prior standard deviation of ln θ.
    factor : float
        Upper over lower end of the 90 % interval.

    Examples
    --------
    >>> verdict_of(0.1, 1.4), verdict_of(0.1, 18.0), verdict_of(0.1, 1.4, "bounds"), verdict_of(0.9, 1.4)
    ('identified', 'weak', 'weak', 'unidentified')
    """
    if ratio >= WEAK:
        return "unidentified"
    return "identified" if decided_by == "data" and factor <= USABLE else "weak"


def identifiability(
    problem: Problem, z: FloatArray, *, seed: int = 0, converged: bool = True, misfit: Misfit | None = None
) -> tuple[Verdict, ...]:
    """Return the verdict on every parameter.

    Parameters
    ----------
    z : (n, d) draws of ln θ from the posterior
    converged : bool
        Whether they are of the posterior; else nothing is called identified.
    misfit : Misfit, optional
        Of the best fit; where chance does not explain it, nothing is called identified.
    """
    prior = problem.prior.std
    ratio = z.std(axis=0) / prior
    low, high = np.quantile(z, [0.05, 0.95], axis=0)
    factor = np.exp(high - low)
    deciders = _deciders(problem, z, ratio, converged)
    if misfit is not None and not misfit.fits:
        deciders = ["misfit" if decider == "data" else decider for decider in deciders]
    before = expected_ratio(problem, problem.prior.draw(_DESIGN_POINTS, np.random.default_rng(seed)))
    factor_before = np.exp(np.minimum(2.0 * NORMAL_90 * before * prior, _LARGEST_LOG))
    reasons = _reasons(problem, z, ratio, factor, deciders)
    return tuple(
        Verdict(
            name=p.name,
            verdict=verdict_of(float(ratio[j]), float(factor[j]), deciders[j]),
            ratio=float(ratio[j]),
            ratio_before=float(before[j]),
            verdict_before=verdict_of(float(before[j]), float(factor_before[j])),
            reason=reasons[j],
            decided_by=deciders[j],
            interval_factor=float(factor[j]),
        )
        for j, p in enumerate(problem.parameters)
    )


def _deciders(problem: Problem, z: FloatArray, ratio: FloatArray, converged: bool) -> list[Decider]:
    """Return what the interval of each parameter comes from."""
    low, middle, high = np.quantile(z, [0.05, 0.5, 0.95], axis=0)
    at_bound = (low - problem.prior.low < _NEAR_BOUND * (middle - low)) | (
        problem.prior.high - high < _NEAR_BOUND * (high - middle)
    )
    deciders: list[Decider] = []
    for j, p in enumerate(problem.parameters):
        if not converged:
            deciders.append("no posterior")
        elif p.median is not None and ratio[j] > BY_DATA:
            deciders.append("prior")
        else:
            deciders.append("bounds" if at_bound[j] or ratio[j] >= WEAK else "data")
    return deciders


def information(problem: Problem, z: FloatArray, near: Found | None = None) -> FloatArray | None:
    """Return the data's information JᵀJ (d, d) on ln θ at a point, None where a mode is lost."""
    _, J, found = problem.evaluate(z, near)
    if found is None:
        return None
    J = J[: problem.n_data]
    return np.asarray(J.T @ J)


def expected_ratio(problem: Problem, z: FloatArray) -> FloatArray:
    """Return posterior over prior standard deviation (d,) to expect: the median over points (n, d)."""
    near = problem.anchor(z.mean(axis=0))
    known = [m for m in (information(problem, point, near) for point in z) if m is not None]
    prior = problem.prior.std
    ratios = [np.sqrt(np.diag(np.linalg.inv(m + np.diag(prior**-2.0)))) / prior for m in known]
    return np.asarray(np.median(ratios, axis=0)) if ratios else np.ones(z.shape[1])


def _reasons(
    problem: Problem, z: FloatArray, ratio: FloatArray, factor: FloatArray, deciders: list[Decider]
) -> list[str]:
    """Return a sentence a parameter: which datum fixes it, or what its interval is made of instead."""
    _, J, _ = problem.evaluate(np.median(z, axis=0), None)
    J = np.abs(J[: problem.n_data]) * problem.prior.std
    data = problem.data_names
    names = [p.name for p in problem.parameters]
    correlation = np.nan_to_num(np.atleast_2d(np.corrcoef(z, rowvar=False)))
    np.fill_diagonal(correlation, 0.0)
    reasons = []
    for j in range(len(names)):
        strongest, partner = int(np.argmax(J[:, j])), int(np.argmax(np.abs(correlation[j])))
        value = correlation[j, partner]
        span = f"90 % within a factor of {factor[j]:.3g}"
        if verdict_of(float(ratio[j]), float(factor[j]), deciders[j]) == "identified":
            reasons.append(f"fixed by {data[strongest]}: {span}")
        elif deciders[j] == "no posterior":
            reasons.append("the posterior did not converge: the interval is Laplace's")
        elif deciders[j] == "misfit":
            reasons.append(f"the model cannot meet the data, so that its interval is too short: {span}")
        elif np.linalg.norm(J[:, j]) < _UNSEEN:
            reasons.append("no datum sees it: its prior moves them by less than half a standard deviation")
        elif abs(value) >= _TRADES:
            reasons.append(f"trades with {names[partner]} (correlation {value:+.2f}); {span}")
        elif deciders[j] == "data":
            reasons.append(f"{data[strongest]} sees it best, {span}: {USABLE:g} or less would be of use")
        else:
            made = "its prior" if deciders[j] == "prior" else "a bound"
            reasons.append(f"{made} decides the interval, {span}; {data[strongest]} sees it best")
    return reasons
