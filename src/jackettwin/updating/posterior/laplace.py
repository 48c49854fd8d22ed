"""Laplace's approximation of the posterior: a normal in ln θ around one solution."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem


def log_covariance(problem: Problem, theta: FloatArray) -> FloatArray:
    """Return the covariance (d, d) of ln θ: (JᵀJ + P)⁻¹ with the prior's precision P.

    A uniform prior is treated as a normal one of the same standard deviation, which remains if the data have
    no effect.
    """
    _, J, _ = problem.evaluate(np.log(theta), None)
    flat = np.array([p.median is None for p in problem.parameters])
    return np.asarray(np.linalg.inv(J.T @ J + np.diag(np.where(flat, problem.prior.std**-2.0, 0.0))))


def laplace_draws(problem: Problem, theta: FloatArray, *, n: int = 400, seed: int = 0) -> FloatArray:
    """Return draws (n, d) of ln θ from the normal around ``theta``, limited to the bounds."""
    rng = np.random.default_rng(seed)
    z = rng.multivariate_normal(np.log(theta), log_covariance(problem, theta), n)
    return np.clip(z, problem.prior.low, problem.prior.high)
