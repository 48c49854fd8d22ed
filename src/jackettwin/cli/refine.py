"""``jackettwin refine``: the steel, stage by stage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import yaml

from jackettwin.cli.console import Reply, answers, output, say, show_table
from jackettwin.errors import located
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.updating import RefinementStage


@click.command("refine")
@click.argument("file", type=click.Path(path_type=Path))
@answers
def refine_command(file: Path) -> Reply:
    """Scale E and ρ of the steel to known frequencies.

    Nothing is written. FILE lists stages: parts on pinned feet, their frequencies, what may change. The
    factors are printed as the steel: block of a twin file.
    """
    from jackettwin.study.refinement import read_refinement, refinement_document
    from jackettwin.updating import refine

    config = read_refinement(file)
    with located(file=file):
        document = refinement_document(refine(config.structure, config.stages))
    return Reply(document, lambda: _show(config.stages, document))


def _show(stages: Sequence[RefinementStage], document: Mapping[str, Any]) -> None:
    for stage, entry in zip(stages, document["stages"], strict=True):
        factors = ", ".join(f"{name} × {value:.4f}" for name, value in entry["factors"].items())
        what = " + ".join(stage.parts) or "the whole structure"
        show_table(Table(f"{what}: {factors or 'compared, nothing changed'}", _COLUMNS, entry["modes"]))
        for m in entry["modes"]:
            if m["worse"]:
                before, after = (f"{_error(m, key):+.2f} %" for key in ("before_hz", "after_hz"))
                say(
                    f"warning: mode {m['mode']} is met worse than before: {before} became {after}; leave it "
                    "out of frequency_hz, or free other steel"
                )
    block = {"structure": {"source": "…", "steel": document["steel"]}}
    output.print(yaml.safe_dump(block, sort_keys=False, allow_unicode=True), end="")


def _error(mode: Mapping[str, Any], key: str) -> float:
    """Return by how many per cent a frequency is off."""
    return float(100 * (mode[key] / mode["target_hz"] - 1.0))


_COLUMNS = (
    TableColumn("mode", "mode"),
    TableColumn("known [Hz]", "target_hz", ".4f"),
    TableColumn("before [Hz]", "before_hz", ".4f"),
    TableColumn("after [Hz]", "after_hz", ".4f"),
    TableColumn("error [%]", lambda mode: _error(mode, "after_hz"), "+.2f"),
)
