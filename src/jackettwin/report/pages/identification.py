"""The page of ``jackettwin identify --report`` on one record, without structure or model."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from jackettwin.identification import Examination, Identification, modal_fit
from jackettwin.records import knows_yaw
from jackettwin.report.figures import measured_shapes as figures_measured, record as figures_record
from jackettwin.report.figures.components import shape_components
from jackettwin.report.pages.page import Block, PageSection, Plot, Text, write_page
from jackettwin.report.sections import records as section_records
from jackettwin.report.tables import records as tables
from jackettwin.version import __version__

PURE = 0.7
"""Smallest share of a shape's energy along one axis for the shape to be named after it."""


def build_identification_page(seen: Examination, path: Path) -> Path:
    """Write one self-contained HTML file on an observed record; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    found = seen.identification
    names = mode_names(seen)
    sections = [
        PageSection("Record", tuple(_record(seen, names))),
        PageSection("Modes", tuple(_modes(seen, names))),
        PageSection("Mode shapes", tuple(_shapes(found, names))),
        PageSection("Warnings", (Text(found.warnings, "warnings"),) if found.warnings else ()),
    ]
    return write_page(
        [section for section in sections if section.blocks],
        path,
        title=f"Modes of {', '.join(found.records)}",
        subtitle=f"{found.duration_s:.0f} s, {len(found.channels)} channels · jackettwin {__version__}",
    )


def mode_names(seen: Examination) -> tuple[str, ...]:
    """Return ``fore_aft_1``, ``side_side_1`` if the yaw is known and the shape is clear, else ``mode_1``."""
    found = seen.identification
    rotor = knows_yaw(seen.record) or seen.record.metadata.get("axes") == "rotor"
    along = np.array([c.direction for c in found.channels])
    count: Counter[str] = Counter()
    names = []
    for mode in found.modes:
        power = np.abs(mode.mode_shape) ** 2 @ along**2
        x, y = power[:2] / max(float(power.sum()), np.finfo(float).tiny)
        kind = "fore_aft" if rotor and x > PURE else "side_side" if rotor and y > PURE else "mode"
        count[kind] += 1
        names.append(f"{kind}_{count[kind]}")
    return tuple(names)


def _record(seen: Examination, names: tuple[str, ...]) -> list[Block]:
    found = seen.identification
    modes = list(zip(names, found.modes, strict=True))
    caption = (
        "Power spectral density of each channel by Welch's method, and singular values. Orange: singular "
        "values of the identified modes under white forces."
    )
    fit = modal_fit(seen.record, found)
    return [
        tables.quality_table(seen),
        Plot("time_series", f"{seen.record.name}: every channel.", figures_record.time_series(seen.record)),
        Plot("spectra", caption, figures_record.spectra(found.spectrum, found.channels, modes, fit)),
    ]


def _modes(seen: Examination, names: tuple[str, ...]) -> list[Block]:
    found = seen.identification
    blocks: list[Block] = [tables.identified_table(found, names)]
    if seen.comparison is not None:
        blocks.append(tables.method_table(seen.comparison, names))
    if len(found.stabilisation.order):
        blocks += section_records.diagrams(found, names)
    if found.rejected:
        blocks.append(tables.rejected_table(found))
    return blocks


def _shapes(found: Identification, names: tuple[str, ...]) -> list[Block]:
    if not found.modes:
        return []
    modes = list(zip(names, found.modes, strict=True))
    if any(channel.height_m is None for channel in found.channels):
        caption = (
            "Measured mode shapes by channel, at the instant of largest motion. The heights of the sensors "
            "are not known (height_m in the JSON beside the record), so that no structure is drawn."
        )
        return [Plot("measured_shapes", caption, shape_components(found.channels, modes))]
    caption = "Measured mode shapes: motion of every sensor along its direction, with its phase."
    return [Plot("measured_shapes", caption, figures_measured.measured_shapes_3d(found.channels, modes))]
