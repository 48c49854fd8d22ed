"""Model of unexplained variation as noise plus Ornstein-Uhlenbeck processes, and its filter."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.watching.design import RegressionPrior
from jackettwin.watching.hours import Hours
from jackettwin.watching.kernels import filter_rows


@dataclass(frozen=True)
class Memory:
    """Model of the unexplained variation of m quantities.

    Attributes
    ----------
    scale : (m,) factors on stated standard deviations
    std : (m,) standard deviations of all slow processes together
    days, shares : (k,) time constants of the processes, and their shares of the variance
    correlation : (k, m, m) correlation of each process between quantities
    """

    scale: FloatArray
    std: FloatArray
    days: FloatArray
    shares: FloatArray
    correlation: FloatArray

    @property
    def slow(self) -> FloatArray:
        """Covariances of the processes, (k, m, m)."""
        return np.asarray(self.shares[:, None, None] * np.outer(self.std, self.std) * self.correlation)

    def of(self, chosen: list[int]) -> Memory:
        """Return the model of some of the quantities."""
        return replace(
            self,
            scale=self.scale[chosen],
            std=self.std[chosen],
            correlation=self.correlation[:, chosen][:, :, chosen],
        )


@dataclass(frozen=True)
class Belief:
    """State of a model after some rows, as in :mod:`jackettwin.watching.kernels`."""

    mean: FloatArray
    cov: FloatArray


def prior_belief(memory: Memory, prior: RegressionPrior) -> Belief:
    """Return the state before the first row."""
    m, p = prior.std.shape
    slow = memory.slow
    cov = np.zeros((m * (p + len(slow)), m * (p + len(slow))))
    cov[range(m * p), range(m * p)] = prior.std.ravel() ** 2
    for k, one in enumerate(slow):
        place = slice(m * (p + k), m * (p + k + 1))
        cov[place, place] = one
    mean = np.zeros(len(cov))
    mean[: m * p] = prior.mean.ravel()
    return Belief(mean, cov)


@dataclass(frozen=True)
class Bank:
    """Possible steps: response of the state to each, and information of the innovations on each.

    Attributes
    ----------
    response, info, score, cross : arrays of :func:`jackettwin.watching.kernels.filter_rows`; ``cross`` is
        None unless ramps are tested
    """

    response: FloatArray
    info: FloatArray
    score: FloatArray
    cross: FloatArray | None = None

    def with_begin(self) -> Bank:
        """Return the bank with one more onset, without information on it."""

        def grown(x: FloatArray, axes: int = 1) -> FloatArray:
            more = np.zeros((*(n + 1 for n in x.shape[:axes]), *x.shape[axes:]))
            more[tuple(slice(n) for n in x.shape)] = x
            return more

        cross = None if self.cross is None else grown(self.cross, 2)
        return Bank(grown(self.response), grown(self.info), grown(self.score), cross)

    def thinned(self, keep: BoolArray) -> Bank:
        """Return the bank with only some of its onsets."""
        cross = None if self.cross is None else self.cross[keep][:, keep]
        return Bank(self.response[keep], self.info[keep], self.score[keep], cross)


def empty_bank(m: int, n: int, *, ramps: bool = False) -> Bank:
    """Return a bank without onsets."""
    cross = np.zeros((0, 0, m, m)) if ramps else None
    return Bank(np.zeros((0, m, n)), np.zeros((0, m, m)), np.zeros((0, m)), cross)


@dataclass(frozen=True)
class Filtered:
    """Result of filtering some rows.

    Attributes
    ----------
    innovation, spread : (n_rows, m) ν and its variance
    log_likelihood : log likelihood of the rows and of the scatter within hours
    """

    belief: Belief
    bank: Bank
    innovation: FloatArray
    spread: FloatArray
    log_likelihood: float


def filtered(memory: Memory, belief: Belief, bank: Bank, hours: Hours, last_day: float) -> Filtered:
    """Return state and bank after some hours; ``last_day`` is the time of the previous state."""
    m = hours.values.shape[1]
    if bank.response.shape[1:] != (m, belief.mean.size) or memory.slow.shape != (len(memory.days), m, m):
        raise ValueError("bank, belief and memory are not of one model")  # compiled code does not check
    if belief.mean.size != m * (hours.rows.shape[1] + len(memory.days)):
        raise ValueError("belief and rows are not of one model")
    mean, cov = belief.mean.copy(), belief.cov.copy()
    none = np.zeros((0, 0, m, m))
    cross = none if bank.cross is None else bank.cross.copy()
    grown = Bank(bank.response.copy(), bank.info.copy(), bank.score.copy(), cross)
    innovation, spread = np.empty(hours.values.shape), np.empty(hours.values.shape)
    before = last_day if np.isfinite(last_day) else float(hours.days[0]) if hours.days.size else 0.0
    likelihood = filter_rows(
        mean, cov, grown.response, grown.info, grown.score, cross,
        np.ascontiguousarray(hours.rows), np.ascontiguousarray(hours.values),
        np.ascontiguousarray(hours.noise * memory.scale**2), np.diff(hours.days, prepend=before),
        1.0 / memory.days, memory.slow, innovation, spread,
    )  # fmt: skip
    if bank.cross is None:
        grown = replace(grown, cross=None)
    return Filtered(Belief(mean, cov), grown, innovation, spread, likelihood + _scatter(memory, hours))


def _scatter(memory: Memory, hours: Hours) -> float:
    """Return the log likelihood of the scatter within hours, up to terms common to all models."""
    chi2, freedom = hours.chi2.sum(axis=0), hours.freedom.sum(axis=0)
    return float(-0.5 * np.sum(chi2 / memory.scale**2 + freedom * np.log(memory.scale**2)))
