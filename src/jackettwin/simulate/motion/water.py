"""Waves and current on the asset: time series of loads, and drag on its own motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.loads import (
    AirySea,
    Ends,
    Kinematics,
    MorisonPoints,
    TravellingKinematics,
    Waves,
    WaveSeries,
    airy_wave,
    drag_damping,
    given_sea,
    irregular_sea,
    member_ends,
    morison_points,
    regular_wave,
    require_cover,
    surface_series,
    wave_number,
    wave_series,
)
from jackettwin.simulate.scenario.sea import Sea
from jackettwin.structure import Assembly

SPACING_M = 8.0
"""Longest piece of a member under a random sea: 0.2 % of the force's spread on the reference jacket."""
REGULAR_SPACING_M = 2.0
"""Longest piece under a regular wave, which is sampled over one period alone."""
THEORIES = {"stokes5": "stokes-5", "stream": "stream-function"}


@dataclass(frozen=True)
class WaterLoads:
    """Loads of waves and current, (n_times, n_columns), that repeat; and where they act."""

    series: WaveSeries
    grid: MorisonPoints
    waves: Waves | None

    def at(self, t: FloatArray) -> FloatArray:
        """Return the loads at times ``t`` [s]."""
        return self._between(self.series.loads, t)

    def elevation(self, t: FloatArray) -> FloatArray:
        """Return the elevation of the waves at the origin at times ``t`` [s]."""
        if self.waves is None:
            return np.zeros_like(t)
        n, origin = self.series.loads.shape[0], np.zeros((1, 3))
        if isinstance(self.waves, AirySea):
            known = surface_series(self.waves, origin, period=self.series.period_s, n_times=n)
        else:
            known = self.waves.elevation(origin, np.arange(n, dtype=np.float64) * self.series.step_s)
        return self._between(known, t)[:, 0]

    def _between(self, samples: FloatArray, t: FloatArray) -> FloatArray:
        """Return samples (n_times, n) at times ``t``, by a periodic cubic spline."""
        knots = np.arange(samples.shape[0] + 1) * self.series.step_s
        spline = CubicSpline(knots, np.vstack([samples, samples[:1]]), bc_type="periodic")
        return np.asarray(spline(np.mod(t, self.series.period_s)))


def wave_field(sea: Sea, *, duration: float) -> Waves | None:
    """Return the waves of a sea; a random one repeats after ``duration`` [s].

    Raises
    ------
    InputError
        If height, period and depth do not fit each other.
    """
    if sea.waves is None:
        return None
    H, T, stretching = sea.height_m, sea.period_s, sea.stretching
    where: dict[str, Any] = {"depth": sea.depth_m, "direction": sea.direction}
    if sea.waves == "airy":
        return airy_wave(height=H, period=T, stretching=stretching, **where)
    if sea.waves in THEORIES:
        return regular_wave(THEORIES[sea.waves], height=H, period=T, **where)
    if sea.kinematics is not None:
        return _travelling(sea, sea.kinematics, duration)
    where |= {"duration": duration, "stretching": stretching}
    if sea.elevation is not None:
        return given_sea(sea.elevation, **where)
    if duration < 2.0 * T:
        raise InputError(
            "too short for a random sea",
            field="time.duration_s",
            value=duration,
            allowed=f"≥ {2.0 * T:g} s, two peak periods",
        )
    return irregular_sea(Hs=H, Tp=T, seed=sea.seed, gamma=sea.gamma, spreading=sea.spreading, **where)


def _travelling(sea: Sea, given: Kinematics, duration: float) -> TravellingKinematics:
    require_cover(given.elevation, duration)
    omega = 2.0 * np.pi / sea.period_s
    c = sea.celerity_m_s or omega / float(wave_number(omega, sea.depth_m))
    return TravellingKinematics(given, duration, c, sea.direction, sea.coefficients.density_kg_m3)


def water_points(assembly: Assembly, sea: Sea, *, spacing: float | None = None) -> MorisonPoints:
    """Return the points of the members that waves can reach, pieces no longer than ``spacing`` [m]."""
    if spacing is None:
        spacing = REGULAR_SPACING_M if sea.regular else SPACING_M
    return morison_points(
        assembly, highest_z=sea.crest_m, lowest_z=-sea.depth_m, coefficients=sea.coefficients, spacing=spacing
    )


def water_ends(assembly: Assembly, sea: Sea) -> Ends | None:
    """Return the loaded ends of members; None if they have no coefficients."""
    if not sea.ends.any:
        return None
    return member_ends(assembly, sea.ends, sea.coefficients, highest_z=sea.crest_m, lowest_z=-sea.depth_m)


def water_loads(
    sea: Sea,
    grid: MorisonPoints,
    columns: FloatArray,
    *,
    duration: float,
    ends: tuple[Ends, FloatArray] | None = None,
    keep_motion: bool = False,
) -> WaterLoads | None:
    """Return loads on ``columns`` (3n, n_columns) of motion of the points; None in still water.

    A regular wave repeats after its own period, a random sea after ``duration`` [s]. ``ends`` come with
    columns of their own.
    """
    waves = wave_field(sea, duration=duration)
    if waves is None and sea.current is None:
        return None
    regular = sea.regular
    calm = airy_wave(height=0.0, period=10.0, depth=sea.depth_m)
    series = wave_series(
        grid,
        waves or calm,
        columns,
        depth=sea.depth_m,
        period=sea.period_s if regular else duration if waves is not None else 10.0,
        current=sea.current,
        ends=ends,
        keep_motion=keep_motion,
        diffraction=sea.diffraction and waves is not None,
    )
    return WaterLoads(series, grid, waves)


def relative_drag(grid: MorisonPoints, loads: WaterLoads, basis: FloatArray) -> FloatArray:
    """Return Borgman's damping (n, n) of drag on the structure's own motion, for the sea's own spread."""
    return np.asarray(basis.T @ (drag_damping(grid, loads.series.sigma) @ basis))


@dataclass(frozen=True)
class RelativeDrag:
    """Drag on the velocity of water less that of the members, thesis (2.2), beyond its linear part.

    Attributes
    ----------
    across : (n_times, n, 3) the water's velocity across the members, that repeats
    strength : (n_times, n) ½ρC_D D times the wet length
    motion : (3n, n_coordinates) velocity across the members from that of the coordinates
    linear : (n_coordinates, n_coordinates) damping that the model knows already
    """

    across: FloatArray
    strength: FloatArray
    step_s: float
    motion: FloatArray
    linear: FloatArray

    def change(self, t: float, velocity: FloatArray) -> FloatArray:
        """Return F(u − ẋ) − F(u) + C ẋ (n_coordinates,) at a time [s] and velocity of the coordinates."""
        at = t / self.step_s
        first = int(at)
        share, k = at - first, self.across.shape[0]
        low, high = first % k, (first + 1) % k
        u = (1.0 - share) * self.across[low] + share * self.across[high]
        strength = (1.0 - share) * self.strength[low] + share * self.strength[high]
        v = u - (self.motion @ velocity).reshape(-1, 3)
        speed, still = (np.sqrt(np.einsum("ni,ni->n", w, w)) for w in (v, u))
        force = (strength * speed)[:, None] * v - (strength * still)[:, None] * u
        return np.asarray(force.ravel() @ self.motion + self.linear @ velocity)


def relative_drag_beyond(
    grid: MorisonPoints, loads: WaterLoads, basis: FloatArray, linear: FloatArray
) -> RelativeDrag:
    """Return the part of relative drag that a damping matrix (n, n) does not tell.

    ``loads`` must have kept the water's motion.
    """
    series = loads.series
    assert series.across is not None and series.wet is not None
    n = grid.weight.size
    motion = np.asarray(grid.N.T @ basis).reshape(n, 3, -1)
    per_point = grid.drag_per_length * grid.weight
    return RelativeDrag(
        series.across,
        series.wet * per_point,
        series.step_s,
        np.einsum("nij,njk->nik", grid.normal, motion).reshape(3 * n, -1),
        linear,
    )
