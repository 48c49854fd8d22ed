"""One simulation: the asset, the sea, the wind, the turbine's state, the clock and the sensors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from jackettwin.errors import InputError, require
from jackettwin.files import Height, one_of
from jackettwin.response import Sensor, sensor_kinds
from jackettwin.simulate.scenario.air import Air, Turbine
from jackettwin.simulate.scenario.asset import Asset
from jackettwin.simulate.scenario.pushes import GivenForces, Pull
from jackettwin.simulate.scenario.sea import Sea

_MOST_SAMPLES = 1e7
_LONGEST_LOAD_STEP_S = 0.05
_MOTION = ("acceleration", "velocity", "displacement")
"""Quantities of sensors that see motion."""
Part = Annotated[float, Field(ge=-1e3, le=1e3)]
"""Of a direction; its length does not count."""


@dataclass(frozen=True)
class SimulationClock:
    """``time`` of a scenario: length of the record, what is thrown away before it, and both steps [s].

    Loads are evaluated every ``load_step_s`` and run straight between: a multiple of ``step_s``, by default
    the longest up to 0.05 s.
    """

    duration_s: Annotated[float, Field(gt=0.0, le=86400.0)] = 600.0
    step_s: Annotated[float, Field(ge=1e-4, le=1.0)] = 0.01
    discard_s: Annotated[float, Field(ge=0.0, le=86400.0)] = 0.0
    load_step_s: Annotated[float, Field(gt=0.0, le=1.0)] = 0.0

    def __post_init__(self) -> None:
        h = self.step_s
        load = self.load_step_s or max(h, h * int(_LONGEST_LOAD_STEP_S / h + 1e-9))
        object.__setattr__(self, "load_step_s", load)
        for field, unit in (("load_step_s", h), ("duration_s", load), ("discard_s", load)):
            value = getattr(self, field)
            require(
                abs(value / unit - round(value / unit)) <= 1e-6 and (value >= unit or field == "discard_s"),
                "must be a whole number of steps",
                field=field,
                value=value,
                allowed=f"multiples of {unit:g} s",
                remedy="change it, or step_s and load_step_s",
            )
        samples = self.total_s / h
        require(
            samples <= _MOST_SAMPLES,
            "too many samples",
            field="step_s",
            value=h,
            allowed=f"{_MOST_SAMPLES:.0e} steps: ≥ {h * samples / _MOST_SAMPLES:.3g} s for this duration",
            remedy="take longer steps or a shorter record",
        )

    @property
    def total_s(self) -> float:
        """Simulated time [s]; wind and waves repeat after it."""
        return self.duration_s + self.discard_s


def _quantities() -> tuple[str, ...]:
    """Return what a simulated sensor can measure."""
    return (*_MOTION, *(name for name in sensor_kinds() if name != "motion"))


@dataclass(frozen=True)
class Instrument:
    """A sensor of the record and its flaws, in SI units of its quantity.

    Attributes
    ----------
    direction : (3,) in global axes, or in the nacelle's if that is the ``frame``
    quantity : a kind of motion, or a kind of sensor that sees something else
    noise : standard deviation of white noise
    bias : constant error
    limit : readings are clipped at ± this
    dropouts_per_hour, dropout_s : how often readings are missing, and for how long on average
    """

    channel: Annotated[str, Field(min_length=1)]
    direction: tuple[Part, Part, Part]
    node: str | None = None
    height_m: Height | None = None
    member: str | None = None
    position: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    quantity: Annotated[str, one_of(_quantities)] = "acceleration"
    frame: Literal["global", "nacelle"] = "global"
    noise: Annotated[float, Field(ge=0.0, le=1e3)] = 0.0
    bias: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    limit: Annotated[float, Field(gt=0.0, le=1e6)] | None = None
    dropouts_per_hour: Annotated[float, Field(ge=0.0, le=36e3)] = 0.0
    dropout_s: Annotated[float, Field(ge=1e-3, le=86400.0)] = 1.0

    @property
    def sensor(self) -> Sensor:
        """Where it sits and what it sees."""
        kind = "motion" if self.quantity in _MOTION else self.quantity
        return Sensor(
            self.channel, self.direction, self.node, self.height_m, self.member, self.position, kind
        )

    @property
    def on_nacelle(self) -> bool:
        """Whether it turns with the nacelle."""
        return self.frame == "nacelle"

    @property
    def recorded_as(self) -> str:
        """Quantity of its channel in the record."""
        return self.quantity if self.quantity in _MOTION else sensor_kinds()[self.quantity].recorded_as


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
    forces: GivenForces | None = None
    """On nodes, from a file."""
    pull: Pull | None = None
    """A node that is pulled aside and let go."""

    @property
    def pushed_nodes(self) -> tuple[str, ...]:
        """Nodes that forces act on which the scenario gives itself."""
        nodes = [] if self.forces is None else [*self.forces.nodes]
        return tuple(dict.fromkeys([*nodes, *([] if self.pull is None else [self.pull.node])]))

    @property
    def heading_rad(self) -> float:
        """Mean heading of the nacelle, anticlockwise from x seen from above; zero in calm."""
        return 0.0 if self.air is None else self.air.yaw


_KEYS = {
    "Hs": "waves.hs_m",
    "Tp": "waves.tp_s",
    "height": "waves.height_m",
    "period": "waves.period_s",
    "theory": "waves.type",
    "depth": "water.depth_m",
    "flooded": "water.flooded",
}
"""Names of the sea's values, and those of a scenario's keys."""


@contextmanager
def in_words_of(scenario: Scenario) -> Iterator[None]:
    """Fill file and key of every input error raised inside."""
    try:
        yield
    except InputError as error:
        field = _KEYS.get(error.field or "", error.field)
        raise type(error)(
            error.problem,
            file=error.file or scenario.path,
            field=field,
            value=error.value,
            allowed=error.allowed,
            remedy=error.remedy,
        ) from None
