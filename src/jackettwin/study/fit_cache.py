"""Cache of the laws' fits by the content of their inputs: no fit is computed twice."""

from __future__ import annotations

from dataclasses import fields, replace

from jackettwin.files import NOT_KEPT, Keep, StoredSchema, digest, kept
from jackettwin.progress import SILENT, Progress
from jackettwin.response import Matrix
from jackettwin.twin.config import UpdateSettings
from jackettwin.updating import ErrorModel, Fit, Problem, Update, update, with_posterior
from jackettwin.version import __version__

FIT = StoredSchema("fit", Fit)
"""Format of stored fits."""


def fitted(
    problem: Problem,
    shown: tuple[int, ...],
    how: UpdateSettings,
    *,
    sampled: bool,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Update:
    """Return the update of one law to a problem, from the cache if it is stored there.

    Parameters
    ----------
    shown : mode numbers
    sampled : bool
        Whether the posterior is sampled too.

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
    """Return a fitted law with its posterior, from the cache if it is stored there."""

    def compute() -> Fit:
        return with_posterior(
            fit, particles=how.particles, sampler=how.sampler, seed=how.seed, progress=progress
        ).fit

    return replace(fit, fit=kept(keep, FIT, fit_key(fit.problem, fit.shown, how, sampled=True), compute))


def fit_key(problem: Problem, shown: tuple[int, ...], how: UpdateSettings, *, sampled: bool) -> str:
    """Return the identity of a fit: equal keys give equal results to the last digit.

    It depends on the data, the priors and every number of the model, but not on the files they come from.
    """
    model = problem.model
    steel = {name: getattr(model.assembly, name) for name in ("mass", "stiffness")}
    matrices = {**steel, **model.nuisance.matrices, **model.nuisance.given}
    apart = ("assembly", "family", "nuisance", "directions")
    plain = [getattr(model, f.name) for f in fields(model) if f.name not in apart]
    return digest(
        [
            [problem.states, problem.parameters, problem.prior],
            [model.family.name, plain, replace(model.nuisance, matrices={}, given={})],
            {name: _numbers(matrix) for name, matrix in matrices.items()},
            _errors(problem.error_model),
            [shown, how.method, how.starts, how.seed, how.most_evaluations],
            [how.particles, how.sampler] if sampled else None,
            __version__,
        ]
    )


def _numbers(matrix: Matrix | None) -> list[object]:
    """Return every number of a sparse matrix."""
    return [] if matrix is None else [matrix.tocsc().data, matrix.tocsc().indices, matrix.tocsc().indptr]


def _errors(model: ErrorModel | None) -> list[object]:
    """Return every number of a model's errors."""
    if model is None:
        return []
    each = [
        [
            one.tolerance.name,
            one.tolerance.std,
            _numbers(one.mass),
            _numbers(one.stiffness),
            one.feet,
            one.resonance_hz,
        ]
        for one in model.directions.each
    ]
    return [each, dict(model.remainder), model.usual_frequency, model.usual_damping, model.scales]
