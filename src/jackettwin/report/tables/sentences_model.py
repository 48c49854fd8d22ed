"""What stands behind the fit, in words: what it does not explain, and what its answers hang on."""

from __future__ import annotations

from math import expm1

from jackettwin.answers import Answers, GroundAnswer
from jackettwin.report.tables.numbers import listed, words
from jackettwin.soil import parameter_words
from jackettwin.updating import Tolerance

_NAMED = 3
"""Values and tolerances that a sentence names: the table has all."""
_FELT = 0.01
"""Changes of a logarithm below this are not reported."""
_STEPS = {"-": (0.01, "1 %"), "m": (0.01, "10 mm"), "kg/m³": (100.0, "100 kg/m³"), "power": (0.1, "0.1")}
"""By unit, the step that a sentence speaks of."""
_METRES = {"rna_height", "rna_overhang", "water_level", "foot_level"}
"""Tolerances in metres that are spoken of by 0.1 m."""


def step(tolerance: Tolerance) -> tuple[float, str]:
    """Return a step of a tolerance in its unit, and in words."""
    if tolerance.name in _METRES:
        return 0.1, "0.1 m"
    return _STEPS.get(tolerance.unit, (tolerance.std, f"{tolerance.std:.2g} {tolerance.unit}"))


def size_words(tolerance: Tolerance, size: float) -> str:
    """Return a size of a tolerance with its sign and unit."""
    if tolerance.unit == "-":
        return f"{100.0 * size:+.2g} %".replace("-", "−")
    if tolerance.unit == "m" and tolerance.name not in _METRES:
        return f"{1000.0 * size:+.2g} mm".replace("-", "−")
    return f"{size:+.2g} {tolerance.unit}".replace("-", "−")


def moved_words(tolerance: Tolerance, effect: float) -> str:
    """Return what a step of a tolerance does to a parameter, ``each 10 mm raises it by 6 %``."""
    size, text = step(tolerance)
    change = 100.0 * expm1(effect * size / tolerance.std)
    return f"each {text} {'raises' if change > 0.0 else 'lowers'} it by {abs(change):.2g} %"


def objection_sentences(a: Answers) -> list[str]:
    """Return what the model does not explain, and what would explain it; nothing where chance does."""
    if a.scrutiny is None or a.scrutiny.objection is None or not a.scrutiny.objects:
        return []
    o, labels = a.scrutiny.objection, {m.number: m.label for m in a.modes}
    worst = sorted((c for c in o.checks if c.objects), key=lambda c: -abs(c.miss) / c.std)[:_NAMED]
    said = []
    for check in worst:
        letter, number = check.datum[0], check.datum[1:].partition(" ")[0]
        label = labels.get(int(number), f"mode {number}") if number.isdigit() else check.datum
        what = "damping" if letter == "ζ" else "frequency"
        side = "above" if check.miss > 0.0 else "below"
        said.append(
            f"{words(label)}'s {what} is {100 * abs(check.miss):.2g} % {side} what the other modes allow "
            f"(± {100 * check.std:.2g} %)"
        )
    together = "the measured modes together are farther from any model within the tolerances than chance goes"
    lead = f"Not explained: {listed(said) if said else together}"
    by = [f"{e.tolerance.words} {size_words(e.tolerance, e.size)}" for e in o.explanations]
    return [f"{lead}.", f"What would explain most of it: {', or '.join(by)}." if by else ""]


def condition_headline(a: Answers) -> str:
    """Return what the ground's answer hangs on; nothing where every tolerance is settled."""
    s = a.scrutiny
    if s is None or not s.influences:
        return ""
    by_name = {g.name: i for i, g in enumerate(a.ground)}
    for condition in s.conditions:
        if condition.parameter in by_name:
            t = condition.tolerance
            return (
                f"{parameter_words(condition.parameter).capitalize()} is known if {_as_stated(t)}: "
                f"{moved_words(t, condition.effect)}; to settle it, {t.settled_by}."
            )
    moved = [_most(a, i, g) for i, g in enumerate(a.ground) if g.verdict == "identified"]
    return next((text for text in moved if text), "")


def _as_stated(t: Tolerance) -> str:
    return "there is no marine growth" if t.name == "growth" else f"the {t.words} is as stated"


def _most(a: Answers, i: int, g: GroundAnswer) -> str:
    """Return which tolerance moves a parameter most, as far as its interval allows for it."""
    if a.scrutiny is None:
        return ""
    first = a.scrutiny.movers(i)[0]
    effect = float(first.effect[i])
    if abs(effect) < _FELT:
        return ""
    return (
        f"Allowed for in that, most by the {first.tolerance.words}: {moved_words(first.tolerance, effect)} "
        f"({parameter_words(g.name)})."
    )


def unseen_sentence(a: Answers) -> str:
    """Return what may be wrong with the structure and would not show in these data."""
    if a.scrutiny is None or a.scrutiny.objection is None:
        return ""
    unseen = [t.words for t in a.scrutiny.objection.unseen]
    return f"These data would not show {listed(unseen)}." if unseen else ""
