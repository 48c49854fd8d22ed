"""Fit of the updated model to the measurements, and the model error that would cover the deviations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import exp, log

import numpy as np
from scipy.optimize import brentq

from jackettwin.answers.result import FitAnswer, ModeAnswer
from jackettwin.study import MeasuredMode
from jackettwin.updating import Residuals, Target, Update, misfit

_LARGEST = 1.0
"""Relative error up to which one that covers the misfit is sought: beyond it the model says nothing."""
OFF = 0.01
"""Relative error of all frequencies of a model whose effect on the ground is told."""


def fit_answer(u: Update, measured: Sequence[MeasuredMode], modes: Sequence[ModeAnswer]) -> FitAnswer | None:
    """Return how the best fit meets its data; None where they carry no standard deviations."""
    found = misfit(u.problem, u.best.theta)
    if found is None:
        return None
    off, stds = {}, {}
    for i, (m, mode) in enumerate(zip(measured, modes, strict=True)):
        model_hz = float(u.modes.frequency_hz[i])
        if m.fits_frequency and m.frequency_hz and m.frequency_std_hz and model_hz > 0.0:
            off[m.label] = model_hz / m.frequency_hz - 1.0
            stds[m.label] = float(np.hypot(m.frequency_std_hz / m.frequency_hz, mode.model_error))
    ranked = dict(sorted(off.items(), key=lambda item: -abs(item[1]) / stds[item[0]]))
    cover = None if found.fits else _cover([*off.values()], [*stds.values()])
    moved = moved_by(u, OFF)
    return FitAnswer(found.chi2, found.freedom, found.probability, found.fits, ranked, cover, moved)


def _cover(off: Sequence[float], stds: Sequence[float]) -> float | None:
    """Return the relative error of the model with which the frequencies deviate as chance has it.

    None where they do already (it is the damping that is missed) or no error up to all of the value does.
    """
    squares = np.array([log(1.0 + d) ** 2 for d in off])
    own = np.array(stds) ** 2
    wanted = max(len(off) - 1, 1)  # at least one stiffness was fitted to them

    def excess(error: float) -> float:
        return float((squares / (own + error**2)).sum()) - wanted

    if not len(off) or excess(0.0) <= 0.0 or excess(_LARGEST) >= 0.0:
        return None
    return float(brentq(excess, 0.0, _LARGEST))


def moved_by(u: Update, error: float) -> Mapping[str, float]:
    """Return by how much, in ln θ, each parameter errs if the model's frequencies are all too high.

    To first order at the best fit: Δ ln θ = −(JᵀJ)⁻¹Jᵀ Δr, Δr the change of the residuals. No interval
    holds it unless the twin states an error of the model as large. Nothing where the fit cannot be evaluated
    again.
    """
    z, problem = np.log(u.best.theta), u.problem
    states = tuple(
        replace(state, residuals=replace(state.residuals, targets=_lower(state.residuals, error)))
        for state in problem.states
    )
    r, J, near = problem.evaluate(z, None)
    moved, _, found = replace(problem, states=states).evaluate(z, near)
    if near is None or found is None:
        return {}
    step = -np.linalg.lstsq(J, moved - r, rcond=None)[0]
    return {p.name: float(d) for p, d in zip(problem.parameters, step, strict=True)}


def _lower(residuals: Residuals, error: float) -> tuple[Target, ...]:
    """Return targets as a model without the error would need to meet them."""
    return tuple(
        t if t.frequency_hz is None else replace(t, frequency_hz=t.frequency_hz * exp(-error))
        for t in residuals.targets
    )
