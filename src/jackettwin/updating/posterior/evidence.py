r"""Evidence of a law from draws of its posterior, by bridge sampling.

With draws θ from the posterior and :math:`\tilde θ` from a density q that is known, any Z that solves

.. math::
    Z = \frac{\frac{1}{m}\sum_j L p(\tilde θ_j) / [s_1 L p(\tilde θ_j) + s_2 Z q(\tilde θ_j)]}
             {\frac{1}{n}\sum_i q(θ_i) / [s_1 L p(θ_i) + s_2 Z q(θ_i)]}

is consistent, with the least variance of all bridges if s₁ : s₂ are as the numbers of independent draws (Meng
& Wong 1996, section 4; Gronau et al. 2017). Neither density need cover the other's tails. Here q is a mixture
of normals on other runs' draws, each as wide as the draws around it (West 1993; Givens & Raftery 1996), which
follows bent valleys and separate hills. What lies beyond a bound has likelihood zero.
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
_NEIGHBOURS = 0.1
"""Share of the draws that a kernel is as wide as."""
_INDEPENDENT = 0.25
"""Share of a run's draws counted as independent: they are the last few states of its particles."""
_FLOOR = 1e-9
"""Least width of a kernel, in the prior's standard deviations."""
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

    So the runs' ln Z do not share their errors, and their spread says how well the mean is known.

    Parameters
    ----------
    log_likelihood : ln L (n,) at points (n, d)
        Called with as many points within the bounds as there are draws.
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
    Where q is the posterior, every draw alone says Z.

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
    """An even mixture of normals.

    Attributes
    ----------
    centres : (n_kernels, d)
    roots : (n_kernels, d, d) lower Cholesky factors of the covariances
    """

    centres: FloatArray
    roots: FloatArray

    def draw(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Return draws (n, d), evenly from all kernels."""
        which = np.resize(rng.permutation(len(self.centres)), n)
        steps = rng.standard_normal((n, self.centres.shape[1]))
        return np.asarray(self.centres[which] + np.einsum("nij,nj->ni", self.roots[which], steps))

    def evenly_with(self, other: Kernels) -> Kernels:
        """Return the mixture of as many of these as of others, which are repeated as need be."""
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

    Near is meant in the metric of all draws, so that a narrow valley's length does not count for its width.

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
    """Return the lower Cholesky factor of a covariance that may lack a direction: few draws, or rounding."""
    return np.asarray(la.cholesky(covariance + 1e-6 * np.diag(np.diag(covariance)), lower=True))
