"""The page on a twin followed through time."""

from __future__ import annotations

from pathlib import Path

from jackettwin.answers import Span
from jackettwin.report.figures_follow import parameters_through_time
from jackettwin.report.numbers import parameter_words
from jackettwin.report.page import Block, PageSection, PageTable, Plot, Text, write_page
from jackettwin.report.sentences import span_words
from jackettwin.twin.followed import Followed
from jackettwin.version import __version__


def build_follow_page(followed: Followed, path: Path) -> Path:
    """Write one self-contained HTML file on a twin followed through time; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    caption = (
        "Does the ground drift? What is known of each parameter from all records up to each day; band: one "
        "slope of all stiffness, 90 %, fitted to the data of all days at once."
    )
    sections = [
        PageSection(
            "Drift",
            (
                Text((followed.statement,)),
                Plot("parameters_through_time", caption, parameters_through_time(followed)),
            ),
        ),
        PageSection("Days", (_table(followed),)),
        *([PageSection("Warnings", (Text(followed.warnings, "warnings"),))] if followed.warnings else []),
    ]
    return write_page(
        sections,
        path,
        title=f"{followed.name} through time",
        subtitle=f"{followed.law}, {len(followed.days)} days · jackettwin {__version__}",
    )


def _table(followed: Followed) -> Block:
    names = list(followed.units)
    rows = []
    for day in followed.days:
        cells = []
        for name in names:
            low, high = day.interval_90[name]
            unit = followed.units[name]
            cells.append(span_words(Span(day.median[name], low, high), unit))
        rows.append((f"{day.time_utc:%Y-%m-%d}", str(day.records), day.status, *cells))
    return PageTable(
        "What was known after each day? Median and 90 % interval of every parameter.",
        ("day (UTC)", "records", "posterior", *map(parameter_words, names)),
        tuple(rows),
        text_columns=3,
    )
