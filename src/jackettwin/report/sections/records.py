"""The report's sections on records and the modes identified in them."""

from __future__ import annotations

from jackettwin.identification import FusedMode, Identification, convergence, fuse, modal_fit
from jackettwin.report.figures import (
    identification as figures_identification,
    record as figures_record,
    subspace_mac as figures_subspace_mac,
)
from jackettwin.report.pages.page import Block, Plot
from jackettwin.report.tables import records as tables
from jackettwin.study import TwinResult


def the_records(result: TwinResult) -> list[Block]:
    """Return quality and spectra of the first record, and the assignment of modes in every record."""
    if result.shown is None or result.record is None:
        return []
    found = result.shown.identification
    modes = list(zip(result.names[0], found.modes, strict=True))
    caption = (
        f"{result.record.name}: what is a mode, what is noise? Power spectral density of each channel "
        "(Welch), and singular values. Orange: spectrum of the identified modes only."
    )
    fit = modal_fit(result.record, found)
    return [
        tables.quality_table(result.shown),
        tables.records_table(result),
        Plot("spectra", caption, figures_record.spectra(found.spectrum, found.channels, modes, fit)),
    ]


def further_records(result: TwinResult) -> list[Block]:
    """Return the diagrams of the first record, the modes of every record, and rejected candidates."""
    if result.shown is None or result.record is None:
        return []
    first, names = result.shown.identification, result.names[0]
    blocks: list[Block] = [
        tables.identified_table(found, labels, folded=i > 0)
        for i, (found, labels) in enumerate(zip(result.identifications, result.names, strict=True))
    ]
    blocks.append(tables.pairing_table(result))
    compared = result.shown.comparison
    if compared is not None:
        blocks.append(tables.method_table(compared, names))
    if first.rejected:
        blocks.append(tables.rejected_table(first))
    caption = (
        f"{result.record.name}: what did the channels measure? Blue: along x, vermilion: along y; extremes "
        "of each bin are drawn."
    )
    series = Plot("time_series", caption, figures_record.time_series(result.record), big=True)
    return [*blocks, *diagrams(first, names), *_history(result), series]


def diagrams(found: Identification, names: tuple[str, ...]) -> list[Block]:
    """Return the stabilisation diagrams of a record, its modes' intervals and subspace MACs."""
    s = found.settings
    modes = list(zip(names, found.modes, strict=True))
    caption = (
        f"{found.records[0]}: which poles are stable? Stabilisation diagram: poles of model orders "
        f"{s.orders[0]} to {s.orders[-1]}; lines are the accepted modes, shaded bands their 90 % intervals "
        "where known."
    )
    blocks: list[Block] = [
        Plot(
            "stabilisation_frequency",
            caption,
            figures_identification.stabilisation(found, names),
            picks_of=found.records[0],
        ),
        Plot(
            "stabilisation_damping",
            "Is their damping stable? The same poles over their damping ratio; above them the accepted "
            "modes with their 90 % intervals.",
            figures_identification.stabilisation_damping(found, names),
        ),
        Plot(
            "damping_frequency",
            "Do poles form clusters? Damping over frequency of all poles, with the accepted modes on top.",
            figures_identification.damping_against_frequency(found, names),
        ),
    ]
    if any(figures_identification.damping_interval(mode) for _, mode in modes):
        caption = "How well is each mode known from this record? 90 % intervals."
        blocks.append(Plot("intervals", caption, figures_identification.intervals(modes)))
    if modes:
        blocks += _shape_figures(found, names)
    return blocks


def _shape_figures(found: Identification, names: tuple[str, ...]) -> list[Block]:
    caption = (
        "Do the sensors distinguish the modes? MAC between identified modes. Values above about 0.2 off the "
        "diagonal are shapes that the sensors hardly distinguish, or a pair that one record does not "
        "separate."
    )
    needles = (
        "Are the shapes real? Shapes of the subspace method in the complex plane, one line per sensor. The "
        "lines of a real mode are collinear; a fan is usually a close pair that one record does not "
        "separate."
    )
    return [
        Plot("mac", caption, figures_subspace_mac.mac_matrix(found, names)),
        Plot("complexity", needles, figures_subspace_mac.complexity(found, names)),
    ]


def _history(result: TwinResult) -> list[Block]:
    """Return the decrease of intervals with the number of records, for modes of the model."""
    if len(result.identifications) < 2:
        return []
    tracks: dict[str, FusedMode] = {}
    for mode in sorted(fuse(result.identifications).modes, key=lambda mode: len(mode.sightings.record)):
        seen = [result.names[r][m] for r, m in zip(mode.sightings.record, mode.sightings.mode, strict=True)]
        tracks[max(set(seen), key=seen.count)] = mode  # the track with the most sightings is drawn
    histories = [(m.label, convergence(tracks[m.label])) for m in result.measured if m.label in tracks]
    if not histories:
        return []
    caption = "Do more records help? Damping ratios with 90 % intervals as records are fused, in their order."
    return [Plot("interval_history", caption, figures_subspace_mac.interval_history(histories))]
