"""Members and nodes that the output channels of a SubDyn deck (M1N1FKze, M1N1MKxe …) refer to."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast import read_deck, to_integer
from jackettwin.decks.subdyn_joints import member_rows
from jackettwin.decks.subdyn_members import deck_axes
from jackettwin.errors import located, look_up, require
from jackettwin.structure import Structure

SECTION_CHANNELS = ("FKze", "MKxe", "MKye")
"""Ends of the channels of axial force and bending moments about local x and y."""


class MemberOutput(NamedTuple):
    """A node of a member whose forces a deck asks for.

    Attributes
    ----------
    prefix : "M1N1" …, as its channels begin
    member : str
    position : share of the member's length from its start
    axes : (2, 3) SubDyn's local x and y, about which MKxe and MKye turn, in global axes
    """

    prefix: str
    member: str
    position: float
    axes: FloatArray


def member_outputs(path: Path, structure: Structure) -> tuple[MemberOutput, ...]:
    """Return the nodes of members whose forces a deck asks for; none if it asks for none.

    Parameters
    ----------
    structure : as it was read from the deck

    Raises
    ------
    InputError
        If the table names a member or a node that is not there.
    """
    deck = read_deck(path)
    with located(file=path):
        if deck.find("NMOutputs") is None:
            return ()
        divisions = max(1, to_integer(deck.scalar("NDiv", "1"), "NDiv"))
        spins = {row["memberid"]: row.number("mspin", 0.0) for row in member_rows(deck) if "mspin" in row}
        members, found = {m.name: m for m in structure.members}, []
        for k, row in enumerate(deck.table("NMOutputs"), start=1):
            name = row["memberid"]
            member = look_up(members, name, "member", field=row.place("memberid"))
            count = to_integer(row["noutcnt"], row.place("noutcnt"))
            words = deck.lines[row.line - 1].split()[2 : 2 + count]
            pieces = member.elements or divisions
            a, b = (np.array(structure.nodes[node]) for node in (member.start, member.end))
            axes = deck_axes(a, b, spins.get(name, 0.0))[1:]
            for j, word in enumerate(words, start=1):
                node = to_integer(word, row.place("nodecnt"))
                require(
                    1 <= node <= pieces + 1, "is no node of the member", field=row.place("nodecnt"),
                    value=node, allowed=f"1 to {pieces + 1}",
                )  # fmt: skip
                found.append(MemberOutput(f"M{k}N{j}", name, (node - 1) / pieces, axes))
        return tuple(found)
