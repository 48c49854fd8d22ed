"""Options for the interface and reaction joints of a foundation, for decks that do not state them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import click

from jackettwin.errors import look_up

if TYPE_CHECKING:
    from jackettwin.structure import Structure

Command = TypeVar("Command", bound=Callable[..., Any])


def joint_options(command: Command) -> Command:
    """Add ``--interface`` and ``--feet`` to a command."""
    feet = click.option("--feet", metavar="NODE,…", help="Nodes at the ground; default: the structure's own.")
    interface = click.option(
        "--interface", metavar="NODE,…", help="Nodes that carry the tower; default: the structure's own."
    )
    return interface(feet(command))


def with_joints(structure: Structure, interface: str | None, feet: str | None) -> Structure:
    """Return the structure with the interface and the reaction nodes that options name.

    Raises
    ------
    InputError
        If the structure has no such node.
    """
    from jackettwin.structure import Reaction

    def named(text: str, option: str) -> tuple[str, ...]:
        names = tuple(name.strip() for name in text.split(","))
        for name in names:
            look_up(structure.nodes, name, "node", field=option, remedy="`jackettwin view` shows the nodes")
        return names

    if feet is not None:
        own = {reaction.node: reaction for reaction in structure.reactions}
        nodes = named(feet, "--feet")
        structure = replace(structure, reactions=tuple(own.get(n, Reaction(n)) for n in nodes))
    if interface is not None:
        structure = replace(structure, interface_nodes=named(interface, "--interface"))
    return structure
