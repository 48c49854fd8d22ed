"""Sentences on what to measure next, and what that would narrow."""

from __future__ import annotations

from jackettwin.answers import Answers
from jackettwin.answers.result import NextStep
from jackettwin.constants import YEAR_DAYS
from jackettwin.report.tables.numbers import count, factor, listed, words
from jackettwin.report.tables.sentences_fit import mend
from jackettwin.soil import parameter_words

_LONG_DAYS = 36_525.0
"""Length of records beyond which this length is named instead: a hundred years."""
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


def data_words(a: Answers) -> str:
    """Return what was measured: ``these 5 records``, or ``these targets``."""
    return f"these {a.records} records" if a.records > 1 else "this record" if a.records else "these targets"


def next_headline(a: Answers) -> str:
    """Return the sentence of the headline on the best next measurement, empty if none is known."""
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


def next_steps(a: Answers) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return what to measure next: what the first page says, and what follows later."""
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
