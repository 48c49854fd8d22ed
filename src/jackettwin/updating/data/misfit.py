"""Whether a best fit agrees with its data: χ² and its degrees of freedom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem

UNLIKELY = 0.01
"""Probability of so large a χ² below which the model is called wrong, or the stated standard deviations too
small. One run in a hundred of a true model is called wrong."""
_SEEN = 0.5
"""A parameter counts as fitted if one standard deviation of its prior moves the data by so many of theirs."""


@dataclass(frozen=True)
class Misfit:
    """Distance of the best fit from its data.

    Attributes
    ----------
    chi2 : float
        Sum of squares of all residuals in standard deviations, those of the priors included.
    freedom : int
        Number of residuals without those that fitted parameters take away; at least 1.
    probability : float
        That a true model has a larger χ².
    """

    chi2: float
    freedom: int
    probability: float

    @property
    def fits(self) -> bool:
        """Whether chance explains the distance."""
        return self.probability >= UNLIKELY


def misfit(problem: Problem, theta: FloatArray) -> Misfit | None:
    """Return the distance of a best fit (d,) from its data; None without standard deviations or freedom.

    A parameter that no datum depends on takes no degree of freedom: those taken are the large singular values
    of the Jacobian by the parameters in units of their prior standard deviations.
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
