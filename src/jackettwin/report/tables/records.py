"""Tables of records and of the modes identified in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jackettwin.identification import Comparison, Examination, Identification, ModalEstimate
from jackettwin.report.figures.identification import damping_interval, frequency_interval
from jackettwin.report.figures.record import plain
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import (
    UNKNOWN,
    count,
    fixed,
    frequency,
    interval,
    percent,
    scientific,
    words,
)
from jackettwin.study import TwinResult
from jackettwin.study.result import unpaired_finding


def quality_table(seen: Examination) -> Table:
    """Return the quality of each channel of a record."""
    channels = {channel.name: channel for channel in seen.record.channels}
    rows = []
    for q in seen.quality.channels:
        findings = [f.text for f in seen.quality.findings if f.subject == q.name]
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
    whole = "".join(f" {f.text[0].upper()}{f.text[1:]}." for f in seen.quality.findings if f.subject is None)
    return Table(f"{seen.record.name}: quality of every channel.{whole}", columns, tuple(rows), 3)


def method_table(compared: Comparison, names: Sequence[str]) -> Table:
    """Return f and ζ of each mode by every method side by side."""

    def said(mode: ModalEstimate | None) -> str:
        if mode is None:
            return UNKNOWN
        return f"{frequency(mode.frequency_hz)} / {percent(mode.damping_ratio, mode.damping_ratio_std)}"

    rows = [
        (
            words(name) if name else f"{frequency(mode.frequency_hz)} Hz",
            said(mode),
            *(said(found[i]) for found in compared.modes.values()),
        )
        for i, (name, mode) in enumerate(zip(names, compared.reference.modes, strict=True))
    ]
    caption = (
        f"f [Hz] / ζ [%] of {', '.join(compared.reference.records)} by every method in the same band, "
        "without refinement. ±: 90 % of ζ, if the method gives it. Dash: not found. EFDD "
        "finds one mode of a close pair and overestimates light damping."
    )
    caption += "".join(
        f" {_method_title(method)} not applied: {why}." for method, why in compared.refused.items()
    )
    columns = ("mode", "reported", *(_method_title(method) for method in compared.modes))
    return Table(caption, columns, tuple(rows))


def _method_title(method: str) -> str:
    """Return the printed name of a method; methods of installed packages have their own names."""
    return {
        "ssi-cov": "SSI-cov",
        "ssi-dat": "SSI-dat",
        "plscf": "pLSCF",
        "efdd": "EFDD",
        "bayoma": "BAYOMA",
    }.get(method, method)


def identified_table(found: Identification, names: Sequence[str], *, folded: bool = False) -> Table:
    """Return the identified modes of a record with their 90 % intervals."""
    rows = [
        (
            words(name) if name else "not in the model",
            m.status.value if m.status_reason is None else f"{m.status.value}: {m.status_reason}",
            f"{frequency(m.frequency_hz)}\n{interval(frequency_interval(m), 1.0, 4)}",
            f"{percent(m.damping_ratio)}\n{interval(damping_interval(m), 100.0, 2)}",
            "–" if m.unrefined is None else percent(m.unrefined.damping_ratio, m.unrefined.damping_ratio_std),
            _limits(m),
            fixed(m.mpc, 2),
            fixed(100.0 * m.order_share, 0),
            m.method,
        )
        for name, m in zip(names, found.modes, strict=True)
    ]
    columns = (
        "mode",
        "status",
        "f [Hz]\n90 % interval",
        "ζ [%]\n90 % interval",
        "ζ by SSI\n[%]",
        "least std\n[% of ζ]",
        "MPC\n[-]",
        "orders\n[%]",
        "method",
    )
    caption = f"Modes identified in {', '.join(found.records)}. ± is half the 90 % interval."
    if not folded:
        caption += (
            " Least std: smallest attainable standard deviation for this length of record, by the long-data "
            "law √(1/2πζfT) and by the Cramér-Rao bound of the fitted spectrum."
        )
    return Table(caption, columns, tuple(rows), 2, folded=folded)


def _limits(m: ModalEstimate) -> str:
    bounds = (
        m.damping_ratio_cov_limit,
        m.cramer_rao_log_std[1] if m.cramer_rao_log_std is not None else None,
    )
    return " / ".join(UNKNOWN if bound is None else fixed(100.0 * bound, 0) for bound in bounds)


def records_table(result: TwinResult) -> Table:
    """Return the named modes in all records, and how far the records agree."""
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
    caption = "The modes in every record: f [Hz] / ζ [%]; a dash where a mode was not found."
    return Table(caption, ("mode", *records), tuple(rows))


def rejected_table(found: Identification) -> Table:
    """Return the candidates that were not accepted, each with its reason."""
    rows = [(r.reason, frequency(r.frequency_hz), percent(r.damping_ratio)) for r in found.rejected]
    caption = f"{count(len(rows), 'candidate').capitalize()} not accepted as a mode, with the reasons"
    return Table(caption, ("reason", "f [Hz]", "ζ [%]"), tuple(rows), folded=True)


def pairing_table(result: TwinResult) -> Table:
    """Return the assignment of identified modes to those of the model, and why others have no counterpart."""
    rows = [
        (
            words(m.label),
            str(m.mode),
            frequency(m.frequency_hz),
            fixed(m.mac, 3),
            "yes" if m.fits_frequency else "no",
            "yes" if m.fits_damping else "no",
            "",
        )
        for m in result.measured
    ]
    for mode, held in result.unpaired:
        why = unpaired_finding(mode, held, result.labels)
        text = "" if why is None else why.text
        rows.append(
            ("no counterpart in the model", UNKNOWN, frequency(mode.frequency_hz), UNKNOWN, "no", "no", text)
        )
    columns = (
        "mode of the model",
        "no.",
        "identified f [Hz]",
        "subspace MAC [-]",
        "f fitted",
        "ζ fitted",
        "held against",
    )
    return Table(
        "Assignment of identified modes by the modal assurance criterion at the sensors, with the support "
        "stiffness for which the model agrees best with the records; for modes closer than 6 % in "
        "frequency, whose measured shapes mix, the share of the shape in the plane of the pair.",
        columns,
        tuple(rows),
    )
