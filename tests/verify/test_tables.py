"""One geometry for Tables 3.3, 5.1, 5.2 and 5.4 of the thesis has modes of the kinds that it describes."""

from dataclasses import replace

import numpy as np

from jackettwin.decks import read_structure
from jackettwin.response import mode_kinds, mode_labels
from jackettwin.structure import STEEL, Structure, assemble
from jackettwin.updating import numbered_modes
from jackettwin.verify.tables import table_structures


def test_both_programs_have_the_same_steel() -> None:
    ours, second = table_structures()
    assert ours.nodes == second.nodes
    for a, b in zip(ours.members, second.members, strict=True):
        assert (a.start, a.end, a.section_start, a.part) == (b.start, b.end, b.section_start, b.part)
        assert a.material.youngs_modulus_pa == b.material.youngs_modulus_pa


def test_the_first_five_are_bending_torsion_and_second_bending() -> None:
    """Section 5.4 of the thesis, of its figures 5.11 and 5.12."""
    for structure in table_structures():
        assembly = assemble(structure)
        modes = numbered_modes(assembly, 5)
        labels = mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))
        assert {*labels[:2]} == {"fore_aft_1", "side_side_1"}
        assert labels[2] == "torsion_1"
        assert {*labels[3:]} == {"fore_aft_2", "side_side_2"}


def steel_of(structure: Structure) -> Structure:
    return replace(structure, members=tuple(replace(m, material=STEEL) for m in structure.members))


def transition_piece_share(structure: Structure) -> float:
    """Return the share of the transition piece in the strain energy of the first mode."""
    assembly = assemble(structure)
    twice = assemble(structure.with_material("transition_piece", youngs_modulus=2.0))
    phi = numbered_modes(assembly, 1).shapes[:, 0]
    energy = phi @ (assembly.stiffness @ phi)
    return float(phi @ ((twice.stiffness - assembly.stiffness) @ phi) / energy)


def test_rayleighs_quotient_bounds_what_a_stiffer_transition_piece_can_do() -> None:
    """ω₁² rises by 1 + 4e at most when its modulus rises fivefold: 0.142 to 0.183 Hz needs 16 %."""
    needed = ((0.1825 / 0.1425) ** 2 - 1.0) / 4.0  # rounding against us
    assert 0.15 < needed < 0.17
    assert transition_piece_share(steel_of(table_structures()[0])) > needed
    assert transition_piece_share(steel_of(read_structure("jacket15"))) < 0.02
    for structure in (steel_of(table_structures()[0]), steel_of(read_structure("jacket15"))):
        stiffer = structure.with_material("transition_piece", youngs_modulus=5.0)
        f = [numbered_modes(assemble(s), 1).frequency_hz[0] for s in (structure, stiffer)]
        assert (f[1] / f[0]) ** 2 <= 1.0 + 4.0 * transition_piece_share(structure)
        assert np.all(np.diff(f) >= 0.0)
