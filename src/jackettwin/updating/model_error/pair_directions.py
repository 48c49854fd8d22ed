r"""Direction of the lower mode of a bending pair, measured and in the model.

Two close modes are the axes of a symmetric 2 × 2 matrix of frequencies. In the model's axes its entry off the
diagonal is

.. math:: e = \tfrac12 \frac{f_2 - f_1}{f} \sin 2(α - α_0),

which is linear in a disturbance of the structure however close the two frequencies are, unlike the angle α:
to first order :math:`e = g\,\mathrm{Re}(κ/λ)`, with κ of :meth:`ToleranceDirections.coupling` and g the
rotation of the lower mode per unit of the upper one added. A foot of lower stiffness rotates a pair; a change
that is equal in all directions does not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response import NumberedModes, principal_direction
from jackettwin.updating.model_error.directions import ToleranceDirections
from jackettwin.updating.model_error.measured_axes import PairDirection
from jackettwin.updating.problem import Problem

CLOSE = 0.03
"""Relative difference of frequencies above which modes are no pair, since other modes then rotate them as
well, unless the model is symmetric. Second pairs of jackets differ by 5 to 20 %, first ones by 0.5 to 2 %."""
_STEP = 0.01
"""Step of ln θ for the derivative of e, which is zero for a symmetric jacket."""


@dataclass(frozen=True, eq=False)
class DirectionRow:
    """A pair's direction as a residual: error of e in the model over its standard deviation.

    Attributes
    ----------
    residual : float
    slopes : (n_parameters,) derivatives by ln θ
    scale : float
        Angle [rad] per unit of residual.
    """

    residual: float
    slopes: FloatArray
    scale: float


def direction_row(problem: Problem, z: FloatArray, pair: PairDirection) -> DirectionRow | None:
    """Return the residual of a pair's direction at a point (d,) of ln θ.

    None if a mode is lost, or if the modes are no pair in measurement or model.
    """
    std = _std(problem, pair)
    at = np.concatenate([z[None], z + _STEP * np.eye(z.size)])
    found = problem.model.predict_many(problem.vectors(at, problem.states[0]), pair.modes, slopes=False)
    if np.isnan(found.poles).any():
        return None
    angle = np.array([_lower(problem, pair, x, y)[0] for x, y in zip(*_ordered(found), strict=True)])
    size = np.sort(np.abs(found.poles), axis=1)
    apart = (size[:, 1] - size[:, 0]) / size.mean(axis=1)
    if max(pair.apart, apart[0]) > CLOSE and not pair.chosen_by_disturbance(float(apart[0])):
        return None
    measured = 0.5 * pair.apart * np.sin(2.0 * (pair.angle_rad - angle[0]))
    turned = 0.5 * apart * np.sin(2.0 * (angle - angle[0]))
    return DirectionRow(float(-measured / std), turned[1:] / _STEP / std, std / pair.apart)


def direction_gains(
    problem: Problem, z: FloatArray, pair: PairDirection, directions: ToleranceDirections
) -> FloatArray:
    """Return the derivatives (n,) of the residual of :func:`direction_row` by errors of the structure."""
    vectors = problem.vectors(z[None], problem.states[0])
    found = problem.model.predict_many(vectors, pair.modes, slopes=False)
    poles, shapes = _ordered(found)
    ordered = replace(found, poles=poles, shapes=shapes)
    turn = _lower(problem, pair, poles[0], shapes[0])[1]
    relative = (directions.coupling(ordered)[0] / poles[0].mean()).real
    return np.asarray(turn * relative / _std(problem, pair))


def _std(problem: Problem, pair: PairDirection) -> float:
    """Return the standard deviation of e from the measurement and the model's remainder.

    For a remainder that is equal for f₁ and f₂ and isotropic, the entry off the diagonal has the standard
    deviation of half their difference, 1/√2 of that of one frequency.
    """
    errors = problem.error_model
    remainder = 0.0 if errors is None else errors.own(f"f{pair.modes[0]}")
    return float(np.hypot(pair.apart * pair.std_rad, remainder / np.sqrt(2.0)))


def _ordered(found: NumberedModes) -> tuple[ComplexArray, ComplexArray]:
    """Return poles (n_sets, 2) and shapes (n_sets, 2, n) of two modes, the lower first."""
    order = np.argsort(np.abs(found.poles), axis=1)
    shapes = np.take_along_axis(found.shapes, order[..., None], axis=1)
    return np.take_along_axis(found.poles, order, axis=1), shapes


def _lower(
    problem: Problem, pair: PairDirection, poles: ComplexArray, shapes: ComplexArray
) -> tuple[float, float]:
    """Return the direction of the lower of two modes [rad], and its rotation per unit of the upper one."""
    expand = problem.model.condensed.expand
    low, high = (pair.motion @ expand(pole, x) for pole, x in zip(poles, shapes, strict=True))
    angle, _ = principal_direction(low)
    along = np.array([np.cos(angle), np.sin(angle)])
    across, amplitude = high @ np.array([-along[1], along[0]]), low @ along
    size = float(np.vdot(amplitude, amplitude).real)
    return angle, float(np.vdot(amplitude, across).real) / size
