"""The fits of a twin's laws to the same data; no fit with the same inputs is computed twice."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from typing import Literal

from jackettwin.errors import InputError
from jackettwin.files import NOT_KEPT, Keep, StoredSchema, digest, kept
from jackettwin.progress import SILENT, Progress
from jackettwin.response import Matrix
from jackettwin.soil import SERIES
from jackettwin.study.problem import UpdateEvidence, law_problem
from jackettwin.study.relaxations import relaxing
from jackettwin.twin import TwinConfig
from jackettwin.twin.config import UpdateSettings
from jackettwin.updating import ErrorModel, Fit, Problem, Update, likely, series, update, with_posterior
from jackettwin.version import __version__

Posteriors = Literal["all", "likely", "none"]
FIT = StoredSchema("fit", Fit)
"""Format of stored fits."""


@dataclass(frozen=True)
class LawFits:
    """The fits of laws to the same data.

    Attributes
    ----------
    updates : tuple of Update
        One for each law that explains the data.
    unfit : {law: error}
        Laws that cannot explain them.
    left_out : tuple of str
        Laws without real poles, if a relaxation was measured.
    series_choice : str or None
        Why a series has the length that it has; None if no series was asked for.
    """

    updates: tuple[Update, ...]
    unfit: dict[str, InputError]
    left_out: tuple[str, ...]
    series_choice: str | None


def fit_laws(
    config: TwinConfig,
    evidence: UpdateEvidence,
    laws: tuple[str, ...],
    shown: tuple[int, ...],
    *,
    posteriors: Posteriors,
    progress: Progress,
    keep: Keep,
) -> LawFits:
    """Fit each law to the same data; a law that fails is no obstacle to the others.

    Parameters
    ----------
    shown : mode numbers

    Raises
    ------
    InputError
        If no law can explain the data, or a relaxation was measured and no law has real poles.
    """

    def fit(law: str, *, sampled: bool) -> Update:
        problem = law_problem(config, evidence, law)
        with _said_where(config):
            return fitted(problem, shown, config.update, sampled=sampled, progress=progress, keep=keep)

    tried = relaxing(config, laws) if evidence.relaxations else laws
    updates, unfit, why = dict[str, Update](), dict[str, InputError](), None
    for law in tried:
        progress(f"update {law}")
        try:
            name = law
            if law == SERIES:
                chosen, why = series(lambda name: fit(name, sampled=False), progress)
                name = chosen.law
            if name not in updates:  # a series may end with a law that is also listed
                updates[name] = fit(name, sampled=posteriors == "all")
        except InputError as error:
            unfit[law] = error
    if not updates:
        raise next(iter(unfit.values()))
    if posteriors == "likely" and (best := likely(list(updates.values()))) is not None:
        updates[best.law] = with_kept_posterior(best, config.update, progress=progress, keep=keep)
    left_out = tuple(law for law in laws if law not in tried)
    return LawFits(tuple(updates.values()), unfit, left_out, why)


@contextmanager
def _said_where(config: TwinConfig) -> Iterator[None]:
    """Add the place in the twin file to errors about data that no support can produce."""
    try:
        yield
    except InputError as error:
        source = "records" if config.records else "targets"
        raise error.at(file=config.path, field=None if error.field else source) from None


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
