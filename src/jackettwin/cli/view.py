"""``jackettwin view``: interactive 3D page of a structure and its motions."""

from __future__ import annotations

from dataclasses import replace
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
import numpy.typing as npt

from jackettwin.axes import DOFS_PER_NODE
from jackettwin.cli.check import nodal_force
from jackettwin.cli.comparison import compared_with, comparison_document, show_comparison
from jackettwin.cli.console import PageFile, Reply, answers, numbers_of, say_all
from jackettwin.cli.modes import pile_model_option, rayleigh_option, supported_option
from jackettwin.errors import InputError, located

if TYPE_CHECKING:
    from jackettwin.loads import GrowthBand
    from jackettwin.report import ColouredQuantity
    from jackettwin.report.view.motions import DrawnMotion
    from jackettwin.response import Sensor, System
    from jackettwin.soil import PileModel
    from jackettwin.structure import Assembly


_OVERDAMPED = 0.3
"""Damping ratio above which poles are motions of the supports and not shown."""
_MOST_USED = 1.5
"""Utilisation at which the colour scale ends, so that failed members do not hide differences of others."""


_MOST_PARTS = 8
"""Largest number of parts with listed dimensions; a SACS deck has dozens of groups."""


@click.command("view")
@click.argument("structure")
@click.option("--out", type=PageFile(), help="The page, in a folder that exists; default out/NAME.html.")
@click.option("--support", help="As for `jackettwin modes`.")
@pile_model_option
@click.option(
    "--modes", "number", default=8, show_default=True, type=click.IntRange(0, 40), help="How many modes."
)
@click.option("--rayleigh", metavar="ZETA,F_HZ", help="Rayleigh damping of the steel.")
@click.option(
    "--subdivide",
    default=3,
    show_default=True,
    type=click.IntRange(1, 20),
    help="Segments per member in the drawing.",
)
@click.option(
    "--growth",
    multiple=True,
    metavar="TOP,BOTTOM,THICKNESS",
    help="Marine growth [m], z from sea level; may be repeated.",
)
@click.option("--flooded", multiple=True, metavar="PART", help="A flooded part or member; may be repeated.")
@click.option("--wave", metavar="HEIGHT,PERIOD[,DIRECTION_DEG]", help="Also draw a passing regular wave.")
@click.option(
    "--against",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="FILE.csv: modes of another program, shown and compared by MAC.",
)
@click.option("--record", type=click.Path(dir_okay=False, path_type=Path), help="Record to play back.")
@click.option(
    "--force",
    "forces",
    multiple=True,
    metavar="NODE=FX,FY,FZ",
    help="Further forces for utilisation, besides the self-weight.",
)
@answers
def view_command(
    structure: str,
    out: Path | None,
    support: str | None,
    pile_model: PileModel | None,
    number: int,
    rayleigh: str | None,
    subdivide: int,
    growth: tuple[str, ...],
    flooded: tuple[str, ...],
    wave: str | None,
    against: Path | None,
    record: Path | None,
    forces: tuple[str, ...],
) -> Reply:
    """Draw STRUCTURE on a page to turn, colour and animate.

    The page is a single file that shows members, modes, waves and a record.
    """
    from jackettwin.decks import read_structure
    from jackettwin.loads import Coefficients
    from jackettwin.records import read_record
    from jackettwin.report import View, record_motion, thickness_quantities
    from jackettwin.report.view.motions import wave_motion
    from jackettwin.report.view.page import write_view
    from jackettwin.report.view.quantities import material_quantities
    from jackettwin.response import build_system, playback, record_sensors, undamped_modes, wave_passage
    from jackettwin.structure import assemble, check

    assembly = assemble(read_structure(structure), subdivide=subdivide)
    chosen, held = supported_option(support, assembly, pile_model)
    if chosen is not assembly.structure:
        assembly = assemble(chosen, subdivide=subdivide)
    system = build_system(assembly, held, rayleigh=rayleigh_option(rayleigh))
    coefficients = Coefficients(growth=tuple(_band(text) for text in growth))
    _require_parts(assembly, flooded)
    motions, lost = _modes(assembly, system, number)
    other, compared = _others(system, number, against)
    motions += other
    sensors: tuple[Sensor, ...] = ()
    if wave is not None:
        H, T, *heading = numbers_of(wave, "--wave", "H,T[,HEADING]", (2, 3))
        with located(field="--wave"):
            passage = wave_passage(
                system,
                height_m=H,
                period_s=T,
                direction_rad=radians(*heading or [0.0]),
                coefficients=coefficients,
            )
        motions.append(wave_motion(assembly, passage))
    if record is not None:
        measured = read_record(record)
        sensors = record_sensors(measured)
        found = playback(assembly, undamped_modes(system, 12), measured)
        motions.append(record_motion(assembly, measured.name, found))
    books = check(assembly)
    loads = dict(nodal_force(f) for f in forces)
    unchecked = not (held.springs or held.fixed) or not chosen.members
    view = View(
        assembly,
        (
            *thickness_quantities(assembly),
            *material_quantities(assembly),
            *lost,
            *(() if unchecked else _uses(assembly, system, loads)),
        ),
        tuple(motions),
        sensors,
        coefficients,
        flooded,
        (f"{books.mass_kg / 1e3:,.0f} t, {len(chosen.members)} members", *_dimensions(assembly)),
    )
    remarks = _remarks(structure)
    path = write_view(view, out or Path("out") / f"{chosen.name}.html")
    dimensions = _dimensions(assembly)
    document = {
        "page": str(path),
        "motions": [motion.name for motion in motions],
        "dimensions": list(dimensions),
        "not_read": list(remarks),
        "colours": [quantity.name for quantity in view.quantities],
        "shapes": compared,
    }

    def show() -> None:
        say_all(f"  {line}" for line in dimensions)
        show_comparison(compared)
        say_all([f"wrote {path}"])

    return Reply(document, show)


def _others(
    system: System, number: int, against: Path | None
) -> tuple[list[DrawnMotion], dict[str, Any] | None]:
    """Return the modes of another program's table as motions, and their comparison with the structure's."""
    from jackettwin.report.view.motions import undamped_motion
    from jackettwin.response import build_system, expanded
    from jackettwin.structure import assemble

    if against is None:
        return [], None
    chosen = system.assembly.structure
    own = build_system(assemble(chosen), system.support)  # the modes that `modes` and `stages` compare
    found = compared_with(own, max(number, 1), against)
    shapes = expanded(system.assembly, found.other)
    mac = {pair.other: f", MAC {pair.mac:.3f} with mode {pair.own + 1}" for pair in found.pairs}
    drawn = [
        undamped_motion(system.assembly, f"{against.stem} {k + 1}{mac.get(k, '')}", float(f), shapes[:, k])
        for k, f in enumerate(found.other.frequency_hz)
    ]
    return [replace(one, group="another program") for one in drawn], comparison_document(found)


def _remarks(structure: str) -> tuple[str, ...]:
    """Return the entries of a deck that were not understood."""
    from jackettwin.decks import is_sacs, sacs_remarks

    path = Path(structure)
    return sacs_remarks(path) if is_sacs(path) and path.is_file() else ()


def _dimensions(assembly: Assembly) -> tuple[str, ...]:
    """Return sentences on levels and widths [m], to compare with a drawing."""
    structure = assembly.structure
    points = assembly.mesh.coordinates - [0.0, 0.0, structure.sea_level_z_m]
    z, lines = points[:, 2], []
    feet = [assembly.mesh.node_names.index(n) for n in structure.reaction_nodes]
    lines.append(f"z {z.min():+.2f} to {z.max():+.2f} m about the sea level")
    if feet:
        low, high = z[feet].min(), z[feet].max()
        slope = f" to {high:+.2f}" if high - low >= 0.005 else ""
        lines.append(f"{len(feet)} feet at z {low:+.2f}{slope} m, {_footprint(points[feet])}")
    parts = dict.fromkeys(bar.part for bar in structure.bars if bar.part)
    if len(parts) > _MOST_PARTS:
        tubes = [s.outer_diameter_m for m in structure.members for s in (m.section_start, m.section_end)]
        return (*lines, f"{len(parts)} parts, tubes {min(tubes):.2f} to {max(tubes):.2f} m")
    for part in parts:
        own = [bar for bar in structure.bars if bar.part == part]
        ends = points[[assembly.mesh.node_names.index(n) for bar in own for n in (bar.start, bar.end)]]
        tubes = [
            s.outer_diameter_m
            for m in structure.members
            if m.part == part
            for s in (m.section_start, m.section_end)
        ]
        size = f"tubes {min(tubes):.2f} to {max(tubes):.2f} m" if tubes else f"{len(own)} beams"
        lines.append(
            f"{part.replace('_', ' ')}: z {ends[:, 2].min():+.2f} to {ends[:, 2].max():+.2f} m, "
            f"{_footprint(ends)}, {size}"
        )
    return tuple(lines)


def _footprint(points: npt.NDArray[np.float64]) -> str:
    x, y = np.ptp(points[:, :2], axis=0)
    if max(x, y) < 0.005:
        return "on one vertical axis"
    return f"{x:.2f} × {y:.2f} m in plan"


def _band(text: str) -> GrowthBand:
    from jackettwin.loads import GrowthBand

    numbers = numbers_of(text, "--growth", "TOP,BOTTOM,THICKNESS", (3,))
    with located(field="--growth"):
        return GrowthBand(*numbers)


def _require_parts(assembly: Assembly, names: tuple[str, ...]) -> None:
    known = {m.name for m in assembly.structure.members} | {m.part for m in assembly.structure.members}
    for name in names:
        if name not in known:
            raise InputError("no such member or part", field="--flooded", value=name)


def _modes(
    assembly: Assembly, system: System, number: int
) -> tuple[list[DrawnMotion], tuple[ColouredQuantity, ...]]:
    """Return undamped modes, damped ones if anything dissipates, and the dissipation of the first of these.

    Rigid-body motions are omitted.
    """
    from jackettwin.report import words
    from jackettwin.report.view.motions import damped_motion, undamped_motion
    from jackettwin.report.view.quantities import damping_quantity
    from jackettwin.response import UndampedModes, damped_modes, mode_kinds, mode_labels, undamped_modes

    if number == 0:
        return [], ()
    still = undamped_modes(system, number + DOFS_PER_NODE)
    shown = range(still.n_at_rest, min(still.n_at_rest + number, still.omega.size))
    still = UndampedModes(still.omega[shown], still.shapes[:, shown])
    labels = mode_labels(mode_kinds(assembly, still.shapes, still.frequency_hz))
    motions = [
        undamped_motion(assembly, f"{k + 1}: {words(label)}", float(f), still.shapes[:, k])
        for k, (f, label) in enumerate(zip(still.frequency_hz, labels, strict=True))
    ]
    damped = damped_modes(system, below_hz=1.02 * float(still.frequency_hz[-1]))
    lively = np.flatnonzero((damped.damping_ratio < _OVERDAMPED) & (damped.damping_ratio > 1e-9))[:number]
    labels = mode_labels(mode_kinds(assembly, damped.shapes[:, lively], damped.frequency_hz[lively]))
    lost = damping_quantity(system, damped) if lively.size else None
    return motions + [
        damped_motion(
            assembly,
            f"{k + 1}: {words(label)}",
            complex(damped.eigenvalues[i]),
            damped.shapes[:, i],
        )
        for k, (i, label) in enumerate(zip(lively, labels, strict=True))
    ], () if lost is None else (lost,)


def _uses(
    assembly: Assembly, system: System, forces: dict[str, tuple[float, ...]]
) -> tuple[ColouredQuantity, ...]:
    """Return static utilisation and stress under the weight and the given forces."""
    from jackettwin.checks import frame_use
    from jackettwin.report import ColouredQuantity
    from jackettwin.response import nodal_load, self_weight, static_displacement
    from jackettwin.structure import element_weight, section_forces, von_mises_stress

    u = static_displacement(system, self_weight(assembly) + nodal_load(assembly, forces))
    along = element_weight(assembly)
    members = frame_use(assembly, u, along=along).members
    uses = np.array([use.utilisation for use in members])[assembly.mesh.member]
    sections = section_forces(assembly, u, along=along)
    return (
        ColouredQuantity("utilisation at rest, ISO 19902", "–", np.minimum(uses, _MOST_USED), from_zero=True),
        ColouredQuantity(
            "von Mises stress at rest",
            "MPa",
            von_mises_stress(assembly, sections).max(axis=1) / 1e6,
            from_zero=True,
        ),
        ColouredQuantity("axial force at rest", "MN", sections.axial.mean(axis=1) / 1e6),
    )
