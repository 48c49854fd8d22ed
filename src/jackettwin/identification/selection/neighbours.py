r"""Recognition, by shape, of force peaks between two modes and of modes that were identified twice.

Between its modes a structure moves in a combination of the modes on either side,
:math:`y(f) = \sum_i \phi_i h_i(f) p_i(f)`. A peak of the forces p thus makes a peak of y, which can be as
sharp and stable as that of a mode but has a shape in the plane of its neighbours' shapes. The same holds for
a peak of an unmeasured base motion. The shape of a mode lies in that plane only by chance. Among close modes
that no fit describes, one may be identified twice; its second shape is a combination of the others' shapes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.identification.status import ModeStatus

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate
    from jackettwin.records import Channel

MAX_OUTSIDE_SHARE = 0.01
"""Share of a shape outside the span of its neighbours' shapes below which it is their combination.
Wave peaks between the first two pairs of a simulated jacket have 0.001;
of 60 modes of random systems none had less than 0.03."""
PAIR_DISTANCE, AXIS_SHARE = 2.0, 0.95
"""Distance over the sum of half bandwidths within which two modes are a pair, and the least share of its
energy along one axis that a shape in their plane must have for each axis."""
_DISTINCT = 0.2
"""Least singular value, of shapes of unit length, of a dimension of the neighbours' span: two shapes whose
MAC is above about 0.92 have one. What little else a wave peak has beside a first mode's shape is the
quasi-static part of the second modes, of which every second mode would then be a combination."""
MIN_FREE_DIMENSIONS = 2
"""Dimensions outside the neighbours' span that are required; with fewer,
almost any shape is a combination."""
MAX_SHARE_OF_ONE = 1e-3
"""The same share where the sensors along the shape's main axis leave one dimension, as three levels do beside
two pairs of modes: of shapes of three random entries one in ten has less than 0.01 outside a plane, one in 32
less than this; of six entries one in fifty has less than 0.01 outside four dimensions."""


def combinations_of_neighbours(
    modes: Sequence[ModalEstimate], scale: FloatArray, close: float, comparable: BoolArray | None = None
) -> list[int]:
    """Return the modes whose shapes are combinations of those of the modes below and above.

    Neither doubtful modes nor modes already returned are used as neighbours. If two modes are each a
    combination of the other and a third one, the more damped is returned first, since force peaks are broad.

    Parameters
    ----------
    modes : by ascending frequency
    scale : (n_channels,)
        Shapes are divided by it.
    close : float
        Distance over the sum of half bandwidths within which modes count as close, not as neighbours.
    comparable : (n_channels, n_channels), optional
        Channels that may show the same motion, those not known to be perpendicular; by default all may.
    """

    def outside(i: int, free: Sequence[int]) -> float:
        return _outside(modes, i, _either_side(modes, free, i, close), scale, comparable)

    return _take_in_turn(modes, outside, lambda mode: mode.damping_ratio)


def identified_twice(
    modes: Sequence[ModalEstimate], scale: FloatArray, close: float, comparable: BoolArray | None = None
) -> list[int]:
    """Return modes without a fit whose shapes are combinations of those of modes close to them.

    Of several modes that are combinations of one another, the one of most uncertain frequency is returned
    first. Two close modes of nearly one shape are recognised by their MAC; here at least three are involved.

    Parameters
    ----------
    modes : by ascending frequency
    scale : (n_channels,)
        Shapes are divided by it.
    close : float
        Distance over the sum of half bandwidths within which modes are close.
    comparable : (n_channels, n_channels), optional
        As of :func:`combinations_of_neighbours`.
    """

    def outside(i: int, free: Sequence[int]) -> float:
        near = [j for j in free if j != i and apart(modes[i], modes[j]) < close]
        beside = near if modes[i].unrefined is None and len(near) > 1 else []
        return _outside(modes, i, beside, scale, comparable)

    return _take_in_turn(modes, outside, lambda mode: (mode.frequency_std_hz or np.inf) / mode.frequency_hz)


def _take_in_turn(
    modes: Sequence[ModalEstimate],
    outside: Callable[[int, Sequence[int]], float],
    rank: Callable[[ModalEstimate], float],
) -> list[int]:
    """Return modes whose shapes are combinations of others, the one of highest rank first.

    ``outside`` returns the share of a mode's shape outside the span of its neighbours among the remaining
    modes, neither doubtful nor returned.
    """
    found: list[int] = []
    while True:
        free = [i for i, m in enumerate(modes) if i not in found and m.status != ModeStatus.DOUBTFUL]
        theirs = [i for i in free if outside(i, free) < MAX_OUTSIDE_SHARE]
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


def _outside(
    modes: Sequence[ModalEstimate],
    i: int,
    beside: Sequence[int],
    scale: FloatArray,
    comparable: BoolArray | None,
) -> float:
    """Return the share of a shape outside the span of others; 1 if there are none or too many of them."""
    if not beside:
        return 1.0
    own, others = modes[i].mode_shape / scale, [modes[j].mode_shape / scale for j in beside]
    inside, dimensions = share_in_span(own, others)
    if dimensions > len(scale) - MIN_FREE_DIMENSIONS:
        return 1.0
    outside = 1.0 - inside
    if comparable is None:
        return outside
    along = comparable[np.argmax(np.abs(own))]
    there = _span([other[along] / np.linalg.norm(other) for other in others]).shape[1]
    few = along.sum() - there < MIN_FREE_DIMENSIONS
    return 1.0 if few and outside > MAX_SHARE_OF_ONE else outside


def share_in_span(shape: ComplexArray, others: Sequence[ComplexArray]) -> tuple[float, int]:
    """Return the share of a shape in the span of others (one or more), and the dimensions of that."""
    basis = _span([other / np.linalg.norm(other) for other in others])
    return float(np.sum(np.abs(basis.conj().T @ shape) ** 2) / np.sum(np.abs(shape) ** 2)), basis.shape[1]


def _span(vectors: Sequence[ComplexArray]) -> ComplexArray:
    """Return the distinct dimensions of some vectors, orthonormal in columns."""
    u, s, _ = np.linalg.svd(np.array(vectors).T, full_matrices=False)
    return np.asarray(u[:, s > _DISTINCT])


def members_of_pairs(modes: Sequence[ModalEstimate], channels: Sequence[Channel]) -> set[int]:
    """Return the members of close pairs whose plane contains a shape along each of the horizontal axes.

    A structure of equal stiffness in two directions has its modes in such pairs. If one member is a mode, so
    is the other: a tone would need to have nearly the same frequency and to move along the other axis only.

    Parameters
    ----------
    channels : (n_channels,)
        With their directions; channels without a direction belong to no axis.
    """
    along = np.array([(0.0, 0.0, 0.0) if c.direction is None else c.direction for c in channels])[:, :2]
    found: set[int] = set()
    for i, j in combinations(range(len(modes)), 2):
        if apart(modes[i], modes[j]) < PAIR_DISTANCE:
            plane: ComplexArray = np.linalg.qr(np.array([modes[i].mode_shape, modes[j].mode_shape]).T)[0]
            shares = (np.linalg.eigvalsh((plane.conj().T * axis**2) @ plane)[-1] for axis in along.T)
            if min(shares) > AXIS_SHARE:
                found |= {i, j}
    return found


def apart(mode: ModalEstimate, other: ModalEstimate) -> float:
    """Return the distance of two modes over the sum of their half bandwidths."""
    both = mode.damping_ratio * mode.frequency_hz + other.damping_ratio * other.frequency_hz
    return abs(mode.frequency_hz - other.frequency_hz) / both
