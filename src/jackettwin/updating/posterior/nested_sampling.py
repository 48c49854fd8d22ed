"""Posterior and evidence by nested sampling with dynesty: slower than SMC, but independent of it."""

from __future__ import annotations

from itertools import count

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, require
from jackettwin.progress import SILENT, Progress
from jackettwin.updating.posterior.smc import Posterior, gathered
from jackettwin.updating.problem import Problem

_DRAWS = 400
"""Equally weighted draws taken from each run."""
_RUNS = 2
"""Independent runs, whose disagreement is the error."""
_REMAINING = 0.02
"""Largest ln Z that the live points may still add at the end."""
_SAID_EVERY = 100
"""Number of evaluations between progress messages: some tenths of a second."""


def sample_nested(
    problem: Problem,
    *,
    live: int = 200,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Posterior:
    """Return the posterior of a problem's parameters from independent runs of dynesty (Speagle 2020).

    Parameters
    ----------
    live : int
        Live points of each run.
    progress : Progress
        Receives the number of likelihood evaluations.

    Raises
    ------
    InputError
        If dynesty is not installed, or the residuals have no standard deviations.
    NumericalError
        If the runs disagree.
    """
    try:
        from dynesty import NestedSampler
    except ImportError:
        raise InputError(
            "nested sampling needs dynesty",
            field="update.sampler",
            value="nested",
            remedy="pip install 'jackettwin[nested]', or sampler: smc",
        ) from None
    require(problem.weighted, "no standard deviations, no likelihood", field="targets")
    near = problem.anchor(0.5 * (problem.prior.low + problem.prior.high))

    evaluations = count(1)

    def log_likelihood(z: FloatArray) -> float:
        n = next(evaluations)
        if n % _SAID_EVERY == 0:
            progress.within(f"nested sampling, {n} evaluations of the likelihood")
        return float(problem.log_likelihood(z[None], near)[0][0])

    draws, values, evidences = [], [], []
    for rng in np.random.default_rng(seed).spawn(_RUNS):
        sampler = NestedSampler(
            log_likelihood, problem.prior.from_unit, problem.prior.low.size, nlive=live, rstate=rng
        )
        sampler.run_nested(dlogz=_REMAINING, print_progress=False)
        weight = np.exp(sampler.results.logwt - sampler.results.logz[-1])
        which = rng.choice(weight.size, _DRAWS, p=weight / weight.sum())
        draws.append(sampler.results.samples[which])
        values.append(sampler.results.logl[which])
        evidences.append(sampler.results.logz[-1])
    z = np.array(draws)
    poles = [problem.log_likelihood(run, near)[1][0].poles for run in z]
    return gathered(problem, z=z, poles=np.array(poles), log_l=np.array(values), log_z=np.array(evidences))
