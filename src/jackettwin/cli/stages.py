"""``jackettwin stages``: frequencies of a structure by parts, compared with another one or the thesis."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jackettwin.cli.comparison import comparison_document, is_table, require_shapes, show_comparison
from jackettwin.cli.console import PageFile, Reply, answers, say, show_table
from jackettwin.errors import InputError, look_up
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.decks import NodalModes
    from jackettwin.response import ModeComparison
    from jackettwin.updating import Stage


Reference = dict[str, tuple[float | None, ...]]

_PUBLISHED = {
    "thesis": {"jacket": "T5.2", "tower": "T5.4"},
    "rosap": {"jacket": "T5.2-ROSAP", "tower": "T5.4-ROSAP"},
}
"""Tables 5.2 and 5.4, Python and ROSAP rows, by the part added last; table 5.3 repeats table 5.2."""


@click.command("stages")
@click.argument("structure")
@click.option(
    "--against",
    help="thesis, rosap (tables 5.2 and 5.4), another structure, or FILE.csv: modes of another program.",
)
@click.option("--figure", type=PageFile(), help="Page that compares the shapes, if there are any.")
@click.option("--number", default=5, show_default=True, type=click.IntRange(1, 100), help="Number of modes.")
@click.option("--gravity", is_flag=True, help="Add the geometric (P-Δ) stiffness of the self-weight.")
@answers
def stages_command(
    structure: str, against: str | None, figure: Path | None, number: int, gravity: bool
) -> Reply:
    """Compute frequencies of STRUCTURE as its parts are added.

    STRUCTURE has pinned feet; the parts are the jacket, then the transition piece, then the tower.
    """
    from jackettwin.decks import read_modes, read_structure
    from jackettwin.report.pages.comparison import write_comparison
    from jackettwin.updating import stages
    from jackettwin.verify import published

    own = stages(read_structure(structure), number, gravity=gravity)
    reference: Reference = {}
    shapes: dict[str, ModeComparison] = {}
    if against in _PUBLISHED:
        reference = {part: published(key) for part, key in _PUBLISHED[against].items()}
    elif against is not None and is_table(against):
        shapes = _against_table(own, read_modes(Path(against)))
    elif against is not None:
        others = _paired(own, stages(read_structure(against), number, gravity=gravity))
        reference = {part: tuple(map(float, stage.frequency_hz)) for part, stage in others.items()}
        shapes = _against_structure(own, others)
    if figure is not None:
        require_shapes(shapes, figure)
        told = [(s.name, s.assembly, shapes[s.parts[-1]]) for s in own if s.parts[-1] in shapes]
        write_comparison(told, figure, title=structure, names=("jackettwin", Path(str(against)).stem))
    reference |= {part: _frequencies_of_pairs(found) for part, found in shapes.items()}
    alone = [s.name for s in own if against is not None and s.parts[-1] not in reference]
    document = {
        "structure": structure,
        "against": against,
        "stages": [
            _row(s, reference) | {"shapes": comparison_document(shapes.get(s.parts[-1]))} for s in own
        ],
        "not_compared": alone,
        "page": None if figure is None else str(figure),
    }
    return Reply(document, lambda: _show(document))


def _against_table(own: tuple[Stage, ...], tables: dict[str, NodalModes]) -> dict[str, ModeComparison]:
    """Return the comparison with a table's stages by the part added last; without stages, of the whole."""
    from jackettwin.response import compare_modes

    known = {name: s for s in own for name in (s.name, s.parts[-1])} | {"": own[-1]}
    found = {}
    for name, other in tables.items():
        stage = look_up(known, name, "stage", field="stage")
        found[stage.parts[-1]] = compare_modes(stage.assembly, stage.modes, other)
    return found


def _frequencies_of_pairs(found: ModeComparison) -> tuple[float | None, ...]:
    """Return the other program's frequency of each own mode; None without a similar mode."""
    other = {pair.own: float(found.other.frequency_hz[pair.other]) for pair in found.pairs}
    return tuple(other.get(k) for k in range(found.own.omega.size))


def _against_structure(own: tuple[Stage, ...], others: dict[str, Stage]) -> dict[str, ModeComparison]:
    """Return the comparison of shapes with another structure's stages with enough common nodes, by part."""
    from jackettwin.response import compare_modes, nodal_modes

    found = {}
    for stage in own:
        other = others.get(stage.parts[-1])
        if other is not None:
            with suppress(InputError):  # too few common nodes: only frequencies are compared
                theirs = nodal_modes(other.assembly, other.modes)
                found[stage.parts[-1]] = compare_modes(stage.assembly, stage.modes, theirs)
    return found


def _paired(own: tuple[Stage, ...], other: tuple[Stage, ...]) -> dict[str, Stage]:
    """Return the other structure's stages by the part added last.

    The whole is always comparable, other stages only if both have the same parts.
    """
    theirs = {frozenset(stage.parts): stage for stage in other[:-1]}
    pairs = [(stage, theirs.get(frozenset(stage.parts))) for stage in own[:-1]] + [(own[-1], other[-1])]
    return {stage.parts[-1]: match for stage, match in pairs if match is not None}


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
        show_comparison(stage["shapes"])
    if document["page"]:
        say(f"wrote {document['page']}")
    if document["not_compared"]:
        say(
            f"not compared with {document['against']}: {', '.join(document['not_compared'])}; "
            "it has no stage of the same parts (SubDyn decks have no parts: only the whole can be compared)"
        )
