"""Tolerances as twin files state them, and which members, bodies and waters they touch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.twin import TwinConfig, read_twin
from jackettwin.twin.config import assembled
from jackettwin.twin.tolerances.parts import legs, part_of
from jackettwin.twin.tolerances.registry import (
    REMAINDERS,
    TOLERANCES,
    directions,
    suspects,
    tolerances,
)

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
