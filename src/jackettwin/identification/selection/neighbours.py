r"""Peaks of the forces between two modes, and modes told twice, by their shape.

Between its modes a structure moves in a combination of those on either side,
:math:`y(f) = \sum_i \phi_i h_i(f) p_i(f)`: a peak of the forces p makes a peak of y, sharp and stable as that
of a mode, whose shape lies in the plane of its neighbours' shapes. So does a peak of what shakes the
structure and is not measured itself. That of a mode of the structure lies there by chance only. Of close
modes that no fit describes, one may be told twice: then its second shape is a combination of theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.status import ModeStatus

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate

OUTSIDE = 0.01
"""Share of a shape outside of its neighbours' below which it is theirs. Peaks of waves between the first two
pairs of a simulated jacket have 0.001; of 60 modes of random systems none had less than 0.03."""
LEFT = 2
"""Dimensions that the neighbours must leave: in fewer any shape is nearly theirs."""


def of_neighbours(modes: Sequence[ModalEstimate], scale: FloatArray, close: float) -> list[int]:
    """Return the modes whose shapes are combinations of those of the modes below and above.

    Modes that are doubted already are nobody's neighbours; one that is told takes no part in the others'. Two
    pairs may each lie in the plane of the other and a third: the broader is told first, as forces are broad.

    Parameters
    ----------
    modes : by ascending frequency
    scale : (n_channels,)
        By which shapes are divided.
    close : float
        Half bandwidths together within which modes are neighbours of one another, not on either side.
    """
    return _one_after_another(
        modes, scale, lambda free, i: _either_side(modes, free, i, close), lambda mode: mode.damping_ratio
    )


def told_twice(modes: Sequence[ModalEstimate], scale: FloatArray, close: float) -> list[int]:
    """Return the modes that no fit describes whose shapes are combinations of those of modes close to them.

    Of several that are so of one another the one of least known frequency is told first. Two close modes of
    nearly one shape are told by its MAC alone; here they are at least three.

    Parameters
    ----------
    modes : by ascending frequency
    scale : (n_channels,)
        By which shapes are divided.
    close : float
        Half bandwidths together within which modes are close.
    """

    def beside(free: Sequence[int], i: int) -> list[int]:
        near = [j for j in free if j != i and apart(modes[i], modes[j]) < close]
        return near if modes[i].unrefined is None and len(near) > 1 else []

    return _one_after_another(
        modes, scale, beside, lambda mode: (mode.frequency_std_hz or np.inf) / mode.frequency_hz
    )


def _one_after_another(
    modes: Sequence[ModalEstimate],
    scale: FloatArray,
    beside: Callable[[Sequence[int], int], Sequence[int]],
    rank: Callable[[ModalEstimate], float],
) -> list[int]:
    """Return the modes whose shapes are those of others beside them, that of the highest rank first.

    ``beside`` says which of the modes that are free, neither doubted nor told, lie beside one of them.
    """
    found: list[int] = []
    while True:
        free = [i for i, m in enumerate(modes) if i not in found and m.status != ModeStatus.DOUBTFUL]
        theirs = [i for i in free if _outside(modes, i, beside(free, i), scale) < OUTSIDE]
        if not theirs:
            return found
        found.append(max(theirs, key=lambda i: rank(modes[i])))


def _either_side(modes: Sequence[ModalEstimate], free: Sequence[int], i: int, close: float) -> list[int]:
    """Return the neighbours of a mode and those close to them; none if it has none on one side."""
    below = [j for j in free if j < i and apart(modes[i], modes[j]) >= close]
    above = [j for j in free if j > i and apart(modes[i], modes[j]) >= close]
    if not below or not above:
        return []
    return [
        *(j for j in below if apart(modes[j], modes[below[-1]]) < close),
        *(j for j in above if apart(modes[j], modes[above[0]]) < close),
    ]


def _outside(modes: Sequence[ModalEstimate], i: int, beside: Sequence[int], scale: FloatArray) -> float:
    """Return the share of a shape outside of those of others; 1 if there are none or too many of them."""
    if not beside or len(beside) > len(scale) - LEFT:
        return 1.0
    basis: ComplexArray = np.linalg.qr(np.array([modes[j].mode_shape / scale for j in beside]).T)[0]
    shape = modes[i].mode_shape / scale
    inside = float(np.sum(np.abs(basis.conj().T @ shape) ** 2) / np.sum(np.abs(shape) ** 2))
    return 1.0 - inside


def apart(mode: ModalEstimate, other: ModalEstimate) -> float:
    """Return the distance of two modes in their half bandwidths together."""
    both = mode.damping_ratio * mode.frequency_hz + other.damping_ratio * other.frequency_hz
    return abs(mode.frequency_hz - other.frequency_hz) / both
