r"""Relaxations of a structure that was pulled aside and released, and their detection limits.

After the release at t = 0 each channel is the sum of a constant, modes (fitted first) and a relaxation,

.. math:: y_c(t) = b_c + \mathrm{Re} \sum_m a_{cm} e^{\lambda_m t} + A_c e^{-at} + e_c(t).

For a given rate a the model is linear in the amplitude A_c: with g the part of :math:`e^{-at}` orthogonal to
the constant, the modes :math:`e^{\lambda_m t}` and their derivatives :math:`t e^{\lambda_m t}`, which hold
errors of the poles and the difference between the two poles of a pair fitted as one,
:math:`\hat A_c = g^T y_c/g^T g`. Its variance and degrees of freedom are those for noise with the spectrum of
the residual of the whole fit, so that :math:`\hat A_c/\sigma_c` follows Student's t distribution. Where the
residual is clearly stronger while g lasts than in the mean (motion of modes too weak to be fitted),
:math:`\sigma_c` is enlarged by that ratio. A relaxation is detected if any channel at any rate of a grid
passes the test; the thresholds limit false alarms to 5 % of records over all channels and rates
(Bonferroni). A relaxation of amplitude

.. math:: A_c = (t_{1-\alpha/2} + t_{0.95})\,\sigma_c

passes the test in 95 % of records: this is the detection limit. Relaxations whose rates are too close for
data of this length to separate are detected as one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.optimize and scipy.special are loaded where they are used
from numpy import fft

from jackettwin.arrays import FloatArray
from jackettwin.identification.decays.damped_cosines import DampedCosines, damped_cosines
from jackettwin.identification.decays.modes_of_decay import modes_of_decay
from jackettwin.identification.estimate import RealPole
from jackettwin.identification.mode_shapes import aligned, normalised
from jackettwin.identification.preparation.resolve import usable_channels
from jackettwin.intervals import NORMAL_90, QUANTILES, log_interval_90
from jackettwin.records import decimate
from jackettwin.records.processing.filters import bridge
from jackettwin.signals import next_fast_len

if TYPE_CHECKING:
    from jackettwin.records import Channel, Record

FALSE_ALARMS = 0.05
"""Largest share of records without a relaxation in which one is reported."""
POWER = 0.95
"""Probability of detecting a relaxation at the limit."""
RATES = 12
"""Number of rates of the grid."""
SLOWEST = 6.0
"""Product of the slowest rate of the grid and the time after the release; slower relaxations cannot be
separated from the constant."""
FASTEST = 2.0
"""Ratio of the fastest rate of the grid to the angular frequency of the strongest mode."""
SAMPLES_PER_CYCLE = 40.0
"""Most samples per cycle of the strongest mode: no relaxation of the grid needs more."""
SETTLING_SAMPLES = 26
"""Samples after the release that the filter before decimation blurs."""
MIN_EXPLAINED = 0.9
"""Smallest share of the motion after a release that its modes explain."""
MIN_FALL = 4.0
"""Least ratio of the power right after a release to that at the end of the record."""
ONSET_RATIO = 10.0
"""Smallest ratio of the power after a release to that before; with a lower one the record begins after the
release."""
_ROUNDS = 3
"""Number of times that modes and relaxation are fitted in turn."""
_STILL = 1e-6
"""Share of the mean power below which a channel counts as not moving."""
MIN_SAMPLES = 256
NOT_BY_CHANCE = 1e-3
"""Probability below which steady noise does not explain that it is strongest while a relaxation lasts."""


@dataclass(frozen=True)
class RelaxationLimit:
    """Detection limit of a relaxation at one rate.

    Attributes
    ----------
    rate_rad_s : float
    amplitude : (n_channels,)
        Smallest detectable amplitude in the units of the channels: for a release, A at that instant; for
        ambient vibration, the rms. Infinite where no relaxation would be detected.
    """

    rate_rad_s: float
    amplitude: FloatArray


@dataclass(frozen=True)
class ReleaseRelaxations:
    """Relaxations of a release test.

    Attributes
    ----------
    release_s : float
        Time of the release from the start of the record.
    channels : tuple of Channel
    pole : RealPole or None
        The relaxation that leaves the smallest residual, if any passes the test; its shape is A_c.
    amplitude : (n_channels,)
        Amplitudes of the pole at the release; zero without one.
    limits : tuple of RelaxationLimit
        One for each rate of the grid, slowest first.
    """

    release_s: float
    channels: tuple[Channel, ...]
    pole: RealPole | None
    amplitude: FloatArray
    limits: tuple[RelaxationLimit, ...]


@dataclass(frozen=True)
class AmplitudeTest:
    """Amplitudes of exp(−at) fitted together with given decays, for rates of a grid.

    Attributes
    ----------
    rates : (n_rates,) [rad/s]
    amplitude, std : (n_rates, n_channels)
    critical : (n_rates, n_channels)
        Threshold of |amplitude|/std.
    limit : (n_rates, n_channels)
        Amplitude that passes with probability ``POWER``.
    """

    rates: FloatArray
    amplitude: FloatArray
    std: FloatArray
    critical: FloatArray
    limit: FloatArray

    @property
    def passed(self) -> bool:
        """Whether any amplitude exceeds its threshold."""
        return bool(np.any(np.abs(self.amplitude) > self.critical * self.std))


def release_relaxations(record: Record) -> ReleaseRelaxations | None:
    """Return the relaxations of a record in which a structure is released; None if it contains no free decay.

    Parameters
    ----------
    record : Record
        As it was measured: accelerations, or better displacements or strains, which show slow motion.

    Raises
    ------
    InputError
        If no channel is usable.
    """
    usable, _ = usable_channels(record)
    usable = usable.select([c.name for c, row in zip(usable.channels, usable.data, strict=True)
                            if not np.isnan(row).all()])  # fmt: skip
    data = np.apply_along_axis(bridge, 1, usable.data)
    if data.shape[1] < MIN_SAMPLES:
        return None
    strongest = _strongest_hz(data, usable.sample_rate_hz)
    factor = max(int(usable.sample_rate_hz / (SAMPLES_PER_CYCLE * strongest)), 1)
    level = decimate(replace(usable, data=data), sample_rate_hz=usable.sample_rate_hz / factor)
    fs = level.sample_rate_hz
    release = onset(level.data, fs, strongest)
    first = int(np.ceil(release * fs)) + (SETTLING_SAMPLES if factor > 1 and release > 0.0 else 1)
    y = level.data[:, first:]
    if y.shape[1] < MIN_SAMPLES or _fall(y) < MIN_FALL:
        return None
    modes = modes_of_decay(y, fs, strongest, None)
    if modes is None or modes.fit.explained < MIN_EXPLAINED:
        return None
    late, rates = first / fs - release, grid(y.shape[1] / fs, strongest)
    pole, amplitude, limits = _tested(y, fs, modes.fit, rates)
    if pole is not None:
        amplitude = amplitude * np.exp(pole.rate_rad_s * late)  # at the release, not at the first sample
    return ReleaseRelaxations(
        release,
        usable.channels,
        pole,
        amplitude,
        tuple(
            RelaxationLimit(float(a), row * np.exp(a * late)) for a, row in zip(rates, limits, strict=True)
        ),
    )


def _tested(
    y: FloatArray, sample_rate_hz: float, fit: DampedCosines, rates: FloatArray
) -> tuple[RealPole | None, FloatArray, FloatArray]:
    """Return the relaxation next to fitted modes, its amplitudes, and the limits (n_rates, n_channels)."""
    t = np.arange(y.shape[1]) / sample_rate_hz
    pole, amplitude, slow = None, np.zeros(len(y)), np.zeros_like(y)
    f, zeta = fit.frequency_hz, fit.damping_ratio
    test = amplitude_test(y, sample_rate_hz, f, zeta, rates)
    for _ in range(_ROUNDS if test.passed else 0):
        pole, amplitude = _pole(y, sample_rate_hz, f, zeta, test)
        slow = np.outer(amplitude, np.exp(-pole.rate_rad_s * t))
        # refit the modes without the relaxation
        fit = damped_cosines(y - slow, sample_rate_hz, f, zeta)
        f, zeta = fit.frequency_hz, fit.damping_ratio
        test = amplitude_test(y, sample_rate_hz, f, zeta, rates)
    if pole is not None and not rates[0] <= pole.rate_rad_s <= rates[-1]:
        # beyond the rates that were tested: what is left of modes that the fit does not hold
        pole, amplitude, slow = None, np.zeros(len(y)), np.zeros_like(y)
    return pole, amplitude, amplitude_test(y - slow, sample_rate_hz, f, zeta, rates).limit


def grid(duration_s: float, strongest_hz: float) -> FloatArray:
    """Return the rates that are tested [rad/s], slowest first."""
    return np.geomspace(SLOWEST / duration_s, FASTEST * 2.0 * np.pi * strongest_hz, RATES)


def onset(y: FloatArray, sample_rate_hz: float, strongest_hz: float) -> float:
    """Return the time of a release [s]: where the ratio of the power after to that before is largest.

    It is 0 if the record begins after the release.

    Parameters
    ----------
    y : (n_channels, n_samples)
    """
    width = max(round(0.5 * sample_rate_hz / strongest_hz), 4)
    power = np.diff(y, axis=1) ** 2
    total = np.cumsum(np.pad(power, ((0, 0), (1, 0))), axis=1)
    k = np.arange(width, power.shape[1] - width)
    before, after = total[:, k] - total[:, k - width], total[:, k + width] - total[:, k]
    least = _STILL * width * power.mean(axis=1, keepdims=True) + 1e-300
    ratio = np.max(after / (before + least), axis=0)
    best = int(np.argmax(ratio))
    if ratio[best] <= ONSET_RATIO:
        return 0.0
    # refined by the likelihood of a change of variance: an early estimate would include rest in the decay
    low, high = max(k[best] - width, 0), min(k[best] + 2 * width, power.shape[1])
    near = power[:, low:high] + least / width
    cut = np.arange(2, high - low - 2)
    part = np.cumsum(near, axis=1)
    earlier, later = part[:, cut - 1], part[:, -1:] - part[:, cut - 1]
    cost = np.sum(
        cut * np.log(earlier / cut) + (high - low - cut) * np.log(later / (high - low - cut)), axis=0
    )
    return float((low + cut[int(np.argmin(cost))]) / sample_rate_hz)


def amplitude_test(
    y: FloatArray,
    sample_rate_hz: float,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    rates: FloatArray,
) -> AmplitudeTest:
    """Return amplitudes of exp(−at) in addition to the decays of given modes, tested together.

    Parameters
    ----------
    y : (n_channels, n_samples)
    frequency_hz, damping_ratio : (n_modes,)
    rates : (n_rates,) [rad/s]
    """
    t = np.arange(y.shape[1]) / sample_rate_hz
    q = _basis(t, frequency_hz, damping_ratio)
    left = y - (y @ q) @ q.T
    alpha = FALSE_ALARMS / (len(rates) * len(y))
    rows = []
    for a in rates:
        g = np.exp(-a * t)
        g = g - q @ (q.T @ g)
        g /= g @ g
        amplitude = left @ g
        std, freedom = _in_noise(g, left - np.outer(amplitude, g / (g @ g)))
        critical = scipy.special.stdtrit(freedom, 1.0 - 0.5 * alpha)
        needed = scipy.special.nctdtrinc(freedom, 1.0 - POWER, critical)
        rows.append((amplitude, std, critical, needed * std))
    return AmplitudeTest(rates, *(np.array(column) for column in zip(*rows, strict=True)))


def _pole(
    y: FloatArray,
    sample_rate_hz: float,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    test: AmplitudeTest,
) -> tuple[RealPole, FloatArray]:
    """Return the relaxation of smallest residual, and its amplitudes at the first sample."""
    t = np.arange(y.shape[1]) / sample_rate_hz
    q = _basis(t, frequency_hz, damping_ratio)
    left = y - (y @ q) @ q.T
    ratio = np.sum((test.amplitude / test.std) ** 2, axis=1)
    start = np.log(test.rates[int(np.argmax(ratio))])
    sigma = np.sqrt(np.mean(_left(left, q, t, start)[2] ** 2, axis=1)) + 1e-300
    found = scipy.optimize.minimize_scalar(
        lambda log_a: float(np.sum((_left(left, q, t, log_a)[2] / sigma[:, None]) ** 2)),
        bounds=(start - 1.0, start + 1.0),
        method="bounded",
        options={"xatol": 1e-7},
    )
    g, amplitude, residual = _left(left, q, t, found.x)
    # derivative of the residual by ln a; sandwich variance for coloured noise
    slope = -np.exp(found.x) * t * np.exp(-np.exp(found.x) * t)
    slope = slope - q @ (q.T @ slope)
    slope -= g * (g @ slope) / (g @ g)
    weight = amplitude / sigma**2
    information = float(slope @ slope * np.sum(amplitude * weight))
    std, freedom = _in_noise(slope, np.sum(weight[:, None] * residual, axis=0)[None])
    wider = float(scipy.special.stdtrit(freedom[0], QUANTILES[-1]) / NORMAL_90)
    log_std, a = wider * float(std[0]) / information, float(np.exp(found.x))
    shape = normalised(aligned(amplitude.astype(complex)))
    return RealPole(a, a * log_std, log_interval_90(a, log_std), shape, 1.0), amplitude


def _left(
    left: FloatArray, q: FloatArray, t: FloatArray, log_a: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the part g of exp(−at) orthogonal to the modes, its amplitudes, and the residual of the fit."""
    g = np.exp(-np.exp(log_a) * t)
    g = g - q @ (q.T @ g)
    amplitude = left @ g / (g @ g)
    return g, amplitude, left - np.outer(amplitude, g)


def _basis(t: FloatArray, frequency_hz: FloatArray, damping_ratio: FloatArray) -> FloatArray:
    """Return an orthonormal basis of a constant, the modes' decays and their derivatives by the poles.

    Returns
    -------
    (n_samples, 4 n_modes + 1)
    """
    poles = 2.0 * np.pi * frequency_hz * (-damping_ratio + 1j * np.sqrt(1.0 - damping_ratio**2))
    decays = np.exp(np.outer(t, poles))
    decays = np.hstack([decays, t[:, None] * decays * poles.real])
    return np.linalg.qr(np.concatenate([decays.real, decays.imag, np.ones((len(t), 1))], axis=1))[0]


def _in_noise(g: FloatArray, noise: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the standard deviation of g·e for noise e with a sample's spectrum, and its degrees of freedom.

    Parameters
    ----------
    g : (n_samples,)
    noise : (n_channels, n_samples)
    """
    n = noise.shape[1]
    size = next_fast_len(n + len(g))
    lines = np.abs(fft.rfft(noise, size, axis=1)) ** 2 / n
    weight = np.abs(fft.rfft(g, size)) ** 2
    weight[1:] *= 2.0
    each = weight * lines
    variance = each.sum(axis=1) / size
    # two degrees of freedom per line of the sample that g rests on; at least white noise of this power
    freedom = max(2.0 * weight.sum() ** 2 / np.sum(weight**2) * n / size, 3.0)
    # the residual has one fewer: the fit removed the component along g
    variance *= freedom / (freedom - 1.0)
    power = noise**2
    white = np.mean(power, axis=1) * (g @ g)
    std = np.sqrt(np.maximum(variance, white) * _concentration(g, power, lines)) + 1e-300
    return std, np.full(len(noise), freedom - 1.0)


def _concentration(g: FloatArray, power: FloatArray, lines: FloatArray) -> FloatArray:
    """Return the power of noise while g lasts over its mean where chance does not explain it, else 1.

    Parameters
    ----------
    power : (n_channels, n_samples)
    lines : (n_channels, n_lines)
        The noise's spectrum: the narrower, the fewer independent samples g spans.
    """
    weight = g**2 / (g @ g)
    ratio = (power @ weight) / (np.mean(power, axis=1) + 1e-300)
    independent = np.mean(lines, axis=1) ** 2 / (np.mean(lines**2, axis=1) + 1e-300) / (weight @ weight)
    freedom = np.maximum(2.0 * independent, 1.0)
    by_chance = scipy.special.chdtri(freedom, NOT_BY_CHANCE) / freedom
    return np.where(ratio > by_chance, ratio, 1.0)


def _strongest_hz(y: FloatArray, sample_rate_hz: float) -> float:
    """Return the frequency of most power of the velocity, in which slow motion does not hide it."""
    speed = np.diff(y, axis=1)
    lines = np.abs(fft.rfft(speed * np.hanning(speed.shape[1]), axis=1)) ** 2
    k = int(np.argmax(np.mean(lines / (lines.sum(axis=1, keepdims=True) + 1e-300), axis=0)[1:])) + 1
    return float(k * sample_rate_hz / speed.shape[1])


def _fall(y: FloatArray) -> float:
    """Return the power of the first quarter over that of the last."""
    n = y.shape[1] // 4
    speed = np.diff(y, axis=1)
    power = np.mean((speed / (speed.std(axis=1, keepdims=True) + 1e-300)) ** 2, axis=0)
    return float(power[:n].mean() / (power[-n:].mean() + 1e-300))
