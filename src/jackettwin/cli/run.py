"""``jackettwin run``: the main job."""

from __future__ import annotations

from pathlib import Path

import click

from jackettwin.cli.console import output, print_json, progress
from jackettwin.cli.update import DEFAULT_TWIN, print_updates
from jackettwin.files import atomic_folder, write_json
from jackettwin.report import build_report
from jackettwin.twin import count_steps, read_twin, run_document, run_twin


@click.command("run")
@click.argument("twin", default=DEFAULT_TWIN)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), help="Folder to write; default out/NAME."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
def run_command(twin: str, out: Path | None, as_json: bool) -> None:
    """Go from records to modes to updated supports: report.html, result.json, figures.

    TWIN is a twin file or the name of a shipped twin: openfast_pile (the default: the reference jacket with
    records that OpenFAST produced) or thesis_table_6_1.
    """
    config = read_twin(twin)
    folder = out or Path("out") / config.name
    with progress(count_steps(config) + 1, config.name) as step:
        result = run_twin(config, step=step)
        step("write the report")
        document = run_document(result, report=str(folder / "report.html"))
        with atomic_folder(folder) as temporary:
            build_report(result, temporary)
            write_json(document, temporary / "result.json")
    if as_json:
        print_json(document)
        return
    print_updates(result)
    output.print(f"report: {folder / 'report.html'}")
