"""The environment and the turbine's state during one record."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from jackettwin.errors import InputError
from jackettwin.loads.current import Current
from jackettwin.loads.waves import AirySea, irregular_sea
from jackettwin.loads.wind import Wind

STATES = ("parked", "idling", "operating")


@dataclass(frozen=True)
class SeaState:
    """A JONSWAP sea: Hs [m], Tp [s], heading from +x [rad]; the rest as in ``irregular_sea``."""

    Hs: float
    Tp: float
    direction: float = 0.0
    gamma: float | None = None
    spreading: float | None = None

    def waves(self, *, depth: float, duration: float, seed: int) -> AirySea:
        """Return the sea's random waves."""
        return irregular_sea(
            Hs=self.Hs,
            Tp=self.Tp,
            depth=depth,
            duration=duration,
            seed=seed,
            gamma=self.gamma,
            direction=self.direction,
            spreading=self.spreading,
        )


@dataclass(frozen=True)
class Conditions:
    """Wind, sea, current and the turbine's state; None is calm.

    Parked: the shaft is locked. Idling: it turns freely, feathered. Operating: the controller's point.
    Wind blows along +x; ``yaw_error`` [rad] is its heading seen from the nacelle.
    """

    wind: Wind | None = None
    sea: SeaState | None = None
    current: Current | None = None
    state: str = "parked"
    pitch: float = 0.5 * pi
    azimuth: float = 0.0
    yaw_error: float = 0.0

    def __post_init__(self) -> None:
        if self.state not in STATES:
            raise InputError(
                "unknown turbine state", field="state", value=self.state, allowed=", ".join(STATES)
            )
        if self.state == "operating" and self.wind is None:
            raise InputError("an operating turbine needs wind", field="wind", remedy="state its speed")

    @property
    def shaft(self) -> str:
        """``locked`` or ``free``, as the rotor needs it."""
        return "free" if self.state == "idling" else "locked"
