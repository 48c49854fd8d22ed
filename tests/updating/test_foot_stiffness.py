"""Numbered modes followed to softer feet: right eigenvalues, and a second pair found where it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.response.conftest import monopile_structure

from jackettwin.decks import read_structure
from jackettwin.identification import ModalEstimate
from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.modes.tracking import mass_mac
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import Prony
from jackettwin.soil.support import on_translations
from jackettwin.structure import Assembly, assemble
from jackettwin.updating import numbered_modes
from jackettwin.updating.data.foot_stiffness import LOWEST_SHARE, Feet, modes_by_foot_stiffness
from jackettwin.updating.data.pairing import pair, pairing_score

SYMMETRIC = """
sea_level_z_m: 50.0
jacket:
  lattice: {legs: 4, bays: 4, mud_braces: true, base_width_m: 12.0, top_width_m: 8.0, height_m: 65.65,
    leg_diameter_m: 1.2, leg_thickness_bottom_m: 0.05, leg_thickness_top_m: 0.035,
    brace: {outer_diameter_m: 0.8, thickness_m: 0.02}}
  transition_piece: {top_z_m: 70.15, tube: {outer_diameter_m: 1.2, thickness_m: 0.04},
    column: {outer_diameter_m: 5.6, thickness_m: 0.06}}
  tower: {height_m: 68.0, elements: 6, bottom: {outer_diameter_m: 5.6, thickness_m: 0.032},
    top: {outer_diameter_m: 4.0, thickness_m: 0.03}}
  rna: {mass_kg: 350000.0, cg_offset_m: [0.0, 0.0, 1.9],
    inertia_about_cg_kg_m2: [2.5e7, 2.5e7, 2.5e7, 0, 0, 0]}
"""

CROSSING = """
sea_level_z_m: 43.5
jacket:
  lattice: {legs: 3, bays: 4, mud_braces: false, base_width_m: 24.5, top_width_m: 13.0, height_m: 58.0,
    leg_diameter_m: 1.5, leg_thickness_bottom_m: 0.055, leg_thickness_top_m: 0.04,
    brace: {outer_diameter_m: 0.8, thickness_m: 0.024}}
  transition_piece: {top_z_m: 63.0, tube: {outer_diameter_m: 1.6, thickness_m: 0.05},
    column: {outer_diameter_m: 6.2, thickness_m: 0.07}}
  tower: {height_m: 84.0, elements: 8, bottom: {outer_diameter_m: 6.2, thickness_m: 0.038},
    top: {outer_diameter_m: 4.1, thickness_m: 0.026}}
  rna: {mass_kg: 410000.0, cg_offset_m: [ARM, 0.0, 2.4],
    inertia_about_cg_kg_m2: [4.4e7, 2.6e7, 2.5e7, 0, 0, 0]}
"""


@pytest.fixture(scope="module")
def assembly(tmp_path_factory: pytest.TempPathFactory) -> Assembly:
    path = tmp_path_factory.mktemp("symmetric") / "jacket.yaml"
    path.write_text(SYMMETRIC)
    return assemble(read_structure(str(path)), gravity=True)


@pytest.fixture(scope="module")
def path(assembly: Assembly) -> tuple[Feet, ...]:
    return modes_by_foot_stiffness(assembly, numbered_modes(assembly, 10))


def test_the_path_starts_as_numbered_and_only_falls(assembly: Assembly, path: tuple[Feet, ...]) -> None:
    """A softer spring raises no frequency: the Rayleigh quotient of every trial shape falls."""
    assert_allclose(path[0].frequency_hz, numbered_modes(assembly, 10).frequency_hz)
    steps = np.diff([feet.frequency_hz[:7] for feet in path], axis=0)
    assert np.all(steps <= 1e-9)
    assert path[-1].frequency_hz[0] >= LOWEST_SHARE * path[0].frequency_hz[0]


def test_every_step_holds_modes_of_the_structure_on_these_springs(
    assembly: Assembly, path: tuple[Feet, ...]
) -> None:
    feet = next(feet for feet in path if feet.stiffness_n_m < 1e9)
    support = on_translations(assembly.structure, Prony(k0=feet.stiffness_n_m))
    modes = undamped_modes(build_system(assembly, support), 16)
    near = np.abs(modes.frequency_hz[:, None] / feet.frequency_hz - 1.0).min(axis=0)
    # one step of inverse iteration from feet 1.8 times as stiff: pairing takes frequencies 7 % apart for one
    assert_allclose(near, 0.0, atol=5e-4)
    # an exactly symmetric pair may turn in its plane: its share of the plane of the next step is kept
    plane = mass_mac(assembly.mass, path[1].shapes[:, :2], path[0].shapes[:, :2]).sum(axis=0)
    assert_allclose(plane, 1.0, atol=1e-3)  # 1e11 N/m changes the first pair by no more


def test_a_second_pair_on_soft_feet_is_paired_by_the_path_and_not_by_pins(
    assembly: Assembly, path: tuple[Feet, ...]
) -> None:
    """On springs of 5e8 N/m the second bending pair is a third lower than on pins: no near miss."""
    support = on_translations(assembly.structure, Prony(k0=5e8))
    truth = undamped_modes(build_system(assembly, support), 8)
    sensors = tuple(
        Sensor(f"{axis}{height}", direction, None, height)
        for height in (88.0, 55.0, 21.0)
        for axis, direction in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
    )
    seen = observation_matrix(assembly, sensors)
    bending = [i for i, x in enumerate((seen @ truth.shapes).T) if np.linalg.norm(x) > 1e-6][:4]
    measured = tuple(
        ModalEstimate(
            float(truth.frequency_hz[i]), 0.01, (seen @ truth.shapes[:, i]).astype(complex), 1.0, 0.0, 1.0
        )
        for i in bending
    )
    pinned = pair(measured, path[0].frequency_hz, seen @ path[0].shapes)
    best = max(path, key=lambda feet: pairing_score(measured, feet.frequency_hz, seen @ feet.shapes))
    found = pair(measured, best.frequency_hz, seen @ best.shapes)
    assert 2.5e8 < best.stiffness_n_m < 1e9
    assert sorted(index for index, _ in found.values()) == [0, 1, 2, 3]
    assert all(subspace_mac > 0.99 for _, subspace_mac in found.values())
    assert sorted(index for index, _ in pinned.values()) == [0, 1]


@pytest.mark.parametrize("arm", [0.0, -1.8])
def test_modes_that_mix_as_they_cross_keep_their_names(arm: float, tmp_path: Path) -> None:
    """A nacelle beside the axis lets torsion and second side-side mix where softer feet make them cross."""
    file = tmp_path / "jacket.yaml"
    file.write_text(CROSSING.replace("ARM", str(arm)))
    assembly = assemble(read_structure(str(file)), gravity=True)
    numbered = numbered_modes(assembly, 10)
    path = modes_by_foot_stiffness(assembly, numbered)
    torsion = mode_labels(mode_kinds(assembly, numbered.shapes, numbered.frequency_hz)).index("torsion_1")
    soft = next(feet for feet in path if feet.stiffness_n_m < 5e8)
    order = np.argsort(soft.frequency_hz)
    kinds = mode_kinds(assembly, soft.shapes[:, order], soft.frequency_hz[order])
    assert kinds[list(order).index(torsion)] == "torsion"
    # below second side-side on pins, above it here: they did cross
    assert torsion == 2 and soft.frequency_hz[torsion] > np.sort(soft.frequency_hz)[3]


def test_clamped_feet_have_no_softer_ones() -> None:
    assembly = assemble(monopile_structure())
    (alone,) = modes_by_foot_stiffness(assembly, numbered_modes(assembly, 4))
    assert alone.stiffness_n_m == np.inf
