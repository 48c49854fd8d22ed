r"""Time series of a random sea's motion at many points, by the fast Fourier transform.

The frequencies of ``irregular_sea`` are multiples of 1/T, so that every field is one inverse FFT per point.
Wheeler stretching needs fields at a moving level: they are computed at Chebyshev levels across the range of
each point and interpolated between these.
"""

from __future__ import annotations

from math import factorial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.fft import irfft

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.loads.kernels import between_levels
from jackettwin.loads.sea.waves import AirySea

LEVELS = 5
"""Largest number of Chebyshev levels per point; the error is 0.1 % of the particle motion for Hs = 8 m."""
_ERROR = 3e-4
"""Relative error of a point's acceleration that is accepted to use fewer levels."""


class SeaSeries(NamedTuple):
    """Surface (n_times, n) [m], velocity and acceleration (n_times, n, 3) [m/s, m/s²]."""

    surface: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


def sea_series(
    sea: AirySea, points: FloatArray, *, period: float, n_times: int, scattered: ComplexArray | None = None
) -> SeaSeries:
    """Return the motion of ``sea`` at points (n, 3) and ``n_times`` regular times of one ``period`` [s].

    Parameters
    ----------
    scattered : (n, n_waves), optional
        Factors of wide members on every wave's acceleration (``diffraction.scattered``).

    Raises
    ------
    InputError
        If a frequency is not a multiple of 1/period, or there are too few times for the shortest wave.
    """
    lines = _lines(sea, period, n_times)
    inertia = np.ones(1) if scattered is None else scattered
    steady = _steady(sea, points)
    still = sea.stretching == "none"
    eta = np.zeros((points.shape[0], n_times)) if still else _transformed(steady, lines, n_times)
    if sea.stretching != "wheeler":
        mixing = _mixing(sea)
        fields = np.empty((mixing.shape[1], points.shape[0], n_times))
        _fields(sea, steady, points[:, 2], lines, inertia, fields)
        return _series(eta, np.einsum("mf,fpt->mpt", mixing, fields, optimize=True))
    level = np.minimum((points[:, 2:] - eta) * sea.depth / (sea.depth + eta), 0.0)
    highest, lowest = level.max(axis=1), level.min(axis=1)
    middle, half = 0.5 * (highest + lowest), 0.5 * (highest - lowest) + 1e-9
    mixing, wanted = _mixing(sea), _levels(sea, middle, half)
    both = np.empty((6, points.shape[0], n_times))
    for number in np.unique(wanted):
        here = np.flatnonzero(wanted == number)
        nodes = np.cos(np.pi * (np.arange(number) + 0.5) / number)
        fields = np.empty((mixing.shape[1], number, here.size, n_times))
        extra = inertia if scattered is None else inertia[here]
        for j, node in enumerate(nodes):
            z = middle[here] + node * half[here]
            _fields(sea, steady[here], z, lines, extra, fields[:, j])
        between_levels(level, middle, half, nodes, fields, mixing, here, both)
    return _series(eta, both)


def _series(surface: FloatArray, both: FloatArray) -> SeaSeries:
    """Return views of surface (n, n_times), and velocity and acceleration (6, n, n_times), time first."""
    return SeaSeries(surface.T, both[:3].transpose(2, 1, 0), both[3:].transpose(2, 1, 0))


def surface_series(sea: AirySea, points: FloatArray, *, period: float, n_times: int) -> FloatArray:
    """Return the elevation (n_times, n) [m] at points (n, 3); arguments as in ``sea_series``."""
    return _transformed(_steady(sea, points), _lines(sea, period, n_times), n_times).T


def _steady(sea: AirySea, points: FloatArray) -> ComplexArray:
    """Return the complex amplitude of every wave at points, (n, n_waves)."""
    along = np.outer(points[:, 0], np.cos(sea.direction)) + np.outer(points[:, 1], np.sin(sea.direction))
    return np.asarray(sea.amplitude * np.exp(1j * (sea.phase - sea.k * along)))


def _levels(sea: AirySea, middle: FloatArray, half: FloatArray) -> IntArray:
    """Return the number of Chebyshev levels of each point; few suffice where the surface hardly moves.

    With n levels over a half range h, the interpolation error of a wave of number k is (kh/2)ⁿ 2/n!.
    """
    strength = (sea.amplitude * sea.omega**2) ** 2 * np.exp(
        2.0 * np.outer(np.minimum(middle + half, 0.0), sea.k)
    )
    total = strength.sum(axis=1)
    wanted = np.full(middle.size, LEVELS, dtype=np.intp)
    for n in range(LEVELS - 1, 1, -1):
        off = (2.0 / factorial(n) * (0.5 * np.outer(half, sea.k)) ** n) ** 2
        wanted[(strength * off).sum(axis=1) < _ERROR**2 * total] = n
    return wanted


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
    """Return the matrix (6, n_fields) from the transformed fields to velocity and acceleration."""
    if np.ptp(sea.direction) > 0.0:
        return np.eye(6)
    cos, sin = np.cos(sea.direction[0]), np.sin(sea.direction[0])
    return np.kron(np.eye(2), np.array([[cos, 0.0], [sin, 0.0], [0.0, 1.0]]))


def _fields(
    sea: AirySea,
    steady: ComplexArray,
    z: FloatArray,
    lines: IntArray,
    inertia: npt.NDArray[Any],
    out: FloatArray,
) -> None:
    """Write velocity, then acceleration, at one level per point to ``out`` (n_fields, n_points, n_times).

    Waves of one direction have two components, along it and vertical; others have three.
    """
    horizontal, vertical = sea.depth_functions(z)
    u, w = sea.omega * horizontal * steady, 1j * sea.omega * vertical * steady
    one = np.ptp(sea.direction) == 0.0
    components = [u, w] if one else [u * np.cos(sea.direction), u * np.sin(sea.direction), w]
    components += [1j * sea.omega * inertia * component for component in components]
    for field, component in zip(out, components, strict=True):
        field[:] = _transformed(component, lines, out.shape[2])


def _transformed(amplitude: ComplexArray, lines: IntArray, n_times: int) -> FloatArray:
    """Return Σ Re(c e^{iωt}) (n, n_times) from amplitudes (n, n_waves)."""
    spectrum = np.zeros((amplitude.shape[0], n_times // 2 + 1), dtype=np.complex128)
    spectrum[:, lines] = 0.5 * amplitude
    return np.asarray(irfft(spectrum, n=n_times, axis=1, norm="forward", overwrite_x=True))
