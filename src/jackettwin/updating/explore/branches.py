"""Branches of a root locus: poles tracked as a parameter varies, each with its mode number.

Where two modes come close and exchange their shapes, or cross, sorting by frequency or by similarity to a
fixed shape would jump from one branch to the other. Each step is therefore predicted with the slope of the
branch, checked against the slopes at both ends and against a crossing of two branches within the step, and
halved until both checks pass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.response import NumberedModes

At = Callable[[float, NumberedModes | None], NumberedModes]
"""Modes of one set at a value of the parameter's logarithm, from those at a neighbouring one."""

_STEPS = 128
"""Number of steps from bound to bound if none is halved."""
_SHORTEST = 2.0**-9
"""Smallest step as a share of the first; if a branch cannot be continued with it, the branch ends."""
_ASTRAY = 0.1
"""Largest error of predicting a step's end by the slopes at both ends, as a share of the step."""
_MEETING = 0.25
"""Smallest distance of two branches within one step, as a share of their distance at its ends."""
_STILL = 1e-6
"""Relative change of a pole below which it counts as unchanged."""


@dataclass(frozen=True)
class Branches:
    """Poles at values of a parameter, one column per branch.

    Attributes
    ----------
    z : (n,) ascending logarithms of the parameter
    poles : (n, n_branches), NaN after the end of a branch, where its mode stops oscillating; a pair that
        leaves the real axis later belongs to another branch
    origin : index of the value at which the branches have the modes' numbers
    """

    z: FloatArray
    poles: ComplexArray
    origin: int


def branches(at: At, start: float, low: float, high: float) -> Branches:
    """Return the branches through the modes at ``start``, tracked down to ``low`` and up to ``high``.

    Parameters
    ----------
    at : function that returns the modes of one set with their slopes by z in the first column
    """
    first = at(start, None)
    width = high - low
    down, up = (_way(at, first, start, end, width / _STEPS) for end in (low, high))
    z = np.array([*(value for value, _ in reversed(down)), start, *(value for value, _ in up)])
    poles = np.stack([*(found for _, found in reversed(down)), first.poles[0], *(found for _, found in up)])
    return Branches(z, poles, len(down))


def _way(
    at: At, first: NumberedModes, start: float, end: float, longest: float
) -> list[tuple[float, ComplexArray]]:
    """Return the values after ``start`` and the branches' poles there."""
    here, z, order = first, start, np.arange(first.poles.shape[1])
    alive = np.isfinite(first.poles[0])
    way: list[tuple[float, ComplexArray]] = []
    sign, step = (1.0 if end > start else -1.0), longest
    while z != end:
        step = min(step, abs(end - z))
        value = end if step >= abs(end - z) else z + sign * step
        there = at(value, here)
        onto = order.copy()
        onto[alive] = _successors(here, order[alive], there, value - z)
        if _astray(here, order[alive], there, onto[alive], value - z) and step > _SHORTEST * longest:
            step *= 0.5
            continue
        here, z, order = there, value, onto
        alive &= np.isfinite(here.poles[0, order])
        way.append((z, np.where(alive, here.poles[0, order], np.nan)))
        step = min(2.0 * step, longest)
    return way


def _successors(here: NumberedModes, order: IntArray, there: NumberedModes, h: float) -> IntArray:
    """Return the pole that continues each branch: near the prediction by its slope, and of similar shape."""
    promised = (here.poles + h * here.slopes[:, :, 0])[0, order]
    poles, onto = there.poles[0], np.array(order)
    known = np.flatnonzero(np.isfinite(promised) & np.isfinite(poles[order]))
    if known.size < 2:
        return onto
    columns = order[known]
    apart = np.abs(promised[known][:, None] - poles[columns][None])
    spread = np.abs(poles[columns][:, None] - poles[columns][None])
    nearest = np.where(spread > _STILL * np.abs(poles[columns]), spread, np.inf).min()
    shapes, others = here.shapes[0, columns], there.shapes[0, columns]
    mac = np.abs(shapes.conj() @ others.T) ** 2 / np.outer(_squares(shapes), _squares(others))
    cost = np.minimum(apart / nearest, 1.0) + 1.0 - mac
    _, chosen = linear_sum_assignment(cost)
    onto[known] = columns[chosen]
    return onto


def _squares(shapes: ComplexArray) -> FloatArray:
    return np.asarray((np.abs(shapes) ** 2).sum(axis=1))


def _astray(here: NumberedModes, order: IntArray, there: NumberedModes, onto: IntArray, h: float) -> bool:
    """Return whether a branch was lost, met another, or deviates from the slopes at both ends."""
    before, after = here.poles[0, order], there.poles[0, onto]
    if (np.isfinite(before) & ~np.isfinite(after)).any():
        return True
    moved = after - before
    promised = 0.5 * h * (here.slopes[0, order, 0] + there.slopes[0, onto, 0])
    allowed = _ASTRAY * np.abs(moved) + _STILL * np.abs(before)
    return bool((np.abs(moved - promised) > allowed).any()) or _meet(before, after)


def _meet(before: ComplexArray, after: ComplexArray) -> bool:
    """Return whether two distinct poles come close on straight lines between two steps."""
    i, j = np.triu_indices(before.size, 1)
    start, end = before[i] - before[j], after[i] - after[j]
    farthest = np.maximum(np.abs(start), np.abs(end))
    apart = farthest > _STILL * np.abs(before[i])
    start, way, farthest = start[apart], (end - start)[apart], farthest[apart]
    length = np.maximum(np.abs(way) ** 2, np.finfo(float).tiny)
    nearest = np.clip(-(way.conj() * start).real / length, 0.0, 1.0)
    return bool((np.abs(start + nearest * way) < _MEETING * farthest).any())
