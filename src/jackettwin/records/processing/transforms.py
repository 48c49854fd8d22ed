"""Fourier transforms over lengths at which they are fast."""

from __future__ import annotations

import numpy as np
import scipy  # scipy.fft is loaded where it is used

from jackettwin.arrays import ComplexArray, FloatArray


def of_fast_length(y: FloatArray) -> FloatArray:
    """Return the samples without the few at the end that make their transform slow, along the last axis.

    Ten minutes at 100 Hz, both ends included, are 60,001 = 29 · 2069 samples, whose transform takes ten
    times as long as that of 60,000. For what is read behind a window, or from the slowest lines, the last
    samples matter nothing.

    >>> of_fast_length(np.zeros((2, 60001))).shape
    (2, 60000)
    """
    return y[..., : scipy.fft.prev_fast_len(max(y.shape[-1], 1))]


def hann_lines(y: FloatArray) -> tuple[ComplexArray, int]:
    """Return the transforms of rows behind a Hann window, (n_channels, n_lines), and the samples they are of.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Without gaps.
    """
    y = of_fast_length(y)
    return np.asarray(np.fft.rfft(y * np.hanning(y.shape[1]), axis=1)), y.shape[1]
