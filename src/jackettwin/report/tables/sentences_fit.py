"""The fit in words: whether the updated model meets its data, and what to do where it cannot."""

from __future__ import annotations

from jackettwin.answers import Answers, Span
from jackettwin.answers.result import FitAnswer
from jackettwin.report.tables.numbers import count, digits_of, listed, quantity, words
from jackettwin.soil import parameter_words

_NAMED = 2
"""Modes that a sentence names: the table has all."""
_BEST = 4
"""Parameters of the best fit that the headline names."""
_RARE = 1e-6
"""Probability below which a fit is no longer given odds."""


def fit_sentence(fit: FitAnswer) -> str:
    """Return whether the updated model meets its data."""
    size = f"χ² {fit.chi2:.3g} at {count(fit.freedom, 'degree')} of freedom"
    if fit.fits:
        return f"Updated, it meets the data as well as chance lets a true model ({size})."
    odds = "less than once in a million" if fit.probability < _RARE else f"once in {1 / fit.probability:.2g}"
    return f"No: updated, {_off(fit)} ({size}; for a true model {odds})."


def misfit_headline(a: Answers) -> list[str]:
    """Return what the headline begins with if the model cannot meet the data; nothing if it can."""
    if a.fit is None or a.fit.fits:
        return []
    best = [f"{parameter_words(g.name)} {value_words(g.value, g.unit)}" for g in a.ground[:_BEST]]
    return [
        f"The model cannot meet what was measured on any ground: {_off(a.fit)}.",
        f"The nearest fit has {listed(best)}; how far that is off is not known.",
        f"{mend(a.fit)}.",
    ]


def value_words(span: Span, unit: str) -> str:
    """Return the value with as many digits as its interval has, so that it reads the same everywhere."""
    digits = 2 if span.low is None or span.high is None else digits_of(span.low, span.high)
    return quantity(span.value, unit, digits=digits)


def mend(fit: FitAnswer) -> str:
    """Return what to do about a model that cannot meet the data."""
    what = "Mend the model first (nacelle, marine growth, water in legs, wall thicknesses), or state "
    if fit.cover is None:
        return f"{what}under update.model_error how far it may be off"
    return f"{what}its error: {100 * fit.cover:.2g} % on frequencies (update.model_error) would cover this"


def _off(fit: FitAnswer) -> str:
    """Return the frequencies with the largest error; if the fit meets them all, the damping."""
    if not fit.fits and fit.cover is None:
        return "the damping does not fit"
    worst = list(fit.off.items())[:_NAMED]
    return listed([f"{words(m)} is {100 * abs(d):.1f} % {'high' if d > 0 else 'low'}" for m, d in worst])
