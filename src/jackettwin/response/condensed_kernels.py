"""The condensed F(λ), small dense linear algebra, and loops over many poles and points, compiled.

Everything here works on plain arrays. A condensed structure is the tuple ``model``

    terms (n_terms, n_pairs), n_moments, mid (n_mid,), P (n_b, n_r), w2 (n_r,),
    group, row, column, weight (n_entries,)

of :class:`jackettwin.response.condensed.Condensed`; a support law is a row of
:mod:`jackettwin.soil.coefficients`.

One file on purpose: compiled code on disk is renewed when its own file changes, whatever other file it calls.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit

# sums may be regrouped for speed, but signed zeros stay: they tell the sides of the branch cut apart
compiled = njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})

_MAX_STEPS = 30
_MAX_DEPTH = 24
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

    They only meet the boundary, not each other, unless a law acts all over the structure (water): then all
    stay. Those near their own resonance stay, too, for they would be poor pivots: ``place`` (n_retained,)
    says where in G, or −1.
    """
    nr = w2.size
    nb = F.shape[0] - nr
    m, phase = nb, 1.0 + 0.0j
    for i in range(1, nr):
        for j in range(i):
            if F[nb + i, nb + j] != 0.0:
                G[:, :] = F
                place[:] = np.arange(nb, nb + nr)
                return nb + nr, phase
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


@compiled
def _matrices(n):
    """Return room for F, dF/ds and what elimination leaves of F."""
    shape = (n, n)
    return np.empty(shape, np.complex128), np.empty(shape, np.complex128), np.empty(shape, np.complex128)


@compiled
def _normalise(x):
    size = 0.0
    for i in range(x.size):
        size += x[i].real ** 2 + x[i].imag ** 2
    x *= 1.0 / np.sqrt(size)


@compiled
def _bounded(step, s):
    """Return the step, no longer than a third of |s|."""
    size, most = abs(step), 0.3 * abs(s)
    return step * (most / size) if size > most else step


@compiled
def refine(model, rows, rayleigh, which, values, vectors, tolerance):
    """Refine starts in place by inverse iteration with the Rayleigh functional (cubic: F is symmetric).

    ``which`` (n_starts,) is the parameter set of each start. Returns (n_starts,) booleans: converged.
    """
    n = vectors.shape[1]
    n_pairs, w2 = model[0].shape[1], model[4]
    F, dF, G = _matrices(n)
    s0, s1 = np.empty(n_pairs, np.complex128), np.empty(n_pairs, np.complex128)
    u, y, room = np.empty(n, np.complex128), np.empty(n, np.complex128), np.empty(n, np.complex128)
    pivot, place = np.empty(n, np.int64), np.empty(w2.size, np.int64)
    done = np.zeros(values.size, np.bool_)
    for m in range(values.size):
        laws, a, b = rows[which[m]], rayleigh[which[m], 0], rayleigh[which[m], 1]
        x, s = vectors[m], values[m]
        _normalise(x)
        # the start's shape knows its pole better than its value does
        fill(model, laws, a, b, s, F, dF, s0, s1)
        step = times(F, x, y) / times(dF, x, y)
        if np.isfinite(abs(step)):
            s -= _bounded(step, s)
        for _ in range(_MAX_STEPS):
            fill(model, laws, a, b, s, F, dF, s0, s1)
            times(dF, x, y)
            left, _ = eliminate(F, w2, place, G)
            if factor(G, left, pivot) == 0.0:
                done[m] = True
                break
            u[:] = y
            solve_eliminated(F, place, G, left, pivot, u, room)
            top = 0.0j
            for i in range(n):
                top += u[i] * y[i]
            step = top / times(dF, u, y)
            _normalise(u)
            x[:] = u
            if not np.isfinite(abs(step)):
                break
            step = _bounded(step, s)
            s -= step
            if abs(step) <= tolerance * abs(s):
                done[m] = True
                break
        values[m] = s
    return done


@compiled
def _forces(model, s, mu, s0, s1, x, forces):
    """Fill the forces S_g x of every group, then (∂F/∂a) x and (∂F/∂b) x."""
    P, w2 = model[3], model[4]
    group, row, column, weight = model[5], model[6], model[7], model[8]
    nb, nr = P.shape
    a, b = forces.shape[0] - 2, forces.shape[0] - 1
    forces[:] = 0.0
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


@compiled
def _loads(rows, s, jacobian, rayleigh_jacobian, forces, law, loads):
    """Fill −(∂F/∂z) x for every parameter z from the forces of the groups, of a and of b."""
    n_groups, width, n_z = jacobian.shape
    n = forces.shape[1]
    loads[:] = 0.0
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


@compiled
def slopes(model, rows, rayleigh, which, values, vectors, jacobian, rayleigh_jacobian, dvalues, dvectors):
    """Fill dλ/dz and dx/dz (without a component along x) for every mode and parameter z.

    ``jacobian`` (n_sets, n_groups, width, n_z) and ``rayleigh_jacobian`` (n_sets, 2, n_z) say how the law
    rows and (a, b) depend on z. An empty ``dvectors`` asks for the eigenvalues alone.
    """
    n = vectors.shape[1]
    n_pairs = model[0].shape[1]
    n_groups, width, n_z = jacobian.shape[1], jacobian.shape[2], jacobian.shape[3]
    F, dF = np.empty((n, n), np.complex128), np.empty((n, n), np.complex128)
    s0, s1 = np.empty(n_pairs, np.complex128), np.empty(n_pairs, np.complex128)
    law = np.empty(width, np.complex128)
    forces, loads = np.empty((n_groups + 2, n), np.complex128), np.zeros((n_z, n + 1), np.complex128)
    bordered, pivot = np.zeros((n + 1, n + 1), np.complex128), np.empty(n + 1, np.int64)
    y = np.empty(n, np.complex128)
    for m in range(values.size):
        k, s, x = which[m], values[m], vectors[m]
        mu = fill(model, rows[k], rayleigh[k, 0], rayleigh[k, 1], s, F, dF, s0, s1)
        _forces(model, s, mu, s0, s1, x, forces)
        _loads(rows[k], s, jacobian[k], rayleigh_jacobian[k], forces, law, loads)
        scale = times(dF, x, y)
        for z in range(n_z):
            total = 0.0j
            for i in range(n):
                total += x[i] * loads[z, i]
            dvalues[m, z] = total / scale
        if dvectors.size == 0:
            continue
        # [F, F'x; xᴴ, 0] [dx; dλ] = [−(∂F/∂z)x; 0]
        bordered[:n, :n], bordered[:n, n], bordered[n, :n] = F, y, np.conj(x)
        bordered[n, n] = 0.0
        factor(bordered, n + 1, pivot)
        for z in range(n_z):
            solve(bordered, n + 1, pivot, loads[z])
            dvectors[m, z] = loads[z, :n]


@compiled
def _phase(model, rows, a, b, s, known, F, dF, G, s0, s1, pivot, place):
    """Return the phase of det F(s)/Π(s − p)(s − p̄) over the known poles p."""
    fill(model, rows, a, b, s, F, dF, s0, s1)
    left, phase = eliminate(F, model[4], place, G)
    phase *= factor(G, left, pivot)
    for p in known:
        away = (s - p) * (s - np.conj(p))
        phase *= np.conj(away) / abs(away)
    return phase


@compiled
def _point(kind, u, radius, small):
    """Return a point of the path at u in [0, 1]: the great arc, the upper side of the cut, the small arc.

    The great arc's points crowd towards the negative real axis, where multiple poles of the supports lie.
    """
    if kind == 0:
        return radius * np.exp(1j * np.pi * (1.0 - (1.0 - u) ** 2))
    if kind == 1:
        return complex(-radius * (small / radius) ** u, 0.0)
    return small * np.exp(1j * np.pi * (1.0 - u))


@compiled
def winding(model, rows, a, b, radius, cut, n_points, known):
    """Return the change of arg det F along the upper half circle in units of π, NaN if it runs over a pole.

    Known poles are divided out, so that only unknown ones can turn the phase fast, and counted in the end.
    With a branch cut the path returns along the upper side of the cut and around the origin.
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
