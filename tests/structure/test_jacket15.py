"""The shipped reference jacket: numbers published in the thesis, and its parts' books in balance."""

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import pinned
from jackettwin.structure import assemble


@pytest.fixture(scope="module")
def modes():
    structure = read_structure("jacket15")
    return undamped_modes(build_system(assemble(structure), pinned(structure)), 6)


def test_pinned_frequencies_of_table_5_4(modes) -> None:
    np.testing.assert_allclose(modes.frequency_hz[:5], [0.1832, 0.1859, 0.5720, 0.7489, 0.7941], rtol=2e-3)


def test_modal_mass_of_table_4_1(modes) -> None:
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    translations = assembly.expand @ modes.shapes[:, 0]
    largest = np.abs(translations.reshape(-1, 6)[:, :3]).max()
    assert 1.0 / largest**2 == pytest.approx(1.12e6, rel=0.01)


def test_total_mass() -> None:
    assembly = assemble(read_structure("jacket15"))
    lift = np.tile([0, 0, 1.0, 0, 0, 0], assembly.n_dof // 6)
    assert lift @ assembly.mass @ lift == pytest.approx(3578e3, rel=2e-4)  # printed to four digits


def test_the_free_structure_has_six_rigid_modes_and_no_more() -> None:
    structure = read_structure("jacket15")
    free = undamped_modes(build_system(assemble(structure), type(pinned(structure))()), 7)
    assert (free.frequency_hz[:6] < 1e-3).all()
    assert free.frequency_hz[6] > 0.1


def test_gravity_lowers_the_first_modes_by_about_three_percent() -> None:
    """evidence: −2.5 to −4 % on f1 of the 15 MW reference."""
    structure = read_structure("jacket15")
    plain, heavy = (
        undamped_modes(build_system(assemble(structure, gravity=g), pinned(structure)), 2).frequency_hz
        for g in (False, True)
    )
    assert (0.96 < heavy / plain).all() and (heavy / plain < 0.975).all()
