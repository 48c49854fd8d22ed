"""Names of the modes of the reference jacket, known from the thesis (table 5.4 and figure 5.3)."""

import numpy as np

from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.response.modes.modal import damped_modes, undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import kelvin_voigt
from jackettwin.soil.support import clamped, on_translations, pinned
from jackettwin.structure import Material, Section, Structure, assemble
from jackettwin.structure.model import Member, Reaction

SQUARE = ((-5.0, -4.0), (5.0, -4.0), (5.0, 4.0), (-5.0, 4.0))


def test_first_five_modes_of_the_reference_jacket(jacket15) -> None:
    modes = undamped_modes(build_system(jacket15, pinned(jacket15.structure)), 5)
    kinds = mode_kinds(jacket15, modes.shapes, modes.frequency_hz)
    assert kinds == ("side_side", "fore_aft", "torsion", "side_side", "fore_aft")
    assert mode_labels(kinds) == ("side_side_1", "fore_aft_1", "torsion_1", "side_side_2", "fore_aft_2")


def test_complex_shapes_have_the_same_names_whatever_their_phase(jacket15) -> None:
    support = on_translations(jacket15.structure, kelvin_voigt(2.5e9, 7.6e8))
    modes = damped_modes(build_system(jacket15, support), below_hz=0.6)
    kinds = mode_kinds(jacket15, modes.shapes * np.exp(0.7j), modes.frequency_hz)
    assert kinds == ("side_side", "fore_aft", "torsion")


def test_modes_of_the_braces_alone_are_local(jacket15) -> None:
    """Four of the ten lowest modes swing X-braces; the third bending pair is not local."""
    modes = undamped_modes(build_system(jacket15, pinned(jacket15.structure)), 11)
    labels = mode_labels(mode_kinds(jacket15, modes.shapes, modes.frequency_hz))
    assert labels[5:9] == ("local_1", "local_2", "local_3", "local_4")
    assert labels[9:] == ("side_side_3", "fore_aft_3")


def test_without_a_tower_the_mean_of_the_interface_decides() -> None:
    """A square frame of four legs sways in two directions, and twists."""
    legs = {f"b{k}": (x, y, 0.0) for k, (x, y) in enumerate(SQUARE)}
    tops = {f"t{k}": (x, y, 20.0) for k, (x, y) in enumerate(SQUARE)}
    tube, steel = Section(1.0, 0.05), Material(210e9, 81e9, 7850.0)
    members = [Member(f"leg{k}", f"b{k}", f"t{k}", tube, tube, steel) for k in range(4)]
    members += [Member(f"top{k}", f"t{k}", f"t{(k + 1) % 4}", tube, tube, steel) for k in range(4)]
    frame = Structure(
        name="frame",
        nodes=legs | tops,
        members=tuple(members),
        reactions=tuple(Reaction(name) for name in legs),
        interface_nodes=tuple(tops),
    )
    modes = undamped_modes(build_system(assemble(frame), clamped(frame)), 3)
    assert sorted(mode_kinds(assemble(frame), modes.shapes, modes.frequency_hz)) == [
        "fore_aft",
        "side_side",
        "torsion",
    ]
