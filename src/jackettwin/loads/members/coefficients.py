"""Drag, added mass and pressure coefficients of members, and the marine growth on them.

As in OpenFAST's HydroDyn there is one set for all members, or tables over the height for all or some members,
each with a second set for members covered by growth.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.constants import SEA_WATER_KG_M3
from jackettwin.errors import InputError, require
from jackettwin.structure import GROWTH_KG_M3


@dataclass(frozen=True)
class Strip:
    """Transverse coefficients of a member per unit length.

    Attributes
    ----------
    drag : C_D
    added_mass : C_a, for the water's acceleration relative to the member
    pressure : C_p, for the acceleration of the undisturbed water (Froude–Krylov); C_M = C_p + C_a
    """

    drag: float = 1.0
    added_mass: float = 1.0
    pressure: float = 1.0

    def __post_init__(self) -> None:
        for field in ("drag", "added_mass", "pressure"):
            _require_not_negative(field, getattr(self, field))

    def row(self) -> tuple[float, float, float]:
        """Return C_D, C_a, C_p."""
        return (self.drag, self.added_mass, self.pressure)


@dataclass(frozen=True)
class StripTable:
    """Coefficients at heights, interpolated linearly in between and constant beyond.

    Attributes
    ----------
    z_m : ascending or descending heights from still water [m]
    bare, grown : coefficients at these heights, without and with growth
    members : members or parts of the structure with these coefficients; all if empty
    """

    z_m: tuple[float, ...]
    bare: tuple[Strip, ...]
    grown: tuple[Strip, ...]
    members: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.z_m or len(set(self.z_m)) < len(self.z_m):
            raise InputError(
                "heights must differ", field="z_m", value=list(self.z_m), remedy="leave one of the two out"
            )

    def at(self, z: FloatArray, grown: BoolArray) -> FloatArray:
        """Return C_D, C_a, C_p at heights ``z``, (3, n)."""
        order = np.argsort(self.z_m)
        known = np.take(self.z_m, order)
        bare, covered = (
            np.array([strip.row() for strip in strips]).T[:, order] for strips in (self.bare, self.grown)
        )
        return np.array(
            [
                np.where(grown, np.interp(z, known, c), np.interp(z, known, b))
                for b, c in zip(bare, covered, strict=True)
            ]
        )


@dataclass(frozen=True)
class GrowthBand:
    """Marine growth between two heights from still water [m], interpolated linearly.

    ``bottom_thickness_m`` and ``bottom_density_kg_m3`` are those of the top unless given.
    """

    top_z_m: float
    bottom_z_m: float
    thickness_m: float
    bottom_thickness_m: float | None = None
    density_kg_m3: float = GROWTH_KG_M3
    bottom_density_kg_m3: float | None = None

    def __post_init__(self) -> None:
        if not self.top_z_m > self.bottom_z_m:
            raise InputError(
                "the top of growth must lie above its bottom",
                field="top_z_m",
                value=self.top_z_m,
                allowed=f"> {self.bottom_z_m:g}",
                remedy="exchange them, or make them differ",
            )
        _require_not_negative("thickness_m", self.thickness_m)
        _require_not_negative("bottom_thickness_m", self.bottom_thickness_m or 0.0)
        _require_not_negative("density_kg_m3", self.density_kg_m3)

    def share(self, z: FloatArray) -> tuple[BoolArray, FloatArray]:
        """Return which ``z`` lie within the band, and their position from its top (0) to its bottom (1)."""
        inside = (z <= self.top_z_m) & (z >= self.bottom_z_m)
        return inside, np.asarray((self.top_z_m - z) / (self.top_z_m - self.bottom_z_m))


def growth_bands(falling: Iterable[tuple[float, float, float]]) -> tuple[GrowthBand, ...]:
    """Return the bands between the rows (z [m], thickness [m], density [kg/m³]) of a table, from the top."""
    return tuple(
        GrowthBand(z, below, thickness, thickness_below, density, density_below)
        for (z, thickness, density), (below, thickness_below, density_below) in pairwise(falling)
    )


@dataclass(frozen=True)
class Coefficients:
    """Coefficients of all members, marine growth and the density of the water.

    Growth increases the hydrodynamic diameter. ``grown`` are the coefficients of covered members, equal to
    ``bare`` unless given. Later ``tables`` override earlier ones and both sets.
    """

    drag: float = 1.0
    added_mass: float = 1.0
    pressure: float = 1.0
    growth: tuple[GrowthBand, ...] = ()
    grown: Strip | None = None
    tables: tuple[StripTable, ...] = ()
    density_kg_m3: float = SEA_WATER_KG_M3

    def __post_init__(self) -> None:
        _require_not_negative("density_kg_m3", self.density_kg_m3)
        _ = self.bare

    @property
    def bare(self) -> Strip:
        """The coefficients of a member without growth."""
        return Strip(self.drag, self.added_mass, self.pressure)

    def thickness(self, z: FloatArray) -> FloatArray:
        """Return the growth's thickness [m] at ``z``; where two bands meet, the later one applies."""
        t = np.zeros_like(z)
        for band in self.growth:
            inside, share = band.share(z)
            bottom = band.thickness_m if band.bottom_thickness_m is None else band.bottom_thickness_m
            t = np.where(inside, band.thickness_m + share * (bottom - band.thickness_m), t)
        return t

    def growth_density(self, z: FloatArray) -> FloatArray:
        """Return the growth's density [kg/m³] at ``z``, zero where there is none."""
        rho = np.zeros_like(z)
        for band in self.growth:
            inside, share = band.share(z)
            top, bottom = band.density_kg_m3, band.bottom_density_kg_m3
            bottom = top if bottom is None else bottom
            rho = np.where(inside, top + share * (bottom - top), rho)
        return rho

    def at(self, z: FloatArray, member: IntArray, names: Sequence[tuple[str, str]]) -> FloatArray:
        """Return C_D, C_a, C_p (3, n) at heights ``z`` on members given by index.

        ``names`` contains each member's name and part.

        Raises
        ------
        InputError
            If a table is for a member or part that does not exist.
        """
        covered = self.thickness(z) > 0.0
        everywhere = StripTable((0.0,), (self.bare,), (self.grown or self.bare,))
        found = everywhere.at(z, covered)
        for table in self.tables:
            require_members(table.members, names, "coefficients")
            meant = np.array([not table.members or bool(set(both) & set(table.members)) for both in names])
            found = np.where(meant[member], table.at(z, covered), found)
        return found


def require_members(wanted: Iterable[str], names: Sequence[tuple[str, str]], field: str) -> None:
    """Raise an error for a word that is neither the name nor the part of a member."""
    known = {word for both in names for word in both}
    for word in wanted:
        require(
            word in known, "no such member or part", field=field, value=word, remedy="name a member or a part"
        )


def _require_not_negative(field: str, value: float) -> None:
    require(np.isfinite(value) and value >= 0.0, "out of range", field=field, value=value, allowed="≥ 0")
