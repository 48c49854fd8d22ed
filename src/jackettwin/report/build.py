"""Put the report together: ``TwinResult`` in, ``report.html`` and its figures out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from jackettwin.identification import Identification, fuse
from jackettwin.identification.convergence import convergence
from jackettwin.report import (
    explore,
    figures_identification,
    figures_landscape,
    figures_likeness,
    figures_record,
    figures_structure,
    tables,
)
from jackettwin.report import figures_updating as compare
from jackettwin.report.figures_modes import Shape, mode_shapes_3d
from jackettwin.report.numbers import fixed, frequency, percent, words
from jackettwin.report.page import Block, Plot, Section, Table, Text, write_figures, write_page
from jackettwin.report.section_posterior import what_is_known, whose_damping
from jackettwin.report.summary import headline, shown_update
from jackettwin.twin import TwinResult
from jackettwin.twin.truth import true_modes, true_parameters
from jackettwin.updating import Update
from jackettwin.version import __version__


def build_report(result: TwinResult, out_dir: Path) -> Path:
    """Write ``report.html`` (self-contained) and ``figures/NAME.html``; return the path of the report.

    Raises
    ------
    OSError
        If the directory cannot be written.
    """
    sections = report_sections(result)
    write_figures(sections, out_dir / "figures")
    title = f"{result.name}: digital twin of {result.assembly.structure.name}"
    return write_page(sections, out_dir / "report.html", title=title, subtitle=_subtitle(result))


def build_gallery(sections: Sequence[Section], out_dir: Path, title: str) -> Path:
    """Write sections as ``gallery.html`` with its figures beside it; return the path of the page."""
    write_figures(sections, out_dir / "figures")
    return write_page(sections, out_dir / "gallery.html", title=title, subtitle=f"jackettwin {__version__}")


def report_sections(result: TwinResult) -> list[Section]:
    """Return the report's sections in the order an engineer reads them; empty ones are left out."""
    makers: tuple[tuple[str, Callable[[TwinResult], list[Block]]], ...] = (
        ("Summary", _summary),
        ("Structure", _structure),
        ("Record", _record),
        ("Identification", _identification),
        ("Identified against updated", _comparison),
        ("Against the known truth", _truth),
        ("What is known", what_is_known),
        ("Whose damping", whose_damping),
        ("Damped and undamped", _damped_undamped),
        ("Mode shapes", _mode_shapes),
        ("Solutions", _solutions),
        ("Sensitivity and root locus", _landscape),
        ("Damping no support explains", _excess),
        ("Assumptions and warnings", _assumptions),
        ("Provenance", _provenance),
    )
    sections = [Section(title, tuple(make(result))) for title, make in makers]
    return [section for section in sections if section.blocks]


def _subtitle(result: TwinResult) -> str:
    names = [name for found in result.identifications for name in found.records]
    source = (
        f"record {names[0]}" if len(names) == 1 else f"{len(names)} records" if names else "given targets"
    )
    return f"{source} · jackettwin {__version__}"


def _summary(result: TwinResult) -> list[Block]:
    blocks: list[Block] = [Text(headline(result)), tables.key_table(result)]
    if result.warnings:
        blocks.append(Text(result.warnings[:3], "warnings"))
    return blocks


def _truth(result: TwinResult) -> list[Block]:
    known, parameters = true_modes(result), true_parameters(result)
    blocks: list[Block] = [tables.truth_table(result, known)] if known else []
    return [*blocks, tables.true_parameters_table(parameters)] if parameters else blocks


def _structure(result: TwinResult) -> list[Block]:
    figure = figures_structure.structure_3d(result.assembly, result.sensors)
    caption = (
        "The structure, members coloured by the quantity chosen above. "
        "Drag to turn, scroll to zoom; axes are equal."
    )
    return [Plot("structure", caption, figure), tables.structure_table(result)]


def _record(result: TwinResult) -> list[Block]:
    if result.record is None:
        return []
    caption = (
        f"{result.record.name}: every channel. Blue along x (fore-aft), vermillion along y (side-side). "
        "Long channels are drawn as the extremes of each bin."
    )
    blocks: list[Block] = [Plot("time_series", caption, figures_record.time_series(result.record))]
    if result.identifications:
        found = result.identifications[0]
        modes = list(zip(result.names[0], found.modes, strict=True))
        caption = (
            "Power spectral density (PSD) of each channel by Welch's method, and singular values of the "
            "spectral matrix of the channels scaled to unit variance, largest darkest. "
            "Dashed lines: identified modes."
        )
        blocks.insert(0, tables.quality_table(result.observations[0]))
        blocks.append(Plot("spectra", caption, figures_record.spectra(found.spectrum, found.channels, modes)))
    return blocks


def _identification(result: TwinResult) -> list[Block]:
    blocks: list[Block] = []
    for i, (found, names) in enumerate(zip(result.identifications, result.names, strict=True)):
        if i == 0:
            blocks += [*_diagrams(found, names), tables.records_table(result)]
        blocks.append(tables.identified_table(found, names, folded=i > 0))
    if result.identifications:
        first = result.identifications[0]
        if first.rejected:
            blocks.append(tables.rejected_table(first))
        blocks += _history(result)
        blocks.append(tables.pairing_table(result.measured, result.unpaired))
    return blocks


def _diagrams(found: Identification, names: tuple[str, ...]) -> list[Block]:
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
            "Stabilisation in damping: the same poles against their damping ratio.",
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
        "Mode shapes in the complex plane, one needle a sensor. The needles of a real mode lie on a line; "
        "a fan is mostly a close pair that one record does not separate."
    )
    return [
        Plot("mac", caption, figures_likeness.mac_matrix(found, names)),
        Plot("complexity", needles, figures_likeness.complexity(found, names)),
    ]


def _history(result: TwinResult) -> list[Block]:
    """Return how intervals shrink with records, for the modes the model knows."""
    if len(result.identifications) < 2:
        return []
    histories = []
    for mode in fuse(result.identifications).modes:
        seen = [
            result.names[r][result.identifications[r].modes.index(member)]
            for r, member in zip(mode.records, mode.members, strict=True)
        ]
        label = max(set(seen), key=seen.count)
        if label:
            histories.append((label, convergence(result.identifications, mode)))
    if not histories:
        return []
    caption = "Damping ratios with 95 % intervals as records are fused, in their order."
    return [Plot("interval_history", caption, figures_likeness.interval_history(histories))]


def _comparison(result: TwinResult) -> list[Block]:
    if not result.updates:
        return []
    f, zeta = compare.frequency_errors, compare.damping_comparison
    return [
        Plot(
            "frequencies",
            "Updated frequencies relative to the measured ones, whose 95 % intervals are the bars.",
            f(result.measured, result.updates),
        ),
        Plot(
            "damping",
            "Measured damping ratios with 95 % intervals, and those of each updated law.",
            zeta(result.measured, result.updates),
        ),
        tables.parameter_table(result.updates),
    ]


def _damped_undamped(result: TwinResult) -> list[Block]:
    if not result.updates:
        return []
    text = (
        "A dashpot that is too strong to move acts as a spring: the damped frequencies fit while the "
        "structure without damping is wrong. Differences beyond 5 % are flagged as locked dampers."
    )
    caption = "Difference of undamped from damped frequencies."
    figure = compare.damped_undamped(result.measured, result.updates)
    return [Text((text,)), tables.damped_undamped_table(result), Plot("damped_undamped", caption, figure)]


def _mode_shapes(result: TwinResult) -> list[Block]:
    if not result.updates:
        return []
    u = shown_update(result)
    shapes = _shapes(result, u)
    caption = (
        f"Mode shapes of the full model updated with {u.law}. Coloured: damped, moving; dotted: undamped at "
        "its largest; pale: at rest. Arrows: the measured shape at the sensors, scaled to the model's."
    )
    return [Plot("mode_shapes", caption, mode_shapes_3d(result.assembly, shapes, result.sensors))]


def _shapes(result: TwinResult, u: Update) -> list[Shape]:
    undamped = explore.undamped_shapes(u)
    order = {
        channel.name: i for found in result.identifications[:1] for i, channel in enumerate(found.channels)
    }
    rows = [order.get(sensor.channel, -1) for sensor in result.sensors]
    shapes = []
    for i, m in enumerate(result.measured):
        f, zeta = float(u.modes.frequency_hz[i]), float(u.modes.damping_ratio[i])
        text = f"<b>{words(m.label)}</b><br>{frequency(f)} Hz<br>ζ {percent(zeta)} %"
        seen = m.estimate.mode_shape[rows] if m.estimate is not None and rows and min(rows) >= 0 else None
        shapes.append(Shape(text, m.label, u.modes.shapes[:, i], undamped[:, i], seen))
    return shapes


def _solutions(result: TwinResult) -> list[Block]:
    said = tuple(f"{u.law}: {u.search.statement}" for u in result.updates)
    return [Text(said), *(tables.solutions_table(result, u) for u in result.updates)]


def _landscape(result: TwinResult) -> list[Block]:
    if not result.updates:
        return []
    curves = [c for u in result.updates for c in explore.sensitivities(u.problem, u.best.theta)]
    caption = "Cost as one parameter moves by ±50 % about the solution, the others held."
    blocks: list[Block] = [Plot("sensitivity", caption, figures_landscape.sensitivity(curves))]
    blocks += [
        _surface(u) for u in result.updates if u.law == "kelvin-voigt" and len(u.model.parameters) == 2
    ]
    labels = tuple(m.label for m in result.measured)
    for u in result.updates:
        path = explore.locus(u.model, u.best.theta, u.residuals.modes, labels)
        caption = (
            f"{u.law}: poles of each mode as {path.parameter} of every support goes from bound to bound."
        )
        blocks.append(Plot(f"root_locus_{u.law}", caption, figures_landscape.root_locus(path)))
    return blocks


def _surface(u: Update) -> Plot:
    x, y, cost = explore.surface(u)
    (px, py), parameters = u.best.theta, u.model.parameters
    figure = figures_landscape.cost_surface(
        x,
        y,
        cost,
        names=(parameters[0].name, parameters[1].name),
        units=(parameters[0].unit, parameters[1].unit),
        points=[("solution", float(px), float(py))],
    )
    return Plot(f"cost_surface_{u.law}", f"{u.law}: the cost over the whole bounds.", figure)


def _excess(result: TwinResult) -> list[Block]:
    if not any(result.excess):
        return []
    u = shown_update(result)
    rows = result.excess[result.updates.index(u)]
    text = (
        "These modes' damping took no part in the fit. What exceeds steel and support has another source: "
        "for side-side modes of a parked rotor, above all its aerodynamics. It is reported, not forced into "
        "the soil."
    )
    caption = f"Measured damping beside what steel and the updated support ({u.law}) give."
    return [
        Text((text,)),
        Plot("damping_excess", caption, compare.damping_excess(u.law, rows)),
        tables.excess_table(result),
    ]


def _assumptions(result: TwinResult) -> list[Block]:
    blocks: list[Block] = [Text(result.assumptions, "list")] if result.assumptions else []
    return [*blocks, Text(result.warnings, "warnings")] if result.warnings else blocks


def _provenance(result: TwinResult) -> list[Block]:
    rows = [("jackettwin", __version__), ("twin", result.name), ("structure", result.assembly.structure.name)]
    rows.append(("degrees of freedom", str(result.assembly.n_dof)))
    for found in result.identifications:
        s = found.settings
        rows.append(("record", ", ".join(found.records)))
        rows.append(("channels", ", ".join(c.name for c in found.channels)))
        rows.append(("band", f"{fixed(s.lowest_frequency_hz, 3)} to {fixed(s.highest_frequency_hz, 3)} Hz"))
        rows.append(("decimated to", f"{s.sample_rate_hz:.4g} Hz"))
        rows.append(("lag window", f"{s.lag_window_s:.3g} s, {s.block_rows} block rows"))
        rows.append(("model orders", f"{s.orders[0]} to {s.orders[-1]}, {len(s.orders)} of them"))
    if result.record is not None:
        rows += [(key.replace("_", " "), str(value)) for key, value in result.record.conditions.items()]
    return [Table("Where the numbers come from.", ("what", "value"), tuple(rows), 2)]
