"""Change of the water's mass by growth, flooding, added mass and the level of the sea."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import scipy.sparse as sp

from jackettwin.loads import Coefficients, GrowthBand, Water, mass_per_level
from jackettwin.structure import Assembly, Structure
from jackettwin.twin.water import WaterConfig, moving_mass

_LEAST_DEPTH_M = 1.0
_SPLASH_M = 2.0
"""Height above still water that unstated growth reaches (DNV-RP-C205, 6.7.4)."""

Change = Callable[[WaterConfig, Structure, float], WaterConfig | None]


def water_of(water: WaterConfig | None, structure: Structure) -> WaterConfig | None:
    """Return the stated water, else plain water down to the feet; None of a structure on land."""
    if water is not None:
        return water
    feet = [structure.nodes[node][2] for node in structure.reaction_nodes]
    depth = structure.sea_level_z_m - min(feet, default=structure.sea_level_z_m)
    if depth < _LEAST_DEPTH_M:
        return None
    return WaterConfig(depth, Coefficients(), Water(), adds_mass=False, sea=None)


def changed_mass(
    water: WaterConfig | None, assembly: Assembly, size: float, change: Change
) -> sp.csc_array | None:
    """Return the mass that a change of the water adds, whether or not the structure's mass includes water."""
    before = water_of(water, assembly.structure)
    after = None if before is None else change(before, assembly.structure, size)
    if before is None or after is None:
        return None
    return sp.csc_array(moving_mass(after, assembly) - moving_mass(before, assembly))


def level_mass(water: WaterConfig | None, assembly: Assembly, size: float) -> sp.csc_array | None:
    """Return the mass that a rise of the sea level by ``size`` [m] adds."""
    stated = water_of(water, assembly.structure)
    if stated is None:
        return None
    return sp.csc_array(size * mass_per_level(assembly, stated.coefficients, stated.carried))


def unstated_growth(water: WaterConfig, structure: Structure, size: float) -> WaterConfig | None:
    """Return the water with growth of ``size`` [m] down to the bed; None if the twin states growth."""
    if any(_thickest(band) > 0.0 for band in water.coefficients.growth):
        return None
    return _grown(water, (GrowthBand(_SPLASH_M, -water.depth_m, size),))


def thicker_growth(water: WaterConfig, structure: Structure, size: float) -> WaterConfig | None:
    """Return the water with the stated growth thicker by a share."""
    factor, bands = 1.0 + size, water.coefficients.growth

    def thicker(band: GrowthBand) -> GrowthBand:
        bottom = band.bottom_thickness_m
        return replace(
            band,
            thickness_m=factor * band.thickness_m,
            bottom_thickness_m=None if bottom is None else factor * bottom,
        )

    return _grown(water, tuple(map(thicker, bands))) if bands else None


def denser_growth(water: WaterConfig, structure: Structure, size: float) -> WaterConfig | None:
    """Return the water with the stated growth denser by ``size`` [kg/m³]."""

    def denser(band: GrowthBand) -> GrowthBand:
        bottom = band.bottom_density_kg_m3
        return replace(
            band,
            density_kg_m3=band.density_kg_m3 + size,
            bottom_density_kg_m3=None if bottom is None else bottom + size,
        )

    bands = water.coefficients.growth
    return _grown(water, tuple(map(denser, bands))) if bands else None


def more_added_mass(water: WaterConfig, structure: Structure, size: float) -> WaterConfig:
    """Return the water with C_a increased by a share everywhere."""
    given, factor = water.coefficients, 1.0 + size

    def more(strip: object) -> object:
        return replace(strip, added_mass=factor * strip.added_mass)  # type: ignore[attr-defined,type-var]

    tables = tuple(
        replace(t, bare=tuple(map(more, t.bare)), grown=tuple(map(more, t.grown)))  # type: ignore[arg-type]
        for t in given.tables
    )
    grown = None if given.grown is None else more(given.grown)
    coefficients = replace(given, added_mass=factor * given.added_mass, grown=grown, tables=tables)  # type: ignore[arg-type]
    return replace(water, coefficients=coefficients)


def flooded(names: tuple[str, ...]) -> Change:
    """Return the change that floods dry members, or empties them if any is drawn as flooded."""

    def change(water: WaterConfig, structure: Structure, size: float) -> WaterConfig:
        given = set(water.carried.flooded)
        members = {m.name for m in structure.members if m.name in given or m.part in given}
        if members & set(names):
            return replace(water, carried=Water(tuple(sorted(members - set(names)))))
        return replace(water, carried=Water((*water.carried.flooded, *names)))

    return change


def _grown(water: WaterConfig, bands: tuple[GrowthBand, ...]) -> WaterConfig:
    return replace(water, coefficients=replace(water.coefficients, growth=bands))


def _thickest(band: GrowthBand) -> float:
    return max(band.thickness_m, band.bottom_thickness_m or 0.0)
