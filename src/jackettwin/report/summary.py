"""The first sentences of the report: what this twin is, what was found, what to trust."""

from __future__ import annotations

import numpy as np

from jackettwin.report.numbers import UNKNOWN, count, fixed, frequency, known, listed, percent, words
from jackettwin.structure import check
from jackettwin.twin import TwinResult
from jackettwin.twin.result import MeasuredMode
from jackettwin.updating import Update


def shown_update(result: TwinResult) -> Update:
    """Return the update whose shapes are drawn: the first law without a locked damper."""
    return next((u for u in result.updates if not u.best.locked_damper), result.updates[0])


def headline(result: TwinResult) -> tuple[str, ...]:
    """Return a few plain sentences; what the data say of the supports comes before how well it fits."""
    sentences = [_what(result), _found(result), *_answer(result), *_fit(result), *_excess(result)]
    return tuple(sentences)


def _what(result: TwinResult) -> str:
    structure = result.assembly.structure
    tonnes = check(result.assembly).mass_kg / 1e3
    base = (
        f"This is a digital twin of {structure.name}: {count(len(structure.members), 'member')}, "
        f"{tonnes:.0f} t, gravity stiffness {'on' if result.assembly.gravity else 'off'}."
    )
    if result.record is None:
        return f"{base} It was updated to modes known from elsewhere, not to a record."
    r, n = result.record, len(result.identifications)
    when = f" from {r.start_utc:%Y-%m-%d %H:%M} UTC" if r.start_utc is not None else ""
    more = f" and {count(n - 1, 'further record')}" if n > 1 else ""
    length = f"{r.duration_s:.0f} s at {r.sample_rate_hz:g} Hz"
    return f"{base} It was updated from record {r.name}{more}: {length}{when}."


def _found(result: TwinResult) -> str:
    first = [m for m in result.measured if known(m.frequency_hz)]
    each = listed(
        [f"{words(m.label)} at {frequency(m.frequency_hz)} Hz{_with_damping(m)}" for m in first[:2]]
    )
    rest = f", and {count(len(first) - 2, 'higher mode')}" if len(first) > 2 else ""
    if result.record is None:
        return f"{count(len(first), 'mode').capitalize()} given: {each}{rest}."
    lost = (
        f"; {count(len(result.unpaired), 'identified mode')} found no counterpart" if result.unpaired else ""
    )
    return f"{count(len(first), 'measured mode').capitalize()} paired with the model: {each}{rest}{lost}."


def _with_damping(m: MeasuredMode) -> str:
    return f" (ζ {percent(m.damping_ratio)} %)" if known(m.damping_ratio) else ""


def _answer(result: TwinResult) -> list[str]:
    """Return the parameters of the shown law that the data determine, with intervals, and name the others."""
    update = shown_update(result) if result.updates else None
    if update is None or update.uncertainty is None:
        return []
    known_of = update.uncertainty
    by_name = zip(
        known_of.verdicts, update.model.parameters, known_of.median, known_of.interval_90, strict=True
    )
    said, open_ = [], []
    for verdict, parameter, median, (low, high) in by_name:
        if verdict.verdict == "unidentified":
            open_.append(parameter.name)
        else:
            unit = f" {parameter.unit}" if parameter.unit else ""
            said.append(
                f"{parameter.name} {median:.3g}{unit}, 90 % {low:.3g} to {high:.3g} ({verdict.verdict})"
            )
    answer = "; ".join(said) if said else "no parameter is determined by these data"
    rest = f" The data do not determine {listed(open_)}." if said and open_ else ""
    return [f"{update.law} says: {answer}.{rest}"]


def _fit(result: TwinResult) -> list[str]:
    if not result.updates:
        return []
    texts = [f"{u.law} {_worst(result.measured, u)}" for u in result.updates]
    fit = f"Largest misfit of what was fitted, frequency / damping: {'; '.join(texts)}."
    locked = [u.law for u in result.updates if u.best.locked_damper]
    most = max(len(u.solutions) for u in result.updates)
    count_locked = sum(s.locked_damper for u in result.updates for s in u.solutions)
    search = (
        f"The search ended in {'one solution' if most == 1 else f'up to {most} distinct solutions'} a law"
    )
    if locked:
        return [
            fit,
            f"{search}; do not use {listed(locked)}: every solution locks its damper, "
            "so the undamped structure is wrong.",
        ]
    if count_locked:
        return [fit, f"{search}; {count_locked} with a locked damper, which are listed but not used."]
    return [fit, f"{search}, none with a locked damper."]


def _worst(measured: tuple[MeasuredMode, ...], u: Update) -> str:
    """Return the largest relative misfits of what was fitted, and whose they are."""
    f = [
        (abs(a / m.frequency_hz - 1.0), m.label)
        for m, a in zip(measured, u.modes.frequency_hz, strict=True)
        if m.fits_frequency and m.frequency_hz and np.isfinite(a)
    ]
    z = [
        (abs(a / m.damping_ratio - 1.0), m.label)
        for m, a in zip(measured, u.modes.damping_ratio, strict=True)
        if m.fits_damping and m.damping_ratio and np.isfinite(a)
    ]
    return " / ".join(_worst_of(misfits, digits) for misfits, digits in ((f, 2), (z, 1)))


def _worst_of(misfits: list[tuple[float, str]], digits: int) -> str:
    if not misfits:
        return UNKNOWN
    largest, label = max(misfits)
    return f"{fixed(100.0 * largest, digits)} % ({words(label)})"


def _excess(result: TwinResult) -> list[str]:
    if not result.updates:
        return []
    rows = result.excess[result.updates.index(shown_update(result))] if any(result.excess) else ()
    said = []
    for carried, source in (
        (True, "the rotor's dashpot does"),
        (False, "another source must (the rotor, the water)"),
    ):
        texts = [
            f"{words(r.label)} measures ζ {percent(r.measured)} % where steel and support give "
            f"{percent(r.support)} %"
            for r in rows
            if not r.explained and r.excess > 0.0 and r.carried == carried
        ]
        if texts:
            said.append(f"{listed(texts).capitalize()}: no support at the feet explains this, {source}.")
    return said
