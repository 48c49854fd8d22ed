"""Families of modes with close frequencies on pinned supports, tracked together between parameter sets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.response.condensation.condensed import Condensed
from jackettwin.response.condensation.newton import kernels, refined
from jackettwin.response.condensation.pole_count import REAL, SAME
from jackettwin.response.modes.tracking import near_degenerate

_KIN = 0.8
"""Smallest mass-weighted share of a mode within the subspace of its family at the neighbouring set for a warm
start to be accepted."""
_TOGETHER = 0.03
"""Poles of a family nearer than this (relative) are refined together; refined separately, two could converge
to one."""
_HALVINGS = 2
"""Number of times that the step between two sets may be halved; after that a cold start is as fast."""


@dataclass(frozen=True)
class Start:
    """Parameter sets with known modes, each the start for one other set.

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
    """The modes that are tracked: the requested ones and the other members of their families.

    Attributes
    ----------
    modes : mode numbers, ascending
    wanted : (n_wanted,) indices of the requested modes, in the order requested
    beside : (n_beside,) indices of the other members
    of : (n_modes,) family of each mode
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
        """Fill poles and shapes of the sets reached from their neighbours; return which sets these are.

        Parameters
        ----------
        rows, rayleigh : (n_sets, …) parameters of the sets
        halvings : int
            Number of times that a step may be halved if it is too long.
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
        """Fill the sets whose modes are recognised as their neighbours'; return which sets these are."""
        values, x = start.poles.copy(), start.shapes.copy()
        done = refined(model, rows, rayleigh, self.of, values, x, _TOGETHER)
        started = ~np.isnan(start.poles)
        sound = done & (values.imag > REAL * np.abs(values)) & (np.abs(values) <= model.radius)
        good = np.asarray((sound | ~started).all(axis=1) & started[:, self.wanted].all(axis=1))
        # a fixed memory layout avoids a second compilation: a neighbour's shapes may be a read-only view
        known = np.require(start.shapes, requirements=["C", "W"])
        good &= kernels().recognised(model.pencil.M, self.of, known, values, x, _KIN, SAME)
        poles[good], shapes[good] = values[good], x[good]
        return good

    def arrange(self, poles: ComplexArray, shapes: ComplexArray) -> IntArray:
        """Number the members of every family and rotate modes of multiple poles to the pinned ones, in place.

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
    """Return the midpoint: the geometric mean, or the arithmetic one where either number is zero."""
    return np.where((one > 0.0) & (other > 0.0), np.sqrt(np.abs(one * other)), 0.5 * (one + other))
