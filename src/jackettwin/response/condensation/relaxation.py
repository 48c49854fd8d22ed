r"""The real pole nearest a given rate: a relaxation exp(−at) of the supports, with its gradient.

Laws with dashpots have close relaxation rates, one for every support DOF. Near a rate a the steel hardly
depends on λ: with its F(−a) = A taken as constant, all relaxations of Prony laws are the eigenvalues of a
symmetric definite pencil in the displacements u of the supports and y_j of the branches' dashpots,

.. math::

    \begin{bmatrix} A + K_0 + \sum_j K_j & -K_j \\ -K_j & K_j \end{bmatrix} x
    = a \begin{bmatrix} C & \\ & τ_j K_j \end{bmatrix} x ,

so that all of them are found at once and none is missed. The one nearest the given rate is then refined on
the exact F(λ). A rate outside the band of the condensed structure is not refined; its value tends to the
1/τ_j of the law, which suffices for a search far from the data.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.identification import mac
from jackettwin.response.condensation.condensed import Condensed
from jackettwin.response.condensation.newton import kernels, refined
from jackettwin.response.condensation.numbered_modes import Points
from jackettwin.response.condensation.pole_count import REAL
from jackettwin.soil import BRANCHES, K0, K_ALPHA, MASS, C

_NEAR = 0.3
"""Largest change of ln a by refinement; a result farther away is another pole."""
_LEAST = 1e-13
"""Share of the longest relaxation time below which an eigenvalue is due to rounding."""


@dataclass(frozen=True)
class Relaxation:
    """One relaxation of every parameter set; NaN where the laws have none.

    Attributes
    ----------
    rate : (n_sets,) a = −λ [rad/s]
    shapes : (n_sets, n) condensed coordinates
    slopes : (n_sets, n_z) da/dz
    """

    rate: FloatArray
    shapes: FloatArray
    slopes: FloatArray

    def some(self, which: BoolArray) -> Relaxation:
        """Return the relaxations of some sets."""
        return Relaxation(self.rate[which], self.shapes[which], self.slopes[which])


def nearest_relaxation(
    model: Condensed,
    points: Points,
    rate: float,
    *,
    at_sensors: FloatArray | None = None,
    shape: ComplexArray | None = None,
) -> Relaxation:
    """Return the relaxation nearest a rate: by |Δ ln a|, or by |Δ ln a| + 1 − MAC where a shape is known.

    Parameters
    ----------
    rate : float
        Rate [rad/s], inside the band for which the structure was condensed.
    at_sensors : (n_channels, n), optional
        Motion of the sensors for each coordinate.
    shape : (n_channels,), optional
        Measured shape at the sensors.
    """
    n_sets, n_z = len(points.rows), points.jacobian.shape[3]
    nothing = Relaxation(
        np.full(n_sets, np.nan), np.full((n_sets, model.n), np.nan), np.full((n_sets, n_z), np.nan)
    )
    if n_sets == 0 or (points.rows[..., K_ALPHA] > 0.0).any():
        return nothing
    pencil = _Pencil(model, points, rate)
    a, x = pencil.relaxations()
    if not a.shape[1]:
        return nothing
    apart = np.abs(np.log(np.where(a > 0.0, a, np.inf) / rate))
    if at_sensors is not None and shape is not None:
        seen = np.einsum("ci,kim->kmc", at_sensors, pencil.shapes(x))
        apart += 1.0 - mac(shape, seen.reshape(-1, shape.size)).reshape(apart.shape)
    rows, nearest = np.arange(n_sets), np.argmin(apart, axis=1)
    own, vector = a[rows, nearest], x[rows, :, nearest]
    start = Relaxation(own, pencil.shapes(vector[..., None])[..., 0], pencil.slopes(own, vector))
    return _refined(model, points, start)


class _Pencil:
    """The symmetric pencil P x = a Q x of the supports' relaxations, with the steel's F at a fixed rate."""

    def __init__(self, model: Condensed, points: Points, rate: float) -> None:
        self.points, self.rate = points, rate
        patterns = np.array([np.asarray(group.S) for group in model.pencil.groups])
        # condense the structure to the coordinates that laws act on
        on = np.flatnonzero(np.einsum("gii->i", patterns))
        rayleigh, which = np.unique(points.rayleigh, axis=0, return_inverse=True)
        steel = [_followed(_steel(model, ab, rate), on) for ab in rayleigh]
        self.A, self.spread = (np.array(part)[which.ravel()] for part in zip(*steel, strict=True))
        self.S = patterns[:, on][:, :, on]
        self.branched = np.flatnonzero(np.einsum("gii->i", self.S[self._with_branches()]))

    def shapes(self, x: FloatArray) -> FloatArray:
        """Return the condensed coordinates (n_sets, n, m) of vectors (n_sets, …, m)."""
        return np.asarray(self.spread @ x[:, : self.A.shape[1]])

    def _with_branches(self) -> IntArray:
        return np.flatnonzero((self.points.rows[:, :, BRANCHES::2] > 0.0).any(axis=(0, 2)))

    def relaxations(self) -> tuple[FloatArray, FloatArray]:
        """Return all rates (n_sets, n_rates) and their vectors (n_sets, n + n_y, n_rates)."""
        rows, n, s = self.points.rows, self.A.shape[1], self.branched
        k, tau = rows[:, :, BRANCHES::2], rows[:, :, BRANCHES + 1 :: 2]
        n_branches, m = k.shape[2], s.size
        size = n + n_branches * m
        P, Q = np.zeros((len(rows), size, size)), np.zeros((len(rows), size, size))
        static = rows[:, :, K0] + rows[:, :, MASS] * self.rate**2
        P[:, :n, :n] = self.A + self._sum(static + k.sum(axis=2))
        Q[:, :n, :n] = self._sum(rows[:, :, C])
        for j in range(n_branches):
            at = slice(n + j * m, n + (j + 1) * m)
            K = self._sum(k[:, :, j])
            P[:, :n, at], P[:, at, :n] = -K[:, :, s], -K[:, s]
            P[:, at, at] = K[:, s][:, :, s]
            Q[:, at, at] = self._sum(k[:, :, j] * tau[:, :, j])[:, s][:, :, s]
        L = np.linalg.inv(np.linalg.cholesky(P))
        time, v = np.linalg.eigh(L @ Q @ L.transpose(0, 2, 1))
        x = L.transpose(0, 2, 1) @ v
        # motions without damping relax instantly
        real = (time > _LEAST * time[:, -1:]).any(axis=0)
        with np.errstate(divide="ignore"):
            rates = np.where(time > _LEAST * time[:, -1:], 1.0 / time, np.inf)
        return rates[:, real], x[:, :, real]

    def slopes(self, a: FloatArray, x: FloatArray) -> FloatArray:
        """Return da/dz = xᵀ(dP − a dQ)x/xᵀQx (n_sets, n_z) of one relaxation of each set."""
        rows, n, s = self.points.rows, self.A.shape[1], self.branched
        if not self.points.jacobian.shape[3]:
            return np.zeros((len(rows), 0))
        k, tau = rows[:, :, BRANCHES::2], rows[:, :, BRANCHES + 1 :: 2]
        u = x[:, :n]
        by_row = np.zeros_like(rows)
        own = self._energy(u)
        by_row[:, :, K0], by_row[:, :, MASS], by_row[:, :, C] = own, own * self.rate**2, -a[:, None] * own
        lost = (rows[:, :, C] * own).sum(axis=1)
        for j in range(k.shape[2]):
            y = np.zeros_like(u)
            y[:, s] = x[:, n + j * s.size : n + (j + 1) * s.size]
            stretched, held = self._energy(u - y), self._energy(y)
            by_row[:, :, BRANCHES + 2 * j] = stretched - a[:, None] * tau[:, :, j] * held
            by_row[:, :, BRANCHES + 2 * j + 1] = -a[:, None] * k[:, :, j] * held
            lost += (k[:, :, j] * tau[:, :, j] * held).sum(axis=1)
        return np.asarray(np.einsum("kgw,kgwz->kz", by_row, self.points.jacobian) / lost[:, None])

    def _sum(self, factors: FloatArray) -> FloatArray:
        """Return Σ_g f_g S_g (n_sets, n, n) of factors (n_sets, n_groups)."""
        return np.asarray(np.tensordot(factors, self.S, axes=1))

    def _energy(self, u: FloatArray) -> FloatArray:
        """Return uᵀS_g u, (n_sets, n_groups)."""
        return np.asarray(np.einsum("gki,ki->kg", u @ self.S, u))


def _steel(model: Condensed, rayleigh: FloatArray, rate: float) -> FloatArray:
    """Return F(−a) (n, n) of the structure without its supports: positive definite on the real axis."""
    F, dF = (np.empty((model.n, model.n), np.complex128) for _ in range(2))
    s0, s1 = (np.empty(model.terms.shape[1], np.complex128) for _ in range(2))
    no_laws = np.zeros((len(model.pencil.groups), BRANCHES))
    kernels().fill(model.arrays(), no_laws, *rayleigh, complex(-rate), F, dF, s0, s1)
    return np.asarray(F.real)


def _followed(A: FloatArray, on: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return A condensed to some coordinates (m, m), and the transformation to all coordinates (n, m)."""
    off = np.setdiff1d(np.arange(len(A)), on)
    spread = np.zeros((len(A), on.size))
    spread[on] = np.eye(on.size)
    spread[off] = -np.linalg.solve(A[np.ix_(off, off)], A[np.ix_(off, on)])
    return A[on] @ spread, spread


def _refined(model: Condensed, points: Points, start: Relaxation) -> Relaxation:
    """Return the relaxations refined on the exact F(λ), where they are inside the band."""
    inside = np.flatnonzero(start.rate < model.radius)
    rate, shapes, slopes = start.rate.copy(), start.shapes.copy(), start.slopes.copy()
    values = (-start.rate[inside, None]).astype(np.complex128)
    vectors = np.ascontiguousarray(start.shapes[inside, None]).astype(np.complex128)
    alone = np.zeros(1, dtype=np.intp)
    done = refined(model, points.rows[inside], points.rayleigh[inside], alone, values, vectors, 0.0)[:, 0]
    poles, x = values[:, 0], vectors[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        done &= np.abs(poles.imag) <= REAL * np.abs(poles)
        done &= np.abs(np.log(-poles.real / start.rate[inside])) < _NEAR
    known, poles, x = inside[done], poles[done], x[done]
    rate[known], shapes[known] = -poles.real, x.real
    if slopes.shape[1]:
        exact = np.empty((known.size, slopes.shape[1]), np.complex128)
        no_shapes = np.empty((0, slopes.shape[1], model.n), np.complex128)
        kernels().slopes(
            model.arrays(), points.rows, points.rayleigh, known, np.arange(known.size), poles, x,
            points.jacobian, points.rayleigh_jacobian, exact, no_shapes,
        )  # fmt: skip
        slopes[known] = -exact.real
    return Relaxation(rate, shapes, slopes)
