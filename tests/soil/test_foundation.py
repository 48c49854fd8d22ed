"""Foundation files: the shipped ones are what they say, bad ones are refused."""

from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import read_support
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.laws.viscoelastic import loss_factor
from jackettwin.structure import assemble

PILE = "pile: {length_m: 60, outer_diameter_m: 2.8, thickness_m: 0.06}\n"
SAND = "soil: {layers: [{thickness_m: 60, effective_weight_n_m3: 1e4, sand: {friction_angle_deg: 35}}]}\n"
CLAY = "soil: {layers: [{thickness_m: 60, effective_weight_n_m3: 9e3, clay: {strength_pa: [20e3, 30e3]}}]}\n"


def test_the_shipped_foundation_meets_table_5_1_piled_and_lumped() -> None:
    foundation = read_foundation("jacket15")
    for structure, support in (
        foundation.piled(read_structure("jacket15")),
        foundation.lumped(read_structure("jacket15")),
    ):
        modes = undamped_modes(build_system(assemble(structure), support), 5)
        error = np.abs(modes.frequency_hz / [0.183, 0.186, 0.595, 0.760, 0.805] - 1.0)
        assert (error < [0.005, 0.005, 0.05, 0.04, 0.04]).all()
        # table 6.1 (identified): f1, f2, f4 within 1.5 %, P-Δ off
        identified = np.abs(modes.frequency_hz[[0, 1, 3]] / [0.1819, 0.1838, 0.7362] - 1.0)
        assert (identified < 0.015).all()


def test_a_foundation_is_a_support(tmp_path: Path) -> None:
    """By its shipped name or as a file: the pile heads, with their mass, under the structure as it is."""
    structure = read_structure("jacket15")
    copy = tmp_path / "piles.yaml"
    copy.write_text((resources.files("jackettwin") / "data" / "foundations" / "jacket15.yaml").read_text())
    lumped, heads = read_foundation("jacket15").lumped(structure)
    assert lumped is structure
    wanted = undamped_modes(build_system(assemble(structure), heads), 4).frequency_hz
    for text in ("jacket15", str(copy)):
        support = read_support(text, structure, first_frequency_hz=lambda: 0.183)
        found = undamped_modes(build_system(assemble(structure), support), 4).frequency_hz
        np.testing.assert_array_equal(found, wanted)


def test_the_piles_move_with_the_feet() -> None:
    """A rigid translation of feet and structure carries the piles' lumped mass, once a foot."""
    structure = read_structure("jacket15")
    assembly, heads = assemble(structure), read_foundation("jacket15").heads(structure)
    with_piles, without = (build_system(assembly, s).pencil.M for s in (heads, replace(heads, masses=())))
    lift = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], assembly.n_dof // 6)
    added = lift @ (with_piles @ lift) - lift @ (without @ lift)
    assert added == pytest.approx(sum(mass[2, 2] for _, mass in heads.masses), rel=1e-9)


def test_the_records_foundation_has_its_loss_factor() -> None:
    """η = 2ζ at ω1, thesis eq. (5.3)–(5.4)."""
    foundation = read_foundation("jacket15_records")
    assert float(loss_factor(foundation.law, 0.183)) == pytest.approx(0.04)
    assert foundation.springs.axial.sum() == pytest.approx(1.6e8 * 60.0 + 4.0e8)
    assert foundation.springs.lateral.sum() == pytest.approx(0.5 * 4.0e7 * 60.0**2)


def test_scour_lowers_the_first_frequency(tmp_path: Path) -> None:
    frequency = []
    for scour in ("", "scour: {general_m: 4.0}\n"):
        path = tmp_path / "ground.yaml"
        path.write_text(PILE + SAND + scour)
        structure, support = read_foundation(path).lumped(read_structure("jacket15"))
        frequency.append(undamped_modes(build_system(assemble(structure), support), 1).frequency_hz[0])
    assert 0.97 < frequency[1] / frequency[0] < 0.999


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PILE + "soil: {}\n", "either layers or linear"),
        (PILE.replace("0.06", "2.0") + "soil: {linear: {lateral_n_m3: 1e7, axial_n_m2: 1e8}}\n", "radius"),
        (PILE + "soil: {linear: {lateral_n_m3: 1e7, axail_n_m2: 1e8}}\n", "axial_n_m2"),
        (PILE + "soil: {layers: [{thickness_m: 9, effective_weight_n_m3: 1e4}]}\n", "sand or clay"),
        (PILE + SAND.replace("35", "70"), r"soil.layers.0.sand.friction_angle_deg.*20 to 45 degrees"),
        (PILE + CLAY.replace("20e3, 30e3", "20, 30"), r"soil.layers.0.clay.strength_pa.*20 kPa is 20e3"),
        (PILE + CLAY.replace("9e3", "9"), r"soil.layers.0.effective_weight_n_m3.*9 kN/m³ is 9e3"),
        (PILE.replace("length_m: ", "length_m: 9") + CLAY, r"pile.length_m.*≤ 300"),
    ],
)
def test_bad_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "ground.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_foundation(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(("diameter_m", "said"), [(2.4, False), (6.0, False), (6.1, True), (9.0, True)])
def test_stout_piles_are_said_to_be_beyond_the_curves(tmp_path: Path, diameter_m: float, said: bool) -> None:
    path = tmp_path / "piles.yaml"
    path.write_text(PILE.replace("2.8", str(diameter_m)) + CLAY)
    notes = read_support(path, read_structure("jacket15")).notes
    assert any("diameters long" in note for note in notes) is said


def test_a_pile_longer_than_its_layers_is_said(tmp_path: Path) -> None:
    structure = read_structure("jacket15")
    for length, said in ((60, 0), (61, 1)):
        path = tmp_path / "piles.yaml"
        path.write_text(PILE.replace("60", str(length), 1) + CLAY)
        notes = read_support(path, structure).notes
        assert len(notes) == said
        assert all("61 m, the layers 60 m" in note for note in notes)
