r"""Damping of lightly damped modes by the exact likelihood of their lines (``line_likelihood.py``).

The motion of one mode is obtained from the channels by a spatial filter that passes its shape and suppresses
those of neighbouring modes: its row of the pseudo-inverse :math:`\Phi^+`. Modes too close to others retain
the estimate of their common fit.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.findings import Finding
from jackettwin.identification.maximum_likelihood.line_likelihood import (
    damping_log_likelihood,
    likelihood_interval,
    over_noise,
)
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.identification.maximum_likelihood.periodogram import MIN_CYCLES
from jackettwin.identification.preparation.gaps import stretches
from jackettwin.identification.selection.gusts import less_information, widened
from jackettwin.identification.selection.neighbours import apart
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.tones.sinusoid import transform

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import ModalEstimate


MAX_KNOWN, MAX_REPLACED = 16.0, 10.0
"""2πζfT below which the likelihood is computed, and below which it replaces the estimate of the damping.
Above the second value the fit of all modes together is as accurate and also uses the ratios between channels.
With a lower second value, fits that overestimate the damping by chance would be retained: for modes with
ζfT = 0.45 only 86 % of the intervals would then contain the true value."""
HALF_BAND_LINES = 20
"""Lines on either side of the peak."""
MAX_HALF_BAND = 0.15
"""Largest half width of the band, as a share of the frequency: beyond, forces are not white."""
MIN_HALF_BAND_LINES = 8
"""Fewest lines on either side."""
CLOSE_DISTANCE = 2.0
"""Distance to another mode, over the sum of half bandwidths, below which one record does not separate the two
shapes; the fit of both together is then retained."""
MAX_AMPLIFICATION = 2.0
"""Largest length of the filter over that of one mode alone. Above it the shapes are too alike."""
BY_CHANCE = frozenset({"steady_envelope", "narrow_as_a_line", "damping_unknown"})
"""Codes of findings that a lightly damped mode may have by chance. A mode with any other finding is given no
likelihood."""
MAX_LOG_STD = 1.0
"""Standard deviation of ln ζ above which damping is unknown."""


def with_damping_likelihoods(
    modes: Sequence[ModalEstimate],
    y: FloatArray,
    sample_rate_hz: float,
    scale: FloatArray,
    derivatives: Sequence[int],
) -> tuple[ModalEstimate, ...]:
    """Return the modes, with the likelihood of their damping where they are lightly damped.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Samples without tones, divided by ``scale``; NaN marks a missing sample.
    derivatives : (n_channels,)
        Number of time derivatives from a channel's quantity to acceleration.
    """
    lowest_hz = min((mode.frequency_hz for mode in modes), default=np.inf)
    parts = stretches(y, int(MIN_CYCLES / lowest_hz * sample_rate_hz) + 1)
    if not parts:
        return tuple(modes)
    duration_s = sum(part.stop - part.start for part in parts) / sample_rate_hz
    order = np.asarray(derivatives)[:, None]
    less = less_information(modes, y, sample_rate_hz, scale)
    out = [widened(mode, times) for mode, times in zip(modes, less, strict=True)]
    looks: list[tuple[float, ComplexArray]] = []
    for i, mode in enumerate(modes):
        lines_wide = mode.damping_ratio * mode.frequency_hz * duration_s
        lightly = 2.0 * np.pi * lines_wide < MAX_KNOWN
        if not lightly or mode.log_covariance is None or {r.code for r in mode.reasons} - BY_CHANCE:
            continue
        if any(apart(mode, other) < CLOSE_DISTANCE for other in modes if other is not mode):
            continue
        looks = looks or [((p.stop - p.start) / sample_rate_hz, transform(y[:, p])) for p in parts]
        of_parts = []
        for length_s, lines in looks:
            line = _band(mode.frequency_hz, length_s, lines.shape[1])
            own = _filter(modes, i, scale, float(len(line)) / length_s)
            if own is None or len(line) < 2 * MIN_HALF_BAND_LINES:
                break
            f = line / length_s
            density = lines[:, line] / (sample_rate_hz * np.sqrt(length_s))
            x = own @ (density * (2j * np.pi * f) ** order)
            of_parts.append(damping_log_likelihood(x, mode.frequency_hz, f, length_s))
        if len(of_parts) == len(looks):
            out[i] = _with(out[i], np.sum(of_parts, axis=0) / less[i], duration_s)
    return tuple(out)


def _band(frequency_hz: float, duration_s: float, n_lines: int) -> Int64Array:
    """Return the lines around a frequency."""
    half = int(max(min(HALF_BAND_LINES, MAX_HALF_BAND * frequency_hz * duration_s), MIN_HALF_BAND_LINES))
    peak = round(frequency_hz * duration_s)
    return np.arange(max(peak - half, 1), min(peak + half + 1, n_lines - 1))


def _filter(
    modes: Sequence[ModalEstimate], i: int, scale: FloatArray, width_hz: float
) -> ComplexArray | None:
    """Return the spatial filter of one mode against others in a band; None if their shapes are too alike."""
    near = [m for m in modes if abs(m.frequency_hz - modes[i].frequency_hz) < width_hz]
    shapes = np.array([m.mode_shape / scale for m in near]).T
    shapes = shapes / np.linalg.norm(shapes, axis=0)
    row = near.index(modes[i])
    if shapes.shape[1] > shapes.shape[0]:
        return None
    own = np.linalg.pinv(shapes)[row]
    return np.asarray(own) if np.linalg.norm(own) < MAX_AMPLIFICATION else None


def _with(mode: ModalEstimate, log_likelihood: FloatArray, duration_s: float) -> ModalEstimate:
    """Return a mode with its likelihood and, where it is lightly damped, with the estimate from it."""
    mode = replace(mode, damping_log_likelihood=log_likelihood)
    if 2.0 * np.pi * mode.damping_ratio * mode.frequency_hz * duration_s > MAX_REPLACED:
        return mode
    assert mode.log_covariance is not None
    middle, low, high, std = likelihood_interval(over_noise(log_likelihood))
    zeta = float(np.exp(middle))
    ratio = np.array([1.0, std / np.sqrt(mode.log_covariance[1, 1])])
    mode = replace(
        mode,
        damping_ratio=zeta,
        damping_ratio_std=zeta * std,
        damping_ratio_interval_90=(float(np.exp(low)), float(np.exp(high))),
        damping_ratio_cov_limit=float(long_data_limits(mode.frequency_hz, zeta, duration_s)[1]),
        log_covariance=mode.log_covariance * np.outer(ratio, ratio),
    )
    known = mode.status.severity >= ModeStatus.DAMPING_UNKNOWN.severity
    if std < MAX_LOG_STD or known:
        return mode
    return mode.flagged(ModeStatus.DAMPING_UNKNOWN, Finding("damping_unknown", params={"log_std": std}))
