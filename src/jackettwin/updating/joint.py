"""From a model and data in several operating states to one problem: what the states share, and what not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.updating.families import Parameter
from jackettwin.updating.model import SupportModel
from jackettwin.updating.prior import BoxPrior
from jackettwin.updating.problem import Problem, State
from jackettwin.updating.shapes import ShapeTarget
from jackettwin.updating.targets import Residuals

FloatArray = npt.NDArray[np.float64]

GROWTH = "growth_per_day"
"""Parameter: the factor by which others grow from one day to the next."""
_FAR = 8.0
"""Bounds of a lognormal parameter that has none of its own, in standard deviations from the median."""


@dataclass(frozen=True)
class Growth:
    """Some parameters grow in time by one common factor a day, θ(t) = θ · g^t.

    Attributes
    ----------
    parameters : names of those that grow
    days : {state: t}
    log_std : float
        Standard deviation of ln g before the data; its median is 0.
    """

    parameters: tuple[str, ...]
    days: Mapping[str, float] = field(default_factory=dict)
    log_std: float = 0.1


def single(model: SupportModel, residuals: Residuals) -> Problem:
    """Return the problem of one operating state.

    Raises
    ------
    InputError
        If a parameter has a lognormal prior but the residuals carry no standard deviations.
    """
    return joint(model, {"": (residuals, {})})


def joint(
    model: SupportModel,
    states: Mapping[str, tuple[Residuals, Mapping[str, float]]],
    *,
    per_state: tuple[str, ...] = (),
    shapes: tuple[ShapeTarget, ...] = (),
    errors: Mapping[str, float] | None = None,
    growth: Growth | None = None,
) -> Problem:
    """Return the problem of several operating states that share their parameters.

    Parameters
    ----------
    states : {name: (residuals, factors)}
        Factors by parameter name: what a shared parameter is multiplied by in this state.
    per_state : tuple of str
        Parameters with a value of their own in each state, named ``parameter@state``.
    shapes : tuple of ShapeTarget
        Measured shapes, in the first state; its residuals hold their modes, too.
    errors : {datum: log_std}, optional
        Errors of the model that all states share, by datum (``f1``, ``ζ4``): each is a factor ``error_f1`` on
        the model's value, lognormal around one. More states do not average them out.
    growth : Growth, optional
        Adds the parameter ``growth_per_day``.

    Raises
    ------
    InputError
        If a name is none of the model's, or priors meet residuals without standard deviations.
    """
    errors = errors or {}
    names = [p.name for p in model.parameters]
    grown = () if growth is None else growth.parameters
    _no_strangers((*per_state, *grown, *(name for _, factors in states.values() for name in factors)), names)
    shared = [p for p in model.parameters if p.name not in per_state]
    own = [p for p in model.parameters if p.name in per_state]
    parameters = (
        *shared,
        *(replace(p, name=f"{p.name}@{state}") for state in states for p in own),
        *(_factor(f"error_{datum}", log_std) for datum, log_std in errors.items()),
        *(() if growth is None else (_factor(GROWTH, growth.log_std),)),
    )
    place = {p.name: i for i, p in enumerate(parameters)}
    built = []
    for i, (state, (residuals, factors)) in enumerate(states.items()):
        weights = np.zeros((len(names), len(parameters)))
        for row, name in enumerate(names):
            weights[row, place.get(name, place.get(f"{name}@{state}", -1))] = 1.0
            if growth is not None and name in grown:
                weights[row, place[GROWTH]] = growth.days.get(state, 0.0)
        shared_errors = np.zeros((residuals.count, len(parameters)))
        for row, datum in enumerate(residuals.names):
            if datum in errors:
                shared_errors[row, place[f"error_{datum}"]] = 1.0
        shifts = np.log([factors.get(name, 1.0) for name in names])
        built.append(State(state, residuals, weights, shifts, shared_errors, () if i else shapes))
    problem = Problem(model, tuple(built), parameters, BoxPrior.of(parameters))
    _no_priors_without_deviations(problem)
    return problem


def _factor(name: str, log_std: float) -> Parameter:
    """Return a parameter around one."""
    return Parameter(name, exp(-_FAR * log_std), exp(_FAR * log_std), "-", 1.0, log_std)


def _no_strangers(given: Sequence[str], names: list[str]) -> None:
    for name in given:
        if name not in names:
            raise InputError("no such parameter", field="states", value=name, allowed=", ".join(names))


def _no_priors_without_deviations(problem: Problem) -> None:
    informed = [p.name for p in problem.parameters if p.median is not None]
    if problem.relative and informed:
        raise InputError(
            "a prior needs data with standard deviations",
            field="update.priors",
            value=informed,
            remedy="give every target its standard deviation, or leave the priors out",
        )
