"""Choice of the reported modes: refined sure candidates, and doubtful ones needed to explain the spectrum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.estimate import Rejected
from jackettwin.identification.maximum_likelihood.fits import FitStart, accepted_fits, not_refined
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.identification.maximum_likelihood.periodogram import MIN_CYCLES
from jackettwin.identification.mode_shapes import mac, normalised
from jackettwin.identification.preparation.gaps import side_by_side, stretches
from jackettwin.identification.preparation.resolve import guarded_band_hz
from jackettwin.identification.preparation.whitening import left_to_differentiate
from jackettwin.identification.selection.candidates import (
    beside_orders,
    beside_tones,
)
from jackettwin.identification.selection.neighbours import apart, members_of_pairs
from jackettwin.identification.selection.screening import (
    LINES_OF_A_PEAK,
    perhaps_two,
    screen,
    with_unknown_damping,
    worth_keeping,
)
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.tones.envelopes import is_suspiciously_steady
from jackettwin.identification.tones.mains import is_mains
from jackettwin.identification.tones.sinusoid import transform
from jackettwin.identification.tones.skirts import LESS_LIKELY, are_orders, missing_skirts, peak_near

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from jackettwin.identification.estimate import ModalEstimate, ResolvedSettings
    from jackettwin.identification.maximum_likelihood.band_fit import BandFit
    from jackettwin.identification.preparation.prepared_record import PreparedRecord
    from jackettwin.identification.selection.candidates import Candidate, Tones
    from jackettwin.identification.selection.screening import Evidence
    from jackettwin.identification.settings import IdentificationSettings


MIN_LIMIT_SHARE = 0.8
"""Smallest standard deviations, over the long-data limits.
The ratios between many channels of low noise contain more information than the lines of a peak: for ten modes
in eight channels the Cramér-Rao bound is 0.79 of the limit."""
HINT_ORDER_SHARE = 0.25
"""Share of the model orders in which a rejected candidate must appear for a finding to mention it."""
SAME_SHAPE = 0.8
"""MAC above which a pole is the same mode as its neighbour."""
SAME_CANDIDATE = 1e-3
"""Relative distance of frequencies within which a rejected candidate is the mode that was restored."""
CLOSE_PAIR = 1.0
"""Distance of two modes, over the sum of their half bandwidths, within which the subspace method confuses
their damping."""
PAIR_WIDENING = 1.6
"""Factor on the damping uncertainty of a close pair that no fit describes, since forces are not smooth.
For 75 such modes of simulated jackets in waves the errors of ln ζ were 1.55 times their standard deviations;
for 50 modes farther apart, 1.16 times."""
LOST_LINES = 0.75
"""Distance from a subtracted tone, in lines, within which lines contain no other motion any more."""


@dataclass(frozen=True)
class Choice:
    """Modes by ascending frequency, the candidate of each, rejected poles, and findings."""

    modes: tuple[ModalEstimate, ...]
    candidate: tuple[int, ...]
    rejected: tuple[Rejected, ...]
    findings: tuple[Finding, ...]


def chosen_modes(
    judged: Sequence[Candidate],
    tones: Tones,
    ready: PreparedRecord,
    settings: IdentificationSettings,
    lines: ComplexArray | None = None,
) -> Choice:
    """Refine the candidates and return those that are modes inside the band.

    ``lines`` are the transforms of the samples without tones if they are known.
    """
    y, scale, resolved = tones.clean, ready.scale, ready.settings
    duration_s = y.shape[1] / resolved.sample_rate_hz
    open_to = [i for i, c in enumerate(judged) if c.objection is None]
    sure = np.array([judged[i].doubt is None for i in open_to], dtype=bool)
    findings: tuple[Finding, ...] = ()
    modes = {i: judged[i].mode for i, certain in zip(open_to, sure, strict=True) if certain}
    if settings.refine and sure.any():
        shortest = int(MIN_CYCLES / resolved.lowest_frequency_hz * resolved.sample_rate_hz) + 1
        parts = stretches(y, shortest)
        if not parts:
            f = np.array([mode.frequency_hz for mode in modes.values()])
            findings = (not_refined(f, "gaps remain in the record"),)
        else:
            start = _start([judged[i].mode for i in open_to], sure, ready, tones, settings)
            band = guarded_band_hz(resolved)
            whole = side_by_side(y, parts)
            fits, findings = accepted_fits(whole, resolved.sample_rate_hz, band, start)
            for fit in fits:
                for position in np.flatnonzero(fit.candidates):
                    modes.pop(open_to[position], None)
                fitted_s = whole.shape[1] / resolved.sample_rate_hz
                modes |= _refined_modes(judged, open_to, fit.modes, scale, fitted_s)
    tones_hz = [(f, f) for f in (*tones.steady_hz, *ready.tones_hz)]
    tones_hz += [tone.swept_hz for tone in tones.drifting]
    found = _sorted(judged, modes, tones_hz, resolved, settings, findings)
    flagged = (beside_orders(mode, ready.rotor_orders) for mode in found.modes)
    lines = transform(y, np.complex64) if lines is None else lines
    flagged_modes = tuple(flagged)
    pairs = members_of_pairs(flagged_modes, ready.channels)
    steady = (
        mode if i in pairs else _steady(mode, lines, duration_s, scale)
        for i, mode in enumerate(flagged_modes)
    )
    few = (_widened(mode, judged[i].widening) for mode, i in zip(steady, found.candidate, strict=True))
    found = replace(found, modes=tuple(few))
    if settings.refine:
        found = replace(found, findings=(*found.findings, *_hidden(judged, found)))
        found = replace(found, modes=tuple(_widen_close_pair(m, found.modes) for m in found.modes))
    return replace(found, rejected=(*found.rejected, *_tones(ready, resolved)))


def _widen_close_pair(mode: ModalEstimate, modes: Sequence[ModalEstimate]) -> ModalEstimate:
    """Widen the damping interval of a mode that is close to another and that no fit describes."""
    beside = (apart(mode, other) for other in modes if other is not mode)
    if mode.unrefined is not None or mode.log_covariance is None or min(beside, default=np.inf) > CLOSE_PAIR:
        return mode
    return _widened(mode, (1.0, PAIR_WIDENING))


def _widened(mode: ModalEstimate, factors: tuple[float, float]) -> ModalEstimate:
    """Multiply the standard deviations of ln f and ln ζ of a mode that no fit describes."""
    if mode.unrefined is not None or mode.log_covariance is None:
        return mode
    return mode.with_covariance(mode.log_covariance * np.outer(factors, factors))


def _steady(mode: ModalEstimate, lines: ComplexArray, duration_s: float, scale: FloatArray) -> ModalEstimate:
    """Flag a mode whose envelope is as steady as that of a tone."""
    shape = mode.mode_shape / scale
    if not is_suspiciously_steady(lines, duration_s, mode.frequency_hz, mode.damping_ratio, shape):
        return mode
    return mode.flagged(ModeStatus.DOUBTFUL, Finding("steady_envelope"))


def _skirted(modes: Sequence[ModalEstimate], known: Evidence) -> tuple[ModalEstimate, ...]:
    """Flag modes whose peaks fall off faster than those of any mode, and others at multiples of them.

    Clear peaks that belong to no mode are not flagged, but modes may lie at a multiple of them.
    """
    reach_hz = LINES_OF_A_PEAK / known.duration_s
    alone = [
        peak_near(known.lines, known.duration_s, peak, reach_hz)
        for peak in known.peaks_hz
        if not any(abs(m.frequency_hz - peak) < reach_hz + m.damping_ratio * peak for m in modes)
    ]
    peaks = [*((m.frequency_hz, m.damping_ratio, m.mode_shape / known.scale) for m in modes), *alone]
    f, zeta = (np.array([peak[column] for peak in peaks]) for column in (0, 1))
    missing = np.array([
        missing_skirts(known.lines, known.duration_s, *peak, np.delete(f, i)) for i, peak in enumerate(peaks)
    ], dtype=float)  # fmt: skip
    found = []
    multiples = are_orders(f, zeta, missing, len(known.scale)) & (not known.speed_known)
    for mode, order, multiple in zip(modes, missing > LESS_LIKELY, multiples, strict=False):
        if order or multiple:
            code = "no_skirts" if order else "multiple_of_order"
            mode = mode.flagged(ModeStatus.DOUBTFUL, Finding(code))
        found.append(mode)
    return tuple(found)


def clear_damping_doubts(judged: Sequence[Candidate], known: Evidence) -> list[Candidate]:
    """Clear the doubt about candidates whose damping is uncertain but which are otherwise modes.

    A fit may then determine their damping.
    """
    out = list(judged)
    sure = [c.mode for c in judged if c.objection is None and c.doubt is None]
    for i, c in enumerate(judged):
        if c.objection is None and c.doubt is not None and worth_keeping(c.mode, sure, known):
            out[i] = replace(c, doubt=None)
            sure.append(c.mode)
    return out


def screened_choice(
    chosen: Choice,
    judged: Sequence[Candidate],
    known: Evidence,
    *,
    tones: Tones,
    rescue: bool = True,
) -> Choice:
    """Assign statuses to the modes, restore those of known frequency, drop those that are no modes.

    Parameters
    ----------
    tones : Tones
        Tones already subtracted: a peak where a drifting one crossed is a mode or the residual of the tone,
        and what is left of a peak at a steady one is no measure of its width.
    rescue : bool
        Whether modes are restored.
    """
    found = dict(zip(chosen.candidate, chosen.modes, strict=True))
    restored: dict[int, ModalEstimate] = {}
    steady = [(f, f) for f in tones.steady_hz]
    rejected = list(chosen.rejected)
    for i, c in enumerate(judged if rescue else ()):
        f = c.mode.frequency_hz
        passing = next((tone for tone in tones.drifting if tone.passes(f)), None) if c.is_tone else None
        if i in found or (c.objection is not None and passing is None) or not known.inside(f):
            continue
        if worth_keeping(c.mode, [*found.values(), *restored.values()], known):
            rejected = [r for r in rejected if not _about(r, c.mode)]
            ranges = steady if passing is None else [passing.swept_hz]
            mode = beside_tones(c.mode, ranges)
            restored[i] = with_unknown_damping(mode) if passing is None else mode
    # an order of unknown damping betrays the one at twice its frequency
    skirted = _skirted((*chosen.modes, *restored.values()), known)
    own, beside = skirted[: len(chosen.modes)], skirted[len(chosen.modes) :]
    judged_modes = screen(own, known, beside=beside)
    modes = dict(zip((*chosen.candidate, *restored), (*judged_modes, *beside), strict=True))
    forced = {i: m for i, m in modes.items() if not m.status.is_a_mode}
    order = sorted((i for i in modes if i not in forced), key=lambda i: modes[i].frequency_hz)
    left_out = [
        Rejected(m.frequency_hz, m.damping_ratio, m.status_reason or "", m.status) for m in forced.values()
    ]
    kept = tuple(modes[i] for i in order)
    said = {f.params["frequency_hz"] for f in chosen.findings if f.code == "hidden_mode"}
    two = (f for f in perhaps_two(kept, known) if f.params["frequency_hz"] not in said)
    return replace(
        chosen,
        findings=(*chosen.findings, *two),
        modes=kept,
        candidate=tuple(order),
        rejected=(*left_out, *rejected),
    )


def _about(refused: Rejected, mode: ModalEstimate) -> bool:
    """Tell whether a rejected candidate is a restored mode, whose frequency refinement may have changed."""
    return abs(refused.frequency_hz / mode.frequency_hz - 1.0) < SAME_CANDIDATE


def _start(
    modes: list[ModalEstimate],
    sure: BoolArray,
    ready: PreparedRecord,
    tones: Tones,
    settings: IdentificationSettings,
) -> FitStart:
    return FitStart(
        frequency_hz=np.array([m.frequency_hz for m in modes]),
        damping_ratio=np.array([m.damping_ratio for m in modes]),
        log_damping_std=np.array([_log_damping_std(m) for m in modes]),
        shapes=np.array([m.mode_shape.real for m in modes]) / ready.scale,
        sure=sure,
        derivatives=left_to_differentiate(ready.channels, ready.differentiated),
        avoid_hz=(
            *(tone.disturbed_hz for tone in tones.drifting),
            *(_lost_hz(f, ready.duration_s) for f in ready.tones_hz),
        ),
        max_damping_ratio=settings.max_damping_ratio,
    )


def _log_damping_std(mode: ModalEstimate) -> float:
    return 0.0 if mode.log_covariance is None else float(np.sqrt(mode.log_covariance[1, 1]))


def _lost_hz(tone_hz: float, duration_s: float) -> tuple[float, float]:
    """Return the range of lines lost with a tone [Hz]: the nearest one, or two if it lies between them."""
    return tone_hz - LOST_LINES / duration_s, tone_hz + LOST_LINES / duration_s


def _refined_modes(
    judged: Sequence[Candidate], open_to: list[int], refined: BandFit, scale: FloatArray, duration_s: float
) -> dict[int, ModalEstimate]:
    """Return the refined modes by candidate."""
    out = {}
    for k, position in enumerate(refined.candidate):
        index = open_to[position]
        f, zeta = float(refined.frequency_hz[k]), float(refined.damping_ratio[k])
        limits = long_data_limits(f, zeta, duration_s)
        lift = np.maximum(MIN_LIMIT_SHARE * limits / np.sqrt(np.diag(refined.covariance[k])), 1.0)
        shape = refined.shapes[k] * scale
        top = int(np.argmax(np.abs(shape)))
        relative = shape / shape[top]
        jacobian = np.diag(scale) - np.outer(relative, scale * (np.arange(len(shape)) == top))
        spread = jacobian @ refined.shape_covariance[k] @ jacobian.T / shape[top] ** 2
        mode = replace(
            judged[index].mode,
            frequency_hz=f,
            damping_ratio=zeta,
            mode_shape=normalised(shape.astype(complex)),
            mode_shape_std=np.sqrt(np.maximum(np.diag(spread), 0.0)),
            method="maximum likelihood",
            unrefined=judged[index].mode,
            cramer_rao_log_std=refined.cramer_rao[k],
            damping_ratio_cov_limit=float(limits[1]),
        )
        out[index] = mode.with_covariance(refined.covariance[k] * np.outer(lift, lift))
    return out


def _sorted(
    judged: Sequence[Candidate],
    modes: dict[int, ModalEstimate],
    tones_hz: Collection[tuple[float, float]],
    resolved: ResolvedSettings,
    settings: IdentificationSettings,
    findings: tuple[Finding, ...],
) -> Choice:
    """Drop modes outside the band or with too uncertain damping, and sort by frequency."""
    rejected = {i: c.rejected for i, c in enumerate(judged) if i not in modes}
    for i, refused in rejected.items():
        if not refused.reason:
            rejected[i] = replace(refused, reason="the spectrum is explained as well without it")
    kept = {}
    for i, mode in modes.items():
        reason = _late_objection(mode, resolved, settings)
        if reason is None:
            kept[i] = beside_tones(mode, tones_hz)
        else:
            rejected[i] = Rejected(mode.frequency_hz, mode.damping_ratio, reason)
    order = sorted(kept, key=lambda i: kept[i].frequency_hz)
    return Choice(
        modes=tuple(kept[i] for i in order),
        candidate=tuple(order),
        rejected=tuple(rejected[i] for i in sorted(rejected)),
        findings=findings,
    )


def _tones(ready: PreparedRecord, resolved: ResolvedSettings) -> list[Rejected]:
    low, high = guarded_band_hz(resolved)
    steady, drifting = "steady tone: one line of the periodogram; taken out", "drifting tone; taken out"
    found = [(f, steady) for f in ready.tones_hz]
    found += [(0.5 * sum(tone.swept_hz), drifting) for tone in ready.drifting]
    inside = [(f, reason) for f, reason in sorted(found) if low < f < high]
    return [Rejected(f, None, reason, _kind_of_tone(f, reason == steady, ready)) for f, reason in inside]


def _kind_of_tone(frequency_hz: float, steady: bool, ready: PreparedRecord) -> ModeStatus:
    mains = steady and is_mains(frequency_hz, ready.recorded_hz, ready.duration_s)
    return ModeStatus.ELECTRICAL if mains else ModeStatus.TONE


def _hidden(judged: Sequence[Candidate], found: Choice) -> list[Finding]:
    """Report rejected poles that may be the other mode of a close pair, at the nearest mode.

    Only modes that no fit describes are considered: otherwise the spectrum needs no further mode.
    """
    out: dict[float, Finding] = {}
    for i, c in enumerate(judged):
        near = [m for m in found.modes if _overlap(c.mode, m)]
        alike = [float(mac(c.mode.mode_shape, m.mode_shape)) for m in near]
        known = i in found.candidate or c.is_tone or c.cluster.order_share < HINT_ORDER_SHARE
        if known or not near or max(alike) > SAME_SHAPE or any(m.unrefined is not None for m in near):
            continue
        mode = min(near, key=lambda m: abs(m.frequency_hz - c.mode.frequency_hz))
        where = {"frequency_hz": mode.frequency_hz, "other_hz": c.mode.frequency_hz}
        out[mode.frequency_hz] = Finding("hidden_mode", params=where)
    return list(out.values())


def _overlap(a: ModalEstimate, b: ModalEstimate) -> bool:
    half = a.damping_ratio * a.frequency_hz + b.damping_ratio * b.frequency_hz
    return abs(a.frequency_hz - b.frequency_hz) < half


def _late_objection(
    mode: ModalEstimate, resolved: ResolvedSettings, settings: IdentificationSettings
) -> str | None:
    if not resolved.lowest_frequency_hz < mode.frequency_hz < resolved.highest_frequency_hz:
        return "outside the band"
    if mode.log_covariance is not None and mode.log_covariance[1, 1] > settings.max_damping_cov**2:
        return (
            f"damping uncertain by {np.sqrt(mode.log_covariance[1, 1]):.0%}, "
            f"at most {settings.max_damping_cov:.0%} allowed"
        )
    return None
