"""The modes that are reported: the candidates no one doubts, refined, and those the spectrum needs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, TypedDict

import numpy as np
import numpy.typing as npt

from jackettwin.identification.estimate import Rejected
from jackettwin.identification.local_refinement import DITHER_SHARES, groups, refine_group
from jackettwin.identification.mac import normalised
from jackettwin.identification.periodogram import DERIVATIVES
from jackettwin.identification.refinement import Refined, refine
from jackettwin.identification.resolve import guarded_band_hz
from jackettwin.identification.selection import beside_tones, long_data_limits, with_covariance

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from jackettwin.identification.estimate import ModalEstimate, ResolvedSettings
    from jackettwin.identification.prepared import Prepared
    from jackettwin.identification.selection import Candidate, Tones
    from jackettwin.identification.settings import IdentificationSettings

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MOST_MISSING = 0.01
"""Share of missing samples in a channel up to which a periodogram is trusted."""

MOST_LACK_OF_FIT = 1.4
"""Mean square of the misfit over its expectation up to which a fit of the whole band is believed;
records that are what the model says have 0.8 to 1.1."""
MOST_LOCAL_LACK_OF_FIT = 2.0
"""The same in a narrow band, where the covariance is multiplied by what exceeds 1."""

TAKEN_LINES = 0.75
"""A line as far from a tone as this went with it."""


@dataclass(frozen=True)
class Choice:
    """Modes by ascending frequency, the candidate each came from, and what was left out."""

    modes: tuple[ModalEstimate, ...]
    candidate: tuple[int, ...]
    rejected: tuple[Rejected, ...]
    warnings: tuple[str, ...]


def chosen_modes(
    judged: Sequence[Candidate], tones: Tones, ready: Prepared, settings: IdentificationSettings
) -> Choice:
    """Refine the candidates and keep those that are modes inside the band."""
    y, scale, resolved = tones.clean, ready.scale, ready.settings
    open_to = [i for i, c in enumerate(judged) if c.objection is None]
    sure = np.array([judged[i].doubt is None for i in open_to], dtype=bool)
    warnings: tuple[str, ...] = ()
    modes = {i: judged[i].mode for i, certain in zip(open_to, sure, strict=True) if certain}
    if settings.refine and sure.any():
        if np.isnan(y).mean(axis=1).max() > MOST_MISSING:
            warnings = ("modes not refined: gaps remain in the record",)
        else:
            start = _start([judged[i].mode for i in open_to], sure, ready, tones)
            fits, warnings = _fits(y, resolved, start)
            for members, fit in fits:
                for position in np.flatnonzero(members):
                    modes.pop(open_to[position], None)
                modes |= _numbers(judged, open_to, fit, scale, y.shape[1] / resolved.sample_rate_hz)
    tones_hz = (*tones.frequency_hz.values(), *ready.tones_hz)
    found = _sorted(judged, modes, tones_hz, resolved, settings, warnings)
    return replace(found, rejected=(*found.rejected, *_tones(ready.tones_hz, resolved)))


class _Start(TypedDict):
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    shapes: FloatArray
    sure: BoolArray
    derivatives: list[int]
    avoid_hz: tuple[tuple[float, float], ...]


def _start(modes: list[ModalEstimate], sure: BoolArray, ready: Prepared, tones: Tones) -> _Start:
    return _Start(
        frequency_hz=np.array([m.frequency_hz for m in modes]),
        damping_ratio=np.array([m.damping_ratio for m in modes]),
        shapes=np.array([m.mode_shape.real for m in modes]) / ready.scale,
        sure=sure,
        derivatives=[DERIVATIVES[c.quantity] for c in ready.channels],
        avoid_hz=(*tones.swept_hz, *(_taken_hz(f, ready.duration_s) for f in ready.tones_hz)),
    )


def _taken_hz(tone_hz: float, duration_s: float) -> tuple[float, float]:
    """Return the range of the lines that went with a tone: one on either side of it, or that it is on."""
    return tone_hz - TAKEN_LINES / duration_s, tone_hz + TAKEN_LINES / duration_s


def _fits(
    y: FloatArray, resolved: ResolvedSettings, start: _Start
) -> tuple[list[tuple[BoolArray, Refined]], tuple[str, ...]]:
    """Return the fits that are believed, with the candidates each speaks for, and what is said of others.

    One fit of the whole band if it describes the record, else one of each group of close modes.
    """
    band, rate = guarded_band_hz(resolved), resolved.sample_rate_hz
    whole, obstacle = _tried(lambda: refine(y, rate, band, **start), MOST_LACK_OF_FIT)
    if whole is not None:
        return [(np.ones(len(start["sure"]), dtype=bool), whole)], ()
    fits, warnings = [], []
    for group in groups(start["frequency_hz"], start["sure"], band):
        for share in DITHER_SHARES:
            work = partial(refine_group, y, rate, group, dither_share=share, **start)
            fit, obstacle = _tried(work, MOST_LOCAL_LACK_OF_FIT)
            if fit is not None:
                break
        if fit is None:
            f = ", ".join(f"{f:.3g}" for f in start["frequency_hz"][group.members & start["sure"]])
            warnings.append(f"modes at {f} Hz not refined: {obstacle}")
        else:
            fits.append((group.members, fit))
    return fits, tuple(warnings)


def _tried(fit: Callable[[], Refined], most: float) -> tuple[Refined | None, str]:
    """Return a fit that is to be used, or why there is none."""
    try:
        refined = fit()
    except np.linalg.LinAlgError:
        return None, "the arithmetic of the fit broke down"
    if not refined.converged:
        return None, "the fit of the spectral model did not converge"
    if refined.lack_of_fit > most:
        return None, (
            f"the spectrum is not that of modes under smooth random forces "
            f"(lack of fit {refined.lack_of_fit:.1f}, at most {most:g})"
        )
    return refined, ""


def _numbers(
    judged: Sequence[Candidate], open_to: list[int], refined: Refined, scale: FloatArray, duration_s: float
) -> dict[int, ModalEstimate]:
    """Return the refined modes by candidate."""
    out = {}
    for k, position in enumerate(refined.candidate):
        index = open_to[position]
        f, zeta = float(refined.frequency_hz[k]), float(refined.damping_ratio[k])
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
            damping_ratio_cov_limit=float(long_data_limits(f, zeta, duration_s)[1]),
        )
        out[index] = with_covariance(mode, refined.covariance[k])
    return out


def _sorted(
    judged: Sequence[Candidate],
    modes: dict[int, ModalEstimate],
    tones_hz: Collection[float],
    resolved: ResolvedSettings,
    settings: IdentificationSettings,
    warnings: tuple[str, ...],
) -> Choice:
    """Drop what is outside the band or hardly known; order by frequency."""
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
        warnings=warnings,
    )


def _tones(removed_hz: Collection[float], resolved: ResolvedSettings) -> list[Rejected]:
    low, high = guarded_band_hz(resolved)
    reason = "steady tone: one line of the periodogram; taken out"
    return [Rejected(f, None, reason) for f in sorted(removed_hz) if low < f < high]


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
