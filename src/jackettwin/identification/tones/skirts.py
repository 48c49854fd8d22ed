r"""Peaks that fall off faster than any mode's: orders of a rotor whose unmeasured speed wanders.

The power of a mode falls with the square of the distance from its peak; that of an order ends with the range
of the speed. With x the distance over half the width of a peak, the lines around it, which are exponentially
distributed, have the means

.. math:: S = a\left(\frac{1}{1 + x^2} + r\right) \quad\text{or}\quad S = a\left(2^{-x^2} + r\right),

r being the level of all else, both times the slope of the forces. The likelihoods of both, at their best a,
r, slope, width and middle, tell one from the other unless half a width is below a line or r hides it.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray

LESS_LIKELY = 5.0
"""Excess of ln L of a peak without skirts above which it is none of a mode. Of 3670 simulated peaks of modes
of 0.5 to 16 lines half width, on levels r of 0.001 to 0.05 and forces that are level or slope by ±0.35 over
half a width, 0.5 % have more; of peaks without skirts 83 % at r = 0.001, 33 % at 0.01 and 6 % at 0.03."""
SHOWN = -1.0
"""Excess below which a peak is taken to have skirts though it lies at a multiple of an order."""
MULTIPLES = np.array([0.5, 2.0])
"""Of 3P and 6P to each other; 9P is weaker, and the more multiples, the more modes lie at one by chance."""
REACH = 6.0
"""Distance from the peak that is compared, in half widths of the mode."""
FEWEST_LINES, MOST_LINES = 16, 40
"""Fewest and most lines on either side."""
WIDTHS = np.exp(np.linspace(np.log(0.7), np.log(12.0), 9))
"""Half widths that are tried, in lines: a few lines of a broad peak look like a narrow one."""
MIDDLES = np.linspace(-0.8, 0.8, 7)
"""Middles that are tried, in half widths of the mode and the same for both: in half widths of what is tried,
a broad peak without skirts could move farther than one with them."""
SLOPES = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])
"""Slopes of the logarithm of the forces over half a width of the mode that are tried. In a turbine at sea
the force was ten times as much at five half widths below a mode as above. If only level forces are tried,
half of the simulated modes above have no skirts."""
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
    reach = min(wanted, free, middle - 1.0, lines.shape[1] - 1 - middle)
    if reach < FEWEST_LINES:
        return None
    k = np.arange(int(np.ceil(middle - reach)), int(middle + reach) + 1)
    power = np.abs(shape.conj() @ lines[:, k]) ** 2
    x = (k - middle - max(half, 1.0) * MIDDLES[:, None]) / WIDTHS[:, None, None]
    slopes = SLOPES[:, None] * (k - k.mean()) / max(half, 1.0)
    return _best(power, slopes, 2.0 ** -(x**2)) - _best(power, slopes, 1.0 / (1.0 + x**2))


def _best(power: FloatArray, slopes: FloatArray, peak: FloatArray) -> float:
    """Return ln L of lines at the best slope (n_slopes, n_lines), peak (…, n_lines), level and scale."""
    shape = (peak[..., None, :] + LEVELS[:, None]).reshape(-1, power.size)
    mean = (power * np.exp(slopes)) @ (1.0 / shape).T / power.size
    return float(np.max(-np.log(shape).sum(axis=-1) - power.size * np.log(mean)))


def are_orders(frequency_hz: FloatArray, damping_ratio: FloatArray, missing: FloatArray) -> BoolArray:
    """Tell which peaks lie at half or twice one without skirts, and do not show skirts themselves.

    Parameters
    ----------
    frequency_hz, damping_ratio, missing : (n,)
        ``missing`` as of :func:`missing_skirts`, NaN where it is unknown.
    """
    order = np.flatnonzero(missing > LESS_LIKELY)
    ratio = frequency_hz[:, None, None] / (frequency_hz[order, None] * MULTIPLES)
    width = np.hypot(damping_ratio[:, None], damping_ratio[order])[..., None]
    near = (np.abs(np.log(ratio)) < width).any(axis=(1, 2))
    return np.asarray(near & (missing > SHOWN))
