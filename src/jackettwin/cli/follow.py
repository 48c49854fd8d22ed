"""``jackettwin follow``: the supports of a twin updated day by day, and their drift."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jackettwin.cli.cache import keeping
from jackettwin.cli.console import Reply, answers, progress, say, say_all, show_table, with_omissions
from jackettwin.report import Table

if TYPE_CHECKING:
    from jackettwin.study import Followed
    from jackettwin.study.follow import Each


@click.command("follow")
@click.argument("twin")
@click.option("--law", help="Only this law; default: the first of the twin file, or the prior's.")
@click.option(
    "--each",
    type=click.Choice(["day", "record"]),
    default="day",
    show_default=True,
    help="Update the twin after each UTC day or after each record.",
)
@click.option(
    "--prior",
    "prior_file",
    type=click.Path(path_type=Path, dir_okay=False),
    help="followed.json of an earlier run to continue; its records are skipped.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for followed.json (the next run's prior), report.html and modes_in_time.csv.",
)
@click.option("--fresh", is_flag=True, help="Ignore stored identifications of earlier runs.")
@answers
def follow_command(
    twin: str,
    law: str | None,
    each: Each,
    prior_file: Path | None,
    out: Path | None,
    fresh: bool,
) -> Reply:
    """Update the supports of TWIN day after day, and find drift.

    The result of one day is the start of the next. To continue, name the new records in TWIN and use --prior.
    """
    from jackettwin.files import atomic_folder, check_room, write_json
    from jackettwin.report.pages.follow import build_follow_page
    from jackettwin.soil import family
    from jackettwin.study import MODES_IN_TIME, follow, write_modes_in_time
    from jackettwin.study.follow_result import follow_document, read_followed
    from jackettwin.study.modes_in_time import rows_of_days
    from jackettwin.twin import read_twin, twin_model

    config = read_twin(twin)
    if law is not None:
        family(law, field="--law")
    if out is not None:
        check_room(out)
    prior = None if prior_file is None else read_followed(prior_file)
    with progress(2 * len(config.records), config.name) as step:
        followed = follow(
            config,
            law=law,
            each=each,
            prior=prior,
            workers=os.cpu_count() or 1,
            progress=step,
            keep=keeping(fresh=fresh),
        )
    document = follow_document(followed)
    if out is not None:
        with atomic_folder(out) as temporary:
            write_json(with_omissions(document, "follow"), temporary / "followed.json")
            build_follow_page(followed, temporary / "report.html")
            rows = rows_of_days(twin_model(config), followed.state)
            write_modes_in_time(rows, temporary / MODES_IN_TIME)

    def show() -> None:
        show_table(_table(followed))
        say(followed.statement)
        say_all(followed.warnings, "warning")
        if out is not None:
            say(f"report: {out / 'report.html'}; next prior: {out / 'followed.json'}")

    return Reply(document, show)


def _table(followed: Followed) -> Table:
    from jackettwin.answers import Span
    from jackettwin.report import span_words
    from jackettwin.soil import parameter_words

    heads = ("time (UTC)", "records", *map(parameter_words, followed.stiffness))
    rows = []
    for day in followed.days:
        spans = {n: Span(day.median[n], *day.interval_90[n]) for n in followed.stiffness}
        cells = (span_words(span, followed.units[n]) for n, span in spans.items())
        rows.append((f"{day.time_utc:%Y-%m-%d %H:%M}", day.records, *cells))
    return Table("", heads, rows)
