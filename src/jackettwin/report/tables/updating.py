"""Tables of measured and updated values; all numbers are those of the result or their differences."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp

import numpy as np

from jackettwin.answers import Answers, Span
from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import (
    UNKNOWN,
    between,
    count,
    frequency,
    percent,
    quantity,
    scientific,
    words,
)
from jackettwin.report.tables.sentences import span_words
from jackettwin.soil import Parameter, parameter_words
from jackettwin.study import TwinResult
from jackettwin.study.truth import StatedMode, TrueParameter
from jackettwin.updating import Update


def key_table(result: TwinResult) -> Table:
    """Return measured and updated values, one row per mode."""
    columns = ["mode", "no.", "measured\nf [Hz]", *(f"{u.law}\nf [Hz]" for u in result.updates)]
    columns += ["measured\nζ [%]", *(f"{u.law}\nζ [%]" for u in result.updates)]
    rows = []
    for i, m in enumerate(result.measured):
        measured_hz = frequency(m.frequency_hz, m.frequency_std_hz)
        row = [words(m.label), str(m.mode), _mark(measured_hz, m.fits_frequency)]
        row += [frequency(float(u.central_hz[i])) for u in result.updates]
        row += [_mark(percent(m.damping_ratio, m.damping_ratio_std), m.fits_damping)]
        row += [percent(float(u.central_damping[i])) for u in result.updates]
        rows.append(tuple(row))
    caption = (
        "Does each law meet the modes? Medians of the posterior where there is one, else the best fit; in "
        "brackets: not fitted; ± half the 90 % interval."
    )
    return Table(caption, tuple(columns), tuple(rows), text_columns=1)


def _mark(text: str, fitted: bool) -> str:
    return text if fitted or text == UNKNOWN else f"({text})"


def truth_table(result: TwinResult, a: Answers, stated: tuple[StatedMode, ...]) -> Table:
    """Return the true modes stated by the records with the measured and the updated ones."""
    columns = ["mode", "true\nf [Hz]", "measured\nf [Hz]", "updated\nf [Hz]"]
    columns += ["true\nζ [%]", "measured\nζ [%]", "updated\nζ [%]"]
    place = {m.label: i for i, m in enumerate(result.measured)}
    rows = []
    for true in stated:
        i = place[true.label]
        m, model = result.measured[i], a.modes[i]
        row = [words(true.label), frequency(true.frequency_hz), frequency(m.frequency_hz, m.frequency_std_hz)]
        row += [UNKNOWN if model.model_hz is None else frequency(model.model_hz.value)]
        row += [percent(true.damping_ratio), percent(m.damping_ratio, m.damping_ratio_std)]
        row += [UNKNOWN if model.model_damping is None else percent(model.model_damping.value)]
        rows.append(tuple(row))
    caption = "Are the modes correct? Mean true values stated by these records, and the values found."
    return Table(caption, tuple(columns), tuple(rows), text_columns=1)


def true_parameters_table(parameters: tuple[TrueParameter, ...]) -> Table:
    """Return the true parameters of the support with the updated ones."""
    rows = [
        (
            p.law,
            p.name,
            quantity(p.true, p.unit, digits=3),
            quantity(p.value, p.unit, digits=3),
            UNKNOWN if p.interval_90 is None else between(*p.interval_90, p.unit),
            UNKNOWN if p.covered is None else "yes" if p.covered else "no",
        )
        for p in parameters
    ]
    columns = ("law", "parameter", "true", "updated", "90 % interval", "inside")
    return Table(
        "Are the parameters correct? True values stated by the records, and the values found, in SI units.",
        columns,
        tuple(rows),
        text_columns=2,
    )


def damped_undamped_table(result: TwinResult) -> Table:
    """Return damped and undamped frequencies of each law."""
    columns = ["mode"]
    for u in result.updates:
        flag = ", locked" if u.best.locked_damper else ""
        columns += [f"{u.law}{flag}\ndamped [Hz]", "\nundamped [Hz]"]
    rows = []
    for i, m in enumerate(result.measured):
        pairs = ((u.modes.frequency_hz[i], u.modes.undamped_hz[i]) for u in result.updates)
        rows.append((words(m.label), *(frequency(float(f)) for pair in pairs for f in pair)))
    caption = (
        "Is a damper locked? Damped and undamped frequencies of the full model at the best fit, without the "
        "tolerances."
    )
    return Table(caption, tuple(columns), tuple(rows))


def relaxation_table(result: TwinResult) -> Table:
    """Return measured real poles with the nearest ones of the updated model."""
    rows = []
    for i, r in enumerate(result.relaxations):
        for u in result.updates:
            known = None if u.uncertainty is None else u.uncertainty.predictive.rates[r.name]
            span = UNKNOWN if known is None else " … ".join(f"{v:.3g}" for v in _interval(known))
            spread = "" if r.rate_std_rad_s is None else f" ± {NORMAL_90 * r.rate_std_rad_s:.2g}"
            rate = float(u.best.rates[i])
            rows.append(
                (r.name, u.law, f"{r.rate_rad_s:.3g}{spread}", f"{rate:.3g}", span, f"{1.0 / rate:.3g}")
            )
    columns = (
        "pole",
        "law",
        "measured rate [1/s]",
        "best fit [1/s]",
        "90 % interval [1/s]",
        "time constant [s]",
    )
    caption = (
        "Real poles exp(−at): measured rates and those of the updated model that are nearest in rate and "
        "shape."
    )
    return Table(caption, columns, tuple(rows), text_columns=2)


def _interval(draws: FloatArray) -> tuple[float, float]:
    low, high = np.nanquantile(draws, QUANTILES[::2])
    return float(low), float(high)


def parameter_table(updates: Sequence[Update]) -> Table:
    """Return the updated support parameters."""
    rows = []
    for u in updates:
        known = u.uncertainty
        for i, (p, value) in enumerate(zip(u.problem.parameters, u.best.theta, strict=True)):
            span, verdict = UNKNOWN, UNKNOWN
            if known is not None:
                low, high = map(float, known.interval_90[i])
                span = span_words(Span(float(known.median[i]), low, high), p.unit)
                verdict = known.verdicts[i].verdict
            text = f"{verdict}{', on its bound' if p.name in u.best.at_bound else ''}"
            named = f"{parameter_words(p.name)}\n{p.name}"
            rows.append((u.law, named, text, _prior(p), span, quantity(float(value), p.unit, digits=3)))
    columns = ("law", "parameter", "verdict", "prior", "median (90 % interval)", "best fit")
    return Table(
        "Parameters of each law. The median with its interval is the value used elsewhere in this report; "
        "the best fit is the most probable point, which may differ if a parameter is uncertain. Below the "
        "name: the key in files.",
        columns,
        tuple(rows),
        3,
    )


def _prior(p: Parameter) -> str:
    if p.median is None or p.log_std is None:
        return between(p.low, p.high, p.unit)
    return f"{quantity(p.median, p.unit)} ×÷ {exp(p.log_std):.2g}"


def solutions_table(result: TwinResult, u: Update) -> Table:
    """Return all distinct solutions of a law, with the fitted modes."""
    of_solution = u.problem.states[0].residuals.modes
    fitted = [m for m in result.measured if m.mode in of_solution]
    columns = ("solution", "parameters", "cost [-]", "", *(words(m.label) for m in fitted))
    rows, marked = [], set()
    for i, s in enumerate(u.solutions):
        if s.locked_damper:
            marked.add(i)
        notes = [f"{i + 1}: {count(s.found, 'start')}"] + ["best fit"] * (s is u.best)
        notes += ["locked damper"] * s.locked_damper
        values = [
            f"{p.name} {quantity(float(v), p.unit, digits=3)}{' *' if p.name in s.at_bound else ''}"
            for p, v in zip(u.problem.parameters, s.theta, strict=True)
        ]
        modes = zip(s.frequency_hz, s.undamped_hz, s.damping_ratio, strict=True)
        cells = [f"{frequency(float(f))}\n{frequency(float(f0))}\n{percent(float(z))}" for f, f0, z in modes]
        head = ("\n".join(notes), "\n".join(values), scientific(s.cost))
        rows.append((*head, "f [Hz]\nundamped f [Hz]\nζ [%]", *cells))
    caption = (
        f"{u.law}: are there other solutions? All solutions found, by cost, with the number of starts that "
        "ended at each; * on a bound."
    )
    return Table(caption, columns, tuple(rows), 2, frozenset(marked))
