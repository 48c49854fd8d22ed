"""Poles of numbered modes and their gradients for many parameter sets at once.

Updating, sampling, root loci and cost surfaces all use this function. A cold start finds every mode and
certifies that the list is complete (:mod:`jackettwin.response.condensation.pole_count`). A warm start refines
the modes of a neighbouring set and recognises them by shape; sets in which this fails are started cold.

Modes of close frequency on pinned supports form a family, such as the bending pair of a symmetric structure.
A family is tracked as a whole and recognised by the subspace of its shapes; its members are assigned to the
pinned modes they resemble most. Modes of one multiple pole, of which any linear combination is a mode, are
rotated until each resembles one pinned mode only; the pinned ones are aligned with the global axes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.response.condensation.close_modes import Start, families_of
from jackettwin.response.condensation.condensed import Condensed, check_rayleigh
from jackettwin.response.condensation.newton import kernels
from jackettwin.response.condensation.pole_count import AllModes, all_modes
from jackettwin.response.modes.tracking import track_modes
from jackettwin.soil import static_rows
from jackettwin.structure import Rayleigh

_BYSTANDERS = 2
"""Number of modes beyond the last requested one that also take part in the assignment by shape."""


class Status(IntEnum):
    """Reliability of a set of poles."""

    CERTIFIED = 0
    """The independent count agrees: no mode missed, duplicated or spurious."""
    NEIGHBOUR = 1
    """Continued from a neighbouring set and recognised by shape."""
    UNCERTIFIED = 2
    """Poles were found, here or in the set these were continued from, but the count does not confirm all."""


@dataclass(frozen=True)
class Points:
    """Parameter sets: the numbers that F depends on, and their derivatives by the parameters z.

    Attributes
    ----------
    rows : (n_sets, n_groups, width) law rows of :mod:`jackettwin.soil.laws.coefficients`
    rayleigh : (n_sets, 2) Rayleigh coefficients a, b
    jacobian : (n_sets, n_groups, width, n_z) d rows/dz
    rayleigh_jacobian : (n_sets, 2, n_z) d(a, b)/dz
    """

    rows: FloatArray
    rayleigh: FloatArray
    jacobian: FloatArray
    rayleigh_jacobian: FloatArray

    @classmethod
    def fixed(cls, rows: FloatArray, rayleigh: Rayleigh) -> Points:
        """Return sets of laws without gradients, all with the same steel damping."""
        n_sets, n_groups, width = rows.shape
        ab = np.tile([rayleigh.alpha, rayleigh.beta], (n_sets, 1))
        return cls(rows, ab, np.zeros((n_sets, n_groups, width, 0)), np.zeros((n_sets, 2, 0)))

    def plain(self) -> Points:
        """Return the same sets without gradients."""
        return Points(self.rows, self.rayleigh, self.jacobian[..., :0], self.rayleigh_jacobian[..., :0])

    def undamped(self) -> Points:
        """Return the same structures without any damping: the static stiffness of every law."""
        rows = static_rows(self.rows)
        return Points(
            rows, np.zeros_like(self.rayleigh), np.zeros((*rows.shape, 0)), np.zeros((len(rows), 2, 0))
        )


@dataclass(frozen=True)
class NumberedModes:
    """Modes numbered on pinned supports, NaN where a mode has no oscillating successor in the band.

    Attributes
    ----------
    modes : requested mode numbers
    poles : (n_sets, n_modes) λ [rad/s]
    shapes : (n_sets, n_modes, n) condensed coordinates, unit norm
    slopes : (n_sets, n_modes, n_z) dλ/dz
    shape_slopes : (n_sets, n_modes, n_z, n) dx/dz without a component along x, nor along other modes of the
        same pole; empty unless requested
    status : (n_sets,) of :class:`Status`
    beside : mode numbers of the other members of their families
    beside_poles : (n_sets, n_beside) poles of these members
    beside_shapes : (n_sets, n_beside, n) their shapes
    rows, rayleigh : parameters of the sets, as in :class:`Points`
    """

    modes: tuple[int, ...]
    poles: ComplexArray
    shapes: ComplexArray
    slopes: ComplexArray
    shape_slopes: ComplexArray
    status: IntArray
    beside: tuple[int, ...]
    beside_poles: ComplexArray
    beside_shapes: ComplexArray
    rows: FloatArray
    rayleigh: FloatArray

    def some(self, which: npt.NDArray[Any]) -> NumberedModes:
        """Return some of the sets, or the same ones in another order."""
        return replace(self, **{name: getattr(self, name)[which] for name in self._filled()})

    def joined(self, other: NumberedModes) -> NumberedModes:
        """Return these sets and then those of another result for the same modes."""
        both = {name: (getattr(self, name), getattr(other, name)) for name in self._filled()}
        joined: dict[str, Any] = {name: np.concatenate(pair) for name, pair in both.items()}
        return replace(self, **joined)

    def start(self, modes: tuple[int, ...], n_sets: int) -> Start:
        """Return the start for a continuation of modes by number; a mode that is not available is NaN."""
        poles = np.concatenate([self.poles, self.beside_poles], axis=1)
        shapes = np.concatenate([self.shapes, self.beside_shapes], axis=1)
        place = {mode: i for i, mode in enumerate((*self.modes, *self.beside))}
        which = np.array([place.get(mode, -1) for mode in modes])
        poles, shapes = poles[:, which], shapes[:, which]
        poles[:, which < 0], shapes[:, which < 0] = np.nan, np.nan
        parts = (self.rows, self.rayleigh, poles, shapes)
        return Start(*(np.ascontiguousarray(np.broadcast_to(p, (n_sets, *p.shape[1:]))) for p in parts))

    def _filled(self) -> list[str]:
        """Return the names of the arrays that have an entry for each set."""
        names = ["poles", "shapes", "slopes", "status", "beside_poles", "beside_shapes", "rows", "rayleigh"]
        return [*names, "shape_slopes"] if len(self.shape_slopes) == len(self.poles) else names


def numbered_poles(
    model: Condensed,
    points: Points,
    modes: tuple[int, ...],
    *,
    near: NumberedModes | None = None,
    shape_slopes: bool = False,
) -> NumberedModes:
    r"""Return the poles of numbered modes and their gradients for every parameter set.

    .. math:: dλ/dz = -\frac{x^T (∂F/∂z) x}{x^T F'(λ) x}

    (Adhikari 2001; F is symmetric). Derivatives of shapes follow from the same system bordered by F′x, those
    of a multiple pole from the border of all its modes.

    Parameters
    ----------
    modes : mode numbers, counted from 1 on pinned supports
    near : NumberedModes, optional
        Result for these modes from which to start, for one set or as many as there are points.
    shape_slopes : bool
        Whether dx/dz is returned too.
    """
    check_rayleigh(points.rayleigh, model.radius)
    families = families_of(model, modes)
    followed = families.modes
    n_sets, n_followed = len(points.rows), len(followed)
    poles = np.full((n_sets, n_followed), np.nan, dtype=np.complex128)
    shapes = np.full((n_sets, n_followed, model.n), np.nan, dtype=np.complex128)
    status = np.full(n_sets, int(Status.UNCERTIFIED), dtype=np.intp)
    cold = np.ones(n_sets, dtype=np.bool_)
    if near is not None:
        start = near.start(followed, n_sets)
        cold = ~families.continued(model, start, points.rows, points.rayleigh, poles, shapes)
        doubtful = np.broadcast_to(near.status == Status.UNCERTIFIED, n_sets)
        status[~cold] = np.where(doubtful, Status.UNCERTIFIED, Status.NEIGHBOUR)[~cold]
    for k in np.flatnonzero(cold):
        found = all_modes(model, points.rows[k], points.rayleigh[k])
        successor = _successors(model, found, followed)
        known = successor >= 0
        poles[k] = np.where(known, found.poles[successor] if found.poles.size else np.nan, np.nan)
        if known.any():
            shapes[k, known] = found.shapes[successor[known]]
        status[k] = Status.CERTIFIED if found.certified else Status.UNCERTIFIED
    multiple = families.arrange(poles, shapes)
    slopes, dx = _slopes(model, points, poles, shapes, multiple, shape_slopes)
    own, beside = families.wanted, families.beside
    return NumberedModes(
        modes,
        poles[:, own],
        shapes[:, own],
        slopes[:, own],
        dx[:, own] if shape_slopes else dx,
        status,
        tuple(followed[i] for i in beside),
        poles[:, beside],
        shapes[:, beside],
        points.rows,
        points.rayleigh,
    )


def _successors(model: Condensed, found: AllModes, modes: tuple[int, ...]) -> IntArray:
    """Return for each mode number the index of its successor among the modes found, or −1."""
    number = max(modes) + _BYSTANDERS
    successor = np.full(number, -1, dtype=np.intp)
    omega, phi = model.pinned.omega[:number], model.pinned.shapes[:, :number]
    successor[: omega.size] = track_modes(model.pencil.M, omega, phi, found.shapes.T)
    return np.asarray(successor[np.array(modes) - 1])


def _slopes(
    model: Condensed,
    points: Points,
    poles: ComplexArray,
    shapes: ComplexArray,
    multiple: IntArray,
    shape_slopes: bool,
) -> tuple[ComplexArray, ComplexArray]:
    n_sets, n_modes = poles.shape
    n_z = points.jacobian.shape[3]
    slopes = np.full((n_sets * n_modes, n_z), np.nan, dtype=np.complex128)
    dx = np.full((n_sets * n_modes, n_z, model.n) if shape_slopes else (0, n_z, model.n), np.nan + 0j)
    if n_z:
        known = np.flatnonzero(~np.isnan(poles.ravel()))
        known = known[np.argsort(multiple.ravel()[known], kind="stable")]
        some = slopes[known]
        some_dx = dx[known] if shape_slopes else dx
        kernels().slopes(
            model.arrays(), points.rows, points.rayleigh, known // n_modes, multiple.ravel()[known],
            poles.ravel()[known], shapes.reshape(-1, model.n)[known],
            points.jacobian, points.rayleigh_jacobian, some, some_dx,
        )  # fmt: skip
        slopes[known] = some
        if shape_slopes:
            dx[known] = some_dx
    dx = dx.reshape(n_sets, n_modes, n_z, model.n) if shape_slopes else dx.reshape(0, n_modes, n_z, model.n)
    return slopes.reshape(n_sets, n_modes, n_z), dx
