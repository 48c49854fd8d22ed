"""The condensed F(λ), small dense linear algebra, and loops over many poles and points, compiled.

Everything here works on plain arrays. A condensed structure is the tuple ``model``

    terms (n_terms, n_pairs), n_moments, mid (n_mid,), P (n_b, n_r), w2 (n_r,),
    group, row, column, weight (n_entries,)

of :class:`jackettwin.response.condensation.condensed.Condensed`; a support law is a row of
:mod:`jackettwin.soil.laws.coefficients`.

All kernels are in one file because Numba recompiles cached code only when the file that contains it changes,
not when a file that it calls does.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator, call-overload"

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

# sums may be regrouped for speed, but signed zeros must remain: they distinguish the sides of the branch cut
_HOW: dict[str, Any] = {"error_model": "numpy", "fastmath": {"reassoc", "contract"}}
compiled = njit(cache=True, **_HOW)
"""Decorator of functions that are called from Python."""
making = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **_HOW)
"""Decorator of functions called by compiled code only; without a Python wrapper a small kernel compiles in
half the time."""
inner = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False, **_HOW)
"""Decorator of such functions that also allocate no array; without reference counting they compile a tenth
faster."""
within = njit(inline="always", **_HOW)
"""Decorator of functions that are called in one place and inlined there."""

MAX_STEPS = 30
"""Most Newton steps; convergence is cubic, so that one that needs more does not converge."""
_TINY = 1e-300
"""In place of zero where a number is divided by, near the smallest one of double precision."""
_MAX_DEPTH = 24
"""Most halvings of a piece of the arc, to 6e-8 of its length."""
_NEAR = 0.05
"""A retained mode whose diagonal is less than this share of its ω² is near its resonance."""
COARSE = 1e-4
"""A cluster has converged as a whole when its mean changes by less than this (relative). The errors of its
poles are then of the order of the square of this and of their distance, and each can be refined
separately."""
INSEPARABLE = 1e-5
"""Poles nearer than this (relative) are refined together to the end: the error, their distance squared, is at
rounding level."""
_PARALLEL = 1.0 - 5e-7
"""Two shapes of equal poles with a larger cosine than this are one mode found twice."""
_SKEWED = 1e3
"""Condition number above which modes of a multiple pole hardly resemble pinned ones and are not rotated."""
_CLEARLY = 1.0 + 1e-9
"""Smallest ratio by which an exchange must be better, to exceed rounding."""
EQUAL = 1e-9
"""Poles nearer than this (relative) are one multiple pole."""


def compiled_before() -> bool:
    """Tell whether compiled code of this file is cached on disk."""
    written = Path(__file__).stat().st_mtime
    kept = Path(refine.stats.cache_path).glob("kernels.refine-*.nbi")
    return any(file.stat().st_mtime >= written for file in kept)


@inner
def _law(row, s):
    """Return D(s) and dD/ds."""
    d = row[0] + (row[1] + row[5] * s) * s
    dd = row[1] + 2.0 * row[5] * s
    if row[2] > 0.0:
        p = row[2] * np.exp(row[3] * np.log(s / row[4]))
        d += p
        dd += row[3] * p / s
    for j in range(6, row.size, 2):
        if row[j] > 0.0 and row[j + 1] > 0.0:
            u = 1.0 / (1.0 + row[j + 1] * s)
            d += row[j] * row[j + 1] * s * u
            dd += row[j] * row[j + 1] * u * u
    return d, dd


@inner
def law_derivatives(row, s, out):
    """Fill ∂D(s)/∂row."""
    for j in range(out.size):
        out[j] = 0.0
    out[0] = 1.0
    out[1] = s
    out[5] = s * s
    if row[2] > 0.0:
        log = np.log(s / row[4])
        p = np.exp(row[3] * log)
        out[2] = p
        out[3] = row[2] * p * log
        out[4] = -row[2] * p * row[3] / row[4]
    for j in range(6, row.size, 2):
        u = 1.0 / (1.0 + row[j + 1] * s)
        out[j] = row[j + 1] * s * u
        out[j + 1] = row[j] * s * u * u


@compiled
def law_response(rows, jacobian, s, D, dD):
    """Fill D(s) (n_groups, n_s) of law rows and, from d rows/dz, dD/dz (n_groups, n_s, n_z)."""
    law = np.empty(rows.shape[1], np.complex128)
    for g in range(rows.shape[0]):
        for m in range(s.size):
            D[g, m], _ = _law(rows[g], s[m])
            law_derivatives(rows[g], s[m], law)
            for z in range(dD.shape[2]):
                total = 0.0j
                for w in range(law.size):
                    total += law[w] * jacobian[g, w, z]
                dD[g, m, z] = total


@inner
def _structure(model, mu, s0, s1):
    """Fill S0(μ) and dS0/dμ, packed; return nothing."""
    terms, n_moments, mid = model[0], model[1], model[2]
    n_pairs = terms.shape[1]
    for p in range(n_pairs):
        s0[p] = 0.0
        s1[p] = 0.0
    power = 1.0 + 0.0j
    for t in range(terms.shape[0]):
        if t == 0:
            c, dc = 1.0 + 0.0j, 0.0j
        elif t == 1:
            c, dc = mu, 1.0 + 0.0j
        elif t < n_moments:
            c, dc = -mu * mu * power, -t * mu * power
            power = -power * mu
        else:
            w = mid[t - n_moments]
            u = 1.0 / (w + mu)
            c, dc = -mu * mu * u, -mu * (2.0 * w + mu) * u * u
        for p in range(n_pairs):
            s0[p] += c * terms[t, p]
            s1[p] += dc * terms[t, p]


@compiled
def fill(model, rows, a, b, s, F, dF, s0, s1):
    """Fill F(s) and dF/ds, and the packed S0(μ), S0′(μ); return μ."""
    P, w2 = model[3], model[4]
    group, row, column, weight = model[5], model[6], model[7], model[8]
    nb, nr = P.shape
    t = 1.0 + b * s
    q = s * s + a * s
    dq = 2.0 * s + a
    mu = q / t
    g = dq - b * mu
    _structure(model, mu, s0, s1)
    p = 0
    for i in range(nb):
        for j in range(i, nb):
            F[i, j] = t * s0[p]
            dF[i, j] = b * s0[p] + g * s1[p]
            F[j, i] = F[i, j]
            dF[j, i] = dF[i, j]
            p += 1
    for i in range(nb):
        for j in range(nr):
            F[i, nb + j] = q * P[i, j]
            dF[i, nb + j] = dq * P[i, j]
            F[nb + j, i] = F[i, nb + j]
            dF[nb + j, i] = dF[i, nb + j]
    for j in range(nr):
        for i in range(nr):
            F[nb + i, nb + j] = 0.0
            dF[nb + i, nb + j] = 0.0
    for j in range(nr):
        F[nb + j, nb + j] = q + t * w2[j]
        dF[nb + j, nb + j] = dq + b * w2[j]
    last = -1
    d, dd = 0.0j, 0.0j
    for e in range(group.size):
        if group[e] != last:
            last = group[e]
            d, dd = _law(rows[last], s)
        F[row[e], column[e]] += weight[e] * d
        dF[row[e], column[e]] += weight[e] * dd
    return mu


@inner
def _copy(A, n, B):
    """Fill the leading n × n of B with that of A."""
    for i in range(n):
        for j in range(n):
            B[i, j] = A[i, j]


@inner
def _assign(x, y):
    """Fill y with x."""
    for i in range(x.size):
        y[i] = x[i]


@inner
def _count_from(start, numbers):
    """Fill numbers with start, start + 1 and so on."""
    for k in range(numbers.size):
        numbers[k] = start + k


@inner
def _mirror(G, n):
    """Copy the upper triangle of the leading n × n of G to the lower one."""
    for i in range(n):
        for k in range(i):
            G[i, k] = G[k, i]


@inner
def eliminate(F, w2, place, G):
    """Eliminate retained modes from F; return the size of the remaining matrix G and the pivots' phase.

    Retained modes are coupled to the boundary but not to each other, unless a law acts on the whole structure
    (water); then none is eliminated. Modes near their own resonance, which would be poor pivots, are not
    eliminated either. ``place`` (n_retained,) is filled with the index of each mode in G, or −1.
    """
    nr = w2.size
    nb = F.shape[0] - nr
    m, phase = nb, 1.0 + 0.0j
    for i in range(1, nr):
        for j in range(i):
            if F[nb + i, nb + j] != 0.0:
                _copy(F, F.shape[0], G)
                _count_from(nb, place)
                return nb + nr, phase
    _copy(F, nb, G)
    for j in range(nr):
        pivot = F[nb + j, nb + j]
        if abs(pivot) < _NEAR * w2[j]:
            place[j] = m
            for i in range(m):
                G[i, m] = F[i, nb + j] if i < nb else 0.0
                G[m, i] = G[i, m]
            G[m, m] = pivot
            m += 1
            continue
        place[j] = -1
        phase *= pivot / abs(pivot)
        inverse = 1.0 / pivot
        for i in range(nb):
            f = F[i, nb + j] * inverse
            for k in range(i, nb):
                G[i, k] -= f * F[k, nb + j]
    _mirror(G, nb)
    return m, phase


@inner
def solve_eliminated(F, place, G, m, pivot, x, z):
    """Overwrite x with F⁻¹x from the factors of G of :func:`eliminate`; ``z`` (m,) is work space."""
    nr = place.size
    nb = F.shape[0] - nr
    for i in range(nb):
        z[i] = x[i]
    for j in range(nr):
        if place[j] >= 0:
            z[place[j]] = x[nb + j]
            continue
        x[nb + j] /= F[nb + j, nb + j]
        for i in range(nb):
            z[i] -= F[i, nb + j] * x[nb + j]
    solve(G, m, pivot, z)
    for i in range(nb):
        x[i] = z[i]
    for j in range(nr):
        if place[j] >= 0:
            x[nb + j] = z[place[j]]
            continue
        force = 0.0j
        for i in range(nb):
            force += F[i, nb + j] * z[i]
        x[nb + j] -= force / F[nb + j, nb + j]


@inner
def factor(A, n, pivot):
    """Factor the leading n × n of A = PLU in place; return the phase of its determinant (0 if singular)."""
    phase = 1.0 + 0.0j
    for k in range(n):
        best, at = -1.0, k
        for i in range(k, n):
            size = abs(A[i, k].real) + abs(A[i, k].imag)
            if size > best:
                best, at = size, i
        pivot[k] = at
        if best == 0.0:
            return 0.0j
        if at != k:
            for j in range(n):
                A[k, j], A[at, j] = A[at, j], A[k, j]
            phase = -phase
        phase *= A[k, k] / abs(A[k, k])
        inverse = 1.0 / A[k, k]
        for i in range(k + 1, n):
            if A[i, k] != 0.0:
                f = A[i, k] * inverse
                A[i, k] = f
                for j in range(k + 1, n):
                    A[i, j] -= f * A[k, j]
    return phase


@inner
def solve(A, n, pivot, x):
    """Overwrite x (n,) with A⁻¹x from the factors of :func:`factor`."""
    for k in range(n):
        at = pivot[k]
        x[k], x[at] = x[at], x[k]
    for i in range(1, n):
        for j in range(i):
            x[i] -= A[i, j] * x[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= A[i, j] * x[j]
        x[i] /= A[i, i]


@inner
def times(A, x, y):
    """Fill y with A x; return xᵀAx."""
    total = 0.0j
    for i in range(x.size):
        row = 0.0j
        for j in range(x.size):
            row += A[i, j] * x[j]
        y[i] = row
        total += x[i] * row
    return total


@inner
def _product(x, y):
    """Return xᵀy."""
    total = 0.0j
    for i in range(x.size):
        total += x[i] * y[i]
    return total


@making
def _matrices(n):
    """Return work space for F, dF/ds and the matrix that remains after elimination."""
    shape = (n, n)
    return np.empty(shape, np.complex128), np.empty(shape, np.complex128), np.empty(shape, np.complex128)


@inner
def _normalise(x):
    size = 0.0
    for i in range(x.size):
        size += x[i].real ** 2 + x[i].imag ** 2
    size = 1.0 / np.sqrt(size)
    for i in range(x.size):
        x[i] *= size


@inner
def _bounded(step, s):
    """Return the step, limited to a third of |s|."""
    size, most = abs(step), 0.3 * abs(s)
    return step * (most / size) if size > most else step


@inner
def _inner_product(x, y):
    """Return xᴴy."""
    total = 0.0j
    for i in range(x.size):
        total += np.conj(x[i]) * y[i]
    return total


@inner
def _mean(values):
    """Return the mean."""
    total = 0.0j
    for i in range(values.size):
        total += values[i]
    return total / values.size


@making
def _room(model):
    """Return work space for refining one or two poles."""
    n, n_pairs, n_retained = model[3].shape[0] + model[3].shape[1], model[0].shape[1], model[4].size
    F, dF, G = _matrices(n)
    s0, s1, z = np.empty(n_pairs, np.complex128), np.empty(n_pairs, np.complex128), np.empty(n, np.complex128)
    U, W, small = np.empty((2, n), np.complex128), np.empty((2, n), np.complex128), np.empty(8, np.complex128)
    return F, dF, G, s0, s1, np.empty(n, np.int64), np.empty(n_retained, np.int64), U, W, z, small


@inner
def _orthonormalise(U, W, m):
    """Orthonormalise the first rows of U, one or two, and transform those of W in the same way."""
    for j in range(m):
        for _ in range(2 * j):  # two passes suffice, even for nearly parallel rows
            c = _inner_product(U[0], U[1])
            for k in range(U.shape[1]):
                U[1, k] -= c * U[0, k]
                W[1, k] -= c * W[0, k]
        size = 1.0 / np.sqrt(_inner_product(U[j], U[j]).real)
        for k in range(U.shape[1]):
            U[j, k] *= size
            W[j, k] *= size


@inner
def _small_eigen(A, B, Y):
    """Return the two δ of A y = δ B y and fill Y with y; the 2 × 2 matrices are stored by rows, (4,)."""
    inverse = 1.0 / (B[0] * B[3] - B[1] * B[2])
    c00, c01 = (B[3] * A[0] - B[1] * A[2]) * inverse, (B[3] * A[1] - B[1] * A[3]) * inverse
    c10, c11 = (B[0] * A[2] - B[2] * A[0]) * inverse, (B[0] * A[3] - B[2] * A[1]) * inverse
    middle, half = 0.5 * (c00 + c11), 0.5 * (c00 - c11)
    root = np.sqrt(half * half + c01 * c10)
    # the root without cancellation
    top = half + root if abs(half + root) > abs(half - root) else half - root
    Y[0], Y[1], Y[2], Y[3] = top, -c01, c10, top
    return middle + (top - half), middle - (top - half)


@inner
def _ritz(room, s, values, vectors):
    """Fill the Rayleigh–Ritz values and vectors about s in the span of U (W is F U); return their step."""
    F, dF, G, s0, s1, pivot, place, U, W, y, small = room
    m, A, B = values.size, small[:4], small[4:]
    _orthonormalise(U, W, m)
    for j in range(m):
        times(dF, U[j], y)
        for i in range(m):
            A[2 * i + j] = -_product(U[i], W[j])
            B[2 * i + j] = _product(U[i], y)
    if m == 1:
        step = A[0] / B[0]
        if np.isfinite(abs(step)):
            values[0] = s + _bounded(step, s)
            _assign(U[0], vectors[0])
        return _bounded(step, s)
    one, other = _small_eigen(A, B, A)
    middle, half = 0.5 * (one + other), 0.5 * (one - other)
    spread = abs(half)
    if not np.isfinite(spread):
        return middle
    step = _bounded(middle, s)
    half *= min(1.0, 0.3 * abs(s) / max(spread, _TINY))
    values[0], values[1] = s + step + half, s + step - half
    for j in range(2):
        _assign(U[j], vectors[j])
        if spread > EQUAL * abs(s):
            # eigenvectors of equal values would be determined by rounding and might be parallel
            for k in range(y.size):
                vectors[j, k] = A[j] * U[0, k] + A[2 + j] * U[1, k]
            _normalise(vectors[j])
    return step


@inner
def _iterate(model, laws, a, b, values, vectors, tolerance, room):
    """Refine one pole, or two nearly equal ones about their mean, by inverse iteration and Rayleigh–Ritz.

    Convergence to one pole is cubic, since F is symmetric; the error of two is the square of their distance.
    The Rayleigh quotients of the initial shapes are more accurate than the initial values. Return whether the
    mean converged.
    """
    F, dF, G, s0, s1, pivot, place, U, W, z, small = room
    m = values.size
    for round_ in range(MAX_STEPS):
        s = _mean(values)
        fill(model, laws, a, b, s, F, dF, s0, s1)
        left, phase = m, 1.0 + 0.0j
        if round_ > 0:
            left, phase = eliminate(F, model[4], place, G)
            if factor(G, left, pivot) == 0.0:
                return True
        for j in range(m):
            if round_ == 0:
                _assign(vectors[j], U[j])
                times(F, U[j], W[j])
            else:
                times(dF, vectors[j], W[j])
                _assign(W[j], U[j])
                solve_eliminated(F, place, G, left, pivot, U[j], z)
        step = _ritz(room, s, values, vectors)
        if not np.isfinite(abs(step)):
            return False
        if round_ > 0 and abs(step) <= tolerance * abs(s):
            return True
    return False


@inner
def _exchange(values, shapes, a, b):
    """Exchange two modes."""
    values[a], values[b] = values[b], values[a]
    for i in range(shapes.shape[1]):
        shapes[a, i], shapes[b, i] = shapes[b, i], shapes[a, i]


@inner
def _take(values, shapes, i, other_values, other_shapes, j):
    """Copy mode i to the place j of others."""
    other_values[j] = values[i]
    for k in range(shapes.shape[1]):
        other_shapes[j, k] = shapes[i, k]


@within
def _refine_cluster(model, laws, a, b, values, vectors, tolerance, room):
    """Refine one pole, or two near each other: first together, then separately if they are distinct.

    Two are returned in the order of |λ|. Return whether all converged.
    """
    first, size = 0, values.size
    near = COARSE if size == 2 else tolerance
    while first < values.size:
        last = first + size
        if not _iterate(model, laws, a, b, values[first:last], vectors[first:last], near, room):
            return False
        if near == tolerance:
            first = last
            continue
        near = tolerance
        if abs(values[1]) < abs(values[0]):
            _exchange(values, vectors, 0, 1)
        if abs(values[1] - values[0]) > INSEPARABLE * abs(values[1]):
            size = 1
    return True


@inner
def _known(values, family, first, at):
    """Fill ``at`` with the indices of a family's finite values, in the order of their size.

    Return how many there are.
    """
    m = 0
    for i in range(first, values.size):
        if family[i] == family[first] and np.isfinite(values[i].real):
            j = m
            while j > 0 and abs(values[at[j - 1]]) > abs(values[i]):
                at[j] = at[j - 1]
                j -= 1
            at[j] = i
            m += 1
    return m


@compiled
def refine(model, rows, rayleigh, family, values, vectors, near, tolerance):
    """Refine initial poles of every set in place, two of one family together if they are near each other.

    ``family`` (n_modes,) ascends; a mode without an initial value is NaN. Returns (n_sets, n_modes) codes: 1
    where a mode converged, 0 where it did not, and −1 − i for modes of a cluster of more than two, which is
    not refined, with i the index of its first mode.
    """
    n_sets, n_modes = values.shape
    room = _room(model)
    done = np.zeros((n_sets, n_modes), np.int64)
    own, at = np.empty(2, np.complex128), np.empty(n_modes, np.int64)
    x = np.empty((2, vectors.shape[2]), np.complex128)
    for k in range(n_sets):
        a, b = rayleigh[k]
        for first in range(n_modes):
            if first > 0 and family[first] == family[first - 1]:
                continue
            m, start = _known(values[k], family, first, at), 0
            for end in range(1, m + 1):
                before, last = at[end - 1], at[min(end, m - 1)]
                if end < m and abs(values[k, last] - values[k, before]) <= near * abs(values[k, last]):
                    continue
                size = end - start
                for i in range(size):
                    if size > 2:
                        done[k, at[start + i]] = -1 - at[start]
                    else:
                        _take(values[k], vectors[k], at[start + i], own, x, i)
                if size <= 2:
                    ok = _refine_cluster(model, rows[k], a, b, own[:size], x[:size], tolerance, room)
                    for i in range(size):
                        _take(own, x, i, values[k], vectors[k], at[start + i])
                        done[k, at[start + i]] = 1 if ok else 0
                start = end
    return done


@inner
def _weighed(M, x, y):
    """Fill y with M x; M is real."""
    for i in range(x.size):
        total = 0.0j
        for j in range(x.size):
            total += M[i, j] * x[j]
        y[i] = total


@inner
def _members(family, values, first, own):
    """Fill ``own`` with the known modes of the family that begins at ``first``.

    Return how many there are and where the next family begins.
    """
    last, m = first, 0
    while last < values.size and family[last] == family[first]:
        if np.isfinite(values[last].real):
            own[m] = last
            m += 1
        last += 1
    return m, last


@inner
def _among(M, starts, shapes, own, m, heavy, room, pivot):
    """Return the smallest mass-weighted share of any of m modes within the space of their initial shapes."""
    gram, part, across = room[: m * m].reshape(m, m), room[m * m : m * (m + 1)], room[m * (m + 1) :]
    for i in range(m):
        _weighed(M, starts[own[i]], heavy[i])
        for j in range(m):
            gram[j, i] = _inner_product(starts[own[j]], heavy[i])
    factor(gram, m, pivot)
    least = 1.0
    for j in range(m):
        x = shapes[own[j]]
        for i in range(m):
            part[i] = np.conj(_inner_product(x, heavy[i]))
            across[i] = part[i]
        solve(gram, m, pivot, across)
        share = 0.0
        for i in range(m):
            share += (np.conj(part[i]) * across[i]).real
        _weighed(M, x, heavy[m])
        least = min(least, share / _inner_product(x, heavy[m]).real)
    return least


@compiled
def recognised(M, family, starts, values, shapes, least, same):
    """Return in which sets every mode lies in the space of its family's initial shapes, without duplicates.

    ``least`` is the smallest mass-weighted share within that space; poles nearer than ``same`` (relative)
    with parallel shapes are duplicates. Modes that are NaN are ignored.
    """
    n_sets, n_modes, n = shapes.shape
    good = np.ones(n_sets, np.bool_)
    heavy = np.empty((n_modes + 1, n), np.complex128)
    room, pivot = np.empty(n_modes * (n_modes + 2), np.complex128), np.empty(n_modes, np.int64)
    own = np.empty(n_modes, np.int64)
    for k in range(n_sets):
        first = 0
        while first < n_modes:
            m, last = _members(family, values[k], first, own)
            if m:
                good[k] &= _among(M, starts[k], shapes[k], own, m, heavy, room, pivot) >= least
            first = last
        for i in range(n_modes):
            for j in range(i):
                if abs(values[k, i] - values[k, j]) <= same * abs(values[k, i]):
                    good[k] &= abs(_inner_product(shapes[k, i], shapes[k, j])) < _PARALLEL
    return good


@inner
def _sort(own, m, values, shapes):
    """Put m modes in the order of |λ|."""
    for i in range(1, m):
        for j in range(i, 0, -1):
            if abs(values[own[j]]) < abs(values[own[j - 1]]):
                _exchange(values, shapes, own[j], own[j - 1])


@inner
def _name(like, own, m, values, shapes, alike):
    """Assign each of m modes of a family to the pinned mode that it resembles most.

    Starting from the order of |λ|, pairs of modes are exchanged until no exchange increases the sum of their
    resemblance, so that the result depends on the modes only, not on how they were found.
    """
    _sort(own, m, values, shapes)
    for j in range(m):
        for i in range(m):
            # shapes of one family have about the same modal mass, so that unit norm suffices
            alike[i, j] = abs(_product(shapes[own[j]], like[own[i]])) ** 2
    better = True
    while better:
        better = False
        for i in range(m):
            for j in range(i):
                now, then = alike[i, i] + alike[j, j], alike[i, j] + alike[j, i]
                if then > _CLEARLY * now:
                    _exchange(values, shapes, own[i], own[j])
                    for n in range(m):
                        alike[n, i], alike[n, j] = alike[n, j], alike[n, i]
                    better = True


@making
def _turn(like, own, m, values, shapes):
    """Rotate m modes of a multiple pole so that each contains its own pinned mode and none of the others.

    Modes that hardly resemble the pinned ones are not changed.
    """
    n = shapes.shape[1]
    part, pivot = np.empty((m, m), np.complex128), np.empty(m, np.int64)
    column, mixed = np.empty(m, np.complex128), np.zeros((m, n), np.complex128)
    largest, mean = 0.0, 0.0j
    for j in range(m):
        mean += values[own[j]] / m
        for i in range(m):
            part[i, j] = _product(shapes[own[j]], like[own[i]])
            largest = max(largest, abs(part[i, j]))
    if factor(part, m, pivot) == 0.0:
        return
    for i in range(m):
        for j in range(m):
            column[j] = largest if i == j else 0.0
        solve(part, m, pivot, column)
        for j in range(m):
            if not abs(column[j]) < _SKEWED:
                return
            for k in range(n):
                mixed[i, k] += column[j] * shapes[own[j], k]
    for i in range(m):
        _normalise(mixed[i])
        values[own[i]] = mean
        _assign(mixed[i], shapes[own[i]])


@compiled
def arrange(like, family, values, shapes, same):
    """Assign the modes of every family in every set to the pinned modes, in place.

    ``like`` (n_modes, n) is φᵀM of the pinned modes. Returns (n_sets, n_modes) the index of the first mode of
    the same multiple pole, that is, of poles nearer than ``same`` (relative).
    """
    n_sets, n_modes = values.shape
    number = np.empty((n_sets, n_modes), np.int64)
    own = np.empty(n_modes, np.int64)
    alike = np.empty((n_modes, n_modes))
    for k in range(n_sets):
        for i in range(n_modes):
            number[k, i] = i
        first = 0
        while first < n_modes:
            m, last = _members(family, values[k], first, own)
            if m > 1:
                _name(like, own, m, values[k], shapes[k], alike)
            for i in range(m):
                for j in range(i + 1, m):
                    near = abs(values[k, own[j]] - values[k, own[i]]) <= same * abs(values[k, own[i]])
                    if near and number[k, own[j]] == own[j]:
                        number[k, own[j]] = number[k, own[i]]
            first = last
    return number


@compiled
def turn(like, number, values, shapes):
    """Rotate the modes of the multiple poles numbered by :func:`arrange` to the pinned ones, in place."""
    n_sets, n_modes = values.shape
    own = np.empty(n_modes, np.int64)
    for k in range(n_sets):
        for i in range(n_modes):
            m = 0
            for j in range(i, n_modes):
                if number[k, j] == i:
                    own[m] = j
                    m += 1
            if m > 1:
                _turn(like, own, m, values[k], shapes[k])


@inner
def _forces(model, s, mu, s0, s1, x, forces):
    """Fill the forces S_g x of every group, then (∂F/∂a) x and (∂F/∂b) x."""
    P, w2 = model[3], model[4]
    group, row, column, weight = model[5], model[6], model[7], model[8]
    nb, nr = P.shape
    a, b = forces.shape[0] - 2, forces.shape[0] - 1
    for e in range(forces.shape[0]):
        for i in range(nb + nr):
            forces[e, i] = 0.0
    for e in range(group.size):
        forces[group[e], row[e]] += weight[e] * x[column[e]]
    p = 0
    for i in range(nb):
        for j in range(i, nb):
            da, db = s * s1[p], s * (s0[p] - mu * s1[p])
            forces[a, i] += da * x[j]
            forces[b, i] += db * x[j]
            if i != j:
                forces[a, j] += da * x[i]
                forces[b, j] += db * x[i]
            p += 1
    for j in range(nr):
        forces[a, nb + j] += s * x[nb + j]
        forces[b, nb + j] += s * w2[j] * x[nb + j]
        for i in range(nb):
            forces[a, i] += s * P[i, j] * x[nb + j]
            forces[a, nb + j] += s * P[i, j] * x[i]


@inner
def _loads(rows, s, jacobian, rayleigh_jacobian, forces, law, loads):
    """Fill −(∂F/∂z) x for every parameter z from the forces of the groups, of a and of b."""
    n_groups, width, n_z = jacobian.shape
    n = forces.shape[1]
    for z in range(n_z):
        for i in range(n):
            loads[z, i] = 0.0
    for g in range(n_groups + 2):
        if g < n_groups:
            law_derivatives(rows[g], s, law)
        for z in range(n_z):
            c = 0.0j
            if g < n_groups:
                for w in range(width):
                    c += law[w] * jacobian[g, w, z]
            else:
                c += rayleigh_jacobian[g - n_groups, z]
            if c != 0.0:
                for i in range(n):
                    loads[z, i] -= c * forces[g, i]


@inner
def _border(F, Y, X, bordered, pivot):
    """Factor [F, F′X; Xᴴ, 0] with Y = F′X, rows of Y and X being modes of one multiple pole."""
    m, n = X.shape
    _copy(F, n, bordered)
    for j in range(m):
        for i in range(m):
            bordered[n + i, n + j] = 0.0
        for i in range(n):
            bordered[i, n + j] = Y[j, i]
            bordered[n + j, i] = np.conj(X[j, i])
    factor(bordered, n + m, pivot)


@inner
def _bordered_solution(bordered, load, pivot, full, x):
    """Fill x with the solution of a factored bordered system under a load."""
    n = load.size
    for i in range(full.size):
        full[i] = load[i] if i < n else 0.0
    solve(bordered, full.size, pivot, full)
    for i in range(n):
        x[i] = full[i]


@compiled
def slopes(
    model, rows, rayleigh, which, multiple, values, vectors, jacobian, rayleigh_jacobian, dvalues, dvectors
):
    """Fill dλ/dz and dx/dz (without a component along x) for every mode and parameter z.

    ``jacobian`` (n_sets, n_groups, width, n_z) and ``rayleigh_jacobian`` (n_sets, 2, n_z) are the derivatives
    of the law rows and of (a, b) by z. With an empty ``dvectors`` only the slopes of the eigenvalues are
    computed. Neighbours with the same number in ``multiple`` (n_values,) are modes of one multiple pole.
    Their slopes are the diagonal of (Xᵀ F′X)⁻¹ Xᵀ(−∂F/∂z)X, whose sum does not depend on the choice of the
    vectors, and dx has no component along any of them.
    """
    n_values, n = vectors.shape
    n_pairs = model[0].shape[1]
    n_groups, width, n_z = jacobian.shape[1], jacobian.shape[2], jacobian.shape[3]
    F, dF = np.empty((n, n), np.complex128), np.empty((n, n), np.complex128)
    s0, s1 = np.empty(n_pairs, np.complex128), np.empty(n_pairs, np.complex128)
    law = np.empty(width, np.complex128)
    forces, loads = np.empty((n_groups + 2, n), np.complex128), np.empty((n_z, n), np.complex128)
    first = 0
    while first < n_values:
        last = first + 1
        while last < n_values and multiple[last] == multiple[first]:
            last += 1
        k, m, s, X = which[first], last - first, _mean(values[first:last]), vectors[first:last]
        mu = fill(model, rows[k], rayleigh[k, 0], rayleigh[k, 1], s, F, dF, s0, s1)
        Y, B, g = np.empty((m, n), np.complex128), np.empty((m, m), np.complex128), np.empty(m, np.complex128)
        small, pivot = np.empty(m, np.int64), np.empty(n + m, np.int64)
        bordered, full = np.empty((n + m, n + m), np.complex128), np.zeros(n + m, np.complex128)
        for j in range(m):
            times(dF, X[j], Y[j])
            for i in range(m):
                B[i, j] = _product(X[i], Y[j])
        factor(B, m, small)
        if dvectors.size:
            _border(F, Y, X, bordered, pivot)
        for j in range(m):
            _forces(model, s, mu, s0, s1, X[j], forces)
            _loads(rows[k], s, jacobian[k], rayleigh_jacobian[k], forces, law, loads)
            for z in range(n_z):
                for i in range(m):
                    g[i] = _product(X[i], loads[z])
                solve(B, m, small, g)
                dvalues[first + j, z] = g[j]
                if dvectors.size:
                    _bordered_solution(bordered, loads[z], pivot, full, dvectors[first + j, z])
        first = last


@inner
def _phase(model, rows, a, b, s, known, F, dF, G, s0, s1, pivot, place):
    """Return the phase of det F(s)/Π(s − p)(s − p̄) over the known poles p."""
    fill(model, rows, a, b, s, F, dF, s0, s1)
    left, phase = eliminate(F, model[4], place, G)
    phase *= factor(G, left, pivot)
    for p in known:
        away = (s - p) * (s - np.conj(p))
        phase *= np.conj(away) / abs(away)
    return phase


@inner
def _point(kind, u, radius, small):
    """Return a point of the path at u in [0, 1]: the great arc, the upper side of the cut, the small arc.

    The points of the great arc are denser towards the negative real axis, where multiple poles of the
    supports lie.
    """
    if kind == 0:
        return radius * np.exp(1j * np.pi * (1.0 - (1.0 - u) ** 2))
    if kind == 1:
        return complex(-radius * (small / radius) ** u, 0.0)
    return small * np.exp(1j * np.pi * (1.0 - u))


@compiled
def winding(model, rows, a, b, radius, cut, n_points, known):
    """Return the change of arg det F along the upper half circle in units of π, NaN if it meets a pole.

    Known poles are divided out, so that only unknown ones can change the phase rapidly, and added at the end.
    If there is a branch cut, the path returns along its upper side and around the origin.
    """
    n = model[3].shape[0] + model[3].shape[1]
    n_pairs = model[0].shape[1]
    F, dF, G = _matrices(n)
    s0, s1 = np.empty(n_pairs, np.complex128), np.empty(n_pairs, np.complex128)
    pivot, place = np.empty(n, np.int64), np.empty(model[4].size, np.int64)
    stop, phase = np.empty(_MAX_DEPTH + 2), np.empty(_MAX_DEPTH + 2, np.complex128)
    small = 1e-6 * radius
    total = 0.0
    for kind in range(3 if cut else 1):
        n_here = n_points if kind < 2 else 4
        u0 = 0.0
        here = _phase(
            model, rows, a, b, _point(kind, 0.0, radius, small), known, F, dF, G, s0, s1, pivot, place
        )
        for i in range(n_here):
            depth = 0
            stop[0] = (i + 1) / n_here
            s = _point(kind, stop[0], radius, small)
            phase[0] = _phase(model, rows, a, b, s, known, F, dF, G, s0, s1, pivot, place)
            while depth >= 0:
                turn = np.angle(phase[depth] * np.conj(here))
                if abs(turn) <= 0.7:
                    total += turn
                    here, u0 = phase[depth], stop[depth]
                    depth -= 1
                    continue
                if depth > _MAX_DEPTH:
                    return np.nan
                stop[depth + 1] = 0.5 * (u0 + stop[depth])
                s = _point(kind, stop[depth + 1], radius, small)
                phase[depth + 1] = _phase(model, rows, a, b, s, known, F, dF, G, s0, s1, pivot, place)
                depth += 1
    inside = 0
    for p in known:
        if abs(p) < radius:
            inside += 1
    return total / np.pi + 2.0 * inside


@compiled
def inertia(model, rows, a, b, points):
    """Return the number of negative eigenvalues of the real symmetric F at each point of the real axis."""
    w2 = model[4]
    n = model[3].shape[0] + w2.size
    n_pairs = model[0].shape[1]
    F, dF, G = _matrices(n)
    s0, s1 = np.empty(n_pairs, np.complex128), np.empty(n_pairs, np.complex128)
    place = np.empty(w2.size, np.int64)
    A = np.empty((n, n))
    count = np.zeros(points.size, np.int64)
    for m in range(points.size):
        fill(model, rows, a, b, complex(points[m], 0.0), F, dF, s0, s1)
        left, _ = eliminate(F, w2, place, G)
        for j in range(w2.size):
            if place[j] < 0 and F[n - w2.size + j, n - w2.size + j].real < 0.0:
                count[m] += 1
        for i in range(left):
            for j in range(left):
                A[i, j] = G[i, j].real
        for k in range(left):
            if A[k, k] < 0.0:
                count[m] += 1
            for i in range(k + 1, left):
                f = A[i, k] / A[k, k] if A[k, k] != 0.0 else 0.0
                for j in range(i, left):
                    A[i, j] -= f * A[k, j]
                    A[j, i] = A[i, j]
    return count
