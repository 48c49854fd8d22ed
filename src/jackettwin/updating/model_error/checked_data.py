"""All measured data of a fit, whitened, with their derivatives by parameters and by errors of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.data.targets import Residuals, Target
from jackettwin.updating.model_error.directions import Direction
from jackettwin.updating.model_error.measured_axes import PairDirection
from jackettwin.updating.model_error.pair_directions import direction_gains, direction_row
from jackettwin.updating.problem import Problem, State

Column = tuple[Direction, FloatArray]


@dataclass(frozen=True, eq=False)
class CheckedData:
    """All data of a fit, whitened by their measurement uncertainty, with derivatives.

    Attributes
    ----------
    r, J, gains : residuals, their derivatives by ln θ and by the errors of the model; the priors' rows last
    known, asked : lists of (error, (n,) derivative of the residuals)
        Tolerances, and suspects.
    names, scale : names of the data, and ln of measured over model (or angle) per unit of residual
    """

    r: FloatArray
    J: FloatArray
    gains: FloatArray
    known: list[Column]
    asked: list[Column]
    names: list[str]
    scale: FloatArray


def checked_data(
    problem: Problem,
    z: FloatArray,
    beside: Sequence[Target],
    suspects: Sequence[Direction],
    pairs: Sequence[PairDirection],
) -> CheckedData | None:
    """Return all data of a fit (d,) of ln θ; None if a mode is lost.

    Parameters
    ----------
    beside : modes that were measured but not fitted, whose frequencies are included
    suspects : errors in addition to those of the error model
    pairs : measured directions of pairs of modes
    """
    whole = _with_beside(problem, beside)
    found = whole.anchor(z)
    if found is None:
        return None
    r, J, _ = whole.plain.evaluate(z, None)
    turned = [(pair, row) for pair in pairs if (row := direction_row(whole, z, pair)) is not None]
    pulls, pull_rows = whole.prior.rows(z)
    n, errors = whole.n_data, whole.error_model
    gains = whole.gains(found)[0]
    asked = np.zeros((n, 0))
    each: tuple[Direction, ...] = ()
    if errors is not None:
        each = errors.directions.each
        others = replace(errors.directions, each=tuple(suspects))
        asked = replace(whole, error_model=replace(errors, directions=others)).gains(found)[0][
            :, : len(suspects)
        ]
        by_pair = [direction_gains(whole, z, pair, errors.directions) for pair, _ in turned]
        gains = _under(gains, by_pair, pulls.size)
        asked = _under(asked, [direction_gains(whole, z, pair, others) for pair, _ in turned], pulls.size)
    else:
        gains = _under(gains, [np.zeros(0)] * len(turned), pulls.size)
    return CheckedData(
        # priors that are not uniform count as data
        np.concatenate([r[:n], [row.residual for _, row in turned], pulls]),
        np.concatenate([J[:n], *(row.slopes[None] for _, row in turned), pull_rows]),
        gains,
        list(zip(each, gains.T, strict=False)),
        list(zip(suspects if errors is not None else (), asked.T, strict=True)),
        [*whole.data_names, *(pair.datum for pair, _ in turned)],
        np.concatenate([*(_log_std(state) for state in whole.states), [row.scale for _, row in turned]]),
    )


def _under(gains: FloatArray, rows: Sequence[FloatArray], n_zero: int) -> FloatArray:
    """Return gains with further rows, filled with zeros, and rows of zeros."""
    filled = [np.pad(row, (0, gains.shape[1] - row.size))[None] for row in rows]
    return np.concatenate([gains, *filled, np.zeros((n_zero, gains.shape[1]))])


def _with_beside(problem: Problem, beside: Sequence[Target]) -> Problem:
    """Return the problem with the frequencies of modes that were not fitted."""
    first = problem.states[0]
    known = {t.mode: t for t in first.residuals.targets}
    for t in beside:
        own = known.get(t.mode, Target(t.mode))
        if own.frequency_hz is None and t.frequency_hz is not None and t.frequency_std_hz is not None:
            known[t.mode] = replace(own, frequency_hz=t.frequency_hz, frequency_std_hz=t.frequency_std_hz)
    targets = tuple(known[mode] for mode in sorted(known))
    if targets == tuple(sorted(first.residuals.targets, key=lambda t: t.mode)):
        return problem
    whole = problem.on(problem.model.reaching(max(known)))
    residuals = Residuals(targets, relative=False)
    place = {name: row for row, name in enumerate(first.residuals.names)}
    own_errors = np.zeros((residuals.count, first.errors.shape[1]))
    for row, name in enumerate(residuals.names):
        if name in place:
            own_errors[row] = first.errors[place[name]]
    state = replace(whole.states[0], residuals=residuals, errors=own_errors)
    return replace(whole, states=(state, *whole.states[1:]))


def _log_std(state: State) -> FloatArray:
    """Return the measured standard deviation of each datum's logarithm; NaN of shapes and relaxations."""
    of = {}
    for t in state.residuals.used:
        of[f"f{t.mode}"], of[f"ζ{t.mode}"] = t.log_stds
    return np.array([of.get(name) or np.nan for name in state.names], dtype=np.float64)
