"""``jackettwin refine``: update of the structure in stages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import yaml

from jackettwin.cli.console import Reply, answers, output, say, show_table, working
from jackettwin.intervals import NORMAL_90
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.updating import Factor, RefinementStage


@click.command("refine")
@click.argument("file", type=click.Path(path_type=Path))
@answers
def refine_command(file: Path) -> Reply:
    """Fit steel, masses and springs to known frequencies.

    FILE lists stages: parts on pinned feet, their frequencies, and the free properties of steel, walls,
    masses and springs, each with bounds and a tolerance. No file is written; the result is printed as the
    structure: block of a twin file.
    """
    from jackettwin.study.refinement import read_refinement, refinement_document

    config = read_refinement(file)
    with working(f"refine {config.structure.name}"):
        document = refinement_document(config.refine())
    return Reply(document, lambda: _show(config.stages, document, config.block(document)))


def _show(stages: Sequence[RefinementStage], document: Mapping[str, Any], block: Mapping[str, Any]) -> None:
    for stage, entry in zip(stages, document["stages"], strict=True):
        what = " + ".join(stage.parts) or "the whole structure"
        changes = ", ".join(_change(f, entry) for f in stage.factors)
        show_table(Table(f"{what}: {changes or 'compared only'}", _COLUMNS, entry["modes"]))
        for name in entry["at_bound"]:
            say(f"warning: {name} lies on a bound: widen it if that is possible, or free another property")
        for m in entry["modes"]:
            if m["worse"]:
                errors = _from_to(m, "before_hz", "after_hz")
                say(
                    f"warning: mode {m['mode']} has a larger misfit than before: {errors}; omit it from "
                    "frequency_hz, or free another property"
                )
            if m["worse_at_the_end"]:
                say(
                    f"warning: mode {m['mode']} of {what} has a larger misfit after all stages: "
                    f"{_from_to(m, 'after_hz', 'final_hz')}; a later stage changes these parts"
                )
    output.print(yaml.safe_dump({"structure": block}, sort_keys=False, allow_unicode=True), end="")


def _change(factor: Factor, entry: Mapping[str, Any]) -> str:
    """Return the change of a property, with half its 90 % interval if it has a tolerance and is no bound."""
    value, std = entry["factors"][factor.name], entry["std"][factor.name]
    known = std is not None and factor.tolerance is not None and factor.name not in entry["at_bound"]
    about = f" ± {float(f'{NORMAL_90 * std:.2g}'):g} (90 %)" if known else ""
    done = f"× {value:.4f}" if factor.is_factor else f"{value:+.6g}"
    return f"{factor.name} {done}{about}"


def _from_to(mode: Mapping[str, Any], before: str, after: str) -> str:
    return f"{_error(mode, before):+.2f} % became {_error(mode, after):+.2f} %"


def _error(mode: Mapping[str, Any], key: str) -> float:
    """Return the error of a frequency in per cent."""
    return float(100 * (mode[key] / mode["target_hz"] - 1.0))


_COLUMNS = (
    TableColumn("mode", "mode"),
    TableColumn("known [Hz]", "target_hz", ".4f"),
    TableColumn("before [Hz]", "before_hz", ".4f"),
    TableColumn("after [Hz]", "after_hz", ".4f"),
    TableColumn("error [%]", lambda mode: _error(mode, "after_hz"), "+.2f"),
)
