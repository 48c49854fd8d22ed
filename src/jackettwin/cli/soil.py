"""``jackettwin soil``: reaction of the ground on a pile of a foundation."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.caveats import Omission, omission_documents, omission_sentences
from jackettwin.cli.console import (
    FiniteFloat,
    PageFile,
    Reply,
    answers,
    messages,
    plain,
    say,
    say_all,
    show_table,
    working,
)
from jackettwin.report import Table

if TYPE_CHECKING:
    from jackettwin.soil import Curve, Foundation
    from jackettwin.soil.piles.capacity import Pushover
    from jackettwin.soil.piles.reaction_curves import PileCurves


_POINTS = 31
"""Number of points of a curve in the tables."""
_REACH = {"py": 0.1, "tz": 0.02, "qz": 0.1}
"""Largest displacement of a curve in the tables, in pile diameters."""
_LEFT_OUT = (
    Omission("axial force and strain hardening in the pushover's yielding steel", "ISO 19902 17"),
    Omission(
        "settlement of a pile by the loads of its group's others; what weakens their lateral ground is "
        "included by `curves: {group: …}`",
        "ISO 19902 17",
    ),
    Omission(
        "cyclic degradation along the axis, but in sand by `axial_cycles` and in clay by `t_multiplier`; "
        "set-up but by `t_multiplier`; weight of pile and plug",
        "ISO 19902 17",
    ),
    Omission("base and side terms of stocky piles, but by `curves: {sand_py: pisa, clay_py: pisa}`"),
)
_FACTORS = {
    "group_p_multiplier": "p-y curves, by the other piles of the group",
    "sand_friction_left": "shaft friction in sand, after cycles along the axis",
}
_LINEAR = "linear ground has no curves and no capacity; describe the ground by layers"


@click.command("soil")
@click.argument("foundation")
@click.option(
    "--frequency-hz",
    default=0.18,
    show_default=True,
    type=FiniteFloat(min=0.0, max=100.0),
    help="Frequency of the head's stiffness and loss.",
)
@click.option(
    "--arm",
    "arm_m",
    default=0.0,
    show_default=True,
    type=FiniteFloat(-300.0, 300.0),
    help="Height of the lateral load [m].",
)
@click.option("--yield-strength", default=355e6, show_default=True, type=FiniteFloat(min=1e6), help="[Pa]")
@click.option(
    "--steps", default=20, show_default=True, type=click.IntRange(2, 500), help="Steps of the pushover."
)
@click.option("--out", type=PageFile(), help="The page, in a folder that exists; default out/NAME_soil.html.")
@answers
def soil_command(
    foundation: str, frequency_hz: float, arm_m: float, yield_strength: float, steps: int, out: Path | None
) -> Reply:
    """Compute curves, stiffness, capacity of a pile of FOUNDATION.

    The page shows the reaction curves, the head's stiffness, the capacity and a pushover.
    """
    from jackettwin.soil import read_foundation
    from jackettwin.soil.piles.capacity import pushover

    ground = read_foundation(foundation)
    pushed = None
    with working(f"piles of {Path(foundation).stem}"):
        if ground.curves is not None:
            pushed = pushover(
                ground.pile,
                ground.curves,
                arm_m=arm_m,
                steps=steps,
                yield_strength_pa=yield_strength,
            )
        document = _document(Path(foundation).stem, ground, pushed, frequency_hz, arm_m)
        if pushed is not None:
            _add_yield(document, ground, pushed, yield_strength)
        # importing the plots takes a second, so only when needed
        from jackettwin.report.pages.soil import write_soil_page

        path = write_soil_page(document, out or Path("out") / f"{document['foundation']}_soil.html")
    document["page"] = str(path)
    for note in document["warnings"]:
        messages.print(f"warning: {plain(note)}")
    return Reply(document, lambda: _show(document))


def _document(
    name: str, ground: Foundation, pushed: Pushover | None, frequency_hz: float, arm_m: float
) -> dict[str, Any]:
    from jackettwin.soil.piles.impedance import head_impedance

    pile, curves = ground.pile, ground.curves
    s = 2j * pi * frequency_hz
    K = head_impedance(pile, ground.springs, s, law=ground.law, dashpots=ground.dashpots)[0]
    return {
        "foundation": name,
        "pile": {
            "length_m": pile.length_m,
            "outer_diameter_m": pile.outer_diameter_m,
            "thickness_m": pile.thickness_m,
        },
        "frequency_hz": frequency_hz,
        "head_stiffness": K.real,
        "head_loss": K.imag,
        **_factors(ground),
        "curves": None if curves is None else {"kinds": _kinds(ground), **_curves(curves)},
        "capacity": None if curves is None or pushed is None else _capacity(ground, curves, pushed),
        "pushover": None if pushed is None else _pushover(pushed, arm_m),
        "warnings": [*ground.notes, *([_LINEAR] if curves is None else [])],
        "left_out": omission_documents(_LEFT_OUT),
    }


def _add_yield(document: dict[str, Any], ground: Foundation, pushed: Pushover, f_y: float) -> None:
    """Add the load from which on the pile's steel yields, and what has become of it at the end."""
    first = pushed.first_load_n(f_y * ground.pile.elastic_modulus_m3)
    document["capacity"]["steel_yields_at_n"] = first
    if first is not None:
        document["warnings"].append(
            f"the pile's steel yields from {1e-6 * first:.2f} MN on (f_y = {1e-6 * f_y:g} MPa, bending "
            f"alone); at the end its curvature is {pushed.ductility:.1f} times that of first yield, "
            f"{pushed.hinge_m:.1f} m deep"
        )


def _factors(ground: Foundation) -> dict[str, float | None]:
    """Return what the pile's group and cycles along its axis leave of the ground's reactions."""
    options, layered = ground.options, ground.profile is not None
    group, cycles = options.group, options.axial_cycles
    return {
        "group_p_multiplier": group.p_multiplier(ground.pile.outer_diameter_m) if group and layered else None,
        "sand_friction_left": cycles.friction_left if cycles and layered else None,
    }


def _kinds(ground: Foundation) -> list[dict[str, str]]:
    """Return the kind of curve of each reaction in the soils of the profile."""
    layers = () if ground.profile is None else ground.profile.layers
    kinds = ground.options.kinds([layer.soil for layer in layers])
    return [{"reaction": kind.reaction, "name": kind.name, "words": kind.words} for kind in kinds]


def _curves(curves: PileCurves) -> dict[str, Any]:
    D, at = curves.diameter_m, curves.at
    return {
        "stations": [
            {
                "depth_m": float(at.depth[k]),
                "py": _curve(curves.py[k], _REACH["py"] * D),
                "tz": _curve(curves.tz[k], _REACH["tz"] * D),
            }
            for k in range(at.depth.size)
        ],
        "qz": _curve(curves.qz, _REACH["qz"] * D),
    }


def _curve(curve: Curve, reach: float) -> dict[str, Any]:
    """Return a curve as a table; a p-y and t-z in N per m of pile, q-z in N."""
    y = reach * np.linspace(0.0, 1.0, _POINTS) ** 2
    return {
        "y_m": y,
        "reaction": curve.force(y),
        "capacity": float(curve.capacity),
        "initial_stiffness": float(curve.initial_stiffness),
    }


def _capacity(ground: Foundation, curves: PileCurves, pushed: Pushover) -> dict[str, Any]:
    from jackettwin.soil.piles.capacity import FAILED_AT, axial_capacity

    axial = axial_capacity(ground.pile, curves)
    return {
        "shaft_n": axial.shaft_n,
        "inner_shaft_n": axial.inner_n,
        "plugged": axial.plugged,
        "tip_n": axial.tip_n,
        "block_shaft_n": None if axial.block is None else axial.block.shaft_n,
        "block_base_n": None if axial.block is None else axial.block.base_n,
        "axial_compression_n": axial.compression_n,
        "axial_tension_n": axial.tension_n,
        "lateral_n": pushed.ultimate_n,
        "highest_lateral_n": pushed.highest_n,
        "lateral_displacement_limit_m": FAILED_AT * curves.diameter_m,
    }


def _pushover(pushed: Pushover, arm_m: float) -> dict[str, Any]:
    return {
        "arm_m": arm_m,
        "load_n": pushed.load_n,
        "head_m": pushed.head_m,
        "rotation_rad": pushed.rotation_rad,
        "largest_moment_nm": pushed.moment_nm,
        "ductility": pushed.ductility,
        "hinge_m": pushed.hinge_m,
    }


def _show(document: dict[str, Any]) -> None:
    pile = document["pile"]
    say(
        f"{document['foundation']}: one pile {pile['length_m']:g} m long, {pile['outer_diameter_m']:g} m × "
        f"{1e3 * pile['thickness_m']:g} mm"
    )
    names = ("x", "y", "z", "rx", "ry", "rz")
    rows = [
        (f"{part} {name}", *(f"{v:.3g}" for v in row))
        for part, key in (("K", "head_stiffness"), ("loss", "head_loss"))
        for name, row in zip(names, np.asarray(document[key]), strict=True)
    ]
    title = f"head at {document['frequency_hz']:g} Hz [N/m, N, N·m/rad]"
    show_table(Table(title, ("", *names), rows))
    capacity, pushed = document["capacity"], document["pushover"]
    for key, words in _FACTORS.items():
        if document[key] is not None:
            say(f"{words}: {document[key]:.3f}")
    if capacity is not None:
        say(
            f"capacity [MN]: compression {1e-6 * capacity['axial_compression_n']:.1f} (shaft "
            f"{1e-6 * capacity['shaft_n']:.1f}, inside {1e-6 * capacity['inner_shaft_n']:.1f}, tip "
            f"{1e-6 * capacity['tip_n']:.1f}; {'plugged' if capacity['plugged'] else 'unplugged'}), tension "
            f"{1e-6 * capacity['axial_tension_n']:.1f}, lateral {1e-6 * capacity['lateral_n']:.2f} at "
            f"{capacity['lateral_displacement_limit_m']:.2f} m (at most "
            f"{1e-6 * capacity['highest_lateral_n']:.2f})"
        )
        if capacity["block_shaft_n"] is not None:
            say(
                f"its share of the group's block of clay [MN]: sides {1e-6 * capacity['block_shaft_n']:.1f}, "
                f"base {1e-6 * capacity['block_base_n']:.1f}"
            )
        from jackettwin.report.pages.soil import pushover_table

        show_table(pushover_table(pushed, "pushover"))
    say_all(omission_sentences(document["left_out"]), "left out")
    say(f"wrote {document['page']}")
