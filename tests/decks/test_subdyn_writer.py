"""Decks written and read again are the same structure."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.cli.joints import with_joints
from jackettwin.decks import read_structure
from jackettwin.decks.subdyn import DeckDamping, read_deck_damping
from jackettwin.decks.subdyn_writer import write_subdyn
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.superelement.craig_bampton import superelement
from jackettwin.response.superelement.files import read_superelement, write_superelement
from jackettwin.response.system import build_system
from jackettwin.soil import clamped, on_translations, own_support, pinned, with_static_reactions
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.laws.viscoelastic import Prony, kelvin_voigt
from jackettwin.structure import Rayleigh, Structure, assemble
from jackettwin.structure.cut import at_interface
from jackettwin.structure.model import PointMass, RigidLink

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"
SACS = Path(__file__).parents[1] / "data" / "sacs"
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


@pytest.mark.parametrize(
    ("support", "kind"),
    [
        *(("own", kind) for kind in ("", "K", "M", "KM")),
        ("pinned", "KM"),
        ("clamped", "K"),
        ("springs", ""),
        ("piles", "M"),
        ("piles", "KM"),
    ],
)
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


@pytest.mark.parametrize(
    ("name", "interface", "feet"),
    [
        ("tripod.sacs", "2", None),
        ("tripod.sacs", "1,601L", "001P,002P,003P"),
        ("k_braced.yaml", None, None),
        ("deck_and_tower.yaml", None, None),
        ("square.yaml", None, None),
        ("uneven_legs.yaml", None, None),
        ("tripod_lattice.dat", None, None),
    ],
)
def test_every_structure_comes_back_from_deck_and_superelement(
    name: str, interface: str | None, feet: str | None, tmp_path: Path
) -> None:
    """M, K and C of SACS decks, K-braces, a tower on its deck, square and uneven legs, mass in the ground.

    A deck holds M and K, and a superelement the dashpots of the ground as well.
    """
    place = SACS if name.endswith(".sacs") else OTHERS
    whole = with_joints(read_structure(place / name), interface, feet)
    base = own_ground(replace(at_interface(whole)[0], rotary_inertia=True), "KM")
    before = build_system(assemble(base), own_support(base)).pencil
    again = read_structure(write_subdyn(base, tmp_path / "deck.dat")[0])
    after = build_system(assemble(again), own_support(again)).pencil
    for old, new in ((before.M, after.M), (before.static_stiffness(), after.static_stiffness())):
        np.testing.assert_allclose(new.toarray(), old.toarray(), rtol=0.0, atol=1e-11 * abs(old).max())
    damped = build_system(
        assemble(base), on_translations(base, kelvin_voigt(2.5e9, 7.6e8)), rayleigh=Rayleigh(0.01, 0.002)
    )
    element = superelement(damped, number=4, band_hz=3.0)
    for kind in ("se.npz", "se.dat"):
        back = read_superelement(write_superelement(element, tmp_path / kind)[0])
        for key in ("M", "K", "C"):
            own = getattr(element, key)
            np.testing.assert_allclose(getattr(back, key), own, rtol=0.0, atol=1e-13 * abs(own).max())
    assert abs(element.C).max() > 0.0


@pytest.mark.parametrize("way", ["modes alone", "rayleigh", "matrix"])
def test_a_deck_s_own_damping_is_exported(way: str, tmp_path: Path) -> None:
    """C of what is read back, too: `export` of a deck wrote 1 % whatever the deck had said."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(6, 6))
    damping = DeckDamping(
        (0.02, 0.015, 0.007),
        *((0.01, 0.002) if way == "rayleigh" else (0.0, 0.0)),
        1e5 * root @ root.T if way == "matrix" else np.zeros((6, 6)),
    )
    deck, again = tmp_path / "deck.dat", tmp_path / "again.dat"
    write_subdyn(read_structure(DECK), deck, damping)
    run = CliRunner().invoke(main, ["export", str(deck), "--out", str(again), "--json"])
    assert run.exit_code == 0, run.stderr
    assert not any("own damping" in one["what"] for one in json.loads(run.stdout)["left_out"])
    back = read_deck_damping(again)
    assert back.modal == pytest.approx(damping.modal, rel=1e-14)
    assert (back.alpha, back.beta) == (damping.alpha, damping.beta)
    np.testing.assert_array_equal(back.interface, damping.interface)
    # a matrix is of the interface that the deck names
    run = CliRunner().invoke(main, ["export", str(deck), "--interface", "1", "--out", str(again), "--json"])
    assert run.exit_code == 0, run.stderr
    assert ("it is left out" in run.stderr) is (way == "matrix")
    assert not read_deck_damping(again).interface.any()


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
