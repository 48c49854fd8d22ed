"""Faults of one channel: detectors of logger and sensor errors, and the findings on them.

Every detector takes the samples of one channel, NaN where missing,
and returns what it detects without changing them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage
from scipy.special import ndtri

from jackettwin.arrays import BoolArray, FloatArray, Int64Array
from jackettwin.findings import Finding
from jackettwin.intervals import NORMAL_OF_MAD
from jackettwin.records.processing.filters import bridge
from jackettwin.records.record import SMALLEST
from jackettwin.signals import runs

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.records.record import Channel


SPIKE_WINDOW = 9
"""Window of the running median; a spike is shorter than half of it [samples]."""
SPIKE_BLOCK = 256
"""Length of the blocks over which the local scatter is taken [samples]."""
ONSET_BLOCK, ONSET_SHARE, ONSET_RATIO = 32, 0.85, 2.0
"""Where motion sets in, as after a release, it is stronger than around it for less than ``SPIKE_BLOCK``: the
scatter of blocks of 32 samples counts, taken from a share of them that spikes leave alone, where it is more
than twice that of the long blocks (in steady noise it is at most 1.6 times)."""
SPIKE_SIGMAS = 8.0
"""Smallest distance of a spike from the running median, in robust standard deviations;
its probability in Gaussian noise is 1e-15."""
CREST_SIGMAS = 4.0
"""Smallest distance in robust standard deviations of the window; the crest of a smooth wave,
which the median cuts, reaches 0.8."""
RAIL_RATIO = 5.0
"""Smallest ratio of samples at a rail to samples at the next levels; a pure sine reaches 3."""
MIN_AT_RAIL = 5
"""Fewest samples at an extreme that count as a rail."""
STUCK_RUN_RATIO = 50.0
"""Length of a run of equal values, over the channel's usual run, from which it is a frozen reading."""
MAX_UNSTEADINESS = 1e9
"""Upper limit of the reported unsteadiness, for a signal that is zero except in one part."""


MAX_LEVELS = 64
"""Most levels of a coarsely quantised channel."""
ROUNDING = 1.0 / (NORMAL_OF_MAD * np.sqrt(12.0))
"""Scatter of rounding errors over the quantisation step, as a median departure."""
MIN_SAMPLES_PER_LEVEL = 20
"""Fewest samples per level; with fewer, a channel may have few levels by chance."""


def quantiser_step(y: FloatArray) -> float:
    """Return the quantisation step of a channel with few levels, else 0, as of one that hardly leaves one.

    >>> float(quantiser_step(np.tile([0.0, 0.5, 1.0, 2.0], 100)))
    0.5
    """
    finite = y[np.isfinite(y)]
    most = min(MAX_LEVELS, len(finite) / MIN_SAMPLES_PER_LEVEL)
    if len(np.unique(finite[: 4 * MAX_LEVELS])) > most:
        return 0.0
    levels, samples = np.unique(finite, return_counts=True)
    told = 2 <= len(levels) <= most and len(finite) - samples.max() >= MIN_SAMPLES_PER_LEVEL
    return float(np.min(np.diff(levels))) if told else 0.0


STRAIGHT = 4.0 * float(np.finfo(np.float32).eps)
"""Largest bend of a line over its samples: three samples of single precision, the middle one twice."""
SMALL_ROUNDING = 0.05
"""Largest share of that in the median bend, so that a line is no part of a smooth motion by chance."""


def is_constant(y: FloatArray) -> bool:
    """Tell whether no two samples differ by more than rounding, or there are fewer than two."""
    finite = y[np.isfinite(y)]
    if len(finite) < 2:
        return True
    return bool(np.ptp(finite) <= max(4.0 * np.spacing(np.abs(finite).max()), SMALLEST))


def spikes(y: FloatArray, *, hold: int = 1) -> BoolArray:
    """Mark short excursions of large amplitude (fewer than five samples).

    The excursion must exceed ``SPIKE_SIGMAS`` robust standard deviations of the departures from
    the running median, both of the whole channel and of the surroundings (neither a gust nor the first
    motion after a release is a spike);
    ``CREST_SIGMAS`` of the window (nor is the crest of a smooth wave, whose flanks the median follows);
    and one robust standard deviation of the signal, as smaller ones are harmless. The rounding of a
    coarsely quantised channel has a standard deviation of 0.29 steps, below which no scatter is taken.
    ``hold`` is the number of samples for which each value is repeated.
    """
    finite = np.isfinite(y)
    if finite.sum() < 2 * SPIKE_WINDOW or is_constant(y):
        return np.zeros(len(y), dtype=np.bool_)
    x = bridge(y)
    median = ndimage.median_filter(x, size=(SPIKE_WINDOW - 1) * hold + 1, mode="nearest")
    departure = np.abs(x - median)
    usual = np.maximum(_surroundings(departure, SPIKE_BLOCK, 0.5), np.median(departure[finite]))
    brief = _surroundings(departure, ONSET_BLOCK * hold, ONSET_SHARE)
    usual = np.where(brief > ONSET_RATIO * usual, brief, usual)
    rounding = ROUNDING * quantiser_step(y)
    usual = np.maximum(usual, rounding)
    quartiles = np.percentile(y[finite], [25.0, 75.0])
    least = max(float(quartiles[1] - quartiles[0]) / 1.349, 1e-12 * float(np.ptp(y[finite])))
    far: BoolArray = finite & (departure > np.maximum(SPIKE_SIGMAS * NORMAL_OF_MAD * usual, least))
    at = np.flatnonzero(far)
    far[at] = departure[at] > CREST_SIGMAS * NORMAL_OF_MAD * np.maximum(_spread_around(x, at, hold), rounding)
    return far


def _spread_around(x: FloatArray, at: Int64Array, hold: int) -> FloatArray:
    """Return the median departure from the median within the window around some samples."""
    reach = hold * np.arange(-(SPIKE_WINDOW // 2), SPIKE_WINDOW // 2 + 1)
    window = x[np.clip(at[:, None] + reach, 0, len(x) - 1)]
    out: FloatArray = np.median(np.abs(window - np.median(window, axis=1, keepdims=True)), axis=1)
    return out


def _surroundings(departure: FloatArray, block: int, share: float) -> FloatArray:
    """Return for every sample the largest scatter of its block and the two adjacent ones.

    Parameters
    ----------
    departure : (n_samples,)
    block : length of a block [samples]
    share : of a block's samples whose largest departure measures its scatter

    Returns
    -------
    (n_samples,)
        As medians: a departure that this share of Gaussian noise does not exceed, times that of a half.
    """
    n_blocks = max(len(departure) // block, 1)
    block = len(departure) // n_blocks
    blocks = departure[: n_blocks * block].reshape(n_blocks, block)
    scatter = np.quantile(blocks, share, axis=1) * (ndtri(0.75) / ndtri(0.5 + 0.5 * share))
    wide = np.repeat(ndimage.maximum_filter1d(scatter, 3, mode="nearest"), block)
    return np.pad(wide, (0, len(departure) - len(wide)), mode="edge")


def clipped(y: FloatArray) -> BoolArray:
    """Mark samples at a rail: many equal extremes with few samples at the levels beside them."""
    mask = np.zeros(len(y), dtype=np.bool_)
    values = y[np.isfinite(y)]
    rails = (values.min(), values.max()) if values.size else ()
    if all(np.count_nonzero(values == rail) < MIN_AT_RAIL for rail in rails):
        return mask
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < 2 * MIN_AT_RAIL:
        return mask
    for rail, at_rail, beside in (
        (levels[-1], counts[-1], counts[-4:-1]),
        (levels[0], counts[0], counts[1:4]),
    ):
        if at_rail >= MIN_AT_RAIL and at_rail > RAIL_RATIO * max(float(np.mean(beside)), 1.0):
            mask |= y == rail
    return mask


def stuck(y: FloatArray, shortest: int) -> BoolArray:
    """Mark runs on one line that are at least ``shortest`` samples and much longer than usual.

    A line is one value, or where a logger or an export joined the ends of a gap.
    """
    mask = np.zeros(len(y), dtype=np.bool_)
    if is_constant(y):
        return mask
    # A run of n equal values shows as n − 1 steps of zero, one of n values on a line as n − 2 bends of zero.
    step = np.diff(y)
    for straight, others in ((step == 0.0, 1), (_no_bend(y, step), 2)):
        found = runs(straight)
        usual = len(y) / max(len(y) - int(straight.sum()), 1)
        least = max(shortest, STUCK_RUN_RATIO * usual)
        for start, length in found[found[:, 1] + others >= least]:
            mask[start : start + length + others] = True
    return mask


def _no_bend(y: FloatArray, step: FloatArray) -> BoolArray:
    """Tell where three samples lie on a line, to the rounding of single precision, (n_samples − 2,).

    Nowhere if that rounding is not small beside the bends of the motion, as on a large offset.
    """
    bend, rounding = np.abs(np.diff(step)), STRAIGHT * np.abs(y[1:-1])
    some = slice(None, None, max(len(bend) // 4096, 1))
    there = np.isfinite(bend[some])
    if not there.any() or not (
        np.median(rounding[some][there]) < SMALL_ROUNDING * np.median(bend[some][there])
    ):
        return np.zeros(len(bend), dtype=np.bool_)
    return np.asarray(bend <= np.maximum(rounding, STRAIGHT * np.abs(y[2:])))


def hold_length(y: FloatArray) -> int:
    """Return how many samples each value is repeated; above 1, the channel has a lower rate."""
    finite = np.isfinite(y)
    if finite.sum() < 20 or is_constant(y):
        return 1
    changes = np.flatnonzero(np.diff(y[finite]) != 0.0)
    steps = np.diff(changes)
    if len(steps) < 5 or 2 * np.count_nonzero(steps == 1) > len(steps):
        return 1
    usual = int(np.median(steps))
    regular = float(np.mean(steps % usual == 0))
    return usual if regular > 0.9 else 1


def drift_ratio(slow: FloatArray, fast: FloatArray) -> float:
    """Return the ratio of the range of the slow part to the standard deviation of the fast part."""
    finite = np.isfinite(slow) & np.isfinite(fast)
    if finite.sum() < 2:
        return 0.0
    scale = float(np.std(fast[finite]))
    return float(np.ptp(slow[finite])) / scale if scale > 0.0 else 0.0


def unsteadiness(y: FloatArray, n_parts: int) -> float:
    """Return the ratio of the rms of the strongest part of a channel to the median of its parts.

    Parameters
    ----------
    y : (n_samples,)
        Zero mean; NaN marks missing samples.

    Examples
    --------
    >>> unsteadiness(np.array([1.0, -1.0, 1.0, -1.0, 5.0, -5.0]), 3)
    5.0
    """
    parts = [part[np.isfinite(part)] for part in np.array_split(y, n_parts)]
    rms = np.array([np.sqrt(np.mean(part**2)) for part in parts if len(part)])
    if len(rms) < n_parts or not rms.max() > 0.0:
        return 1.0
    return float(min(rms.max() / max(float(np.median(rms)), SMALLEST), MAX_UNSTEADINESS))


DRIFT_RATIO = 3.0
"""Ratio of the range of the slow part to the rms of the rest above which it is drift."""
UNSTEADY_RATIO = 4.0
"""Ratio of the rms of the strongest part to the median above which a record is not stationary.
A lightly damped tower under steady forces reaches 2, also in turbulence."""
COARSE_STEPS = 0.7
"""Quantisation step over the rms of the vibration above which rounding is not white noise of step²/12.
A Gaussian signal allows a step of its standard deviation (Widrow & Kollár 2008), others less."""


@dataclass(frozen=True)
class ChannelQuality:
    """Quality measures of one channel; shares are of all samples."""

    name: str
    score: float
    dead: bool
    gap_share: float
    longest_gap_s: float
    spike_share: float
    clipped_share: float
    stuck_share: float
    changed_share: float
    hold_length: int
    drift_ratio: float
    unsteadiness: float
    swapped_sign: bool
    quantiser_steps: float = 0.0
    """Quantisation step over the rms of the vibration; 0 if it is fine."""


def channel_findings(
    channel: Channel, q: ChannelQuality, *, empty: bool, outliers: bool, sign: bool | None
) -> Iterator[Finding]:
    """Yield the findings on one channel."""
    name = q.name
    if empty:
        yield Finding("empty", name, {"share": q.gap_share}, repaired=True)
        return
    if q.dead:
        yield Finding("dead", name, repaired=True)
        return
    if q.gap_share > 0.0:
        yield Finding("gaps", name, {"share": q.gap_share, "longest_s": q.longest_gap_s})
    if outliers:
        yield Finding("outliers", name, {"share": q.spike_share})
    elif q.spike_share > 0.0:
        yield Finding("spikes", name, {"share": q.spike_share}, repaired=True)
    yield from _signal_findings(channel, q)
    if sign is not None:
        yield Finding("sign_turned" if sign else "sign_unclear", name, repaired=sign)


def _signal_findings(channel: Channel, q: ChannelQuality) -> Iterator[Finding]:
    """Yield findings on the sensor's range, its resolution and its zero."""
    name = q.name
    if q.clipped_share > 0.0:
        # clipped samples are kept: the covariances of a clipped Gaussian signal keep their shape (Bussgang
        # 1952), whereas those of a signal with gaps at its peaks do not
        yield Finding("clipped", name, {"share": q.clipped_share})
    if q.stuck_share > 0.0:
        yield Finding("stuck", name, {"share": q.stuck_share}, repaired=True)
    if q.hold_length > 1:
        yield Finding("held", name, {"times": q.hold_length})
    if q.quantiser_steps > COARSE_STEPS:
        yield Finding("coarse_quantiser", name, {"steps": q.quantiser_steps})
    if _drifts(channel, q):
        yield Finding("drift", name, {"ratio": q.drift_ratio}, repaired=True)
    if q.unsteadiness > UNSTEADY_RATIO:
        yield Finding("unsteady", name, {"ratio": q.unsteadiness})


def _drifts(channel: Channel, q: ChannelQuality) -> bool:
    """Tell drift from quasi-static response, which displacement, strain and tilt have."""
    return channel.quantity in ("acceleration", "velocity") and q.drift_ratio > DRIFT_RATIO
