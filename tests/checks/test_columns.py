"""Columns of a frame: their lengths, and which of them are cantilevers."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.checks.columns import StraightRun, columns
from jackettwin.decks import read_structure
from jackettwin.structure import Section, Structure
from jackettwin.structure.model import STEEL, Beam, Member, Reaction, RigidLink
from jackettwin.structure.sections import rectangular_section
from jackettwin.structure.two_node import two_node_element

TUBE = Section(1.0, 0.02)


def frame(nodes: dict[str, tuple[float, float, float]], *joined: str, feet: str = "a") -> Structure:
    """A frame whose nodes have one letter and whose members are named by two."""
    members = tuple(Member(pair, pair[0], pair[1], TUBE, TUBE, STEEL) for pair in joined)
    return Structure("frame", nodes, members, reactions=tuple(Reaction(node) for node in feet))


MAST = {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 10.0), "c": (0.0, 0.0, 25.0)}


def test_a_mast_is_one_cantilever() -> None:
    assert columns(frame(MAST, "ab", "bc")) == dict.fromkeys(("ab", "bc"), StraightRun(25.0, True))


def test_a_beam_that_is_no_tube_goes_on_with_the_column() -> None:
    """The upper half of a mast in another section: the tube below buckles with the whole."""
    tubes = (Member("ab", "a", "b", TUBE, TUBE, STEEL),)
    rows = np.eye(12)
    upper = Beam("bc", "b", "c", rectangular_section(2.0, 1.0, 0.0, poisson_ratio=0.3), STEEL)
    mast = Structure("mast", MAST, tubes, reactions=(Reaction("a"),), beams=(upper,))
    assert columns(mast)["ab"] == StraightRun(25.0, True)
    # a spring to the ground beside it holds the joint
    spring = two_node_element("bg", "spring", ("b", "g"), rows)
    held = replace(
        mast,
        nodes=MAST | {"g": (9.0, 0.0, 10.0)},
        reactions=(Reaction("a"), Reaction("g")),
        elements=(spring,),
    )
    assert columns(held)["ab"] == StraightRun(10.0, False)


def test_a_foot_in_the_middle_ends_a_column() -> None:
    found = columns(frame(MAST, "ab", "bc", feet="ab"))
    assert found == {"ab": StraightRun(10.0, False), "bc": StraightRun(15.0, True)}


def test_what_hangs_on_a_mast_does_not_hold_it() -> None:
    """A platform by a member, a box by a rigid link, a nacelle on top."""
    hung = MAST | {"p": (4.0, 0.0, 10.0), "n": (-5.0, 0.0, 26.0)}
    structure = frame(hung, "ab", "bc", "bp", "cn")
    mast = replace(structure, nodes=hung | {"q": (0.0, 2.0, 10.0)}, rigid_links=(RigidLink("b", "q"),))
    found = columns(mast)
    assert found["ab"] == found["bc"] == StraightRun(25.0, True)
    assert found["bp"] == StraightRun(4.0, True)


def test_a_stay_to_the_ground_holds_it() -> None:
    stayed = MAST | {"s": (8.0, 0.0, 0.0)}
    found = columns(frame(stayed, "ab", "bc", "bs", feet="as"))
    assert found["ab"] == StraightRun(10.0, False)
    assert found["bc"] == StraightRun(15.0, True)
    assert not found["bs"].is_cantilever


def test_names_of_parts_do_not_matter() -> None:
    """jacket15 without its parts, as a SubDyn deck has it: one cantilever, the tower of 116 m."""
    structure = read_structure("jacket15")
    plain = replace(structure, members=tuple(replace(m, part="") for m in structure.members))
    found = columns(plain)
    assert {name for name in found if found[name].is_cantilever} == {f"tower_{k}" for k in range(1, 13)}
    assert found["tower_6"].length_m == pytest.approx(116.0)
    bay = np.linalg.norm(np.subtract(structure.nodes["leg_1_1"], structure.nodes["foot_1"]))
    assert found["leg_1_bay_1"].length_m == pytest.approx(bay)


def test_a_transition_piece_ties_the_legs_of_a_deck() -> None:
    """Two posts alone are cantilevers; as joints of one interface they hold each other."""
    posts = {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 10.0), "c": (9.0, 0.0, 0.0), "d": (9.0, 0.0, 10.0)}
    braced = frame(posts, "ab", "cd", "ac", feet="ac")
    assert columns(braced)["ab"].is_cantilever
    assert not columns(replace(braced, interface_nodes=("b", "d")))["ab"].is_cantilever
