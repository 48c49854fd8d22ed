"""Errors that turbines of one design share: what drawings have wrong, they have wrong on every one of them.

What is weighed, grown over or driven at one place stays each turbine's own. The derivatives Γ of all
residuals are stacked with one column for a shared error and one for each turbine's own, so that every formula
of :mod:`jackettwin.updating.model_error.marginal` holds for the farm as it does for one turbine.
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
    """Errors of the models of several turbines, all independent and of variance one.

    Attributes
    ----------
    gains : (n_data of all, n_errors) derivatives Γ of all residuals, turbine after turbine
    names : tuple of (turbine, error), the turbine None of an error that all share
    """

    gains: FloatArray
    names: tuple[tuple[str | None, str], ...]


def stacked(
    gains: Mapping[str, FloatArray], names: Mapping[str, Sequence[str]], shared: Collection[str]
) -> StackedErrors:
    """Return the errors of several turbines, those of ``shared`` names as one column each.

    An error of several columns of one name, of each foot, is shared column by column. A turbine may lack a
    shared error.

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
    """Return mean and standard deviation of each shared error after the data of all turbines.

    In its standard deviations before, about each turbine's best fit, its own parameters and errors open; to
    first order. Of an error of several columns, the best known.

    Parameters
    ----------
    problems : {turbine: its problem, with an error model}
    z : {turbine: (d,) ln θ of its best fit}
    shared : names of tolerances, or of remainders (``f1``), that are one unknown of all turbines

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
