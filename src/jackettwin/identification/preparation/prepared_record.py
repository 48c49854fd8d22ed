"""Preparation common to all identification methods."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray, Int64Array
from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification.preparation.gaps import fill
from jackettwin.identification.preparation.resolve import (
    BAND_RATIO,
    EDGE_BELOW_PEAK,
    FEWEST_SAMPLES,
    GUARD,
    MAX_ORDER,
    SAMPLES_PER_CYCLE,
    resolve,
    shortness,
    usable_channels,
)
from jackettwin.identification.preparation.spectra import lowest_motion_hz
from jackettwin.identification.preparation.whitening import accelerated
from jackettwin.identification.tones.drifting_tones import drifting_tones
from jackettwin.identification.tones.rotor_speed import estimated_speed
from jackettwin.identification.tones.steady_tones import steady_tones
from jackettwin.records import decimate, detrend
from jackettwin.signals import of_fast_length

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ResolvedSettings
    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.identification.tones.phase_track import PhaseTrack
    from jackettwin.records import Channel, Record


LONG = 100_000
"""Samples of a channel from which the memory of a transform is worth the few it may leave out."""
TONE_RATE_RATIO = 2.0
"""Ratio of the sample rate at which tones are sought to the rate needed for a band that starts at the lowest
peak, which may itself be a tone."""
PEAK_CHANNELS = 6
"""Number of channels used to find that peak."""
MIN_TOP_DEGREE = 10
"""Smallest upper limit of the polynomial degree of pLSCF."""
MIN_REPORTED_SHARE = 0.005
"""Share of filled samples above which a finding is given."""


@dataclass(frozen=True)
class PreparedRecord:
    """The usable channels of a record at the rate of the identification.

    Attributes
    ----------
    channels : tuple of Channel
    y : (n_channels, n_samples)
        Samples of zero mean and unit variance; NaN where unknown.
    scale : (n_channels,)
        Standard deviations by which the channels were divided.
    references : list of int
        Rows of the reference channels.
    settings : ResolvedSettings
    duration_s : float
    tones_hz : tuple of float
        Steady tones that were subtracted.
    drifting : tuple of PhaseTrack
        Drifting tones that were subtracted.
    findings : tuple of Finding
        On channels left out, samples predicted, and a short record.
    differentiated : (n_channels,) int
        Number of times each channel was differentiated with respect to time.
    rotor_orders : tuple of (order, low, high)
        Frequency ranges of rotor orders [Hz] if the record reveals the speed; else empty.
    recorded_hz : float
        Sample rate of the record.
    """

    channels: tuple[Channel, ...]
    y: FloatArray
    scale: FloatArray
    references: list[int]
    settings: ResolvedSettings
    duration_s: float
    tones_hz: tuple[float, ...]
    drifting: tuple[PhaseTrack, ...]
    findings: tuple[Finding, ...]
    differentiated: Int64Array
    rotor_orders: tuple[tuple[int, float, float], ...] = ()
    recorded_hz: float = 0.0


def prepare(record: Record, settings: IdentificationSettings) -> PreparedRecord:
    """Select live vibration channels, detrend, whiten, subtract tones, decimate, fill gaps, and scale.

    Channels are scaled to unit variance, so that the direction of largest motion does not hide the other.

    Raises
    ------
    InputError
        If no usable channel is left, the band lies outside the record's, or the record is shorter than
        its lag window needs.
    """
    usable, findings = usable_channels(record)
    level, differentiated = accelerated(detrend(usable))
    top = band_top_hz(level, settings) or np.inf
    level = _of_fast_length(_decimated(level, top, settings))
    rotor = None if settings.quick else estimated_speed(level.data, level.sample_rate_hz)
    tones, slowly_drifting, without = steady_tones(level.data, level.sample_rate_hz)
    drifting = slowly_drifting
    if not settings.quick:
        more, without = drifting_tones(without, level.sample_rate_hz, highest_hz=top)
        drifting = (*drifting, *more)
    if tones or drifting:
        level = replace(level, data=without)
        settings = _above_tones(level, settings, min([*tones, *(tone.swept_hz[0] for tone in drifting)]))
    resolved, reduced = resolve(level, settings)
    reduced = _of_fast_length(reduced)
    del level, without  # of a day each copy takes fifty megabytes
    findings += shortness(reduced, resolved, chosen=settings.lowest_frequency_hz is None)
    y = fill(reduced.data)
    filled = np.mean(np.isnan(reduced.data) & np.isfinite(y), axis=1)
    for channel, share in zip(usable.channels, filled, strict=True):
        if share > MIN_REPORTED_SHARE:
            findings += (Finding("predicted", channel.name, {"share": float(share)}),)
    del reduced
    scale = np.array([np.sqrt(np.nanmean(row**2)) for row in y])
    references = _references(record, usable, settings)
    if settings.method == "plscf":
        resolved = replace(resolved, orders=_degrees(settings, len(references)))
    return PreparedRecord(
        usable.channels,
        y / scale[:, None],
        scale,
        references,
        resolved,
        record.duration_s,
        tones,
        drifting,
        findings,
        differentiated,
        () if rotor is None else rotor.orders,
        record.sample_rate_hz,
    )


def band_top_hz(level: Record, settings: IdentificationSettings) -> float | None:
    """Return the upper limit of the band, or None without a peak.

    Only a few channels are examined. If none has the lowest peak, the limit is merely higher than necessary.
    """
    if settings.highest_frequency_hz is not None:
        return GUARD * settings.highest_frequency_hz
    if settings.lowest_frequency_hz is not None:
        return GUARD * BAND_RATIO * settings.lowest_frequency_hz
    few = level.data[:: -(-len(level.data) // PEAK_CHANNELS)]
    if few.shape[1] < FEWEST_SAMPLES:
        return None
    peak = lowest_motion_hz(few, level.sample_rate_hz)
    return None if peak is None else GUARD * BAND_RATIO * peak


def _decimated(level: Record, top_hz: float, settings: IdentificationSettings) -> Record:
    """Decimate a record sampled much faster than its band needs, to speed up the search for tones."""
    needed = TONE_RATE_RATIO * max(SAMPLES_PER_CYCLE * top_hz, settings.sample_rate_hz or 0.0)
    factor = int(level.sample_rate_hz / needed)
    return decimate(level, sample_rate_hz=level.sample_rate_hz / factor) if factor > 1 else level


def _of_fast_length(record: Record) -> Record:
    """Leave out the last few samples of a long record whose transform would take more memory than itself."""
    if record.data.shape[1] <= LONG:
        return record
    return replace(record, data=of_fast_length(record.data))


def _above_tones(level: Record, settings: IdentificationSettings, lowest_hz: float) -> IdentificationSettings:
    """Return settings whose band starts below the tones if there is no other clear peak."""
    if settings.lowest_frequency_hz is not None or lowest_motion_hz(level.data, level.sample_rate_hz):
        return settings
    return settings.model_copy(update={"lowest_frequency_hz": EDGE_BELOW_PEAK * lowest_hz})


def _degrees(settings: IdentificationSettings, n_references: int) -> tuple[int, ...]:
    """Return polynomial degrees that give at least SSI's numbers of poles, at most twice as many."""
    top = max(2 * (settings.max_order or MAX_ORDER) // n_references, MIN_TOP_DEGREE)
    return tuple(range(2, top + 1))


def _references(record: Record, usable: Record, settings: IdentificationSettings) -> list[int]:
    """Return the rows of the reference channels among the usable ones; all of them by default."""
    if settings.reference_channels is None:
        return list(range(len(usable.channels)))
    record.select(settings.reference_channels)
    names = [name for name in settings.reference_channels if name in usable.channel_names]
    if not names:
        raise InputError(
            "no reference channel is usable",
            file=record.name,
            field="reference_channels",
            value=settings.reference_channels,
            allowed=", ".join(usable.channel_names),
        )
    return [usable.channel_names.index(name) for name in names]
