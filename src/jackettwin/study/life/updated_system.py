"""The structure on supports updated by a twin's records or targets, and on draws of their posterior."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import require
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.progress import SILENT, Progress
from jackettwin.response import System, undamped_modes
from jackettwin.study.run import run_twin
from jackettwin.twin import TwinConfig
from jackettwin.updating import Update, likely, possible

_MOST_DRAWS = 100


def updated(config: TwinConfig, *, progress: Progress = SILENT, keep: Keep = NOT_KEPT) -> Update:
    """Return a twin's update under its most probable law.

    Raises
    ------
    InputError
        If the twin has neither records nor targets, or they do not fit the structure.
    """
    require(
        config.records or config.targets,
        "nothing updates the supports",
        file=config.path,
        field="records",
        remedy="state records or targets",
    )
    result = run_twin(config, posteriors="likely", progress=progress, keep=keep)
    update = likely(result.updates)
    assert update is not None
    return update


def updated_systems(update: Update, *, draws: int = 0, seed: int = 0) -> tuple[System, ...]:
    """Return the structure on its most probable supports, then ``draws`` of any posterior.

    The draws differ in their supports and in what the tolerances leave open of the structure, as the data
    leave both probable together. Dampers that lock the feet in the first mode are left out: without a prior
    data hardly exclude them, and no ground loses more than it stores.
    """
    known = update.uncertainty
    best = np.log(update.best.theta) if known is None else np.log(known.median)
    others = np.empty((0, best.size))
    if known is not None and draws:
        rows = np.random.default_rng(seed).choice(len(known.log_theta), min(draws, _MOST_DRAWS))
        others = _unlocked(update, known.log_theta, rows)
    first, *vectors = update.problem.vectors(np.vstack([best[None], others]), update.problem.states[0])
    system, model = update.model.system, update.problem.error_model
    if not len(others) or model is None:
        return (system(first), *(system(theta) for theta in vectors))
    drawn = update.problem.drawn_errors(others, np.random.default_rng(seed)).errors
    amounts = np.nan_to_num(drawn[:, : len(model.tolerances)])
    pairs = zip(vectors, amounts, strict=True)
    return (system(first), *(possible(partial(system, theta), own) for theta, own in pairs))


def _unlocked(update: Update, log_theta: FloatArray, rows: IntArray) -> FloatArray:
    """Return rows of a posterior (n, n_parameters), each that locks the feet exchanged for one that does not.

    All are kept as they are where every one locks them.
    """
    others = np.random.default_rng(len(rows)).permutation(len(log_theta))
    tried = log_theta[np.concatenate([rows, others])]
    vectors = update.problem.vectors(tried, update.problem.states[0])
    omega = float(undamped_modes(update.model.system(vectors[0]), 1).omega[0])
    free = (row for row, theta in zip(tried, vectors, strict=True) if not _locks(update, theta, omega))
    found = list(islice(free, len(rows)))
    return np.array([found[i % len(found)] for i in range(len(rows))]) if found else log_theta[rows]


def _locks(update: Update, theta: FloatArray, omega: float) -> bool:
    """Whether a foot loses more than it stores at an angular frequency."""
    support = update.model.system(theta).support
    feet = update.model.assembly.structure.reaction_nodes
    stiffness = [spring.law.stiffness(1j * omega) for spring in support.springs if spring.node in feet]
    return any(abs(k.imag) > k.real for k in stiffness)


def with_record(config: TwinConfig, record: Path) -> TwinConfig:
    """Return a twin that is updated by a record if it has neither records nor targets."""
    if config.records or config.targets:
        return config
    return replace(config, records=(record,))
