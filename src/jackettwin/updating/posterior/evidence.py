r"""Evidence of a law from draws of its posterior, by bridge sampling.

With draws θ from the posterior and :math:`\tilde θ` from a known density q, the Z that solves

.. math::
    Z = \frac{\frac{1}{m}\sum_j L p(\tilde θ_j) / [s_1 L p(\tilde θ_j) + s_2 Z q(\tilde θ_j)]}
             {\frac{1}{n}\sum_i q(θ_i) / [s_1 L p(θ_i) + s_2 Z q(θ_i)]}

is consistent, and has the smallest variance of all bridges if s₁ : s₂ is the ratio of the numbers of
independent draws (Meng & Wong 1996, section 4; Gronau et al. 2017). Neither density needs to cover the tails
of the other. Here q is a mixture of normals centred at draws of other runs, each with the covariance of the
neighbouring draws (West 1993; Givens & Raftery 1996), which adapts to curved valleys and separate maxima. The
likelihood outside the bounds is zero.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
from scipy.special import logsumexp

from jackettwin.arrays import FloatArray
from jackettwin.updating.prior import Prior
from jackettwin.updating.problem import NEVER

_KERNELS = 100
"""Most kernels of the density of the draws, whose centres are chosen at random."""
_NEIGHBOURS = 0.1
"""Share of the draws whose covariance is that of a kernel."""
_INDEPENDENT = 0.25
"""Share of a run's draws that count as independent; draws are the last few states of its particles."""
_FLOOR = 1e-9
"""Smallest width of a kernel, in the prior's standard deviations."""
_TOLERANCE = 1e-6
_ITERATIONS = 1000


def bridged_evidence(
    log_likelihood: Callable[[FloatArray], FloatArray],
    prior: Prior,
    z: FloatArray,
    log_l: FloatArray,
    rng: np.random.Generator,
) -> FloatArray:
    """Return ln Z (n_runs,) of independent runs, each bridged to a density fitted to the others' draws.

    The errors of the runs' ln Z are therefore independent, and their scatter gives the uncertainty of the
    mean.

    Parameters
    ----------
    log_likelihood : function that returns ln L (n,) at points (n, d) within the bounds
    z : (n_runs, n_draws, d) draws from the posterior, at least two runs
    log_l : (n_runs, n_draws) ln L of the draws
    """
    found = []
    for run, own_log_l in enumerate(log_l):
        q = fitted(np.concatenate(np.delete(z, run, axis=0)), prior.std, rng)
        trial = q.draw(z.shape[1], rng)
        log_p = prior.log_density(trial)
        inside = np.isfinite(log_p)
        at_trial = np.full(len(trial), NEVER)
        at_trial[inside] = log_likelihood(trial[inside]) + log_p[inside] - q.log_density(trial[inside])
        at_draws = own_log_l + prior.log_density(z[run]) - q.log_density(z[run])
        found.append(bridge(at_draws, at_trial, independent=_INDEPENDENT * z.shape[1]))
    return np.array(found)


def bridge(at_draws: FloatArray, at_trial: FloatArray, *, independent: float) -> float:
    """Return ln Z from ln(L p/q) at draws (n,) from the posterior and at draws (m,) from q.

    Parameters
    ----------
    independent : number of independent draws from the posterior

    Examples
    --------
    If q is the posterior, every single draw gives Z.

    >>> round(bridge(np.full(5, -3.0), np.full(9, -3.0), independent=5.0), 6)
    -3.0
    """
    log_s1, log_s2 = np.log([independent, at_trial.size]) - np.log(independent + at_trial.size)
    log_z = float(logsumexp(at_trial) - np.log(at_trial.size))
    for _ in range(_ITERATIONS):
        above = logsumexp(at_trial - np.logaddexp(log_s1 + at_trial, log_s2 + log_z)) - np.log(at_trial.size)
        below = logsumexp(-np.logaddexp(log_s1 + at_draws, log_s2 + log_z)) - np.log(at_draws.size)
        before, log_z = log_z, float(above - below)
        if abs(log_z - before) < _TOLERANCE:
            break
    return log_z


@dataclass(frozen=True)
class Kernels:
    """A mixture of normals with equal weights.

    Attributes
    ----------
    centres : (n_kernels, d)
    roots : (n_kernels, d, d) lower Cholesky factors of the covariances
    """

    centres: FloatArray
    roots: FloatArray

    def draw(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Return draws (n, d), equally many from all kernels."""
        which = np.resize(rng.permutation(len(self.centres)), n)
        steps = rng.standard_normal((n, self.centres.shape[1]))
        return np.asarray(self.centres[which] + np.einsum("nij,nj->ni", self.roots[which], steps))

    def evenly_with(self, other: Kernels) -> Kernels:
        """Return the mixture of these with equally many of other kernels, which are repeated if necessary."""
        repeats = np.resize(np.arange(len(other.centres)), len(self.centres))
        return Kernels(
            np.concatenate([self.centres, other.centres[repeats]]),
            np.concatenate([self.roots, other.roots[repeats]]),
        )

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return ln q (n,) of points (n, d)."""
        log_q = np.empty((len(self.centres), len(z)))
        for row, centre, root in zip(log_q, self.centres, self.roots, strict=True):
            x = la.solve_triangular(root, (z - centre).T, lower=True)
            row[:] = -0.5 * (x * x).sum(axis=0) - np.log(np.diag(root)).sum()
        constant = 0.5 * z.shape[1] * np.log(2.0 * np.pi) + np.log(len(self.centres))
        return np.asarray(logsumexp(log_q, axis=0) - constant)


def fitted(z: FloatArray, scale: FloatArray, rng: np.random.Generator) -> Kernels:
    """Return kernels on some of the draws (n, d), each with the covariance of its nearest neighbours.

    Distances are in the metric of all draws, so that the length of a narrow valley does not affect its width.

    Parameters
    ----------
    scale : (d,) standard deviations of the prior
    """
    n, d = z.shape
    floor = np.diag((_FLOOR * scale) ** 2)
    whole = root_of(np.atleast_2d(np.cov(z.T)) + floor)
    x = la.solve_triangular(whole, z.T, lower=True).T
    centres = rng.choice(n, min(_KERNELS, n), replace=False)
    count = min(n, max(round(_NEIGHBOURS * n), 2 * d + 1))
    roots = []
    for i in centres:
        near = np.argpartition(((x - x[i]) ** 2).sum(axis=1), count - 1)[:count]
        roots.append(root_of(np.atleast_2d(np.cov(z[near].T)) + floor))
    return Kernels(z[centres], np.array(roots))


def root_of(covariance: FloatArray) -> FloatArray:
    """Return the lower Cholesky factor of a covariance that may be singular."""
    return np.asarray(la.cholesky(covariance + 1e-6 * np.diag(np.diag(covariance)), lower=True))
