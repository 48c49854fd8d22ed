"""Parts of a structure on pinned feet, for the comparison of thesis section 5.4."""

from __future__ import annotations

from dataclasses import dataclass, replace

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, require
from jackettwin.response import UndampedModes
from jackettwin.structure import Assembly, Structure, assemble, check
from jackettwin.updating.band import numbered_modes


def only_parts(structure: Structure, parts: tuple[str, ...]) -> Structure:
    """Return the structure with only some of its parts and the bodies on their nodes.

    Raises
    ------
    InputError
        If no member belongs to a part, or the parts are not joined to each other and to every foot.
    """
    known = sorted({member.part for member in structure.bars})
    for part in parts:
        require(part in known, "no such part", field="parts", value=part, allowed=", ".join(known))
    members = tuple(member for member in structure.members if member.part in parts)
    beams = tuple(beam for beam in structure.beams if beam.part in parts)
    used = _nodes_of(structure, parts)
    try:
        return replace(
            structure,
            nodes={name: xyz for name, xyz in structure.nodes.items() if name in used},
            members=members,
            beams=beams,
            masses=tuple(mass for mass in structure.masses if mass.node in used),
            rigid_links=tuple(link for link in structure.rigid_links if {link.leader, link.follower} <= used),
            elements=tuple(e for e in structure.elements if {e.start, e.end} <= used),
            interface_nodes=tuple(node for node in structure.interface_nodes if node in used),
        )
    except InputError as error:
        left_out = ", ".join(part or "members of no named part" for part in known if part not in parts)
        if not left_out:
            raise
        raise InputError(
            "these parts are not joined to each other and to every foot",
            field="parts",
            value=list(parts),
            remedy=f"they leave out {left_out}: add what joins them",
        ) from error


def _nodes_of(structure: Structure, parts: tuple[str, ...]) -> set[str]:
    """Return the nodes of the bars of some parts, and those without bars that are joined to them.

    Where members have offsets, a foot is such a node: a rigid link leads from it to the member's end.
    """
    ends = {node for bar in structure.bars for node in (bar.start, bar.end)}
    used = {node for bar in structure.bars if bar.part in parts for node in (bar.start, bar.end)}
    joints = [{link.leader, link.follower} for link in structure.rigid_links]
    joints += [{element.start, element.end} for element in structure.elements]
    while more := {node for pair in joints if pair & used for node in pair - used - ends}:
        used |= more
    return used


@dataclass(frozen=True)
class Stage:
    """Some parts of a structure on pinned feet.

    Attributes
    ----------
    parts : names of the parts in this stage
    added : parts that the previous stage does not have
    mass_kg : float
    assembly : Assembly
    modes : UndampedModes
    """

    parts: tuple[str, ...]
    added: tuple[str, ...]
    mass_kg: float
    assembly: Assembly
    modes: UndampedModes

    @property
    def frequency_hz(self) -> FloatArray:
        """Undamped frequencies (n_modes,)."""
        return self.modes.frequency_hz

    @property
    def name(self) -> str:
        """``jacket``, then ``+ transition_piece`` and so on: the parts added last."""
        if self.parts == ("",):
            return "whole structure"
        last = ", ".join(part or "members of no named part" for part in self.added)
        return last if self.added == self.parts else f"+ {last}"


def stages(structure: Structure, number: int, *, gravity: bool = False) -> tuple[Stage, ...]:
    """Return a stage for every part, in the order of the structure; the last is the whole structure.

    Parts that are not connected with the previous ones, such as legs that are joined only by braces, are
    added with the next part.
    """
    parts = _in_order(structure) or ("",)
    found: list[Stage] = []
    before = 0
    for k in range(1, len(parts) + 1):
        standing: Structure | None = (
            structure  # the whole structure includes nodes without members, e.g. ends of rigid links
        )
        if k < len(parts):
            standing = _if_joined(structure, parts[:k])
        if standing is None:
            continue
        assembly = assemble(standing, gravity=gravity)
        mass, modes = check(assembly).mass_kg, numbered_modes(assembly, number)
        found.append(Stage(parts[:k], parts[before:k], mass, assembly, modes))
        before = k
    return tuple(found)


def _in_order(structure: Structure) -> tuple[str, ...]:
    """Return the parts as they are built.

    A structure lists its beams behind its tubes, so that a part of beams alone, e.g. a transition piece of
    box girders, has lost its place: it comes before the part that nothing connects without it.
    """
    parts = list(dict.fromkeys(one.part for one in structure.bars))
    tubes = {member.part for member in structure.members}
    for beams in [part for part in parts if part not in tubes]:
        others = [part for part in parts if part != beams]
        for k in range(1, len(others)):
            standing = (*others[:k], beams)
            if _if_joined(structure, standing) and not _if_joined(structure, tuple(others[: k + 1])):
                parts = [*standing, *others[k:]]
                break
    return tuple(parts)


def _if_joined(structure: Structure, parts: tuple[str, ...]) -> Structure | None:
    """Return some parts of the structure; None if they are not connected to each other and all feet."""
    try:
        return only_parts(structure, parts)
    except InputError:
        return None
