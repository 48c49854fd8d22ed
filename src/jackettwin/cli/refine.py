"""``jackettwin refine``: the steel, stage by stage."""

from __future__ import annotations

from pathlib import Path

import click
import yaml
from rich.table import Table

from jackettwin.cli.console import output, print_json
from jackettwin.errors import located
from jackettwin.study.refinement import read_refinement, refinement_document
from jackettwin.updating import refine


@click.command("refine")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def refine_command(file: Path, as_json: bool) -> None:
    """Scale E and ρ of the steel, part by part, to known frequencies; writes nothing.

    FILE lists stages: parts on pinned feet, their frequencies, what may change. The factors are printed as
    the steel: block of a twin file.
    """
    config = read_refinement(file)
    with located(file=file):
        document = refinement_document(refine(config.structure, config.stages))
    if as_json:
        print_json(document)
        return
    for stage, entry in zip(config.stages, document["stages"], strict=True):
        factors = ", ".join(f"{name} × {value:.4f}" for name, value in entry["factors"].items())
        title = (
            f"{' + '.join(stage.parts) or 'the whole structure'}: {factors or 'compared, nothing changed'}"
        )
        table = Table("mode", "known [Hz]", "before [Hz]", "after [Hz]", "error [%]", title=title)
        for m in entry["modes"]:
            error = 100 * (m["after_hz"] / m["target_hz"] - 1.0)
            values = (f"{m[key]:.4f}" for key in ("target_hz", "before_hz", "after_hz"))
            table.add_row(str(m["mode"]), *values, f"{error:+.2f}")
        output.print(table)
        for m in entry["modes"]:
            if m["worse"]:
                before, after = (100 * (m[key] / m["target_hz"] - 1.0) for key in ("before_hz", "after_hz"))
                output.print(
                    f"warning: mode {m['mode']} is met worse than before: {before:+.2f} % became "
                    f"{after:+.2f} %; leave it out of frequency_hz, or free other steel"
                )
    block = {"structure": {"source": "…", "steel": document["steel"]}}
    output.print(yaml.safe_dump(block, sort_keys=False, allow_unicode=True), end="")
