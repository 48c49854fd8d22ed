"""The page of ``jackettwin identify --report`` on many records: fused modes, tracked modes, groups."""

from __future__ import annotations

from pathlib import Path

from jackettwin.identification import FusedIdentification, FusedMode, convergence
from jackettwin.report.figures.subspace_mac import interval_history
from jackettwin.report.figures.tracks import MOST_POINTS, tracks
from jackettwin.report.pages.page import Block, PageSection, Plot, Text, write_page
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import UNKNOWN, count, fixed, frequency, interval, percent, words
from jackettwin.study.many_records.groups import RecordGroup
from jackettwin.study.many_records.summary import FusedBatch
from jackettwin.twin import Failed
from jackettwin.version import __version__

_SHOWN_FAILURES = 50


def build_many_page(together: FusedBatch, failed: tuple[Failed, ...], path: Path) -> Path:
    """Write one self-contained HTML file on fused records; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    fused = together.fused
    sections = [
        PageSection("Modes", tuple(_modes(fused)) if fused is not None else ()),
        PageSection("Groups", (_groups(together.groups),) if len(together.groups) > 1 else ()),
        PageSection("Warnings", (Text(together.warnings, "warnings"),) if together.warnings else ()),
        PageSection("Not identified", (_failures(failed),) if failed else ()),
    ]
    n = len(fused.records) if fused is not None else 0
    return write_page(
        [section for section in sections if section.blocks],
        path,
        title=f"Modes of {count(n, 'record')}",
        subtitle=f"{together.duration_s / 3600.0:.3g} h · jackettwin {__version__}",
    )


def _modes(fused: FusedIdentification) -> list[Block]:
    if not fused.modes:
        return [Text(("No mode was found in enough records.",))]
    named = [(f"mode_{i}", mode) for i, mode in enumerate(fused.modes, start=1)]
    followed = (
        "Every mode in every record with 90 % intervals; shaded: all records together. Scatter beyond the "
        "intervals is due to changes between records: wind, tide, temperature or operating state."
    )
    if len(fused.records) > MOST_POINTS:
        followed += " Dots are medians of neighbouring records, bars the range of nine in ten."
    shrinking = "Damping ratios with 90 % intervals as records are fused, in their order."
    histories = [(label, convergence(mode)) for label, mode in named if mode.uncertainty_known]
    return [
        _mode_table(named, len(fused.records)),
        Plot("tracks", followed, tracks(named, fused.records)),
        *([Plot("interval_history", shrinking, interval_history(histories))] if histories else []),
    ]


def _mode_table(named: list[tuple[str, FusedMode]], n_records: int) -> Table:
    rows = [
        (
            words(label),
            *_numbers(mode),
            fixed(100.0 * len(mode.sightings) / n_records, 0),
            *_scatter(mode),
            mode.status if mode.status_reason is None else f"{mode.status}: {mode.status_reason}",
        )
        for label, mode in named
    ]
    columns = (
        "mode",
        "f [Hz]",
        "90 % of f [Hz]",
        "ζ [%]",
        "90 % of ζ [%]",
        "found in\n[% of records]",
        "scatter of f\n[%]",
        "scatter of ζ\n[%]",
        "status",
    )
    caption = (
        "Modes fused over all records. Scatter is the standard "
        "deviation between records in excess of their uncertainty. The mean is taken over the records in "
        "which the mode is ok, if there are any. The status is the median over all records that contain the "
        "mode, unless a check across records objects."
    )
    return Table(caption, columns, tuple(rows))


def _groups(groups: tuple[RecordGroup, ...]) -> Table:
    rows = []
    for group in groups:
        where = (_range(group.wind_speed_m_s), _range(group.yaw_deg), group.state or UNKNOWN)
        rows += [
            (*where, str(len(group.records)), *_numbers(mode), mode.status) for mode in group.fused.modes
        ]
    columns = (
        "wind [m/s]",
        "yaw [°]",
        "state",
        "records",
        "f [Hz]",
        "90 % of f [Hz]",
        "ζ [%]",
        "90 % of ζ [%]",
        "status",
    )
    return Table(
        "The same by wind speed, yaw and operating state, if the records state these.",
        columns,
        tuple(rows),
        3,
    )


def _failures(failed: tuple[Failed, ...]) -> Table:
    rows = [(one.record, one.problem) for one in failed[:_SHOWN_FAILURES]]
    more = len(failed) - len(rows)
    caption = f"{count(len(failed), 'record')} could not be identified" + (
        f"; {more} more are in the JSON." if more else "."
    )
    return Table(caption, ("record", "problem"), tuple(rows), 2)


def _numbers(mode: FusedMode) -> tuple[str, ...]:
    if not mode.uncertainty_known:
        return fixed(mode.frequency_hz, 4), UNKNOWN, fixed(100.0 * mode.damping_ratio, 2), UNKNOWN
    return (
        frequency(mode.frequency_hz),
        interval(mode.frequency_interval_90, 1.0, 4),
        percent(mode.damping_ratio),
        interval(mode.damping_ratio_interval_90, 100.0, 2),
    )


def _scatter(mode: FusedMode) -> tuple[str, str]:
    if not mode.uncertainty_known:
        return UNKNOWN, UNKNOWN
    return fixed(100.0 * mode.scatter_frequency, 2), fixed(100.0 * mode.scatter_damping_ratio, 0)


def _range(low_high: tuple[float, float] | None) -> str:
    return UNKNOWN if low_high is None else f"{low_high[0]:g} to {low_high[1]:g}"
