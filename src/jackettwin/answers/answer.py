"""From a run's result to the answers of its first page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from jackettwin.answers.fit import fit_answer
from jackettwin.answers.ground_average import averaged_ground
from jackettwin.answers.next_steps import next_steps, records_for
from jackettwin.answers.result import (
    Answers,
    Clearance,
    GroundAnswer,
    LawAnswer,
    ModeAnswer,
    Span,
)
from jackettwin.arrays import FloatArray
from jackettwin.constants import DAY_S
from jackettwin.intervals import NORMAL_90, interval_90
from jackettwin.soil import Parameter, families, law_parameter
from jackettwin.study import MeasuredMode, Scrutiny, TwinResult
from jackettwin.updating import (
    SOURCES,
    USABLE,
    Update,
    approximate_probability,
    law_probability,
    recommended,
)

PRECISION = 0.2
"""A damping ratio known to ± so much (90 %) tells a design with half a per cent more from one without."""
_DESIGNS = 100
"""Draws of the prior that the design's frequencies are made of: their 5 % quantile to some tenth of a σ."""
_STRANGERS = ("c_fore_aft", "c_side_side", "water_", "rayleigh_")
"""Names of what is updated beside the ground."""


def answer(result: TwinResult) -> Answers:
    """Return what a run says to the five questions of its first page."""
    u = recommended(result.updates)
    laws, source = _laws(result.updates)
    number, seconds = result.extent
    days = seconds / DAY_S
    ground = () if u is None else tuple(_ground(u))
    open_ = [g.name for g in ground if g.verdict in ("weak", "unidentified")]
    speed = result.rotor_speed_hz
    modes = _modes(result, u)
    fit = None if u is None else fit_answer(u, result.measured, modes)
    return Answers(
        law="" if u is None else u.law,
        laws=laws,
        probability_from=source,
        modes=modes,
        clearances=() if speed is None else tuple(_clearances(modes, speed, result.blades)),
        rotor_speed_hz=speed,
        rotor_state=result.rotor_state,
        wind_m_s=result.wind_m_s,
        blades=result.blades,
        ground=ground,
        next_steps=()
        if u is None or not (fit is None or fit.fits)  # what a wrong model would learn is not known
        else next_steps(u, result.measured, open_, result.labels, days=days),
        records=number,
        minutes=days * 1440.0,
        records_for=records_for(result.measured, number, PRECISION),
        precision=PRECISION,
        scrutiny=_scrutiny(result, u),
        usable=USABLE,
        fit=fit,
        averaged=averaged_ground(
            result.updates, {law.law: law.probability for law in laws if law.probability is not None}
        ),
    )


def _scrutiny(result: TwinResult, u: Update | None) -> Scrutiny | None:
    """Return what stands behind the fit of a law."""
    if u is None or not result.scrutiny:
        return None
    return result.scrutiny[[other is u for other in result.updates].index(True)]


def _laws(updates: Sequence[Update]) -> tuple[tuple[LawAnswer, ...], str]:
    """Return every law with its probability, and where the probabilities are from."""
    exact = law_probability(updates) if updates else None
    probability = exact or approximate_probability(updates)
    found = tuple(
        LawAnswer(
            u.law,
            None if u.best.locked_damper else probability.get(u.law),
            float(u.best.cost),
            u.best.locked_damper,
            u.uncertainty is not None,
        )
        for u in updates
    )
    return found, "evidence" if exact else "approximation" if probability else ""


def _modes(result: TwinResult, u: Update | None) -> tuple[ModeAnswer, ...]:
    design = {} if u is None else _design(u)
    return tuple(
        ModeAnswer(
            label=m.label,
            number=m.mode,
            measured_hz=Span.of(m.frequency_hz, m.frequency_std_hz),
            measured_damping=Span.of(m.damping_ratio, m.damping_ratio_std),
            fits_frequency=m.fits_frequency,
            fits_damping=m.fits_damping,
            design_hz=design.get(m.mode),
            rigid_hz=float(result.numbered.frequency_hz[m.mode - 1]),
            model_hz=None if u is None else _model_hz(u, i, m),
            model_damping=None if u is None else _model_damping(u, i, m),
            sources={} if u is None else _sources(u, i),
            model_error=0.0 if u is None else _model_error(u, m),
            open_dashpot="" if u is None else u.open_dashpot(m.label),
        )
        for i, m in enumerate(result.measured)
    )


def _model_error(u: Update, m: MeasuredMode) -> float:
    """Return by how much, relative, the model may miss a frequency: all its tolerances and its remainder."""
    errors = u.problem.error_model
    if errors is None:
        return 0.0
    theta = u.problem.vectors(np.log(u.best.theta)[None], u.problem.states[0])
    found = u.model.predict_many(theta, (m.mode,), slopes=False)
    if np.isnan(found.poles).any():
        return 0.0
    shift = errors.on(u.model.condensed).shifts(found)[0, 0, 0]
    return float(np.hypot(np.linalg.norm(shift), errors.own(f"f{m.mode}")))


def _model_hz(u: Update, i: int, m: MeasuredMode) -> Span | None:
    q = None if u.uncertainty is None else u.uncertainty.predictive
    draws = None if q is None or m.mode not in q.modes else q.frequency_hz[:, q.modes.index(m.mode)]
    return _span(draws, float(u.central_hz[i]))


def _model_damping(u: Update, i: int, m: MeasuredMode) -> Span | None:
    q = None if u.uncertainty is None else u.uncertainty.predictive
    draws = None if q is None or m.mode not in q.modes else q.damping_ratio[:, q.modes.index(m.mode)]
    return _span(draws, float(u.central_damping[i]))


def _span(draws: FloatArray | None, best: float) -> Span | None:
    """Return the median of draws with its interval, else the best fit; None for a mode there is not."""
    known = None if draws is None else interval_90(draws)
    if known is not None:
        low, middle, high = known
        return Span(middle, low, high)
    return None if np.isnan(best) else Span(best)


def _design(u: Update) -> dict[int, Span]:
    """Return what frequencies the priors of the ground's stiffness allow; nothing if one of them is flat."""
    stiff = [p for p in u.problem.parameters if _kind(p) == "stiffness"]
    if u.problem.relative or not stiff or any(p.median is None for p in stiff):
        return {}
    z = u.problem.prior.draw(_DESIGNS, np.random.default_rng(0))
    state = u.problem.states[0]
    middle = np.log([p.median or np.sqrt(p.low * p.high) for p in u.problem.parameters])
    loose = [_kind(p) != "stiffness" for p in u.problem.parameters]
    z[:, loose] = middle[loose]  # what damps moves no frequency of a design
    near = u.model.predict_many(u.problem.vectors(middle[None], state), u.shown, slopes=False)
    start = None if np.isnan(near.poles).any() else near
    found = u.model.predict_many(u.problem.vectors(z, state), u.shown, near=start, slopes=False)
    at, spread = np.abs(near.poles[0]) / (2.0 * np.pi), np.abs(found.poles) / (2.0 * np.pi)
    spans = {mode: _span(spread[:, i], float(at[i])) for i, mode in enumerate(u.shown)}
    return {mode: span for mode, span in spans.items() if span is not None}


def _sources(u: Update, i: int) -> dict[str, Span]:
    """Return each source's part of a mode's damping; sources that damp no mode are not modelled."""
    b, found = u.budget, {}
    for s in range(b.damping_ratio.shape[1]):
        value = float(b.damping_ratio[i, s])
        if np.isnan(value) or not np.nanmax(np.abs(b.damping_ratio[:, s])) > 0.0:
            continue
        interval = b.damping_ratio_interval_90
        low, high = (None, None) if interval is None else map(float, interval[i, s])
        found[SOURCES[s]] = Span(value, low, high)
    return found


def _kind(p: Parameter) -> Literal["stiffness", "damping", ""]:
    """Return what of the ground a parameter is; nothing for one of the rotor, the water or the steel."""
    if p.name.startswith(_STRANGERS):
        return ""
    # k1 of Zener's law is a part of what damps
    stiff = law_parameter(p.name) in {law.names[0] for law in families().values()}
    return "stiffness" if stiff else "damping"


def _ground(u: Update) -> Sequence[GroundAnswer]:
    found, known = [], u.uncertainty
    for j, p in enumerate(u.problem.parameters):
        kind = _kind(p)
        if not kind:
            continue
        value, verdict, factor, reason = Span(float(u.best.theta[j])), "", None, ""
        if known is not None:
            low, high = map(float, known.interval_90[j])
            value = Span(float(known.median[j]), low, high)
            v = known.verdicts[j]
            verdict, factor, reason = v.verdict, v.interval_factor, v.reason
        found.append(GroundAnswer(p.name, p.unit, kind, value, _before(p), verdict, factor, reason))
    return found


def _before(p: Parameter) -> Span | None:
    if p.median is None or p.log_std is None:
        return None
    factor = float(np.exp(NORMAL_90 * p.log_std))
    return Span(p.median, max(p.low, p.median / factor), min(p.high, p.median * factor))


def _clearances(modes: Sequence[ModeAnswer], speed_hz: tuple[float, float], blades: int) -> list[Clearance]:
    """Return how far each measured frequency stays from the speeds of the rotor and of its blades."""
    found = []
    for mode in modes:
        if mode.measured_hz is None:
            continue
        for multiple in (1, blades):
            low, high = multiple * speed_hz[0], multiple * speed_hz[1]
            below, above = (
                mode.measured_hz.low or mode.measured_hz.value,
                (mode.measured_hz.high or mode.measured_hz.value),
            )
            # the farther side counts: a mode below a band is judged by its upper end
            margin = max(below / high - 1.0, 1.0 - above / low)
            found.append(Clearance(mode.label, f"{multiple}P", low, high, margin))
    return found
