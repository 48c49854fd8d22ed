"""Stages: the last is the whole, masses add up, the numbers of reproduce's tables."""

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.structure import assemble, check
from jackettwin.updating import numbered_modes
from jackettwin.updating.steel import stages


def test_jacket15_part_by_part() -> None:
    structure = read_structure("jacket15")
    jacket, piece, full = stages(structure, 5)
    assert [stage.name for stage in (jacket, piece, full)] == ["jacket", "+ transition_piece", "+ tower"]
    assert jacket.mass_kg < piece.mass_kg < full.mass_kg
    assert full.mass_kg == pytest.approx(check(assemble(structure)).mass_kg, rel=1e-12)
    np.testing.assert_array_equal(full.frequency_hz, numbered_modes(assemble(structure), 5).frequency_hz)
    # the calibrated reference jacket, printed with three digits
    np.testing.assert_allclose(jacket.frequency_hz, [0.836, 0.957, 0.957, 1.016, 1.637], rtol=1e-3)
