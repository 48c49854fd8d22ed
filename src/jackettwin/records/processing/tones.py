"""A tone whose phase is known, steady or drifting: taken out of a signal by least squares."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray

FEWEST_SAMPLES = 30
"""A channel with fewer keeps what it has: three unknowns a channel, tenfold."""


def less_phase(y: FloatArray, phase: FloatArray) -> FloatArray:
    """Return samples less the least-squares combination of the cosine and the sine of a phase.

    A constant is fitted beside them and stays.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks missing samples.
    phase : (n_samples,)
        [rad]

    Examples
    --------
    >>> phase = np.linspace(0.0, 60.0, 200) ** 1.2
    >>> bool(np.allclose(less_phase(np.array([1.0 + np.sin(phase)]), phase), 1.0))
    True
    """
    basis = np.stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
    out = y.copy()
    for row, there in zip(out, np.isfinite(y), strict=True):
        if there.sum() >= FEWEST_SAMPLES:
            seen = basis[:, there]
            row[there] -= np.linalg.solve(seen @ seen.T, seen @ row[there])[:2] @ seen[:2]
    return out
