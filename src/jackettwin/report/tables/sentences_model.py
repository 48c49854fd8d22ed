"""Sentences on what the model does not explain, and on the assumptions that its answers depend on."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees, expm1

from jackettwin.answers import Answers, GroundAnswer
from jackettwin.intervals import NORMAL_90
from jackettwin.report.tables.numbers import listed, rounded_percent, words
from jackettwin.soil import parameter_words
from jackettwin.updating import DatumCheck, OrderCheck, ShapeCheck, Tolerance, UndetectedError

_NAMED = 3
"""Largest number of values and tolerances in a sentence; the table has all."""
_ANY = 8.0
"""Standard deviations of a tolerance beyond which no size is given, as the linearisation is not valid."""
_FELT = 0.01
"""Changes of a logarithm below this are not reported."""
_STEPS = {"-": (0.01, "1 %"), "m": (0.01, "10 mm"), "kg/m³": (100.0, "100 kg/m³"), "power": (0.1, "0.1")}
"""Step of a tolerance in sentences, by unit."""
_METRES = {"rna_height", "rna_overhang", "water_level", "foot_level"}
"""Tolerances in metres whose step is 0.1 m."""


def step(tolerance: Tolerance) -> tuple[float, str]:
    """Return a step of a tolerance in its unit, and in words."""
    if tolerance.name in _METRES:
        return 0.1, "0.1 m"
    return _STEPS.get(tolerance.unit, (tolerance.std, f"{tolerance.std:.2g} {tolerance.unit}"))


def size_words(tolerance: Tolerance, size: float) -> str:
    """Return a size of a tolerance with its sign and unit."""
    if tolerance.unit == "-":
        return f"{_rounded(100.0 * size)} %"
    if tolerance.unit == "m" and tolerance.name not in _METRES:
        return f"{_rounded(1000.0 * size)} mm"
    if tolerance.unit == "power":
        return f"ω^{_rounded(size).lstrip('+')}"
    return f"{_rounded(size)} {tolerance.unit}"


def _rounded(size: float) -> str:
    """Return a size with its sign and two significant digits, never with an exponent.

    >>> _rounded(118.1), _rounded(-0.0345)
    ('+120', '−0.035')
    """
    return f"{float(f'{size:.2g}'):+g}".replace("-", "−")


def moved_words(tolerance: Tolerance, effect: float) -> str:
    """Return the effect of a step of a tolerance on a parameter, ``each 10 mm raises it by 6 %``."""
    size, text = step(tolerance)
    change = expm1(effect * size / tolerance.std)
    return f"each {text} {'raises' if change > 0.0 else 'lowers'} it by {rounded_percent(abs(change))}"


def objected(a: Answers) -> list[DatumCheck]:
    """Return the measured values named on the first page because they contradict the model."""
    if a.scrutiny is None or a.scrutiny.objection is None:
        return []
    strays = [check for check in a.scrutiny.objection.checks if check.objects]
    return sorted(strays, key=lambda check: -abs(check.miss) / check.std)[:_NAMED]


def mode_of(check: DatumCheck) -> int | None:
    """Return the number of the mode of a value; None for a shape or a relaxation."""
    number = check.datum[1:].partition(" ")[0]
    return int(number) if number.isdigit() else None


def objection_sentences(a: Answers) -> list[str]:
    """Return what the model does not explain, and what would explain it; nothing if chance explains it."""
    if a.scrutiny is None or a.scrutiny.objection is None or not a.scrutiny.objects:
        return []
    o, labels = a.scrutiny.objection, {m.number: m.label for m in a.modes}
    said = [_stray(check, labels) for check in objected(a)]
    said += [_shape(check, labels) for check in o.shapes if check.objects]
    said += [_order(check, labels) for check in o.orders if check.objects]
    if o.suspected and not any(check.objects for check in o.checks):
        what = "measured modes" if not said else "frequencies and damping of the measured modes"
        said.append(f"the {what} deviate in the pattern of {listed([t.words for t in o.suspected])}")
    together = (
        "together, the measured modes deviate from all models within the tolerances by more than chance"
    )
    by = [f"{e.tolerance.words} {size_words(e.tolerance, e.size)}" for e in o.explanations]
    beside = any(check.objects for checks in (o.shapes, o.orders) for check in checks)
    what = "the deviation of frequencies and damping" if beside else "it"  # no error is tried on shapes
    return [
        f"Not explained: {listed(said) if said else together}.",
        f"Most of {what} would be explained by {', or '.join(by)}." if by else "",
    ]


def _stray(check: DatumCheck, labels: Mapping[int, str]) -> str:
    """Return a clause on a value that contradicts the model."""
    mode = mode_of(check)
    label = check.datum if mode is None else words(labels.get(mode, f"mode {mode}"))
    if check.is_direction:
        return (
            f"the direction of the pair of {label} differs by {abs(degrees(check.miss)):.0f}° from that in "
            f"the model (90 %: ± {degrees(NORMAL_90 * check.std):.0f}°)"
        )
    what, side = "damping" if check.datum[0] == "ζ" else "frequency", "above" if check.miss > 0.0 else "below"
    return (
        f"the {what} of {label} is {100 * abs(check.miss):.2g} % {side} the value that the other modes imply "
        f"(90 %: ± {100 * NORMAL_90 * check.std:.2g} %)"
    )


def _shape(check: ShapeCheck, labels: Mapping[int, str]) -> str:
    half = 100 * NORMAL_90 * check.std
    return (
        f"{100 * check.outside:.2g} % of {words(labels.get(check.mode, f'mode {check.mode}'))}'s shape lies "
        f"outside the model's (expected {100 * check.expected:.2g} %; 90 %: ± {half:.2g} %)"
    )


def _order(check: OrderCheck, labels: Mapping[int, str]) -> str:
    lower, upper = (words(labels.get(mode, f"mode {mode}")) for mode in (check.lower, check.upper))
    return (
        f"{lower} lies {100 * expm1(check.apart):.2g} % below {upper}, and in the model "
        f"{100 * expm1(-check.predicted):.2g} % above it (90 %: ± {100 * NORMAL_90 * check.std:.2g} %)"
    )


def feet_headline(a: Answers) -> str:
    """Return which mean of unlike feet a stiffness is, and whether one soft foot would show.

    Frequencies see how much the feet yield; so the stiffness is that of like feet which yield as much.
    """
    s = a.scrutiny
    known = any(g.kind == "stiffness" and g.verdict in ("identified", "weak") for g in a.ground)
    if s is None or not known or all(one.tolerance.name != "feet_unlike" for one in s.influences):
        return ""
    hidden = () if s.objection is None else s.objection.unseen
    said = [_seen_from(one.tolerance, one.seen_from) for one in hidden if one.tolerance.name == "weak_leg"]
    foot = f"; one foot softer than the others is {said[0]}" if said else ""
    return f"Stiffness is one value for all feet, from their mean compliance{foot}."


def condition_headline(a: Answers) -> str:
    """Return the assumption that the ground's answer depends on most; nothing if no tolerance matters."""
    s = a.scrutiny
    if s is None or not s.influences:
        return ""
    by_name = {g.name: i for i, g in enumerate(a.ground)}
    for condition in s.conditions:
        if condition.parameter in by_name:
            t = condition.tolerance
            return (
                f"{parameter_words(condition.parameter).capitalize()} is known only if {_as_stated(t)}: "
                f"{moved_words(t, condition.effect)}; to find out, {t.settled_by}."
            )
    moved = [_most(a, i, g) for i, g in enumerate(a.ground) if g.verdict == "identified"]
    return next((text for text in moved if text), "")


def _as_stated(t: Tolerance) -> str:
    return "there is no marine growth" if t.name == "growth" else f"the {t.words} is as stated"


def _most(a: Answers, i: int, g: GroundAnswer) -> str:
    """Return the tolerance with the largest effect on a parameter, which its interval includes."""
    if a.scrutiny is None:
        return ""
    first = a.scrutiny.movers(i)[0]
    effect = float(first.effect[i])
    if abs(effect) < _FELT:
        return ""
    return (
        f"The interval of {parameter_words(g.name)} includes the model's tolerances, of which the "
        f"{first.tolerance.words} has the largest effect: {moved_words(first.tolerance, effect)}."
    )


def unseen_sentence(a: Answers) -> str:
    """Return possible errors of the model that these data would not reveal, and their size.

    They are sought in what is listed: shapes are compared on their own, and other damping is not used.
    """
    if a.scrutiny is None or a.scrutiny.objection is None:
        return ""
    said = [_unseen(a, one) for one in a.scrutiny.objection.unseen]
    fitted = any(m.fits_damping for m in a.modes)
    data = f"all measured frequencies, fitted or not{', and the fitted damping' if fitted else ''}"
    return f"These data ({data}, but no shapes) would not reveal {listed(said)}." if said else ""


def _unseen(a: Answers, one: UndetectedError) -> str:
    """Return a suspected error with its size, its effect on the ground and the size the data would reveal."""
    t = one.tolerance
    size = size_words(t, t.std).lstrip("+")
    moved = _moved_most(a, one)
    return f"{t.words} ({size}{moved}; {_seen_from(t, one.seen_from)})"


def _moved_most(a: Answers, one: UndetectedError) -> str:
    """Return the ground parameter that an unrevealed error changes most, and by how much."""
    felt = [(abs(float(e)), float(e), g.name) for e, g in zip(one.effect, a.ground, strict=False)]
    most, effect, name = max(felt, default=(0.0, 0.0, ""))
    if most < _FELT:
        return ""
    change = f"{rounded_percent(abs(expm1(effect)))} {'more' if effect > 0.0 else 'less'}"
    return f", with which {parameter_words(name)} would be {change} than stated"


def _seen_from(t: Tolerance, size: float) -> str:
    if size > _ANY * t.std or (t.name == "weak_leg" and size >= 1.0):
        return "not revealed at any likely size"
    return f"revealed only from {size_words(t, size).lstrip('+')}"
