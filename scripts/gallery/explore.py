"""What is evaluated around a solution: sensitivities, cost surface, root locus."""

from __future__ import annotations

import numpy as np

from gallery.figures_landscape import Curve, Locus
from gallery.landscape import cost_surface, sensitivity_curve
from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.updating import Problem, SupportModel, Update

_STRIDE, _REFINEMENTS = 0.06, 3
"""A root locus is refined where a pole moves by more than this share of its path; so many times."""
_LOSSY = 1
"""Position of the parameter that damps in every family: c, loss_factor, alpha."""


def sensitivities(problem: Problem, theta: FloatArray) -> list[Curve]:
    """Return the cost as each parameter moves by ±50 % (thesis figures 8.5 and 8.6)."""
    curves = []
    for j, p in enumerate(problem.parameters):
        factor, cost = sensitivity_curve(problem, theta, j)
        curves.append(Curve(problem.model.family.name, p.name, float(theta[j]), p.unit, factor, cost))
    return curves


def surface(update: Update, *, n: int = 81) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (x, y, cost) over the bounds of a law with two parameters."""
    first, second = update.problem.parameters
    x, y = np.geomspace(first.low, first.high, n), np.geomspace(second.low, second.high, n)
    return x, y, cost_surface(update.problem, update.best.theta, (0, 1), x, y)


def locus(
    model: SupportModel, theta: FloatArray, modes: tuple[int, ...], labels: tuple[str, ...], *, n: int = 41
) -> Locus:
    """Return how the poles move as the damping parameter of every support goes from bound to bound.

    Where the poles at a bound are the limits c → 0 and c → ∞ of a dashpot.
    """
    width = len(model.family.parameters)
    n_law = width * len(model.tie_groups.suffixes)
    p = model.parameters[_LOSSY]

    def poles_at(values: FloatArray) -> ComplexArray:
        moved = np.tile(theta, (values.size, 1))
        moved[:, _LOSSY:n_law:width] = values[:, None]
        return model.predict_many(moved, modes, slopes=False).poles

    values = np.geomspace(p.low, p.high, n)
    poles = poles_at(values)
    for _ in range(_REFINEMENTS):
        wide = np.flatnonzero(_strides(poles) > _STRIDE)
        if wide.size == 0:
            break
        between = np.sqrt(values[wide] * values[wide + 1])
        order = np.argsort(np.concatenate([values, between]), kind="stable")
        poles = np.concatenate([poles, poles_at(between).reshape(-1, len(modes))])[order]
        values = np.concatenate([values, between])[order]
    here = model.predict(theta, modes).poles
    name = model.family.parameters[_LOSSY].name
    return Locus(model.family.name, name, p.unit, labels, values, poles, here)


def _strides(poles: ComplexArray) -> FloatArray:
    """Return the longest step of any mode between neighbours, as a share of its path's extent."""
    extent = np.nanmax(np.abs(poles - poles[0]), axis=0)
    steps = np.abs(np.diff(poles, axis=0)) / np.where(extent > 0.0, extent, 1.0)
    return np.asarray(np.nan_to_num(steps).max(axis=1))
