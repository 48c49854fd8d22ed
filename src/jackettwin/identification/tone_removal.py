"""Take steady tones out of a record, so that what is left is what random forces did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

if TYPE_CHECKING:
    from collections.abc import Iterable

FloatArray = npt.NDArray[np.float64]


def without_tones(y: FloatArray, sample_rate_hz: float, tones_hz: Iterable[float]) -> FloatArray:
    """Return samples less the least-squares sinusoid near each frequency.

    The frequency is sought within a line and a half of the periodogram, where it explains most.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample.

    Examples
    --------
    >>> t = np.arange(2000) / 10.0
    >>> left = without_tones(np.array([np.sin(2 * np.pi * 0.5003 * t)]), 10.0, [0.5])
    >>> bool(np.abs(left).max() < 1e-3)
    True
    """
    out = y
    for tone in tones_hz:
        out = _without_one(out, sample_rate_hz, tone)
    return out


def _without_one(y: FloatArray, sample_rate_hz: float, tone_hz: float) -> FloatArray:
    valid = np.isfinite(y)
    filled = np.where(valid, y, 0.0)
    t = np.arange(y.shape[1]) / sample_rate_hz
    line = sample_rate_hz / y.shape[1]

    def power(f: float) -> float:
        return float(np.sum(np.abs(filled @ np.exp(-2j * np.pi * f * t)) ** 2))

    lines = tone_hz + line * np.arange(-3, 4)
    near = float(lines[np.argmax([power(f) for f in lines])])
    best = minimize_scalar(
        lambda f: -power(f), bounds=(near - 1.5 * line, near + 1.5 * line), method="bounded",
        options={"xatol": 1e-4 * line},
    ).x  # fmt: skip
    basis = np.stack([np.cos(2.0 * np.pi * best * t), np.sin(2.0 * np.pi * best * t)])
    out = y.copy()
    for a in range(len(y)):
        there = basis[:, valid[a]]
        weights = np.linalg.lstsq(there.T, y[a, valid[a]], rcond=None)[0]
        out[a, valid[a]] -= weights @ there
    return out
