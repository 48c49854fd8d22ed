"""All damped poles inside a disc, by a sparse method.

The first-order system of the thesis, (7.2) and (7.5), is never formed. Arnoldi iteration is applied to its
inverse about a small positive real shift σ, where F(σ) is real, symmetric and positive definite for any
passive support. Converged states are projected out and the iteration is repeated until no pole is left inside
the disc; in this way multiple poles are found. Each pole, or cluster of nearly equal poles, is then refined
on the non-linear F(λ)x = 0, which preserves their number. A springpot is first approximated by a law of few
states; the poles found are refined with the springpot's law, first in the space of all shapes found, then on
the whole system.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as spla
from scipy.sparse.csgraph import connected_components

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.errors import NumericalError
from jackettwin.response.state import factorised, shifted_inverse
from jackettwin.response.system import Matrix, Pencil
from jackettwin.soil import Prony, Springpot, one_branch, prony_fit

Pair = tuple[complex, ComplexArray]
"""A pole and its shape at the pencil's DOFs."""

_SMALL = 300
"""State vectors shorter than this are solved densely, as Arnoldi iteration needs a larger space."""
REAL = 1e-9
"""A pole with |Im λ| below this share of |λ| is real."""
_AT_ZERO = 5e-6
"""A pole smaller than this share of the disc's radius is a rigid-body motion, not an oscillation."""
_MOST_STEPS = 20
"""Most steps of a refinement; convergence is cubic."""
_AT_REST = 1e-10
"""A pole has converged when a Newton step changes it by less than this (relative)."""
_ROUNDING = 1e-7
"""Relative error of a pole due to rounding on a fine mesh, whose stiffness spans many decades."""
_FINE = (1e-4, 1e3, 4)
"""Limits of the range, relative to the radius, and branches per decade of a springpot's fit, used if one
branch is not sufficient. Every branch inside the disc adds a real pole for every degree of freedom it acts
on, all of which must be found."""
_OFF = 0.05
"""Relative error of initial poles from one branch (within 10 % of the law over a decade and a half)."""
_IN_SPACE = 1e-7
"""Relative size of the last Newton step in the space of the shapes found, which limits its accuracy."""
_STALE = 1e-3
"""A new factorisation is made when a pole has moved farther than this (relative)."""
_ALIKE = 0.9
"""Cosine of two shapes above which they are the same."""
_CLUSTER = 1e-5
"""Poles nearer than this (relative) are refined together, so that none falls on its neighbour."""


def damping_ratio(poles: ComplexArray | complex) -> FloatArray:
    """Return the damping ratios −Re λ/|λ| of poles [rad/s], thesis (3.6), in their shape."""
    z = np.asarray(poles)
    return np.asarray(-z.real / np.abs(z))


def poles_below(pencil: Pencil, radius: float) -> list[Pair]:
    """Return every pole with |λ| ≤ radius [rad/s] and Im λ ≥ 0, by |λ|.

    Raises
    ------
    NumericalError
        If the iteration does not converge or a refined pole does not come to rest.
    """
    if all(group.law.is_rational for group in pencil.groups):
        values, vectors = _poles_within(pencil, radius * (1.0 + _CLUSTER))
        pairs = [pair for at in _clusters(values) for pair in _exactly(pencil, values[at], vectors[:, at])]
    else:
        coarse = _fitted(pencil, lambda law: one_branch(law.row, radius))
        pairs, whole = _from_start(pencil, coarse, radius)
        if not whole:
            low, high, per_decade = _FINE
            hz = radius / (2.0 * pi)
            fine = _fitted(pencil, lambda law: prony_fit(law, low * hz, high * hz, per_decade))
            pairs, _ = _from_start(pencil, fine, radius)
    inside = [pair for pair in pairs if abs(pair[0]) <= radius and pair[0].imag >= -REAL * abs(pair[0])]
    return sorted(inside, key=lambda pair: abs(pair[0]))


def _from_start(pencil: Pencil, start: Pencil, radius: float) -> tuple[list[Pair], bool]:
    """Return the poles of ``pencil`` from those on other laws, and whether each start had its own."""
    # a start law is off by some hundredths: what it has just outside may lie inside
    values, vectors = _poles_within(start, radius * (1.0 + _OFF))
    clusters = [at for at in _clusters(values) if values[at].imag.any()]  # the others are the start law's own
    if not clusters:
        return [], True
    space = _extended(np.zeros((pencil.n, 0)), vectors)
    small = _on_space(pencil, space)
    found = [_nearly(pencil, small, space, values[at], space.T @ vectors[:, at]) for at in clusters]
    pairs = [pair for part in found for pair in part]
    return pairs, all(found) and not _doubled(pairs)


def _doubled(pairs: list[Pair]) -> bool:
    """Tell whether two initial poles converged to the same pole and shape."""
    values = np.array([value for value, _ in pairs])
    near = np.abs(values[:, None] - values) <= _ROUNDING * np.abs(values)
    return any(
        abs(np.vdot(pairs[i][1], pairs[j][1])) > _ALIKE
        for i, j in zip(*np.nonzero(np.triu(near, 1)), strict=True)
    )


def _fitted(pencil: Pencil, fit: Callable[[Springpot], Prony]) -> Pencil:
    """Return the pencil with a law of few states for every springpot."""
    laws = [fit(g.law) if isinstance(g.law, Springpot) else g.law for g in pencil.groups]
    return pencil.with_laws(laws)


def _on_space(pencil: Pencil, V: FloatArray) -> Pencil:
    """Return the pencil projected on a basis (n, n_vectors)."""
    groups = tuple(replace(group, S=V.T @ (group.S @ V)) for group in pencil.groups)
    return Pencil(V.T @ (pencil.M @ V), V.T @ (pencil.K @ V), pencil.rayleigh, groups)


def _poles_within(pencil: Pencil, radius: float) -> tuple[ComplexArray, ComplexArray]:
    """Return all poles with |λ| ≤ radius and Im λ ≥ 0 and their displacement parts (n, n_poles).

    Both poles of a nearly real pair are returned, since rounding may have produced it from two real poles.
    """
    sigma = 0.02 * radius
    inverse, size = shifted_inverse(pencil, sigma)
    Q = np.eye(size) if size <= _SMALL else _invariant_subspace(inverse, sigma, radius, size)
    theta, Y = np.linalg.eig(Q.T @ np.column_stack([inverse.matvec(q) for q in Q.T]))
    keep = _inside(theta, sigma, radius)
    values = (sigma + 1.0 / theta[keep]).astype(np.complex128)
    # rigid-body motions are double poles at zero, which rounding splits into slow pairs
    resting = np.abs(values) <= _AT_ZERO * radius
    values[resting] = values[resting].real
    upper = values.imag >= -_CLUSTER * np.abs(values)
    return values[upper], Q[: pencil.n] @ Y[:, keep][:, upper]


def _inside(theta: ComplexArray, sigma: float, radius: float) -> BoolArray:
    """Tell which eigenvalues θ = 1/(λ − σ) of the inverse belong to |λ| ≤ radius."""
    return np.asarray((np.abs(theta) > 0.0) & (np.abs(1.0 + sigma * theta) <= radius * np.abs(theta)))


def _invariant_subspace(inverse: spla.LinearOperator, sigma: float, radius: float, size: int) -> FloatArray:
    """Return an orthonormal basis of the states of all poles with |λ| ≤ radius.

    Arnoldi iteration from one vector finds one state of a multiple pole. It is therefore repeated from
    another vector, orthogonal to the known states, until all poles found lie outside.
    """
    Q, k = np.zeros((size, 0)), 24
    while True:
        known = Q

        def rest(b: FloatArray, known: FloatArray = known) -> FloatArray:
            y = inverse.matvec(b)
            return np.asarray(y - known @ (known.T @ y))

        k = min(k, size - Q.shape[1] - 2)
        if k < 1:
            return np.eye(size)
        operator = spla.LinearOperator((size, size), matvec=rest, dtype=np.float64)
        try:
            theta, x = spla.eigs(
                operator, k=k, v0=_start(size, Q.shape[1]), ncv=min(size, 2 * k + 20), tol=1e-12, maxiter=300
            )
        except (spla.ArpackError, RuntimeError) as error:
            if k > 4:  # among so many, the last were too small relative to the first to converge
                k //= 2
                continue
            raise NumericalError(f"damped modes did not converge: {error}") from error
        found = _inside(theta, sigma, radius)
        if not found.any():
            return Q
        Q = _extended(Q, x[:, found])
        k = 48 if found.all() else 8


def _extended(Q: FloatArray, x: ComplexArray) -> FloatArray:
    """Return the basis with the real and imaginary parts of ``x`` added, as far as they are independent."""
    parts = np.hstack([x.real, x.imag])
    parts = parts - Q @ (Q.T @ parts)
    u, s, _ = la.svd(parts, full_matrices=False)
    # nearly dependent vectors would add noise; the next run finds them accurately
    new = u[:, s > 1e-6 * s[0]]
    new = new - Q @ (Q.T @ new)
    return np.hstack([Q, np.linalg.qr(new)[0]])


def _clusters(values: ComplexArray) -> list[IntArray]:
    """Return groups of poles that are too close to be refined one by one."""
    near = np.abs(values[:, None] - values) <= _CLUSTER * np.abs(values)
    n_groups, group = connected_components(near.astype(float), directed=False)
    return [np.flatnonzero(group == g) for g in range(n_groups)]


def _exactly(pencil: Pencil, values: ComplexArray, x: ComplexArray) -> list[Pair]:
    """Return the poles of one cluster that Arnoldi found on the pencil's own laws.

    Raises
    ------
    NumericalError
        If the refinement of a pole does not converge near its initial value.
    """
    if not values.imag.any():  # real poles are not refined
        return list(zip(map(complex, values), x.T, strict=True))
    found, y, at_rest = _newton(pencil, values, x)
    if not at_rest or abs(found.mean() - values.mean()) > 1e-6 * abs(values.mean()):
        raise NumericalError(f"the pole near λ = {values.mean():.6g} rad/s could not be refined")
    return list(zip(map(complex, found), y.T, strict=True))


def _nearly(
    pencil: Pencil, small: Pencil, space: FloatArray, values: ComplexArray, x: ComplexArray
) -> list[Pair]:
    """Return the poles of one cluster from approximate ones; none for an artefact near the branch cut.

    Parameters
    ----------
    small : the pencil on the coordinates of ``space`` (n, n_vectors)
    x : (n_vectors, n_values)
    """
    near, y, _ = _newton(small, values, x, rest=_IN_SPACE)
    found, y, at_rest = _newton(pencil, near, space @ y)
    if not at_rest or abs(found.mean() - values.mean()) > 0.1 * abs(values.mean()):
        return []
    return list(zip(map(complex, found), y.T, strict=True))


def _newton(
    pencil: Pencil, values: ComplexArray, x: ComplexArray, *, rest: float = _AT_REST
) -> tuple[ComplexArray, ComplexArray, bool]:
    r"""Refine a cluster of poles together: inverse iteration and Rayleigh–Ritz on F(λ) about their mean.

    For one pole this is Newton's method: since F is symmetric, :math:`δ = -u^T F u / u^T F' u` with
    :math:`u = F^{-1} F' x` converges cubically. Near the pole a factorisation is reused by residual inverse
    iteration (Neumaier 1985): :math:`x - F(σ)^{-1} F(λ) x`.
    """
    change = last = np.inf
    for _ in range(_MOST_STEPS):
        mean = complex(values.mean())
        F, dF = pencil.F(mean), pencil.dF(mean)
        try:
            if change > min(_STALE, 0.1 * last):
                solve = _solver(F)
                x = solve(dF @ x)
            else:
                x = x - solve(F @ x + dF @ (x * (values - mean)))
        except (RuntimeError, np.linalg.LinAlgError):
            pass  # F is numerically singular: the vectors have converged
        last = change
        Q = np.linalg.qr(x)[0]
        delta, y = la.eig(-(Q.T @ (F @ Q)), Q.T @ (dF @ Q))
        values, x = mean + delta, Q @ y
        change = abs(values.mean() - mean) / abs(mean)
        if change <= rest or 0.5 * last <= change <= _ROUNDING:
            break
    return values, x / np.linalg.norm(x, axis=0), change <= _ROUNDING


def _solver(F: Matrix) -> Callable[[ComplexArray], ComplexArray]:
    """Return a function that solves F x = b, for sparse or dense F."""
    if isinstance(F, np.ndarray):
        return lambda b: np.asarray(np.linalg.solve(F, b), dtype=np.complex128)
    factors = factorised(F)
    return lambda b: np.asarray(factors.solve(b), dtype=np.complex128)


def _start(n: int, seed: int = 0) -> FloatArray:
    """Return a fixed start vector with a component along every mode."""
    return np.random.default_rng(seed).standard_normal(n)
