"""What is simulated: the asset, the sea, the wind, the turbine's state, the clock and the sensors."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import Wind
from jackettwin.loads.aerodynamics.bem import Control
from jackettwin.loads.aerodynamics.rotor import Rotor
from jackettwin.loads.aerodynamics.rotor_wind import PIECE_M
from jackettwin.loads.aerodynamics.turbulence import Coherent
from jackettwin.loads.aerodynamics.wind import TOWER_DRAG
from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.members.ends import EndCoefficients
from jackettwin.loads.members.water import Water
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.given_kinematics import Kinematics
from jackettwin.loads.sea.given_waves import Elevation
from jackettwin.response import Sensor
from jackettwin.soil import Support
from jackettwin.soil.foundation import Foundation
from jackettwin.structure import Rayleigh, Structure


@dataclass(frozen=True)
class Asset:
    """The structure on its supports."""

    structure: Structure
    support: Support
    beam: str | None = None
    rotary_inertia: bool | None = None
    subdivide: int | None = None
    gravity: bool = False
    rayleigh: Rayleigh = Rayleigh()
    support_text: str | None = None
    """The support as a short form, if it was given so: parameters that an update should find again."""
    coupled_damping: float | None = None
    """Damping ratio to which the tower is tuned: that of the first modes of the whole asset in still air."""
    foundation: Foundation | None = None
    """Piles whose ground unloads and reloads in time; None if it is the support's linear law."""


REGULAR = ("airy", "stokes5", "stream")
"""Types of waves that are one wave."""
_HIGHEST_WAVE = sqrt(0.5 * log(1000.0))
"""Of a random sea over Hs: the most probable highest of a thousand Rayleigh waves, 1.86."""


@dataclass(frozen=True)
class Sea:
    """Still water about the asset, its waves and current.

    ``height_m`` and ``period_s`` are H and T of a regular wave, Hs and Tp of a random sea.
    """

    depth_m: float
    coefficients: Coefficients
    water: Water | None = None
    """What moves with the structure, if its mass does not hold it already."""
    waves: str | None = None
    height_m: float = 0.0
    period_s: float = 0.0
    direction: float = 0.0
    seed: int = 0
    stretching: str = "none"
    gamma: float | None = None
    spreading: float | None = None
    relative_velocity: str = "linearised"
    """How drag knows the motion of the structure: ``none``, ``linearised`` or ``full``."""
    diffraction: bool = False
    current: Current | None = None
    ends: EndCoefficients = EndCoefficients()
    elevation: Elevation | None = None
    """Of waves that are given, from the start of what is discarded."""
    kinematics: Kinematics | None = None
    """Of waves whose whole motion is given; ``elevation`` is its own."""
    celerity_m_s: float | None = None
    """At which given kinematics travel; None is that of their peak period."""

    @property
    def regular(self) -> bool:
        """Whether the waves repeat after their own period."""
        return self.waves in REGULAR

    @property
    def highest_wave_m(self) -> float:
        """H of a regular wave, 1.86 Hs of a random sea, twice the highest crest of a given one [m]."""
        if self.elevation is not None:
            return 2.0 * float(self.elevation.eta_m.max())
        return self.height_m if self.regular else _HIGHEST_WAVE * self.height_m

    @property
    def crest_m(self) -> float:
        """Height over still water that no crest passes [m]: members below it are loaded."""
        return 1.2 * max(self.height_m, 0.5 * self.highest_wave_m)


GRID_M = 19.1
"""Between the nodes of the wind field that the OpenFAST records were made in [m]."""
_HEADINGS = 9
"""Over which the rotor's mean stiffness is averaged."""


@dataclass(frozen=True)
class Air:
    """Wind along +x; ``yaw`` is the nacelle's heading, anticlockwise from +x seen from above [rad]."""

    wind: Wind
    seed: int = 0
    yaw: float = 0.0
    """The mean heading of a path: at which the nacelle's mass stands."""
    yaw_path: tuple[tuple[float, float], ...] = ()
    """Time in the record [s], first to last, and heading [rad] of rotor and sensors; straight in between."""
    tower_drag: float = TOWER_DRAG
    coherent: Coherent = "all"
    """Which components of turbulence are coherent across rotor and tower."""
    piece_m: float = PIECE_M
    """Longest piece of a standing blade or of the tower with a wind of its own."""
    grid_m: float | None = None
    """Width of a grid whose nodes standing blades take their wind from instead."""

    def heading(self, t: FloatArray) -> FloatArray:
        """Return the nacelle's heading [rad] at times ``t`` [s] in the record."""
        if not self.yaw_path:
            return np.full(t.shape, self.yaw)
        at, yaw = np.transpose(self.yaw_path)
        return np.asarray(np.interp(t, at, yaw), dtype=np.float64)

    def headings(self) -> FloatArray:
        """Return headings [rad] that stand for the record, each for as much of it."""
        if not self.yaw_path:
            return np.array([self.yaw])
        first, last = self.yaw_path[0][0], self.yaw_path[-1][0]
        return self.heading(first + (last - first) * (np.arange(_HEADINGS) + 0.5) / _HEADINGS)


@dataclass(frozen=True)
class Turbine:
    """The rotor and what it does: parked (shaft locked), idling (shaft free) or operating."""

    rotor: Rotor
    control: Control
    state: str = "parked"
    pitch: float = 0.5 * pi
    azimuth: float = 0.0
    name: str = ""
    assumed: bool = False
    """Whether nobody chose the rotor."""


@dataclass(frozen=True)
class SimulationClock:
    """Length of the record, what is thrown away before it, and both steps [s]."""

    duration_s: float = 600.0
    step_s: float = 0.01
    discard_s: float = 0.0
    load_step_s: float = 0.05
    """Loads are evaluated this often and run straight between; a multiple of ``step_s``."""

    @property
    def total_s(self) -> float:
        """Simulated time [s]; wind and waves repeat after it."""
        return self.duration_s + self.discard_s


@dataclass(frozen=True)
class Instrument:
    """A sensor and its flaws.

    Attributes
    ----------
    sensor : Sensor
        ``direction`` is in global axes, or in the nacelle's if ``on_nacelle``.
    quantity : ``acceleration``, ``velocity``, ``displacement``, ``inclination`` or ``strain``
    noise : standard deviation of white noise, in SI units of the quantity
    bias : constant error
    limit : readings are clipped at ± this
    dropouts_per_hour, dropout_s : how often readings are missing, and for how long on average
    """

    sensor: Sensor
    quantity: str = "acceleration"
    on_nacelle: bool = False
    noise: float = 0.0
    bias: float = 0.0
    limit: float | None = None
    dropouts_per_hour: float = 0.0
    dropout_s: float = 1.0


@dataclass(frozen=True)
class Scenario:
    """One simulation, checked and in SI units; None is calm."""

    name: str
    path: Path
    asset: Asset
    sea: Sea | None
    air: Air | None
    turbine: Turbine | None
    clock: SimulationClock
    instruments: tuple[Instrument, ...]
    sensor_seed: int = 0

    @property
    def heading_rad(self) -> float:
        """Mean heading of the nacelle, anticlockwise from x seen from above; zero in calm."""
        return 0.0 if self.air is None else self.air.yaw
