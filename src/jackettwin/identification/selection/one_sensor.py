r"""Recognition of the motion of a single sensor close to a mode, by the plane of the two shapes.

A vibrating mount or cable moves its sensor alone, with the shape :math:`e_i`.
Close to a mode, one record determines the plane of the two shapes but not the shapes in it.
Neither shape is then that of one sensor, but :math:`e_i` lies in their plane, whereas the unit vector of
another sensor lies there only by chance. The mode in which the sensor moves more is that of its mount.
Over the rms of each channel the first modes of a turbine whose rotor turns are nearly those of its top, since
all else moves faster: the unit vector must lie in the plane of the shapes as they are, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.identification.selection.neighbours import apart

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate

MIN_IN_PLANE = 0.99
"""Share of a sensor's unit vector in the plane of two shapes above which that sensor moves alone.
The share is 0.999 to 1 for sensors that vibrate close to a mode and at most 0.92 for pairs of modes of random
systems. Of random planes, four in a hundred contain a unit vector by chance with four channels, one in two
hundred with five."""
MIN_OTHER_SENSORS = 2
"""Fewest other sensors that could measure the motion of the same point and direction."""
_ONE_SHAPE = 1e-6
"""Singular value below which two shapes of unit length are one, to rounding: one peak told twice."""


def of_one_sensor(
    modes: Sequence[ModalEstimate], scale: FloatArray, comparable: BoolArray, close: float
) -> dict[int, float]:
    """Return the index of each mode that is motion of one sensor, with that sensor's share of its motion.

    Parameters
    ----------
    scale : (n_channels,)
        Shapes are divided by it.
    comparable : (n_channels, n_channels)
        Channels that may show the same motion: those not known to be perpendicular.
    close : float
        Distance over the sum of half bandwidths within which two modes share their plane.
    """
    found: dict[int, float] = {}
    told = comparable.sum(axis=1) > MIN_OTHER_SENSORS
    for i, j in combinations(range(len(modes)), 2):
        if apart(modes[i], modes[j]) >= close:
            continue
        as_measured: ComplexArray = np.array([modes[k].mode_shape for k in (i, j)])
        shapes = np.asarray(as_measured / scale)
        inside = np.minimum(_in_plane(shapes), _in_plane(as_measured))
        sensor = int(np.argmax(np.where(told, inside, 0.0)))
        if not told[sensor] or inside[sensor] < MIN_IN_PLANE:
            continue
        share = np.abs(shapes[:, sensor]) ** 2 / np.sum(np.abs(shapes) ** 2, axis=1)
        own = int(np.argmax(share))
        found[(i, j)[own]] = float(share[own])
    return found


def _in_plane(shapes: ComplexArray) -> FloatArray:
    """Return the share of each sensor's unit vector in the plane of two shapes; 0 if they span none."""
    u, size, _ = np.linalg.svd(shapes.T / np.linalg.norm(shapes, axis=1), full_matrices=False)
    if size[-1] < _ONE_SHAPE:  # one shape spans no plane
        return np.zeros(shapes.shape[1])
    return np.asarray(np.sum(np.abs(u) ** 2, axis=1))
