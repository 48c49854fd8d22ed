"""Draws of a posterior near an earlier one, by importance sampling.

The posterior of some more records is near the earlier one, so that a thousand draws around that one, each
weighted by posterior over proposal, represent it at a tenth of the cost of sampling anew. Where it has moved
too far, the proposal follows it in steps: the next one has mean and covariance of the draws weighted by a
power of their weights (Koblents & Miguez 2015). A fifth of the draws is from the prior, which bounds the
weights where the proposal has no draws (defensive mixture, Hesterberg 1995).
"""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.optimize import brentq
from scipy.special import logsumexp

from jackettwin.arrays import FloatArray
from jackettwin.updating.posterior.evidence import Kernels, root_of
from jackettwin.updating.posterior.smc import scouted, systematic
from jackettwin.updating.problem import Problem

_WIDTHS = (1.0, 1.5, 2.5)
"""Widths of the proposal's normals, in expected standard deviations; a posterior has heavier tails."""
_FROM_PRIOR = 0.2
"""Share of draws from the prior: no weight then exceeds five times the likelihood's (Hesterberg 1995)."""
_EFFECTIVE = 120.0
"""Least effective number of draws (Kong 1992): ends of 90 % intervals are then at 5 ± 2 %."""
_MOST_STEPS = 12
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
        Number of weighted draws of a step, those of the prior included.
    """
    for _ in range(_MOST_STEPS):
        root = root_of(covariance)
        near = Kernels(np.array([centre] * len(_WIDTHS)), np.array([width * root for width in _WIDTHS]))
        z, log_w = _weighed(problem, near, rng, n)
        if _lacking(log_w, 1.0) <= 0.0:
            return z[systematic(np.exp(log_w), _KEPT, rng)]
        log_w *= brentq(partial(_lacking, log_w), 0.0, 1.0, rtol=1e-3)
        w = np.exp(log_w - logsumexp(log_w))
        centre, covariance = w @ z, np.atleast_2d(np.cov(z.T, aweights=w))
    return None


def _lacking(log_w: FloatArray, power: float) -> float:
    """Return how many draws, weighted by a power of their weights, are lacking to be enough."""
    return float(_EFFECTIVE - np.exp(2.0 * logsumexp(power * log_w) - logsumexp(2.0 * power * log_w)))


def _weighed(
    problem: Problem, proposal: Kernels, rng: np.random.Generator, n: int
) -> tuple[FloatArray, FloatArray]:
    """Return draws (n, d) of a proposal and the prior, and the logarithms of their weights."""
    prior, of_prior = problem.prior, round(_FROM_PRIOR * n)
    z = np.concatenate([proposal.draw(n - of_prior, rng), prior.draw(of_prior, rng)])
    swarm = scouted(problem, rng.permutation(z[np.isfinite(prior.log_density(z))]))
    log_q = np.logaddexp(
        proposal.log_density(swarm.z) + np.log(1.0 - _FROM_PRIOR), swarm.log_p + np.log(_FROM_PRIOR)
    )
    log_w = swarm.log_l + swarm.log_p - log_q
    return swarm.z, log_w - logsumexp(log_w)
