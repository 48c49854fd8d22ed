"""Construction of one problem from a model and data in several operating states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, require
from jackettwin.soil import Parameter
from jackettwin.updating.data.relaxations import RelaxationTarget
from jackettwin.updating.data.shapes import ShapeTarget
from jackettwin.updating.data.targets import Residuals
from jackettwin.updating.model import SupportModel
from jackettwin.updating.model_error.error_model import ErrorModel
from jackettwin.updating.posterior.scatter import Legs, ScatteredPrior
from jackettwin.updating.prior import BoxPrior, Prior
from jackettwin.updating.problem import Problem, State
from jackettwin.updating.tie_groups import SIDES

GROWTH = "growth_per_day"
"""Parameter: factor by which other parameters grow per day."""
_FAR = 8.0
"""Bounds of a lognormal parameter without given bounds, in standard deviations from the median."""


@dataclass(frozen=True)
class Growth:
    """Growth of some parameters by one common factor per day, θ(t) = θ · g^t.

    Attributes
    ----------
    parameters : names of the growing parameters
    days : {state: t} day of each state
    log_std : float
        Prior standard deviation of ln g, whose median is 0.
    """

    parameters: tuple[str, ...]
    days: Mapping[str, float] = field(default_factory=dict)
    log_std: float = 0.1


def single(model: SupportModel, residuals: Residuals) -> Problem:
    """Return the problem of one operating state.

    Raises
    ------
    InputError
        If a parameter has a lognormal prior but the residuals have no standard deviations.
    """
    return joint(model, {"": (residuals, {})})


def joint(
    model: SupportModel,
    states: Mapping[str, tuple[Residuals, Mapping[str, float]]],
    *,
    per_state: tuple[str, ...] = (),
    shapes: tuple[ShapeTarget, ...] = (),
    relaxations: tuple[RelaxationTarget, ...] = (),
    shared: tuple[str, ...] = (),
    scatter: Mapping[str, float] | None = None,
    errors: Mapping[str, float] | None = None,
    growth: Growth | None = None,
    error_model: ErrorModel | None = None,
) -> Problem:
    """Return the problem of several operating states that share their parameters.

    Parameters
    ----------
    states : {name: (residuals, factors)}
        Factors on shared parameters in this state, by parameter name.
    per_state : tuple of str
        Parameters with a separate value in each state, named ``parameter@state``.
    shapes : tuple of ShapeTarget
        Measured shapes in the first state, whose residuals must include their modes.
    relaxations : tuple of RelaxationTarget
        Measured real poles in the first state.
    shared : tuple of str
        Parameters of the law with one value for all tie groups, e.g. one loss factor for legs of different
        stiffness. If legs are split, ``k_vertical`` is shared by the legs' vertical springs.
    scatter : {parameter of the law: s₀}, optional
        The values of all tie groups scatter about a common mean with an unknown standard deviation of ln θ of
        about s₀ (:mod:`jackettwin.updating.posterior.scatter`).
    errors : {datum: log_std}, optional
        Errors of the model that are common to all states, by datum (``f1``, ``ζ4``): each is a lognormal
        factor ``error_f1`` with median one on the model's value. More states do not average them out.
    growth : Growth, optional
        Adds the parameter ``growth_per_day``.
    error_model : ErrorModel, optional
        Further errors of the model; only possible if the data have standard deviations.

    Raises
    ------
    InputError
        If a name does not exist in the model, or there are priors but residuals without standard deviations.
    """
    errors, alias = errors or {}, _alias(model, (*shared, *(scatter or {})), shared)
    names = [p.name for p in model.parameters]
    grown = () if growth is None else growth.parameters
    _no_strangers((*per_state, *grown, *(name for _, factors in states.values() for name in factors)), names)
    unique = {alias.get(p.name, p.name): p for p in model.parameters}
    everywhere = [replace(p, name=name) for name, p in unique.items() if p.name not in per_state]
    own = [p for p in model.parameters if p.name in per_state]
    parameters = (
        *everywhere,
        *(replace(p, name=f"{p.name}@{state}") for state in states for p in own),
        *(_factor(f"error_{datum}", log_std) for datum, log_std in errors.items()),
        *(() if growth is None else (_factor(GROWTH, growth.log_std),)),
    )
    place = {p.name: i for i, p in enumerate(parameters)}
    built = []
    for i, (state, (residuals, factors)) in enumerate(states.items()):
        weights = np.zeros((len(names), len(parameters)))
        for row, name in enumerate(names):
            known = alias.get(name, name)
            weights[row, place.get(known, place.get(f"{known}@{state}", -1))] = 1.0
            if growth is not None and name in grown:
                weights[row, place[GROWTH]] = growth.days.get(state, 0.0)
        shifts = np.log([factors.get(name, 1.0) for name in names])
        common = _common_errors(residuals.names, place)
        beside = ((), ()) if i else (shapes, relaxations)
        built.append(State(state, residuals, weights, shifts, common, *beside))
    problem = Problem(model, tuple(built), parameters, _prior(model, parameters, scatter or {}))
    if problem.weighted:
        problem = replace(problem, error_model=error_model)
    _no_priors_without_deviations(problem)
    return problem


def _alias(model: SupportModel, given: tuple[str, ...], shared: tuple[str, ...]) -> dict[str, str]:
    """Return {name in the model: name in the problem} of shared parameters, which must belong to the law."""
    law = {p.name + side: None for side in ("", *model.tie_groups.sides) for p in model.family.parameters}
    for name in given:
        require(
            name in law, "the law has no such parameter", field="support", value=name, allowed=", ".join(law)
        )
    return {member: name for name in shared for members in _members(model, name) for member in members}


def _members(model: SupportModel, name: str) -> list[list[str]]:
    """Return the parameters that a name stands for, separately by side if legs are split.

    ``k`` is that of every leg, ``k_vertical`` that of every leg's vertical spring.
    """
    tie_groups, law = model.tie_groups, [p.name for p in model.family.parameters]
    by_side: dict[str, list[str]] = {}
    for suffix, side in zip(tie_groups.suffixes, tie_groups.sides, strict=True):
        for own in law:
            if name in (own, own + side):
                by_side.setdefault(side, []).append(own + suffix)
    return list(by_side.values())


def _common_errors(data: list[str], place: Mapping[str, int]) -> FloatArray:
    """Return the matrix of model errors in the data, (n_data, n_parameters)."""
    errors = np.zeros((len(data), len(place)))
    for row, datum in enumerate(data):
        if f"error_{datum}" in place:
            errors[row, place[f"error_{datum}"]] = 1.0
    return errors


def _prior(model: SupportModel, parameters: tuple[Parameter, ...], scatter: Mapping[str, float]) -> Prior:
    """Return the priors of the parameters; scattering tie groups have a joint prior."""
    place = {p.name: i for i, p in enumerate(parameters)}
    legs = []
    for name, scale in scatter.items():
        for members in _members(model, name):
            columns = [place[member] for member in members if member in place]
            if len(columns) > 1:
                side = next((s for s in SIDES if members[0].endswith(s) and not name.endswith(s)), "")
                legs.append(Legs(name + side, np.array(columns, dtype=np.intp), scale))
    box = BoxPrior.of(parameters)
    return ScatteredPrior(box, tuple(legs)) if legs else box


def _factor(name: str, log_std: float) -> Parameter:
    """Return a lognormal parameter with median one."""
    return Parameter(name, exp(-_FAR * log_std), exp(_FAR * log_std), "-", 1.0, log_std)


def _no_strangers(given: Sequence[str], names: list[str]) -> None:
    for name in given:
        require(name in names, "no such parameter", field="states", value=name, allowed=", ".join(names))


def _no_priors_without_deviations(problem: Problem) -> None:
    informed = [p.name for p in problem.parameters if p.median is not None]
    if isinstance(problem.prior, ScatteredPrior):
        informed += [group.name for group in problem.prior.legs]
    if problem.relative and informed:
        raise InputError(
            "a prior needs data with standard deviations",
            field="update.priors",
            value=informed,
            remedy="give every target its standard deviation, or leave out the priors",
        )
