"""Whether a best fit meets its data at all: χ² beside its degrees of freedom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem

UNLIKELY = 0.01
"""Probability of so large a χ² below which the model is wrong or the data surer of themselves than they may
be: one run in a hundred of a true model is called wrong."""
_SEEN = 0.5
"""Standard deviations of the data that a parameter's prior standard deviation must move to be fitted."""


@dataclass(frozen=True)
class Misfit:
    """How far the best fit stays from its data.

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
        """Whether chance explains what is missed."""
        return self.probability >= UNLIKELY


def misfit(problem: Problem, theta: FloatArray) -> Misfit | None:
    """Return how far a best fit (d,) stays from its data; None without standard deviations or freedom.

    A parameter that no datum sees takes no freedom: counted are the singular values of the Jacobian on
    parameters in units of their priors.
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
