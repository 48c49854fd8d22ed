r"""A rotor at work on a model of the motion: how it damps the tower, and how slow gusts push it.

A rotor whose files are known has the damping C (6, 6) of the tower top's motions at the first frequency, as
its blades' elements have it (`loads.operating_damping`). The same at the frequency of slow gusts is
how the thrust grows with the wind: a tower top that moves windward sees what a stronger wind brings. Gusts of
standard deviation σ over the disc then push by

.. math:: σ_F = 0.57\, C_{xx}(ω_{slow})\, σ

whatever accelerations say of a motion that they do not feel. Of a rotor that nobody described a usual ratio
is taken, whose dashpot tells the thrust, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import (
    OPERATING_LEAST_RATIO,
    OPERATING_LOG_STD,
    Control,
    Rotor,
    operating_damping,
    operating_point,
)
from jackettwin.sensing.motion_model import MotionModel
from jackettwin.sensing.wind_forces import gusts_std, with_thrust

_RATIO, _RATIO_LOG_STD = 0.08, 0.35
"""Fore-aft damping ratio that a working rotor adds to the first pair where nothing tells it: 4 to 13 %."""
_AVERAGED = 0.57
"""Gusts over a disc of 240 m over those at a point (IEC 61400-1 (2019), C.2)."""
_SLOW_HZ = 0.01
_WINDS_M_S = 1.0
"""Between winds in which a rotor is computed."""


@dataclass(frozen=True)
class RotorAtTop:
    """What a rotor at work does at the tower top in a wind, x with the wind.

    Attributes
    ----------
    damping : (6, 6) at the first frequency, symmetric [N·s/m, N·s, N·m·s]
    thrust_slope : of the thrust by the wind's speed in slow gusts [N·s/m]
    passing_hz : how often a blade passes; None if that is not known
    thrust_n : in the mean wind
    """

    damping: FloatArray
    thrust_slope: float
    passing_hz: float | None = None
    thrust_n: float = 0.0

    def towards(self, heading_rad: float) -> FloatArray:
        """Return the damping (6, 6) of a rotor whose wind blows towards a heading."""
        c, s = np.cos(heading_rad), np.sin(heading_rad)
        turn = np.kron(np.eye(2), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
        return np.asarray(turn @ self.damping @ turn.T)


@dataclass(frozen=True)
class RotorByWind:
    """A rotor whose files are known, in any wind.

    Attributes
    ----------
    rotor, control : its blades and set points
    first_hz : the first frequency of what it stands on
    shaft : "free" where the torque is held, "locked" where the speed is
    """

    rotor: Rotor
    control: Control
    first_hz: float
    shaft: str = "free"
    _computed: dict[int, RotorAtTop] = field(default_factory=dict, repr=False, compare=False)

    def at(self, wind_m_s: float) -> RotorAtTop:
        """Return what it does in a wind, straight between winds 1 m/s apart that are computed once."""
        low, high = self.control.wind_speeds_m_s or (3.0, 25.0)
        wind = min(max(wind_m_s, low), high)
        k = wind / _WINDS_M_S
        below = max(int(np.floor(k)), int(np.ceil(low / _WINDS_M_S)))
        above = max(min(below + 1, int(high / _WINDS_M_S)), below)
        share = min(max(k - below, 0.0), 1.0) if above > below else 0.0
        a, b, steady = self._at(below), self._at(above), operating_point(self.rotor, self.control, wind)
        return RotorAtTop(
            (1.0 - share) * a.damping + share * b.damping,
            (1.0 - share) * a.thrust_slope + share * b.thrust_slope,
            steady.rotor_speed * self.rotor.n_blades / (2.0 * np.pi),
            steady.thrust,
        )

    @property
    def hub(self) -> tuple[float, float, float]:
        """The hub from the tower top [m]."""
        x, y, z = self.rotor.hub
        return float(x), float(y), float(z)

    def _at(self, number: int) -> RotorAtTop:
        if number not in self._computed:
            operation = operating_point(self.rotor, self.control, number * _WINDS_M_S)
            first, slow = (
                operating_damping(self.rotor, operation, pole=2j * np.pi * f, shaft=self.shaft).damping
                for f in (self.first_hz, _SLOW_HZ)
            )
            self._computed[number] = RotorAtTop(0.5 * (first + first.T), float(slow[0, 0]))
        return self._computed[number]


def damped_at_work(
    model: MotionModel, rotor: RotorAtTop | None, heading_rad: float, away: float = 0.0
) -> MotionModel:
    """Return a model that a working rotor damps, ``away`` deviations in logarithm from what is expected."""
    if rotor is None:
        return model.with_dashpot(_RATIO * float(np.exp(_RATIO_LOG_STD * away)), heading_rad)
    factor = float(np.exp(OPERATING_LOG_STD["fore_aft"] * away))
    return model.with_damping_at_top(factor * rotor.towards(heading_rad), OPERATING_LEAST_RATIO)


def pushed_at_work(
    model: MotionModel, rotor: RotorAtTop | None, heading_rad: float, wind_m_s: float | None
) -> MotionModel:
    """Return a model whose rotor's slow gusts push as is expected; as it is in an unknown wind."""
    if wind_m_s is None:
        return model
    slope = model.dashpot(heading_rad) if rotor is None else rotor.thrust_slope
    thrust = slope * _AVERAGED * gusts_std(wind_m_s)
    return model.with_forces(with_thrust(model.forces, {"rotor Fx": thrust}))
