"""Wave loads as time series, projected on a few coordinates: resultants, modes or other shapes."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.loads.members.ends import Ends, end_forces
from jackettwin.loads.members.morison import MorisonPoints, above_bed, point_forces, wetness
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.diffraction import scattered
from jackettwin.loads.sea.given_kinematics import TravellingKinematics
from jackettwin.loads.sea.sea_series import sea_series
from jackettwin.loads.sea.waves import AirySea, Waves

_CHUNK = 48
"""Number of points per block, so that their fields fit in the processor's cache."""
_REGULAR_SAMPLES = 256
"""Number of times in one period of a regular wave."""


class WaveSeries(NamedTuple):
    """Periodic loads (n_times, n_columns) in steps of ``step_s``, and the water's velocity.

    ``sigma`` (n,) is the standard deviation of the water's velocity normal to the members at the points
    [m/s]; ``across`` (n_times, n, 3) is that velocity and ``wet`` (n_times, n) the wet share of the points,
    if requested.
    """

    loads: FloatArray
    step_s: float
    sigma: FloatArray
    across: FloatArray | None = None
    wet: FloatArray | None = None

    @property
    def period_s(self) -> float:
        """Time after which the loads repeat."""
        return float(self.step_s * self.loads.shape[0])


def resultant_columns(points: FloatArray) -> FloatArray:
    """Return the matrix (3n, 6) from forces at points (n, 3) to force and moment about the origin."""
    columns = np.zeros((points.shape[0], 3, 6))
    columns[:, :, :3] = np.eye(3)
    x, y, z = points.T
    columns[:, 2, 3], columns[:, 1, 3] = y, -z
    columns[:, 0, 4], columns[:, 2, 4] = z, -x
    columns[:, 1, 5], columns[:, 0, 5] = x, -y
    return columns.reshape(-1, 6)


def wave_series(
    grid: MorisonPoints,
    waves: Waves,
    columns: FloatArray,
    *,
    depth: float,
    period: float,
    step: float = 0.25,
    current: Current | None = None,
    ends: tuple[Ends, FloatArray] | None = None,
    keep_motion: bool = False,
    diffraction: bool = False,
) -> WaveSeries:
    """Return the loads of waves that are periodic with ``period`` [s].

    Parameters
    ----------
    columns : (3n, n_columns)
        Work of forces at the points on each coordinate: ``grid.N.T @ basis``, or ``resultant_columns``.
    depth : float
        Water depth [m]; nothing below the bed is loaded.
    step : float
        Longest time between samples of a random sea [s].
    ends : (Ends, (3n, n_columns)), optional
        Ends of members and the work of forces on them.
    keep_motion : bool
        Whether to return the water's motion at the points: 30 MB for ten minutes on a jacket.
    diffraction : bool
        Whether to include diffraction by the members (MacCamy & Fuchs); for Airy waves only.
    """
    random = isinstance(waves, AirySea) and waves.omega.size > 1
    many = random or isinstance(waves, TravellingKinematics)
    n_times = 2 * int(np.ceil(0.5 * period / step)) if many else _REGULAR_SAMPLES
    t = np.arange(n_times, dtype=np.float64) * (period / n_times)
    loads = np.zeros((n_times, columns.shape[1]))
    sigma = np.zeros(grid.weight.size)
    across = np.zeros((n_times, grid.weight.size, 3)) if keep_motion else None
    share = np.zeros((n_times, grid.weight.size)) if keep_motion else None
    for start in range(0, grid.weight.size, _CHUNK):
        here = slice(start, start + _CHUNK)
        part = some_points(grid, here)
        if isinstance(waves, AirySea) and (random or diffraction):
            wide = scattered(waves.k, part.diameter) if diffraction else None
            surface, u, du = sea_series(waves, part.points, period=period, n_times=n_times, scattered=wide)
        else:
            surface = waves.surface(part.points, t)
            u, du = waves.motion(part.points, t)
        if current is not None:
            u = u + current.velocity(part.points[:, 2])
        wet = wetness(part, surface) * above_bed(part, depth)
        if across is not None and share is not None:
            across[:, here], share[:, here] = np.einsum("nij,tnj->tni", part.normal, u), wet
        forces = point_forces(part, u, du, wet=wet)
        loads += forces.reshape(n_times, -1) @ columns[3 * start : 3 * start + 3 * part.weight.size]
        # the covariance of the water's velocity normal to the member
        spread = (u[::4] - u.mean(axis=0)).transpose(1, 2, 0)
        covariance = spread @ spread.swapaxes(1, 2) / spread.shape[2]
        sigma[here] = np.sqrt(0.5 * np.maximum(np.einsum("nij,nij->n", part.normal, covariance), 0.0))
    if ends is not None:
        on_ends = end_forces(ends[0], waves, t, current=current)
        loads += on_ends.reshape(n_times, -1) @ ends[1]
    return WaveSeries(loads, period / n_times, sigma, across, share)


def some_points(grid: MorisonPoints, here: slice) -> MorisonPoints:
    """Return a slice of the points."""
    N = sp.csr_array(grid.N[:, 3 * here.start : 3 * here.stop])
    rest = {f.name: getattr(grid, f.name)[here] for f in fields(grid) if f.name not in ("N", "density_kg_m3")}
    return replace(grid, N=N, **rest)
