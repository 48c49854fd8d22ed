"""Decimation of samples that arrive in pieces, equal to that of the whole."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.records.processing import filters
from jackettwin.records.processing.prepare import PASS_SHARE


def thinned(pieces: Iterable[tuple[int, FloatArray]], factor: int) -> Iterator[FloatArray]:
    """Yield every ``factor``-th sample behind the filter of ``decimate``; memory holds one piece.

    Parameters
    ----------
    pieces : iterable of (int, (n_channels, n_samples))
        Number of the first sample in the record, and the samples, in the order of time. Samples between
        pieces are missing; those that come twice are taken once.
    factor : int
        From 2 on.

    Yields
    ------
    (n_channels, n_kept)

    Examples
    --------
    >>> y = np.sin(0.01 * np.arange(3000.0))[None]
    >>> parts = thinned([(0, y[:, :1000]), (1000, y[:, 1000:])], 5)
    >>> bool(np.allclose(np.hstack(list(parts))[0, 100:500], y[0, ::5][100:500], atol=1e-4))
    True
    """
    stop = 0.5 / factor
    taps = filters.lowpass_taps(PASS_SHARE * stop, stop)
    reach = filters.half_length(taps)
    held, begin, done = np.empty((0, 0)), 0, 0

    def kept(until: int) -> FloatArray:
        first = begin // factor
        return filters.resample(held, taps, 1, factor)[:, done - first : until - first]

    for start, piece in pieces:
        held = held if held.size else np.empty((len(piece), 0))
        missing = start - begin - held.shape[1]
        between = np.full((len(piece), max(missing, 0)), np.nan)
        held = np.hstack([held, between, piece[:, max(-missing, 0) :]])
        # an output is final once all samples that its filter weighs are there
        final = (begin + held.shape[1] - 1 - reach) // factor + 1
        if final > done:
            yield kept(final)
            done = final
            needed = max(done * factor - reach, 0) // factor * factor
            held, begin = held[:, needed - begin :].copy(), needed
    if held.shape[1] > reach:
        yield kept((begin + held.shape[1] - 1) // factor + 1)
