"""``jackettwin modes``: undamped and damped modes of a structure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.axes import DOFS_PER_NODE
from jackettwin.cli.comparison import comparison_of, show_comparison
from jackettwin.cli.console import PageFile, Reply, answers, numbers_of, say, say_all, show_table
from jackettwin.cli.omissions import of_modes
from jackettwin.errors import InputError, located, require
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.arrays import IntArray
    from jackettwin.response import DampedModes, System
    from jackettwin.soil import PileModel, Support
    from jackettwin.structure import Assembly, Rayleigh, Structure


pile_model_option = click.option(
    "--pile-model",
    type=click.Choice(["head", "members"]),
    help="Piles of a foundation lumped at the feet, or members on springs; default: as its file states.",
)
_OVERDAMPED = 0.3
"""Damping ratio above which a pole unlike all modes of the pinned structure is a motion of the supports."""


@click.command("modes")
@click.argument("structure")
@click.option(
    "--support", help="pinned, clamped, LAW:arguments, or a YAML file; default: the structure's own."
)
@pile_model_option
@click.option("--number", default=10, show_default=True, type=click.IntRange(1, 200), help="Number of modes.")
@click.option("--gravity", is_flag=True, help="Add the geometric (P-Δ) stiffness of the self-weight.")
@click.option(
    "--beam", type=click.Choice(["euler-bernoulli", "timoshenko"]), help="Default: the structure's own."
)
@click.option("--rotary-inertia", is_flag=True, default=None, help="Add rotary inertia.")
@click.option(
    "--subdivide", type=click.IntRange(1, 1000), help="Elements per member; default: the structure's own."
)
@click.option(
    "--rayleigh",
    metavar="ZETA,F_HZ",
    help="Rayleigh damping of the steel: minimum ratio and its frequency, or ZETA,F_HZ,ZETA,F_HZ.",
)
@click.option(
    "--mode-damping", metavar="MODE=ZETA,…", help="Damping ratios of the structure's own modes, e.g. 1=0.005."
)
@click.option(
    "--blades",
    metavar="ROTOR[,PITCH]",
    help="Model flexible blades: iea15, a windIO or an ElastoDyn file; pitch in degrees, default 90.",
)
@click.option(
    "--shapes",
    type=click.Path(dir_okay=False, path_type=Path),
    help="FILE.csv: write the undamped modes, by mode and node.",
)
@click.option(
    "--against",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="FILE.csv: modes of another program, compared by MAC.",
)
@click.option("--figure", type=PageFile(), help="With --against: a page that compares the shapes.")
@click.option(
    "--state",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the state matrices and the names of their states to this .npz.",
)
@answers
def modes_command(
    structure: str,
    support: str | None,
    pile_model: PileModel | None,
    number: int,
    gravity: bool,
    beam: str | None,
    rotary_inertia: bool | None,
    subdivide: int | None,
    rayleigh: str | None,
    mode_damping: str | None,
    blades: str | None,
    shapes: Path | None,
    against: Path | None,
    figure: Path | None,
    state: Path | None,
) -> Reply:
    """Compute undamped and damped modes of STRUCTURE.

    STRUCTURE is a shipped name, a YAML file, or a SubDyn .dat file.
    """
    from jackettwin.decks import read_structure
    from jackettwin.response import build_system, modal_damping, own_damping, with_inner_piles
    from jackettwin.soil import Prony
    from jackettwin.soil.support import described
    from jackettwin.structure import assemble

    options: dict[str, Any] = {
        "beam_theory": beam,
        "rotary_inertia": rotary_inertia,
        "subdivide": subdivide,
        "gravity": gravity,
    }
    read = read_structure(structure).with_theory(beam, rotary_inertia)
    bare = assemble(blades_option(blades, read), **options)
    standing, held = supported_option(support, bare, pile_model)
    assembly = bare if standing is bare.structure else assemble(standing, **options)
    steel = rayleigh_option(rayleigh)
    spread = own_damping(assembly, steel)
    if mode_damping is not None:
        ratios = _by_mode(mode_damping)
        with located(field="--mode-damping"):
            own_modes = modal_damping(assembly, ratios, steel)
        spread = (*spread, (own_modes, Prony(c=1.0)))
    system = with_inner_piles(build_system(assembly, held, rayleigh=steel, spread=spread))
    own = f"the structure's own: {described(held)}"
    document = {**_document(system, number, bare), "support": own if support is None else support}
    document["warnings"] = [*document["warnings"], *held.notes]
    document |= comparison_of(system, number, shapes=shapes, against=against, figure=figure)
    document["gravity"] = gravity
    damped = rayleigh is not None or mode_damping is not None
    document["left_out"] = of_modes(gravity=gravity, steel=damped)
    document["state"] = None if state is None else _write_state(system, state)
    return Reply(document, lambda: _show(document))


def _write_state(system: System, path: Path) -> dict[str, Any]:
    """Write the state space of a system; return the file and its number of states and inputs."""
    from jackettwin.response import state_model, write_state_model

    require(path.suffix == ".npz", "is no .npz", field="--state", value=str(path), remedy="name it model.npz")
    model = state_model(system)
    write_state_model(model, path)
    return {"file": str(path), "states": len(model.states), "inputs": len(model.inputs)}


def blades_option(text: str | None, structure: Structure) -> Structure:
    """Return the structure with the bending blades that ``--blades ROTOR[,PITCH]`` names.

    Raises
    ------
    InputError
        If there is no such rotor, or its blades are heavier than the mass on the top.
    """
    from jackettwin.decks import read_flexible_rotor
    from jackettwin.structure import with_rotor, without_rotor

    if text is None:
        return structure
    source, _, pitch = text.partition(",")
    (angle,) = numbers_of(pitch or "90", "--blades", "ROTOR,PITCH", (1,), given=text)
    with located(field="--blades"):
        rotor = replace(read_flexible_rotor(source), pitch=radians(angle))
        return with_rotor(without_rotor(structure), rotor, structure.top_node)


def support_option(text: str | None, assembly: Assembly) -> Support:
    """Return the support of ``--support``; laws that need the first frequency use that on pinned feet.

    Raises
    ------
    InputError
        If this structure has no such support.
    """
    from jackettwin.soil import read_support

    return read_support(text, assembly.structure, first_frequency_hz=_first_frequency_hz(assembly))


def supported_option(
    text: str | None, assembly: Assembly, pile_model: PileModel | None
) -> tuple[Structure, Support]:
    """Return the structure and the support of ``--support``, with piles according to ``--pile-model``.

    Raises
    ------
    InputError
        If this structure has no such support, or piles as members are requested but there are none.
    """
    from jackettwin.soil import read_supported

    first = _first_frequency_hz(assembly)
    return read_supported(text, assembly.structure, pile_model=pile_model, first_frequency_hz=first)


def _first_frequency_hz(assembly: Assembly) -> Callable[[], float]:
    from jackettwin.updating import numbered_modes

    return lambda: float(numbered_modes(assembly, 1).frequency_hz[0])


def rayleigh_option(text: str | None) -> Rayleigh:
    """Return the steel damping of ``--rayleigh ZETA,F_HZ``.

    Raises
    ------
    InputError
        If the text is not two or four numbers in range.
    """
    from jackettwin.structure import Rayleigh

    if text is None:
        return Rayleigh()
    numbers = numbers_of(text, "--rayleigh", "ZETA,F_HZ", (2, 4))
    with located(field="--rayleigh"):
        if len(numbers) == 4:
            return Rayleigh.two_points((numbers[0], numbers[2]), (numbers[1], numbers[3]))
        return Rayleigh.minimum(*numbers)


def _by_mode(text: str) -> dict[int, float]:
    """Return the ratios of ``--mode-damping MODE=ZETA,…``."""
    ratios = {}
    for part in text.split(","):
        mode, _, value = part.partition("=")
        if not mode.strip().isdigit():
            raise InputError(
                "not MODE=ZETA,…", field="--mode-damping", value=text, allowed="e.g. 1=0.005,2=0.005,4=0.01"
            )
        (ratios[int(mode)],) = numbers_of(value, "--mode-damping", "MODE=ZETA,…", (1,), given=text)
    return ratios


def _document(system: System, number: int, bare: Assembly) -> dict[str, Any]:
    """Return the document of a system; modes are numbered as those of ``bare``, without its piles."""
    from jackettwin.response import damped_modes, mode_kinds, mode_labels, track_modes, undamped_modes
    from jackettwin.structure import check

    assembly = system.assembly
    structure, M = assembly.structure, assembly.mass
    undamped = undamped_modes(system, number + 12)
    free = undamped.n_at_rest
    damped = damped_modes(
        system, below_hz=1.1 * float(undamped.frequency_hz[min(number + free, undamped.omega.size) - 1])
    )
    damped = _enough(system, damped, number)
    static = track_modes(M, undamped.omega, undamped.shapes, damped.shapes)
    of_damped = {int(column): row for row, column in enumerate(static) if column >= 0}
    numbers = _numbers(assembly, bare, damped, number)
    labels = mode_labels(mode_kinds(assembly, damped.shapes, damped.frequency_hz))
    rows: list[dict[str, Any]] = []
    others: list[dict[str, Any]] = []
    for i, (f, zeta) in enumerate(zip(damped.frequency_hz, damped.damping_ratio, strict=True)):
        row = {
            "frequency_hz": float(f),
            "damping_ratio": float(zeta),
            "undamped_frequency_hz": float(undamped.frequency_hz[of_damped[i]]) if i in of_damped else None,
            "mode": numbers.get(i),
            "label": labels[i],
        }
        (others if i not in numbers and zeta > _OVERDAMPED else rows).append(row)
    books = check(assembly)
    return {
        "structure": structure.name,
        "mass_kg": books.mass_kg,
        "support_mass_kg": books.support_mass_kg,
        "center_of_mass_m": books.center_of_mass_m,
        "n_dof": system.free.size,
        "warnings": books.warnings,
        "modes": rows[:number],
        "overdamped_poles": others,
        "free_motions": free,
        # each rigid-body motion has a double pole at zero
        "real_poles_rad_s": damped.real_poles[2 * free :],
    }


def _enough(system: System, damped: DampedModes, number: int) -> DampedModes:
    """Return at least ``number`` modes: strong dampers lift frequencies above the undamped ones."""
    from jackettwin.response import damped_modes

    below = 1.5 * max([*damped.frequency_hz[-1:], 0.01])
    for _ in range(8):
        if np.count_nonzero(damped.damping_ratio <= _OVERDAMPED) >= min(number, system.pencil.n):
            break
        damped = damped_modes(system, below_hz=below)
        below *= 1.5
    return damped


def _numbers(assembly: Assembly, bare: Assembly, damped: DampedModes, number: int) -> dict[int, int]:
    """Return {index of a damped mode: its number on pinned supports, without piles below these}."""
    from jackettwin.response import track_modes
    from jackettwin.updating import numbered_modes

    if not bare.structure.reactions:
        return {}
    reference = numbered_modes(bare, number + 6)
    above = np.asarray(assembly.expand @ damped.shapes)[_same_dofs(bare, assembly)]
    successor = track_modes(bare.mass, reference.omega, reference.shapes, above)
    return {int(column): mode + 1 for mode, column in enumerate(successor) if column >= 0}


def _same_dofs(bare: Assembly, assembly: Assembly) -> IntArray:
    """Return the indices of one assembly's DOFs on the mesh of another that has all its nodes."""
    place = {name: k for k, name in enumerate(assembly.mesh.node_names)}
    node, component = np.divmod(bare.independent, DOFS_PER_NODE)
    at = np.array([place[bare.mesh.node_names[k]] for k in node], dtype=np.intp)
    return np.asarray(DOFS_PER_NODE * at + component, dtype=np.intp)


def _show(document: dict[str, Any]) -> None:
    x, y, z = document["center_of_mass_m"]
    say(
        f"{document['structure']}: {document['mass_kg'] / 1e3:,.1f} t, "
        f"centre of mass ({x:.2f}, {y:.2f}, {z:.2f}) m in the structure's frame, "
        f"{document['n_dof']} degrees of freedom"
    )
    carried = document["support_mass_kg"]
    beside = f", which adds {carried / 1e3:,.1f} t" if carried else ""
    say(f"support: {document['support']}{beside}")
    say_all(document["warnings"], "warning")
    show_table(Table("", _COLUMNS, document["modes"]))
    show_comparison(document["shapes"])
    for page in filter(None, (document["shapes_file"], document["page"])):
        say(f"wrote {page}")
    if not document["gravity"]:
        say("without P-Δ (--gravity), which scenarios and twins include unless they state gravity: false")
    if document["state"]:
        s = document["state"]
        say(f"{s['file']}: A and B of {s['states']} states and {s['inputs']} inputs, with their names")
    if document["free_motions"]:
        free = f"{document['free_motions']} free motions"
        say(f"{free}: the structure or a part of it is a mechanism (its feet: reaction_nodes)")
    if document["overdamped_poles"]:
        say(
            f"{len(document['overdamped_poles'])} overdamped motions of the supports, e.g. "
            f"{document['overdamped_poles'][0]['frequency_hz']:.4f} Hz"
        )
    if len(document["real_poles_rad_s"]):
        slow = np.abs(document["real_poles_rad_s"])
        say(
            f"{slow.size} real poles (relaxation) from {slow.min():.3g} to {slow.max():.3g} rad/s; "
            f"slowest time constant {1.0 / slow.min():.3g} s ({slow.min() / (2 * pi):.3g} Hz)"
        )


def _difference(row: dict[str, Any]) -> float | None:
    """Return the per cent by which the undamped frequency is higher."""
    undamped = row["undamped_frequency_hz"]
    return None if undamped is None else float(100.0 * (undamped / row["frequency_hz"] - 1.0))


_COLUMNS = (
    TableColumn("mode", "mode"),
    TableColumn("label", "label"),
    TableColumn("f [Hz]", "frequency_hz", ".4f"),
    TableColumn("ζ [%]", "damping_ratio", ".3f", 100.0),
    TableColumn("undamped f [Hz]", "undamped_frequency_hz", ".4f"),
    TableColumn("difference [%]", _difference, ".3f"),
)
