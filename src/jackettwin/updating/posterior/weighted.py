"""Draws of a posterior by importance sampling from a proposal that is near it.

The posterior of some more records is near the earlier one, so that a thousand draws around that one, each
weighted by posterior over proposal, represent it at a tenth of the cost of sampling anew. A fifth of the
draws is from the prior, which bounds the weights where the proposal has no draws (defensive mixture,
Hesterberg 1995).
"""

from __future__ import annotations

import numpy as np
from scipy.special import logsumexp

from jackettwin.arrays import FloatArray
from jackettwin.updating.posterior.evidence import Kernels, root_of
from jackettwin.updating.posterior.smc import scouted, systematic
from jackettwin.updating.problem import Problem

_WIDTHS = (1.0, 1.5, 2.5)
"""Widths of the proposal's normals, in expected standard deviations; a posterior has heavier tails."""
_FROM_PRIOR = 0.2
_EFFECTIVE = 120.0
"""Least effective number of draws (Kong 1992): ends of 90 % intervals are then at 5 ± 2 %."""
_KEPT = 1000


def weighted_draws(
    problem: Problem, centre: FloatArray, covariance: FloatArray, rng: np.random.Generator, *, n: int = 1000
) -> FloatArray | None:
    """Return equally weighted draws (1000, d) of ln θ; None if too few of the weighted ones count.

    Parameters
    ----------
    problem : Problem
        Problem whose residuals have standard deviations.
    centre, covariance : (d,), (d, d)
        About where the posterior is expected.
    n : int
        Number of weighted draws, those of the prior included.
    """
    root = root_of(covariance)
    proposal = Kernels(np.array([centre] * len(_WIDTHS)), np.array([width * root for width in _WIDTHS]))
    prior, of_prior = problem.prior, round(_FROM_PRIOR * n)
    z = np.concatenate([proposal.draw(n - of_prior, rng), prior.draw(of_prior, rng)])
    swarm = scouted(problem, rng.permutation(z[np.isfinite(prior.log_density(z))]))
    log_q = np.logaddexp(
        proposal.log_density(swarm.z) + np.log(1.0 - _FROM_PRIOR), swarm.log_p + np.log(_FROM_PRIOR)
    )
    log_w = swarm.log_l + swarm.log_p - log_q
    w = np.exp(log_w - logsumexp(log_w))
    return swarm.z[systematic(w, _KEPT, rng)] if 1.0 / (w @ w) > _EFFECTIVE else None
