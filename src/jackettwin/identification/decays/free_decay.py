"""The modes of a structure that was released, from its free decay."""

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
from jackettwin.identification.selection.candidates import with_covariance
from jackettwin.identification.status import ModeStatus
from jackettwin.records import decimate, detrend
from jackettwin.records.processing.filters import bridge

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.records import Record


SAMPLES_A_CYCLE = 40.0
"""Least samples in a cycle of the strongest frequency: modes up to sixteen times as high are seen."""
MOST_MISSING = 0.02
"""Largest share of a channel's samples that is interpolated; a channel that misses more is left out."""
DEEP = 1.5
"""Fall in e-folds from which fading ambient vibration is hardly ever mistaken for a free decay …"""
MOSTLY = 0.88
"""… if damped cosines explain this share of it; responses to random forces leave more …"""
NEARLY_ALL = 0.97
"""… and this share of a shallower one."""
BRIEF = 0.1
"""Share of the record below which a decay may be a knock …"""
A_KNOCK = 3.0
"""… if it falls by fewer e-folds: then the rest of the record tells more of the modes."""
STILL_FORCED = 1.5
"""Residual power in the first quarter of a fit over that in the rest, from which forces still act."""
LATER_STARTS = 8
"""Number of times that the start is put off by two cycles."""
HOPELESS = 0.8
"""Share of a decay that damped cosines explain, below which no later start makes it a free one: of those that
end as one the first explains 0.95, of a shaking table that fades 0.3, wherever it begins."""
CLEAR = 25.0
"""Power of a mode over the noise power in its cosines, from which the mode is certain."""
UNFORCED = 0.92
"""Share of a decay that its modes must explain for their intervals to cover the effect of forces."""
LEAST_FOLDS = 1.0
"""Least number of e-folds by which a mode falls within the decay."""
MOST_SPREAD = 0.5
"""Standard deviation of ln ζ from which the damping is unknown."""
EXPLAINED_HALVES = 0.95
"""Share that the modes explain of either half of a decay, from which the two are compared …"""
CHANGES = 3.5
"""… and standard deviations between their ln ζ from which it is not one damping."""
LEAST_CHANGE = 0.1
"""Least change of ln ζ that is reported."""
MOST_SPREAD_OF_HALVES = 0.3
"""Standard deviation of ln ζ of either half up to which the two are compared."""


@dataclass(frozen=True)
class _Decay:
    whole: DecayPart
    part: DecayPart
    found: DecayFit


@dataclass(frozen=True)
class Transient:
    """A record that falls from one high point and does not come back.

    Attributes
    ----------
    fall : float
        E-folds of the amplitude.
    identified : Identification or None
        Its modes, where damped cosines explain what falls, or those of what is beside it; None where forces
        go on.
    beside : Record or None
        The longer stretch before or after a fall so brief and shallow that it may be a knock.
    """

    fall: float
    identified: Identification | None
    beside: Record | None = None

    def doubted(self, modes: Iterable[ModalEstimate]) -> tuple[ModalEstimate, ...]:
        """Return modes that were taken from the whole record, which is not stationary, as doubtful."""
        reason = Finding("transient", params={"fall": self.fall})
        return tuple(mode.flagged(ModeStatus.DOUBTFUL, reason) for mode in modes)


def transient(record: Record, settings: IdentificationSettings, *, knocks: bool = False) -> Transient | None:
    """Return the decay in a record, with its modes if it is a free one; None if the record does not decay.

    Parameters
    ----------
    knocks : bool
        Whether the modes of what may be a knock are sought as well.

    Raises
    ------
    InputError
        If no channel is usable.
    """
    usable, warnings = usable_channels(record)
    missing = dict(zip(usable.channel_names, np.isnan(usable.data).mean(axis=1), strict=True))
    gaps = {name: share for name, share in missing.items() if share > MOST_MISSING}
    if len(gaps) == len(missing):
        return None
    usable = usable.select([name for name in missing if name not in gaps])
    warnings += tuple(f"channel {name} left out: {share:.0%} missing" for name, share in gaps.items())
    measured = detrend(usable)
    level, times = accelerated(measured, as_declared=True)
    part, level = _falling(level)
    if part is None and times.any():
        # noise that two derivatives lift may hide what a displacement shows
        times = np.zeros_like(times)
        part, level = _falling(measured)
    if part is None:
        return None
    rate = level.sample_rate_hz
    beside = _beside_knock(record, part, level)
    if beside is not None and not knocks:
        return Transient(part.fall, None, beside)
    decay = _free(part, level.data, rate)
    if decay is None:
        return Transient(part.fall, None)
    part = decay.part
    said = Finding(
        "free_decay",
        params={
            "from_s": part.first / rate,
            "to_s": part.last / rate,
            "fall": part.fall,
            "explained": decay.found.fit.explained,
        },
    )
    modes = _modes(decay, level.data, rate)
    low, high = settings.lowest_frequency_hz or 0.0, settings.highest_frequency_hz or np.inf
    inside = [mode for mode in modes if low <= mode.frequency_hz <= high]
    f = decay.found.fit.frequency_hz
    identified = Identification(
        records=(record.name,),
        channels=usable.channels,
        modes=tuple(sorted(inside, key=lambda mode: mode.frequency_hz)),
        rejected=tuple(
            Rejected(mode.frequency_hz, mode.damping_ratio, "outside the band")
            for mode in modes
            if mode not in inside
        ),
        stabilisation=_no_poles(len(usable.channels)),
        spectrum=as_measured(welch(level.data, rate), times),
        settings=ResolvedSettings(
            low or 0.5 * float(f.min()), min(high, 0.4 * rate), rate, 0, (), (part.last - part.first) / rate
        ),
        duration_s=record.duration_s,
        warnings=(*warnings, str(said)),
    )
    return Transient(part.fall, identified)


def _beside_knock(record: Record, part: DecayPart, level: Record) -> Record | None:
    """Return the longer stretch before or after a decay that may be a knock; None if it is more.

    It is more where nothing moved before; as much again is left out after it, in which it still rings.
    """
    # its highest point is that of a mean over cycles: it begins before
    begin = max(part.first - round(2.0 * CYCLES * level.sample_rate_hz / part.strongest_hz), 0)
    times = record.sample_rate_hz / level.sample_rate_hz
    first, last = int(begin * times), int((2 * part.last - part.first) * times)
    brief = part.last - part.first < BRIEF * level.data.shape[1]
    before = level.data[:, :begin]
    if part.fall > A_KNOCK or not brief or before.shape[1] < FEWEST_SAMPLES:
        return None
    if lowest_peak_hz(welch(before, level.sample_rate_hz)) is None:
        return None
    if first >= record.data.shape[1] - last:
        return replace(record, data=record.data[:, :first])
    start = record.start_utc and record.start_utc + timedelta(seconds=last / record.sample_rate_hz)
    return replace(record, data=record.data[:, last:], start_utc=start)


def _falling(level: Record) -> tuple[DecayPart | None, Record]:
    """Return the part that falls, and the record without gaps at the rate that is needed for it."""
    level = replace(level, data=np.apply_along_axis(bridge, 1, level.data))
    part = decay_part(level.data, level.sample_rate_hz)
    factor = 1 if part is None else int(level.sample_rate_hz / (SAMPLES_A_CYCLE * part.strongest_hz))
    if factor > 1:
        level = decimate(level, sample_rate_hz=level.sample_rate_hz / factor)
        part = decay_part(level.data, level.sample_rate_hz)
    return part, level


def _free(part: DecayPart, y: FloatArray, rate: float) -> _Decay | None:
    """Return the part of a decay in which no force acts any more, and its modes."""
    step, whole = round(CYCLES * rate / part.strongest_hz), part
    fit: DampedCosines | None = None
    for put_off in range(LATER_STARTS):
        falling = y[:, part.first : part.last]
        if falling.shape[1] < 4 * step:
            return None
        if fit is not None:
            # the modes found first tell where forces act no more; from there they are sought again
            fit = damped_cosines(falling, rate, fit.frequency_hz, fit.damping_ratio)
        if fit is None or not _still_forced(fit) or put_off == LATER_STARTS - 1:
            found = modes_of_decay(falling, rate, part.strongest_hz, y[:, part.last :])
            if found is None or found.fit.explained < HOPELESS:
                return None
            if not _still_forced(found.fit):
                enough = MOSTLY if part.fall >= DEEP else NEARLY_ALL
                return _Decay(whole, part, found) if found.fit.explained >= enough else None
            fit = found.fit
        part = replace(part, first=part.first + step)
    return None


def _still_forced(fit: DampedCosines) -> bool:
    power = np.mean((fit.residual / (fit.residual.std(axis=1, keepdims=True) + 1e-300)) ** 2, axis=0)
    quarter = len(power) // 4
    return bool(power[:quarter].mean() > STILL_FORCED * power[quarter:].mean())


def _modes(decay: _Decay, y: FloatArray, rate: float) -> list[ModalEstimate]:
    fit, part = decay.found.fit, decay.part
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
        mode = with_covariance(mode, fit.log_covariance[both])
        out.append(
            _judged(
                mode, float(decay.found.ratio[k]), fit.explained, (part.last - part.first) / rate, halves, k
            )
        )
    return out


def _judged(
    mode: ModalEstimate,
    ratio: float,
    explained: float,
    watched_s: float,
    halves: tuple[DampedCosines, DampedCosines] | None,
    k: int,
) -> ModalEstimate:
    """Flag a mode that is weak, hardly falls, or whose damping changes with the amplitude."""
    folds = 2.0 * np.pi * mode.frequency_hz * mode.damping_ratio * watched_s
    if ratio < CLEAR:
        mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("decay_weak", params={"ratio": ratio}))
    if explained < UNFORCED:
        forced = Finding("decay_forced", params={"left": 1.0 - explained})
        mode = mode.flagged(ModeStatus.DOUBTFUL, forced)
    if folds < LEAST_FOLDS:
        mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("decay_short", params={"folds": folds}))
    if mode.log_covariance is not None and mode.log_covariance[1, 1] > MOST_SPREAD**2:
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
    if max(variances) > MOST_SPREAD_OF_HALVES**2:
        return mode
    change = abs(float(np.log(zeta[1] / zeta[0])))
    if change > max(CHANGES * np.sqrt(sum(variances)), LEAST_CHANGE):
        params = {"early": float(zeta[0]), "late": float(zeta[1])}
        mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("decay_damping_changes", params=params))
    return mode


def _halves(decay: _Decay, y: FloatArray, rate: float) -> tuple[DampedCosines, DampedCosines] | None:
    """Fit the same modes to either half of the whole decay, if damped cosines explain both."""
    fit, part = decay.found.fit, decay.whole
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
    return (early, late) if min(early.explained, late.explained) > EXPLAINED_HALVES else None


def _no_poles(n_channels: int) -> Stabilisation:
    none, no = np.empty(0), np.empty(0, dtype=bool)
    whole = np.empty(0, dtype=np.int64)
    shapes = np.empty((0, n_channels), dtype=complex)
    return Stabilisation(whole, none, none, shapes, no, no, no, whole)
