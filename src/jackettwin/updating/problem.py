"""What is solved and sampled: a support model, its data in one or several operating states, and a prior."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.response.numbered import NumberedModes, Status
from jackettwin.updating.families import Parameter
from jackettwin.updating.model import SupportModel
from jackettwin.updating.prior import BoxPrior
from jackettwin.updating.shapes import ShapeTarget
from jackettwin.updating.targets import Residuals

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]

NEVER = -1e30
"""Log-likelihood where a target mode does not exist."""
_LOST = 10.0
"""Residual of a mode that cannot be followed: worse than any that can."""

Found = tuple[NumberedModes, ...]
"""Modes at many parameter vectors, one entry a state: where neighbours start from."""


@dataclass(frozen=True)
class State:
    """Data measured in one operating state.

    Attributes
    ----------
    columns : (n_model,) which of the problem's parameters are the model's in this state
    factors : (n_model,) what they are multiplied by: a rotor's dashpot grows with the wind
    shapes : tuple of ShapeTarget
        Of modes that the residuals hold, too.
    """

    name: str
    residuals: Residuals
    columns: IntArray
    factors: FloatArray
    shapes: tuple[ShapeTarget, ...] = ()

    @property
    def names(self) -> list[str]:
        """What each residual is of: frequencies and damping ratios, then shapes."""
        return [*self.residuals.names, *(f"MAC{shape.mode}" for shape in self.shapes)]

    @property
    def log_normalisation(self) -> float:
        """−log of the density of zero residuals."""
        return self.residuals.log_normalisation + sum(shape.log_normalisation for shape in self.shapes)

    def values(self, modes: NumberedModes, known: BoolArray) -> FloatArray:
        """Return the residuals (n_known, n_data) of the parameter sets whose modes are known."""
        of = self.residuals.modes.index
        columns = [shape.values(modes.shapes[known, of(shape.mode)])[:, None] for shape in self.shapes]
        return np.concatenate([self.residuals.values(modes.poles[known]), *columns], axis=1)

    def evaluate(self, modes: NumberedModes) -> tuple[FloatArray, FloatArray]:
        """Return the residuals (n_data,) of the first parameter set and their Jacobian."""
        values, rows = self.residuals.evaluate(modes.poles[0], modes.slopes[0])
        for shape in self.shapes:
            i = self.residuals.modes.index(shape.mode)
            value, row = shape.evaluate(modes.shapes[0, i], modes.shape_slopes[0, i])
            values, rows = np.append(values, value), np.vstack([rows, row])
        return values, rows


@dataclass(frozen=True)
class Problem:
    """A support model and everything measured of it.

    Attributes
    ----------
    parameters : tuple of Parameter
        The model's, and for a state-dependent one a copy for each state.
    prior : BoxPrior
        Of their logarithms.
    """

    model: SupportModel
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    prior: BoxPrior

    @property
    def relative(self) -> bool:
        """Whether the cost is the thesis's: no likelihood, no prior."""
        return any(state.residuals.relative for state in self.states)

    @property
    def weighted(self) -> bool:
        """Whether every value has a standard deviation, so that there is a likelihood."""
        return not self.relative and all(state.residuals.weighted for state in self.states)

    @property
    def negligible(self) -> float:
        """Cost that does not matter: χ² by one, or each relative residual by 1e-4."""
        return self.n_data * 1e-8 if self.relative else 1.0

    @property
    def hopeless(self) -> float:
        """Cost above the best from which a minimum explains nothing: χ² by 50, relative residuals of 10 %."""
        return self.n_data * 1e-2 if self.relative else 50.0

    def allowance(self, cost: float) -> float:
        """Return by how much a cost may rise and still count as the same: solutions apart by less are one."""
        return max(self.negligible, 1e-3 * cost)

    @property
    def n_data(self) -> int:
        """Number of data residuals: they come before the priors'."""
        return sum(len(state.names) for state in self.states)

    @property
    def data_names(self) -> list[str]:
        """What each residual is of: ``f1``, ``ζ4``, with the state's name if there are several."""
        several = len(self.states) > 1
        return [
            f"{name} ({state.name})" if several else name for state in self.states for name in state.names
        ]

    def vectors(self, z: FloatArray, state: State) -> FloatArray:
        """Return the model's parameter vectors (n, n_model) of points z = ln θ (n, d) in one state."""
        return np.asarray(np.exp(z[:, state.columns]) * state.factors)

    def evaluate(self, z: FloatArray, near: Found | None) -> tuple[FloatArray, FloatArray, Found | None]:
        """Return residuals, their Jacobian by z and the modes at one point (d,); None if a mode is lost.

        The normal priors follow the data's residuals.
        """
        values, rows = [], []
        found = self._modes(z[None], near, slopes=True)
        for state, modes in zip(self.states, found, strict=True):
            jacobian = np.zeros((len(state.names), z.size))
            value = np.full(len(state.names), _LOST)
            if not np.isnan(modes.poles).any():
                value, jacobian[:, state.columns] = state.evaluate(modes)
            values.append(value)
            rows.append(jacobian)
        if not self.relative:
            value, jacobian = self.prior.rows(z)
            values.append(value)
            rows.append(jacobian)
        lost = any(np.isnan(modes.poles).any() for modes in found)
        return np.concatenate(values), np.concatenate(rows), None if lost else found

    def anchor(self, z: FloatArray) -> Found | None:
        """Return the modes at one point (d,), for many others to start from; None if a mode is lost there."""
        found = self._modes(z[None], None, slopes=False)
        return None if any(np.isnan(modes.poles).any() for modes in found) else found

    def costs(self, z: FloatArray, near: Found | None) -> FloatArray:
        """Return the cost (n,), (8.4) or χ² with the normal priors, at points (n, d)."""
        cost = np.zeros(len(z))
        for state, modes in zip(self.states, self._modes(z, near, slopes=False), strict=True):
            known = np.asarray(~np.isnan(modes.poles).any(axis=1))
            r = state.values(modes, known)
            cost[known] += (r * r).sum(axis=1)
            cost[~known] += len(state.names) * _LOST**2
        if not self.relative:
            cost += [float(r @ r) for r, _ in map(self.prior.rows, z)]
        return cost

    def log_likelihood(self, z: FloatArray, near: Found | None) -> tuple[FloatArray, Found]:
        """Return ln L (n,) at points (n, d) and the modes there; ``NEVER`` where a mode does not exist."""
        log_l, found = np.zeros(len(z)), self._modes(z, near, slopes=False)
        for state, modes in zip(self.states, found, strict=True):
            known = np.asarray(~np.isnan(modes.poles).any(axis=1))
            r = state.values(modes, known)
            log_l[known] += -0.5 * (r * r).sum(axis=1) - state.log_normalisation
            log_l[~known] = NEVER
        return log_l, found

    def _modes(self, z: FloatArray, near: Found | None, *, slopes: bool) -> Found:
        """Return the modes of every state at points (n, d).

        Without a neighbour the other states start from the first one's modes: only the rotor differs.
        """
        found: list[NumberedModes] = []
        for i, state in enumerate(self.states):
            modes = state.residuals.modes
            start = None if near is None else near[i]
            if start is None and found and set(modes) <= set(self.states[0].residuals.modes):
                start = _some(found[0], [self.states[0].residuals.modes.index(m) for m in modes])
            vectors = self.vectors(z, state)
            found.append(
                self.model.predict_many(
                    vectors, modes, near=start, slopes=slopes, shape_slopes=slopes and bool(state.shapes)
                )
            )
        return tuple(found)


def _some(found: NumberedModes, which: list[int]) -> NumberedModes:
    """Return some of the modes; a set that lost one of them is no start."""
    poles = found.poles[:, which]
    status = np.where(np.isnan(poles).any(axis=1), Status.UNCERTIFIED, found.status)
    return replace(
        found, poles=poles, shapes=found.shapes[:, which], slopes=found.slopes[:, which], status=status
    )


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

    Raises
    ------
    InputError
        If a name is none of the model's, or priors meet residuals without standard deviations.
    """
    names = [p.name for p in model.parameters]
    for name in (*per_state, *(name for _, factors in states.values() for name in factors)):
        if name not in names:
            raise InputError("no such parameter", field="states", value=name, allowed=", ".join(names))
    shared = [p for p in model.parameters if p.name not in per_state]
    own = [p for p in model.parameters if p.name in per_state]
    parameters = (*shared, *(replace(p, name=f"{p.name}@{state}") for state in states for p in own))
    place = {p.name: i for i, p in enumerate(parameters)}
    built = tuple(
        State(
            state,
            residuals,
            np.array([place.get(name, place.get(f"{name}@{state}", -1)) for name in names], dtype=np.intp),
            np.array([factors.get(name, 1.0) for name in names]),
            () if i else shapes,
        )
        for i, (state, (residuals, factors)) in enumerate(states.items())
    )
    problem = Problem(model, built, parameters, BoxPrior.of(parameters))
    if problem.relative and any(p.median is not None for p in parameters):
        raise InputError(
            "a prior needs data with standard deviations",
            field="update.priors",
            value=[p.name for p in parameters if p.median is not None],
            remedy="give every target its standard deviation, or leave the priors out",
        )
    return problem
