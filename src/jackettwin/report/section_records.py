"""The report's sections on records and the modes identified in them."""

from __future__ import annotations

from jackettwin.identification import FusedMode, Identification, fuse
from jackettwin.identification.many_records.convergence import convergence
from jackettwin.identification.maximum_likelihood.spectral_fit import modal_fit
from jackettwin.report import figures_identification, figures_record, figures_subspace_mac
from jackettwin.report import tables_records as tables
from jackettwin.report.page import Block, Plot
from jackettwin.twin import TwinResult


def the_record(result: TwinResult) -> list[Block]:
    """Return the quality, the channels and the spectra of the first record."""
    if result.shown is None or result.record is None:
        return []
    caption = (
        f"{result.record.name}: every channel. Blue along x (fore-aft), vermillion along y (side-side). "
        "Long channels are drawn as the extremes of each bin."
    )
    blocks: list[Block] = [Plot("time_series", caption, figures_record.time_series(result.record))]
    found = result.shown.identification
    modes = list(zip(result.names[0], found.modes, strict=True))
    caption = (
        "Power spectral density (PSD) of each channel by Welch's method, and singular values of the "
        "spectral matrix of the channels scaled to unit variance, largest darkest. "
        "Orange: the first two that the identified modes alone would have under white forces."
    )
    fit = modal_fit(result.record, found)
    spectra = figures_record.spectra(found.spectrum, found.channels, modes, fit)
    return [tables.quality_table(result.shown), *blocks, Plot("spectra", caption, spectra)]


def what_was_identified(result: TwinResult) -> list[Block]:
    """Return diagrams of the first record, the modes of every record, and which mode is which."""
    blocks: list[Block] = []
    for i, (found, names) in enumerate(zip(result.identifications, result.names, strict=True)):
        if i == 0:
            blocks += [*diagrams(found, names), tables.records_table(result)]
        blocks.append(tables.identified_table(found, names, folded=i > 0))
    if result.shown is not None:
        first = result.shown.identification
        compared = result.shown.comparison
        if compared is not None:
            blocks.append(tables.method_table(compared, result.names[0]))
        if first.rejected:
            blocks.append(tables.rejected_table(first))
        blocks += _history(result)
        blocks.append(tables.pairing_table(result))
    return blocks


def diagrams(found: Identification, names: tuple[str, ...]) -> list[Block]:
    """Return the stabilisation diagrams of a record, its modes' intervals and subspace MACs."""
    s = found.settings
    modes = list(zip(names, found.modes, strict=True))
    caption = (
        f"{found.records[0]}, stabilisation in frequency: poles of every model order, "
        f"{s.orders[0]} to {s.orders[-1]}; lines are the modes kept, shaded bands their 95 % intervals "
        "where known."
    )
    blocks: list[Block] = [
        Plot("stabilisation_frequency", caption, figures_identification.stabilisation(found, names)),
        Plot(
            "stabilisation_damping",
            "Stabilisation in damping: the same poles against their damping ratio; above them the modes kept "
            "with their 95 % intervals.",
            figures_identification.stabilisation_damping(found, names),
        ),
        Plot(
            "damping_frequency",
            "Damping against frequency of all poles, the modes kept on top.",
            figures_identification.damping_against_frequency(found, names),
        ),
    ]
    if any(figures_identification.damping_interval(mode) for _, mode in modes):
        caption = "Identified modes with their 95 % intervals."
        blocks.append(Plot("intervals", caption, figures_identification.intervals(modes)))
    if modes:
        blocks += _likeness(found, names)
    return blocks


def _likeness(found: Identification, names: tuple[str, ...]) -> list[Block]:
    caption = (
        "MAC between the identified modes. Off the diagonal, above about 0.2: shapes that the sensors hardly "
        "tell apart, or a pair whose shapes one record leaves mixed."
    )
    needles = (
        "Mode shapes in the complex plane as the subspace method found them (of the likelihood only "
        "real parts are kept), one needle a sensor. The needles of a real mode lie on a line; a fan is "
        "mostly a close pair that one record does not separate."
    )
    return [
        Plot("mac", caption, figures_subspace_mac.mac_matrix(found, names)),
        Plot("complexity", needles, figures_subspace_mac.complexity(found, names)),
    ]


def _history(result: TwinResult) -> list[Block]:
    """Return how intervals shrink with records, for the modes the model knows."""
    if len(result.identifications) < 2:
        return []
    tracks: dict[str, FusedMode] = {}
    for mode in sorted(fuse(result.identifications).modes, key=lambda mode: len(mode.sightings.record)):
        seen = [result.names[r][m] for r, m in zip(mode.sightings.record, mode.sightings.mode, strict=True)]
        tracks[max(set(seen), key=seen.count)] = mode  # the track with the most sightings is drawn
    histories = [(m.label, convergence(tracks[m.label])) for m in result.measured if m.label in tracks]
    if not histories:
        return []
    caption = "Damping ratios with 95 % intervals as records are fused, in their order."
    return [Plot("interval_history", caption, figures_subspace_mac.interval_history(histories))]
