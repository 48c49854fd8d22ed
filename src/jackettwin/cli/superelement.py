"""``jackettwin superelement``: reduction of a foundation to 6 + N coordinates."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.cli.console import FiniteFloat, Reply, answers, messages, numbers_of, say, show_table
from jackettwin.cli.joints import joint_options, with_joints
from jackettwin.cli.modes import rayleigh_option, support_option
from jackettwin.cli.omissions import of_superelement
from jackettwin.errors import InputError
from jackettwin.report import Table, TableColumn
from jackettwin.response import DEFAULT, LAYOUTS

if TYPE_CHECKING:
    import scipy.sparse as sp

    from jackettwin.arrays import FloatArray
    from jackettwin.decks import DeckDamping
    from jackettwin.response import Layout, ReducedModes, Superelement
    from jackettwin.structure import Assembly, Structure, Vector

_MODES = 24


@click.command("superelement")
@click.argument("structure")
@click.option(
    "--support", help="pinned, clamped, LAW:arguments, or a YAML file; default: the structure's own."
)
@joint_options
@click.option(
    "--tower-inside",
    is_flag=True,
    help="Reduce the tower, too: the interface is its top, whose masses are left to the turbine.",
)
@click.option(
    "--modes",
    "number",
    type=click.IntRange(0, 500),
    help=f"Number N of internal coordinates; default: {_MODES}, or all that a small foundation has.",
)
@click.option(
    "--reference",
    metavar="X,Y,Z",
    help="Reference point [m] in the structure's frame; default: the interface's centroid.",
)
@click.option(
    "--rayleigh", metavar="ZETA,F_HZ", help="Rayleigh damping of the steel: minimum ratio and its frequency."
)
@click.option(
    "--band-hz",
    type=FiniteFloat(min=0.0, min_open=True),
    help="Highest frequency [Hz] with accurate damping; default: five modes of the structure.",
)
@click.option(
    "--time-step",
    "step_s",
    metavar="S",
    type=FiniteFloat(min=0.0, min_open=True),
    help="Time step [s] for which fast poles are slowed, so that explicit integration is stable.",
)
@click.option(
    "--gravity",
    is_flag=True,
    help="Add the geometric (P-Δ) stiffness of the weight of everything above the bed.",
)
@click.option("--deck-damping", is_flag=True, help="Add a SubDyn deck's JDampings and GuyanDampMod.")
@click.option(
    "--beam", type=click.Choice(["euler-bernoulli", "timoshenko"]), help="Default: the structure's own."
)
@click.option(
    "--subdivide", type=click.IntRange(1, 1000), help="Elements per member; default: the structure's own."
)
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="FILE.npz, or FILE.dat for OpenFAST's ExtPtfm; default out/NAME.npz.",
)
@click.option(
    "--layout",
    type=click.Choice(LAYOUTS),
    default=DEFAULT,
    show_default=True,
    help="Version of OpenFAST that will read FILE.dat.",
)
@answers
def superelement_command(
    structure: str,
    support: str | None,
    interface: str | None,
    feet: str | None,
    tower_inside: bool,
    number: int | None,
    reference: str | None,
    rayleigh: str | None,
    band_hz: float | None,
    step_s: float | None,
    gravity: bool,
    deck_damping: bool,
    beam: str | None,
    subdivide: int | None,
    out: Path | None,
    layout: Layout,
) -> Reply:
    """Reduce the foundation of STRUCTURE to 6 + N coordinates.

    The foundation is the part below the interface; the error of the reduction is printed. STRUCTURE may also
    be a superelement (.npz, ExtPtfm's .dat), which is read, shown and written again.
    """
    from jackettwin.decks import read_structure
    from jackettwin.response import (
        build_system,
        default_band_hz,
        fixed_interface_frequencies,
        is_superelement,
        reduced_modes,
        require_format,
        slowed,
        with_deck_damping,
        write_superelement,
    )
    from jackettwin.response.superelement.craig_bampton import most_internal, superelement
    from jackettwin.structure import assemble, at_interface

    out = out or Path("out") / f"{Path(structure).stem}.npz"
    require_format(out)
    if is_superelement(Path(structure)):
        return _answer(_rewritten(Path(structure), out, layout))
    whole = with_joints(read_structure(structure).with_theory(beam, None), interface, feet)
    turbine: tuple[str, ...] = ()
    if tower_inside:
        whole, turbine = _up_to_the_top(whole, interface), (whole.top_node,)
    bare = whole.with_masses(tuple(mass for mass in whole.masses if mass.node not in turbine))
    foundation, rest = at_interface(bare)
    point = _point(reference)

    complete = assemble(whole, beam_theory=beam, subdivide=subdivide, gravity=gravity)

    def built(part: Structure) -> Assembly:
        # a part carries the weight of the whole
        return assemble(part, beam_theory=beam, subdivide=subdivide, gravity=gravity, weight=complete.weight)

    held = support_option(support, complete)
    steel = rayleigh_option(rayleigh)
    full, base = (build_system(part, held, rayleigh=steel) for part in (complete, built(foundation)))
    top = None if rest is None else built(rest)
    band = band_hz or default_band_hz(full)
    if number is None:
        number = min(_MODES, most_internal(base))
    element = superelement(base, number=number, reference_m=point, band_hz=band)
    if step_s is not None:
        element = slowed(element, step_s=step_s, band_hz=band)
    plain = superelement(base, number=number, reference_m=point, band_hz=band, damped=False)
    carried, plain = (_carrying(one, complete, built(bare), turbine) for one in (element, plain))
    written = with_deck_damping(element, _deck_damping(structure)) if deck_damping else element
    files = write_superelement(written, out, layout=layout)
    document = _document(
        written,
        fixed_interface_frequencies(base, max(number, 1)),
        reduced_modes(carried, full, top, band_hz=band),
        reduced_modes(plain, full, top, band_hz=band),
        band,
        explicit=out.suffix.lower() == ".dat" and layout != DEFAULT,
    )
    document |= {"structure": whole.name, "files": [str(path) for path in files]}
    document["left_out"] = of_superelement(gravity=gravity, steel=rayleigh is not None or deck_damping)
    return _answer(document)


def _up_to_the_top(structure: Structure, interface: str | None) -> Structure:
    """Return the structure with its tower's top as the interface."""
    if interface is not None:
        raise InputError(
            "the interface is given twice",
            field="--tower-inside, --interface",
            value=interface,
            remedy="keep one of them",
        )
    return replace(structure, interface_nodes=(structure.top_node,))


def _carrying(
    element: Superelement, whole: Assembly, bare: Assembly, turbine: tuple[str, ...]
) -> Superelement:
    """Return the element with the masses that the turbine has on its interface, to compare modes."""
    if not turbine:
        return element
    dofs = whole.dofs(turbine[0])

    def added(own: FloatArray, much: sp.csc_array, less: sp.csc_array) -> FloatArray:
        total = own.copy()
        total[:6, :6] += (much - less)[dofs][:, dofs].toarray()
        return total

    M, K = added(element.M, whole.mass, bare.mass), added(element.K, whole.stiffness, bare.stiffness)
    return replace(element, M=M, K=K)


def _deck_damping(structure: str) -> DeckDamping:
    from jackettwin.decks import read_deck_damping

    if Path(structure).suffix.lower() != ".dat":
        raise InputError(
            "only a SubDyn deck states its damping",
            field="--deck-damping",
            value=structure,
            remedy="name a .dat file, or use --rayleigh",
        )
    return read_deck_damping(Path(structure))


def _rewritten(source: Path, out: Path, layout: Layout) -> dict[str, Any]:
    from jackettwin.response import read_superelement, write_superelement

    element = read_superelement(source)
    files = [str(path) for path in write_superelement(element, out, layout=layout)]
    return _matrices(element, element.held_frequency_hz) | {
        "structure": source.name,
        "files": files,
        "modes": [],
        "warnings": [],
        "left_out": [],
    }


def _answer(document: dict[str, Any]) -> Reply:
    for warning in document["warnings"]:
        messages.print(f"warning: {warning}")
    return Reply(document, lambda: _show(document))


def _point(text: str | None) -> Vector | None:
    if text is None:
        return None
    x, y, z = numbers_of(text, "--reference", "X,Y,Z", (3,))
    return x, y, z


def _matrices(element: Superelement, fixed_hz: FloatArray) -> dict[str, Any]:
    from jackettwin.response import INTERFACE, RUNGE_KUTTA

    fastest = element.fastest_pole_rad_s
    return {
        "reference_m": element.reference_m,
        "n": element.n,
        "damped_shapes": element.n_damped,
        "interface_stiffness": element.interface_stiffness,
        "interface_mass": element.interface_mass,
        "interface_damping": element.C[:INTERFACE, :INTERFACE],
        "guyan_frequency_hz": element.guyan_frequency_hz,
        "fixed_interface_frequency_hz": fixed_hz,
        "fastest_pole_rad_s": fastest,
        "largest_explicit_step_s": RUNGE_KUTTA / fastest if fastest > 0.0 else None,
    }


def _document(
    element: Superelement,
    fixed_hz: FloatArray,
    error: ReducedModes,
    plain: ReducedModes,
    band_hz: float,
    *,
    explicit: bool,
) -> dict[str, Any]:
    from jackettwin.response import damping_ratio, hertz

    columns = zip(error.full, error.reduced, plain.reduced, strict=True)
    matrices = _matrices(element, fixed_hz)
    return matrices | {
        "band_hz": band_hz,
        "modes": [
            {
                "frequency_hz": float(hertz(f)),
                "damping_ratio": float(damping_ratio(f)),
                "reduced_frequency_hz": float(hertz(r)),
                "reduced_damping_ratio": float(damping_ratio(r)),
                "plain_craig_bampton_frequency_hz": float(hertz(p)),
                "plain_craig_bampton_damping_ratio": float(damping_ratio(p)),
            }
            for f, r, p in columns
        ],
        "largest_frequency_error": float(np.abs(error.frequency_error).max(initial=0.0)),
        "largest_damping_error": float(np.abs(error.damping_error).max(initial=0.0)),
        "warnings": _warnings(error, matrices["largest_explicit_step_s"] if explicit else None),
    }


def _warnings(error: ReducedModes, step_s: float | None) -> list[str]:
    """Return the warnings to the user.

    Parameters
    ----------
    step_s : float or None
        Longest stable step of an explicit integrator, if one reads the file.
    """
    from jackettwin.response import damping_ratio

    found = []
    if error.missing:
        found.append(f"{error.missing} modes of the band are missing: increase the number of coordinates")
    apart = float(np.abs(error.frequency_error).max(initial=0.0))
    if apart > 0.01:
        found.append(f"a frequency is {100 * apart:.0f} % off: increase the number of coordinates")
    worst = float(np.abs(error.damping_error / np.maximum(damping_ratio(error.full), 1e-3)).max(initial=0.0))
    if worst > 0.05:
        found.append(
            f"a damping ratio is {100 * worst:.0f} % off: increase the number of coordinates, or reduce "
            "--time-step"
        )
    if step_s is not None and step_s < 1e-3:
        found.append(
            f"OpenFAST before version 5 integrates this explicitly, in steps below {step_s:.2g} s; "
            "--time-step slows fast poles"
        )
    return found


def _show(document: dict[str, Any]) -> None:
    x, y, z = document["reference_m"]
    say(
        f"{document['structure']}: {document['n']} coordinates ({document['damped_shapes']} damped shapes), "
        f"reference point ({x:.3f}, {y:.3f}, {z:.3f}) m"
    )
    for key, name in (
        ("guyan_frequency_hz", "interface alone"),
        ("fixed_interface_frequency_hz", "interface held"),
    ):
        say(f"{name} [Hz]: " + " ".join(f"{f:.4f}" for f in document[key][:6]))
    if document["modes"]:
        show_table(Table(f"whole structure up to {document['band_hz']:.3g} Hz", _COLUMNS, document["modes"]))
    say("wrote " + ", ".join(document["files"]))


_COLUMNS = (
    TableColumn("f [Hz]", "frequency_hz", ".5f"),
    TableColumn("ζ [%]", "damping_ratio", ".4f", 100.0),
    TableColumn("reduced f [Hz]", "reduced_frequency_hz", ".5f"),
    TableColumn("reduced ζ [%]", "reduced_damping_ratio", ".4f", 100.0),
    TableColumn("plain Craig–Bampton ζ [%]", "plain_craig_bampton_damping_ratio", ".4f", 100.0),
)
