"""The keys of a scenario file."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from jackettwin.decks import RnaSchema
from jackettwin.files import Placed, Schema
from jackettwin.files.limits import Angle, ForceCoefficient, Frequency, Height, Seed
from jackettwin.loads.aerodynamics.wind import TOWER_DRAG
from jackettwin.simulate.scenario.water_files import WaterSchema
from jackettwin.soil import CurveOptions, Layer, Radiation, Scour
from jackettwin.soil.foundation import FoundationDampingSchema, LinearSchema, PileSchema
from jackettwin.soil.laws.files import LawSchema

Ratio = Annotated[float, Field(ge=0.0, lt=1.0)]
Period = Annotated[float, Field(ge=0.5, le=100.0)]
"""Of a wave: shorter ones are ripples, longer ones tides [s]."""
SignificantHeight = Annotated[float, Field(gt=0.0, le=30.0)]
"""Of a random sea [m]."""
WindSpeed = Annotated[float, Field(gt=0.0, le=100.0)]
"""Mean at the hub [m/s]."""
Speed = Annotated[float, Field(ge=0.0, le=10.0)]
"""Of water [m/s]."""
Part = Annotated[float, Field(ge=-1e3, le=1e3)]
"""Of a direction; its length does not count."""


class StructureChoice(Schema):
    """A structure with overrides."""

    source: str
    rna: RnaSchema | None = None


class RayleighSchema(Schema):
    """Steel damping: a least ratio and where it stands."""

    ratio: Ratio
    frequency_hz: Frequency


class SteelDampingSchema(Schema):
    """``damping``: of the steel, and the ratio to which the tower is tuned in the coupled first modes."""

    rayleigh: RayleighSchema | None = None
    coupled: Annotated[float, Field(gt=0.0, lt=0.2)] | None = None


class GroundSchema(Schema):
    """``soil``: layers or linear ground, scour, which curves, and the ground's damping or law."""

    layers: list[Placed[Layer]] | None = Field(default=None, min_length=1)
    linear: LinearSchema | None = None
    scour: Placed[Scour] | None = None
    curves: Placed[CurveOptions] = CurveOptions()
    damping: FoundationDampingSchema | None = None
    law: LawSchema | None = None
    radiation: Placed[Radiation] | None = None
    hysteresis: bool = False


class WavesSchema(Schema):
    """``waves``: height and period of a regular wave, Hs and Tp of a random sea, or a file."""

    type: Literal["airy", "stokes5", "stream", "jonswap", "pierson-moskowitz", "elevation", "kinematics"]
    file: str | None = None
    celerity_m_s: Annotated[float, Field(gt=0.0, le=200.0)] | None = None
    height_m: Annotated[float, Field(gt=0.0, le=100.0)] | None = None
    period_s: Period | None = None
    hs_m: SignificantHeight | None = None
    tp_s: Period | None = None
    gamma: Annotated[float, Field(ge=1.0, le=10.0)] | None = None
    spreading: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    direction_deg: Angle = 0.0
    seed: Seed = 0
    stretching: Literal["none", "vertical", "extrapolated", "wheeler"] | None = None
    relative_velocity: Literal["none", "linearised", "full"] = "linearised"
    diffraction: Literal["none", "maccamy-fuchs"] = "none"


class CurrentSchema(Schema):
    """``current``."""

    subsurface_m_s: Speed = 0.0
    wind_driven_m_s: Speed = 0.0
    uniform_m_s: Speed = 0.0
    direction_deg: Angle = 0.0


class WindSchema(Schema):
    """``wind``: along +x; ``yaw_deg`` turns the nacelle anticlockwise from there."""

    speed_m_s: WindSpeed
    turbulence: Literal["A+", "A", "B", "C", "none"] | Annotated[float, Field(ge=0.0, le=1.0)] = "B"
    shear: Annotated[float, Field(ge=0.0, le=1.0)] = 0.14
    seed: Seed = 0
    yaw_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 0.0
    yaw_path: list[tuple[float, Angle]] | None = Field(default=None, min_length=2)
    tower_drag: ForceCoefficient = TOWER_DRAG
    coherence: Literal["all", "u"] | None = None
    piece_m: Annotated[float, Field(ge=1.0, le=200.0)] | None = None
    grid_m: Annotated[float, Field(ge=5.0, le=200.0)] | None = None


class RotorSchema(Schema):
    """``rotor``: a shipped windIO turbine, a file, or ``none``."""

    data: str = "iea15"
    state: Literal["parked", "idling", "operating"] = "parked"
    pitch_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 90.0
    azimuth_deg: Angle = 0.0


class TimeSchema(Schema):
    """``time``."""

    duration_s: Annotated[float, Field(gt=0.0, le=86400.0)] = 600.0
    step_s: Annotated[float, Field(ge=1e-4, le=1.0)] = 0.01
    discard_s: Annotated[float, Field(ge=0.0, le=86400.0)] = 0.0
    load_step_s: Annotated[float, Field(gt=0.0, le=1.0)] | None = None


class InstrumentSchema(Schema):
    """A sensor of the record, with its flaws in SI units."""

    channel: Annotated[str, Field(min_length=1)]
    node: str | None = None
    height_m: Height | None = None
    member: str | None = None
    position: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    direction: tuple[Part, Part, Part]
    quantity: Literal["acceleration", "velocity", "displacement", "inclination", "strain"] = "acceleration"
    frame: Literal["global", "nacelle"] = "global"
    noise: Annotated[float, Field(ge=0.0, le=1e3)] = 0.0
    bias: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    limit: Annotated[float, Field(gt=0.0, le=1e6)] | None = None
    dropouts_per_hour: Annotated[float, Field(ge=0.0, le=36e3)] = 0.0
    dropout_s: Annotated[float, Field(ge=1e-3, le=86400.0)] = 1.0


class ScenarioSchema(Schema):
    """A scenario file: the asset, then what happens to it.

    The ground is ``soil`` with ``piles``, or ``foundation`` (a file or a shipped name), or ``support``.
    """

    structure: str | StructureChoice
    rna: RnaSchema | None = None
    beam: Literal["euler-bernoulli", "timoshenko"] | None = None
    rotary_inertia: bool | None = None
    subdivide: Annotated[int, Field(ge=1, le=1000)] | None = None
    gravity: bool = False
    damping: SteelDampingSchema = SteelDampingSchema()
    soil: GroundSchema | None = None
    piles: PileSchema | None = None
    foundation: str | None = None
    support: str | None = None
    water: WaterSchema | None = None
    waves: WavesSchema | None = None
    current: CurrentSchema | None = None
    wind: WindSchema | None = None
    rotor: RotorSchema | None = None
    time: TimeSchema = TimeSchema()
    sensors: list[InstrumentSchema] = []
    sensor_seed: Seed = 0
