"""``jackettwin stages``: a structure part by part, beside another one or the thesis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from jackettwin.cli.console import Reply, answers, say, show_table
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.updating import Stage


Reference = dict[str, tuple[float, ...]]

_PUBLISHED = {
    "thesis": {"jacket": "T5.2", "tower": "T5.4"},
    "rosap": {"jacket": "T5.2-ROSAP", "tower": "T5.4-ROSAP"},
}
"""Tables 5.2 and 5.4, Python and ROSAP rows, by the part added last; table 5.3 repeats table 5.2."""


@click.command("stages")
@click.argument("structure")
@click.option("--against", help="thesis, rosap (tables 5.2 and 5.4), or another structure.")
@click.option("--number", default=5, show_default=True, type=click.IntRange(1, 100), help="How many modes.")
@click.option("--gravity", is_flag=True, help="Add the geometric (P-Δ) stiffness of the self-weight.")
@answers
def stages_command(structure: str, against: str | None, number: int, gravity: bool) -> Reply:
    """Compute frequencies of STRUCTURE as its parts are added.

    It stands on pinned feet; the jacket comes first, then the transition piece, then the tower.
    """
    from jackettwin.decks import read_structure
    from jackettwin.updating import stages
    from jackettwin.verify import published

    own = stages(read_structure(structure), number, gravity=gravity)
    reference: Reference = {}
    if against is not None:
        tables = _PUBLISHED.get(against)
        reference = (
            {part: published(key) for part, key in tables.items()}
            if tables
            else _paired(own, stages(read_structure(against), number, gravity=gravity))
        )
    alone = [s.name for s in own if against is not None and s.parts[-1] not in reference]
    document = {
        "structure": structure,
        "against": against,
        "stages": [_row(s, reference) for s in own],
        "not_compared": alone,
    }
    return Reply(document, lambda: _show(document))


def _paired(own: tuple[Stage, ...], other: tuple[Stage, ...]) -> Reference:
    """Return the other structure's frequencies by our part added last: the whole is always comparable.

    Other stages are, where the same parts stand in both.
    """
    theirs = {frozenset(stage.parts): stage for stage in other[:-1]}
    pairs = [(stage, theirs.get(frozenset(stage.parts))) for stage in own[:-1]] + [(own[-1], other[-1])]
    return {
        stage.parts[-1]: tuple(map(float, match.frequency_hz)) for stage, match in pairs if match is not None
    }


def _row(stage: Stage, reference: Reference) -> dict[str, Any]:
    theirs = reference.get(stage.parts[-1], ())
    modes = []
    for k, f in enumerate(stage.frequency_hz):
        other = theirs[k] if k < len(theirs) else None
        modes.append(
            {
                "mode": k + 1,
                "frequency_hz": float(f),
                "reference_frequency_hz": other,
                "relative_error": None if other is None else float(f) / other - 1.0,
            }
        )
    return {"name": stage.name, "parts": stage.parts, "mass_kg": stage.mass_kg, "modes": modes}


def _show(document: dict[str, Any]) -> None:
    columns = (TableColumn("mode", "mode"), TableColumn("f [Hz]", "frequency_hz", ".4f"))
    compared = (
        TableColumn(f"{document['against']} f [Hz]", "reference_frequency_hz", ".4g"),
        TableColumn("difference [%]", "relative_error", ".3g", 100.0),
    )
    for stage in document["stages"]:
        title = f"{stage['name'].replace('_', ' ')}: {stage['mass_kg'] / 1e3:,.0f} t"
        known = any(row["reference_frequency_hz"] is not None for row in stage["modes"])
        show_table(Table(title, (*columns, *(compared if known else ())), stage["modes"]))
    if document["not_compared"]:
        say(
            f"not compared with {document['against']}: {', '.join(document['not_compared'])}; "
            "it has no stage of the same parts (SubDyn decks name none: only the whole can be compared)"
        )
