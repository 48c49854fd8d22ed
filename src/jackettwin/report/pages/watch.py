"""The page on modes monitored through time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jackettwin.change import (
    MonitoredTable,
    alike_sentence,
    corrected_sentence,
    next_sentence,
    smallest_documents,
    smallest_sentence,
    statement,
)
from jackettwin.report.figures.watch import (
    change_pattern,
    evidence_through_time,
    explained_shares,
    frequencies,
    leading,
    unexplained_through_time,
)
from jackettwin.report.pages.page import Block, PageSection, Plot, Text, write_page
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import count
from jackettwin.version import __version__

_LISTED = 0.01
"""Smallest probability of a cause in the table; ``watched.json`` has all causes."""
_PATTERN = (
    "Change of each quantity with its 90 % interval, and the changes that the most likely causes predict."
)


def build_watch_page(watched: MonitoredTable, path: Path) -> Path:
    """Write one self-contained HTML file on modes monitored through time; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    outcome: list[Block] = [Text((statement(watched),))]
    if could := smallest_sentence(smallest_documents(watched.smallest)):
        outcome.append(Text((could,)))
    sections = []
    if watched.looks:
        caption = (
            "Daily residuals after the effects of conditions. Grey: range of nine days out of ten without a "
            "change. Orange: onset of the change, 90 %; red: alarm and size of the change."
        )
        figure = unexplained_through_time(watched, [leading(watched)])
        outcome.append(Plot("leading_through_time", caption, figure, fits=True))
    sections.append(PageSection("Has it changed?", tuple(outcome)))
    sections += [
        PageSection(f"Change {i + 1}" if len(watched.alarms) > 1 else "The change", tuple(_alarm(watched, i)))
        for i in range(len(watched.alarms))
    ]
    if watched.looks:
        figure = unexplained_through_time(watched, frequencies(watched))
        caption = "The same for every frequency, and for the direction of every pair of modes that has one."
        sections.append(
            PageSection("Every mode", (Plot("unexplained_through_time", caption, figure, fits=True),))
        )
        caption = (
            "Evidence for all tested changes, summed over possible onsets. Without a change, the mean time "
            f"until the dashed line is reached is {watched.watch.arl_years:g} years."
        )
        sections.append(
            PageSection(
                "Evidence",
                (Plot("evidence_through_time", caption, evidence_through_time(watched), fits=True),),
            )
        )
    caption = "Share of the variance of each quantity over the baseline that each condition explains."
    sections.append(
        PageSection(
            "Effects of conditions",
            (Plot("explained_shares", caption, explained_shares(watched), fits=True),),
        )
    )
    if watched.limits:
        sections.append(PageSection("Limits", (Text(watched.limits, "list"),)))
    return write_page(
        sections,
        path,
        title=f"{watched.table.name} watched",
        subtitle=f"{count(len(watched.looks), 'day')} after the baseline · jackettwin {__version__}",
    )


def _alarm(watched: MonitoredTable, number: int) -> list[Block]:
    document = watched.documents[number]
    shown = [cause for cause in document["causes"] if cause["probability"] >= _LISTED]
    rows = [(c["cause"], f"{100.0 * c['probability']:.0f}", *_size(c)) for c in shown]
    others = len(document["causes"]) - len(shown)
    if others:
        rest = 1.0 - sum(cause["probability"] for cause in shown)
        rows.append((count(others, "other cause"), f"{100.0 * rest:.0f}", "–", "–"))
    caption = "Probable causes, given the data of the change."
    pattern = change_pattern(watched, watched.alarms[number])
    blocks: list[Block] = [
        Table(caption, ("cause", "probability [%]", "size", "90 %"), tuple(rows)),
        Plot(f"change_pattern_{number + 1}", _PATTERN, pattern, fits=True),
    ]
    if alike := alike_sentence(document):
        blocks.append(Text((f"{alike}.",)))
    if corrected := corrected_sentence(document):
        blocks.insert(0, Text((f"{corrected[0].upper()}{corrected[1:]}.",)))
    if document["inseparable"]:
        said = tuple(f"These data do not distinguish {', '.join(g)}." for g in document["inseparable"])
        blocks.append(Text(said, "list"))
    if document["next_measurements"]:
        blocks.append(Text((next_sentence(document),)))
    return blocks


def _size(cause: Mapping[str, Any]) -> tuple[str, str]:
    """Return size and interval as text; a cause that is either present or not has no size."""
    if cause["interval_90"] is None or cause["cause"].partition(" (or ")[0].endswith((" lost", " flooded")):
        return "–", "–"
    (low, high), unit = cause["interval_90"], cause["unit"]
    scale, unit = {"-": (100.0, "%"), "m": (1000.0, "mm"), "kg": (1e-3, "t")}.get(unit, (1.0, unit))
    if unit == "mm" and abs(cause["size"]) >= 0.1:
        scale, unit = 1.0, "m"
    size, *ends = (f"{scale * x:.2g}" for x in (cause["size"], low, high))
    return f"{size} {unit}", f"{ends[0]} to {ends[1]}"
