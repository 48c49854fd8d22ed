r"""Time series of a random sea's motion at many points, by the fast Fourier transform.

The components of ``irregular_sea`` lie on the lines of a period T, so that every field is one inverse FFT a
point. Wheeler's stretching asks for fields at a level that moves: they are transformed at Chebyshev levels
across the range of each point and interpolated between these.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.loads.kernels import between_levels
from jackettwin.loads.waves import AirySea

LEVELS = 5
"""Chebyshev levels a point: 0.1 % of the particle motion under Hs = 8 m."""


class SeaSeries(NamedTuple):
    """Surface (n_times, n) [m], velocity and acceleration (n_times, n, 3) [m/s, m/s²]."""

    surface: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


def sea_series(
    sea: AirySea,
    points: FloatArray,
    *,
    period: float,
    n_times: int,
    scattered: ComplexArray | None = None,
) -> SeaSeries:
    """Return what ``sea`` does at points (n, 3) at ``n_times`` even times of one ``period`` [s].

    Parameters
    ----------
    scattered : (n, n_waves), optional
        What wide members make of every wave's acceleration (``diffraction.scattered``).

    Raises
    ------
    InputError
        If a component is not on a line of the period, or the times are too few for the shortest wave.
    """
    lines = _lines(sea, period, n_times)
    inertia = np.ones(1) if scattered is None else scattered
    along = np.outer(points[:, 0], np.cos(sea.direction)) + np.outer(points[:, 1], np.sin(sea.direction))
    steady = sea.amplitude * np.exp(1j * (sea.phase - sea.k * along))
    still = sea.stretching == "none"
    eta = np.zeros((n_times, points.shape[0])) if still else _transformed(steady, lines, n_times).T
    if sea.stretching != "wheeler":
        fields = _fields(sea, steady, points[:, 2], lines, n_times, inertia)
        both = np.einsum("mf,fpt->tpm", _mixing(sea), fields, optimize=True)
        return SeaSeries(eta, both[..., :3], both[..., 3:])
    level = np.minimum((points[:, 2] - eta) * sea.depth / (sea.depth + eta), 0.0)
    nodes = np.cos(np.pi * (np.arange(LEVELS) + 0.5) / LEVELS)
    middle, half = 0.5 * (level.max(0) + level.min(0)), 0.5 * np.ptp(level, axis=0) + 1e-9
    mixing = _mixing(sea)
    fields = np.empty((mixing.shape[1], LEVELS, points.shape[0], n_times))
    for j, node in enumerate(nodes):
        fields[:, j] = _fields(sea, steady, middle + node * half, lines, n_times, inertia)
    both = between_levels(level, middle, half, nodes, fields, mixing)
    return SeaSeries(eta, both[..., :3], both[..., 3:])


def _lines(sea: AirySea, period: float, n_times: int) -> IntArray:
    cycles = sea.omega * period / (2.0 * np.pi)
    lines = np.rint(cycles).astype(np.intp)
    if np.abs(cycles - lines).max() > 1e-6:
        raise InputError("the sea does not repeat with this period", field="period", value=period)
    if lines.max() >= n_times // 2:
        raise InputError(
            "too few times for the shortest wave",
            field="n_times",
            value=n_times,
            allowed=f"> {2 * int(lines.max()) + 2}",
        )
    return lines


def _mixing(sea: AirySea) -> FloatArray:
    """Return (6, n_fields): velocity and acceleration from the fields that were transformed."""
    if np.ptp(sea.direction) > 0.0:
        return np.eye(6)
    cos, sin = np.cos(sea.direction[0]), np.sin(sea.direction[0])
    return np.kron(np.eye(2), np.array([[cos, 0.0], [sin, 0.0], [0.0, 1.0]]))


def _fields(
    sea: AirySea,
    steady: ComplexArray,
    z: FloatArray,
    lines: IntArray,
    n_times: int,
    inertia: npt.NDArray[Any],
) -> FloatArray:
    """Return velocity, then acceleration, at one level a point, (n_fields, n_points, n_times).

    Waves of one direction have two components, along it and up; else three.
    """
    horizontal, vertical = sea.depth_functions(z)
    u, w = sea.omega * horizontal * steady, 1j * sea.omega * vertical * steady
    one = np.ptp(sea.direction) == 0.0
    components = [u, w] if one else [u * np.cos(sea.direction), u * np.sin(sea.direction), w]
    components += [1j * sea.omega * inertia * component for component in components]
    return np.array([_transformed(component, lines, n_times) for component in components])


def _transformed(amplitude: ComplexArray, lines: IntArray, n_times: int) -> FloatArray:
    """Return Σ Re(c e^{iωt}) (n, n_times) from amplitudes (n, n_waves)."""
    spectrum = np.zeros((amplitude.shape[0], n_times // 2 + 1), dtype=np.complex128)
    spectrum[:, lines] = 0.5 * n_times * amplitude
    return np.asarray(np.fft.irfft(spectrum, n=n_times, axis=1))
