"""Cutting at the interface loses nothing and doubles nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.structure import assemble, check
from jackettwin.structure.cut import at_interface

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"


def test_the_parts_weigh_what_the_whole_weighs() -> None:
    whole = read_structure("jacket15")
    base, top = at_interface(whole)
    assert top is not None
    parts = [check(assemble(part)).mass_kg for part in (base, top)]
    assert sum(parts) == pytest.approx(check(assemble(whole)).mass_kg, rel=1e-12)
    assert {m.part for m in base.members} == {"jacket", "transition_piece"}
    assert {m.part for m in top.members} == {"tower"}
    assert top.masses == whole.masses
    assert not top.reactions


def test_a_deck_is_all_foundation() -> None:
    """Masses on the interface joints stay with it."""
    deck = read_structure(DECK)
    base, top = at_interface(deck)
    assert top is None
    assert (base.members, base.masses) == (deck.members, deck.masses)


def test_what_cannot_be_cut_is_refused() -> None:
    whole = read_structure("jacket15")
    with pytest.raises(InputError, match="has no interface"):
        at_interface(replace(whole, interface_nodes=()))
    with pytest.raises(InputError, match="no reaction node stands below"):
        at_interface(replace(whole, interface_nodes=whole.reaction_nodes))


def test_what_floats_is_cut_above_its_interface() -> None:
    whole = read_structure("jacket15")
    base, top = at_interface(replace(whole, reactions=()))
    assert top is not None
    assert [m.name for m in base.members] == [m.name for m in at_interface(whole)[0].members]
    assert {m.part for m in top.members} == {"tower"}


def test_the_deck_s_mass_ignores_shear() -> None:
    """SubDyn puts Euler–Bernoulli masses under Timoshenko stiffness."""
    deck = read_structure(DECK)
    assert deck.beam == "timoshenko"
    shear = assemble(replace(deck, shear_in_mass=True)).mass
    plain = assemble(deck, beam_theory="euler-bernoulli", rotary_inertia=True).mass
    assert np.abs((assemble(deck).mass - plain).data).max(initial=0.0) == 0.0
    assert np.abs((shear - plain).data).max() > 0.0
