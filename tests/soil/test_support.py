"""Supports of a structure."""

from dataclasses import replace

import numpy as np
from tests.response.conftest import DECK

from jackettwin.decks import read_structure
from jackettwin.soil import clamped, on_translations, own_support, pinned
from jackettwin.soil.laws.viscoelastic import kelvin_voigt
from jackettwin.soil.support import standing
from jackettwin.structure.model import Reaction

FEET = ("foot_1", "foot_2", "foot_3", "foot_4")


def test_pins_hold_translations_and_clamps_everything() -> None:
    structure = read_structure("jacket15")
    assert pinned(structure).fixed == tuple((foot, (0, 1, 2)) for foot in FEET)
    assert clamped(structure).fixed == tuple((foot, (0, 1, 2, 3, 4, 5)) for foot in FEET)
    assert own_support(structure) == pinned(structure)


def test_a_law_stands_on_twelve_translations() -> None:
    support = on_translations(read_structure("jacket15"), kelvin_voigt(1.0, 2.0))
    assert tuple(spring.node for spring in support.springs) == FEET
    assert all((np.diag(s.matrix) == [1, 1, 1, 0, 0, 0]).all() for s in support.springs)


def test_a_deck_brings_its_pile_head_stiffness() -> None:
    """Jacket_Kzz.txt holds a vertical spring; the deck holds the other DOFs of its reaction joints."""
    structure = read_structure(DECK)
    support = own_support(structure)
    assert [node for node, _ in support.fixed] == list(structure.reaction_nodes)
    assert all(held == (0, 1, 3, 4, 5) for _, held in support.fixed)
    for spring in support.springs:
        assert spring.matrix[2, 2] > 0.0
        assert np.count_nonzero(spring.matrix) == 1


def test_modes_are_numbered_on_pins_unless_these_let_the_structure_turn() -> None:
    structure = read_structure("jacket15")
    assert standing(structure) == pinned(structure)
    for feet in (("foot_1",), ("foot_1", "foot_2")):
        leaning = replace(structure, reactions=tuple(Reaction(node, (True,) * 6) for node in feet))
        assert standing(leaning) == clamped(leaning)
