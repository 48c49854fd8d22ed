"""``jackettwin run``: from records to updated supports and a report."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import click

from jackettwin.cli.answers import answers_document, print_answers
from jackettwin.cli.cache import keeping
from jackettwin.cli.console import Reply, answers, progress, say, with_omissions
from jackettwin.cli.provenance import provenance
from jackettwin.cli.update import DEFAULT_TWIN, print_updates

SIMULATED_TWIN = "simulated"


@click.command("run")
@click.argument("twin", required=False)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), help="Folder to write; default out/NAME."
)
@click.option(
    "--simulate", is_flag=True, help="Simulate the records first, of an asset with known parameters."
)
@click.option("--set", "set_file", default="demo", show_default=True, help="Set of scenarios to simulate.")
@click.option(
    "--all-laws", is_flag=True, help="Sample the posterior of every law and compare them by evidence; slower."
)
@click.option("--compare", is_flag=True, help="Identify the first record by every method, for comparison.")
@click.option("--fresh", is_flag=True, help="Ignore stored identifications and fits of earlier runs.")
@answers
def run_command(
    twin: str | None,
    out: Path | None,
    simulate: bool,
    set_file: str,
    all_laws: bool,
    compare: bool,
    fresh: bool,
) -> Reply:
    """Go from records to modes to updated supports, and report it.

    The folder receives report.html, result.json and figures.     TWIN is a twin file or the name of a shipped
    twin: openfast_pile (the default: the reference jacket with records that OpenFAST produced) or
    thesis_table_6_1. With --simulate the records come from `jackettwin simulate-set`, by default those of
    a known asset, with whose true values the report compares. Only the recommended law gets a posterior (the
    twin's first, unless another is ten times as probable); --all-laws samples that of every law.
    """
    from jackettwin.answers import Span, answer as answer_run
    from jackettwin.files import atomic_folder, check_room, write_json
    from jackettwin.report import build_report, value_words
    from jackettwin.study import (
        MODES_IN_TIME,
        count_steps,
        run_document,
        run_twin,
        true_parameters,
        write_modes_in_time,
    )
    from jackettwin.study.modes_in_time import rows_of_records
    from jackettwin.twin import inputs_document, read_twin

    config = read_twin(twin or (SIMULATED_TWIN if simulate else DEFAULT_TWIN), records_follow=simulate)
    folder = out or Path("out") / config.name
    check_room(folder)
    if simulate:
        config = replace(config, records=_simulated(set_file, folder / "records"), targets=())
    with progress(count_steps(config) + 1, config.name) as step:
        result = run_twin(
            config,
            compare=compare,
            posteriors="all" if all_laws else "likely",
            workers=os.cpu_count() or 1,
            progress=step,
            keep=keeping(fresh=fresh),
        )
        step("write the report")
        found = answer_run(result)
        made = provenance(config)
        document = run_document(result, report=str(folder / "report.html")) | answers_document(found)
        document |= {"provenance": dict(made), "inputs": inputs_document(config)}
        with atomic_folder(folder) as temporary:
            build_report(result, temporary, answers=found, provenance=made)
            write_json(with_omissions(document, "run"), temporary / "result.json")
            rows = rows_of_records(result.observations)
            write_modes_in_time(rows, temporary / MODES_IN_TIME)

    def show() -> None:
        print_answers(found)
        print_updates(result, only=found.law)
        for p in true_parameters(result):
            true, value = (value_words(Span(x), p.unit) for x in (p.true, p.value))
            say(f"  true {p.name} = {true}, updated {value}: {_COVERED[p.covered]}")
        say(f"report: {folder / 'report.html'}")

    return Reply(document, show)


_COVERED = {None: "no interval", True: "inside its 90 % interval", False: "outside its 90 % interval"}


def _simulated(set_file: str, folder: Path) -> tuple[Path, ...]:
    """Simulate the pending cases of a set and return its records."""
    from jackettwin.simulate import pending_cases, read_set, record_path, run_set

    chosen = read_set(set_file)
    with progress(len(pending_cases(chosen, folder)), f"simulate {chosen.name}") as step:
        run_set(chosen, folder, step=step)
    return tuple(record_path(case, folder) for case in chosen.cases)
