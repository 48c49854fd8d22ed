"""The report's tables: every number comes from the result, none is computed here but differences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jackettwin.identification import Identification, ModalEstimate
from jackettwin.report.figures_identification import damping_interval, frequency_interval
from jackettwin.report.figures_record import plain
from jackettwin.report.numbers import (
    UNKNOWN,
    count,
    fixed,
    frequency,
    interval,
    known,
    percent,
    scientific,
    words,
)
from jackettwin.report.page import Table
from jackettwin.twin import Observation, TwinResult
from jackettwin.twin.result import MeasuredMode
from jackettwin.twin.truth import TrueMode, TrueParameter
from jackettwin.updating import Update


def key_table(result: TwinResult) -> Table:
    """Return measured against updated, one row a mode."""
    columns = ["mode", "no.", "measured\nf [Hz]", *(f"{u.law}\nf [Hz]" for u in result.updates)]
    columns += ["measured\nζ [%]", *(f"{u.law}\nζ [%]" for u in result.updates)]
    rows = []
    for i, m in enumerate(result.measured):
        row = [words(m.label), str(m.mode), frequency(m.frequency_hz, m.frequency_std_hz)]
        row += [_mark(frequency(float(u.modes.frequency_hz[i])), m.fits_frequency) for u in result.updates]
        row += [percent(m.damping_ratio, m.damping_ratio_std)]
        row += [_mark(percent(float(u.modes.damping_ratio[i])), m.fits_damping) for u in result.updates]
        rows.append(tuple(row))
    caption = (
        "Measured and updated modes. ± is one standard deviation; values in brackets took no part in the fit."
    )
    return Table(caption, tuple(columns), tuple(rows), text_columns=1)


def _mark(text: str, fitted: bool) -> str:
    return text if fitted or text == UNKNOWN else f"({text})"


def truth_table(result: TwinResult, stated: tuple[TrueMode, ...]) -> Table:
    """Return the true modes that the records state beside the measured and the updated ones."""
    columns = ["mode", "true\nf [Hz]", "measured\nf [Hz]", *(f"{u.law}\nf [Hz]" for u in result.updates)]
    columns += ["true\nζ [%]", "measured\nζ [%]", *(f"{u.law}\nζ [%]" for u in result.updates)]
    place = {m.label: i for i, m in enumerate(result.measured)}
    rows = []
    for true in stated:
        i = place[true.label]
        m = result.measured[i]
        row = [words(true.label), frequency(true.frequency_hz), frequency(m.frequency_hz, m.frequency_std_hz)]
        row += [frequency(float(u.modes.frequency_hz[i])) for u in result.updates]
        row += [percent(true.damping_ratio), percent(m.damping_ratio, m.damping_ratio_std)]
        row += [percent(float(u.modes.damping_ratio[i])) for u in result.updates]
        rows.append(tuple(row))
    caption = "What is known to be true of these records, the mean over them, beside what was found."
    return Table(caption, tuple(columns), tuple(rows), text_columns=1)


def true_parameters_table(parameters: tuple[TrueParameter, ...]) -> Table:
    """Return the true parameters of the support beside the updated ones."""
    rows = [
        (
            p.law,
            p.name,
            f"{p.true:.4g}",
            f"{p.value:.4g}",
            UNKNOWN if p.interval_90 is None else f"{p.interval_90[0]:.4g} – {p.interval_90[1]:.4g}",
            UNKNOWN if p.covered is None else "yes" if p.covered else "no",
        )
        for p in parameters
    ]
    columns = ("law", "parameter", "true", "updated", "90 % interval", "inside")
    return Table("True parameters of the support, SI units.", columns, tuple(rows), text_columns=2)


def structure_table(result: TwinResult) -> Table:
    """Return what the structure is made of, part by part."""
    mesh, structure = result.assembly.mesh, result.assembly.structure
    p = mesh.properties
    rows: list[tuple[str, ...]] = []
    for part in dict.fromkeys(member.part for member in structure.members):
        chosen = [structure.members[m].part == part for m in mesh.member]
        mass = float((p.rho * p.A * p.L)[chosen].sum())
        members = [m for m in structure.members if m.part == part]
        walls = [1e3 * s.thickness_m for m in members for s in (m.section_start, m.section_end)]
        diameters = [s.outer_diameter_m for m in members for s in (m.section_start, m.section_end)]
        rows.append(
            (
                part.replace("_", " ") or "structure",
                str(len(members)),
                fixed(mass / 1e3, 1),
                _range(diameters, 2),
                _range(walls, 1),
                _range([float(v) / 1e9 for v in p.E[chosen]], 0),
                _range([float(v) for v in p.rho[chosen]], 0),
            )
        )
    for body in structure.masses:
        name = "rotor–nacelle assembly" if body.part == "rna" else f"mass at {body.node}"
        rows.append((name, UNKNOWN, fixed(body.mass_kg / 1e3, 1), *[UNKNOWN] * 4))
    columns = ("part", "members", "mass [t]", "diameter [m]", "wall [mm]", "E [GPa]", "density [kg/m³]")
    return Table("What the structure is made of.", columns, tuple(rows))


def _range(values: list[float], decimals: int) -> str:
    low, high = fixed(min(values), decimals), fixed(max(values), decimals)
    return low if low == high else f"{low} … {high}"


def quality_table(seen: Observation) -> Table:
    """Return how good each channel of a record is."""
    channels = {channel.name: channel for channel in seen.record.channels}
    rows = []
    for q in seen.quality.channels:
        findings = [f.text for f in seen.quality.findings if f.channel == q.name]
        rms, unit = UNKNOWN, ""
        if q.name in channels:
            unit = plain(channels[q.name].unit)
            y = seen.record.data[seen.record.channel_names.index(q.name)]
            rms = scientific(float(np.nanstd(y))) if np.isfinite(y).any() else UNKNOWN
        lost = [fixed(100.0 * share, 2) for share in (q.gap_share, q.spike_share, q.clipped_share)]
        rows.append((q.name, "; ".join(findings) or "no fault found", unit, fixed(q.score, 2), rms, *lost))
    columns = (
        "channel",
        "findings",
        "unit",
        "score [-]",
        "std [unit]",
        "missing [%]",
        "spikes [%]",
        "clipped [%]",
    )
    return Table(f"{seen.record.name}: quality of every channel.", columns, tuple(rows), 3)


def identified_table(found: Identification, names: Sequence[str], *, folded: bool = False) -> Table:
    """Return the identified modes of a record with their 95 % intervals."""
    rows = [
        (
            words(name) if name else "not in the model",
            frequency(m.frequency_hz, m.frequency_std_hz),
            interval(frequency_interval(m), 1.0, 4),
            percent(m.damping_ratio, m.damping_ratio_std),
            interval(damping_interval(m), 100.0, 2),
            "–" if m.unrefined is None else percent(m.unrefined.damping_ratio, m.unrefined.damping_ratio_std),
            fixed(100.0 * m.damping_ratio_cov_limit, 0) if m.damping_ratio_cov_limit is not None else "–",
            fixed(100.0 * m.cramer_rao_log_std[1], 0) if m.cramer_rao_log_std is not None else "–",
            fixed(m.mpc, 2),
            fixed(100.0 * m.order_share, 0),
            m.method,
        )
        for name, m in zip(names, found.modes, strict=True)
    ]
    columns = (
        "mode",
        "f [Hz]",
        "95 % of f [Hz]",
        "ζ [%]",
        "95 % of ζ [%]",
        "ζ by SSI [%]",
        "least ± of ζ: long-data law [% of ζ]",
        "Cramér-Rao [% of ζ]",
        "MPC [-]",
        "orders [%]",
        "method",
    )
    return Table(f"Modes identified in {', '.join(found.records)}.", columns, tuple(rows), folded=folded)


def records_table(result: TwinResult) -> Table:
    """Return every named mode in every record: which is which, and how far the records agree."""
    found = [
        dict(zip(names, seen.modes, strict=True))
        for names, seen in zip(result.names, result.identifications, strict=True)
    ]
    rows = [
        (
            words(m.label),
            *(
                f"{frequency(mode.frequency_hz)} / {percent(mode.damping_ratio)}" if mode else UNKNOWN
                for mode in (modes.get(m.label) for modes in found)
            ),
        )
        for m in result.measured
    ]
    records = [name for seen in result.identifications for name in seen.records]
    caption = "Which mode is which in every record: f [Hz] / ζ [%]; a dash where it was not found."
    return Table(caption, ("mode", *records), tuple(rows))


def rejected_table(found: Identification) -> Table:
    """Return the candidates that were not accepted, each with its reason."""
    rows = [(r.reason, frequency(r.frequency_hz), percent(r.damping_ratio)) for r in found.rejected]
    caption = f"{count(len(rows), 'candidate').capitalize()} not accepted as a mode, with the reasons"
    return Table(caption, ("reason", "f [Hz]", "ζ [%]"), tuple(rows), folded=True)


def pairing_table(measured: Sequence[MeasuredMode], unpaired: Sequence[ModalEstimate]) -> Table:
    """Return which identified mode is which of the model."""
    rows = [
        (
            words(m.label),
            str(m.mode),
            frequency(m.frequency_hz),
            fixed(m.mac, 3),
            "yes" if m.fits_frequency else "no",
            "yes" if m.fits_damping else "no",
        )
        for m in measured
    ]
    rows += [
        ("no counterpart in the model", UNKNOWN, frequency(e.frequency_hz), UNKNOWN, "no", "no")
        for e in unpaired
    ]
    columns = ("mode of the model", "no.", "identified f [Hz]", "likeness [-]", "f fitted", "ζ fitted")
    return Table(
        "Which identified mode is which: the modal assurance criterion at the sensors; for modes closer than "
        "6 % in frequency, whose measured shapes mix, the share of the shape in the plane of the pair.",
        columns,
        tuple(rows),
    )


def damped_undamped_table(result: TwinResult) -> Table:
    """Return damped and undamped frequencies side by side, law by law."""
    rows: list[tuple[str, ...]] = []
    marked = set()
    for u in result.updates:
        for m, f, f0 in zip(result.measured, u.modes.frequency_hz, u.modes.undamped_hz, strict=True):
            if u.best.locked_damper:
                marked.add(len(rows))
            flag = "locked damper" if u.best.locked_damper else "no"
            apart = fixed(100.0 * (float(f0) / float(f) - 1.0), 2, sign=True) if known(float(f)) else UNKNOWN
            rows.append((u.law, words(m.label), frequency(float(f)), frequency(float(f0)), apart, flag))
    columns = ("law", "mode", "damped f [Hz]", "undamped f [Hz]", "difference [%]", "locked")
    return Table(
        "Damped and undamped frequencies of the full updated model.",
        columns,
        tuple(rows),
        2,
        frozenset(marked),
    )


def parameter_table(updates: Sequence[Update]) -> Table:
    """Return the updated support parameters."""
    rows = []
    for u in updates:
        known = u.uncertainty
        for i, (p, value) in enumerate(zip(u.problem.parameters, u.best.theta, strict=True)):
            span, verdict = UNKNOWN, UNKNOWN
            if known is not None:
                low, high = known.interval_90[i]
                span, verdict = f"{scientific(low)} … {scientific(high)}", known.verdicts[i].verdict
            text = f"{verdict}{', on its bound' if p.name in u.best.at_bound else ''}"
            rows.append((u.law, p.name, p.unit, text, scientific(float(value)), span))
    columns = ("law", "parameter", "unit", "verdict", "value", "90 % interval")
    return Table(
        "Updated supports. The verdict compares what the data say with the width of the bounds.",
        columns,
        tuple(rows),
        4,
    )


def solutions_table(result: TwinResult, u: Update) -> Table:
    """Return every distinct solution of a law, with the modes that took part in the fit."""
    fitted = [m for m in result.measured if m.fits_frequency or m.fits_damping]
    chosen = [m in fitted for m in result.measured]
    columns = ("solution", "parameters", "cost [-]", "", *(words(m.label) for m in fitted))
    rows, marked = [], set()
    for i, s in enumerate(u.solutions):
        if s.locked_damper:
            marked.add(i)
        notes = [f"{i + 1}: {count(s.found, 'start')}"] + ["reported"] * (s is u.best)
        notes += ["locked damper"] * s.locked_damper
        values = [
            f"{p.name} {scientific(float(v))}{_unit(p.unit)}{' *' if p.name in s.at_bound else ''}"
            for p, v in zip(u.problem.parameters, s.theta, strict=True)
        ]
        modes = zip(s.frequency_hz[chosen], s.undamped_hz[chosen], s.damping_ratio[chosen], strict=True)
        cells = [f"{frequency(float(f))}\n{frequency(float(f0))}\n{percent(float(z))}" for f, f0, z in modes]
        head = ("\n".join(notes), "\n".join(values), scientific(s.cost))
        rows.append((*head, "f [Hz]\nundamped f [Hz]\nζ [%]", *cells))
    caption = (
        f"{u.law}: every distinct solution of the search, cheapest first, and how many starts ended there; "
        "* on a bound."
    )
    return Table(caption, columns, tuple(rows), 2, frozenset(marked))


def _unit(unit: str) -> str:
    return "" if unit == "-" else f" {unit}"


def excess_table(result: TwinResult) -> Table:
    """Return the damping that the updated supports do not explain."""
    rows = []
    for u, excess in zip(result.updates, result.excess, strict=True):
        for e in excess:
            verdict = "within two standard deviations" if e.explained else "not explained"
            rows.append(
                (
                    u.law,
                    words(e.label),
                    verdict,
                    percent(e.measured, e.measured_std),
                    percent(e.model),
                    percent(e.measured - e.model),
                )
            )
    columns = ("law", "mode", "verdict", "measured ζ [%]", "model ζ [%]", "excess [%]")
    return Table("Damping left out of the fit, beside what steel and support give.", columns, tuple(rows), 3)
