"""A wave passing: loads in balance with the rest positions, symmetric where the structure is."""

import numpy as np
import pytest
from tests.support.wave_loads import wave_loads

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads import airy_wave, morison_points
from jackettwin.response.motion.passage import wave_passage
from jackettwin.response.system import build_system
from jackettwin.soil import on_translations
from jackettwin.soil.laws.viscoelastic import kelvin_voigt
from jackettwin.structure import assemble


@pytest.fixture(scope="module")
def system():
    structure = read_structure("jacket15")
    return build_system(assemble(structure), on_translations(structure, kelvin_voigt(2.5e9, 7.6e8)))


def test_springs_at_the_feet_balance_the_wave(system) -> None:
    passage = wave_passage(system, height_m=10.0, period_s=10.0, n_phases=8)
    assembly = system.assembly
    feet = np.concatenate([assembly.dofs(node)[:1] for node in assembly.structure.reaction_nodes])
    reaction = 2.5e9 * passage.displacement[:, feet].sum(axis=1)
    grid = morison_points(assembly, highest_z=10.0)
    wave = airy_wave(height=10.0, period=10.0, depth=72.0)
    load = wave_loads(grid, wave, np.arange(8) * 10.0 / 8)
    sway = np.tile([1.0, 0, 0, 0, 0, 0], assembly.n_dof // 6)
    np.testing.assert_allclose(reaction, load @ sway, rtol=1e-6, atol=1.0)
    # a wave along x leaves the y of a symmetric jacket alone, but for the offset of nothing static
    side = np.concatenate([assembly.dofs(node)[1:2] for node in assembly.structure.reaction_nodes])
    assert np.abs(passage.displacement[:, side].sum(axis=1)).max() < 1e-6 * np.abs(reaction / 2.5e9).max()


def test_dry_members_carry_nothing(system) -> None:
    passage = wave_passage(system, height_m=10.0, period_s=10.0, direction_rad=0.5, n_phases=4)
    members = system.assembly.structure.members
    tower = np.array([members[k].part == "tower" for k in system.assembly.mesh.member])
    assert (passage.load_n_m[:, tower] == 0.0).all()
    assert (passage.load_n_m[:, ~tower].max(axis=0) > 0.0).sum() > 50
    # deep-water length gT²/2π = 156 m, a little less in 72 m
    assert passage.length_m == pytest.approx(155.0, rel=0.01)
    with pytest.raises(InputError, match="height"):
        wave_passage(system, height_m=70.0, period_s=10.0)
