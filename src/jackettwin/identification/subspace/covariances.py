"""Covariances of a record at many lags, by FFT, with missing samples left out."""

from __future__ import annotations

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.signals import next_fast_len

SEGMENT_WINDOWS = 8
"""Length of the FFT segments, in lag windows."""
SEGMENTS_AT_ONCE = 64
"""Segments that are transformed together."""
LEAST_PAIRS = 0.2
"""Smallest share of the sample pairs of a lag that must be free of gaps."""


def covariances(y: FloatArray, n_lags: int) -> FloatArray:
    r"""Return output covariances at lags 0 … ``n_lags``.

    .. math:: R_i = \frac{1}{N_i} \sum_t y_{t+i}\, y_t^T

    with :math:`N_i` the number of pairs without a missing sample (N−i when there is none). Thesis
    eq. (6.3), transposed as eq. (6.6) requires.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples; NaN marks a missing one.
    n_lags : int
        Largest lag [samples].

    Returns
    -------
    (n_lags + 1, n_channels, n_channels)

    Raises
    ------
    InputError
        If gaps leave too few sample pairs at some lag.
    """
    n_samples = y.shape[1]
    valid = np.isfinite(y)
    if valid.all():
        pairs = (n_samples - np.arange(n_lags + 1))[:, None, None]
        return np.asarray(_lag_products(y, y, n_lags) / pairs)
    mask = valid.astype(float)
    pairs = np.round(_lag_products(mask, mask, n_lags))
    possible = (n_samples - np.arange(n_lags + 1))[:, None, None]
    if np.any(pairs < LEAST_PAIRS * possible):
        raise InputError(
            "gaps leave too few pairs of samples",
            field="data",
            value=f"{float((pairs / possible).min()):.0%} of the pairs at one lag",
            allowed=f"≥ {LEAST_PAIRS:.0%}",
            remedy="drop the channels with the longest gaps or use another record",
        )
    filled = np.where(valid, y, 0.0)
    return np.asarray(_lag_products(filled, filled, n_lags) / pairs)


def block_covariances(y: FloatArray, n_lags: int, n_blocks: int) -> FloatArray:
    """Return the covariances of consecutive blocks of the record, lags 0 … ``n_lags``.

    Block b contains the products whose earlier sample lies in block b; the later sample may lie in the next.
    The mean over blocks is the covariance of the record, except for the samples after the last block.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples; NaN marks a missing one, whose pairs are left out.

    Returns
    -------
    (n_blocks, n_lags + 1, n_channels, n_channels)
    """
    n_channels, n_samples = y.shape
    length = (n_samples - n_lags) // n_blocks
    if length < 1:
        raise InputError(
            "record too short for its blocks",
            field="blocks",
            value=n_blocks,
            allowed=f"≤ {max(n_samples - n_lags, 0)}",
            remedy="use a longer record or fewer blocks",
        )
    valid = np.isfinite(y)
    complete = bool(valid.all())
    filled = y if complete else np.where(valid, y, 0.0)
    out = np.empty((n_blocks, n_lags + 1, n_channels, n_channels))
    for b in range(n_blocks):
        early = slice(b * length, (b + 1) * length)
        late = slice(b * length, (b + 1) * length + n_lags)
        products = _lag_products(filled[:, late], filled[:, early], n_lags)
        if complete:
            out[b] = products / length
        else:
            mask = valid.astype(float)
            pairs = np.round(_lag_products(mask[:, late], mask[:, early], n_lags))
            out[b] = products / np.maximum(pairs, 1.0)
    return out


def _lag_products(late: FloatArray, early: FloatArray, n_lags: int) -> FloatArray:
    """Return Σ_t late_{t+i} early_tᵀ for i = 0 … n_lags: (n_lags + 1, n_late, n_early).

    The record is cut into segments of a few lag windows; their cross spectra are summed before a single
    inverse transform.
    """
    size = next_fast_len(min(max(SEGMENT_WINDOWS * n_lags, 1024), early.shape[1] + n_lags), real=True)
    hop = size - n_lags
    cross: ComplexArray | float = 0.0
    for first in range(0, early.shape[1], SEGMENTS_AT_ONCE * hop):
        after = first + SEGMENTS_AT_ONCE * hop
        some, beyond = early[:, first:after], late[:, first : after + n_lags]
        n_segments = -(-some.shape[1] // hop)
        spectrum_early = fft.rfft(_segments(some, n_segments, hop, hop), size, axis=2)
        spectrum_late = fft.rfft(_segments(beyond, n_segments, hop, size), axis=2)
        cross = cross + spectrum_late.transpose(2, 0, 1) @ spectrum_early.conj().transpose(2, 1, 0)
    return np.ascontiguousarray(fft.irfft(cross, size, axis=0)[: n_lags + 1])


def _segments(y: FloatArray, n_segments: int, hop: int, length: int) -> FloatArray:
    """Return segments that start a hop apart, zero beyond the end: (n_channels, n_segments, length)."""
    needed = (n_segments - 1) * hop + length
    padded = np.pad(y[:, :needed], ((0, 0), (0, max(needed - y.shape[1], 0))))
    return np.lib.stride_tricks.sliding_window_view(padded, length, axis=1)[:, ::hop]
