"""Decks written and read again are the same structure."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.decks.subdyn_writer import write_subdyn
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import clamped, on_translations, own_support, pinned, with_static_reactions
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.laws.viscoelastic import Prony, kelvin_voigt
from jackettwin.structure import Structure, assemble
from jackettwin.structure.cut import at_interface
from jackettwin.structure.model import PointMass, RigidLink

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"
OTHERS = Path(__file__).parents[2] / "qualify" / "decks"


def frequencies(structure) -> np.ndarray:
    return undamped_modes(build_system(assemble(structure), own_support(structure)), 8).frequency_hz


def test_a_deck_survives_unchanged(tmp_path: Path) -> None:
    """Old format in, new format out: every joint, member, mass and reaction to the last bit."""
    old = read_structure(DECK)
    files = write_subdyn(old, tmp_path / "deck.dat")
    assert len(files) == 2  # three reactions, one ground
    assert replace(read_structure(files[0]), name=old.name) == old


def own_ground(base: Structure, kind: str) -> Structure:
    """Give the feet of a structure a stiffness and a mass of their own, coupled as a pile's head is."""
    rng = np.random.default_rng(5)
    root = rng.normal(size=(6, 6))
    block = tuple(map(tuple, root @ root.T))
    ground = {"K": (block, None), "M": (None, block), "KM": (block, block), "": (None, None)}[kind]
    stiffness = None if ground[0] is None else tuple(tuple(1e9 * v for v in row) for row in ground[0])
    mass = None if ground[1] is None else tuple(tuple(1e5 * v for v in row) for row in ground[1])
    return replace(base, reactions=tuple(replace(r, stiffness=stiffness, mass=mass) for r in base.reactions))


@pytest.mark.parametrize("kind", ["", "K", "M", "KM"])
@pytest.mark.parametrize("support", ["own", "pinned", "clamped", "springs", "piles"])
@pytest.mark.parametrize("name", ["jacket15", "deck", "three_legs.yaml", "oc3_tripod.dat", "oc4_jacket.dat"])
def test_what_is_read_back_has_the_same_matrices(name: str, support: str, kind: str, tmp_path: Path) -> None:
    """Stiffness and mass, to rounding, of a structure on every kind of support."""
    whole = {"jacket15": "jacket15", "deck": DECK}.get(name, OTHERS / name)
    base = at_interface(read_structure(whole))[0]
    base = own_ground(replace(base, rotary_inertia=True), kind)
    held = {
        "own": own_support,
        "pinned": pinned,
        "clamped": clamped,
        "springs": lambda s: on_translations(s, Prony(k0=2.5e9)),
        "piles": lambda s: read_foundation("jacket15").heads(s),
    }[support](base)
    before = build_system(assemble(base), held).pencil
    deck = write_subdyn(with_static_reactions(base, held), tmp_path / "deck.dat")[0]
    again = read_structure(deck)
    after = build_system(assemble(again), own_support(again)).pencil
    for old, new in ((before.M, after.M), (before.static_stiffness(), after.static_stiffness())):
        # z is counted from the sea level in a deck: lengths differ by their rounding
        np.testing.assert_allclose(new.toarray(), old.toarray(), rtol=0.0, atol=1e-11 * abs(old).max())


def test_a_jacket_on_piles_becomes_a_deck(tmp_path: Path) -> None:
    """Names become numbers and z is counted from the sea level; mass and frequencies stay."""
    base, _ = at_interface(read_structure("jacket15"))
    held = with_static_reactions(base, read_foundation("jacket15").heads(base))
    again = read_structure(write_subdyn(held, tmp_path / "jacket.dat")[0])
    # SubDyn's beams have rotary inertia
    np.testing.assert_allclose(frequencies(again), frequencies(replace(held, rotary_inertia=True)), rtol=1e-9)
    assert min(z for _, _, z in again.nodes.values()) == pytest.approx(-72.0)


def test_links_and_several_masses_on_a_joint(tmp_path: Path) -> None:
    base, _ = at_interface(read_structure("jacket15"))
    base = replace(
        base,
        nodes=dict(base.nodes) | {"platform": (3.0, 1.0, 101.0)},
        rigid_links=(RigidLink("tp_top", "platform"),),
        masses=(
            PointMass("leg_1_2", 5e4, (1.0, 0.0, 2.0), (1e6, 2e6, 3e6, 1e5, 2e5, 3e5)),
            PointMass("leg_1_2", 2e4, (0.0, -1.0, 0.5)),
            PointMass("platform", 1e5),
            PointMass("leg_2_2", 0.0, inertia_kg_m2=(1e6, 1e6, 2e6, 0.0, 0.0, 0.0)),
        ),
        rotary_inertia=True,
    )
    held = with_static_reactions(base, on_translations(base, kelvin_voigt(2.5e9, 7.6e8)))
    again = read_structure(write_subdyn(held, tmp_path / "jacket.dat")[0])
    np.testing.assert_allclose(frequencies(again), frequencies(held), rtol=1e-9)


def test_what_no_deck_can_hold_is_refused(tmp_path: Path) -> None:
    base, _ = at_interface(read_structure("jacket15"))
    with pytest.raises(InputError, match="interface joints"):
        write_subdyn(replace(base, interface_nodes=()), tmp_path / "deck.dat")
    piled, support = read_foundation("jacket15").piled(base)
    with pytest.raises(InputError, match="no reaction node"):
        with_static_reactions(piled, support)
