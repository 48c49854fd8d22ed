"""Identifiability of each parameter from the data, with reasons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.updating.data.misfit import Misfit
from jackettwin.updating.problem import Found, Problem

Decider = Literal["data", "bounds", "prior", "misfit", "no posterior"]

USABLE = 2.0
"""Largest ratio of the ends of the 90 % interval of an identified parameter: a stiffness known within a
factor of √2 either way. With a larger ratio, foundations of different designs fit the same data."""
BY_DATA, WEAK = 0.5, 0.8
"""Ratio of posterior to prior standard deviation of ln θ up to which the precision of the data is three times
that of the prior, and above which the data give no information."""
_NEAR_BOUND = 0.5
"""An end of the interval is determined by a bound if its distance to the bound is below this share of its
distance to the median."""
_TRADES = 0.7
"""Correlation above which two parameters are reported to compensate each other."""
_UNSEEN = 0.5
"""Median effect of one prior standard deviation of a parameter on the data, in their standard deviations,
below which the data do not depend on it."""
_LARGEST_LOG = 700.0
"""Larger exponents overflow."""
_DESIGN_POINTS = 48
"""Number of points of the prior at which the expected precision is computed."""


@dataclass(frozen=True)
class Verdict:
    """Identifiability of one parameter.

    Attributes
    ----------
    verdict : ``identified``, ``weak`` or ``unidentified``
        Identified: the interval is determined by the data and short enough (``USABLE``).
    ratio : float
        Ratio of posterior to prior standard deviation of ln θ.
    ratio_before : float
        The same ratio expected from the precision of the measurements: the median over the prior.
    verdict_before : str
    reason : str
    decided_by : {"data", "bounds", "prior", "misfit", "no posterior"}
        What determines the interval. Without convergence it is not known, and if the model cannot reproduce
        the data the interval is too short.
    interval_factor : float
        Ratio of the ends of the 90 % interval.
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
    """Return the verdict on a parameter.

    Parameters
    ----------
    ratio : float
        Ratio of posterior to prior standard deviation of ln θ.
    factor : float
        Ratio of the ends of the 90 % interval.

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
        Whether the draws have converged; otherwise no parameter is identified.
    misfit : Misfit, optional
        Misfit of the best fit; if it exceeds chance, no parameter is identified.
    """
    prior = problem.prior.std
    ratio = z.std(axis=0) / prior
    low, high = np.quantile(z, QUANTILES[::2], axis=0)
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


def contradicted(verdicts: Sequence[Verdict], words: str) -> tuple[Verdict, ...]:
    """Return the verdicts of a fit whose data ask for an error that its intervals do not include.

    Nothing is identified then.

    Parameters
    ----------
    words : the error in words
    """
    reason = f"the data ask for {words}, which the interval does not include"
    doubted = [replace(v, verdict="weak", decided_by="misfit", reason=reason) for v in verdicts]
    return tuple(one if v.verdict == "identified" else v for v, one in zip(verdicts, doubted, strict=True))


def _deciders(problem: Problem, z: FloatArray, ratio: FloatArray, converged: bool) -> list[Decider]:
    """Return what determines the interval of each parameter."""
    low, middle, high = np.quantile(z, QUANTILES, axis=0)
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
    """Return the expected ratio of posterior to prior standard deviation (d,), median over points (n, d)."""
    near = problem.anchor(z.mean(axis=0))
    known = [m for m in (information(problem, point, near) for point in z) if m is not None]
    prior = problem.prior.std
    ratios = [np.sqrt(np.diag(np.linalg.inv(m + np.diag(prior**-2.0)))) / prior for m in known]
    return np.asarray(np.median(ratios, axis=0)) if ratios else np.ones(z.shape[1])


def _reasons(
    problem: Problem, z: FloatArray, ratio: FloatArray, factor: FloatArray, deciders: list[Decider]
) -> list[str]:
    """Return a sentence per parameter on the datum that determines it, or on what else does."""
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
            reasons.append("the posterior did not converge: the interval is that of Laplace's approximation")
        elif deciders[j] == "misfit":
            reasons.append(f"the model cannot reproduce the data, so that the interval is too short: {span}")
        elif np.linalg.norm(J[:, j]) < _UNSEEN:
            reasons.append(
                "no datum depends on it: its prior changes them by less than half a standard deviation"
            )
        elif abs(value) >= _TRADES:
            reasons.append(f"trades with {names[partner]} (correlation {value:+.2f}); {span}")
        elif deciders[j] == "data":
            reasons.append(
                f"{data[strongest]} depends on it most, {span}: a factor of {USABLE:g} or less is needed"
            )
        else:
            made = "its prior" if deciders[j] == "prior" else "a bound"
            reasons.append(f"{made} determines the interval, {span}; {data[strongest]} depends on it most")
    return reasons
