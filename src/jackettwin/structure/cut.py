"""Cut of a structure at its interface into foundation and tower."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jackettwin.errors import require
from jackettwin.structure.model import Structure, reached_by

if TYPE_CHECKING:
    from collections.abc import Iterable


def at_interface(structure: Structure) -> tuple[Structure, Structure | None]:
    """Return (foundation, rest): what is joined to the ground without passing the interface, and the rest.

    Masses on interface nodes and members between two of them belong to the foundation. The rest is None if
    nothing stands on the interface. Without any reaction node the structure floats, or hangs on its
    interface: all of it is foundation but the tower.

    Raises
    ------
    InputError
        If the structure has no interface nodes, or nothing below them.
    """
    interface = set(structure.interface_nodes)
    require(
        interface,
        "the structure has no interface",
        field="interface_nodes",
        value=[],
        remedy="name the nodes that carry what stands on the foundation: `interface_nodes` of a file, or "
        "`--interface NODE,…` where a deck does not state them",
    )
    inside = reached_by(structure.joined, _grounded(structure) - interface, stop=interface)
    require(
        inside,
        "no reaction node stands below the interface",
        field="reaction_nodes",
        value=list(structure.reaction_nodes),
        remedy="name the nodes that stand on the ground",
    )
    foundation = inside | interface
    every = structure.bars
    below = [m.name for m in every if {m.start, m.end} <= foundation]
    above = [m.name for m in every if not {m.start, m.end} <= foundation]
    rest = set(structure.nodes) - foundation
    base = replace(_part(structure, foundation, below), interface_nodes=structure.interface_nodes)
    if not rest:
        return base, None
    top = replace(_part(structure, rest | interface, above), reactions=())
    return base, replace(top, masses=tuple(m for m in top.masses if m.node in rest))


def _grounded(structure: Structure) -> set[str]:
    """Return the reaction nodes; of a structure without them, every node that is not the tower's."""
    if structure.reactions:
        return set(structure.reaction_nodes)
    tower = {node for m in structure.bars if m.part == "tower" for node in (m.start, m.end)}
    return set(structure.nodes) - tower


def _part(structure: Structure, nodes: set[str], members: Iterable[str]) -> Structure:
    names = set(members)
    used = {n for m in structure.bars if m.name in names for n in (m.start, m.end)}
    links = tuple(link for link in structure.rigid_links if {link.leader, link.follower} <= nodes)
    elements = tuple(e for e in structure.elements if {e.start, e.end} <= nodes)
    used |= {n for link in links for n in (link.leader, link.follower)}
    used |= {n for element in elements for n in (element.start, element.end)}
    return replace(
        structure,
        nodes={name: xyz for name, xyz in structure.nodes.items() if name in used},
        members=tuple(m for m in structure.members if m.name in names),
        beams=tuple(m for m in structure.beams if m.name in names),
        masses=tuple(m for m in structure.masses if m.node in used),
        rigid_links=links,
        elements=elements,
        reactions=tuple(r for r in structure.reactions if r.node in used),
        interface_nodes=tuple(n for n in structure.interface_nodes if n in used),
    )
