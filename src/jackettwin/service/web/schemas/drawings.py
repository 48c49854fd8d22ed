"""Schemas of curves, surfaces and structures to draw."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field, computed_field

Drawn = list[float | None]
"""Values of a curve; null for missing ones."""


def _words(parameter: str) -> str:
    """Return a parameter's name as text; what it needs is loaded with the first answer, not at the start."""
    from jackettwin.soil import parameter_words

    return parameter_words(parameter)


class BranchOut(BaseModel):
    """Locus of one mode along a parameter; null where it does not oscillate.

    At the medians measured modes have the reported frequencies; damping is of the sources in the model.
    """

    mode: int
    label: str
    pole_real_rad_s: Drawn
    pole_imag_rad_s: Drawn
    frequency_hz: Drawn
    damping_ratio: Drawn
    most_damped_at: float | None
    most_damping_ratio: float | None


class LocusOut(BaseModel):
    """The root locus along a parameter; ``origin`` is the index of the explored point among its values."""

    parameter: str
    unit: str
    values: list[float]
    origin: int
    branches: list[BranchOut]

    @computed_field  # type: ignore[prop-decorator]
    @property
    def words(self) -> str:
        """The parameter's name as text."""
        return _words(self.parameter)


class AxisOut(BaseModel):
    """Values of a parameter along an axis."""

    parameter: str
    values: list[float]


class SurfaceOut(BaseModel):
    """The cost over two parameters, a row for each value of y."""

    x: AxisOut
    y: AxisOut
    cost: list[Drawn]


class CurveOut(BaseModel):
    """The cost as one parameter is multiplied by factors."""

    parameter: str
    value: float
    factor: list[float]
    cost: Drawn


class ExploredValue(BaseModel):
    """A parameter at the explored point, and its bounds."""

    name: str
    unit: str
    value: float
    low: float
    high: float

    @computed_field  # type: ignore[prop-decorator]
    @property
    def words(self) -> str:
        """Its name as text."""
        return _words(self.name)


class ExploredOut(BaseModel):
    """Effect of the law's parameters on cost and modes around their medians; empty before an update."""

    law: str | None = None
    parameters: list[ExploredValue] = []
    loci: list[LocusOut] = []
    surface: SurfaceOut | None = None
    curves: list[CurveOut] = []


class LawParameterOut(BaseModel):
    """A parameter of a law, and the bounds between which it is sought."""

    name: str
    words: str
    unit: str
    low: float
    high: float


class LawFamilyOut(BaseModel):
    """A support law that the server knows; ``name:parameter=value,…`` is one of it."""

    name: str
    words: str
    parameters: list[LawParameterOut]


class LawOut(BaseModel):
    """A support law over frequency and time: D(2πif) = storage + i·loss, and its answer to steps.

    ``creep`` is null of a law that cannot carry a force.
    """

    law: str
    frequency_hz: list[float]
    storage_n_m: Drawn
    loss_n_m: Drawn
    loss_factor: Drawn
    time_s: list[float]
    creep_m_n: Drawn
    relaxation_n_m: Drawn


class PlaceOut(BaseModel):
    """A sensor's place at rest [m], z above the mean sea level, and the nearest node."""

    at: list[float]
    node: int


class MeasuredShapeOut(BaseModel):
    """Displacements of the sensors in a mode, x, y, z of each, on the shapes of the motion."""

    places: list[PlaceOut]
    shapes: list[list[float]]


class MotionOut(BaseModel):
    """A motion: displacements of the nodes (x, y, z of each) by shape times the coordinates of each frame."""

    name: str
    note: str
    group: str
    shapes: list[list[float]]
    q: list[list[float]]
    step_s: float
    start_s: float
    cyclic: bool
    largest_m: float | None
    measured: MeasuredShapeOut | None
    stress: list[list[float]] | None = Field(
        default=None,
        description="N/A, My/W and Mz/W [MPa] of each shape at both ends of every element; per metre.",
    )


class ColourOut(BaseModel):
    """A number for every element to colour by; ``log`` spreads values that span decades."""

    name: str
    unit: str
    log: bool
    from_zero: bool
    values: list[float | None]


class StructureOut(BaseModel):
    """A structure to draw: nodes (x, y, z of each [m], z above sea level), elements, colours, motions.

    Empty until supports have been updated.
    """

    title: str = ""
    nodes: list[float] = []
    start: list[int] = []
    end: list[int] = []
    diameter: list[float] = Field(default=[], description="[m]")
    growth: list[float] = Field(default=[], description="[m]")
    flooded: list[int] = []
    text: list[str] = []
    quantities: list[ColourOut] = []
    motions: list[MotionOut] = []
    sensors: list[dict[str, Any]] = []
    masses: list[dict[str, Any]] = []
    others: list[dict[str, Any]] = []
    dimensions: dict[str, Any] = {}
    mud_z: float = 0.0
