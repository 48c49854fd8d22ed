"""Tables printed by ``jackettwin check``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jackettwin.caveats import omission_sentences
from jackettwin.cli.check_document import FORCES_OF_SECTION
from jackettwin.cli.console import say, say_all, show_table
from jackettwin.report import Table, TableColumn

_SHOWN = 15
"""Number of members shown on the terminal."""
_TRACE = 0.005
"""Share of a joint's class below which it is not shown."""
_HEADINGS = ("N", "Vy", "Vz", "T", "My", "Mz")


def show_check(document: dict[str, Any]) -> None:
    """Print the uses, the largest first, and what to beware of."""
    members = document["members"]
    show_table(Table(document["structure"], _USE, members[:_SHOWN]))
    if not all(row["covered"] for row in members[:_SHOWN]):
        say("* beyond 13.1, which the warnings explain")
    if document["combinations"]:
        show_table(Table("combinations", _COMBINATIONS, document["combinations"]))
    show_table(Table("section forces there [kN, kN·m]", _SECTION_FORCES, members[:_SHOWN]))
    if len(members) > _SHOWN:
        more = len(members) - _SHOWN
        say(f"and {more} more members; --json has all of them, with the forces at both ends")
    if document["joints"]:
        _show_joints(document["joints"])
    if document["piles"]:
        show_table(
            Table("piles, ISO 19902 17 and 13; forces on their heads in MN", _PILES, document["piles"])
        )
    if document["grouted"]:
        show_table(Table("grouted connections, ISO 19902 15.1", _GROUTED, document["grouted"]))
    if document["vortices"]:
        show_table(Table("vortices, by reduced velocity", _VORTICES, document["vortices"][:_SHOWN]))
    if document["sheet"] is not None:
        show_table(Table("calculation, ISO 19902", _SHEET, document["sheet"]))
    say(f"largest von Mises stress {document['largest_von_mises_stress_pa'] / 1e6:.1f} MPa")
    say_all(document["warnings"], "warning")
    say_all(omission_sentences(document["left_out"]), "left out")


def _show_joints(rows: list[dict[str, Any]]) -> None:
    show_table(Table("tubular joints, ISO 19902 14.3; forces in kN, kN·m", _JOINTS, rows[:_SHOWN]))
    if any(row["beyond_validity"] for row in rows[:_SHOWN]):
        say("* beyond the ranges of 14.3.1; --json gives the reason")
    if len(rows) > _SHOWN:
        say(f"and {len(rows) - _SHOWN} more braces at joints; --json has all of them")


def _governing(name: str) -> Callable[[dict[str, Any]], float]:
    return lambda row: row["governing"][name]


_PLACES = {0.0: "start", 1.0: "end"}
_USE = (
    TableColumn("member", "member"),
    TableColumn("part", "part"),
    TableColumn("utilisation", lambda row: f"{row['utilisation']:.3f}{'' if row['covered'] else '*'}"),
    TableColumn("governed by", "clause"),
    TableColumn("K", "effective_length_factor", "g"),
    TableColumn("L [m]", "column_length_m", ".2f"),
)
_COMBINATIONS = (
    TableColumn("combination", "combination"),
    TableColumn("member", "member"),
    TableColumn("utilisation", "utilisation", ".3f"),
    TableColumn("joint", "joint"),
    TableColumn("utilisation", "joint_utilisation", ".3f"),
)
_SECTION_FORCES = (
    TableColumn("member", "member"),
    TableColumn("at", lambda row: _PLACES.get(at := row["governing"]["position"], f"{at:.2f} L")),
    *(
        TableColumn(heading, _governing(name), ",.1f", 1e-3)
        for heading, name in zip(_HEADINGS, FORCES_OF_SECTION, strict=True)
    ),
)
_JOINTS = (
    TableColumn("joint", "node"),
    TableColumn("chord", "chord"),
    TableColumn("brace", "brace"),
    TableColumn(
        "utilisation", lambda row: f"{row['utilisation']:.3f}{'*' if row['beyond_validity'] else ''}"
    ),
    TableColumn(
        "class",
        lambda row: " ".join(
            f"{kind} {share:.2f}" for kind, share in row["shares"].items() if share > _TRACE
        ),
    ),
    TableColumn("β", "beta", ".2f"),
    TableColumn("γ", "gamma", ".1f"),
    TableColumn("θ [°]", "theta_deg", ".0f"),
    TableColumn("N", "axial_n", ",.1f", 1e-3),
    TableColumn("M in plane", "in_plane_nm", ",.1f", 1e-3),
    TableColumn("M out of plane", "out_of_plane_nm", ",.1f", 1e-3),
)
_SHEET = (
    TableColumn("", "symbol"),
    TableColumn("formula", "formula"),
    TableColumn("value", "value", ".5g"),
    TableColumn("unit", "unit"),
    TableColumn("clause", "clause"),
)
_GROUTED = (
    TableColumn("foot", "foot"),
    TableColumn(
        "utilisation", lambda row: f"{row['utilisation']:.3f}{'*' if row['beyond_validity'] else ''}"
    ),
    TableColumn("governed by", "governs"),
    TableColumn("N [MN]", "axial_n", ".2f", 1e-6),
    TableColumn("σ [MPa]", "stress_pa", ".3f", 1e-6),
    TableColumn("f sliding [MPa]", "sliding_pa", ".3f", 1e-6),
    TableColumn("f grout [MPa]", "shear_pa", ".3f", 1e-6),
)
_PILES = (
    TableColumn("foot", "foot"),
    TableColumn("axial use", "axial_utilisation", ".3f"),
    TableColumn("lateral use", "lateral_utilisation", ".3f"),
    TableColumn("steel use", "steel_utilisation", ".3f"),
    TableColumn("at depth [m]", "steel_depth_m", ".1f"),
    TableColumn("head moves [mm]", "head_displacement_m", ".1f", 1e3),
    TableColumn("capacity ↓ [MN]", "capacity_compression_n", ".1f", 1e-6),
    TableColumn("↑ [MN]", "capacity_tension_n", ".1f", 1e-6),
    TableColumn("Fz", lambda row: row["head_force"]["z_n"], ".2f", 1e-6),
    TableColumn("Fx", lambda row: row["head_force"]["x_n"], ".2f", 1e-6),
    TableColumn("Fy", lambda row: row["head_force"]["y_n"], ".2f", 1e-6),
)
_VORTICES = (
    TableColumn("member", "member"),
    TableColumn("in", "medium"),
    TableColumn("D [m]", "diameter_m", ".2f"),
    TableColumn("f [Hz]", "frequency_hz", ".3g"),
    TableColumn("V_R", "reduced_velocity", ".2f"),
    TableColumn("onset", "onset", ".2f"),
    TableColumn("from [m/s]", "onset_m_s", ".2f"),
    TableColumn("excites", "excites"),
    TableColumn("by", "clause"),
)
