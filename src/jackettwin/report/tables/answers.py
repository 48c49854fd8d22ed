"""The answers as tables: measured, designed and updated modes, ground, sources of damping, next steps."""

from __future__ import annotations

from jackettwin.answers import Answers, Span
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import UNKNOWN, between, factor, fixed, words
from jackettwin.report.tables.sentences import span_words, verdict_words
from jackettwin.report.tables.sentences_fit import value_words
from jackettwin.report.tables.sentences_next import step_words
from jackettwin.soil import parameter_words
from jackettwin.study import TwinResult
from jackettwin.updating import SOURCES


def modes_table(a: Answers, result: TwinResult) -> Table:
    """Return every measured mode with the design and the updated model."""
    rows = []
    for mode, m in zip(a.modes, result.measured, strict=True):
        fitted = [what for what, flag in (("f", mode.fits_frequency), ("ζ", mode.fits_damping)) if flag]
        rows.append(
            (
                words(mode.label),
                " and ".join(fitted) or "nothing",
                _cell(mode.measured_hz, 1.0, 4),
                _cell(mode.design_hz, 1.0, 4),
                fixed(mode.rigid_hz, 4),
                _cell(mode.model_hz, 1.0, 4),
                _cell(mode.measured_damping, 100.0, 2),
                _cell(mode.model_damping, 100.0, 2),
                fixed(m.mac, 2),
            )
        )
    columns = (
        "mode",
        "fitted",
        "measured\nf [Hz]",
        "design\nf [Hz]",
        "rigid feet\nf [Hz]",
        "updated\nf [Hz]",
        "measured\nζ [%]",
        "updated\nζ [%]",
        "MAC\n[-]",
    )
    caption = (
        f"Does the model agree with the measurements? Below each value its 90 % interval; updated: "
        f"{a.law or 'no law'}. MAC: agreement of measured and modelled shapes."
    )
    return Table(caption, columns, tuple(rows), 2)


def _cell(span: Span | None, factor: float, decimals: int) -> str:
    if span is None:
        return UNKNOWN
    text = fixed(factor * span.value, decimals)
    if span.low is None or span.high is None:
        return text
    return f"{text}\n{fixed(factor * span.low, decimals)} – {fixed(factor * span.high, decimals)}"


def ground_table(a: Answers) -> Table:
    """Return the verdict on every parameter of the ground, with the reason."""
    rows = tuple(
        (parameter_words(g.name), (verdict_words(g) if a.fits else "does not fit") or UNKNOWN,
         g.reason or UNKNOWN, ranged(g.before, g.unit),
         ranged(g.value, g.unit), UNKNOWN if g.factor is None else f"{g.factor:.3g}")
        for g in a.ground
    )  # fmt: skip
    median = "median" if any(g.verdict for g in a.ground) else "best fit"
    columns = ("parameter", "verdict", "why", "prior", f"posterior, {median}", "factor [-]")
    caption = (
        f"What is known of the ground ({a.law})? Values are for one foot, with 90 % intervals in brackets; "
        f"factor: ratio of the ends. Known means at most {a.usable:g} from the data without the prior."
    )
    return Table(caption, columns, rows, 3)


def ranged(span: Span | None, unit: str) -> str:
    """Return a value above its interval in brackets, as a cell of a table."""
    if span is None:
        return "uniform between its bounds"
    if span.low is None or span.high is None:
        return span_words(span, unit)
    return f"{value_words(span, unit)}\n({between(span.low, span.high, unit)})"


def laws_table(a: Answers) -> Table:
    """Return every fitted law with its probability and misfit."""
    # without probabilities laws are ordered by cost, with locked dampers last
    laws = a.laws if a.probability_from else tuple(sorted(a.laws, key=lambda one: (one.locked, one.misfit)))
    rows = tuple(
        (
            law.law,
            "locks a damper: do not use" if law.locked else "recommended" if law.law == a.law else "",
            UNKNOWN if law.probability is None else fixed(100.0 * law.probability, 0),
            f"{law.misfit:.3g}",
        )
        for law in laws
    )
    source = {
        "evidence": "from the evidence that was sampled for each",
        "approximation": "by Laplace's approximation; --all-laws samples it",
        "": "not known, as the data have no standard deviations; ordered by cost",
    }[a.probability_from]
    if laws and all(law.locked for law in laws):
        source = f"not known, as each of them locks a damper; what is said of the ground is by {a.law}"
    caption = f"Which law? Probability of each with equal priors: {source}."
    marked = frozenset(i for i, law in enumerate(laws) if law.locked)
    return Table(caption, ("law", "", "probability [%]", "misfit, χ² or relative [-]"), rows, 2, marked)


def budget_table(a: Answers) -> Table:
    """Return each mode's damping by source."""
    sources = [s for s in SOURCES if any(s in m.sources for m in a.modes)]
    names = {"structure": "steel", "soil": "ground"}
    beyond = any(m.unexplained for m in a.modes)
    rows = tuple(
        (
            words(m.label),
            _cell(m.measured_damping, 100.0, 2),
            _cell(m.model_damping, 100.0, 2),
            *(
                "not\nconstrained" if s == "rotor" and m.open_dashpot else _cell(m.sources.get(s), 100.0, 3)
                for s in sources
            ),
            *([UNKNOWN if m.unexplained is None else fixed(100.0 * m.unexplained, 3)] if beyond else []),
        )
        for m in a.modes
    )
    owners = (*(names.get(s, s) for s in sources), *(["unexplained"] if beyond else []))
    columns = ("mode", "measured\nζ [%]", "model\nζ [%]", *(f"{owner}\nζ [%]" for owner in owners))
    caption = (
        "How much damping does each source add to each mode? Below each value its 90 % interval. The sources "
        "add up to the model's damping; of what the tolerances change, the growth of the ground's loss is "
        "the ground's, the rest is shared by all sources."
    )
    return Table(caption, columns, rows, 1)


def next_table(a: Answers) -> Table:
    """Return the expected effect of each further measurement on parameters that are not known."""
    names = [g.name for g in a.ground if g.verdict in ("weak", "unidentified")]
    now = {g.name: g.factor for g in a.ground}
    rows = [("as it is", *(_number(now[name]) for name in names))]
    rows += [(step_words(a, s), *(_number(s.factors.get(name)) for name in names)) for s in a.next_steps]
    caption = (
        "What would determine the ground? Expected ratio of the ends of each 90 % interval; at most "
        f"{a.usable:g} counts as known."
    )
    return Table(
        caption, ("measurement", *(f"{parameter_words(name)} [-]" for name in names)), tuple(rows), 1
    )


def _number(value: float | None) -> str:
    return factor(value)
