r"""Sensors that point the other way than the twin says: told by the shapes of its model.

A sensor whose sign is wrong turns its row in every measured shape. Where it holds the share p of a shape, the
subspace MAC with the model falls from 1 to :math:`(1-2p)^2`, in every mode; turned back, none may suffer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification import ModalEstimate
from jackettwin.updating import subspace_mac_nearby

LEAST_GAIN = 0.15
"""Rise of the subspace MAC, summed over the modes, below which nothing is said."""
LIKE = 0.9
"""Likeness that the modes which gain reach at least, turned back."""
SUFFERS = 0.02
"""Fall of a mode's subspace MAC that a turned sensor cannot cause."""
ALIKE = 0.05
"""Sensors whose turn gains the same within this cannot be told from each other."""
LARGEST_SHARE = 3
"""At most one sensor in so many is said to be turned."""


@dataclass(frozen=True)
class Turned:
    """A sensor that moves against the model, or several of which one does.

    Attributes
    ----------
    rows : tuple of int
        Of the shapes.
    before, after : float
        Mean subspace MAC of the modes that gain.
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
    """Return the sensors whose turned sign would make the measured shapes those of the model.

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
    """Return by how much a turn brings the modes nearer to the model; 0 if any suffers."""
    counts = np.maximum(old, new) >= LIKE
    rise = np.where(counts, new - old, 0.0)
    return 0.0 if np.any(rise < -SUFFERS) else float(rise.sum())
