"""Whether a best fit agrees with its data: χ² and its degrees of freedom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem

UNLIKELY = 0.01
"""Probability of a larger χ² below which the model counts as wrong, or the stated standard deviations as too
small. One run in a hundred of a correct model counts as wrong."""
_SEEN = 0.5
"""Least change of the data, in their standard deviations, by one standard deviation of a fitted parameter."""


@dataclass(frozen=True)
class Misfit:
    """Distance of the best fit from its data.

    Attributes
    ----------
    chi2 : float
        Sum of squares of all residuals in standard deviations, including those of the priors.
    freedom : int
        Number of residuals minus the number of fitted parameters; at least 1.
    probability : float
        Probability that a correct model has a larger χ².
    """

    chi2: float
    freedom: int
    probability: float

    @property
    def fits(self) -> bool:
        """Whether chance explains the misfit."""
        return self.probability >= UNLIKELY


def misfit(problem: Problem, theta: FloatArray) -> Misfit | None:
    """Return the misfit of a best fit (d,); None without standard deviations or degrees of freedom.

    A parameter that no datum depends on uses no degree of freedom. The number of fitted parameters is that of
    large singular values of the Jacobian by the parameters in units of their prior standard deviations.
    """
    if not problem.weighted:
        return None
    residuals, jacobian, found = problem.evaluate(np.log(theta), None)
    fitted = int((np.linalg.svd(jacobian * problem.prior.std, compute_uv=False) > _SEEN).sum())
    freedom = residuals.size - fitted
    if found is None or freedom < 1:
        return None
    total = float(residuals @ residuals)
    return Misfit(total, freedom, float(chdtrc(freedom, total)))
