r"""Speed of a rotor estimated without a speed signal, from tones with coupled phases.

The orders 1P, 3P and 6P of a rotor follow one angle: whatever the speed and the wind, the phase of a higher
order is a multiple of that of a lower one. In pairs of bands at f and r f, with r = 2 for 3P and 6P and r = 3
for 1P and 3P, the analytic signals a and b of the channels' best combination are compared by

.. math:: C = \Bigl|\frac1T \int \frac{b\,\bar a^{\,r}}{|b|\,|a|^r} dt\Bigr| ,

which is 1 for tones, however their frequency and amplitude vary, and small for two modes, whose phases are
independent under random forces. The value that occurs by chance is found from the same record: shifting b
against a in time preserves each signal but destroys the relation between two orders.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.tones.bands import MAX_ELEMENTS, Band, bands_of, overlapping_bands
from jackettwin.identification.tones.phase_track import baseband
from jackettwin.identification.tones.sinusoid import lines_around, sinusoid, transform

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


PAIRS = ((3, 1, 3), (2, 3, 6))
"""Ratio of two compared orders, the lower order, and the higher."""
ORDERS = (1, 3, 6)
"""Multiples of the speed at which three blades excite a tower."""
HIGHER = range(9, 31, 3)
"""Higher multiples, which are reported only where a tone is detected, since most of them are too weak."""
MIN_RATIO = 8.0
"""Smallest D (``sinusoid.py``) of a higher order after removal of the phase that follows from the speed. At
rated speed of an offshore turbine the orders 9 to 24 have 9 to 60 and other multiples up to 5; modes at the
frequency of an order have up to 3."""
WIDTHS = (0.015, 0.05)
"""Half widths of the bands, as a share of their middle."""
MIN_LINES = 5.0
"""Fewest Fourier lines in half a band."""
STEP = 0.5
"""Distance of neighbouring bands, in half widths."""
HIGHEST = 0.45
"""Highest band, as a share of the sample rate."""
LEAST_SPEED_HZ, MOST_SPEED_HZ = 0.04, 0.6
"""Range of the rotor's speed: 2.4 to 36 revolutions a minute."""
SHIFTS = 16
"""Number of shifts of one signal against the other, which show the coherence that arises by chance."""
LEAST_COHERENCE = 0.6
"""Smallest C of two orders; it is below 1 since their bands also contain modes and noise."""
MARGIN = 0.3
"""Smallest excess of C over its value for every shift."""
CERTAIN_COHERENCE = 0.93
"""C of two orders above which no excess is required: tones that hardly drift are coherent at any shift."""
PASSING = (2.0, 98.0)
"""Percentiles of the speed that limit the range of an order."""
SMOOTHING_SHARE = 0.03
"""Share of the record over which the phase is smoothed for the speed."""


@dataclass(frozen=True)
class EstimatedSpeed:
    """Speed of a rotor estimated from two of its orders.

    Attributes
    ----------
    speed_hz : (n_instants,)
        Revolutions per second, evenly spread over the record.
    coherence : float
        C of the two orders.
    seen : (low, high)
        The two orders from which the speed was estimated.
    higher : tuple of (order, low, high)
        Detected orders above the sixth, and the frequency range of each [Hz].
    """

    speed_hz: FloatArray
    coherence: float
    seen: tuple[int, int]
    higher: tuple[tuple[int, float, float], ...] = ()

    @property
    def orders(self) -> tuple[tuple[int, float, float], ...]:
        """Orders with the frequency range of each: (order, low, high) [Hz]."""
        return (*((order, *self.swept_hz(order)) for order in ORDERS), *self.higher)

    def swept_hz(self, order: int) -> tuple[float, float]:
        """Return the frequency range of an order [Hz]."""
        low, high = np.percentile(order * self.speed_hz, PASSING)
        return float(low), float(high)


def estimated_speed(y: FloatArray, sample_rate_hz: float) -> EstimatedSpeed | None:
    """Return the speed of a rotor if two of its orders are in a record, else None.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample and counts as zero.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> angle = 2 * np.pi * 0.1 * (t + 4.0 * np.sin(2 * np.pi * t / 300.0))
    >>> noise = np.random.default_rng(1).standard_normal((2, 6000))
    >>> found = estimated_speed(np.cos(angle) + np.cos(3 * angle + 1.0) + noise, 10.0)
    >>> low, high = found.swept_hz(3)
    >>> bool(abs(low - 0.275) < 0.01 and abs(high - 0.325) < 0.01)
    True
    """
    lines, duration = transform(y), y.shape[1] / sample_rate_hz
    highest = HIGHEST * sample_rate_hz
    best: EstimatedSpeed | None = None
    for pair in PAIRS:
        for width in WIDTHS:
            for found in _coherent_speeds(lines, duration, *_bands(width, pair, duration, highest), pair):
                if best is None or found.coherence > best.coherence:
                    best = found
    if best is None:
        return None
    return replace(best, higher=tuple(higher_orders(y, sample_rate_hz, best.speed_hz)))


def higher_orders(
    y: FloatArray, sample_rate_hz: float, speed_hz: FloatArray
) -> Iterator[tuple[int, float, float]]:
    """Yield the detected orders above the sixth with the frequency range of each [Hz].

    After removal of the phase derived from the speed, an order is a single line.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample and counts as zero.
    speed_hz : (n_instants,)
        Evenly spaced over the record.
    """
    lines, duration = transform(y), y.shape[1] / sample_rate_hz
    turns = np.append(0.0, np.cumsum(speed_hz)) * duration / len(speed_hz)
    slowest, fastest = np.percentile(speed_hz, PASSING)
    for order in HIGHER:
        low, high = order * float(slowest), order * float(fastest)
        room = 2.0 * (high - low) + 2.0 * lines_around(len(lines)) / duration
        if high + room > HIGHEST * sample_rate_hz:
            return
        band = baseband(lines, duration, 0.5 * (low + high), room)
        n = band.signal.shape[1]
        at = np.arange(n) / n
        turned = order * np.interp(at, np.linspace(0.0, 1.0, len(turns)), turns)
        phase = 2.0 * np.pi * (turned - band.middle_hz * duration * at)
        along = fft.fftshift(fft.fft(band.signal * np.exp(-1j * phase), axis=1), axes=1)
        if sinusoid(along, n // 2).ratio > MIN_RATIO:
            yield order, low, high


def _bands(
    width: float, pair: tuple[int, int, int], duration_s: float, highest_hz: float
) -> tuple[FloatArray, FloatArray]:
    """Return middles and half widths of overlapping bands in which the lower order of a pair may lie."""
    ratio, order, _ = pair
    least = MIN_LINES / duration_s
    middle, half = overlapping_bands(
        max(order * LEAST_SPEED_HZ, 4.0 * least), order * MOST_SPEED_HZ, width, least, STEP
    )
    below = ratio * (middle + 3.0 * half) <= highest_hz
    return middle[below], half[below]


def _coherent_speeds(
    lines: ComplexArray, duration_s: float, f: FloatArray, half: FloatArray, pair: tuple[int, int, int]
) -> Iterator[EstimatedSpeed]:
    """Yield speeds whose two orders are in the bands at f and at its multiple."""
    ratio, lower, higher = pair
    lows, highs = bands_of(lines, duration_s, f, half), bands_of(lines, duration_s, ratio * f, ratio * half)
    # each baseband is relative to its own middle line; the multiple of the lower one differs slightly
    low, high = (np.array([_line(band, duration_s) for band in x]) for x in (lows, highs))
    length = 2 ** np.ceil(np.log2(8.0 * ratio * half * duration_s + 8.0)).astype(np.intp)
    for n in map(int, np.unique(length)):
        alike = np.flatnonzero(length == n)
        for at in np.array_split(alike, -(-len(alike) * n // MAX_ELEMENTS)):
            a = _analytic(lines, duration_s, [lows[k] for k in at], n)
            b = _analytic(lines, duration_s, [highs[k] for k in at], n)
            unit_a, unit_b = a / (np.abs(a) + 1e-300), b / (np.abs(b) + 1e-300)
            turn = np.exp(2j * np.pi * np.outer((high - ratio * low)[at], np.arange(n)) / n)
            product = unit_a.conj() ** ratio * turn
            coherence = np.abs(np.mean(unit_b * product, axis=1))
            for i in np.flatnonzero(coherence >= LEAST_COHERENCE):
                c = float(coherence[i])
                if c >= CERTAIN_COHERENCE or _exceeds_chance(unit_b[i], product[i], c):
                    speed_hz = _speed(b[i], int(high[at[i]]), higher, duration_s)
                    yield EstimatedSpeed(speed_hz, c, (lower, higher))


def _speed(b: ComplexArray, line: int, order: int, duration_s: float) -> FloatArray:
    """Return the smoothed speed from the phase of an order, (n_instants,)."""
    n = len(b)
    angle = (np.unwrap(np.angle(b)) + 2.0 * np.pi * line * np.arange(n) / n) / order
    width = max(int(SMOOTHING_SHARE * n), 3)
    kernel = np.hanning(width + 2)[1:-1]
    speed = np.gradient(angle) * n / (2.0 * np.pi * duration_s)
    return np.asarray(
        np.convolve(np.pad(speed, width, mode="reflect"), kernel / kernel.sum(), "same")[width:-width]
    )


def _exceeds_chance(b: ComplexArray, product: ComplexArray, coherence: float) -> bool:
    """Tell whether two signals are more coherent than after any shift in time."""
    n = len(b)
    shifts = [(k * n) // (SHIFTS + 1) for k in range(1, SHIFTS + 1)]
    return bool(coherence > MARGIN + max(_shifted_mean(np.roll(b, k) * product, k, n) for k in shifts))


def _shifted_mean(product: ComplexArray, shift: int, n: int) -> float:
    """Return the larger mean of the two parts of a circularly shifted product, taken separately."""
    parts = [part for part in (product[:shift], product[shift:]) if len(part) > n // 4]
    return max((float(np.abs(np.mean(part))) for part in parts), default=0.0)


def _analytic(lines: ComplexArray, duration_s: float, bands: Sequence[Band], n: int) -> ComplexArray:
    """Return the best combinations of channels relative to their middle lines, (n_bands, n)."""
    spread = np.zeros((len(bands), n), dtype=complex)
    for row, band in zip(spread, bands, strict=True):
        middle, reach = _line(band, duration_s), int(band.half_hz * duration_s)
        inside = np.arange(max(middle - reach, 1), min(middle + reach, lines.shape[1] - 1) + 1)
        row[(inside - middle) % n] = band.combination.conj() @ lines[:, inside]
    return np.asarray(fft.ifft(spread))


def _line(band: Band, duration_s: float) -> int:
    return round(band.middle_hz * duration_s)
