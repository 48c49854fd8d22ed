"""Sections of members in YAML: tubes, boxes, rectangles, I-sections, and any section by its properties."""

from __future__ import annotations

from math import inf
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from jackettwin.errors import located, require
from jackettwin.files import Schema
from jackettwin.structure import BeamSection, Section, i_section, rectangular_section

Side = Annotated[float, Field(ge=1e-4, le=1e3)]
"""Of a section [m]."""
Area = Annotated[float, Field(ge=1e-8, le=1e4)]
SecondMoment = Annotated[float, Field(ge=1e-14, le=1e6)]


class TubeSchema(Schema):
    """A circular tube."""

    shape: Literal["tube"] = "tube"
    outer_diameter_m: float
    thickness_m: float

    def build(self) -> Section:
        """Return the tube."""
        return Section(self.outer_diameter_m, self.thickness_m)


class BoxSchema(Schema):
    """A rectangular tube of even wall, ``width_m`` along the section's x, ``height_m`` along its y."""

    shape: Literal["box"]
    width_m: Side
    height_m: Side
    thickness_m: Side

    def build(self, poisson_ratio: float) -> BeamSection:
        """Return the section of a material's Poisson's ratio."""
        most = 0.5 * min(self.width_m, self.height_m)
        require(
            self.thickness_m < most,
            "the walls fill the box",
            field="thickness_m",
            value=self.thickness_m,
            allowed=f"< {most:g} m",
            remedy="give the wall in metres, or shape: rectangle",
        )
        return rectangular_section(self.width_m, self.height_m, self.thickness_m, poisson_ratio=poisson_ratio)


class RectangleSchema(Schema):
    """A solid rectangle, ``width_m`` along the section's x, ``height_m`` along its y."""

    shape: Literal["rectangle"]
    width_m: Side
    height_m: Side

    def build(self, poisson_ratio: float) -> BeamSection:
        """Return the section of a material's Poisson's ratio."""
        return rectangular_section(self.width_m, self.height_m, 0.0, poisson_ratio=poisson_ratio)


class ISchema(Schema):
    """An I of two equal flanges ``width_m`` wide along the section's x; ``height_m`` overall along its y."""

    shape: Literal["i"]
    width_m: Side
    height_m: Side
    flange_thickness_m: Side
    web_thickness_m: Side

    def build(self, poisson_ratio: float) -> BeamSection:
        """Return the section, which no Poisson's ratio changes."""
        for field, most in (
            ("flange_thickness_m", 0.5 * self.height_m),
            ("web_thickness_m", self.width_m),
        ):
            value = getattr(self, field)
            remedy = "give sides and plates in metres"
            require(
                value < most, "too thick", field=field, value=value, allowed=f"< {most:g} m", remedy=remedy
            )
        return i_section(self.width_m, self.height_m, self.flange_thickness_m, self.web_thickness_m)


class AnySchema(Schema):
    """Any section by its numbers about its principal axes; without shear areas it is stiff in shear."""

    shape: Literal["any"]
    area_m2: Area
    second_moment_x_m4: SecondMoment
    second_moment_y_m4: SecondMoment
    torsion_constant_m4: SecondMoment
    polar_moment_m4: SecondMoment | None = None
    shear_area_x_m2: Area | None = None
    shear_area_y_m2: Area | None = None

    def build(self, poisson_ratio: float) -> BeamSection:
        """Return the section, which no Poisson's ratio changes."""
        both = self.second_moment_x_m4 + self.second_moment_y_m4
        return BeamSection(
            A=self.area_m2,
            A_x=self.shear_area_x_m2 or inf,
            A_y=self.shear_area_y_m2 or inf,
            I_x=self.second_moment_x_m4,
            I_y=self.second_moment_y_m4,
            I_p=self.polar_moment_m4 or both,
            J=self.torsion_constant_m4,
        )


def _usual_shape(given: Any) -> Any:
    return {"shape": "tube"} | given if isinstance(given, dict) else given


SectionInFile = Annotated[
    Annotated[TubeSchema | BoxSchema | RectangleSchema | ISchema | AnySchema, Field(discriminator="shape")],
    BeforeValidator(_usual_shape),
]
"""A section by its ``shape``; without one it is a tube."""
SHAPES = {"box": "box", "rectangle": "rectangle", "i": "I-section", "any": "any section"}
"""Name of a beam's section, by its ``shape``."""


def build_tube(name: str, given: SectionInFile, *, remedy: str) -> Section:
    """Return a tube of a file.

    Raises
    ------
    InputError
        If it cannot be, or is another shape.
    """
    with located(field=f"sections.{name}"):
        require(isinstance(given, TubeSchema), "not a tube", field="shape", value=given.shape, remedy=remedy)
        assert isinstance(given, TubeSchema)
        return given.build()
