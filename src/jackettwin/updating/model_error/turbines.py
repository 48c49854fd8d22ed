"""Errors that are common to turbines of one design, such as errors of their drawings.

Errors of weighing, marine growth or pile driving are separate for each turbine. The derivatives Γ of all
residuals are stacked with one column for a common error and one per turbine for separate ones, so that the
formulas of :mod:`jackettwin.updating.model_error.marginal` apply to a farm as to one turbine.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError
from jackettwin.updating.model_error.influence import errors_after
from jackettwin.updating.problem import Problem


@dataclass(frozen=True, eq=False)
class StackedErrors:
    """Errors of the models of several turbines, independent and of variance one.

    Attributes
    ----------
    gains : (n_all_data, n_errors) derivatives Γ of all residuals, turbine after turbine
    names : tuple of (turbine, error); the turbine is None for a common error
    """

    gains: FloatArray
    names: tuple[tuple[str | None, str], ...]


def stacked(
    gains: Mapping[str, FloatArray], names: Mapping[str, Sequence[str]], shared: Collection[str]
) -> StackedErrors:
    """Return the errors of several turbines, with one column for each common error (``shared``).

    An error with several columns of one name (one per foot) is common column by column. A turbine need not
    have all common errors.

    Parameters
    ----------
    gains : {turbine: (n_data, n_errors)}
    names : {turbine: names of its errors, in order}
    """
    columns: dict[tuple[str | None, str, int], int] = {}
    places: dict[str, list[int]] = {}
    for turbine, own in names.items():
        seen: dict[str, int] = {}
        places[turbine] = []
        for name in own:
            which = seen[name] = seen.get(name, -1) + 1
            key = (None if name in shared else turbine, name, which)
            places[turbine].append(columns.setdefault(key, len(columns)))
    blocks = []
    for turbine, own_gains in gains.items():
        block = np.zeros((len(own_gains), len(columns)))
        block[:, places[turbine]] = own_gains
        blocks.append(block)
    return StackedErrors(np.concatenate(blocks), tuple((turbine, name) for turbine, name, _ in columns))


def shared_errors(
    problems: Mapping[str, Problem], z: Mapping[str, FloatArray], shared: Collection[str]
) -> dict[str, tuple[float, float]]:
    """Return posterior mean and standard deviation of each common error given the data of all turbines.

    They are in units of the prior standard deviation and of first order about each turbine's best fit, with
    its parameters and separate errors unknown. For an error with several columns, the best known is returned.

    Parameters
    ----------
    problems : {turbine: its problem, with an error model}
    z : {turbine: (d,) ln θ of its best fit}
    shared : names of tolerances, or of remainders (``f1``), that are common to all turbines

    Raises
    ------
    NumericalError
        If a mode is lost at a best fit.
    """
    gains, names, residuals, slopes, precision = {}, {}, [], [], []
    for turbine, problem in problems.items():
        found = problem.anchor(z[turbine])
        if found is None:
            raise NumericalError(f"a mode of {turbine} is lost at its best fit")
        r, J, _ = problem.plain.evaluate(z[turbine], found)
        gains[turbine] = problem.gains(found)[0]
        own = () if problem.error_model is None else problem.error_model.names
        names[turbine] = (*own, *problem.error_data)[: gains[turbine].shape[1]]
        residuals.append(r[: problem.n_data])
        slopes.append(J[: problem.n_data])
        precision.append(np.diag(problem.prior.std**-2.0))
    both = stacked(gains, names, shared)
    mean, std = errors_after(
        both.gains, la.block_diag(*slopes), la.block_diag(*precision), np.concatenate(residuals)
    )
    known: dict[str, tuple[float, float]] = {}
    for (owner, name), m, s in zip(both.names, mean, std, strict=True):
        if owner is None and s < known.get(name, (0.0, np.inf))[1]:
            known[name] = float(m), float(s)
    return known
