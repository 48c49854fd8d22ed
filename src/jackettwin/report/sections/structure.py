"""The report's section on the structure: a 3D view, and a table of its parts."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray
from jackettwin.report.pages.page import Block, Embedded
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import UNKNOWN, fixed, words
from jackettwin.report.view.motions import SensorMotion, damped_motion, measured_shape
from jackettwin.report.view.page import View, render_view
from jackettwin.report.view.quantities import thickness_quantities
from jackettwin.study import MeasuredMode, TwinResult
from jackettwin.updating import recommended

_STEEL = (210e9, 7850.0)
"""Young's modulus [Pa] and density [kg/m³] of structural steel."""


def the_structure(result: TwinResult) -> list[Block]:
    """Return the 3D view of the structure with its updated modes, on request, and the table of its parts."""
    caption = "How is the structure built, and how does it move? 3D view with properties and updated modes."
    page = Embedded(
        "structure", caption, render_view(structure_view(result)), "Show the structure and its modes"
    )
    return [page, structure_table(result)]


def structure_view(result: TwinResult) -> View:
    """Return the structure with its updated modes, each beside what was measured of it.

    Shapes are those of the best fit; frequencies and damping ratios are the reported ones.
    """
    u = recommended(result.updates)
    motions = (
        []
        if u is None
        else [
            damped_motion(
                result.assembly,
                words(m.label),
                _pole(float(u.central_hz[i]), float(u.central_damping[i])),
                u.modes.shapes[:, i],
                _measured(result, m, u.modes.shapes[:, i]),
            )
            for i, (m, pole) in enumerate(zip(result.measured, u.modes.poles, strict=True))
            if np.isfinite(pole) and np.isfinite(u.modes.shapes[:, i]).all()
        ]
    )
    return View(result.assembly, thickness_quantities(result.assembly), tuple(motions), result.sensors)


def _pole(frequency_hz: float, damping_ratio: float) -> complex:
    r"""Return the eigenvalue :math:`ω(-ζ + i\sqrt{1 - ζ^2})` [rad/s]."""
    return 2.0 * np.pi * frequency_hz * complex(-damping_ratio, np.sqrt(1.0 - damping_ratio**2))


def _measured(result: TwinResult, mode: MeasuredMode, shape: ComplexArray) -> SensorMotion | None:
    """Return the shape that was measured of a mode, if the record it is of says where its sensors are."""
    for seen in result.observations:
        if not any(mode.estimate is one for one in seen.identification.modes):
            continue
        placed = {sensor.channel: sensor for sensor in seen.sensors}
        names = [channel.name for channel in seen.identification.channels]
        if mode.estimate is not None and all(name in placed for name in names):
            sensors = [placed[name] for name in names]
            return measured_shape(result.assembly, sensors, mode.estimate.mode_shape, shape)
    return None


def structure_table(result: TwinResult) -> Table:
    """Return the parts of the structure with masses and dimensions."""
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
    caption = "What is the structure made of?"
    if (np.abs(p.E / _STEEL[0] - 1.0) > 0.1).any() or (np.abs(p.rho / _STEEL[1] - 1.0) > 0.05).any():
        caption += (
            " Values that differ from those of steel (210 GPa, 7850 kg/m³) account for parts not modelled."
        )
    return Table(caption, columns, tuple(rows))


def _range(values: list[float], decimals: int) -> str:
    low, high = fixed(min(values), decimals), fixed(max(values), decimals)
    return low if low == high else f"{low} … {high}"
