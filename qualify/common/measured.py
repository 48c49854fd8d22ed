"""What one record says of a twin of known truth, and what is then known of it."""

from __future__ import annotations

import numpy as np

from jackettwin.errors import NumericalError
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.updating import Problem, Target
from jackettwin.updating.posterior.smc import Posterior, sample_posterior


def as_measured(
    modes: tuple[int, ...], poles: np.ndarray, seconds: float, rng: np.random.Generator
) -> tuple[Target, ...]:
    """Return poles as one record gives them: lognormal, with Au's long-data limits."""
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    cov_f, cov_zeta = long_data_limits(f, zeta, seconds)
    f = f * np.exp(cov_f * rng.standard_normal(f.size))
    zeta = zeta * np.exp(cov_zeta * rng.standard_normal(zeta.size))
    return tuple(map(Target, modes, f, cov_f * f, zeta, cov_zeta * zeta))


def sampled(problem: Problem, seed: int) -> Posterior | None:
    """Return the posterior; with twice the draws if the islands do not agree, as an update does."""
    for particles in (100, 200):
        try:
            return sample_posterior(problem, particles=particles, islands=3, seed=seed)
        except NumericalError:
            continue
    return None
