"""Sentences on whose damping it is: the parts of each mode, and what no support explains."""

from __future__ import annotations

from jackettwin.answers import Answers, ModeAnswer, Span
from jackettwin.report.tables.numbers import listed, words

WIDE = 10.0
"""Ratio of the ends of an interval above which the order of magnitude is not known."""
SMALL = 0.10
"""Sources with a smaller share of a mode's damping are not named."""
_SOURCES = {"structure": "the steel", "soil": "the ground", "rotor": "the rotor", "water": "the water"}
_UNEXPLAINED = "unexplained"
ROUGHLY = "known roughly"


def percent_words(span: Span) -> str:
    """Return a ratio in per cent with its interval."""
    text = f"{100.0 * span.value:.2g} %"
    if span.low is None or span.high is None or span.high < 1.05 * span.low:  # practically given
        return text
    return f"{text} ({100.0 * span.low:.2g} to {100.0 * span.high:.2g} %)"


def firsts(a: Answers) -> list[ModeAnswer]:
    """Return the first bending modes that were measured."""
    return [m for m in a.modes if m.label in ("fore_aft_1", "side_side_1") and m.measured_hz is not None]


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


def owner_headline(a: Answers) -> str:
    """Return a sentence on the source of more than half of the damping of each first bending mode."""
    by_owner: dict[str, list[str]] = {}
    alone = {(owner, m.label) for m in firsts(a) for owner in _alone(m)}
    for m in firsts(a):
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
        for m in firsts(a)
        for owner, share in _alone(m).items()
    ]
    text = listed(said)
    return [f"{text[0].upper()}{text[1:]}: the model damps too much."] if said else []


def _largest(a: Answers) -> dict[str, list[str]]:
    """Return the largest source of the measured damping of each first bending mode."""
    found: dict[str, list[str]] = {}
    for m in firsts(a):
        shares = _shares(m)
        if shares:
            owner = max(shares, key=lambda name: shares[name])
            found.setdefault(owner, []).append(f"{100 * shares[owner]:.0f} % in {_of_whom(m)}")
    return found


def owners(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return whose damping it is: what the first page says, and what follows later."""
    short = [_budget_words(m) for m in firsts(a) if m.sources and m.measured_damping is not None]
    short += [*_open_dashpots(a), *_of_rotor(a)]
    unexplained = set()
    for m in firsts(a):
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
    sources = {m.label: m.given_sources for m in firsts(a) if m.given_sources}
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
