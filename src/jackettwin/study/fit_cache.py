"""Fits of the laws, kept by the content they were made of: nothing is searched or sampled twice."""

from __future__ import annotations

from dataclasses import fields, replace

from jackettwin.files import NOT_KEPT, Keep, StoredSchema, digest, kept
from jackettwin.progress import SILENT, Progress
from jackettwin.twin.config import UpdateSettings
from jackettwin.updating import Fit, Problem, Update, update, with_posterior
from jackettwin.version import __version__

FIT = StoredSchema("fit", Fit)
"""How fits are kept."""


def fitted(
    problem: Problem,
    shown: tuple[int, ...],
    how: UpdateSettings,
    *,
    sampled: bool,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Update:
    """Return the update of one law to a problem, found again if it was made before.

    Parameters
    ----------
    shown : mode numbers
    sampled : bool
        Whether its posterior is wanted, too.

    Raises
    ------
    InputError
        If no start of the search ends in a minimum.
    """

    def compute() -> Fit:
        return update(
            problem,
            modes=shown,
            method=how.method,
            starts=how.starts_for(problem),
            particles=how.particles,
            sampler=how.sampler,
            seed=how.seed,
            most_evaluations=how.most_evaluations,
            sampled=sampled,
            progress=progress,
        ).fit

    fit = kept(keep, FIT, fit_key(problem, shown, how, sampled=sampled), compute)
    return Update(problem, problem.model.reaching(max(shown)), shown, fit)


def with_kept_posterior(
    fit: Update, how: UpdateSettings, *, progress: Progress = SILENT, keep: Keep = NOT_KEPT
) -> Update:
    """Return a fitted law with its posterior, found again if it was sampled before."""

    def compute() -> Fit:
        return with_posterior(
            fit, particles=how.particles, sampler=how.sampler, seed=how.seed, progress=progress
        ).fit

    return replace(fit, fit=kept(keep, FIT, fit_key(fit.problem, fit.shown, how, sampled=True), compute))


def fit_key(problem: Problem, shown: tuple[int, ...], how: UpdateSettings, *, sampled: bool) -> str:
    """Return the identity of a fit: the same key, the same result to the last digit.

    The data, the priors and every number of the model count, wherever in a twin's files they come from.
    """
    model = problem.model
    steel = {name: getattr(model.assembly, name) for name in ("mass", "stiffness")}
    matrices = {**steel, **model.nuisance.matrices, **model.nuisance.given}
    plain = [
        getattr(model, f.name) for f in fields(model) if f.name not in ("assembly", "family", "nuisance")
    ]
    return digest(
        [
            [problem.states, problem.parameters, problem.prior],
            [model.family.name, plain, replace(model.nuisance, matrices={}, given={})],
            {name: [m.tocsc().data, m.tocsc().indices, m.tocsc().indptr] for name, m in matrices.items()},
            [shown, how.method, how.starts, how.seed, how.most_evaluations],
            [how.particles, how.sampler] if sampled else None,
            __version__,
        ]
    )
