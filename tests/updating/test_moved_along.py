"""A structure that differs along its tolerances, in full."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.response import System, build_system, undamped_modes
from jackettwin.soil import Prony, on_translations, pinned
from jackettwin.structure import assemble
from jackettwin.updating import Direction, Tolerance, moved_along, on_unlike_feet, possible

SIZE = Tolerance("size", "its size", 0.1, "-", "", "")


def test_mass_and_stiffness_move_by_their_amounts() -> None:
    """All mass a tenth heavier and all stiffness two tenths stiffer: frequencies by √(1.2/1.1)."""
    assembly = assemble(read_structure("jacket15"))
    ways = (Direction(SIZE, mass=0.1 * assembly.mass), Direction(SIZE, stiffness=0.1 * assembly.stiffness))
    moved, shares = moved_along(assembly, ways, np.array([1.0, 2.0]))
    feet = pinned(assembly.structure)
    before, after = (undamped_modes(build_system(a, feet), 3).omega for a in (assembly, moved))
    assert_allclose(after / before, np.sqrt(1.2 / 1.1), rtol=1e-9)
    assert not shares.any()


def test_feet_move_by_their_own_shares() -> None:
    structure = read_structure("jacket15")
    share = np.zeros((len(structure.reaction_nodes), 6))
    share[0] = 0.3
    _, shares = moved_along(assemble(structure), (Direction(SIZE, feet=share),), np.array([-2.0]))
    support = on_unlike_feet(on_translations(structure, Prony(k0=1e9)), structure, shares)
    assert support.springs[0].matrix[2, 2] == pytest.approx(np.exp(-0.6))
    assert all(s.matrix[2, 2] == 1.0 for s in support.springs[1:])


def test_a_structure_drawn_without_mass_comes_nearer_until_it_has_modes() -> None:
    """Three tenths of the mass for each standard deviation: four take more than there is, two leave 0.4."""
    assembly = assemble(read_structure("jacket15"))
    ways, feet = (Direction(SIZE, mass=0.3 * assembly.mass),), pinned(assembly.structure)

    def made(amounts: np.ndarray) -> System:
        return build_system(moved_along(assembly, ways, amounts)[0], feet)

    found, stated = possible(made, np.array([-4.0])), build_system(assembly, feet)
    ratio = undamped_modes(found, 1).omega[0] / undamped_modes(stated, 1).omega[0]
    assert ratio == pytest.approx(np.sqrt(1.0 / 0.4), rel=1e-6)
