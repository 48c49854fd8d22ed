"""Families of modes that are close on pinned supports, followed together from one set to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.response.condensation.condensed import Condensed
from jackettwin.response.condensation.newton import kernels, refined
from jackettwin.response.condensation.pole_count import REAL, SAME
from jackettwin.response.modes.tracking import near_degenerate

_KIN = 0.8
"""Least share of a mode, weighted by mass, in the subspace of its family at the neighbouring set for a warm
start to be accepted."""
_TOGETHER = 0.03
"""Poles of a family nearer than this (relative) are refined together: apart, two might end in one."""
_HALVINGS = 2
"""How often a way between two sets that is too long is halved; after that a cold start is as fast."""


@dataclass(frozen=True)
class Start:
    """Sets whose modes are known, for as many others to start from.

    Attributes
    ----------
    rows, rayleigh : (n_sets, …) as in :class:`jackettwin.response.condensation.numbered_modes.Points`
    poles : (n_sets, n_modes), NaN where a mode is not known
    shapes : (n_sets, n_modes, n)
    """

    rows: FloatArray
    rayleigh: FloatArray
    poles: ComplexArray
    shapes: ComplexArray

    def some(self, which: IntArray) -> Start:
        """Return some of the sets."""
        return Start(self.rows[which], self.rayleigh[which], self.poles[which], self.shapes[which])


@dataclass(frozen=True)
class Families:
    """The modes that are followed: those asked for, and the other members of their families.

    Attributes
    ----------
    modes : mode numbers, ascending
    wanted : (n_wanted,) places of those asked for, in their order
    beside : (n_beside,) places of the others
    of : (n_modes,) the family of each
    like : (n_modes, n) φᵀM of the pinned modes; zero beyond the last
    """

    modes: tuple[int, ...]
    wanted: IntArray
    beside: IntArray
    of: IntArray
    like: FloatArray

    def continued(
        self,
        model: Condensed,
        start: Start,
        rows: FloatArray,
        rayleigh: FloatArray,
        poles: ComplexArray,
        shapes: ComplexArray,
        halvings: int = _HALVINGS,
    ) -> BoolArray:
        """Fill poles and shapes of the sets that a neighbour's lead to; return which sets these are.

        Parameters
        ----------
        rows, rayleigh : (n_sets, …) of the sets
        halvings : int
            How often a way that is too long may be halved.
        """
        good = self._step(model, start, rows, rayleigh, poles, shapes)
        far: IntArray = np.flatnonzero(~good & ~np.isnan(start.poles[:, self.wanted]).any(axis=1))
        if halvings and far.size:
            here, there = start.some(far), (rows[far], rayleigh[far])
            middle = Start(
                _between(here.rows, there[0]),
                _between(here.rayleigh, there[1]),
                np.full_like(here.poles, np.nan),
                np.full_like(here.shapes, np.nan),
            )
            reached = self.continued(
                model, here, middle.rows, middle.rayleigh, middle.poles, middle.shapes, halvings - 1
            )
            end_poles, end_shapes = np.full_like(here.poles, np.nan), np.full_like(here.shapes, np.nan)
            reached &= self.continued(model, middle, *there, end_poles, end_shapes, halvings - 1)
            good[far], poles[far[reached]] = reached, end_poles[reached]
            shapes[far[reached]] = end_shapes[reached]
        return good

    def _step(
        self,
        model: Condensed,
        start: Start,
        rows: FloatArray,
        rayleigh: FloatArray,
        poles: ComplexArray,
        shapes: ComplexArray,
    ) -> BoolArray:
        """Fill the sets in whose modes the neighbour's are recognised; return which these are."""
        values, x = start.poles.copy(), start.shapes.copy()
        done = refined(model, rows, rayleigh, self.of, values, x, _TOGETHER)
        started = ~np.isnan(start.poles)
        sound = done & (values.imag > REAL * np.abs(values)) & (np.abs(values) <= model.radius)
        good = np.asarray((sound | ~started).all(axis=1) & started[:, self.wanted].all(axis=1))
        # one layout of arrays is one compilation: a neighbour's shapes may be a view that cannot be written
        known = np.require(start.shapes, requirements=["C", "W"])
        good &= kernels().recognised(model.pencil.M, self.of, known, values, x, _KIN, SAME)
        poles[good], shapes[good] = values[good], x[good]
        return good

    def arrange(self, poles: ComplexArray, shapes: ComplexArray) -> IntArray:
        """Name the members of every family and turn the modes of multiple poles to the pinned ones, in place.

        Returns
        -------
        (n_sets, n_modes) numbers, the same for the modes of one multiple pole
        """
        number: IntArray = kernels().arrange(self.like, self.of, poles, shapes, SAME)
        n_sets, n_modes = number.shape
        if (number != np.arange(n_modes)).any():
            kernels().turn(self.like, number, poles, shapes)
        return np.asarray(number + n_modes * np.arange(n_sets)[:, None])


def families_of(model: Condensed, modes: tuple[int, ...]) -> Families:
    """Return the families of mode numbers, counted from 1 on pinned supports."""
    known: dict[tuple[int, ...], Families] = model.cache
    if modes not in known:
        known[modes] = _families(model, modes)
    return known[modes]


def _families(model: Condensed, modes: tuple[int, ...]) -> Families:
    omega, phi = model.pinned.omega, model.pinned.shapes
    asked, followed, of = set(modes), [], []
    groups = [[int(i) + 1 for i in group] for group in near_degenerate(omega)]
    groups += [[mode] for mode in sorted(asked) if mode > omega.size]
    for number, group in enumerate(groups):
        if asked & set(group):
            followed += group
            of += [number] * len(group)
    like = np.zeros((len(followed), model.n))
    known = [i for i, mode in enumerate(followed) if mode <= omega.size]
    like[known] = phi[:, [followed[i] - 1 for i in known]].T @ model.pencil.M
    place = {mode: i for i, mode in enumerate(followed)}
    return Families(
        modes=tuple(followed),
        wanted=np.array([place[mode] for mode in modes], dtype=np.intp),
        beside=np.array([i for i, mode in enumerate(followed) if mode not in asked], dtype=np.intp),
        of=np.array(of, dtype=np.intp),
        like=like,
    )


def _between(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the numbers half-way: the geometric mean, or the arithmetic one where either is zero."""
    return np.where((one > 0.0) & (other > 0.0), np.sqrt(np.abs(one * other)), 0.5 * (one + other))
