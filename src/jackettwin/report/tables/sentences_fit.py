"""Sentences on the fit: whether the updated model agrees with its data, and what to do if it does not."""

from __future__ import annotations

from jackettwin.answers import Answers, Span
from jackettwin.answers.result import FitAnswer
from jackettwin.report.tables.numbers import count, digits_of, listed, quantity, words
from jackettwin.soil import parameter_words

_NAMED = 2
"""Largest number of modes in a sentence; the table has all."""
_BEST = 4
"""Largest number of parameters of the best fit in the headline."""
_RARE = 1e-6
"""Probability below which no odds are stated."""


def fit_sentence(fit: FitAnswer) -> str:
    """Return whether the updated model agrees with its data."""
    size = f"χ² {fit.chi2:.3g} at {count(fit.freedom, 'degree')} of freedom"
    if fit.fits:
        return f"The updated model agrees with the data within their uncertainty ({size})."
    odds = "less than once in a million" if fit.probability < _RARE else f"once in {1 / fit.probability:.2g}"
    return f"No: in the updated model {_off(fit)} ({size}; for a correct model this occurs {odds})."


def misfit_headline(a: Answers) -> list[str]:
    """Return the first sentences of the headline if the model does not agree with the data, else nothing."""
    if a.fit is None or a.fit.fits:
        return []
    best = [f"{parameter_words(g.name)} {value_words(g.value, g.unit)}" for g in a.ground[:_BEST]]
    return [
        f"The model cannot reproduce the measurements on any ground: {_off(a.fit)}.",
        f"The best fit has {listed(best)}; its error is not known.",
        f"{mend(a.fit)}.",
    ]


def value_words(span: Span, unit: str) -> str:
    """Return the value with as many digits as its interval, so that it is the same everywhere."""
    digits = 2 if span.low is None or span.high is None else digits_of(span.low, span.high)
    return quantity(span.value, unit, digits=digits)


def mend(fit: FitAnswer) -> str:
    """Return what to do about a model that does not agree with the data."""
    what = "Correct the model first (nacelle, marine growth, water in legs, wall thicknesses), or state its "
    if fit.cover is None:
        return f"{what}error under update.model_error"
    return f"{what}error: {100 * fit.cover:.2g} % of frequencies (update.model_error) would cover this"


def _off(fit: FitAnswer) -> str:
    """Return the frequencies with the largest errors, or the damping if all frequencies agree."""
    if not fit.fits and fit.cover is None:
        return "the damping does not agree"
    worst = list(fit.off.items())[:_NAMED]
    return listed([f"{words(m)} is {100 * abs(d):.1f} % too {'high' if d > 0 else 'low'}" for m, d in worst])
