"""Modes of a released structure from its free decay."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import timedelta
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.decays.damped_cosines import DampedCosines, damped_cosines
from jackettwin.identification.decays.decay_part import CYCLES, DecayPart, decay_part
from jackettwin.identification.decays.modes_of_decay import DecayFit, modes_of_decay
from jackettwin.identification.estimate import (
    Identification,
    ModalEstimate,
    Rejected,
    ResolvedSettings,
    Stabilisation,
)
from jackettwin.identification.mode_shapes import aligned, mpc, mpd_rad, normalised
from jackettwin.identification.preparation.resolve import FEWEST_SAMPLES, usable_channels
from jackettwin.identification.preparation.spectra import lowest_peak_hz, welch
from jackettwin.identification.preparation.whitening import accelerated, as_measured
from jackettwin.identification.status import ModeStatus
from jackettwin.records import decimate, detrend
from jackettwin.records.processing.filters import bridge

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.records import Record


SAMPLES_PER_CYCLE = 40.0
"""Fewest samples per cycle of the strongest frequency; modes up to sixteen times as high are then
resolved."""
MAX_MISSING_SHARE = 0.02
"""Largest share of missing samples in a channel that is interpolated; others are left out."""
DEEP_FALL = 1.5
"""Fall in e-folds from which ambient vibration that fades is rarely mistaken for a free decay."""
MIN_EXPLAINED_DEEP = 0.88
"""Smallest share of a deep decay that damped cosines must explain;
they explain less of a response to random forces."""
MIN_EXPLAINED_SHALLOW = 0.97
"""Smallest share that damped cosines must explain of a decay shallower than ``DEEP_FALL``."""
BRIEF_SHARE = 0.1
"""Share of the record below which a decay may come from an impact."""
MAX_IMPACT_FALL = 3.0
"""Fall in e-folds below which a brief decay counts as an impact; the modes are then identified from the
record before or after it."""
MIN_REST_CYCLES = 60.0
"""Fewest cycles of the strongest frequency after a decay that are identified instead of the whole record."""
FORCED_RATIO = 1.5
"""Ratio of the residual power in the first quarter of a fit to that in the rest above which forces still
act."""
NO_FORCES = 0.9999
"""Share explained by damped cosines from which what they leave is too little for forces: modes that die at
once leave it, and damping is known from little decay."""
MAX_STARTS = 8
"""Number of initial instants of the decay that are tried, each two cycles later."""
MIN_EXPLAINED_FIRST = 0.8
"""Share explained by damped cosines below which no later initial instant is tried. In decays that are finally
accepted the first fit explains 0.95; in the fading response of a structure on a shaking table it explains 0.3
from any instant."""
CERTAIN_RATIO = 25.0
"""Ratio of the power of a mode to the noise power in its cosines from which the mode is certain."""
MIN_EXPLAINED_INTERVALS = 0.92
"""Smallest share of a decay that its modes must explain for their intervals to allow for the remaining
forces."""
MIN_MODE_FALL = 1.0
"""Smallest fall of a mode within the decay, in e-folds."""
MAX_LOG_DAMPING_STD = 0.5
"""Standard deviation of ln ζ above which the damping counts as unknown."""
MIN_EXPLAINED_HALVES = 0.95
"""Smallest share explained of each half of a decay for the halves to be compared."""
CHANGE_STANDARD_DEVIATIONS = 3.5
"""Difference of ln ζ between the halves, in standard deviations, above which the damping is not constant."""
MIN_LOG_CHANGE = 0.1
"""Smallest change of ln ζ that is reported."""
MAX_LOG_DAMPING_STD_HALVES = 0.3
"""Largest standard deviation of ln ζ of either half for the halves to be compared."""


@dataclass(frozen=True)
class _Decay:
    whole: DecayPart
    part: DecayPart
    modes_fit: DecayFit


@dataclass(frozen=True)
class Transient:
    """A record whose amplitude falls from one high point and does not recover.

    Attributes
    ----------
    fall : float
        Fall of the amplitude in e-folds.
    identified : Identification or None
        Modes of the decay if damped cosines explain it; None if forces act on.
    beside : Record or None
        The longer part of the record before or after a decay that is so brief and shallow that it may come
        from an impact, or the part after a decay that forces disturb, if it is most of the record.
    """

    fall: float
    identified: Identification | None
    beside: Record | None = None

    def as_doubtful(self, modes: Iterable[ModalEstimate]) -> tuple[ModalEstimate, ...]:
        """Flag modes of the whole record as doubtful, since it is not stationary."""
        reason = Finding("transient", params={"fall": self.fall})
        return tuple(mode.flagged(ModeStatus.DOUBTFUL, reason) for mode in modes)


def transient(record: Record, settings: IdentificationSettings, *, impacts: bool = False) -> Transient | None:
    """Return the decay in a record, with its modes if it is free; None if the record does not decay.

    Parameters
    ----------
    impacts : bool
        Whether a decay is identified too that may come from an impact, or that forces disturb.

    Raises
    ------
    InputError
        If no channel is usable.
    """
    usable, findings = usable_channels(record)
    missing = dict(zip(usable.channel_names, np.isnan(usable.data).mean(axis=1), strict=True))
    gaps = {name: share for name, share in missing.items() if share > MAX_MISSING_SHARE}
    if len(gaps) == len(missing):
        return None
    usable = usable.select([name for name in missing if name not in gaps])
    findings += tuple(Finding("empty", name, {"share": float(share)}) for name, share in gaps.items())
    measured = detrend(usable)
    level, times = accelerated(measured, as_declared=True)
    part, level = _falling(level)
    if part is None and times.any():
        # the noise amplified by two differentiations may hide a decay that is visible in the displacement
        times = np.zeros_like(times)
        part, level = _falling(measured)
    if part is None:
        return None
    rate = level.sample_rate_hz
    beside = _part_beside_impact(record, part, level) if part.ended else None
    if beside is not None and not impacts:
        return Transient(part.fall, None, beside)
    decay = _free_part(part, level.data, rate)
    rest = None if impacts else _rest_after(record, part, level)
    if decay is None:
        return Transient(part.fall, None, rest) if part.ended else None
    if rest is not None and decay.modes_fit.fit.explained < MIN_EXPLAINED_INTERVALS:
        return Transient(part.fall, None, rest)
    part = decay.part
    finding = Finding(
        "free_decay",
        params={
            "from_s": part.first / rate,
            "to_s": part.last / rate,
            "fall": part.fall,
            "explained": decay.modes_fit.fit.explained,
        },
    )
    modes = _modes(decay, level.data, rate)
    low, high = settings.lowest_frequency_hz or 0.0, settings.highest_frequency_hz or np.inf
    inside = [mode for mode in modes if low <= mode.frequency_hz <= high]
    f = decay.modes_fit.fit.frequency_hz
    identified = Identification(
        records=(record.name,),
        channels=usable.channels,
        modes=tuple(sorted(inside, key=lambda mode: mode.frequency_hz)),
        rejected=tuple(
            Rejected(mode.frequency_hz, mode.damping_ratio, "outside the band")
            for mode in modes
            if mode not in inside
        ),
        stabilisation=Stabilisation.none(len(usable.channels)),
        spectrum=as_measured(welch(level.data, rate), times),
        settings=ResolvedSettings(
            low or 0.5 * float(f.min()), min(high, 0.4 * rate), rate, 0, (), (part.last - part.first) / rate
        ),
        duration_s=record.duration_s,
        findings=(*findings, finding),
    )
    return Transient(part.fall, identified)


def _part_beside_impact(record: Record, part: DecayPart, level: Record) -> Record | None:
    """Return the longer part before or after a decay that may come from an impact, else None.

    A decay without motion before it is no impact.
    """
    # the highest point is that of a mean over cycles, so the decay begins earlier
    begin = max(part.first - round(2.0 * CYCLES * level.sample_rate_hz / part.strongest_hz), 0)
    times = record.sample_rate_hz / level.sample_rate_hz
    first = int(begin * times)
    brief = part.last - part.first < BRIEF_SHARE * level.data.shape[1]
    before = level.data[:, :begin]
    if part.fall > MAX_IMPACT_FALL or not brief or before.shape[1] < FEWEST_SAMPLES:
        return None
    if lowest_peak_hz(welch(before, level.sample_rate_hz)) is None:
        return None
    after = _after(record, part, level)
    return replace(record, data=record.data[:, :first]) if first >= after.data.shape[1] else after


def _rest_after(record: Record, part: DecayPart, level: Record) -> Record | None:
    """Return what follows a decay if it is most of a long record, as after the start of a simulation."""
    after = _after(record, part, level)
    most = after.data.shape[1] > 0.5 * record.data.shape[1]
    return after if part.ended and most and after.duration_s * part.strongest_hz > MIN_REST_CYCLES else None


def _after(record: Record, part: DecayPart, level: Record) -> Record:
    """Return the record from as long after a decay as it lasts, since the structure still rings."""
    last = int((2 * part.last - part.first) * record.sample_rate_hz / level.sample_rate_hz)
    start = record.start_utc and record.start_utc + timedelta(seconds=last / record.sample_rate_hz)
    return replace(record, data=record.data[:, last:], start_utc=start)


def _falling(level: Record) -> tuple[DecayPart | None, Record]:
    """Return the decaying part, and the record without gaps at the sample rate that it needs."""
    if not np.isfinite(level.data).all():
        level = replace(level, data=np.apply_along_axis(bridge, 1, level.data))
    part = decay_part(level.data, level.sample_rate_hz)
    factor = 1 if part is None else int(level.sample_rate_hz / (SAMPLES_PER_CYCLE * part.strongest_hz))
    if factor > 1:
        level = decimate(level, sample_rate_hz=level.sample_rate_hz / factor)
        part = decay_part(level.data, level.sample_rate_hz)
    return part, level


def _free_part(part: DecayPart, y: FloatArray, rate: float) -> _Decay | None:
    """Return the part of a decay in which forces no longer act, and its modes."""
    step, whole = round(CYCLES * rate / part.strongest_hz), part
    fit: DampedCosines | None = None
    for attempt in range(MAX_STARTS):
        falling = y[:, part.first : part.last]
        if falling.shape[1] < 4 * step:
            return None
        if fit is not None:
            # the first fit shows when forces cease to act; modes are then sought again from that instant
            fit = damped_cosines(falling, rate, fit.frequency_hz, fit.damping_ratio)
        if fit is None or not _forces_act(fit) or attempt == MAX_STARTS - 1:
            modes_fit = modes_of_decay(falling, rate, part.strongest_hz, y[:, part.last :])
            if modes_fit is None or modes_fit.fit.explained < MIN_EXPLAINED_FIRST:
                return None
            if not _forces_act(modes_fit.fit):
                enough = MIN_EXPLAINED_DEEP if part.fall >= DEEP_FALL else MIN_EXPLAINED_SHALLOW
                return _Decay(whole, part, modes_fit) if modes_fit.fit.explained >= enough else None
            fit = modes_fit.fit
        part = replace(part, first=part.first + step)
    return None


def _forces_act(fit: DampedCosines) -> bool:
    if fit.explained > NO_FORCES:
        return False
    power = np.mean((fit.residual / (fit.residual.std(axis=1, keepdims=True) + 1e-300)) ** 2, axis=0)
    quarter = len(power) // 4
    return bool(power[:quarter].mean() > FORCED_RATIO * power[quarter:].mean())


def _modes(decay: _Decay, y: FloatArray, rate: float) -> list[ModalEstimate]:
    fit, part = decay.modes_fit.fit, decay.part
    n = len(fit.frequency_hz)
    halves = _halves(decay, y, rate)
    out = []
    for k in range(n):
        both = np.ix_([k, n + k], [k, n + k])
        shape = normalised(aligned(fit.amplitudes[k]))
        mode = ModalEstimate(
            float(fit.frequency_hz[k]),
            float(fit.damping_ratio[k]),
            shape,
            float(mpc(shape)),
            float(mpd_rad(shape)),
            1.0,
            method="decay",
            cramer_rao_log_std=np.sqrt(np.diag(fit.cramer_rao[both])),
        )
        mode = mode.with_covariance(fit.log_covariance[both])
        out.append(
            _judged(
                mode,
                float(decay.modes_fit.ratio[k]),
                fit.explained,
                (part.last - part.first) / rate,
                halves,
                k,
            )
        )
    return out


def _judged(
    mode: ModalEstimate,
    ratio: float,
    explained: float,
    duration_s: float,
    halves: tuple[DampedCosines, DampedCosines] | None,
    k: int,
) -> ModalEstimate:
    """Flag a mode that is weak, hardly decays, or whose damping depends on the amplitude."""
    folds = 2.0 * np.pi * mode.frequency_hz * mode.damping_ratio * duration_s
    if ratio < CERTAIN_RATIO:
        mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("decay_weak", params={"ratio": ratio}))
    if explained < MIN_EXPLAINED_INTERVALS:
        forced = Finding("decay_forced", params={"left": 1.0 - explained})
        mode = mode.flagged(ModeStatus.DOUBTFUL, forced)
    if folds < MIN_MODE_FALL and explained < NO_FORCES:
        mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("decay_short", params={"folds": folds}))
    if mode.log_covariance is not None and mode.log_covariance[1, 1] > MAX_LOG_DAMPING_STD**2:
        spread = float(np.sqrt(mode.log_covariance[1, 1]))
        mode = mode.flagged(
            ModeStatus.DAMPING_UNKNOWN, Finding("decay_damping_unknown", params={"spread": spread})
        )
    if halves is None:
        return mode
    early, late = halves
    n = len(early.frequency_hz)
    zeta = early.damping_ratio[k], late.damping_ratio[k]
    variances = [half.log_covariance[n + k, n + k] for half in halves]
    if max(variances) > MAX_LOG_DAMPING_STD_HALVES**2:
        return mode
    change = abs(float(np.log(zeta[1] / zeta[0])))
    if change > max(CHANGE_STANDARD_DEVIATIONS * np.sqrt(sum(variances)), MIN_LOG_CHANGE):
        params = {"early": float(zeta[0]), "late": float(zeta[1])}
        mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("decay_damping_changes", params=params))
    return mode


def _halves(decay: _Decay, y: FloatArray, rate: float) -> tuple[DampedCosines, DampedCosines] | None:
    """Fit the same modes to each half of the whole decay; None unless damped cosines explain both."""
    fit, part = decay.modes_fit.fit, decay.whole
    rate_of_fall = 2.0 * np.pi * float(fit.frequency_hz[0] * fit.damping_ratio[0])
    length = min(part.last - part.first, int(part.fall / rate_of_fall * rate))
    middle = part.first + length // 2
    if middle - part.first < 4 * len(fit.frequency_hz) + 2:
        return None
    noise = y[:, part.last :]
    early, late = (
        damped_cosines(y[:, a:b], rate, fit.frequency_hz, fit.damping_ratio, noise=noise)
        for a, b in ((part.first, middle), (middle, part.first + length))
    )
    return (early, late) if min(early.explained, late.explained) > MIN_EXPLAINED_HALVES else None
