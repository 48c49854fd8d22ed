"""Which modes frequencies without a name are: those they lie nearest below, on supports that soften."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import scipy  # scipy.optimize is loaded where it is used

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError

LEAST_SHARE, MOST_SHARE = 0.5, 1.15
"""Of a mode's frequency on rigid feet: what soft soil leaves of it, and what errors of a model add to it."""
_ABOVE = 2.0
"""A frequency above a mode's on rigid feet is this many times as far from it: no support stiffens."""
_NEVER = 1e6
"""The distance from a mode that is taken; a finite one, as the assignment needs."""


def assigned_modes(frequency_hz: FloatArray, pinned_hz: FloatArray, taken: Collection[int]) -> list[int]:
    """Return the numbers of the modes that some frequencies are, each mode once, nearest on the whole.

    Parameters
    ----------
    frequency_hz : (n_frequencies,)
    pinned_hz : (n_modes,)
        Of the modes on rigid feet, numbered from 1.
    taken : numbers of the modes that have their target already

    Raises
    ------
    InputError
        If a frequency is near none that is left; it names the nearest.

    Examples
    --------
    >>> assigned_modes(np.array([0.72, 0.182]), np.array([0.183, 0.186, 0.572, 0.749]), taken=())
    [4, 1]
    """
    apart = np.log(np.asarray(frequency_hz)[:, None] / pinned_hz)
    distance = np.where(apart > 0.0, _ABOVE * apart, -apart) ** 2
    distance[:, [mode - 1 for mode in taken if mode <= len(pinned_hz)]] = _NEVER
    rows, columns = scipy.optimize.linear_sum_assignment(distance)
    modes = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    for k, f in enumerate(frequency_hz):
        if k not in modes or not LEAST_SHARE <= f / pinned_hz[modes[k]] <= MOST_SHARE:
            nearest = int(np.argmin(np.abs(apart[k])))
            raise InputError(
                "is near no mode of the model that is left",
                field="frequency_hz",
                value=float(f),
                allowed=f"{LEAST_SHARE} to {MOST_SHARE} times a mode's frequency on rigid feet",
                remedy=f"the nearest is mode {nearest + 1} with {pinned_hz[nearest]:.4g} Hz: name modes "
                "(mode: fore_aft_1), check the unit and the structure",
            )
    return [modes[k] + 1 for k in range(len(frequency_hz))]
