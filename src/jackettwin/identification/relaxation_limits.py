r"""Detection limit of relaxations in a record of ambient vibration, found by adding some to the record.

A first-order process of rate a, with random amplitudes in all instruments, is added to the record, and the
search for real poles is run unchanged. The share of trials in which it reports a pole within a factor of two
of a rises with the process's rms. A logistic curve in ln rms is fitted; the detection limit is the rms at
which it reaches 95 %, with an interval for the number of trials. Thus no assumption on noise, forces, modes
and the rules of the search is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log, pi
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.optimize and scipy.signal are loaded where they are used

from jackettwin.arrays import FloatArray
from jackettwin.identification.decays.relaxations import POWER
from jackettwin.identification.pole_methods import relaxations
from jackettwin.identification.preparation.components import components
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.intervals import NORMAL_90
from jackettwin.progress import SILENT, Progress

if TYPE_CHECKING:
    from jackettwin.identification.preparation.prepared_record import PreparedRecord
    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.records import Record

RATES = 3
"""Number of rates, from the lowest of the band upwards."""
TRIALS = 40
"""Number of trials at each rate."""
ALIKE = 2.0
"""Factor within which a reported rate counts as that of the added process."""
WEAKEST, STRONGEST = 0.01, 8.0
"""Least and largest rms of the added process, in multiples of the record's."""
_HALVINGS = 6
"""Number of first trials, by bisection between missed and detected amplitudes."""
_SLOPE, _SLOPE_LOG_STD, _MIDDLE_STD = 3.0, 1.0, 3.0
"""Prior of the curve in ln rms: a rise from 5 to 95 % within a factor of seven, with a broad middle."""


@dataclass(frozen=True)
class AmbientLimit:
    """Detection limit of a relaxation of one rate.

    Attributes
    ----------
    rate_rad_s : float
    rms_share : float
        The rms, in multiples of the record's in the band, at which 95 % are found; infinite if it exceeds
        ``STRONGEST``.
    interval_90 : (low, high)
        Of ``rms_share``, for the number of trials.
    found, trials : int
    """

    rate_rad_s: float
    rms_share: float
    interval_90: tuple[float, float]
    found: int
    trials: int


@dataclass(frozen=True)
class AmbientLimits:
    """Detection limits of relaxations in a record of ambient vibration.

    Attributes
    ----------
    lowest_rate_rad_s, highest_rate_rad_s : float
        Ends of the band, outside which the search finds no relaxations.
    channels : names
    rms : (n_channels,)
        Of the channels within the band, in their units.
    limits : tuple of AmbientLimit
    """

    lowest_rate_rad_s: float
    highest_rate_rad_s: float
    channels: tuple[str, ...]
    rms: FloatArray
    limits: tuple[AmbientLimit, ...]


def ambient_limits(
    record: Record,
    settings: IdentificationSettings,
    *,
    rates: tuple[float, ...] = (),
    progress: Progress = SILENT,
) -> AmbientLimits:
    """Return the detection limits of relaxations in a record.

    Parameters
    ----------
    record, settings : as for the identification
    rates : [rad/s]; three from the lowest of the band upwards if none are given
    progress : receives a step for every rate

    Raises
    ------
    InputError
        As the identification.
    """
    ready = prepare(record, settings)
    band = ready.settings
    low, high = 2.0 * pi * band.lowest_frequency_hz, 2.0 * pi * band.highest_frequency_hz
    names, rms = tuple(c.name for c in ready.channels), ready.scale * np.nanstd(ready.y, axis=1)
    ready, _ = components(ready, settings)
    rng = np.random.default_rng(0)
    found = []
    for a in rates or tuple(np.geomspace(1.25 * low, min(8.0 * low, 0.8 * high), RATES)):
        progress(f"detection limit of relaxations at {a:.3g} rad/s")
        found.append(_limit(ready, settings, float(a), TRIALS, rng))
    return AmbientLimits(low, high, names, np.asarray(rms), tuple(found))


def with_relaxation(
    y: FloatArray, rate_rad_s: float, sample_rate_hz: float, rms: float, rng: np.random.Generator
) -> FloatArray:
    """Return channels with a stationary first-order process added, with random amplitudes.

    Parameters
    ----------
    y : (n_channels, n_samples)
    rms : root mean square of the process over all channels, in units of the channels
    """
    mu = np.exp(-rate_rad_s / sample_rate_hz)
    force = np.sqrt(1.0 - mu**2) * rng.standard_normal(y.shape[1])
    process = scipy.signal.lfilter([1.0], [1.0, -mu], force)
    shape = rng.standard_normal(len(y))
    shape *= np.sqrt(len(y)) / np.linalg.norm(shape)
    return np.asarray(y + rms * np.outer(shape * np.nanstd(y, axis=1), process))


def _limit(
    ready: PreparedRecord,
    settings: IdentificationSettings,
    rate: float,
    trials: int,
    rng: np.random.Generator,
) -> AmbientLimit:
    """Return the limit at one rate; each trial is made at the most informative amplitude."""
    sizes: list[float] = []
    seen: list[bool] = []
    low, high, logit = log(WEAKEST), log(STRONGEST), log(POWER / (1.0 - POWER))
    for k in range(trials):
        if k < _HALVINGS:
            x = _bisected(sizes, seen, low, high)
        else:
            # from slightly below the middle to beyond the 95 % point
            middle, slope, _ = _curve(np.array(sizes), np.array(seen))
            x = middle + logit / slope * rng.uniform(-0.3, 1.1)
        x = float(np.clip(x, low, high))
        y = with_relaxation(ready.y, rate, ready.settings.sample_rate_hz, float(np.exp(x)), rng)
        there = relaxations(replace(ready, y=y), settings)
        sizes.append(x)
        seen.append(any(abs(log(p.rate_rad_s / rate)) < log(ALIKE) for p in there))
    middle, slope, covariance = _curve(np.array(sizes), np.array(seen))
    x95 = middle + logit / slope
    by = np.array([1.0, -logit / slope])  # derivatives of x95 with respect to middle and ln slope
    std = float(np.sqrt(by @ covariance @ by))
    beyond = x95 > high
    interval = (float(np.exp(x95 - NORMAL_90 * std)), float(np.exp(x95 + NORMAL_90 * std)))
    return AmbientLimit(rate, float("inf") if beyond else float(np.exp(x95)), interval, sum(seen), trials)


def _bisected(sizes: list[float], seen: list[bool], low: float, high: float) -> float:
    """Return the middle between the largest missed and the smallest detected size."""
    missed = [x for x, s in zip(sizes, seen, strict=True) if not s]
    there = [x for x, s in zip(sizes, seen, strict=True) if s]
    return 0.5 * (max(missed, default=low) + min(there, default=high))


def _curve(x: FloatArray, seen: FloatArray) -> tuple[float, float, FloatArray]:
    """Return the middle and slope of the logistic curve, and the covariance of (middle, ln slope)."""

    def cost(p: FloatArray) -> float:
        z = np.exp(p[1]) * (x - p[0])
        fit = np.sum(np.logaddexp(0.0, np.where(seen, -z, z)))
        prior = ((p[1] - log(_SLOPE)) / _SLOPE_LOG_STD) ** 2 + ((p[0] - x.mean()) / _MIDDLE_STD) ** 2
        return float(fit + 0.5 * prior)

    found = scipy.optimize.minimize(cost, np.array([x.mean(), log(_SLOPE)]), method="BFGS")
    middle, log_slope = found.x
    p = 1.0 / (1.0 + np.exp(-np.exp(log_slope) * (x - middle)))
    by = np.stack([np.full(len(x), -np.exp(log_slope)), np.exp(log_slope) * (x - middle)])
    information = (by * (p * (1.0 - p))) @ by.T + np.diag([_MIDDLE_STD**-2, _SLOPE_LOG_STD**-2])
    return float(middle), float(np.exp(log_slope)), np.linalg.inv(information)
