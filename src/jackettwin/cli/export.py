"""``jackettwin export``: a foundation as an OpenFAST SubDyn input file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jackettwin.cli.console import Reply, answers, messages, say
from jackettwin.cli.joints import joint_options, with_joints
from jackettwin.cli.modes import pile_model_option, supported_option
from jackettwin.cli.omissions import of_export
from jackettwin.errors import InputError

if TYPE_CHECKING:
    from jackettwin.soil import PileModel, Support
    from jackettwin.structure import Structure


@click.command("export")
@click.argument("structure")
@click.option(
    "--support",
    help="pinned, clamped, LAW:arguments, a foundation or a YAML file; default: the structure's own.",
)
@pile_model_option
@joint_options
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="FILE.dat: a SubDyn input file; default out/NAME_SubDyn.dat.",
)
@answers
def export_command(
    structure: str,
    support: str | None,
    pile_model: PileModel | None,
    interface: str | None,
    feet: str | None,
    out: Path | None,
) -> Reply:
    """Write the foundation of STRUCTURE as a SubDyn input file.

    The foundation is the part below the interface. Nodes of piles modelled as members become reaction joints.
    """
    from jackettwin.decks import read_deck_damping, read_structure, write_subdyn
    from jackettwin.soil import held_where_sprung, with_static_reactions
    from jackettwin.structure import assemble, at_interface

    if out is not None and out.suffix.lower() != ".dat":
        raise InputError("unknown format of a deck", field="--out", value=out.name, allowed=".dat")
    named = with_joints(read_structure(structure), interface, feet)
    whole, held = supported_option(support, assemble(named), pile_model)
    whole = held_where_sprung(whole, held)
    foundation, _ = at_interface(whole)
    path = out or Path("out") / f"{whole.name}_SubDyn.dat"
    deck = Path(structure).suffix.lower() == ".dat"
    damping, warnings = read_deck_damping(Path(structure)) if deck else None, _warnings(whole, held)
    if damping is not None and interface is not None and damping.interface.any():
        damping = replace(damping, interface=0.0 * damping.interface)
        warnings.append("the deck's damping matrix is of its own interface: it is left out")
    files = [str(file) for file in write_subdyn(with_static_reactions(foundation, held), path, damping)]
    for warning in warnings:
        messages.print(f"warning: {warning}")
    return Reply(
        {
            "structure": whole.name,
            "files": files,
            "warnings": warnings,
            "left_out": of_export(damping=damping is None),
        },
        lambda: say("wrote " + ", ".join(files)),
    )


def _warnings(whole: Structure, held: Support) -> list[str]:
    found = []
    if any(spring.law.dissipates for spring in held.springs):
        found.append("a deck has no damping of the ground; a superelement has")
    if not whole.rotary_inertia or (whole.beam == "timoshenko" and whole.shear_in_mass):
        found.append("SubDyn adds rotary inertia to its beams, and neglects shear in their mass")
    return found
