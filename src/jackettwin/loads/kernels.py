"""Compiled loops of the loads: interpolation between levels, Morison's equation, blade elements.

Plain arrays in and out; what they mean stands where they are called.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit

compiled = njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})


@compiled
def between_levels(level, middle, half, nodes, fields, mixing):
    """Return mixing @ fields at a moving level, (n_times, n_points, n_mixed).

    ``fields`` (n_fields, n_nodes, n_points, n_times) are known at middle + nodes·half of each point;
    Lagrange interpolation to ``level`` (n_times, n_points).
    """
    n_fields, n_nodes, n_points, n_times = fields.shape
    out = np.zeros((n_times, n_points, mixing.shape[0]))
    weight, value = np.empty(n_nodes), np.empty(n_fields)
    for p in range(n_points):
        for t in range(n_times):
            _lagrange((level[t, p] - middle[p]) / half[p], nodes, weight)
            for f in range(n_fields):
                value[f] = 0.0
                for j in range(n_nodes):
                    value[f] += weight[j] * fields[f, j, p, t]
            for m in range(mixing.shape[0]):
                for f in range(n_fields):
                    out[t, p, m] += mixing[m, f] * value[f]
    return out


@compiled
def _lagrange(x, nodes, weight):
    for j in range(nodes.size):
        weight[j] = 1.0
        for i in range(nodes.size):
            if i != j:
                weight[j] *= (x - nodes[i]) / (nodes[j] - nodes[i])


@compiled
def morison(drag, inertia, normal, u, du, length, out):
    """Write length·(drag |v| v + inertia a), v and a normal to the member, (n_times, n_points, 3).

    ``drag`` (n_points,) is ½ρC_D D, ``inertia`` (n_points,) ρC_M πD²/4, ``length`` (n_times, n_points).
    """
    v, a = np.empty(3), np.empty(3)
    for t in range(u.shape[0]):
        for p in range(u.shape[1]):
            speed = 0.0
            for i in range(3):
                v[i] = a[i] = 0.0
                for j in range(3):
                    v[i] += normal[p, i, j] * u[t, p, j]
                    a[i] += normal[p, i, j] * du[t, p, j]
                speed += v[i] * v[i]
            speed = np.sqrt(speed)
            for i in range(3):
                out[t, p, i] = length[t, p] * (drag[p] * speed * v[i] + inertia[p] * a[i])


@compiled
def blade_elements(
    arm,
    chordwise,
    normal,
    station,
    scale,
    cl,
    cd,
    first_alpha,
    alpha_step,
    induced,
    shaft,
    hub,
    rotor_speed,
    free,
    azimuth,
    wind,
    motion,
    out,
):
    """Write force and moment at the tower top, (n, 6), of blade elements in wind (n, n_elements, 3).

    ``arm``, ``chordwise``, ``normal`` (n_elements, 3) stand at azimuth zero; ``azimuth`` (n,) turns them
    about ``shaft``. ``scale`` is ½ρ c dr; ``induced`` (n_elements, 2) axial and tangential; ``motion`` (n, 6)
    of the tower top.
    """
    turn = np.empty((3, 3))
    a, c, m, w = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    spin, at_hub = np.empty(3), np.empty(3)
    for k in range(wind.shape[0]):
        _turn(shaft, azimuth[k], turn)
        for i in range(3):
            spin[i] = motion[k, 3 + i]
        _cross(spin, hub, at_hub)
        about = spin[0] * shaft[0] + spin[1] * shaft[1] + spin[2] * shaft[2] if free else 0.0
        for i in range(3):
            at_hub[i] += motion[k, i]
            spin[i] += (rotor_speed - about) * shaft[i]
        total, moment = np.zeros(3), np.zeros(3)
        for e in range(arm.shape[0]):
            _times(turn, arm[e], a)
            _times(turn, chordwise[e], c)
            _times(turn, normal[e], m)
            _cross(spin, a, w)
            for i in range(3):
                w[i] = wind[k, e, i] - at_hub[i] - w[i] - induced[e, 0] * shaft[i]
            if induced[e, 1] != 0.0:
                t0 = shaft[1] * a[2] - shaft[2] * a[1]
                t1 = shaft[2] * a[0] - shaft[0] * a[2]
                t2 = shaft[0] * a[1] - shaft[1] * a[0]
                swirl = induced[e, 1] / np.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
                w[0] -= swirl * t0
                w[1] -= swirl * t1
                w[2] -= swirl * t2
            wc = w[0] * c[0] + w[1] * c[1] + w[2] * c[2]
            wn = w[0] * m[0] + w[1] * m[1] + w[2] * m[2]
            at = (np.arctan2(wn, wc) - first_alpha) / alpha_step
            low = min(max(int(at), 0), cl.shape[1] - 2)
            share, s = at - low, station[e]
            lift = cl[s, low] * (1.0 - share) + cl[s, low + 1] * share
            drag = cd[s, low] * (1.0 - share) + cd[s, low + 1] * share
            speed = scale[e] * np.sqrt(wc * wc + wn * wn)
            along, across = speed * (drag * wc - lift * wn), speed * (lift * wc + drag * wn)
            for i in range(3):
                w[i] = along * c[i] + across * m[i]
                total[i] += w[i]
            _cross(a, w, c)
            for i in range(3):
                moment[i] += c[i]
        about = moment[0] * shaft[0] + moment[1] * shaft[1] + moment[2] * shaft[2] if free else 0.0
        _cross(hub, total, c)
        for i in range(3):
            out[k, i] = total[i]
            out[k, 3 + i] = moment[i] - about * shaft[i] + c[i]


@compiled
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


@compiled
def _times(matrix, vector, out):
    for i in range(3):
        out[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]


@compiled
def _cross(a, b, out):
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@compiled
def wind_on_blades(samples, azimuth, spoke, ring, ring_share, n_spokes):
    """Return the wind at blade elements (n_times, n_elements, 3) from samples on rings and spokes.

    ``samples`` (n_times, 1 + n_rings·n_spokes, 3): the hub, then ring by ring. Element e sits at angle
    ``spoke`` (in spokes, azimuth not included) between rings ``ring`` and ``ring`` + 1; ring 0 is the hub.
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
