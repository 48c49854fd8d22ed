"""Every damped pole inside a disc, by a sparse method.

The first-order system of the thesis, (7.2) and (7.5), is never formed. Arnoldi iteration works on its inverse
about a small positive real shift σ, where F(σ) is real, symmetric and positive definite for any passive
support. What it found is projected out and it runs again, until nothing is left inside the disc: that is what
finds multiple poles. Each pole, or cluster of nearly equal poles, is then refined on the non-linear F(λ)x = 0
itself, which keeps their number. A springpot starts from a Prony series and is refined on its own law.
"""

from __future__ import annotations

from math import pi

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as spla
from scipy.sparse.csgraph import connected_components

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.errors import NumericalError
from jackettwin.response.state import factorised, shifted_inverse
from jackettwin.response.system import Pencil
from jackettwin.soil.viscoelastic import Prony, Springpot, prony_fit

Pair = tuple[complex, ComplexArray]
"""A pole and its shape on the pencil's DOFs."""

_SMALL = 300
"""State vectors shorter than this are solved densely: Arnoldi needs room."""
REAL = 1e-9
"""A pole with |Im λ| below this share of |λ| is real."""
_AT_ZERO = 5e-6
"""A pole smaller than this share of the disc's radius is a structure at rest, not an oscillation."""
_AT_REST = 1e-10
"""A pole that a Newton step moves less than this (relative) is found."""
_ROUNDING = 1e-7
"""What rounding may leave in a pole of a finely cut mesh, whose stiffness spans many decades."""
_COARSE, _FINE = (1e-2, 10.0, 1), (1e-4, 1e3, 4)
"""Fit of a springpot to start from: range over the radius and branches a decade. Every branch inside the disc
brings a real pole for every degree of freedom it holds, and all of these have to be found: the coarse one
(within 2 % of the law) costs what three Maxwell branches do, the fine one ten times that."""
_OFF = 0.02
"""By which the starts of a coarse law may miss."""
_ALIKE = 0.9
"""Cosine of two shapes of unit length from which they are one."""
_CLUSTER = 1e-5
"""Poles nearer than this (relative) are refined together, so that none falls on its neighbour."""


def poles_below(pencil: Pencil, radius: float) -> list[Pair]:
    """Return every pole with |λ| ≤ radius [rad/s] and Im λ ≥ 0, by |λ|.

    Raises
    ------
    NumericalError
        If the iteration does not converge or a refined pole does not come to rest.
    """
    if all(isinstance(group.law, Prony) for group in pencil.groups):
        pairs, _ = _from_start(pencil, pencil, radius)
    else:
        pairs, whole = _from_start(pencil, _finite(pencil, radius, _COARSE), radius)
        if not whole:
            pairs, _ = _from_start(pencil, _finite(pencil, radius, _FINE), radius)
    inside = [pair for pair in pairs if abs(pair[0]) <= radius and pair[0].imag >= -REAL * abs(pair[0])]
    return sorted(inside, key=lambda pair: abs(pair[0]))


def _from_start(pencil: Pencil, start: Pencil, radius: float) -> tuple[list[Pair], bool]:
    """Return the poles of ``pencil`` from those of ``start``, and whether each start had its own."""
    # a start law is off by some hundredths: what it has just outside may lie inside
    room = _CLUSTER if start is pencil else _OFF
    values, vectors = _poles_within(start, radius * (1.0 + room))
    pairs: list[Pair] = []
    whole = True
    for members in _clusters(values):
        found = _refined(pencil, values[members], vectors[:, members], exact=start is pencil)
        whole &= bool(found) or not values[members].imag.any()
        pairs += found
    return pairs, whole and not _doubled(pairs)


def _doubled(pairs: list[Pair]) -> bool:
    """Tell whether two starts came to one pole: the same value and the same shape."""
    values = np.array([value for value, _ in pairs])
    near = np.abs(values[:, None] - values) <= _ROUNDING * np.abs(values)
    return any(
        abs(np.vdot(pairs[i][1], pairs[j][1])) > _ALIKE
        for i, j in zip(*np.nonzero(np.triu(near, 1)), strict=True)
    )


def _finite(pencil: Pencil, radius: float, fit: tuple[float, float, int]) -> Pencil:
    """Return the pencil with every springpot fitted over a share of the radius, some branches a decade."""
    low, high, per_decade = fit
    hz = radius / (2.0 * pi)
    laws = [
        prony_fit(group.law, low * hz, high * hz, per_decade)
        if isinstance(group.law, Springpot)
        else group.law
        for group in pencil.groups
    ]
    return pencil.with_laws(laws)


def _poles_within(pencil: Pencil, radius: float) -> tuple[ComplexArray, ComplexArray]:
    """Return all poles with |λ| ≤ radius and Im λ ≥ 0 and their displacement parts (n, n_poles).

    Of a nearly real pair both are returned: rounding may have made it from two real poles.
    """
    sigma = 0.02 * radius
    inverse, size = shifted_inverse(pencil, sigma)
    Q = np.eye(size) if size <= _SMALL else _invariant_subspace(inverse, sigma, radius, size)
    theta, Y = np.linalg.eig(Q.T @ np.column_stack([inverse.matvec(q) for q in Q.T]))
    keep = _inside(theta, sigma, radius)
    values = (sigma + 1.0 / theta[keep]).astype(np.complex128)
    # a structure at rest has double poles at zero, which rounding splits into slow pairs
    resting = np.abs(values) <= _AT_ZERO * radius
    values[resting] = values[resting].real
    upper = values.imag >= -_CLUSTER * np.abs(values)
    return values[upper], Q[: pencil.n] @ Y[:, keep][:, upper]


def _inside(theta: ComplexArray, sigma: float, radius: float) -> BoolArray:
    """Tell which eigenvalues θ = 1/(λ − σ) of the inverse belong to |λ| ≤ radius."""
    return np.asarray((np.abs(theta) > 0.0) & (np.abs(1.0 + sigma * theta) <= radius * np.abs(theta)))


def _invariant_subspace(inverse: spla.LinearOperator, sigma: float, radius: float, size: int) -> FloatArray:
    """Return an orthonormal basis of the states of all poles with |λ| ≤ radius.

    Arnoldi from one vector sees one state of a multiple pole. So it runs again beside what is already known,
    from another start, until all it finds lies outside.
    """
    Q, k = np.zeros((size, 0)), 24
    while True:
        known = Q

        def rest(b: FloatArray, known: FloatArray = known) -> FloatArray:
            y = inverse.matvec(b - known @ (known.T @ b))
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
            if k > 4:  # the last of the many were too small beside the first to converge
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
    # what is nearly dependent would add noise; the next run finds it cleanly
    new = u[:, s > 1e-6 * s[0]]
    new = new - Q @ (Q.T @ new)
    return np.hstack([Q, np.linalg.qr(new)[0]])


def _clusters(values: ComplexArray) -> list[IntArray]:
    """Return groups of poles that lie too close to be refined one by one."""
    near = np.abs(values[:, None] - values) <= _CLUSTER * np.abs(values)
    n_groups, group = connected_components(near.astype(float), directed=False)
    return [np.flatnonzero(group == g) for g in range(n_groups)]


def _refined(pencil: Pencil, values: ComplexArray, x: ComplexArray, *, exact: bool) -> list[Pair]:
    """Return the poles of one cluster on the pencil itself; ``exact`` if the starts come from its own laws.

    Raises
    ------
    NumericalError
        If a pole of the pencil does not come to rest where Arnoldi found it.
    """
    if not values.imag.any():  # real poles are as exact as Arnoldi made them; the start law's are none
        return [(complex(v), y) for v, y in zip(values, x.T, strict=True)] if exact else []
    found, y, at_rest = _newton(pencil, values, x)
    moved = np.abs(found.mean() - values.mean()) > (1e-6 if exact else 0.1) * np.abs(values.mean())
    if at_rest and not moved:
        return list(zip(map(complex, found), y.T, strict=True))
    if exact:
        raise NumericalError(f"the pole near λ = {values.mean():.6g} rad/s could not be refined")
    return []  # an artefact of the start law near the branch cut


def _newton(
    pencil: Pencil, values: ComplexArray, x: ComplexArray, steps: int = 20
) -> tuple[ComplexArray, ComplexArray, bool]:
    r"""Refine a cluster of poles together: inverse iteration and Rayleigh–Ritz on F(λ) about their mean.

    With one pole this is Newton's method; F is symmetric, so that
    :math:`δ = -u^T F u / u^T F' u` with :math:`u = F^{-1} F' x` converges cubically.
    """
    last = np.inf
    for _ in range(steps):
        mean = complex(values.mean())
        F, dF = pencil.F(mean), pencil.dF(mean)
        try:
            x = factorised(F).solve(dF @ x)
        except RuntimeError:  # F is singular to the last digit: the vectors are as good as they get
            pass
        Q = np.linalg.qr(x)[0]
        delta, y = la.eig(-(Q.T @ (F @ Q)), Q.T @ (dF @ Q))
        values, x = mean + delta, Q @ y
        change = abs(values.mean() - mean) / abs(mean)
        if change <= _AT_REST or 0.5 * last <= change <= _ROUNDING:
            break
        last = change
    return values, x / np.linalg.norm(x, axis=0), change <= _ROUNDING


def _start(n: int, seed: int = 0) -> FloatArray:
    """Return a fixed start vector with something of every mode in it."""
    return np.random.default_rng(seed).standard_normal(n)
