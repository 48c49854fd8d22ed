r"""Detection of sensors of reversed polarity from the shapes of the twin's model.

A reversed sensor changes the sign of its row in every measured shape. If its share of the squared shape is p,
the subspace MAC with the model falls from 1 to :math:`(1-2p)^2`. Restoring the sign must not lower any mode's
MAC.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification import ModalEstimate
from jackettwin.updating import subspace_mac_nearby

LEAST_GAIN = 0.15
"""Least rise of the subspace MAC, summed over the modes, that is reported."""
LIKE = 0.9
"""Least MAC that the improved modes must reach after the change of sign."""
SUFFERS = 0.02
"""Fall of a mode's subspace MAC that excludes a reversed sensor as the cause."""
ALIKE = 0.05
"""Difference of gain below which two sensors cannot be distinguished."""
LARGEST_SHARE = 3
"""At most one sensor out of this number is reported as reversed."""


@dataclass(frozen=True)
class Turned:
    """A sensor of reversed polarity, or several of which one is reversed.

    Attributes
    ----------
    rows : tuple of int
        Rows of the shapes.
    before, after : float
        Mean subspace MAC of the improved modes, before and after the change of sign.
    """

    rows: tuple[int, ...]
    before: float
    after: float

    def described(self, names: tuple[str, ...]) -> str:
        """Return the sentence on it, with the names of the channels."""
        which = " or ".join(names[i] for i in self.rows)
        return (
            f"{which} points opposite to its direction in the twin: with the other sign, its shapes have "
            f"a MAC of {self.after:.0%}, not {self.before:.0%}. Samples are unchanged; reverse its direction."
        )


def sensor_polarity(
    modes: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: FloatArray | ComplexArray
) -> tuple[Turned, ...]:
    """Return the sensors whose change of sign makes the measured shapes agree with the model.

    Parameters
    ----------
    modes : measured modes
    frequency_hz : (n_modes,) of the model
    shapes : (n_channels, n_modes) of the model at the sensors
    """
    if not modes or not frequency_hz.size:
        return ()
    n = len(shapes)
    signs = np.ones(n)
    found: list[Turned] = []
    while len(found) < max(n // LARGEST_SHARE, 1):
        old = subspace_mac_nearby(modes, frequency_hz, signs[:, None] * shapes)
        tries = [
            subspace_mac_nearby(modes, frequency_hz, _flip(signs, i)[:, None] * shapes) for i in range(n)
        ]
        gains = np.array([_gain(old, new) for new in tries])
        best = int(np.argmax(gains))
        if gains[best] < LEAST_GAIN:
            break
        rows = tuple(int(i) for i in np.flatnonzero(gains > gains[best] - ALIKE))
        gained = tries[best] > old + SUFFERS
        found.append(Turned(rows, float(old[gained].mean()), float(tries[best][gained].mean())))
        if len(rows) > 1:
            break
        signs = _flip(signs, best)
    return tuple(found)


def _flip(signs: FloatArray, i: int) -> FloatArray:
    out = signs.copy()
    out[i] = -out[i]
    return out


def _gain(old: FloatArray, new: FloatArray) -> float:
    """Return the total rise of the MAC by a change of sign; 0 if the MAC of any mode falls."""
    counts = np.maximum(old, new) >= LIKE
    rise = np.where(counts, new - old, 0.0)
    return 0.0 if np.any(rise < -SUFFERS) else float(rise.sum())
