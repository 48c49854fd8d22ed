"""Tolerances as twin files state them, and which members, bodies and waters they touch."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_flexible_rotor, read_structure
from jackettwin.errors import InputError
from jackettwin.response import damped_modes
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, with_rotor
from jackettwin.twin import TwinConfig, read_twin
from jackettwin.twin.config import assembled
from jackettwin.twin.tolerances.parts import legs, legs_by_foot, part_of
from jackettwin.twin.tolerances.registry import (
    REMAINDERS,
    TOLERANCES,
    directions,
    suspects,
    tolerances,
)
from jackettwin.updating import ErrorModel, ToleranceDirections, support_model

DECKS = Path(__file__).parents[2] / "qualify" / "decks"
TARGET = "targets: [{mode: 1, frequency_hz: 0.18, frequency_std_hz: 0.001}]\n"


def twin(folder: Path, text: str = "", structure: str = "jacket15") -> TwinConfig:
    path = folder / "twin.yaml"
    path.write_text(f"structure: {structure}\n{TARGET}{text}")
    return read_twin(path)


def names(config: TwinConfig) -> list[str]:
    return list(dict.fromkeys(one.tolerance.name for one in directions(config, assembled(config))))


def test_every_tolerance_says_where_it_is_from_and_what_settles_it() -> None:
    for known in tolerances().values():
        assert known.tolerance.source and known.tolerance.settled_by and known.tolerance.std > 0.0


def test_a_twin_that_says_nothing_has_all_that_its_structure_has(tmp_path: Path) -> None:
    found = names(twin(tmp_path))
    assert {"rna_mass", "tower_stiffness", "jacket_mass", "growth", "flooding", "feet_unlike"} <= set(found)
    assert not {"growth_thickness", "weak_leg"} & set(found)  # no growth is stated; a suspect is no tolerance


def test_stated_growth_is_as_thick_as_stated_by_a_share(tmp_path: Path) -> None:
    water = "water: {marine_growth: [{top_z_m: 2, bottom_z_m: -40, thickness_m: 0.05}]}\n"
    found = names(twin(tmp_path, water))
    assert "growth_thickness" in found and "growth_density" in found and "growth" not in found


@pytest.mark.parametrize(
    ("text", "closed"),
    [
        ("tolerances: {rna_mass: 0}", "rna_mass"),
        ("tolerances: {rna_mass: {weighed: true}}", "rna_mass"),
        ("tolerances: {growth: {std: 0.0}}", "growth"),
    ],
)
def test_what_was_weighed_is_closed(tmp_path: Path, text: str, closed: str) -> None:
    before = names(twin(tmp_path))
    assert closed in before
    assert names(twin(tmp_path, text)) == [name for name in before if name != closed]


def test_none_closes_all(tmp_path: Path) -> None:
    assert names(twin(tmp_path, "tolerances: none")) == []


def test_a_value_sizes_the_matrix(tmp_path: Path) -> None:
    """Twice the tolerance, twice the mass: linear in the RNA's mass, to rounding."""
    two = [twin(tmp_path, f"tolerances: {{rna_mass: {std}}}") for std in (0.01, 0.02)]
    mass = [next(d.mass for d in directions(c, assembled(c)) if d.tolerance.name == "rna_mass") for c in two]
    assert mass[0] is not None and mass[1] is not None
    np.testing.assert_allclose(mass[1].toarray(), 2.0 * mass[0].toarray(), rtol=1e-6, atol=1e-3)
    # one per cent of 809 t along x: the three translations of the body
    assert np.abs(mass[0].toarray()).max() > 8090.0


@pytest.mark.parametrize(
    ("text", "field", "allowed"),
    [
        ("tolerances: {rna_mas: 0.01}", "tolerances.rna_mas", "rna_mass"),
        ("tolerances: {rna_mass: {}}", "tolerances.rna_mass", "std"),
        ("tolerances: {rna_mass: -0.1}", "rna_mass", "0"),
    ],
)
def test_wrong_ones_are_refused_by_name(tmp_path: Path, text: str, field: str, allowed: str) -> None:
    with pytest.raises(InputError, match=field) as refused:
        twin(tmp_path, text)
    assert allowed in str(refused.value)


def test_parts_are_told_by_where_members_stand_if_the_file_does_not_say() -> None:
    """OC4's deck names no parts: eight members of its tower stand above the transition piece at 20.15 m."""
    structure = read_structure(DECKS / "oc4_jacket.dat")
    parts = part_of(structure)
    tower = [m for m in structure.members if parts[m.name] == "tower"]
    assert len(tower) >= 8
    assert min(structure.nodes[n][2] for m in tower for n in (m.start, m.end)) == pytest.approx(
        20.15, abs=0.1
    )
    low = [m for m in structure.members if max(structure.nodes[n][2] for n in (m.start, m.end)) < 16.0]
    assert {parts[m.name] for m in low} == {"jacket"}
    # four legs of several pieces each climb
    assert len(legs(structure)) >= 16


@pytest.mark.parametrize("deck", ["four_legs.yaml", "three_legs.yaml", "oc4_jacket.dat"])
def test_legs_flood_one_by_one(tmp_path: Path, deck: str) -> None:
    """Each leg is an unknown of its own, as heavy as the others, and every member is in one leg."""
    config = twin(tmp_path, structure=str(DECKS / deck))
    by_foot = legs_by_foot(config.structure)
    assert len(by_foot) == len(config.structure.reaction_nodes)
    assert sorted(name for names in by_foot for name in names) == sorted(legs(config.structure))
    assert len({len(names) for names in by_foot}) == 1
    each = [d for d in directions(config, assembled(config)) if d.tolerance.name == "flooding"]
    assert len(each) == len(by_foot)
    # equal to rounding of the coordinates that the files state
    heavy = [d.mass.diagonal().sum() for d in each if d.mass is not None]
    assert len(heavy) == len(each) and np.ptp(heavy) < 1e-3 * heavy[0]


def test_suspects_are_of_what_the_twin_ties_together(tmp_path: Path) -> None:
    tied = twin(tmp_path, "support: {tie: all}")
    split = twin(tmp_path, "support: {tie: horizontal-vertical}")
    found = [{d.tolerance.name for d in suspects(c, assembled(c))} for c in (tied, split)]
    assert "soft_sideways" in found[0] and "soft_sideways" not in found[1]
    assert "weak_leg" in found[0] & found[1]


def test_a_structure_on_land_has_no_sea(tmp_path: Path) -> None:
    source = (DECKS / "four_legs.yaml").read_text().replace("sea_level_z_m: 55.0", "sea_level_z_m: 0.0")
    (tmp_path / "land.yaml").write_text(source)
    found = names(twin(tmp_path, structure="land.yaml"))
    assert not {"growth", "added_mass", "flooding", "water_level"} & set(found)
    assert "rna_mass" in found


def test_the_page_is_the_registry() -> None:
    page = Path(__file__).parents[2] / "docs" / "reference" / "tolerances.md"
    rows = [line for line in page.read_text("utf-8").splitlines() if line.startswith("| `")]
    stated = {row.split("`")[1]: row.split("|")[3].strip() for row in rows}
    known = {name: f"{one.tolerance.std:g}" for name, one in TOLERANCES.items()}
    assert stated == known | {name: f"{std:g}" for name, std in REMAINDERS.items()}


def test_bending_blades_are_a_suspect_that_moves_modes_as_a_bending_rotor(tmp_path: Path) -> None:
    """jacket15 with the IEA 15 MW rotor's own modes, feathered, beside what the suspect says of a lumped one.

    The first pair falls by 0.3 %, the second rises by 6 to 7 %: half to twice of that to first order, for the
    second pair lies close above the blades. A twin that models its blades has no such suspect.
    """
    config, theta = twin(tmp_path), np.array([[2e9, 0.1]])
    assembly = assembled(config)
    found = [d for d in suspects(config, assembly) if d.tolerance.name == "bending_blades"]
    assert len(found) == 1
    model = support_model(
        assembly, family=family("maxwell-3"), rayleigh=Rayleigh.minimum(0.0055, 0.1832), highest_mode=5
    )
    near = model.predict_many(theta, (1, 2, 4, 5), slopes=False)
    own = ToleranceDirections(assembly, model.condensed, tuple(found), 1)
    said = ErrorModel(own).shifts(near)[0, 0, :, 0]
    structure = with_rotor(config.structure, read_flexible_rotor("iea15"), config.structure.top_node)
    bending = replace(config, structure=structure)
    there = support_model(
        assembled(bending), family=family("maxwell-3"), rayleigh=model.rayleigh, highest_mode=8
    ).system(theta[0])
    modes = damped_modes(there, below_hz=0.8)
    # the blades' own modes stand between the pairs, at 0.46 to 0.66 Hz
    hz = np.abs(modes.eigenvalues) / (2.0 * np.pi)
    true = np.log(
        np.concatenate([np.sort(hz)[:2], np.sort(hz)[-2:]]) / (np.abs(near.poles[0]) / (2.0 * np.pi))
    )
    assert (true[:2] < 0.0).all() and (true[2:] > 0.04).all()
    assert ((said / true > 0.5) & (said / true < 2.0)).all()
    assert not [d for d in suspects(bending, assembled(bending)) if d.tolerance.name == "bending_blades"]
