"""Poles of numbered modes and their gradients for many parameter sets at once.

This is the one function behind updating, sampling, root locus and cost surfaces. A cold start finds every
mode and certifies that it has (:mod:`jackettwin.response.certified`). A warm start refines the modes of a
neighbouring set and recognises them by shape; whatever is in doubt starts cold.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from jackettwin.response.certified import REAL, SAME, STEP, AllModes, all_modes, kernels
from jackettwin.response.condensed import Condensed, check_rayleigh
from jackettwin.response.mode_tracking import track_modes
from jackettwin.soil.coefficients import static_rows
from jackettwin.structure.damping import Rayleigh

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]

_BYSTANDERS = 2
"""Modes beyond the last one wanted that may claim a shape, too."""
_KIN = 0.8
"""Mass-weighted MAC to the neighbour's mode by which a warm start is recognised."""


class Status(IntEnum):
    """How sure a set of poles is."""

    CERTIFIED = 0
    """The independent count agrees: no mode missed, duplicated or spurious."""
    NEIGHBOUR = 1
    """Continued from a neighbouring set and recognised by shape."""
    UNCERTIFIED = 2
    """Poles were found, here or where these were continued from, but the count does not confirm them all."""


@dataclass(frozen=True)
class Points:
    """Parameter sets as the numbers F depends on, and how these depend on the parameters z.

    Attributes
    ----------
    rows : (n_sets, n_groups, width) law rows of :mod:`jackettwin.soil.coefficients`
    rayleigh : (n_sets, 2) a, b
    jacobian : (n_sets, n_groups, width, n_z) d rows/dz
    rayleigh_jacobian : (n_sets, 2, n_z)
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
            rows,
            np.zeros_like(self.rayleigh),
            np.zeros((*rows.shape, 0)),
            np.zeros((len(rows), 2, 0)),
        )


@dataclass(frozen=True)
class NumberedModes:
    """Modes numbered on pinned supports, NaN where a mode has no oscillating successor in the band.

    Attributes
    ----------
    poles : (n_sets, n_modes) λ [rad/s]
    shapes : (n_sets, n_modes, n) condensed coordinates, unit norm
    slopes : (n_sets, n_modes, n_z) dλ/dz
    shape_slopes : (n_sets, n_modes, n_z, n) dx/dz without a component along x; empty unless asked for
    status : (n_sets,) of :class:`Status`
    """

    poles: ComplexArray
    shapes: ComplexArray
    slopes: ComplexArray
    shape_slopes: ComplexArray
    status: IntArray


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

    (Adhikari 2001; F is symmetric), shapes from the same system bordered by F′x.

    Parameters
    ----------
    modes : mode numbers, counted from 1 on pinned supports
    near : NumberedModes, optional
        A result for the same ``modes``, of one set or as many as there are points, to start from.
    shape_slopes : bool
        Return dx/dz too.
    """
    check_rayleigh(points.rayleigh, model.radius)
    n_sets, n_modes = len(points.rows), len(modes)
    poles = np.full((n_sets, n_modes), np.nan, dtype=np.complex128)
    shapes = np.full((n_sets, n_modes, model.n), np.nan, dtype=np.complex128)
    status = np.full(n_sets, int(Status.UNCERTIFIED), dtype=np.intp)
    cold = np.ones(n_sets, dtype=np.bool_)
    if near is not None:
        cold = ~_continue(model, points, near, poles, shapes)
        doubtful = np.broadcast_to(near.status == Status.UNCERTIFIED, n_sets)
        status[~cold] = np.where(doubtful, Status.UNCERTIFIED, Status.NEIGHBOUR)[~cold]
    for k in np.flatnonzero(cold):
        found = all_modes(model, points.rows[k], points.rayleigh[k])
        successor = _successors(model, found, modes)
        known = successor >= 0
        poles[k] = np.where(known, found.poles[successor] if found.poles.size else np.nan, np.nan)
        if known.any():
            shapes[k, known] = found.shapes[successor[known]]
        status[k] = Status.CERTIFIED if found.certified else Status.UNCERTIFIED
    slopes, dx = _slopes(model, points, poles, shapes, shape_slopes)
    return NumberedModes(poles, shapes, slopes, dx, status)


def _successors(model: Condensed, found: AllModes, modes: tuple[int, ...]) -> IntArray:
    """Return for each mode number the index of its successor among the modes found, or −1."""
    number = max(modes) + _BYSTANDERS
    successor = np.full(number, -1, dtype=np.intp)
    omega, phi = model.pinned.omega[:number], model.pinned.shapes[:, :number]
    successor[: omega.size] = track_modes(model.pencil.M, omega, phi, found.shapes.T)
    return np.asarray(successor[np.array(modes) - 1])


def _continue(
    model: Condensed, points: Points, near: NumberedModes, poles: ComplexArray, shapes: ComplexArray
) -> BoolArray:
    """Fill poles and shapes continued from a neighbour; return which sets can be trusted."""
    n_sets, n_modes = poles.shape
    starts = np.ascontiguousarray(np.broadcast_to(near.shapes, shapes.shape))
    values: ComplexArray = np.array(np.broadcast_to(near.poles, poles.shape)).reshape(-1)
    vectors = starts.reshape(-1, model.n).copy()
    which = np.repeat(np.arange(n_sets), n_modes)
    done = (
        kernels()
        .refine(model.arrays(), points.rows, points.rayleigh, which, values, vectors, STEP)
        .reshape(n_sets, n_modes)
    )
    found, x = values.reshape(n_sets, n_modes), vectors.reshape(shapes.shape)
    M = model.pencil.M
    cross = np.abs(np.einsum("kmi,kmi->km", starts.conj() @ M, x)) ** 2
    own = np.einsum("kmi,kmi->km", starts.conj() @ M, starts).real
    new = np.einsum("kmi,kmi->km", x.conj() @ M, x).real
    trusted = done & (cross >= _KIN * own * new) & (found.imag > REAL * np.abs(found))
    trusted &= np.abs(found) <= model.radius
    good: BoolArray = trusted.all(axis=1)
    for i in range(n_modes):
        for j in range(i):
            good &= np.abs(found[:, i] - found[:, j]) > SAME * np.abs(found[:, i])
    poles[good], shapes[good] = found[good], x[good]
    return good


def _slopes(
    model: Condensed, points: Points, poles: ComplexArray, shapes: ComplexArray, shape_slopes: bool
) -> tuple[ComplexArray, ComplexArray]:
    n_sets, n_modes = poles.shape
    n_z = points.jacobian.shape[3]
    slopes = np.full((n_sets * n_modes, n_z), np.nan, dtype=np.complex128)
    dx = np.full((n_sets * n_modes, n_z, model.n) if shape_slopes else (0, n_z, model.n), np.nan + 0j)
    if n_z:
        known = np.flatnonzero(~np.isnan(poles.ravel()))
        some = slopes[known]
        some_dx = dx[known] if shape_slopes else dx
        kernels().slopes(
            model.arrays(), points.rows, points.rayleigh, known // n_modes,
            poles.ravel()[known], shapes.reshape(-1, model.n)[known],
            points.jacobian, points.rayleigh_jacobian, some, some_dx,
        )  # fmt: skip
        slopes[known] = some
        if shape_slopes:
            dx[known] = some_dx
    dx = dx.reshape(n_sets, n_modes, n_z, model.n) if shape_slopes else dx.reshape(0, n_modes, n_z, model.n)
    return slopes.reshape(n_sets, n_modes, n_z), dx
