"""Welds and their life: rows of JSON, warnings, and tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.caveats import Omission
from jackettwin.cli.console import messages, say, show_table
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.fatigue import TubeLife, WeldLife

SHOWN = 10
"""Largest number of rows in a table."""
SIDE = tuple(TableColumn(name, name) for name in ("joint", "brace", "side"))
POINT = (TableColumn("point", "position"), TableColumn("environment", "environment"))


OF_WELDS = (
    Omission("cans: butt welds stand at nodes, where the model changes a wall"),
    Omission("cones between tubes, seams within a member, piles in the ground"),
    Omission("flanges, grout and castings that --details does not name"),
    Omission("joints in several planes: each plane is assessed separately"),
    Omission("crack growth"),
)
_COLUMNS = (
    *SIDE,
    *POINT,
    TableColumn("largest range [MPa]", "largest_range_mpa", ".1f"),
    TableColumn("life [years]", "life_years", ".3g"),
    TableColumn("within ranges", lambda row: "no" if row["beyond_validity"] else "yes"),
)

_TUBE_COLUMNS = (
    TableColumn("weld", "weld"),
    TableColumn("kind", "kind"),
    *POINT,
    TableColumn("curve", "curve"),
    TableColumn("factor", "scf", ".2f"),
    TableColumn("largest range [MPa]", "largest_range_mpa", ".1f"),
    TableColumn("life [years]", "life_years", ".3g"),
)


def show_welds(title: str, columns: Sequence[TableColumn], rows: Sequence[dict[str, Any]]) -> None:
    """Print the first welds, and how many others there are."""
    show_table(Table(title, columns, rows[:SHOWN]))
    if len(rows) > SHOWN:
        say(f"and {len(rows) - SHOWN} more welds; --json has all of them")


def show_lives(document: dict[str, Any], like: str) -> None:
    """Print lives of joints and tubes, and warnings."""
    shown = (
        ("joints", f"life if all time is like {like}", _COLUMNS),
        ("welds", "butt welds and details of tubes", _TUBE_COLUMNS),
    )
    for key, title, columns in shown:
        if document[key]:
            # a factor outside its range is a bound, and no headline
            show_welds(title, columns, sorted(document[key], key=lambda row: bool(row["beyond_validity"])))
    for warning in document["warnings"]:
        messages.print(f"warning: {warning}")


def lives_document(
    joints: Sequence[WeldLife],
    tubes: Sequence[TubeLife],
    apart: Sequence[str],
    *,
    before: Sequence[str] = (),
    after: Sequence[str] = (),
) -> dict[str, Any]:
    """Return the lives of welds and the warnings on them as JSON has them.

    Parameters
    ----------
    apart : nodes in line where walls do not meet
    before, after : other warnings, by their place
    """
    rows = [_weld_row(one) for one in joints]
    return {
        "joints": rows,
        "welds": [_tube_row(one) for one in tubes],
        "warnings": [*before, *_weld_warnings(rows), *_tube_warnings(tubes, apart), *after],
    }


def _weld_row(one: WeldLife) -> dict[str, Any]:
    """Return one side of a joint's weld as JSON has it."""
    weld = one.weld
    return {
        "joint": weld.node,
        "chord": weld.chord,
        "brace": weld.brace,
        "side": one.side,
        "position": one.position,
        "z_m": one.z_m,
        "environment": one.environment,
        "scf": weld.scf,
        **_life(one),
    }


def _tube_row(one: TubeLife) -> dict[str, Any]:
    """Return a weld around a tube as JSON has it."""
    weld = one.weld
    return {
        "weld": weld.name,
        "kind": weld.kind,
        "member": weld.member,
        "member_position": weld.position,
        "position": one.position,
        "z_m": weld.z_m,
        "outer_diameter_m": weld.section.outer_diameter_m,
        "thickness_m": weld.section.thickness_m,
        "environment": one.environment,
        "curve": one.curve,
        "scf": weld.scf,
        **_life(one),
    }


def _life(one: WeldLife | TubeLife) -> dict[str, Any]:
    life = one.life
    return {
        "largest_range_mpa": 1e-6 * one.largest_range_pa,
        "damage": life.damage,
        "damage_by_point": one.damage_by_point,
        "damage_interval_90": list(life.damage_interval_90),
        "life_years": life.life_years if np.isfinite(life.life_years) else None,
        "variance_shares": life.variance_shares,
        "beyond_validity": list(one.weld.warnings),
    }


def _tube_warnings(tubes: Sequence[TubeLife], apart: Sequence[str]) -> list[str]:
    """Return what a reader must know of the welds around tubes."""
    from jackettwin.structure import few

    said = [f"{one.weld.name}: {text}" for one in tubes for text in one.weld.warnings]
    found = [f"{len(said)} butt welds are beyond the range of their factors: {few(said)}"] if said else []
    if apart:
        found.append(
            "no butt weld where the walls of tubes in line do not meet, as of a stepped taper: "
            f"{few(list(apart))} (--details can name them)"
        )
    return found


def _weld_warnings(rows: list[dict[str, Any]]) -> list[str]:
    """Return what a reader must know of the joints' welds."""
    from jackettwin.structure import few

    outside = [row for row in rows if row["beyond_validity"]]
    if not outside:
        return []
    named = few(list(dict.fromkeys(f"{row['brace']} at {row['joint']}" for row in outside)))
    shortest = outside[0]["life_years"]
    least = "" if shortest is None else f"; by the larger factor there and at the limit {shortest:.3g} years"
    said = f"{len(outside)} of {len(rows)} welds are beyond the validity ranges of Efthymiou's factors"
    return [f"{said}: {named}{least}"]
