"""From a record to its modes without a hand on it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.identification.clustering import Cluster, clusters
from jackettwin.identification.covariances import block_covariances, covariances
from jackettwin.identification.estimate import (
    Identification,
    ModalEstimate,
    Rejected,
    ResolvedSettings,
    Stabilisation,
)
from jackettwin.identification.harmonics import is_tone
from jackettwin.identification.mac import aligned, mpc, mpd_rad, normalised
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.spectra import FEWEST_CYCLES, lowest_peak_hz, welch
from jackettwin.identification.ssi_cov import order_poles, ssi_cov
from jackettwin.identification.ssi_uncertainty import (
    block_deviations,
    order_poles_with_uncertainty,
    propagation,
)
from jackettwin.identification.stabilisation import admissible, stabilisation
from jackettwin.quantities import VIBRATIONS
from jackettwin.records import Record, decimate, detrend

if TYPE_CHECKING:
    from collections.abc import Callable

FloatArray = npt.NDArray[np.float64]

EDGE_BELOW_PEAK = 0.65
"""Lower edge of the band as a share of the lowest clear peak."""
BAND_RATIO = 25.0
"""Upper edge of the band over its lower edge."""
SAMPLES_A_CYCLE = 2.5
"""Sample rate over the upper edge of the band: the decimation filter passes up to 0.8 of Nyquist."""
WINDOW_CYCLES = 1.0
"""Block rows in cycles of the lower edge. Twice that is the lag window: long enough to tell a pair of
frequencies a few per cent apart, short enough that the covariances are still determined."""
WINDOW_SHARE = 0.2
"""Largest lag window as a share of the record."""
FEWEST_BLOCKS = 5
"""Fewer blocks give no standard deviation worth printing."""
TONE_REACH = 6.0
"""A tone nearer than this many half bandwidths disturbs a mode …"""
TONE_WIDENING = 2.0
"""… whose standard deviations are multiplied by this."""
DEAD = 1e-9
"""A channel is dead when it moves less than this share of its largest value."""


def identify(
    record: Record,
    settings: IdentificationSettings | None = None,
    *,
    progress: Callable[[str], None] | None = None,
) -> Identification:
    """Identify the modes of a record.

    Vibration channels only; others are left aside. Detrended, decimated and scaled to unit variance,
    then SSI-cov over a sweep of model orders, clustering of the poles, hard criteria.

    Parameters
    ----------
    record : Record
        NaN marks a missing sample.
    settings : IdentificationSettings, optional
        What is not set follows from the data.
    progress : callable, optional
        Called with a few words at the start of every step.

    Raises
    ------
    InputError
        If no usable channel is left, the band lies outside the record's, or the record is shorter than
        its lag window needs.

    Examples
    --------
    >>> import numpy as np
    >>> from jackettwin.records import Channel, Record
    >>> t = np.arange(6000) / 20.0
    >>> rng = np.random.default_rng(1)
    >>> h = np.exp(-0.02 * 2 * np.pi * t) * np.sin(2 * np.pi * t)
    >>> y = np.convolve(rng.standard_normal(6000), h)[:6000]
    >>> result = identify(Record(np.array([y, -0.5 * y]), 20.0, (Channel("a"), Channel("b"))))
    >>> [round(mode.frequency_hz, 1) for mode in result.modes]
    [1.0]
    """
    settings = settings or IdentificationSettings()
    say = progress or (lambda text: None)
    say("preparing")
    usable, warnings = _usable(record)
    usable = detrend(usable)
    resolved, reduced = _resolve(usable, settings)
    scale = np.sqrt(np.nanmean(reduced.data**2, axis=1))
    y = reduced.data / scale[:, None]
    say("poles")
    poles = _poles(y, scale, resolved, settings)
    say("selection")
    found = clusters(poles, distance=settings.cluster_distance, n_orders=len(resolved.orders), scale=scale)
    tones = _tones(poles, found, y / scale[:, None], resolved.sample_rate_hz, settings)
    modes, rejected, poles = _select(poles, found, tones, settings, record.duration_s)
    return Identification(
        records=(record.name,),
        channels=usable.channels,
        modes=modes,
        rejected=rejected,
        stabilisation=poles,
        spectrum=welch(reduced.data, resolved.sample_rate_hz),
        settings=resolved,
        duration_s=record.duration_s,
        warnings=warnings,
    )


def _poles(
    y: FloatArray, scale: FloatArray, resolved: ResolvedSettings, settings: IdentificationSettings
) -> Stabilisation:
    """Return the poles of all orders, with their uncertainty where it is known how to propagate it."""
    band = (resolved.lowest_frequency_hz, resolved.highest_frequency_hz)
    n_lags = 2 * resolved.block_rows
    subspace = ssi_cov(
        covariances(y, n_lags),
        block_rows=resolved.block_rows,
        max_order=resolved.orders[-1],
        weighting=settings.weighting,
        state_matrix=settings.state_matrix,
    )
    if settings.blocks >= FEWEST_BLOCKS and (settings.weighting, settings.state_matrix) == ("br", "shift"):
        blocks = block_covariances(y, n_lags, settings.blocks)
        poles = order_poles_with_uncertainty(
            propagation(subspace, block_deviations(blocks, resolved.block_rows)),
            resolved.orders,
            keep=lambda mu: admissible(mu, settings, resolved.sample_rate_hz, band),
        )
    else:
        poles = order_poles(subspace, resolved.orders)
    return stabilisation(poles, settings, sample_rate_hz=resolved.sample_rate_hz, band_hz=band, scale=scale)


def _usable(record: Record) -> tuple[Record, tuple[str, ...]]:
    """Return the vibration channels that are alive, and a sentence on each that is not."""
    vibration = [c.name for c in record.channels if c.quantity in VIBRATIONS]
    alive, warnings = [], []
    for channel, y in zip(record.channels, record.data, strict=True):
        if channel.name not in vibration:
            continue
        finite = y[np.isfinite(y)]
        if len(finite) < 0.5 * len(y):
            warnings.append(
                f"channel {channel.name} left out: {1.0 - len(finite) / max(len(y), 1):.0%} missing"
            )
        elif np.ptp(finite) <= DEAD * np.abs(finite).max():
            warnings.append(f"channel {channel.name} left out: constant")
        else:
            alive.append(channel.name)
    if not alive:
        raise InputError(
            "no usable vibration channel" + "".join(f"; {text}" for text in warnings),
            file=record.name,
            field="channels",
            value=list(record.channel_names),
            allowed=f"at least one live channel of {', '.join(sorted(VIBRATIONS))}",
            remedy="check the record's quantities and its data",
        )
    return record.select(alive), tuple(warnings)


def _resolve(record: Record, settings: IdentificationSettings) -> tuple[ResolvedSettings, Record]:
    """Choose what the settings leave open, and decimate."""
    low, high = _band(record, settings)
    rate = settings.sample_rate_hz
    if rate is None:
        rate = record.sample_rate_hz / max(int(record.sample_rate_hz / (SAMPLES_A_CYCLE * high)), 1)
    window = settings.block_rows or max(int(np.ceil(WINDOW_CYCLES * rate / low)), 4)
    _check_duration(record, low, 2.0 * window / rate)
    reduced = decimate(record, sample_rate_hz=rate) if rate < record.sample_rate_hz else record
    n_channels = len(record.channels)
    top = min(settings.max_order or 60, (window - 1) * n_channels)
    orders = tuple(
        range(min(settings.order_step, 2) if settings.order_step < 2 else 2, top + 1, settings.order_step)
    )
    return ResolvedSettings(low, high, reduced.sample_rate_hz, window, orders, 2.0 * window / rate), reduced


def _band(record: Record, settings: IdentificationSettings) -> tuple[float, float]:
    nyquist = 0.5 * record.sample_rate_hz
    low = settings.lowest_frequency_hz
    if low is None:
        peak = lowest_peak_hz(welch(record.data, record.sample_rate_hz))
        if peak is None:
            raise InputError(
                "no spectral peak stands out",
                file=record.name,
                field="lowest_frequency_hz",
                remedy="state the lowest frequency of interest",
            )
        low = EDGE_BELOW_PEAK * peak
    limit = 2.0 / SAMPLES_A_CYCLE * nyquist
    high = settings.highest_frequency_hz or min(BAND_RATIO * low, limit)
    if not low < high < nyquist:
        raise InputError(
            "the band of interest does not fit the record",
            file=record.name,
            field="lowest_frequency_hz, highest_frequency_hz",
            value=(low, high),
            allowed=f"0 < lowest < highest < {nyquist:g} Hz",
            remedy="choose a lower band or use a record of higher rate",
        )
    return low, high


def _check_duration(record: Record, low: float, window_s: float) -> None:
    needed = max(window_s / WINDOW_SHARE, FEWEST_CYCLES / low)
    if record.duration_s < needed:
        raise InputError(
            "record too short for its lag window",
            file=record.name,
            field="duration_s",
            value=record.duration_s,
            allowed=f"≥ {needed:.0f} s for a lowest frequency of {low:.3g} Hz",
            remedy="use a longer record or raise lowest_frequency_hz",
        )


def _select(
    poles: Stabilisation,
    found: list[Cluster],
    tones: dict[int, float],
    settings: IdentificationSettings,
    duration_s: float,
) -> tuple[tuple[ModalEstimate, ...], tuple[Rejected, ...], Stabilisation]:
    """Apply the hard criteria to the clusters; label the poles of those that pass."""
    modes: list[ModalEstimate] = []
    rejected: list[Rejected] = []
    label = poles.cluster.copy()
    for cluster in found:
        f, zeta = (float(x[cluster.representative]) for x in (poles.frequency_hz, poles.damping_ratio))
        shape = normalised(aligned(poles.mode_shape[cluster.representative]))
        reason = _reason(cluster, float(mpc(shape)), float(mpd_rad(shape)), settings)
        if cluster.representative in tones:
            reason = "steady tone: its envelope does not wander as that of a mode"
        if reason is not None:
            rejected.append(Rejected(f, zeta, reason))
            continue
        label[cluster.poles] = len(modes)
        bare = ModalEstimate(f, zeta, shape, float(mpc(shape)), float(mpd_rad(shape)), cluster.order_share)
        mode = _with_uncertainty(bare, poles, cluster, duration_s)
        modes.append(_beside_tones(mode, list(tones.values())))
    return tuple(modes), tuple(rejected), replace(poles, cluster=label)


def _tones(
    poles: Stabilisation,
    found: list[Cluster],
    y: FloatArray,
    sample_rate_hz: float,
    settings: IdentificationSettings,
) -> dict[int, float]:
    """Return the frequencies of steady tones among the clusters, by representative pole."""
    candidates = [c.representative for c in found if c.order_share >= settings.min_order_share]
    return {
        k: float(poles.frequency_hz[k])
        for k in candidates
        if is_tone(y, sample_rate_hz, float(poles.frequency_hz[k]), poles.mode_shape[k])
    }


def _beside_tones(mode: ModalEstimate, tones_hz: list[float]) -> ModalEstimate:
    """Flag a mode near a tone, and widen what is said of its damping."""
    reach = TONE_REACH * mode.damping_ratio * mode.frequency_hz
    near = [f for f in tones_hz if abs(f - mode.frequency_hz) < reach]
    if not near:
        return mode
    mode = replace(mode, status=f"a steady tone at {near[0]:.4g} Hz is too near to trust the damping")
    if mode.log_covariance is None:
        return mode
    covariance = TONE_WIDENING**2 * mode.log_covariance
    std_f, std_zeta = np.sqrt(np.diag(covariance))
    return replace(
        mode,
        log_covariance=covariance,
        frequency_std_hz=float(mode.frequency_hz * std_f),
        damping_ratio_std=float(mode.damping_ratio * std_zeta),
        frequency_interval_95=_interval(mode.frequency_hz, std_f),
        damping_ratio_interval_95=_interval(mode.damping_ratio, std_zeta),
    )


def _with_uncertainty(
    mode: ModalEstimate, poles: Stabilisation, cluster: Cluster, duration_s: float
) -> ModalEstimate:
    """Add the uncertainty of the representative pole and the scatter over the model orders.

    Never below the long-data limits of Au 2014, ζ: 1/√(2πζfT), f: √(ζ/(2πfT)): blocks shorter than the
    memory of a mode underestimate its scatter.
    """
    f, zeta = mode.frequency_hz, mode.damping_ratio
    cycles = 2.0 * np.pi * f * duration_s
    limit = 1.0 / np.sqrt(zeta * cycles)
    mode = replace(mode, damping_ratio_cov_limit=float(limit))
    if poles.log_covariance is None or poles.mode_shape_std is None:
        return mode
    both = np.log([poles.frequency_hz[cluster.core], poles.damping_ratio[cluster.core]])
    covariance = poles.log_covariance[cluster.representative] + np.cov(both, bias=True)
    lift = np.sqrt(np.maximum(np.array([zeta / cycles, limit**2]) / np.diag(covariance), 1.0))
    covariance = covariance * np.outer(lift, lift)
    std_f, std_zeta = np.sqrt(np.diag(covariance))
    return replace(
        mode,
        log_covariance=covariance,
        frequency_std_hz=float(f * std_f),
        damping_ratio_std=float(zeta * std_zeta),
        frequency_interval_95=_interval(f, std_f),
        damping_ratio_interval_95=_interval(zeta, std_zeta),
        mode_shape_std=poles.mode_shape_std[cluster.representative],
    )


def _interval(centre: float, log_std: float) -> tuple[float, float]:
    factor = float(np.exp(1.96 * log_std))
    return centre / factor, centre * factor


def _reason(
    cluster: Cluster, collinearity: float, deviation: float, settings: IdentificationSettings
) -> str | None:
    """Return why a cluster is not a mode, or None."""
    if cluster.order_share < settings.min_order_share:
        return f"in {cluster.order_share:.0%} of the model orders, {settings.min_order_share:.0%} needed"
    if cluster.damping_cov > settings.max_damping_cov:
        return (
            f"damping uncertain by {cluster.damping_cov:.0%}, at most {settings.max_damping_cov:.0%} allowed"
        )
    if collinearity < settings.min_mpc:
        return f"modal phase collinearity {collinearity:.2f} below {settings.min_mpc:g}"
    if deviation > settings.max_mpd_rad:
        return f"mean phase deviation {deviation:.2f} rad above {settings.max_mpd_rad:g}"
    return None
