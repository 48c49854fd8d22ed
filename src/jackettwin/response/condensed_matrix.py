"""The condensed F(λ) itself and small dense linear algebra, compiled.

Everything here works on plain arrays. A condensed structure is the tuple ``model``

    terms (n_terms, n_pairs), n_moments, mid (n_mid,), P (n_b, n_r), w2 (n_r,),
    group, row, column, weight (n_entries,)

of :class:`jackettwin.response.condensed.Condensed`; a support law is a row of
:mod:`jackettwin.soil.coefficients`.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit

# sums may be regrouped for speed, but signed zeros stay: they tell the sides of the branch cut apart
compiled = njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})

_NEAR = 0.05
"""A retained mode whose diagonal is less than this share of its ω² is near its resonance."""


@compiled
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


@compiled
def law_derivatives(row, s, out):
    """Fill ∂D(s)/∂row."""
    out[:] = 0.0
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
def _structure(model, mu, s0, s1):
    """Fill S0(μ) and dS0/dμ, packed; return nothing."""
    terms, n_moments, mid = model[0], model[1], model[2]
    n_pairs = terms.shape[1]
    s0[:] = 0.0
    s1[:] = 0.0
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
    F[nb:, nb:] = 0.0
    dF[nb:, nb:] = 0.0
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


@compiled
def eliminate(F, w2, place, G):
    """Eliminate retained modes from F; return the size of what is left in G and the phase of their pivots.

    They only meet the boundary, not each other. Those near their own resonance stay, for they would be poor
    pivots: ``place`` (n_retained,) says where in G, or −1.
    """
    nr = w2.size
    nb = F.shape[0] - nr
    m, phase = nb, 1.0 + 0.0j
    G[:nb, :nb] = F[:nb, :nb]
    for j in range(nr):
        pivot = F[nb + j, nb + j]
        if abs(pivot) < _NEAR * w2[j]:
            place[j] = m
            G[:nb, m] = F[:nb, nb + j]
            G[m, :nb] = F[:nb, nb + j]
            G[m, nb:m], G[nb:m, m], G[m, m] = 0.0, 0.0, pivot
            m += 1
            continue
        place[j] = -1
        phase *= pivot / abs(pivot)
        inverse = 1.0 / pivot
        for i in range(nb):
            f = F[i, nb + j] * inverse
            for k in range(i, nb):
                G[i, k] -= f * F[k, nb + j]
    for i in range(nb):
        for k in range(i):
            G[i, k] = G[k, i]
    return m, phase


@compiled
def solve_eliminated(F, place, G, m, pivot, x, z):
    """Overwrite x with F⁻¹x from the factors of what :func:`eliminate` left; ``z`` is room for m numbers."""
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


@compiled
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


@compiled
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


@compiled
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
