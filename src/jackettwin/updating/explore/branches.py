"""Branches of a root locus: poles followed from value to value of a parameter, each under its own name.

Where two modes come close and exchange their shapes, or cross, sorting by frequency would jump from one
branch to the other, and so would names by likeness to a fixed shape. Here every step goes where the slope of
the branch points, is checked against the slopes at both of its ends and against a meeting of two branches on
the way, and is halved until neither is in doubt.
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
"""Steps from bound to bound where nothing happens."""
_SHORTEST = 2.0**-9
"""Of a first step: where a branch still breaks, it ends."""
_ASTRAY = 0.1
"""A step's end may differ from what the slopes at both ends promise by this share of the step."""
_MEETING = 0.25
"""Two branches may not come nearer than this share of their distance within one step."""
_STILL = 1e-6
"""A pole that moves by less than this share of itself stands still."""


@dataclass(frozen=True)
class Branches:
    """Poles at values of a parameter, a column a branch.

    Attributes
    ----------
    z : (n,) ascending logarithms of the parameter
    poles : (n, n_branches), NaN from where a branch has ended: it no longer oscillates, and whatever pair
        comes off the real axis later is another's
    origin : place among them of the value at which the branches have the modes' names
    """

    z: FloatArray
    poles: ComplexArray
    origin: int


def branches(at: At, start: float, low: float, high: float) -> Branches:
    """Return the branches through the modes at ``start``, followed down to ``low`` and up to ``high``.

    Parameters
    ----------
    at : gives the modes of one set, with their slopes by z, in the first column
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
    """Return which pole there continues each branch: near where its slope points, and like it in shape."""
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
    """Return whether a branch was lost, met another, or moved otherwise than the slopes at both ends say."""
    before, after = here.poles[0, order], there.poles[0, onto]
    if (np.isfinite(before) & ~np.isfinite(after)).any():
        return True
    moved = after - before
    promised = 0.5 * h * (here.slopes[0, order, 0] + there.slopes[0, onto, 0])
    allowed = _ASTRAY * np.abs(moved) + _STILL * np.abs(before)
    return bool((np.abs(moved - promised) > allowed).any()) or _meet(before, after)


def _meet(before: ComplexArray, after: ComplexArray) -> bool:
    """Return whether two poles that are apart come close on straight ways between two places."""
    i, j = np.triu_indices(before.size, 1)
    start, end = before[i] - before[j], after[i] - after[j]
    farthest = np.maximum(np.abs(start), np.abs(end))
    apart = farthest > _STILL * np.abs(before[i])
    start, way, farthest = start[apart], (end - start)[apart], farthest[apart]
    length = np.maximum(np.abs(way) ** 2, np.finfo(float).tiny)
    nearest = np.clip(-(way.conj() * start).real / length, 0.0, 1.0)
    return bool((np.abs(start + nearest * way) < _MEETING * farthest).any())
