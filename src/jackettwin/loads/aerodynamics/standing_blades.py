"""Wind on the blades of a parked rotor: averaged over segments, or from the nodes of a grid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics.rotor import Rotor

_POINTS = 5
"""Number of points over which a segment is averaged."""


class Places(NamedTuple):
    """Places with separate wind, and their weights in the wind at each blade element.

    Attributes
    ----------
    points : (n_places, n, 2) y and height [m] of the points whose mean wind is that of a place
    shares : (n_elements, n_places) weights, blade by blade
    """

    points: FloatArray
    shares: FloatArray


def blade_pieces(hub_height: float, rotor: Rotor, azimuth: float, piece: float) -> Places:
    """Return segments of every blade no longer than ``piece`` [m], from the hub's centre to the tips.

    The wind at an element is the mean wind over its segment.
    """
    centre = np.array([0.0, hub_height])
    tips = centre + rotor.radius * _along(rotor, azimuth)
    points = np.concatenate([line_pieces(centre, tip, piece) for tip in tips])
    n, r = rotor.n_blades, rotor.hub_radius + rotor.blade.z
    each = points.shape[0] // n
    on = np.minimum((r * each / rotor.radius).astype(np.intp), each - 1)
    shares = np.zeros((n * r.size, points.shape[0]))
    shares[np.arange(n * r.size), np.concatenate([on + blade * each for blade in range(n)])] = 1.0
    return Places(points, shares)


def grid_nodes(hub_height: float, rotor: Rotor, azimuth: float, spacing: float) -> Places:
    """Return the nodes around the blades of a grid of ``spacing`` [m], one of them at the hub.

    The wind at an element is interpolated bilinearly between four nodes, as other programs do with wind
    files.
    """
    r = rotor.hub_radius + rotor.blade.z
    at = (_along(rotor, azimuth)[:, None, :] * r[:, None]).reshape(-1, 2) / spacing
    n = int(np.ceil(np.abs(at).max()))
    steps = np.arange(-n, n + 1, dtype=np.float64)
    across, up = (np.maximum(1.0 - np.abs(x[:, None] - steps), 0.0) for x in at.T)
    shares = (across[:, :, None] * up[:, None, :]).reshape(at.shape[0], -1)
    nodes = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) * spacing
    used = shares.any(axis=0)
    return Places((nodes[used] + [0.0, hub_height])[:, None, :], shares[:, used])


def line_pieces(start: FloatArray, end: FloatArray, piece: float) -> FloatArray:
    """Return points (n_pieces, n, 2) of the segments of a line."""
    n = int(np.ceil(np.linalg.norm(end - start) / piece))
    share = (np.arange(n * _POINTS) + 0.5) / (n * _POINTS)
    return np.asarray((start + share[:, None] * (end - start)).reshape(n, _POINTS, 2))


def _along(rotor: Rotor, azimuth: float) -> FloatArray:
    """Return unit vectors (n_blades, 2: y and z) along the blades."""
    angle = azimuth + 2.0 * np.pi * np.arange(rotor.n_blades) / rotor.n_blades
    return np.stack([-np.sin(angle), np.cos(angle)], axis=1)
