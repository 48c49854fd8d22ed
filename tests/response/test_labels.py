"""Names of the modes of the reference jacket, known from the thesis (table 5.4 and figure 5.3)."""

import numpy as np

from jackettwin.response.labels import mode_kinds, mode_labels
from jackettwin.response.modal import damped_modes, undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.support import on_translations, pinned
from jackettwin.soil.viscoelastic import kelvin_voigt


def test_first_five_modes_of_the_reference_jacket(jacket15) -> None:
    modes = undamped_modes(build_system(jacket15, pinned(jacket15.structure)), 5)
    kinds = mode_kinds(jacket15, modes.shapes)
    assert kinds == ("side_side", "fore_aft", "torsion", "side_side", "fore_aft")
    assert mode_labels(kinds) == ("side_side_1", "fore_aft_1", "torsion_1", "side_side_2", "fore_aft_2")


def test_complex_shapes_have_the_same_names_whatever_their_phase(jacket15) -> None:
    support = on_translations(jacket15.structure, kelvin_voigt(2.5e9, 7.6e8))
    modes = damped_modes(build_system(jacket15, support), below_hz=0.6)
    kinds = mode_kinds(jacket15, modes.shapes * np.exp(0.7j))
    assert kinds == ("side_side", "fore_aft", "torsion")
