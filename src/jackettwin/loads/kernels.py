"""Compiled loops of the loads: interpolation between levels, Morison's equation, blade elements.

All arguments are plain arrays, described where the functions are called.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator, call-overload"

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

_BLOCK = 64
"""Number of times per block, so that the data of a block fit in the processor's cache."""

_HOW: dict[str, Any] = {"error_model": "numpy", "fastmath": {"reassoc", "contract"}}
compiled = njit(cache=True, **_HOW)
"""Decorator of functions that are called from Python."""
inner = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **_HOW)
"""Decorator of functions called by compiled code only; without a Python wrapper a small kernel compiles in
half the time."""


@compiled
def between_levels(level, middle, half, nodes, fields, mixing, points, out):
    """Write mixing @ fields at a moving level to ``points`` of ``out`` (n_mixed, n_all_points, n_times).

    ``fields`` (n_fields, n_nodes, n_points, n_times) are given at the levels middle + nodes·half of each
    point and interpolated (Lagrange) to ``level`` (n_all_points, n_times); the other arrays are for all
    points too.
    """
    n_fields, n_nodes, n_points, n_times = fields.shape
    scale = _lagrange_scale(nodes)
    x, weight = np.empty(_BLOCK), np.empty((n_nodes, _BLOCK))
    value = np.empty((n_fields, _BLOCK))
    for p in range(n_points):
        at = points[p]
        for start in range(0, n_times, _BLOCK):
            n = min(_BLOCK, n_times - start)
            here = level[at, start : start + n]
            for t in range(n):
                x[t] = (here[t] - middle[at]) / half[at]
            _lagrange(x[:n], nodes, scale, weight)
            value[:, :n] = 0.0
            for f in range(n_fields):
                for j in range(n_nodes):
                    known = fields[f, j, p, start : start + n]
                    for t in range(n):
                        value[f, t] += weight[j, t] * known[t]
            _mix(mixing, value[:, :n], out[:, at, start : start + n])


@inner
def _lagrange(x, nodes, scale, weight):
    """Write the Lagrange weights of the nodes at every x to ``weight`` (n_nodes, ≥ n_x)."""
    for j in range(nodes.size):
        weight[j, : x.size] = scale[j]
        for i in range(nodes.size):
            if i != j:
                for t in range(x.size):
                    weight[j, t] *= x[t] - nodes[i]


@inner
def _mix(mixing, value, out):
    """Write mixing @ value (n_fields, n) to ``out`` (n_mixed, n)."""
    out[:] = 0.0
    for m in range(mixing.shape[0]):
        for f in range(value.shape[0]):
            for t in range(value.shape[1]):
                out[m, t] += mixing[m, f] * value[f, t]


@inner
def _lagrange_scale(nodes):
    """Return 1/Π(x_j − x_i) of every node."""
    scale = np.ones(nodes.size)
    for j in range(nodes.size):
        for i in range(nodes.size):
            if i != j:
                scale[j] /= nodes[j] - nodes[i]
    return scale


@compiled
def morison(drag, inertia, normal, u, du, length, out):
    """Write length·(drag |v| v + inertia a), with v and a normal to the member, (n_points, 3, n_times).

    ``drag`` (n_points,) is ½ρC_D D, ``inertia`` (n_points,) ρC_M πD²/4, ``length`` (n_points, n_times);
    ``u`` and ``du`` (3, n_points, n_times).
    """
    for p in range(u.shape[1]):
        N, c, m = normal[p], drag[p], inertia[p]
        for t in range(u.shape[2]):
            x, y, z = u[0, p, t], u[1, p, t], u[2, p, t]
            ax, ay, az = du[0, p, t], du[1, p, t], du[2, p, t]
            vx = N[0, 0] * x + N[0, 1] * y + N[0, 2] * z
            vy = N[1, 0] * x + N[1, 1] * y + N[1, 2] * z
            vz = N[2, 0] * x + N[2, 1] * y + N[2, 2] * z
            d = c * np.sqrt(vx * vx + vy * vy + vz * vz)
            wet = length[p, t]
            out[p, 0, t] = wet * (d * vx + m * (N[0, 0] * ax + N[0, 1] * ay + N[0, 2] * az))
            out[p, 1, t] = wet * (d * vy + m * (N[1, 0] * ax + N[1, 1] * ay + N[1, 2] * az))
            out[p, 2, t] = wet * (d * vz + m * (N[2, 0] * ax + N[2, 1] * ay + N[2, 2] * az))


@compiled
def blade_elements(
    along, across, own, station, scale, polar, first_alpha, alpha_step, shaft, hub, free,
    first, place, share, angle, wind, motion, out,
):  # fmt: skip
    """Write force and moment at the tower top, (n, 6), of blade elements in wind (n, n_places, 3).

    The wind at element e is the sum of ``share`` times the wind at ``place``, from ``first[e]`` to ``first[e
    + 1]``. ``along`` and ``across`` (6, n_elements) are the directions of chord and normal and their moments
    about the hub, before the rotor rotates by ``angle`` (n,) about ``shaft``. ``own`` (2, n_elements) is the
    flow along both due to rotation and wake, which is subtracted. ``scale`` is ½ρ c dr, ``motion`` (n, 6)
    that of the tower top.

    Wind, flow, lift and load of the elements are computed in separate loops, so that the second and the last
    are vectorised.
    """
    n = station.size
    turn, v, load = np.empty((3, 3)), np.empty(6), np.empty(6)
    seen, flow, at = np.empty((3, n)), np.empty((2, n)), np.empty(n)
    for k in range(wind.shape[0]):
        _turn(shaft, angle[k], turn)
        _to_rotor(turn, shaft, hub, free, motion[k], v)
        _seen_by_elements(wind[k], first, place, share, seen)
        if angle[k] != 0.0:
            for e in range(n):
                _back(turn, seen[:, e], seen[:, e])
        for e in range(n):
            x, y, z = seen[0, e] - v[0], seen[1, e] - v[1], seen[2, e] - v[2]
            chord = along[0, e] * x + along[1, e] * y + along[2, e] * z - own[0, e]
            chord -= along[3, e] * v[3] + along[4, e] * v[4] + along[5, e] * v[5]
            normal = across[0, e] * x + across[1, e] * y + across[2, e] * z - own[1, e]
            normal -= across[3, e] * v[3] + across[4, e] * v[4] + across[5, e] * v[5]
            at[e] = (_arctan2(normal, chord) - first_alpha) / alpha_step
            flow[0, e], flow[1, e] = chord, normal
        for e in range(n):
            low = min(max(int(at[e]), 0), polar.shape[1] - 2)
            high, s = at[e] - low, station[e]
            for i in range(2):
                seen[i, e] = polar[s, low, i] * (1.0 - high) + polar[s, low + 1, i] * high
        _summed(along, across, scale, seen, flow, load)
        _to_top(turn, shaft, hub, free, load, out[k])


@inner
def _seen_by_elements(wind, first, place, share, out):
    """Write the wind at elements (3, n_elements) from that at places (n_places, 3)."""
    for e in range(first.size - 1):
        x = y = z = 0.0
        for j in range(first[e], first[e + 1]):
            at, part = wind[place[j]], share[j]
            x += part * at[0]
            y += part * at[1]
            z += part * at[2]
        out[0, e], out[1, e], out[2, e] = x, y, z


@inner
def _summed(along, across, scale, polar, flow, out):
    """Write force and moment (6,) of all elements from their lift and drag coefficients and their flow."""
    a = b = c = d = e = f = 0.0
    for i in range(scale.size):
        x, y, lift, drag = flow[0, i], flow[1, i], polar[0, i], polar[1, i]
        speed = scale[i] * np.sqrt(x * x + y * y)
        p, q = speed * (drag * x - lift * y), speed * (lift * x + drag * y)
        a += p * along[0, i] + q * across[0, i]
        b += p * along[1, i] + q * across[1, i]
        c += p * along[2, i] + q * across[2, i]
        d += p * along[3, i] + q * across[3, i]
        e += p * along[4, i] + q * across[4, i]
        f += p * along[5, i] + q * across[5, i]
    out[0], out[1], out[2], out[3], out[4], out[5] = a, b, c, d, e, f


@inner
def _arctan2(y, x):
    """Return the angle of (x, y) to 2e-8 rad (Abramowitz & Stegun 1964, eq. 4.4.49), three times as fast."""
    low, high = min(abs(x), abs(y)), max(abs(x), abs(y))
    t = low / max(high, 1e-300)  # without a branch the loop is vectorised
    q = t * t
    p = 0.0429096138 + q * (-0.0161657367 + q * 0.0028662257)
    p = -0.1420889944 + q * (0.1065626393 + q * (-0.0752896400 + q * p))
    angle = t * (1.0 + q * (-0.3333314528 + q * (0.1999355085 + q * p)))
    angle = 0.5 * np.pi - angle if abs(y) > abs(x) else angle
    angle = np.pi - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@inner
def _to_rotor(turn, shaft, hub, free, motion, out):
    """Write the hub's velocity and angular velocity in the rotor's axes from the tower top's motion (6,)."""
    spin, at_hub = motion[3:], np.empty(3)
    _cross(spin, hub, at_hub)
    for i in range(3):
        at_hub[i] += motion[i]
    _back(turn, at_hub, out[:3])
    _back(turn, spin, out[3:])
    if free:
        about = spin[0] * shaft[0] + spin[1] * shaft[1] + spin[2] * shaft[2]
        for i in range(3):
            out[3 + i] -= about * shaft[i]


@inner
def _to_top(turn, shaft, hub, free, load, out):
    """Write force and moment at the tower top from those at the hub in the rotor's axes (6,)."""
    arm = np.empty(3)
    _times(turn, load[:3], out[:3])
    _times(turn, load[3:], out[3:])
    about = out[3] * shaft[0] + out[4] * shaft[1] + out[5] * shaft[2] if free else 0.0
    _cross(hub, out[:3], arm)
    for i in range(3):
        out[3 + i] += arm[i] - about * shaft[i]


@inner
def _turn(axis, angle, out):
    """Write the rotation by ``angle`` about a unit ``axis``."""
    cos, sin = np.cos(angle), np.sin(angle)
    for i in range(3):
        for j in range(3):
            out[i, j] = (1.0 - cos) * axis[i] * axis[j]
        out[i, i] += cos
    out[0, 1] -= sin * axis[2]
    out[0, 2] += sin * axis[1]
    out[1, 0] += sin * axis[2]
    out[1, 2] -= sin * axis[0]
    out[2, 0] -= sin * axis[1]
    out[2, 1] += sin * axis[0]


@inner
def _times(matrix, vector, out):
    for i in range(3):
        out[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]


@inner
def _back(matrix, vector, out):
    """Write matrixᵀ vector; ``out`` may be the same array as the vector."""
    x, y, z = vector[0], vector[1], vector[2]
    for i in range(3):
        out[i] = matrix[0, i] * x + matrix[1, i] * y + matrix[2, i] * z


@inner
def _cross(a, b, out):
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@compiled
def wind_on_blades(samples, azimuth, spoke, ring, ring_share, n_spokes):
    """Return the wind at blade elements (n_times, n_elements, 3) from samples on rings and spokes.

    ``samples`` (n_times, 1 + n_rings·n_spokes, 3) are those of the hub, then ring by ring. Element e is at
    the angle ``spoke`` (in spokes, without the azimuth) between rings ``ring`` and ``ring`` + 1; ring 0 is
    the hub.
    """
    n_times, n = azimuth.size, spoke.size
    out = np.zeros((n_times, n, 3))
    for t in range(n_times):
        for e in range(n):
            at = (spoke[e] + azimuth[t] * n_spokes / (2.0 * np.pi)) % n_spokes
            first = min(int(at), n_spokes - 1)
            share = at - first
            second = (first + 1) % n_spokes
            for side in range(2):
                r = ring[e] + side
                weight = ring_share[e] if side == 1 else 1.0 - ring_share[e]
                a = 0 if r == 0 else 1 + (r - 1) * n_spokes + first
                b = 0 if r == 0 else 1 + (r - 1) * n_spokes + second
                for i in range(3):
                    out[t, e, i] += weight * ((1.0 - share) * samples[t, a, i] + share * samples[t, b, i])
    return out
