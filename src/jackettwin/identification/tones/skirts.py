r"""Peaks that fall off faster than any mode's: orders of a rotor whose unmeasured speed wanders.

The power of a mode falls with the square of the distance from its peak; that of an order ends with the range
of the speed. With x the distance over half the width of a peak, the lines around it, which are exponentially
distributed, have the means

.. math:: S = a\left(\frac{1}{1 + x^2} + r\right) \quad\text{or}\quad S = a\left(2^{-x^2} + r\right),

r being the level of all else, both times the slope of the forces. The likelihoods of both, at their best a,
r, slope, width and middle, tell one from the other unless r hides the skirts. The ends of a record differ,
which gives every peak skirts of its own; through Hann's window it has none, and both means are those seen
through it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray

LESS_LIKELY = 5.0
"""Excess of ln L of a peak without skirts above which it is none of a mode. Of 8100 simulated peaks of modes
of 1 to 8 lines half width, on levels r of 0.001 to 0.05 and forces that are level or slope by 0.25 or −0.35
over half a width, 0.15 % have more; of peaks without skirts and from 0.5 to 8 lines 77 % at r = 0.001, 26 %
at 0.01 and 6 % at 0.03."""
BOTH_LESS_LIKELY = 3.0
"""The same for the sum of two peaks at a multiple of each other, neither of which shows skirts: two modes are
there by chance in a few per cent of cases, and one in twenty of such pairs has more."""
SHOWN = -1.0
"""Excess below which a peak is taken to have skirts though it lies at a multiple of an order. With fewer than
``FEW_SENSORS``, the least of that sum: what else moves hides the skirts there, of modes (−0.5 to 1) as of
orders (−1 to 5). Two modes are a multiple of each other in one of a hundred pairs and two orders always, so
that orders are the likelier if one turbine in ten turns at a speed that nobody tells."""
FEW_SENSORS = 4
HIGHEST_3P_HZ = 1.8
"""Greatest frequency of the lower of these: 3P of 36 revolutions a minute."""
MULTIPLES = np.array([0.5, 2.0])
"""Of 3P and 6P to each other; 9P is weaker, and the more multiples, the more modes lie at one by chance."""
CENTRE = 0.01
"""Least difference of two logarithms of frequency that are a multiple of each other's: the middle of a peak
that is some per cent broad is known to about half a per cent, however narrow a mode has been fitted to it."""
REACH = 6.0
"""Distance from the peak that is compared, in half widths of the mode."""
FEWEST_LINES, MOST_LINES = 16, 40
"""Fewest and most lines on either side."""
AROUND = 2
"""Lines on either side of a peak that give its shape and its power."""
WIDTHS = tuple(map(float, np.exp(np.linspace(np.log(0.15), np.log(12.0), 11))))
"""Half widths that are tried, in lines: a few lines of a broad peak look like a narrow one, and through the
window a narrow one is a line and a half wide."""
INDEPENDENT = 2.0 / 3.0
"""Independent values in a line through Hann's window: its noise bandwidth is one and a half lines."""
FURTHEST, PER_LINE = 128, 16
"""Greatest distance from a peak at which its mean is tabulated, in lines, and values per line."""
MIDDLES = np.linspace(-0.8, 0.8, 7)
"""Middles that are tried, in half widths of the mode and the same for both: in half widths of what is tried,
a broad peak without skirts could move farther than one with them."""
SLOPES = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])
"""Slopes of the logarithm of the forces over half a width of the mode that are tried. In a turbine at sea
the force was ten times as much at five half widths below a mode as above. If only level forces are tried,
half of the simulated modes above have no skirts."""
LN_2 = float(np.log(2.0))
LEVELS = 10.0 ** np.arange(-4.0, 0.1, 0.5)
"""Levels r that are tried."""
MAX_DAMPING_RATIO = 0.03
"""Damping ratio above which a peak is wider than that of an order."""


def missing_skirts(
    lines: ComplexArray,
    duration_s: float,
    frequency_hz: float,
    damping_ratio: float,
    shape: ComplexArray,
    others_hz: FloatArray,
) -> float | None:
    """Return how much more likely a peak is that of an order of a rotor of varying speed than that of a mode.

    Returns
    -------
    The excess of ln L; None for a peak too broad for an order, or with too few lines of its own.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transforms of the channels, from zero frequency.
    shape : (n_channels,) complex
    others_hz : (n_others,)
        Other modes; lines nearer to one of them are not compared.
    """
    if damping_ratio > MAX_DAMPING_RATIO:
        return None
    half, middle = damping_ratio * frequency_hz * duration_s, frequency_hz * duration_s
    free = 0.5 * float(np.abs(others_hz - frequency_hz).min(initial=np.inf)) * duration_s
    wanted = np.clip(REACH * half, FEWEST_LINES, MOST_LINES)
    reach = min(wanted, free, middle - 2.0, lines.shape[1] - 2 - middle)
    if reach < FEWEST_LINES:
        return None
    k = np.arange(int(np.ceil(middle - reach)), int(middle + reach) + 1)
    near = shape.conj() @ lines[:, k[0] - 1 : k[-1] + 2]
    power = np.abs(near[1:-1] - 0.5 * (near[:-2] + near[2:])) ** 2
    away = np.abs(k - middle - max(half, 1.0) * MIDDLES[:, None])
    slopes = SLOPES[:, None] * (k - k.mean()) / max(half, 1.0)
    place = np.arange(FURTHEST * PER_LINE) / PER_LINE
    with_skirts, without = (
        _best(power, slopes, np.array([np.interp(away, place, through_window(w, skirts)) for w in WIDTHS]))
        for skirts in (True, False)
    )
    return INDEPENDENT * (without - with_skirts)


def peak_near(
    lines: ComplexArray, duration_s: float, frequency_hz: float, reach_hz: float
) -> tuple[float, float, ComplexArray]:
    """Return frequency, damping ratio and shape of the peak nearest to a coarse frequency.

    It is taken to be as broad as the lines that are compared at least.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transforms of the channels, from zero frequency.
    """
    low = max(int((frequency_hz - reach_hz) * duration_s), AROUND)
    high = min(int((frequency_hz + reach_hz) * duration_s) + 1, lines.shape[1] - AROUND - 1)
    near = lines[:, low - AROUND : high + AROUND + 1]
    power = np.convolve(np.sum(np.abs(near) ** 2, axis=0), np.ones(2 * AROUND + 1), "valid")
    middle = low + int(np.argmax(power))
    here = lines[:, middle - AROUND : middle + AROUND + 1]
    shape = np.linalg.eigh(here @ here.conj().T)[1][:, -1]
    return middle / duration_s, FEWEST_LINES / (REACH * middle), np.asarray(shape)


@lru_cache(maxsize=64)
def through_window(half_lines: float, skirts: bool) -> FloatArray:
    r"""Return the mean power of lines through Hann's window beside a peak, over that at its middle.

    The transform of the process's covariance, exp(−2πh|τ|) or exp(−π²h²τ²/ln 2) with h in lines and τ in
    records, times the autocorrelation of the window.

    Returns
    -------
    (FURTHEST · PER_LINE,) at distances of 0, 1 / PER_LINE, … lines

    Examples
    --------
    >>> through_window(0.15, False)[[0, 16, 64]].round(3).tolist()
    [1.0, 0.265, 0.0]
    >>> round(float(through_window(8.0, True)[16 * 8]), 2)
    0.5
    """
    n = 4 * FURTHEST
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(n) + 0.5) / n)
    tau = np.arange(n) / n
    covariance = np.exp(
        -2.0 * np.pi * half_lines * tau if skirts else -((np.pi * half_lines * tau) ** 2) / LN_2
    )
    product = covariance * np.correlate(window, window, "full")[n - 1 :]
    product[0] *= 0.5
    mean = np.fft.rfft(product, n * PER_LINE).real[: FURTHEST * PER_LINE]
    return np.asarray(np.maximum(mean, 0.0) / mean[0])


def _best(power: FloatArray, slopes: FloatArray, peak: FloatArray) -> float:
    """Return ln L of lines at the best slope (n_slopes, n_lines), peak (…, n_lines), level and scale."""
    shape = (peak[..., None, :] + LEVELS[:, None]).reshape(-1, power.size)
    mean = (power * np.exp(slopes)) @ (1.0 / shape).T / power.size
    return float(np.max(-np.log(shape).sum(axis=-1) - power.size * np.log(mean)))


def are_orders(
    frequency_hz: FloatArray, damping_ratio: FloatArray, missing: FloatArray, n_sensors: int
) -> BoolArray:
    """Tell which peaks lie at half or twice another, and are as little modes as that one.

    Neither shows skirts, and the other has none, or both together are unlikely to have any; of few sensors,
    do not show them together either. A peak too close to others to be judged by itself is judged by the
    other.

    Parameters
    ----------
    frequency_hz, damping_ratio, missing : (n,)
        ``missing`` as of :func:`missing_skirts`, NaN where it is unknown.
    """
    ratio = frequency_hz[:, None, None] / (frequency_hz[:, None] * MULTIPLES)
    width = np.maximum(np.hypot(damping_ratio[:, None], damping_ratio), CENTRE)[..., None]
    near = (np.abs(np.log(ratio)) < width).any(axis=2)
    near &= np.minimum(frequency_hz[:, None], frequency_hz) < HIGHEST_3P_HZ
    least = SHOWN if n_sensors < FEW_SENSORS else BOTH_LESS_LIKELY
    order = (missing > LESS_LIKELY) | (missing[:, None] + missing > least)
    shown = missing < SHOWN
    return np.asarray((near & order & ~shown & ~shown[:, None]).any(axis=1))
