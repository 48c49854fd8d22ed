"""The page on a twin updated day by day."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from jackettwin.answers import Span
from jackettwin.report.figures.follow import parameters_through_time, stiffness_in_time
from jackettwin.report.pages.page import PageSection, Plot, Text, write_page
from jackettwin.report.table import Table
from jackettwin.report.tables.answers import ranged
from jackettwin.report.tables.numbers import count, sentence
from jackettwin.soil import parameter_words
from jackettwin.study import Followed
from jackettwin.version import __version__


def build_follow_page(followed: Followed, path: Path) -> Path:
    """Write one self-contained HTML file on a twin updated day by day; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    each, others = followed.moments, [n for n in followed.units if n not in followed.stiffness]
    drift = (
        f"How stiff is the ground? Stiffness as known after each {each}, with errors of the model that are "
        "the same on all of them; band: one slope of all stiffness, 90 %, if it did not jump."
    )
    more = f"What else is known after each {each}? Median and 90 % interval."
    sections = [
        PageSection(
            "Drift",
            (
                Text((sentence(followed.statement),)),
                *_in_time(followed),
                _plot(followed, "stiffness_through_time", drift, followed.stiffness),
                _table(followed, followed.stiffness),
            ),
        ),
        *([PageSection("Damping", (_plot(followed, "others_through_time", more, others),
                                   _table(followed, others)))] if others else []),
        *([PageSection("Warnings", (Text(followed.warnings, "warnings"),))] if followed.warnings else []),
    ]  # fmt: skip
    return write_page(
        sections,
        path,
        title=f"{followed.name} through time",
        subtitle=f"{followed.law}, {count(len(followed.days), each)} · jackettwin {__version__}",
    )


def stiffness_section(followed: Followed) -> PageSection:
    """Return the section on stiffness through time of a monitored twin, after the answers of its report."""
    said = "All other results are of all records together, as if the stiffness had been the same on all days."
    return PageSection(
        "Stiffness through time", (Text((sentence(followed.stiffness_statement), said)), *_in_time(followed))
    )


def _in_time(followed: Followed) -> tuple[Plot, ...]:
    if len(followed.smoothed) < 2:
        return ()
    caption = (
        "How did the stiffness change since the first day? Points: as known on the day; band: as known now "
        "from all days; dotted: expected. The effect of weather is removed with the stated conditions."
    )
    return (Plot("stiffness_in_time", caption, stiffness_in_time(followed), fits=True),)


def _plot(followed: Followed, name: str, caption: str, names: Sequence[str]) -> Plot:
    return Plot(name, caption, parameters_through_time(followed, names), fits=True)


def _table(followed: Followed, names: Sequence[str]) -> Table:
    by_day, failed = followed.moments == "day", any(day.status != "ok" for day in followed.days)
    rows = []
    for day in followed.days:
        cells = [ranged(Span(day.median[n], *day.interval_90[n]), followed.units[n]) for n in names]
        when = f"{day.time_utc:%Y-%m-%d}" if by_day else f"{day.time_utc:%Y-%m-%d %H:%M}"
        rows.append(
            (when, *([str(day.records)] if by_day else []), *([day.status] if failed else []), *cells)
        )
    columns = ("time (UTC)", *(["records"] if by_day else []), *(["posterior"] if failed else []))
    return Table(
        f"Parameters as known after each {followed.moments}: median and, in brackets, 90 % interval.",
        (*columns, *map(parameter_words, names)),
        tuple(rows),
        text_columns=len(columns),
    )
