"""Stages: the last is the whole, masses add up, the numbers of reproduce's tables."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.structure import RigidLink, assemble, check
from jackettwin.updating import numbered_modes
from jackettwin.updating.steel import stages

DECKS = Path(__file__).parents[2] / "qualify" / "decks"


def test_jacket15_part_by_part() -> None:
    structure = read_structure("jacket15")
    jacket, piece, full = stages(structure, 5)
    assert [stage.name for stage in (jacket, piece, full)] == ["jacket", "+ transition_piece", "+ tower"]
    assert jacket.mass_kg < piece.mass_kg < full.mass_kg
    assert full.mass_kg == pytest.approx(check(assemble(structure)).mass_kg, rel=1e-12)
    np.testing.assert_array_equal(full.frequency_hz, numbered_modes(assemble(structure), 5).frequency_hz)
    # the calibrated reference jacket, printed with three digits
    np.testing.assert_allclose(jacket.frequency_hz, [0.836, 0.957, 0.957, 1.016, 1.637], rtol=1e-3)


def test_legs_that_only_braces_join_are_no_stage_of_their_own() -> None:
    """As in a SACS deck, whose groups are its parts: the legs come with the braces."""
    whole = read_structure("jacket15")
    members = tuple(replace(m, part="legs") if m.name.startswith("leg") else m for m in whole.members)
    legs_first = tuple(sorted(members, key=lambda m: m.part != "legs"))
    first, *_, full = stages(replace(whole, members=legs_first), 2)
    assert first.parts == first.added == ("legs", "jacket")
    assert first.name == "legs, jacket"
    np.testing.assert_allclose(first.frequency_hz, stages(whole, 2)[0].frequency_hz, rtol=1e-9)
    assert full.name == "+ tower"


def test_a_foot_beside_its_member_stands_in_every_stage() -> None:
    """As in a SACS deck with member offsets: a rigid link leads from the foot to the member."""
    whole = read_structure("jacket15")
    foot = whole.reaction_nodes[0]
    beside = f"{foot}:A"
    members = tuple(replace(m, start=beside) if m.start == foot else m for m in whole.members)
    moved = replace(
        whole,
        nodes={**whole.nodes, beside: whole.nodes[foot]},
        members=members,
        rigid_links=(*whole.rigid_links, RigidLink(foot, beside)),
    )
    assert [stage.name for stage in stages(moved, 2)] == ["jacket", "+ transition_piece", "+ tower"]
    np.testing.assert_allclose(stages(moved, 2)[0].frequency_hz, stages(whole, 2)[0].frequency_hz, rtol=1e-9)


def test_a_part_of_beams_alone_is_added_where_it_connects() -> None:
    """Girders between legs and tower came last, behind all tubes, so that there was no stage with them."""
    found = stages(read_structure(DECKS / "uneven_legs.yaml"), 2)
    assert [stage.name for stage in found] == ["jacket", "+ transition_piece", "+ tower"]
