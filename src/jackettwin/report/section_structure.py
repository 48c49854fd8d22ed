"""The report's section on the structure: a picture to turn, and what it is made of."""

from __future__ import annotations

import numpy as np

from jackettwin.report import figures_structure
from jackettwin.report.numbers import UNKNOWN, fixed
from jackettwin.report.page import Block, Plot, Table
from jackettwin.twin import TwinResult

_STEEL = (210e9, 7850.0)
"""Young's modulus [Pa] and density [kg/m³] of structural steel."""


def the_structure(result: TwinResult) -> list[Block]:
    """Return the picture of the structure and the table of its parts."""
    figure = figures_structure.structure_3d(result.assembly, result.sensors)
    caption = (
        "The structure, members coloured by the quantity chosen above. "
        "Drag to turn, scroll to zoom; axes are equal."
    )
    return [Plot("structure", caption, figure), structure_table(result)]


def structure_table(result: TwinResult) -> Table:
    """Return what the structure is made of, part by part."""
    mesh, structure = result.assembly.mesh, result.assembly.structure
    p = mesh.properties
    rows: list[tuple[str, ...]] = []
    for part in dict.fromkeys(member.part for member in structure.members):
        chosen = [structure.members[m].part == part for m in mesh.member]
        mass = float((p.rho * p.A * p.L)[chosen].sum())
        members = [m for m in structure.members if m.part == part]
        walls = [1e3 * s.thickness_m for m in members for s in (m.section_start, m.section_end)]
        diameters = [s.outer_diameter_m for m in members for s in (m.section_start, m.section_end)]
        rows.append(
            (
                part.replace("_", " ") or "structure",
                str(len(members)),
                fixed(mass / 1e3, 1),
                _range(diameters, 2),
                _range(walls, 1),
                _range([float(v) / 1e9 for v in p.E[chosen]], 0),
                _range([float(v) for v in p.rho[chosen]], 0),
            )
        )
    for body in structure.masses:
        name = "rotor–nacelle assembly" if body.part == "rna" else f"mass at {body.node}"
        rows.append((name, UNKNOWN, fixed(body.mass_kg / 1e3, 1), *[UNKNOWN] * 4))
    columns = ("part", "members", "mass [t]", "diameter [m]", "wall [mm]", "E [GPa]", "density [kg/m³]")
    caption = "What the structure is made of."
    if (np.abs(p.E / _STEEL[0] - 1.0) > 0.1).any() or (np.abs(p.rho / _STEEL[1] - 1.0) > 0.05).any():
        caption += " Values far from steel's (210 GPa, 7850 kg/m³) stand for what is not drawn."
    return Table(caption, columns, tuple(rows))


def _range(values: list[float], decimals: int) -> str:
    low, high = fixed(min(values), decimals), fixed(max(values), decimals)
    return low if low == high else f"{low} … {high}"
