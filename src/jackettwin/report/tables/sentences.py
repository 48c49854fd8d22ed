"""The answers in words: a headline, and five questions with their sentences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import expm1, log

from jackettwin.answers import Answers, GroundAnswer, ModeAnswer, Span
from jackettwin.answers.result import Clearance
from jackettwin.report.tables.numbers import UNKNOWN, between, count, listed, rounded_percent, words
from jackettwin.report.tables.sentences_damping import (
    ROUGHLY,
    WIDE,
    firsts,
    owner_headline,
    owners,
)
from jackettwin.report.tables.sentences_fit import fit_sentence, misfit_headline, value_words
from jackettwin.report.tables.sentences_model import (
    condition_headline,
    feet_headline,
    mode_of,
    objected,
    objection_sentences,
    unseen_sentence,
)
from jackettwin.report.tables.sentences_next import data_words, next_headline, next_steps
from jackettwin.soil import family, parameter_words

MARGIN = 0.10
"""Usual smallest distance between natural frequencies and rotor excitation, as a share of the latter
(DNV-ST-0126 requires a margin; ten per cent is usual)."""
_NOTHING = 0.005
"""Changes of a logarithm below this are not reported."""
_MOST = 4
"""Number of ground parameters on the first page; further ones follow later."""


@dataclass(frozen=True)
class AnsweredQuestion:
    """A question of the first page with its answer in few words, with numbers, and further sentences."""

    title: str
    answer: tuple[str, ...]
    short: tuple[str, ...]
    more: tuple[str, ...] = ()


@dataclass(frozen=True)
class FirstPageWords:
    """The first page in words."""

    headline: tuple[str, ...]
    questions: tuple[AnsweredQuestion, ...]


def sentences(a: Answers) -> FirstPageWords:
    """Return the first page in words.

    The headline is the answers in the order of their questions; a ground that is not known comes first.
    """
    right, known, damping, trusted, steps = _answers(a)
    questions = (
        AnsweredQuestion("Is the model right?", right, *_model(a)),
        AnsweredQuestion("How stiff and how damped is the ground?", known, *_ground(a)),
        AnsweredQuestion("Whose damping is it?", damping, *owners(a)),
        AnsweredQuestion("How far can this be trusted?", trusted, (*_trust(a), *_law(a))),
        AnsweredQuestion("What to do next?", steps, *next_steps(a)),
    )
    fits = a.fit is None or a.fit.fits
    lost = fits and bool(a.ground) and all(g.verdict == "unidentified" for g in a.ground)
    told = (known, right, damping, trusted, steps) if lost else (right, known, damping, trusted, steps)
    return FirstPageWords(tuple(line for answer in told for line in answer), questions)


def _answers(a: Answers) -> tuple[tuple[str, ...], ...]:
    """Return the answer to each question; of a model that does not agree with the data, less."""
    objections = objection_sentences(a)
    if misfit := misfit_headline(a):
        disagrees, best, mended = misfit
        said = [[disagrees, *_stiff_enough(a), *objections[1:]], [best], [], [], [mended]]
    else:
        said = [
            [*objections, *_stiff_enough(a)],
            [*_ground_headline(a), feet_headline(a)],
            [owner_headline(a)],
            [condition_headline(a) or " ".join(_identifiability(a))],
            [next_headline(a)],
        ]
    return tuple(tuple(filter(None, answer)) for answer in said)


def span_words(span: Span, unit: str) -> str:
    """Return a value with its interval.

    >>> span_words(Span(3.8e9, 2.0e9, 1.4e10), "N/m")
    '3.8 GN/m (2 to 14 GN/m)'
    """
    value = value_words(span, unit)
    if span.low is None or span.high is None:
        return value
    return f"{value} ({between(span.low, span.high, unit)})"


def _tight(a: Answers) -> list[Clearance]:
    return [c for c in a.clearances if c.margin < MARGIN]


def _stiff_enough(a: Answers) -> list[str]:
    first, tight = firsts(a), _tight(a)
    if not first:
        return ["No first bending mode was measured: the foundation as a whole cannot be assessed."]
    names = listed([words(m.label) for m in first])
    if tight:
        worst = min(tight, key=lambda c: c.margin)
        where = "is inside" if worst.margin <= 0.0 else f"is within {100 * worst.margin:.0f} % of"
        return [f"{words(worst.label).capitalize()} {where} the {worst.order} range of the rotor."]
    off = [m for m in first if m.near_design is False]
    if off:
        return [f"The model is not as designed: {listed([_against_design(m) for m in off])}."]
    clear = _clear(a, {m.label for m in first})
    if all(m.as_designed for m in first):
        return [f"The foundation is stiff enough: {names} {_be(first)} as designed{clear}."]
    if all(m.near_design for m in first):
        beside = listed([_against_design(m) for m in first if not m.as_designed])
        return [f"The foundation is nearly as designed: {beside}, within the model's error{clear}."]
    higher = any(_softening(m) < 0.0 for m in first)
    sides = {_side(m) for m in first}
    each = [f"{_moved(m)} {_side(m)}" if len(sides) > 1 else _moved(m) for m in first]
    side = "" if len(sides) > 1 else f" {sides.pop()}"
    why = ": the ground cannot raise a frequency" if higher else ""
    return [f"{names.capitalize()} {_be(first)} {listed(each)}{side} the values on rigid feet{clear}{why}."]


def _be(modes: Sequence[object]) -> str:
    return "is" if len(modes) == 1 else "are"


def _softening(m: ModeAnswer) -> float:
    """Return the share by which a measured frequency is below that on rigid feet."""
    return 1.0 - (0.0 if m.measured_hz is None else m.measured_hz.value) / m.rigid_hz


def _moved(m: ModeAnswer) -> str:
    return f"{100.0 * abs(_softening(m)):.1f} %"


def _side(m: ModeAnswer) -> str:
    return "above" if _softening(m) < 0.0 else "below"


def _clear(a: Answers, labels: set[str]) -> str:
    """Return the distance of the first modes from the rotor's excitation."""
    texts = []
    for order in dict.fromkeys(c.order for c in a.clearances):
        least = min(
            (c for c in a.clearances if c.order == order and c.label in labels), key=lambda c: c.margin
        )
        mode = next(m for m in a.modes if m.label == least.label)
        value = 0.0 if mode.measured_hz is None else mode.measured_hz.value
        side = "above" if value > least.high_hz else "below"
        texts.append(f"{100 * least.margin:.0f} % {side} {order}")
    return f" and at least {listed(texts)}" if texts else ""


def _against_design(m: ModeAnswer) -> str:
    """Return a sentence that compares the measured with the design frequency."""
    if m.measured_hz is None or m.design_hz is None:
        return words(m.label)
    change = 100.0 * (m.measured_hz.value / m.design_hz.value - 1.0)
    side = "above" if change > 0 else "below"
    return (
        f"{words(m.label)} at {m.measured_hz.value:.4g} Hz is {abs(change):.1f} % {side} the design's "
        f"{m.design_hz.value:.4g} Hz"
    )


def _ground_headline(a: Answers) -> list[str]:
    """Return sentences on how well the ground is known."""
    if not a.ground:
        return []
    if all(g.verdict == "" for g in a.ground):
        return ["How well the ground is known cannot be stated: the data have no standard deviations."]
    known = [g for g in a.ground if g.verdict == "identified"]
    weak = [g for g in a.ground if g.verdict == "weak"]
    if not known and not weak:
        return [
            f"The ground is not determined by {data_words(a)}: its values are those of the stated priors."
        ]
    said, doubted = [], bool(objection_sentences(a))
    for kind in ("stiffness", "damping"):
        of_kind = [g for g in a.ground if g.kind == kind]
        sure = [g for g in of_kind if g.verdict == "identified"]
        whose = "If the model is right all the same, the" if doubted else "The"
        if sure:
            said.append(f"{whose} ground's {kind} is known: {listed([_value(g) for g in sure])}.")
        elif all(g.verdict == "unidentified" for g in of_kind) and of_kind:
            said.append(f"The ground's {kind} is not determined by {data_words(a)}.")
        elif of_kind:
            some = [g for g in of_kind if g.verdict == "weak"]
            best = [g for g in some if verdict_words(g) == ROUGHLY] or some
            ranges = listed([_range(g) for g in best])
            said.append(f"{whose} ground's {kind} is {verdict_words(best[0])}: {ranges}.")
    return said


def verdict_words(g: GroundAnswer, *, fits: bool = True) -> str:
    """Return how well a parameter of the ground is known, in words; nothing without a verdict."""
    if g.verdict != "weak":
        return {"identified": "known", "unidentified": "not known"}.get(g.verdict, "")
    if not fits:
        return "the interval of a model that does not fit"
    return ROUGHLY if g.factor is None or g.factor <= WIDE else "not known to a factor of ten"


def _value(g: GroundAnswer) -> str:
    return f"{parameter_words(g.name)} {span_words(g.value, g.unit)}"


def _range(g: GroundAnswer) -> str:
    if g.value.low is None or g.value.high is None:
        return _value(g)
    return f"{parameter_words(g.name)} {between(g.value.low, g.value.high, g.unit)}"


def _model(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    short, more = [], []
    judged = [m for m in a.modes if m.as_designed is not None and m.fits_frequency]
    if judged:
        good = sum(bool(m.as_designed) for m in judged)
        first = listed([_beside_design(m) for m in firsts(a)])
        be = "is" if len(judged) == 1 else "are"
        short.append(f"{good} of {count(len(judged), 'measured mode')} {be} as designed: {first}.")
        others = (_against_design(m) for m in judged if not m.as_designed)
        short += [f"{text[0].upper()}{text[1:]}." for text in others]
        more.append(
            "The design is the model on the foundation of the twin's priors, within their 90 % intervals."
        )
    elif a.modes:
        beside = [
            f"{words(m.label)} {_hertz(m.measured_hz)}, on rigid feet {m.rigid_hz:.4f}" for m in firsts(a)
        ]
        short.append(f"The twin has no design foundation (update.priors). Measured: {listed(beside)}.")
    short += [] if a.fit is None else [fit_sentence(a.fit)]
    short += _off_unfitted(a)
    short += [*filter(None, objection_sentences(a))]
    short += [*filter(None, [unseen_sentence(a)])]
    short += _margins(a)
    misses = [
        (abs(m.model_hz.value / m.measured_hz.value - 1.0), m.label)
        for m in a.modes
        if m.model_hz is not None and m.measured_hz is not None and m.fits_frequency
    ]
    if misses:
        worst, label = max(misses)
        how = (
            "agrees with all fitted frequencies within"
            if a.fits
            else "differs from fitted frequencies by up to"
        )
        size = max(100 * worst, 0.1) if a.fits else 100 * worst  # not "within 0.0 %"
        more.append(f"The updated model {how} {size:.1f} % ({words(label)}).")
    return tuple(short), tuple(more)


def _off_unfitted(a: Answers) -> list[str]:
    """Return sentences on measured modes that were not fitted and differ from updated model or design.

    Modes that the objections name are left out.
    """
    found, beside = [], []
    named = {mode_of(check) for check in objected(a) if check.datum.startswith("f")}
    for m in a.modes:
        if m.fits_frequency or m.model_hz is None or m.measured_hz is None or m.number in named:
            continue
        off = m.model_hz.value / m.measured_hz.value - 1.0
        if abs(off) > _NOTHING and not m.measured_hz.meets(m.model_hz):
            side = "above" if off > 0.0 else "below"
            found.append(f"{words(m.label)} {100.0 * abs(off):.1f} % {side}")
        elif m.as_designed is False:
            text = f"{_against_design(m)}; it was not fitted, but agrees with the updated model"
            beside.append(f"{text[0].upper()}{text[1:]} ({m.model_hz.value:.4g} Hz{_from_to(m.model_hz)}).")
    what = "it was not fitted" if len(found) == 1 else "they were not fitted"
    said = [f"The updated model has {listed(found)} the measured value; {what}."] if found else []
    return [*beside, *said]


def _from_to(span: Span) -> str:
    return "" if span.low is None or span.high is None else f", {span.low:.4g} to {span.high:.4g}"


def _hertz(span: Span | None) -> str:
    if span is None:
        return UNKNOWN
    if span.low is None or span.high is None:
        return f"{span.value:.4f} Hz"
    return f"{span.value:.4f} Hz ({span.low:.4f} to {span.high:.4f})"


def _beside_design(m: ModeAnswer) -> str:
    design = UNKNOWN if m.design_hz is None else f"{m.design_hz.value:.4f}"
    return f"{words(m.label)} {_hertz(m.measured_hz)}, design {design}"


def _margins(a: Answers) -> list[str]:
    if a.rotor_speed_hz is None:
        return ["Margins to 1P and 3P are not known: state rotor_speed_rpm: [lowest, highest] in the twin."]
    tight = _tight(a)
    if not tight:
        first = {m.label for m in firsts(a)}
        return [f"The first modes are{_clear(a, first).removeprefix(' and')}."] if first else []
    return [
        f"{words(c.label).capitalize()} is {100 * c.margin:.0f} % from {c.order} "
        f"({c.low_hz:.3g} to {c.high_hz:.3g} Hz), less than the usual {100 * MARGIN:.0f} %."
        if c.margin > 0.0
        else f"{words(c.label).capitalize()} is inside {c.order} ({c.low_hz:.3g} to {c.high_hz:.3g} Hz)."
        for c in tight
    ]


def _ground(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    said = [_parameter(g, a.fits) for g in a.ground]
    if not a.ground:
        said = ["No law was fitted."]
    first, more = firsts(a), []
    if first and all(_softening(m) > 0.0 for m in first):
        moved = [m for m in a.modes if m.measured_hz is not None and _softening(m) > _NOTHING]
        if moved:
            lower = listed([f"{words(m.label)} by {_moved(m)}" for m in moved])
            more.append(f"Compared with rigid feet, the ground lowers {lower}.")
    return tuple(said[:_MOST]), (*said[_MOST:], *more)


def _parameter(g: GroundAnswer, fits: bool) -> str:
    name = parameter_words(g.name).capitalize()
    before = "" if g.before is None else f"; prior {span_words(g.before, g.unit)}"
    verdict = verdict_words(g, fits=fits) or "no interval"
    return f"{name} {span_words(g.value, g.unit)}{before}: {verdict}."


def _law(a: Answers) -> list[str]:
    law = next((one for one in a.laws if one.law == a.law), None)
    if law is None:
        return []
    why = family(law.law).words
    if all(one.locked for one in a.laws):
        like = "" if len(a.laws) == 1 else f"like that of all {count(len(a.laws), 'law')} tried, "
        return [f"Law: {law.law} ({why}); {like}its best fit locks a damper: none is recommended."]
    if law.probability is None:
        return [f"Law: {law.law} ({why})."]
    others = [one for one in a.laws if one.law != a.law and one.probability is not None]
    best = max((one.probability or 0.0 for one in others), default=0.0)
    about = "about " if a.probability_from == "approximation" else ""
    open_ = bool(others) and best >= 0.1 * law.probability
    verdict = "the data do not distinguish the laws" if open_ else "all other laws are much less probable"
    if not others:
        if len(a.laws) == 1:
            return [f"Law: {law.law} ({why}); no other was tried."]
        return [f"Recommended law: {law.law} ({why}); all others lock a damper."]
    more = next((one for one in others if one.probability == best and best > law.probability), None)
    than = "" if more is None else f", {more.law} {100 * best:.0f} %"
    first = "" if more is None else ", the twin's first"
    return [
        f"Recommended law: {law.law} ({why}){first}, {about}{100 * law.probability:.0f} % probable among "
        f"{count(len(others) + 1, 'law')}{than}; {verdict}.",
        *_averaged(a),
    ]


def _averaged(a: Answers) -> list[str]:
    """Return the ground's stiffness and loss averaged over the laws that the data do not distinguish."""
    if not a.averaged:
        return []
    one = a.averaged[0]
    said = [f"{parameter_words(g.name)} {span_words(g.value, g.unit)}" for g in a.averaged[:_MOST]]
    return [
        f"Averaged over {count(len(one.laws), 'law')} by their probability, at {one.frequency_hz:.3g} Hz: "
        f"{listed(said)}."
    ]


def _lasting(minutes: float) -> str:
    """Return a duration in the unit that people would give it in."""
    return f"{minutes:.0f} minutes" if minutes < 2880.0 else count(round(minutes / 1440.0), "day")


def _trust(a: Answers) -> list[str]:
    if a.records:
        said = [
            f"Data: {count(a.records, 'record')}, {_lasting(a.minutes)}; "
            f"{count(len(a.modes), 'mode')} paired with the model."
        ]
    else:
        said = [f"Data: {count(len(a.modes), 'mode')} given as targets."]
    said += _identifiability(a)
    stated = sorted(m.model_error for m in a.modes if m.fits_frequency and m.model_error > 0.0)
    said.append(
        f"Model error: {_errors(stated)} of frequencies, from the tolerances of drawings and sea."
        if stated
        else "Model error: the twin sets all tolerances to zero; intervals are those of an exact model."
    )
    return [*said, *_if_off(a)]


def _identifiability(a: Answers) -> list[str]:
    """Return how many parameters of the ground are known, nothing without verdicts."""
    judged = [g for g in a.ground if g.verdict]
    known = [g for g in judged if g.verdict == "identified"]
    if not judged:
        return []
    of = count(len(judged), "ground parameter")
    return [
        f"{len(known)} of {of} {'is' if len(known) == 1 else 'are'} known within a factor of {a.usable:g}."
    ]


def _errors(stated: list[float]) -> str:
    """Return the least and the largest error in per cent."""
    low, high = (f"{100 * error:.2g}" for error in (stated[0], stated[-1]))
    return f"{low} %" if low == high else f"{low} to {high} %"


def _if_off(a: Answers) -> list[str]:
    """Return the effect of an undetectable error of the model on the ground's stiffness."""
    moved = {} if a.fit is None else a.fit.moved
    of_kind = [g for g in a.ground if g.kind == "stiffness" and g.verdict in ("identified", "weak")]
    parts = [
        f"{parameter_words(g.name)} by {_percent(abs(moved[g.name]))}"
        for g in of_kind[:_MOST]
        if abs(moved.get(g.name, 0.0)) > _NOTHING
    ]
    return [f"An error of 1 % of all frequencies of the model changes {listed(parts)}."] if parts else []


def _percent(log_change: float) -> str:
    """Return a change of a logarithm in per cent; large ones, as of poor fits, are not given in numbers."""
    return rounded_percent(expm1(log_change)) if log_change < log(WIDE) else "more than tenfold"
