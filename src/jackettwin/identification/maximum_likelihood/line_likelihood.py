r"""Exact likelihood of the damping of a lightly damped mode, from the Fourier lines of one record.

Where the decay time of a mode is about the length of the record, neighbouring lines are correlated: all
contain the difference between the motion at the first and at the last sample. A periodogram likelihood, which
assumes independent lines, is then biased. Near its peak the complex amplitude z of a mode under smooth random
forces obeys :math:`\dot z = pz + w` with white w of density q and
:math:`p = \omega(-\zeta + i\sqrt{1-\zeta^2})`. Its transform over a record of length T at a Fourier frequency
is, without any approximation,

.. math:: X_k = \frac{W_k - D}{i\omega_k - p}, \qquad D = \frac{z(T) - z(0)}{\sqrt T},

.. math:: \mathrm{E}|W_k|^2 = q, \quad
          \mathrm{E}\,D\bar W_k = \frac{q\,(1 - e^{pT})}{T\,(i\omega_k - p)}, \quad
          \mathrm{E}|D|^2 = \frac{q\,(1 - \mathrm{Re}\,e^{pT})}{aT}, \qquad a = -\mathrm{Re}\,p .

With white noise n the covariance of the lines is a diagonal plus a matrix of rank two. The likelihood of ln ζ
is integrated over the frequency (uniform prior), q and n (uniform in the logarithm). Maximising over n
instead attributes part of the tails to noise and underestimates the damping, by a tenth in ten minutes.
Any one prior of n is wrong in the same way in every record of one sensor, so that many records together are
biased by it, by −7 to +6 % as n is less or more than the tails. Likelihoods are therefore kept apart by
ranges of n; many records show which of these occur (``many_records/joint_damping.py``).
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.intervals import NORMAL_90, NORMAL_95

LOG_ZETA = np.round(np.arange(np.log(1e-4), np.log(0.2), 0.2), 6)
"""Nodes of ln ζ at which likelihoods are stored; a spacing of 0.2 suffices for records up to 2πζfT = 25."""
LEAST_BANDWIDTH, MOST_BANDWIDTH = 0.01, 12.0
"""Range of ζfT within which the likelihood is computed. Below it a mode is a single line, and the likelihood
is continued as a constant; above it the likelihood is extrapolated with its last slope."""
FREQUENCY_POINTS = 17
"""Frequencies over which the likelihood is integrated."""
FREQUENCY_STDS, FREQUENCY_LINES = 4.5, 0.2
"""Half range of these frequencies: this many standard deviations √(a/T), at most ``MOST_LINES`` lines, plus
this many lines."""
MOST_LINES = 3.0
NOISE_STEP = 0.4
"""Step of ln n."""
NO_NOISE, NO_NOISE_WEIGHT = -8.0, 5.0
"""Logarithm of a negligible noise relative to the tail of the mode, and the range of ln n it represents."""
LOWEST_NOISE, NOISE_RANGES, RANGE_STEPS = -3.0, 8, 4
"""Lower limit of ln n relative to the tail of the mode at the edge of the band, number of ranges above it,
and steps in each: the highest is e⁴ times the density of the mode one line from its peak."""
NOISE_WEIGHTS = np.append(NO_NOISE_WEIGHT, np.full(NOISE_RANGES, RANGE_STEPS * NOISE_STEP))
NOISE_WEIGHTS /= NOISE_WEIGHTS.sum()
"""Prior weight of negligible noise and of each range of ln n."""
NEGLIGIBLE = 12.0
"""Noise levels whose log-likelihood is this far below the largest are left out."""
IMPOSSIBLE = -60.0
"""Log-likelihood stored for them."""


def line_log_likelihood(
    x: ComplexArray, omega: FloatArray, duration_s: float, pole: ComplexArray, noise: FloatArray
) -> FloatArray:
    """Return the log-likelihood of Fourier lines, integrated over the force density q, up to a constant.

    Parameters
    ----------
    x : (n_lines,)
        Transform over the root of the duration, at Fourier frequencies.
    omega : (n_lines,)
        Angular frequencies [rad/s].
    pole : (...)
        p [rad/s].
    noise : (...)
        n/q [s²/rad²].
    """
    pole, noise = np.broadcast_arrays(pole, noise)
    p = pole[..., None]
    g = 1.0 / (1j * omega - p)
    change = 1.0 - np.exp(p * duration_s)
    power = change.real / (-p.real * duration_s)
    first = g * (0.5 * power - (change * g / duration_s).conj())
    weight = 1.0 / (np.abs(g) ** 2 + noise[..., None])
    weighted = g.conj() * weight
    s_gg = np.sum(np.abs(g) ** 2 * weight, axis=-1)
    s_ff = np.sum(np.abs(first) ** 2 * weight, axis=-1)
    s_fg = np.sum(first.conj() * g * weight, axis=-1) + 1.0
    y_f, y_g = (first.conj() * weight) @ x, weighted @ x
    determinant = np.abs(s_fg) ** 2 - s_ff * s_gg
    square = weight @ np.abs(x) ** 2
    square += (s_gg * np.abs(y_f) ** 2 + s_ff * np.abs(y_g) ** 2 - 2.0 * np.real(y_f.conj() * s_fg * y_g)) / (
        determinant
    )
    return np.asarray(np.sum(np.log(weight), axis=-1) - np.log(determinant) - len(x) * np.log(square))


def damping_log_likelihood(
    x: ComplexArray, frequency_hz: float, lines_hz: FloatArray, duration_s: float
) -> FloatArray:
    """Return the log-likelihood of ``LOG_ZETA`` in every range of the noise, (1 + NOISE_RANGES, n_nodes).

    The largest value is 0; the first row is that of negligible noise.

    Parameters
    ----------
    x : (n_lines,)
        Transform of one mode's motion over the root of the duration, at Fourier frequencies around its peak.
    frequency_hz : float
        Frequency of the mode, accurate to two lines.
    lines_hz : (n_lines,)
        The Fourier frequencies.
    """
    omega, line = 2.0 * np.pi * lines_hz, 2.0 * np.pi / duration_s
    bandwidth = np.exp(LOG_ZETA) * frequency_hz * duration_s
    inside = np.flatnonzero((bandwidth > LEAST_BANDWIDTH) & (bandwidth < MOST_BANDWIDTH))
    a = 2.0 * np.pi * bandwidth[inside] / duration_s
    at_edge = -2.0 * np.log(0.5 * (len(x) - 1) * line)
    steps = np.arange(NOISE_RANGES * RANGE_STEPS)
    log_noise = at_edge + np.append(NO_NOISE, LOWEST_NOISE + (0.5 + steps) * NOISE_STEP)
    row = np.append(0, 1 + steps // RANGE_STEPS)

    near = 2.0 * np.pi * frequency_hz + line * np.linspace(-2.0, 2.0, 33)
    coarse = line_log_likelihood(
        x,
        omega,
        duration_s,
        (-a[::4, None] + 1j * near)[:, :, None],
        np.exp(log_noise[::3]),
    )
    centre = near[np.unravel_index(np.argmax(coarse), coarse.shape)[1]]
    likely = 3 * np.flatnonzero(coarse.max(axis=(0, 1)) > coarse.max() - NEGLIGIBLE)
    noise = slice(max(likely[0] - 2, 0), likely[-1] + 3)

    reach = np.minimum(FREQUENCY_STDS * np.sqrt(a / duration_s), MOST_LINES * line) + FREQUENCY_LINES * line
    at = centre + reach[:, None] * np.linspace(-1.0, 1.0, FREQUENCY_POINTS)
    fine = line_log_likelihood(
        x, omega, duration_s, (-a[:, None] + 1j * at)[:, :, None], np.exp(log_noise[noise])
    )
    over_frequency = np.exp(fine - fine.max()).sum(axis=1).T * reach
    ranges = np.zeros((1 + NOISE_RANGES, len(inside)))
    np.add.at(ranges, row[noise], over_frequency)
    ranges[1:] /= RANGE_STEPS
    values = np.log(np.maximum(ranges, np.exp(IMPOSSIBLE)))
    out = np.empty((len(ranges), len(LOG_ZETA)))
    out[:, inside] = values
    out[:, : inside[0]] = values[:, :1]
    slope = np.minimum(values[:, -1] - values[:, -2], 0.0)
    beyond = np.arange(1, len(LOG_ZETA) - inside[-1])
    out[:, inside[-1] + 1 :] = values[:, -1:] + slope[:, None] * beyond
    return np.asarray(out - out.max())


def over_noise(log_likelihood: FloatArray) -> FloatArray:
    """Return the log-likelihood of ``LOG_ZETA`` of one record, over all noise, with its largest value 0.

    Parameters
    ----------
    log_likelihood : (1 + NOISE_RANGES, n_nodes)
    """
    out = np.log(NOISE_WEIGHTS @ np.exp(log_likelihood))
    return np.asarray(out - out.max())


FINE = 20
"""Points per interval of nodes at which a likelihood is interpolated."""


def likelihood_interval(log_likelihood: FloatArray) -> tuple[float, float, float, float]:
    """Return of ln ζ the median, the ends of the 90 % interval by likelihood ratio, and a standard deviation.

    The standard deviation is that of a normal likelihood with the same interval of 95 %.

    Parameters
    ----------
    log_likelihood : (n_nodes,)
        At ``LOG_ZETA``. The median is that of a uniform prior on ln ζ over the range of these nodes.

    Examples
    --------
    >>> found = likelihood_interval(-0.5 * ((LOG_ZETA + 5.0) / 0.3) ** 2)
    >>> [round(x, 2) for x in found]
    [-5.0, -5.49, -4.51, 0.3]
    """
    log_zeta, values = between_nodes(log_likelihood)
    weight = np.exp(values - values.max())
    middle = float(np.interp(0.5 * weight.sum(), np.cumsum(weight) - 0.5 * weight, log_zeta))
    low, high = likelihood_ends(log_likelihood, NORMAL_90)
    far_low, far_high = likelihood_ends(log_likelihood, NORMAL_95)
    middle = min(max(middle, far_low), far_high)
    return middle, min(low, middle), max(high, middle), (far_high - far_low) / (2.0 * NORMAL_95)


def likelihood_ends(log_likelihood: FloatArray, half_width: float) -> tuple[float, float]:
    """Return the ends of ln ζ of an interval by likelihood ratio.

    Parameters
    ----------
    log_likelihood : (n_nodes,)
        At ``LOG_ZETA``.
    half_width : float
        Of the interval of a normal likelihood, in standard deviations.
    """
    log_zeta, values = between_nodes(log_likelihood)
    low, high = _where_above(log_zeta, values - values.max(), -0.5 * half_width**2)
    return low, high


def _where_above(x: FloatArray, values: FloatArray, level: float) -> list[float]:
    """Return the first and last place at which values on a grid exceed a level, between its points."""
    inside = np.flatnonzero(values > level)
    ends = [float(x[inside[0]]), float(x[inside[-1]])]
    for k, (inner, outer) in enumerate(((inside[0], inside[0] - 1), (inside[-1], inside[-1] + 1))):
        if 0 <= outer < len(values):
            share = (values[inner] - level) / (values[inner] - values[outer])
            ends[k] += float(share * (x[outer] - x[inner]))
    return ends


def between_nodes(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return ln ζ at ``FINE`` points per interval and the values there, by cubic interpolation."""
    n = len(LOG_ZETA)
    at = np.arange((n - 1) * FINE + 1) / FINE
    first = np.clip(at.astype(int) - 1, 0, n - 4)
    t = at - first
    weight = np.ones((4, len(at)))
    for j in range(4):
        for m in range(4):
            if m != j:
                weight[j] *= (t - m) / (j - m)
    fine = sum(weight[j] * values[first + j] for j in range(4))
    step = LOG_ZETA[1] - LOG_ZETA[0]
    return np.asarray(LOG_ZETA[0] + step * at), np.asarray(fine)
