"""The answers in words: a headline, and five questions with their sentences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import expm1, log

from jackettwin.answers import Answers, GroundAnswer, ModeAnswer, Span
from jackettwin.answers.result import Clearance, NextStep
from jackettwin.constants import YEAR_DAYS
from jackettwin.report.tables.numbers import UNKNOWN, between, count, factor, listed, rounded_percent, words
from jackettwin.report.tables.sentences_fit import fit_sentence, mend, misfit_headline, value_words
from jackettwin.report.tables.sentences_model import (
    condition_headline,
    feet_headline,
    mode_of,
    objected,
    objection_sentences,
    unseen_sentence,
)
from jackettwin.soil import family, parameter_words

MARGIN = 0.10
"""Usual smallest distance between natural frequencies and rotor excitation, as a share of the latter
(DNV-ST-0126 requires a margin; ten per cent is usual)."""
WIDE = 10.0
"""Ratio of the ends of an interval above which the order of magnitude is not known."""
_NOTHING = 0.005
"""Changes of a logarithm below this are not reported."""
SMALL = 0.10
"""Sources with a smaller share of a mode's damping are not named."""
_LONG_DAYS = 36_525.0
"""Length of records beyond which this length is named instead: a hundred years."""
_MOST = 4
"""Number of ground parameters on the first page; further ones follow later."""
_SOURCES = {"structure": "the steel", "soil": "the ground", "rotor": "the rotor", "water": "the water"}
_UNEXPLAINED = "unexplained"
_ROUGHLY = "known roughly"
_STEPS = {
    "feet": "measure at the feet: low-noise accelerometers on one foot, synchronised with those on the "
    "tower; its amplitude (to 10 %) gives the stiffness, its phase lag (to 0.6°) the damping",
    "decays": "stop the rotor in calm weather and record a few free decays: the rotor then adds hardly any "
    "damping",
    "torsion": "measure torsion as well: two accelerometers at one height on opposite sides of the tower",
    "second_bending": "measure the second bending modes as well: accelerometers half-way up the tower",
    "model": "reduce the error of the model (weigh the nacelle, check the drawings) and state it under "
    "update.model_error; the effect is that of a model without error",
}
_GERUNDS = {
    "feet": "motion measured at the feet, synchronised with the tower's",
    "decays": "free decays in calm weather",
    "torsion": "torsion, from two accelerometers at one height",
    "second_bending": "the second bending modes, from accelerometers half-way up",
    "model": "a model with a smaller error",
}


@dataclass(frozen=True)
class AnsweredQuestion:
    """A question of the first page with its answer in one or two sentences, and further sentences."""

    title: str
    short: tuple[str, ...]
    more: tuple[str, ...] = ()


@dataclass(frozen=True)
class FirstPageWords:
    """The first page in words."""

    headline: tuple[str, ...]
    questions: tuple[AnsweredQuestion, ...]


def sentences(a: Answers) -> FirstPageWords:
    """Return the first page in words."""
    return FirstPageWords(
        tuple(filter(None, _headline(a))),
        (
            AnsweredQuestion("Is the model right?", *_model(a)),
            AnsweredQuestion("How stiff and how damped is the ground?", *_ground(a)),
            AnsweredQuestion("Whose damping is it?", *_owners(a)),
            AnsweredQuestion("How far can this be trusted?", (*_trust(a), *_law(a))),
            AnsweredQuestion("What to do next?", *_next(a)),
        ),
    )


def _headline(a: Answers) -> list[str]:
    """Return the headline; a misfit or an unknown ground comes first."""
    if misfit := misfit_headline(a):
        return [misfit[0], *_stiff_enough(a), *objection_sentences(a)[1:], *misfit[1:]]
    ground = [*_ground_headline(a), feet_headline(a), condition_headline(a)]
    lead = [*objection_sentences(a), *_stiff_enough(a), *ground]
    if a.ground and all(g.verdict == "unidentified" for g in a.ground):
        lead = [*ground, *_stiff_enough(a)]
    return [*lead, _owner_headline(a), _next_headline(a)]


def span_words(span: Span, unit: str) -> str:
    """Return a value with its interval.

    >>> span_words(Span(3.8e9, 2.0e9, 1.4e10), "N/m")
    '3.8 GN/m (2 to 14 GN/m)'
    """
    value = value_words(span, unit)
    if span.low is None or span.high is None:
        return value
    return f"{value} ({between(span.low, span.high, unit)})"


def percent_words(span: Span) -> str:
    """Return a ratio in per cent with its interval."""
    text = f"{100.0 * span.value:.2g} %"
    if span.low is None or span.high is None or span.high < 1.05 * span.low:  # practically given
        return text
    return f"{text} ({100.0 * span.low:.2g} to {100.0 * span.high:.2g} %)"


def data_words(a: Answers) -> str:
    """Return what was measured: ``these 5 records``, or ``these targets``."""
    return f"these {a.records} records" if a.records > 1 else "this record" if a.records else "these targets"


def _firsts(a: Answers) -> list[ModeAnswer]:
    return [m for m in a.modes if m.label in ("fore_aft_1", "side_side_1") and m.measured_hz is not None]


def _tight(a: Answers) -> list[Clearance]:
    return [c for c in a.clearances if c.margin < MARGIN]


def _stiff_enough(a: Answers) -> list[str]:
    first, tight = _firsts(a), _tight(a)
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
            best = [g for g in some if verdict_words(g) == _ROUGHLY] or some
            ranges = listed([_range(g) for g in best])
            said.append(f"{whose} ground's {kind} is {verdict_words(best[0])}: {ranges}.")
    return said


def verdict_words(g: GroundAnswer, *, fits: bool = True) -> str:
    """Return how well a parameter of the ground is known, in words; nothing without a verdict."""
    if g.verdict != "weak":
        return {"identified": "known", "unidentified": "not known"}.get(g.verdict, "")
    if not fits:
        return "the interval of a model that does not fit"
    return _ROUGHLY if g.factor is None or g.factor <= WIDE else "not known to a factor of ten"


def _value(g: GroundAnswer) -> str:
    return f"{parameter_words(g.name)} {span_words(g.value, g.unit)}"


def _range(g: GroundAnswer) -> str:
    if g.value.low is None or g.value.high is None:
        return _value(g)
    return f"{parameter_words(g.name)} {between(g.value.low, g.value.high, g.unit)}"


def _shares(m: ModeAnswer) -> dict[str, float]:
    """Return each source's share of a mode's damping, and that of what is measured beyond all of them.

    Of the measured damping, or of the model's if that is larger: they never add up to more than all.
    """
    if m.measured_damping is None:
        return {}
    parts = {source: span.value for source, span in m.given_sources.items()}
    parts |= {} if m.unexplained is None else {_UNEXPLAINED: m.unexplained}
    whole = max(m.measured_damping.value, sum(parts.values()))
    return {name: part / whole for name, part in parts.items()}


def _times(m: ModeAnswer) -> float:
    """Return the damping in the model as a multiple of the measured one; 1 without."""
    whole = sum(span.value for span in m.given_sources.values())
    return 1.0 if m.measured_damping is None else whole / m.measured_damping.value


def _of_whom(m: ModeAnswer) -> str:
    """Return the label of a mode, and whose damping the shares are of, if the model damps more."""
    more = f" (of the model's, {_times(m):.1f} times the measured)" if _times(m) > 1.0 + SMALL else ""
    return f"{words(m.label)}{more}"


def _owner_headline(a: Answers) -> str:
    """Return a sentence on the source of more than half of the damping of each first bending mode."""
    by_owner: dict[str, list[str]] = {}
    alone = {(owner, m.label) for m in _firsts(a) for owner in _alone(m)}
    for m in _firsts(a):
        for owner, share in _shares(m).items():
            if share > 0.5 and (owner, m.label) not in alone:
                part = "all" if share >= 1.0 else f"{100 * share:.0f} %"
                by_owner.setdefault(owner, []).append(f"{part} in {_of_whom(m)}")
    if not by_owner and not _too_much(a):
        by_owner = _largest(a)
    parts = [
        f"{listed(of)} is unexplained" if owner == _UNEXPLAINED else f"{_SOURCES[owner]} gives {listed(of)}"
        for owner, of in by_owner.items()
    ]
    return " ".join([*_too_much(a), *([f"Of the damping, {listed(parts)}."] if parts else [])])


def _alone(m: ModeAnswer) -> dict[str, float]:
    """Return the sources that alone give more than the measured damping, as multiples of it."""
    if m.measured_damping is None:
        return {}
    times = {source: span.value / m.measured_damping.value for source, span in m.given_sources.items()}
    return {source: share for source, share in times.items() if share > 1.0 + SMALL}


def _too_much(a: Answers) -> list[str]:
    """Return a sentence on first bending modes of which one source alone gives more than was measured."""
    said = [
        f"{_SOURCES[owner]} alone gives {share:.1f} times the measured damping of {words(m.label)}"
        for m in _firsts(a)
        for owner, share in _alone(m).items()
    ]
    text = listed(said)
    return [f"{text[0].upper()}{text[1:]}: the model damps too much."] if said else []


def _largest(a: Answers) -> dict[str, list[str]]:
    """Return the largest source of the measured damping of each first bending mode."""
    found: dict[str, list[str]] = {}
    for m in _firsts(a):
        shares = _shares(m)
        if shares:
            owner = max(shares, key=lambda name: shares[name])
            found.setdefault(owner, []).append(f"{100 * shares[owner]:.0f} % in {_of_whom(m)}")
    return found


def _next_headline(a: Answers) -> str:
    if not a.next_steps:
        return ""
    # what is free is said before what is not, but is no headline unless it is enough
    best = next((s for s in a.next_steps if s.what != "modes" or _enough(a, s)), a.next_steps[0])
    kinds = dict.fromkeys(g.kind for g in a.ground if g.name in best.factors)
    if best.what == "records" and not _enough(a, best):
        return f"No single measurement determines the ground's {listed(list(kinds))}: see what to do next."
    what = _STEPS.get(best.what, _records(a, best)).split(":")[0]
    by = f"fitting {_unfitted(best)} too" if best.what == "modes" else _GERUNDS.get(best.what, what)
    return f"The ground's {listed(list(kinds))} would be determined by {by}."


def _model(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    short, more = [], []
    judged = [m for m in a.modes if m.as_designed is not None and m.fits_frequency]
    if judged:
        good = sum(bool(m.as_designed) for m in judged)
        first = listed([_beside_design(m) for m in _firsts(a)])
        be = "is" if len(judged) == 1 else "are"
        short.append(f"{good} of {count(len(judged), 'measured mode')} {be} as designed: {first}.")
        others = (_against_design(m) for m in judged if not m.as_designed)
        short += [f"{text[0].upper()}{text[1:]}." for text in others]
        more.append(
            "The design is the model on the foundation of the twin's priors, within their 90 % intervals."
        )
    elif a.modes:
        beside = [
            f"{words(m.label)} {_hertz(m.measured_hz)}, on rigid feet {m.rigid_hz:.4f}" for m in _firsts(a)
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
        first = {m.label for m in _firsts(a)}
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
    first, more = _firsts(a), []
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


def _owners(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    short = [_budget_words(m) for m in _firsts(a) if m.sources and m.measured_damping is not None]
    short += [*_open_dashpots(a), *_of_rotor(a)]
    unexplained = set()
    for m in _firsts(a):
        beyond = m.unexplained or 0.0
        if m.measured_damping is not None and beyond > SMALL * m.measured_damping.value:
            unexplained.add(m.label)
            share = 100.0 * beyond / m.measured_damping.value
            short.append(
                f"Of the measured damping of {words(m.label)}, {share:.0f} % has no source in the model."
            )
    short += [_disagreement(m) for m in a.modes if _disagrees(m) and m.label not in unexplained]
    missing = [
        _SOURCES[s] for s in ("rotor", "water") if a.modes and all(s not in m.sources for m in a.modes)
    ]
    if missing and any(m.sources for m in a.modes):
        short.append(f"Not modelled: {listed(missing)}; its damping is attributed to the other sources.")
    return tuple(short), ()


def _open_dashpots(a: Answers) -> list[str]:
    """Return which dashpots of the rotor no datum constrains, and what would."""
    said = []
    for name in dict.fromkeys(m.open_dashpot for m in a.modes if m.open_dashpot):
        kind = name.removeprefix("c_")
        fitted = any(m.fits_damping for m in a.modes if m.label.startswith(kind))
        why = (
            "the fitted damping does not determine it"
            if fitted
            else f"update.damping_of leaves out the damping of {kind.replace('_', '-')} modes"
        )
        said.append(
            f"No datum constrains the rotor's dashpot {name}: {why}. Fit that damping too (damping_of: all), "
            "or state the rotor (update.rotor)."
        )
    return said


def _of_rotor(a: Answers) -> list[str]:
    """Return why the rotor damps a first bending mode of which it is the largest source."""
    sources = {m.label: m.given_sources for m in _firsts(a) if m.given_sources}
    owners = {label: max(of, key=lambda s: of[s].value) for label, of in sources.items()}
    damped = [label for label, owner in owners.items() if owner == "rotor"]
    wind = "" if a.wind_m_s is None else f" ({a.wind_m_s:.3g} m/s on average in these records)"
    if a.rotor_state == "parked" and any(label.startswith("side_side") for label in damped):
        return [
            "Why the rotor: feathered blades move with their flat sides through the air in side-side motion, "
            "which turns the wind that they feel and so their lift, in proportion to the wind"
            f"{wind}; in fore-aft motion they move edgewise, where only their small drag damps."
        ]
    if a.rotor_state == "operating" and any(label.startswith("fore_aft") for label in damped):
        return [
            "Why the rotor: at work its thrust grows when the tower moves into the wind and falls when it "
            f"moves with it; side-side motion changes it little{wind}."
        ]
    return []


def _budget_words(m: ModeAnswer) -> str:
    whole = sum(span.value for span in m.given_sources.values())
    parts = [
        f"{_SOURCES[s]} {percent_words(span) if _roughly(span) else _not_known(span)}"
        for s, span in sorted(m.given_sources.items(), key=lambda item: -item[1].value)
        if span.value > SMALL * whole or s == "soil"
    ]
    if m.open_dashpot:
        parts.append(f"the rotor and what is unexplained are not known ({m.open_dashpot} is open)")
    if m.unexplained is not None:
        parts.append(f"unexplained {percent_words(Span(m.unexplained))}")
    measured, more = "", ""
    if m.measured_damping is not None:
        measured, times = percent_words(m.measured_damping), _times(m)
        more = f"; together {times:.1f} times the measured value" if times > 1.0 + SMALL else ""
    return f"{words(m.label).capitalize()} has a measured damping of {measured}: {', '.join(parts)}{more}."


def _roughly(span: Span) -> bool:
    """Return whether a part is known to a factor of ten, or states no interval."""
    return span.low is None or span.high is None or span.high <= WIDE * span.low


def _not_known(span: Span) -> str:
    """Return a part of the damping whose order of magnitude is not known: only its upper end counts."""
    return f"at most {100.0 * (span.high or span.value):.2g} %"


def _disagrees(m: ModeAnswer) -> bool:
    """Return whether measured and modelled damping differ by more than their intervals (or by a tenth)."""
    if m.damped_as_measured is not None:
        return not m.damped_as_measured
    a, b = m.measured_damping, m.model_damping
    return a is not None and b is not None and abs(b.value / a.value - 1.0) > SMALL


def _disagreement(m: ModeAnswer) -> str:
    a, b = m.measured_damping, m.model_damping
    if a is None or b is None:
        return ""
    why = (
        "the damping in the model is larger than measured"
        if b.value > a.value
        else "part of its damping is not explained"
    )
    fitted = "" if m.fits_damping else "; its damping was not fitted"
    alone = [f"{_SOURCES[s]} alone gives {percent_words(Span(m.sources[s].value))}" for s in m.excessive]
    beyond = f". {listed(alone)[0].upper()}{listed(alone)[1:]}" if alone else ""
    return (
        f"{words(m.label).capitalize()}: {why}: {percent_words(b)} in the model, {percent_words(a)} "
        f"measured{fitted}{beyond}."
    )


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
    judged = [g for g in a.ground if g.verdict]
    if judged:
        known = [g for g in judged if g.verdict == "identified"]
        said.append(
            f"Identifiability: {len(known)} of {count(len(judged), 'ground parameter')} known within a "
            f"factor of {a.usable:g}."
        )
    stated = sorted(m.model_error for m in a.modes if m.fits_frequency and m.model_error > 0.0)
    said.append(
        f"Model error: {_errors(stated)} of frequencies, from the tolerances of drawings and sea."
        if stated
        else "Model error: the twin sets all tolerances to zero; intervals are those of an exact model."
    )
    return [*said, *_if_off(a)]


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


def _next(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    if a.fit is not None and not a.fit.fits:
        return (f"{mend(a.fit)}. Then run again: only a model that fits shows what to measure next.",), ()
    # what is measured already, if it helps; then the best of either kind
    told = [step for step in a.next_steps if step.what != "modes" or _gains(a, step)]
    first = {step.what if step.what in ("modes", "records") else "": step for step in reversed(told)}
    short = [_step(a, step) for step in told if step in first.values()]
    open_ = [g for g in a.ground if g.verdict != "identified"]
    if a.ground and not open_:
        short = ["The ground is known well enough. Monitor it: `jackettwin follow`, `jackettwin watch`."]
    elif a.ground and all(g.verdict == "" for g in a.ground):
        short = ["State the standard deviation of every target, to obtain intervals and advice."]
    if a.records_for:
        needs = [f"{words(label)} {n}" for label, n in a.records_for.items()]
        short.append(
            f"For damping ratios to ±{100 * a.precision:.0f} %, this many records like these are "
            f"needed: {listed(needs)} (now {a.records})."
        )
    rest = [step for step in told if step not in first.values() and _gains(a, step)]
    return tuple(short), tuple(_step(a, step) for step in rest)


def _step(a: Answers, step: NextStep) -> str:
    what, gains = step_words(a, step), _gains(a, step)
    narrow = "They narrow" if step.what == "records" and not _enough(a, step) else "It narrows"
    how = f"the 90 % interval of {listed(gains)}" if gains else "no interval noticeably"
    return f"{what[0].upper()}{what[1:]}. {narrow} {how}."


def _gains(a: Answers, step: NextStep) -> list[str]:
    """Return the stiffness and the damping that a step makes most certain, if the change is visible."""
    kinds = {g.name: g.kind for g in a.ground}
    gains: dict[str, tuple[str, float]] = {}  # the most certain parameter of each kind
    for name, left in sorted(step.factors.items(), key=lambda item: item[1]):
        gains.setdefault(kinds.get(name, ""), (name, left))
    return [
        f"{parameter_words(name)} to a factor of {factor(left)} (now {factor(_now(a, name))})"
        for name, left in gains.values()
        if factor(left) != factor(_now(a, name))
    ]


def step_words(a: Answers, step: NextStep) -> str:
    """Return a step in words."""
    if step.what == "modes":
        return (
            f"fit {_unfitted(step)} too (update.modes), measured already in {data_words(a)}; higher modes "
            "depend more on blades and brace details"
        )
    return _STEPS.get(step.what, _records(a, step))


def _unfitted(step: NextStep) -> str:
    """Return the modes of a step by their numbers, as ``update.modes`` has them."""
    return f"{'modes' if len(step.modes) > 1 else 'mode'} {listed([str(mode) for mode in step.modes])}"


def _now(a: Answers, name: str) -> float | None:
    return next((g.factor for g in a.ground if g.name == name), None)


def _enough(a: Answers, step: NextStep) -> bool:
    return max(step.factors.values()) <= a.usable


def _records(a: Answers, step: NextStep) -> str:
    """Return the effect of more records in words."""
    days = step.days or 0.0
    times = days * 1440.0 / max(a.minutes, 1e-9)
    length = count(round(days), "day") if days >= 2.0 else count(max(round(24 * days), 1), "hour")
    if _enough(a, step):
        return f"record {length} in the same way ({round(times * a.records)} records instead of {a.records})"
    if days > _LONG_DAYS:
        length = f"{_LONG_DAYS / YEAR_DAYS:.0f} years"
    return f"more records alone do not determine it, not even {length} of records"
