"""Slopes of frequencies with the sea level against the model at two levels, and a closed form."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import SEA_WATER_KG_M3, Coefficients, GrowthBand
from jackettwin.loads.members.morison import morison_points
from jackettwin.loads.members.water import Water, mass_per_level, water_mass
from jackettwin.response.modes.modal import UndampedModes, undamped_modes
from jackettwin.response.motion.tide import tide_slopes
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.response.system import build_system
from jackettwin.soil.support import clamped
from jackettwin.structure import Assembly, assemble

COEFFICIENTS = Coefficients(growth=(GrowthBand(2.0, -40.0, 0.1),))
N = 6
DECKS = Path(__file__).parents[2] / "qualify/decks"


def wet(dry: Assembly, water: Water, level_m: float) -> tuple[Assembly, UndampedModes]:
    grid = morison_points(dry, highest_z=1.0, coefficients=COEFFICIENTS)
    mass = dry.mass + water_mass(dry, grid, water, level_m=level_m).tocsc()
    assembly = replace(dry, mass=mass)
    return assembly, undamped_modes(build_system(assembly, clamped(dry.structure)), N)


@pytest.mark.parametrize("deck", ["jacket15", DECKS / "oc4_jacket.dat", DECKS / "oc3_tripod.dat"])
def test_slopes_are_differences_of_frequencies(deck: str | Path) -> None:
    """A tide of ±0.5 m, legs and braces flooded: second order in a level of 1e-3 of f."""
    dry = assemble(read_structure(deck))
    # members of a deck have no part but that of the tower
    water = Water(flooded=tuple(m.name for m in dry.structure.members if m.part in ("jacket", "")))
    assembly, modes = wet(dry, water, 0.0)
    change = mass_per_level(assembly, COEFFICIENTS, water)
    found = tide_slopes(modes.frequency_hz, modes.shapes, assembly.mass, change)
    high, low = (wet(dry, water, level)[1].frequency_hz for level in (0.5, -0.5))
    np.testing.assert_allclose(found.slope_hz_m, high - low, rtol=0.02, atol=1e-7)
    assert (found.relative < 0.0).all()


def test_a_metre_of_water_on_a_pile(monopile: Assembly) -> None:
    """∂M/∂level is ρ(C_a πD²/4) of one metre at the surface: f'/f = −½ m' φ²/(φᵀMφ)."""
    structure = replace(monopile.structure, sea_level_z_m=50.0)
    assembly = assemble(structure)
    modes = undamped_modes(build_system(assembly, clamped(structure)), 2)
    change = mass_per_level(assembly, Coefficients(), Water(), step_m=0.05)
    found = tide_slopes(modes.frequency_hz, modes.shapes, assembly.mass, change)
    line = SEA_WATER_KG_M3 * 0.25 * np.pi * 7.0**2
    rows = observation_matrix(
        assembly,
        [Sensor(f"s{k}", height_m=0.0, direction=tuple(np.eye(3)[k])) for k in range(2)],
    )
    across = ((rows @ modes.shapes) ** 2).sum(axis=0)
    modal = np.einsum("ij,ij->j", modes.shapes, assembly.mass @ modes.shapes)
    np.testing.assert_allclose(found.relative, -0.5 * line * across / modal, rtol=1e-3)


def test_shapes_of_other_modes_are_refused(monopile: Assembly) -> None:
    with pytest.raises(InputError, match="differ in number"):
        tide_slopes(np.ones(3), np.ones((monopile.n_dof, 2)), monopile.mass, monopile.mass)
