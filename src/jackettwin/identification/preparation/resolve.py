"""Resolve the settings of an identification: usable channels, band, sample rate and lag window."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification.estimate import ResolvedSettings
from jackettwin.identification.preparation.spectra import FEWEST_CYCLES, densities, lowest_motion_hz, welch
from jackettwin.quantities import VIBRATIONS
from jackettwin.records import Record, decimate
from jackettwin.records.quality.repair import without_stuck
from jackettwin.records.quality.repeats import duplicate_channels
from jackettwin.records.record import SMALLEST

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jackettwin.identification.estimate import Spectrum
    from jackettwin.identification.settings import IdentificationSettings

EDGE_BELOW_PEAK = 0.65
"""Lower edge of the band as a share of the lowest clear peak."""
BAND_RATIO = 25.0
"""Upper edge of the band over its lower edge."""
SAMPLES_PER_CYCLE = 2.5
"""Ratio of sample rate to upper edge of the band: the decimation filter passes up to 0.8 of Nyquist."""
WINDOW_CYCLES = 1.0
"""Block rows in cycles of the lower edge. The lag window is twice that: long enough to separate a pair of
frequencies a few per cent apart, short enough that the covariances are well determined."""
SINGLE_CHANNEL_CYCLES = 2.5
"""Most block rows of a single channel, in the same cycles. Without a shape to separate them, block rows of
one cycle merge two modes that differ by an eighth of their frequency into one mode twice as broad."""
SINGLE_CHANNEL_SHARE = 1.0 / 400.0
"""Largest share of the record for these block rows: with hundreds of cycles the covariances are accurate."""
GUARD = 1.25
"""Poles are sought and spectra fitted up to this multiple of the band's upper edge if the sample rate allows:
a mode near the edge needs its whole peak, and one just beyond must be modelled."""
WINDOW_SHARE = 0.2
"""Largest lag window as a share of the record."""
MAX_ORDER = 60
"""Largest model order."""
FEW_CHANNELS_ORDER = 40
"""Model order that must be possible with few channels; block rows are added for it."""
DENSE_ORDERS = 20
"""Model order up to which every order of the sweep is used; beyond it every second one is. For relaxations,
which appear in few orders, all are used."""
SHORT_RECORD_CYCLES = 60.0
"""Number of cycles of its lowest mode below which a record counts as short."""
STRONG_RATIO = 0.1
"""Ratio of the largest singular value below the band to that within it above which a warning is given."""
FEWEST_SAMPLES = 64
"""Fewest samples for a spectrum."""
REACH_LINES = 4
"""Spectral lines on either side of the strongest one that belong to its peak under a Hann window."""
ONE_FREQUENCY = 0.5
"""Share of the power around the strongest line from which a record moves at one frequency."""
DEAD_SHARE = 1e-9
"""A channel is dead if it varies by less than this share of its largest value."""


def usable_channels(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the live vibration channels, and a finding on each that is left out.

    Frozen readings become missing samples.
    """
    vibration = [c.name for c in record.channels if c.quantity in VIBRATIONS]
    alive: list[str] = []
    record, frozen = without_stuck(record)
    findings = [Finding("stuck", name, {"share": share}) for name, share in frozen.items()]
    for channel, y in zip(record.channels, record.data, strict=True):
        if channel.name not in vibration:
            continue
        finite = y[np.isfinite(y)]
        if len(finite) < 0.5 * len(y):
            findings.append(Finding("empty", channel.name, {"share": 1.0 - len(finite) / max(len(y), 1)}))
        elif np.ptp(finite) <= max(DEAD_SHARE * np.abs(finite).max(), SMALLEST):
            findings.append(Finding("dead", channel.name))
        else:
            alive.append(channel.name)
    twins = duplicate_channels(record.select(alive).data) if alive else {}
    findings += [Finding("copied", alive[i], {"other": alive[j]}) for i, j in twins.items()]
    alive = [name for i, name in enumerate(alive) if i not in twins]
    if not alive:
        raise InputError(
            "no usable vibration channel" + "".join(f"; {finding}" for finding in findings),
            field="channels",
            value=list(record.channel_names),
            allowed=f"at least one live channel of {', '.join(sorted(VIBRATIONS))}",
            remedy="check the record's quantities and its data",
        )
    return record.select(alive), tuple(findings)


def resolve(record: Record, settings: IdentificationSettings) -> tuple[ResolvedSettings, Record]:
    """Choose the settings left open, and decimate."""
    _check_samples(record)
    low, high = _band(record, settings)
    rate = settings.sample_rate_hz
    if rate is None:
        rate = record.sample_rate_hz / max(int(record.sample_rate_hz / (SAMPLES_PER_CYCLE * high)), 1)
    n_channels = len(record.channels)
    window = settings.block_rows or _block_rows(rate / low, n_channels, record.duration_s * rate)
    _check_duration(record, low, 2.0 * window / rate)
    reduced = decimate(record, sample_rate_hz=rate) if rate < record.sample_rate_hz else record
    top = min(settings.max_order or MAX_ORDER, (window - 1) * n_channels)
    orders = _orders(settings.order_step, top)
    return ResolvedSettings(low, high, reduced.sample_rate_hz, window, orders, 2.0 * window / rate), reduced


def _block_rows(samples_a_cycle: float, n_channels: int, n_samples: float) -> int:
    """Return the number of block rows: cycles of the lower edge, and enough for models of few channels.

    Examples
    --------
    >>> _block_rows(14.2, 6, 12_000.0), _block_rows(14.2, 1, 12_000.0), _block_rows(14.2, 1, 400.0)
    (15, 41, 40)
    >>> _block_rows(64.0, 2, 60_000.0), _block_rows(64.0, 1, 60_000.0)
    (64, 150)
    """
    cycles = max(int(np.ceil(WINDOW_CYCLES * samples_a_cycle)), 4)
    wanted = -(-FEW_CHANNELS_ORDER // n_channels) + 1
    if n_channels == 1:
        wanted = max(
            wanted,
            int(min(np.ceil(SINGLE_CHANNEL_CYCLES * samples_a_cycle), SINGLE_CHANNEL_SHARE * n_samples)),
        )
    return max(cycles, min(wanted, int(0.5 * WINDOW_SHARE * n_samples)))


def with_orders(resolved: ResolvedSettings, wanted: Iterable[int]) -> ResolvedSettings:
    """Return the settings with further model orders, those beyond the highest left out."""
    top = resolved.orders[-1] if resolved.orders else 0
    more = {order for order in wanted if 1 <= order <= top}
    return replace(resolved, orders=tuple(sorted({*resolved.orders, *more})))


def dense_orders(resolved: ResolvedSettings, step: int) -> ResolvedSettings:
    """Return the settings with high model orders as dense as low ones: relaxations appear in few orders."""
    return replace(resolved, orders=_orders(step, resolved.orders[-1], resolved.orders[-1]))


def _orders(step: int, top: int, dense: int = DENSE_ORDERS) -> tuple[int, ...]:
    """Return the model orders; of high ones, which differ little, every second is left out.

    Examples
    --------
    >>> _orders(2, 30)
    (2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 28)
    """
    low = range(min(step, 2), min(top, dense) + 1, step)
    return (*low, *range(low[-1] + 2 * step, top + 1, 2 * step)) if len(low) else ()


def shortness(reduced: Record, resolved: ResolvedSettings, *, chosen: bool) -> tuple[Finding, ...]:
    """Return findings on what the record is too short for.

    Parameters
    ----------
    reduced : Record
        Record at the rate of the identification, with zero mean.
    chosen : bool
        Whether the lower edge of the band was chosen automatically.
    """
    low, duration = resolved.lowest_frequency_hz, reduced.duration_s
    at_peak = chosen and low * duration > 1.001 * FEWEST_CYCLES  # else the record is too short for that edge
    first = low / EDGE_BELOW_PEAK if at_peak else low
    out: tuple[Finding, ...] = ()
    if first * duration < SHORT_RECORD_CYCLES:
        params = {"duration_s": duration, "cycles": first * duration, "frequency_hz": first}
        out += (Finding("short_for_lowest", params=params),)
    strongest = _strongest_below(welch(reduced.data, reduced.sample_rate_hz), low) if chosen else None
    if strongest is not None and strongest * duration < SHORT_RECORD_CYCLES:
        out += (Finding("strong_below_band", params={"low_hz": low, "strongest_hz": strongest}),)
    return out


def _strongest_below(spectrum: Spectrum, low: float) -> float | None:
    """Return the frequency of strong motion below an edge, or None."""
    f, s = spectrum.frequencies_hz[1:], spectrum.singular_values[0, 1:]
    below, above = f < low, f >= low
    if not below.any() or s[below].max() < STRONG_RATIO * s[above].max():
        return None
    return float(f[below][np.argmax(s[below])])


def guarded_band_hz(resolved: ResolvedSettings) -> tuple[float, float]:
    """Return the band in which poles are sought: that of the modes plus a guard above it."""
    passed = resolved.sample_rate_hz / SAMPLES_PER_CYCLE
    high = max(min(GUARD * resolved.highest_frequency_hz, passed), resolved.highest_frequency_hz)
    return resolved.lowest_frequency_hz, high


def _band(record: Record, settings: IdentificationSettings) -> tuple[float, float]:
    nyquist = 0.5 * record.sample_rate_hz
    low = settings.lowest_frequency_hz
    if low is None:
        peak = lowest_motion_hz(record.data, record.sample_rate_hz)
        if peak is None:
            raise _without_peak(record)
        low = max(EDGE_BELOW_PEAK * peak, FEWEST_CYCLES / record.duration_s)
    limit = 2.0 / SAMPLES_PER_CYCLE * nyquist
    high = settings.highest_frequency_hz or min(BAND_RATIO * low, limit)
    if not low < high < nyquist:
        raise InputError(
            "the band of interest does not fit the record",
            field="lowest_frequency_hz, highest_frequency_hz",
            value=(low, high),
            allowed=f"0 < lowest < highest < {nyquist:g} Hz",
            remedy="choose a lower band or use a record of higher rate",
        )
    return low, high


def _without_peak(record: Record) -> InputError:
    """Return the error on a record without a clear peak: it moves for too few cycles, or it is noise."""
    seen = densities(record.data, record.sample_rate_hz, record.data.shape[1])
    share = np.mean(seen.density / seen.density.sum(axis=1, keepdims=True), axis=0)
    k = int(np.argmax(share))
    f = float(seen.frequencies_hz[k])
    value = f"a record of {record.duration_s:.0f} s"
    if share[max(k - REACH_LINES, 0) : k + REACH_LINES + 1].sum() > ONE_FREQUENCY and k > REACH_LINES:
        return InputError(
            "the record has too few cycles to be identified",
            field="duration_s",
            value=f"{k} cycles near {f:.2g} Hz in {value}",
            allowed=f"≥ {SHORT_RECORD_CYCLES:.0f} cycles, or a free decay by at least a factor of 2.7",
            remedy="measure for longer, or, after a pull, until the motion has died away",
        )
    return InputError(
        "no spectral peak is clear: the record is noise, or it is too short",
        field="lowest_frequency_hz",
        value=value,
        remedy="check that the sensors are connected and resolve the motion, and measure in more "
        "wind or for longer; to see the spectra nevertheless, state lowest_frequency_hz",
    )


def _check_samples(record: Record) -> None:
    n = record.data.shape[1]
    if n < FEWEST_SAMPLES:
        raise InputError(
            "record too short to identify anything",
            field="data",
            value=f"{n} samples",
            allowed=f"≥ {FEWEST_SAMPLES} samples",
            remedy="use a longer record",
        )


def _check_duration(record: Record, low: float, window_s: float) -> None:
    needed = max(window_s / WINDOW_SHARE, FEWEST_CYCLES / low)
    if record.duration_s < needed:
        raise InputError(
            "record too short for its lag window",
            field="duration_s",
            value=record.duration_s,
            allowed=f"≥ {needed:.0f} s for a lowest frequency of {low:.3g} Hz",
            remedy="use a longer record or raise lowest_frequency_hz",
        )
