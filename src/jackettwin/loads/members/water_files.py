"""``water`` of a scenario: coefficients of members, marine growth, flooded members."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import Field

from jackettwin.constants import SEA_WATER_KG_M3
from jackettwin.errors import InputError, located, require
from jackettwin.files import ForceCoefficient, Height, Placed, Schema
from jackettwin.loads.members.coefficients import (
    Coefficients,
    GrowthBand,
    Strip,
    StripTable,
    growth_bands,
    require_members,
)
from jackettwin.loads.members.ends import EndCoefficients
from jackettwin.loads.members.hydrodyn_deck import read_hydrodyn
from jackettwin.loads.members.water import Water
from jackettwin.structure import GROWTH_KG_M3, PILES, Structure

_GAP_M = 5.0
"""Largest height of feet above the bed, e.g. at the top of protruding piles."""
Growth = Annotated[float, Field(ge=500.0, le=5000.0)]
"""Density of marine growth [kg/m³]."""


class GrowthSchema(Schema):
    """Marine growth: a band of one thickness, or one height of a table; heights from still water."""

    top_z_m: Height | None = None
    bottom_z_m: Height | None = None
    z_m: Height | None = None
    thickness_m: Annotated[float, Field(ge=0.0, le=2.0)]
    density: Growth | None = None


class StripSchema(Schema):
    """C_D, C_a and C_p, where they differ from the general ones."""

    drag: ForceCoefficient | None = None
    added_mass: ForceCoefficient | None = None
    pressure: ForceCoefficient | None = None


class HeightSchema(StripSchema):
    """Coefficients at one height from still water, ``with_growth`` those of a covered member."""

    z_m: Height
    with_growth: StripSchema | None = None


class TableSchema(Schema):
    """Coefficients over the height, of some members or parts or of all."""

    members: list[str] = []
    at: list[HeightSchema] = Field(min_length=1)


class WaterSchema(Schema):
    """``water``: coefficients of all members, tables for some (C_M = C_p + C_a), growth and flooding."""

    depth_m: Annotated[float, Field(ge=1.0, le=1000.0)] | None = None
    density: Annotated[float, Field(ge=500.0, le=2000.0)] = SEA_WATER_KG_M3
    drag: ForceCoefficient = 1.0
    added_mass: ForceCoefficient = 1.0
    pressure: ForceCoefficient = 1.0
    with_growth: StripSchema = StripSchema()
    coefficients: list[TableSchema] = []
    marine_growth: list[GrowthSchema] = []
    growth_density: Growth = GROWTH_KG_M3
    flooded: bool | list[str] = []
    ends: Placed[EndCoefficients] = EndCoefficients()
    """Axial coefficients at the ends of members (HydroDyn's AxCp, AxCa, AxCd)."""
    hydrodyn: str | None = None
    """HydroDyn input file from which all this is read, except depth, density and ``adds_mass``."""
    adds_mass: bool | None = None


class Members(NamedTuple):
    """Hydrodynamic properties of members: coefficients, those of their ends, flooded members.

    ``adds_mass`` tells whether growth and water are added to the mass; else the structure's mass includes
    them.
    """

    coefficients: Coefficients
    ends: EndCoefficients
    water: Water
    adds_mass: bool


def water_members(w: WaterSchema, structure: Structure, folder: Path) -> Members:
    """Return the properties of members given by ``water``; a HydroDyn file is relative to ``folder``.

    Raises
    ------
    InputError
        If members or parts do not exist, or values are given both directly and by a HydroDyn file.
    """
    if w.hydrodyn is None:
        coefficients, ends, flooded = _coefficients(w, structure), w.ends, _flooded(w, structure)
    else:
        twice = sorted(w.model_fields_set - {"hydrodyn", "depth_m", "density", "adds_mass"})
        field = f"water.{twice[0]}" if twice else None
        require(not twice, "given by the HydroDyn file already", field=field, remedy="leave one of them out")
        with located(field="water.hydrodyn"):
            coefficients, ends, flooded = read_hydrodyn(
                folder / w.hydrodyn, structure, density_kg_m3=w.density
            )
    adds = bool(coefficients.growth or flooded) if w.adds_mass is None else w.adds_mass
    return Members(coefficients, ends, Water(flooded), adds)


def _coefficients(w: WaterSchema, structure: Structure) -> Coefficients:
    """Return the coefficients of members and the growth on them."""
    names = [(m.name, m.part) for m in structure.members]
    require_members((m for t in w.coefficients for m in t.members), names, "water.coefficients.members")
    bare = Strip(w.drag, w.added_mass, w.pressure)
    grown = _strip(w.with_growth, bare)
    with located(field="water.marine_growth"):
        growth = _growth(w)
    with located(field="water.coefficients"):
        tables = tuple(_table(table, bare, grown) for table in w.coefficients)
    return Coefficients(w.drag, w.added_mass, w.pressure, growth, grown, tables, w.density)


def _flooded(w: WaterSchema, structure: Structure) -> tuple[str, ...]:
    if isinstance(w.flooded, bool):
        below = {m.name for m in structure.members if m.part not in ("tower", PILES)}
        return tuple(sorted(below)) if w.flooded else ()
    require_members(w.flooded, [(m.name, m.part) for m in structure.members], "water.flooded")
    return tuple(w.flooded)


def _strip(given: StripSchema | None, default: Strip) -> Strip:
    said = {} if given is None else given.model_dump(include={"drag", "added_mass", "pressure"})
    return replace(default, **{name: value for name, value in said.items() if value is not None})


def _table(table: TableSchema, bare: Strip, grown: Strip) -> StripTable:
    """Return a table; missing values are those without growth at the same height, or the general ones."""
    at = [_strip(row, bare) for row in table.at]
    covered = [_strip(row.with_growth, _strip(row, grown)) for row in table.at]
    return StripTable(tuple(row.z_m for row in table.at), tuple(at), tuple(covered), tuple(table.members))


def _growth(w: WaterSchema) -> tuple[GrowthBand, ...]:
    """Return bands, from bands or from a table of heights."""
    rows = w.marine_growth
    if all(g.z_m is None for g in rows):
        return tuple(_band(g, g.density or w.growth_density) for g in rows)
    require(
        len(rows) >= 2 and all(g.z_m is not None and g.top_z_m is g.bottom_z_m is None for g in rows),
        "a table of growth needs z_m at every height and at least two heights",
        field="z_m",
        value=[g.z_m for g in rows if g.z_m is not None],
        remedy="give z_m and thickness_m everywhere, or top_z_m, bottom_z_m and thickness_m",
    )
    table = ((g.z_m or 0.0, g.thickness_m, g.density or w.growth_density) for g in rows)
    return growth_bands(sorted(table, reverse=True))


def _band(g: GrowthSchema, density: float) -> GrowthBand:
    if g.top_z_m is None or g.bottom_z_m is None:
        raise InputError(
            "growth without heights",
            field="top_z_m" if g.top_z_m is None else "bottom_z_m",
            remedy="give top_z_m and bottom_z_m, or z_m at every height of a table",
        )
    return GrowthBand(g.top_z_m, g.bottom_z_m, g.thickness_m, density_kg_m3=density)


def depth_of(w: WaterSchema, structure: Structure) -> float:
    """Return the stated depth [m], or that of the lowest foot."""
    feet = structure.reaction_nodes or tuple(structure.nodes)
    reach = structure.sea_level_z_m - min(structure.nodes[node][2] for node in feet)
    if w.depth_m is not None:
        require(
            w.depth_m <= reach + _GAP_M,
            "the structure does not reach the bed",
            field="water.depth_m",
            value=w.depth_m,
            allowed=f"up to {reach + _GAP_M:g} m; its feet are {reach:g} m below still water",
            remedy="state the depth of this structure or its sea_level_z_m, or leave the depth out",
        )
        return w.depth_m
    require(
        reach > 0.0,
        "water depth is not known",
        field="water.depth_m",
        remedy="state it, or sea_level_z_m in the structure's file",
    )
    return reach
