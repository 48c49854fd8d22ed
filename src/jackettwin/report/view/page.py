"""Interactive view of a structure as one self-contained page.

Python provides the data; a script in the page projects and draws them on a canvas. z is from the mean sea
level.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from jackettwin.arrays import FloatArray
from jackettwin.files import atomic_path, null_for_nan
from jackettwin.loads import Coefficients
from jackettwin.report.view.dimensions import dimensions
from jackettwin.report.view.motions import DrawnMotion
from jackettwin.response import Sensor, sensor_positions
from jackettwin.structure import Assembly

_LINES = ("cable", "spring", "beam")
"""Elements of a deck that are drawn as lines; springs at joints have no length."""


@dataclass(frozen=True)
class ColouredQuantity:
    """A number for every element, for colouring; ``log`` is for values that span decades."""

    name: str
    unit: str
    values: FloatArray
    log: bool = False
    from_zero: bool = False
    """Whether the scale starts at zero."""


@dataclass(frozen=True)
class View:
    """Content of the page.

    Attributes
    ----------
    coefficients : Coefficients, optional
        Coefficients whose marine growth is drawn.
    flooded : members or parts that are filled with water
    """

    assembly: Assembly
    quantities: tuple[ColouredQuantity, ...]
    motions: tuple[DrawnMotion, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    coefficients: Coefficients | None = None
    flooded: tuple[str, ...] = ()
    facts: tuple[str, ...] = field(default=())


def write_view(view: View, path: Path) -> Path:
    """Write one self-contained HTML file."""
    with atomic_path(path) as temporary:
        temporary.write_text(render_view(view), encoding="utf-8")
    return path


def render_view(view: View) -> str:
    """Return a self-contained page."""
    environment = Environment(
        loader=PackageLoader("jackettwin.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    text = json.dumps(null_for_nan(view_document(view)), separators=(",", ":"), allow_nan=False)
    return environment.get_template("view.html.j2").render(
        title=view.assembly.structure.name,
        facts=view.facts,
        data=Markup(text.replace("</", "<\\/")),
    )


def view_document(view: View) -> dict[str, Any]:
    """Return everything that ``view.js`` needs to draw a structure and its motions, as plain data."""
    assembly, mesh = view.assembly, view.assembly.mesh
    structure = assembly.structure
    points = mesh.coordinates - [0.0, 0.0, structure.sea_level_z_m]
    flooded = [m.name in view.flooded or m.part in view.flooded for m in structure.members]
    return {
        "title": structure.name,
        "nodes": _rounded(points, 3),
        "start": mesh.start,
        "end": mesh.end,
        "diameter": _rounded(diameters(assembly), 4),
        "growth": _rounded(_growth(assembly, points, view.coefficients), 4),
        "flooded": np.array(flooded, dtype=int)[mesh.member],
        "text": member_text(assembly),
        "quantities": [
            {
                "name": q.name,
                "unit": q.unit,
                "log": q.log,
                "from_zero": q.from_zero,
                "values": _digits(q.values),
            }
            for q in view.quantities
        ],
        "motions": [motion.document() for motion in view.motions],
        "sensors": _sensors(assembly, view.sensors),
        "masses": [
            {
                "at": _rounded(
                    np.add(structure.nodes[m.node], m.cg_offset_m) - [0.0, 0.0, structure.sea_level_z_m], 3
                ),
                "node": mesh.node_names.index(m.node),
                "text": f"{m.part or 'mass'}: {m.mass_kg / 1e3:,.0f} t, centre of mass",
            }
            for m in structure.masses
        ],
        "others": _others(assembly),
        "dimensions": dimensions(assembly),
        "mud_z": float(
            min(
                (points[mesh.node_names.index(n), 2] for n in structure.reaction_nodes),
                default=points[:, 2].min(),
            )
        ),
    }


def diameters(assembly: Assembly) -> FloatArray:
    """Return the outer diameter of every element [m]."""
    p = assembly.mesh.properties
    return np.asarray(np.sqrt(2.0 * (p.A / np.pi + 4.0 * p.I / p.A)))


def _growth(assembly: Assembly, points: FloatArray, coefficients: Coefficients | None) -> FloatArray:
    """Return the thickness of marine growth at the middle of every element [m]."""
    if coefficients is None:
        return np.zeros(assembly.mesh.start.size)
    middle = 0.5 * (points[assembly.mesh.start, 2] + points[assembly.mesh.end, 2])
    return np.asarray(coefficients.thickness(middle))


def _others(assembly: Assembly) -> list[dict[str, Any]]:
    """Return elements between nodes that are not tubes: cables, springs, other beams, rigid links."""
    structure, place = assembly.structure, assembly.mesh.node_names.index
    joins = [(e.kind, e.start, e.end) for e in assembly.mesh.others if e.kind in _LINES]
    joins += [("rigid link", link.leader, link.follower) for link in structure.rigid_links]
    return [{"kind": kind, "start": place(a), "end": place(b)} for kind, a, b in joins]


def _sensors(assembly: Assembly, sensors: Sequence[Sensor]) -> list[dict[str, Any]]:
    sea = assembly.structure.sea_level_z_m
    nodes = assembly.mesh.coordinates - [0.0, 0.0, sea]
    places = sensor_positions(assembly, sensors)
    return [
        {
            "name": s.channel,
            "at": _rounded(at, 3),
            "node": int(np.argmin(np.linalg.norm(nodes - at, axis=1))),
            "direction": _rounded(np.asarray(s.direction) / np.linalg.norm(s.direction), 4),
        }
        for s, at in zip(sensors, places, strict=True)
    ]


def _rounded(values: FloatArray, decimals: int) -> list[Any]:
    """Return values with few decimals, to keep the page small."""
    return np.round(values, decimals).ravel().tolist()


def _digits(values: FloatArray) -> list[float]:
    return [float(f"{value:.5g}") for value in values]


def member_text(assembly: Assembly) -> list[str]:
    """Return the text of each element's tooltip: name, section, material."""
    p = assembly.mesh.properties
    texts = []
    for e, member in enumerate(assembly.mesh.member):
        m = assembly.structure.members[member]
        section = m.section_start
        texts.append(
            f"{m.name} ({m.part.replace('_', ' ') or 'structure'})<br>"
            f"D {section.outer_diameter_m:.3f} m, t {1e3 * section.thickness_m:.1f} mm, L {p.L[e]:.2f} m<br>"
            f"E {p.E[e] / 1e9:.0f} GPa, ρ {p.rho[e]:.0f} kg/m³"
        )
    return texts
