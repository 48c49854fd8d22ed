r"""Peaks of one sensor alone beside a mode, told by the plane of the two shapes.

A mount or a cable that shakes moves its sensor alone, with the shape :math:`e_i`. Beside a mode, one record
tells the plane of the two shapes, not the shapes in it: neither looks like one sensor's, but :math:`e_i` lies
in their plane, where the unit vector of a sensor lies by chance only. The one that moves the sensor more is
the mount's.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.identification.selection.neighbours import apart

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate

IN_PLANE = 0.99
"""Share of a sensor's unit vector in the plane of two shapes, from which it is taken for theirs: 0.999 to 1
of sensors that shake beside a mode; at most 0.92 of pairs of modes of random systems. Of random planes among
four channels four in a hundred hold one, among five one in two hundred."""
FEWEST_PEERS = 2
"""Other sensors that could see what moves a sensor."""


def of_one_sensor(
    modes: Sequence[ModalEstimate], scale: FloatArray, comparable: BoolArray, close: float
) -> dict[int, float]:
    """Return the modes that are of one sensor beside another, and the share of it in their motion.

    Parameters
    ----------
    scale : (n_channels,)
        By which shapes are divided.
    comparable : (n_channels, n_channels)
        Which channels may show the same motion: those not known to be crosswise.
    close : float
        Half bandwidths together within which two modes share their plane.
    """
    found: dict[int, float] = {}
    told = comparable.sum(axis=1) > FEWEST_PEERS
    for i, j in combinations(range(len(modes)), 2):
        if apart(modes[i], modes[j]) >= close:
            continue
        shapes = np.array([modes[k].mode_shape / scale for k in (i, j)])
        inside = np.sum(np.abs(np.linalg.qr(shapes.T)[0]) ** 2, axis=1)
        sensor = int(np.argmax(np.where(told, inside, 0.0)))
        if not told[sensor] or inside[sensor] < IN_PLANE:
            continue
        share = np.abs(shapes[:, sensor]) ** 2 / np.sum(np.abs(shapes) ** 2, axis=1)
        own = int(np.argmax(share))
        found[(i, j)[own]] = float(share[own])
    return found
