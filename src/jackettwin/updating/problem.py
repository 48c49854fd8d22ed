"""The problem of an update: a support model, its data in one or several operating states, and a prior."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.response import NumberedModes, Relaxation
from jackettwin.soil import Parameter
from jackettwin.updating.data.relaxations import RelaxationTarget
from jackettwin.updating.data.shapes import ShapeTarget
from jackettwin.updating.data.targets import Residuals
from jackettwin.updating.model import SupportModel
from jackettwin.updating.model_error.error_model import DrawnErrors, ErrorModel
from jackettwin.updating.model_error.marginal import (
    drawn,
    drawn_scales,
    errors_given,
    inverse_root,
    log_density,
    squares,
)
from jackettwin.updating.prior import Prior

NEVER = -1e30
"""Log-likelihood where a target mode does not exist."""
DOUBLE = 1e-6
"""Relative distance of two poles below which they are one double pole, with any shapes in their plane."""
_LOST = 10.0
"""Residual of a mode that is lost, larger than that of any mode that is found."""

Found = tuple[NumberedModes, ...]
"""Modes at many parameter vectors, one entry per state, from which neighbouring points start."""


@dataclass(frozen=True)
class State:
    """Data measured in one operating state.

    The model's parameters in this state are ``exp(weights @ z + shifts)``: common to all states or separate,
    multiplied by a known factor, or growing with time.

    Attributes
    ----------
    weights : (n_model, d) derivatives of the model's ln θ by z
    shifts : (n_model,) logarithms of known factors, e.g. of a rotor's dashpot that increases with the wind
    errors : (n_residuals, d) derivatives of the logarithms of the model's values by z, for model errors that
        are common to all states
    shapes : tuple of ShapeTarget
        Shapes of modes that the residuals include.
    relaxations : tuple of RelaxationTarget
    """

    name: str
    residuals: Residuals
    weights: FloatArray
    shifts: FloatArray
    errors: FloatArray
    shapes: tuple[ShapeTarget, ...] = ()
    relaxations: tuple[RelaxationTarget, ...] = ()

    @property
    def names(self) -> list[str]:
        """Names of the residuals: frequencies and damping ratios, then shapes, then relaxations."""
        shapes = (shape.name for shape in self.shapes)
        return [*self.residuals.names, *shapes, *(relaxation.name for relaxation in self.relaxations)]

    @property
    def log_normalisation(self) -> float:
        """−log of the density of zero residuals."""
        shapes = sum(shape.log_normalisation for shape in self.shapes)
        relaxations = sum(relaxation.log_normalisation for relaxation in self.relaxations)
        return self.residuals.log_normalisation + shapes + relaxations

    @property
    def weighted(self) -> bool:
        """Whether every value has a standard deviation."""
        return self.residuals.weighted and all(r.log_std is not None for r in self.relaxations)

    def values(self, z: FloatArray, modes: NumberedModes, relaxed: tuple[Relaxation, ...]) -> FloatArray:
        """Return the residuals (n, n_data) of points z (n, d) whose modes are known."""
        columns = [shape.values(self._of_mode(shape, modes, modes.shapes)) for shape in self.shapes]
        columns += [r.values(found.rate) for r, found in zip(self.relaxations, relaxed, strict=True)]
        poles = self.residuals.values(modes.poles, shift=z @ self.errors.T)
        return np.concatenate([poles, *(column[:, None] for column in columns)], axis=1)

    def _of_mode(self, shape: ShapeTarget, modes: NumberedModes, of: ComplexArray) -> ComplexArray:
        """Return what belongs to a shape's mode (n, …) of all modes' (n, n_modes, …): shapes or their slopes.

        The solver returns any two shapes of the plane of an exactly double mode; the one most like the
        measured counts. To first order its weights do not matter, as they fit best.
        """
        i, poles = self.residuals.modes.index(shape.mode), modes.poles
        own = of[:, i]
        double = np.abs(poles - poles[:, [i]]) < DOUBLE * np.abs(poles[:, [i]])
        for j in np.flatnonzero(double.any(axis=0)):
            if j != i:
                at = np.flatnonzero(double[:, j])
                pair = np.ix_(at, np.array([i, j]))
                own = own.copy()
                own[at] = np.einsum("kp,kp...->k...", shape.nearest(modes.shapes[pair]), of[pair])
        return own

    def jacobian(self, modes: NumberedModes, relaxed: tuple[Relaxation, ...]) -> FloatArray:
        """Return the derivatives (n_data, d) of the residuals at the first of the points."""
        own = [self.residuals.jacobian(modes.poles[0], modes.slopes[0])]
        for shape in self.shapes:
            x, slopes = (self._of_mode(shape, modes, of)[0] for of in (modes.shapes, modes.shape_slopes))
            own.append(shape.jacobian(x, slopes)[None])
        own += [r.jacobian(found)[None] for r, found in zip(self.relaxations, relaxed, strict=True)]
        rows = np.concatenate(own) @ self.weights
        rows[: self.residuals.count] += self.residuals.shift_jacobian(self.errors)
        return rows


@dataclass(frozen=True)
class Problem:
    """A support model with its data and prior.

    Attributes
    ----------
    parameters : tuple of Parameter
        Parameters of the model, with one copy per state of those that depend on the state.
    prior : Prior
        Prior of their logarithms z.
    error_model : ErrorModel, optional
        Errors of the model, marginalised at every point; None for a model without errors.
    """

    model: SupportModel
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    prior: Prior
    error_model: ErrorModel | None = None

    @property
    def relative(self) -> bool:
        """Whether the cost is that of the thesis, without likelihood and prior."""
        return any(state.residuals.relative for state in self.states)

    @property
    def weighted(self) -> bool:
        """Whether every value has a standard deviation, so that there is a likelihood."""
        return not self.relative and all(state.weighted for state in self.states)

    @property
    def negligible(self) -> float:
        """Negligible difference of the cost: one in χ², or 1e-4 of each relative residual."""
        return self._total_weight * 1e-8 if self.relative else 1.0

    @property
    def hopeless(self) -> float:
        """Cost above the best at which a minimum explains nothing: 50 in χ², or 10 % relative residuals."""
        return self._total_weight * 1e-2 if self.relative else 50.0

    def poor(self, best: float) -> float:
        """Return the cost above which a minimum fits far worse than the best one.

        It is 50 more in χ²; for relative residuals 1 % each, or ten times the best cost if that is more, but
        not more than 10 % each above the best.
        """
        return best + (
            min(self.hopeless, max(9.0 * best, 1e-2 * self.hopeless)) if self.relative else self.hopeless
        )

    @property
    def _total_weight(self) -> float:
        """Sum of the weights of the data, or their number without weights."""
        poles = sum(state.residuals.total_weight - state.residuals.count for state in self.states)
        return self.n_data + poles

    def allowance(self, cost: float) -> float:
        """Return the increase of the cost that counts as equal: solutions separated by less are one."""
        return max(self.negligible, 1e-3 * cost)

    @property
    def n_data(self) -> int:
        """Number of residuals of the data, which come before those of the priors."""
        return sum(len(state.names) for state in self.states)

    @property
    def data_names(self) -> list[str]:
        """Names of the residuals of the data, ``f1``, ``ζ4``, with the state's name if there are several."""
        several = len(self.states) > 1
        return [
            f"{name} ({state.name})" if several else name for state in self.states for name in state.names
        ]

    def vectors(self, z: FloatArray, state: State) -> FloatArray:
        """Return the model's parameter vectors (n, n_model) of points z = ln θ (n, d) in one state."""
        return np.asarray(np.exp(z @ state.weights.T + state.shifts))

    def evaluate(self, z: FloatArray, near: Found | None) -> tuple[FloatArray, FloatArray, Found | None]:
        """Return residuals, their Jacobian by z and the modes at one point (d,); None if a mode is lost.

        Residuals of non-uniform priors follow those of the data.
        """
        values, rows = [], []
        found, lost = self._modes(z[None], near, slopes=True), False
        for state, modes in zip(self.states, found, strict=True):
            jacobian = np.zeros((len(state.names), z.size))
            value = np.full(len(state.names), _LOST)
            relaxed = self.relaxed(z[None], state, slopes=True)
            if _complete(modes, relaxed)[0]:
                value = state.values(z[None], modes, relaxed)[0]
                jacobian = state.jacobian(modes, relaxed)
            else:
                lost = True
            values.append(value)
            rows.append(jacobian)
        if self.error_model is not None and not lost:
            # the derivative of the errors' weights by z is neglected; it vanishes for zero residuals
            root = self.whitening(found)
            values, rows = [root @ np.concatenate(values)], [root @ np.concatenate(rows)]
        if not self.relative:
            value, jacobian = self.prior.rows(z)
            values.append(value)
            rows.append(jacobian)
        return np.concatenate(values), np.concatenate(rows), None if lost else found

    def gains(self, found: Found) -> FloatArray:
        """Return the derivatives Γ (n, n_data, n_errors) of the residuals by the errors of the model.

        The standard deviations of shapes and relaxations include the model's error.

        Parameters
        ----------
        found : modes at n points, where none is lost
        """
        if self.error_model is None:
            return np.zeros((len(found[0].poles), self.n_data, 0))
        parts = []
        for state, modes in zip(self.states, found, strict=True):
            own = self.error_model.gains(state.residuals, modes, self.error_data)
            beside = len(state.names) - state.residuals.count
            parts.append(np.concatenate([own, np.zeros((len(own), beside, own.shape[2]))], axis=1))
        return np.concatenate(parts, axis=1)

    def whitening(self, found: Found) -> FloatArray:
        """Return the whitening matrix of the residuals at given modes, (n_data, n_data).

        It is the identity without an error model.
        """
        return np.eye(self.n_data) if self.error_model is None else inverse_root(self.gains(found)[0])

    def on(self, model: SupportModel) -> Problem:
        """Return the problem on another model of the same structure, e.g. one that reaches higher modes."""
        states = tuple(replace(s, shapes=tuple(shape.on(model) for shape in s.shapes)) for s in self.states)
        errors = self.error_model and self.error_model.on(model.condensed)
        return replace(self, model=model, states=states, error_model=errors)

    @property
    def plain(self) -> Problem:
        """The problem of a model without errors."""
        return replace(self, error_model=None)

    @property
    def error_data(self) -> tuple[str, ...]:
        """Names of the data with a remainder of the model's error, each once."""
        return tuple(dict.fromkeys(name for state in self.states for name in state.residuals.names))

    def drawn_errors(self, z: FloatArray, rng: np.random.Generator) -> DrawnErrors:
        """Return draws of the model's errors given the data at points (n, d): tolerances and ``error_data``.

        Raises
        ------
        ValueError
            If the model has no errors.
        """
        if self.error_model is None:
            raise ValueError("the problem has no error model")
        r, gains, known = self._residuals_and_gains(z)
        errors, scale = np.full((len(z), gains.shape[2]), np.nan), np.ones(len(z))
        scale[known] = own = drawn_scales(r, gains, self.error_model.scales, rng)
        mean, variance = errors_given(r, own[:, None, None] * gains)
        errors[known] = own[:, None] * drawn(mean, variance, rng)
        return DrawnErrors(errors, scale)

    def expected_errors(self, z: FloatArray) -> DrawnErrors:
        """Return the expected errors of the model, of the stated sizes, given the data at points (n, d)."""
        r, gains, known = self._residuals_and_gains(z)
        errors = np.full((len(z), gains.shape[2]), np.nan)
        errors[known] = errors_given(r, gains)[0]
        return DrawnErrors(errors, np.zeros(len(z)))

    def _residuals_and_gains(self, z: FloatArray) -> tuple[FloatArray, FloatArray, BoolArray]:
        """Return the residuals and Γ of the points (n, d) without lost modes, and which these are."""
        found = self._modes(z, self.anchor(z[0]), slopes=False)
        r, known = self._all_residuals(z, found)
        return r, self.gains(tuple(modes.some(known) for modes in found)), known

    def anchor(self, z: FloatArray) -> Found | None:
        """Return the modes at one point (d,), from which others can start; None if a mode is lost."""
        found = self._modes(z[None], None, slopes=False)
        return None if any(np.isnan(modes.poles).any() for modes in found) else found

    def log_likelihood(self, z: FloatArray, near: Found | None) -> tuple[FloatArray, Found]:
        """Return ln L (n,) at points (n, d) and the modes there; ``NEVER`` where a mode does not exist."""
        log_l, found = np.full(len(z), NEVER), self._modes(z, near, slopes=False)
        r, known = self._all_residuals(z, found)
        if self.error_model is None:
            log_l[known] = -0.5 * (r * r).sum(axis=1)
        elif known.any():
            gains = self.gains(tuple(modes.some(known) for modes in found))
            log_l[known] = log_density(r, gains, self.error_model.scales)
        log_l[known] -= sum(state.log_normalisation for state in self.states)
        return log_l, found

    def costs(self, z: FloatArray, near: Found | None) -> FloatArray:
        """Return the cost (n,) of points (n, d), the sum of squared residuals; NaN if a mode does not exist.

        The residuals are those of ``evaluate``, including non-uniform priors.
        """
        cost, found = np.full(len(z), np.nan), self._modes(z, near, slopes=False)
        r, known = self._all_residuals(z, found)
        if known.any():
            cost[known] = squares(r, self.gains(tuple(modes.some(known) for modes in found)))
        if not self.relative:
            cost += [row @ row for row, _ in map(self.prior.rows, z)]
        return cost

    def _all_residuals(self, z: FloatArray, found: Found) -> tuple[FloatArray, BoolArray]:
        """Return the residuals (n_known, n_data) of the points without lost modes, and which these are."""
        relaxed = [self.relaxed(z, state) for state in self.states]
        known = np.ones(len(z), dtype=np.bool_)
        for modes, rates in zip(found, relaxed, strict=True):
            known &= _complete(modes, rates)
        columns = [
            state.values(z[known], modes.some(known), tuple(rate.some(known) for rate in rates))
            for state, modes, rates in zip(self.states, found, relaxed, strict=True)
        ]
        return np.concatenate(columns, axis=1), known

    def _modes(self, z: FloatArray, near: Found | None, *, slopes: bool) -> Found:
        """Return the modes of every state at points (n, d).

        Without a neighbour the other states start from the modes of the first, since only the rotor differs.
        """
        found: list[NumberedModes] = []
        for i, state in enumerate(self.states):
            modes = state.residuals.modes
            start = None if near is None else near[i]
            if start is None and found and set(modes) <= set(self.states[0].residuals.modes):
                start = found[0]
            vectors = self.vectors(z, state)
            found.append(
                self.model.predict_many(
                    vectors, modes, near=start, slopes=slopes, shape_slopes=slopes and bool(state.shapes)
                )
            )
        return tuple(found)

    def relaxed(self, z: FloatArray, state: State, *, slopes: bool = False) -> tuple[Relaxation, ...]:
        """Return the model's relaxations of one state at points (n, d)."""
        if not state.relaxations:
            return ()
        vectors = self.vectors(z, state)
        return tuple(r.nearest(self.model, vectors, slopes=slopes) for r in state.relaxations)


def _complete(modes: NumberedModes, relaxed: tuple[Relaxation, ...]) -> BoolArray:
    """Return at which points (n,) the model has all modes and relaxations."""
    complete = ~np.isnan(modes.poles).any(axis=1)
    for found in relaxed:
        complete &= ~np.isnan(found.rate)
    return np.asarray(complete)
