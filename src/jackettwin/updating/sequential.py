r"""Record after record: the posterior of one is the prior of the next, and drifting soil gives itself away.

The parameters walk at random between records, :math:`z_{t+1} = z_t + q`, :math:`q ∼ N(0, Q)`; the prior of
the next record is the mixture :math:`\frac{1}{n}\sum_i N(z; z_i, Q + h^2 Σ)` over the draws of the last one.
The log evidences of all records add up to that of the walk: with a drift against without says whether there
was one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import logsumexp

from jackettwin.errors import InputError
from jackettwin.updating.posterior import Posterior, sample_posterior
from jackettwin.updating.problem import Problem

FloatArray = npt.NDArray[np.float64]

_CENTRES = 200
"""Draws that the mixture is made of."""


@dataclass(frozen=True)
class DrawnPrior:
    """A mixture of equal normal kernels, cut at bounds.

    Attributes
    ----------
    centres : (n, d)
    factor : (d, d) Cholesky factor of the kernels' covariance
    low, high : (d,)
    """

    centres: FloatArray
    factor: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def after(cls, z: FloatArray, drift_std: FloatArray, low: FloatArray, high: FloatArray) -> DrawnPrior:
        """Return the prior that follows draws z (n, d) whose ln θ drift by ``drift_std`` (d,).

        The draws are shrunk towards their mean by what the kernels widen (Liu & West 2001).
        """
        kept = z[:: max(1, len(z) // _CENTRES)][:_CENTRES]
        n, d = kept.shape
        h2 = (4.0 / ((d + 2.0) * n)) ** (2.0 / (d + 4.0))
        covariance = np.atleast_2d(np.cov(z, rowvar=False))
        centres = kept.mean(axis=0) + np.sqrt(1.0 - h2) * (kept - kept.mean(axis=0))
        kernel = h2 * covariance + np.diag(drift_std**2)
        return cls(centres, np.linalg.cholesky(kernel + 1e-12 * np.eye(d)), low, high)

    @property
    def std(self) -> FloatArray:
        """Standard deviation of each z, (d,)."""
        return np.asarray(np.sqrt(self.centres.var(axis=0) + (self.factor**2).sum(axis=1)))

    def draw(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Return draws (n, d); what falls beyond a bound is mirrored back."""
        which = rng.integers(len(self.centres), size=n)
        z = self.centres[which] + rng.standard_normal((n, self.low.size)) @ self.factor.T
        z = np.where(z < self.low, 2.0 * self.low - z, z)
        z = np.where(z > self.high, 2.0 * self.high - z, z)
        return np.clip(z, self.low, self.high)

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return ln p (n,) of points (n, d); −inf outside the bounds."""
        apart = (z[:, None, :] - self.centres).reshape(-1, self.low.size)
        u = np.linalg.solve(self.factor, apart.T).reshape(self.low.size, len(z), -1)
        log_p = logsumexp(-0.5 * (u * u).sum(axis=0), axis=1)
        log_p -= np.log(len(self.centres)) + np.log(np.diag(self.factor)).sum()
        log_p -= 0.5 * self.low.size * np.log(2.0 * np.pi)
        inside = np.all((z >= self.low) & (z <= self.high), axis=1)
        return np.where(inside, log_p, -np.inf)


@dataclass(frozen=True)
class Walk:
    """Posteriors of successive records.

    Attributes
    ----------
    names : parameter names
    posteriors : tuple of Posterior
        One a record; each knows the records up to its own.
    """

    names: tuple[str, ...]
    posteriors: tuple[Posterior, ...]

    @property
    def log_evidence(self) -> float:
        """Of all records together."""
        return sum(p.log_evidence for p in self.posteriors)

    def median(self) -> FloatArray:
        """Return the median of every parameter after every record, (n_records, d)."""
        return np.array([np.exp(np.median(p.log_theta, axis=0)) for p in self.posteriors])

    def interval(self, level: float = 0.9) -> FloatArray:
        """Return the central intervals, (n_records, d, 2)."""
        return np.array([p.interval(level) for p in self.posteriors])


def follow_records(
    problems: Sequence[Problem],
    *,
    drift: Mapping[str, float] | None = None,
    particles: int = 150,
    islands: int = 4,
    seed: int = 0,
    progress: Callable[[], None] | None = None,
) -> Walk:
    """Return the posterior after each record.

    Parameters
    ----------
    problems : sequence of Problem
        One a record, of the same parameters; the first one's prior starts the walk.
    drift : {parameter: std}, optional
        Standard deviation by which ln θ may walk between records; default: none walks.
    progress : callable, optional
        Called after each record.

    Raises
    ------
    InputError
        If there is no record, the records differ in their parameters, or a drift names none of them.
    NumericalError
        If a posterior does not converge.
    """
    if not problems:
        raise InputError("no record to follow", field="records", value=[])
    names = tuple(p.name for p in problems[0].parameters)
    for problem in problems:
        if tuple(p.name for p in problem.parameters) != names:
            raise InputError("records of different parameters", field="records", value=names)
    for name in drift or {}:
        if name not in names:
            raise InputError("no such parameter", field="drift", value=name, allowed=", ".join(names))
    step = np.array([(drift or {}).get(name, 0.0) for name in names])
    bounds = problems[0].prior
    posteriors: list[Posterior] = []
    for i, problem in enumerate(problems):
        prior = None
        if posteriors:
            prior = DrawnPrior.after(posteriors[-1].log_theta, step, bounds.low, bounds.high)
        posteriors.append(
            sample_posterior(problem, prior=prior, particles=particles, islands=islands, seed=seed + i)
        )
        if progress is not None:
            progress()
    return Walk(names, tuple(posteriors))


def drift_log_odds(
    problems: Sequence[Problem],
    drift: Mapping[str, float],
    *,
    particles: int = 150,
    islands: int = 4,
    seed: int = 0,
) -> float:
    """Return the log Bayes factor of a walk with this drift against parameters that stay.

    Those that stay are sampled with all records at once. Above 3 the records speak clearly for a drift,
    below −1 against it (Kass & Raftery 1995).
    """
    moving = follow_records(problems, drift=drift, particles=particles, islands=islands, seed=seed)
    together = replace(problems[0], states=tuple(state for p in problems for state in p.states))
    still = sample_posterior(together, particles=particles, islands=islands, seed=seed)
    return moving.log_evidence - still.log_evidence
