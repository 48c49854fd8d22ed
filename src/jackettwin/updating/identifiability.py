"""What the data tell of each parameter, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jackettwin.updating.problem import Found, Problem

FloatArray = npt.NDArray[np.float64]

IDENTIFIED, WEAK = 0.3, 0.8
"""Posterior over prior standard deviation of ln θ below which a parameter is identified, or weakly so."""
_TRADES = 0.7
"""Correlation from which two parameters trade places."""
_UNSEEN = 0.5
"""Standard deviations of the data that a prior standard deviation of a parameter moves, at the median."""
_DESIGN_POINTS = 48
"""Points of the prior at which the precision to expect is computed."""


@dataclass(frozen=True)
class Verdict:
    """What the data tell of one parameter.

    Attributes
    ----------
    verdict : ``identified``, ``weak`` or ``unidentified``
    ratio : float
        Posterior over prior standard deviation of ln θ.
    ratio_before : float
        The same, expected from the precision of the measurements alone: the median over the prior.
    verdict_before : str
    reason : str
    """

    name: str
    verdict: str
    ratio: float
    ratio_before: float
    verdict_before: str
    reason: str


def verdict_of(ratio: float) -> str:
    """Return the word for a ratio of posterior to prior standard deviation of ln θ.

    Examples
    --------
    >>> verdict_of(0.1), verdict_of(0.5), verdict_of(0.9)
    ('identified', 'weak', 'unidentified')
    """
    return "identified" if ratio < IDENTIFIED else "weak" if ratio < WEAK else "unidentified"


def identifiability(problem: Problem, z: FloatArray, *, seed: int = 0) -> tuple[Verdict, ...]:
    """Return the verdict on every parameter.

    Parameters
    ----------
    z : (n, d) draws of ln θ from the posterior
    """
    ratio = z.std(axis=0) / problem.prior.std
    before = expected_ratio(problem, problem.prior.draw(_DESIGN_POINTS, np.random.default_rng(seed)))
    reasons = _reasons(problem, z, ratio)
    return tuple(
        Verdict(p.name, verdict_of(now), float(now), float(was), verdict_of(was), reason)
        for p, now, was, reason in zip(problem.parameters, ratio, before, reasons, strict=True)
    )


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


def _reasons(problem: Problem, z: FloatArray, ratio: FloatArray) -> list[str]:
    """Return a sentence a parameter: which datum fixes it, what it trades with, or that no datum sees it."""
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
        if ratio[j] < IDENTIFIED:
            reasons.append(f"fixed by {data[strongest]}")
        elif np.linalg.norm(J[:, j]) < _UNSEEN:
            reasons.append("no datum sees it: its prior moves them by less than half a standard deviation")
        elif abs(value) >= _TRADES:
            reasons.append(f"trades with {names[partner]} (correlation {value:+.2f})")
        else:
            reasons.append(f"{data[strongest]} sees it best, but not precisely enough")
    return reasons
