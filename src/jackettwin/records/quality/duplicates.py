"""Channels that hold the samples of another: a cable plugged twice, a column written twice."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray

ROUNDING = 1e-6
"""Largest difference of two copies, as a share of their rms: that of a file that keeps seven digits.
Two sensors differ by their noise, a hundred times that at least."""


def duplicate_channels(y: FloatArray) -> dict[int, int]:
    """Return the rows that repeat an earlier one, and which.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample; offsets do not matter.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> a, b = rng.standard_normal((2, 1000))
    >>> duplicate_channels(np.array([a, b, a + 3.0, -b]))
    {2: 0}
    """
    size = np.nanstd(y, axis=1)
    out: dict[int, int] = {}
    for i in range(1, len(y)):
        for j in range(i):
            # a look at the sizes spares most of the work
            if j in out or abs(size[i] - size[j]) > ROUNDING * size[j]:
                continue
            both = np.isfinite(y[i]) & np.isfinite(y[j])
            if both.any() and float(np.std(y[i, both] - y[j, both])) <= ROUNDING * size[j]:
                out[i] = j
                break
    return out
