"""Water around a twin: its mass on the members and its drag damping, with factors that can be updated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import scipy.sparse as sp

from jackettwin.errors import InputError
from jackettwin.loads import (
    Coefficients,
    MorisonPoints,
    SeaState,
    StillWater,
    Water,
    morison_points,
    sea_drag_damping,
    still_water,
    water_mass,
)
from jackettwin.structure import Assembly

_SPACING_M = 4.0
"""Greatest length of a member's segments [m]."""


@dataclass(frozen=True)
class WaterConfig:
    """``water`` and ``sea`` of a twin file.

    Attributes
    ----------
    carried : Water
        Contents of flooded members and growth.
    adds_mass : bool
        Whether it adds mass, since the structure's own mass excludes water and growth.
    sea : SeaState or None
        In which drag is linearised.
    """

    depth_m: float
    coefficients: Coefficients
    carried: Water
    adds_mass: bool
    sea: SeaState | None


def moving_mass(water: WaterConfig, assembly: Assembly) -> sp.csr_array:
    """Return the mass matrix of growth, internal water and added mass, (n_dof, n_dof)."""
    return water_mass(assembly, _points(water, assembly), water.carried)


def in_water(water: WaterConfig | None, assembly: Assembly) -> Assembly:
    """Return an assembled structure with the water's mass, if there is water and it adds some."""
    if water is None or not water.adds_mass:
        return assembly
    return replace(assembly, mass=assembly.mass + moving_mass(water, assembly).tocsc())


def still_loads(water: WaterConfig, assembly: Assembly) -> StillWater:
    """Return the weight of growth and water inside less buoyancy, on the DOFs and along the elements."""
    return still_water(assembly, _points(water, assembly), water.carried)


def water_effects(
    water: WaterConfig | None, assembly: Assembly, wanted: tuple[str, ...]
) -> Mapping[str, sp.csr_array]:
    """Return the matrices of the water's free factors for ``NuisanceParameters``.

    Raises
    ------
    InputError
        If a factor needs water or a sea that the twin does not state.
    """
    effects: dict[str, sp.csr_array] = {}
    for name in wanted:
        if water is None or (name == "water_damping" and water.sea is None):
            missing = "water" if water is None else "sea"
            raise InputError(
                f"a factor of the water needs {missing}",
                field="update.water",
                value=name,
                remedy=f"state {missing}: in the twin file",
            )
        if name == "water_mass":
            effects[name] = moving_mass(water, assembly)
        elif water.sea is not None:
            effects[name] = sea_drag_damping(_points(water, assembly), water.sea, water.depth_m)
    return effects


def in_the_records_sea(water: WaterConfig | None, waves: tuple[float, float] | None) -> WaterConfig | None:
    """Return the water in the records' mean sea (height [m], period [s]), unless the twin states a sea."""
    if water is None or water.sea is not None or waves is None:
        return water
    return replace(water, sea=SeaState(*waves))


def _points(water: WaterConfig, assembly: Assembly) -> MorisonPoints:
    return morison_points(
        assembly,
        highest_z=0.0,
        lowest_z=-water.depth_m,
        coefficients=water.coefficients,
        spacing=_SPACING_M,
    )
