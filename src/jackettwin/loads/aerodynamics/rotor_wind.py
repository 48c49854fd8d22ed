"""Turbulent wind over a rotor and its tower.

For a parked rotor the wind is averaged over segments of each blade or given at the nodes of a grid; for a
rotating one it is sampled on rings of points through which the blades pass (rotational sampling). The rotor
disc is normal to the wind, which blows along +x. Heights are measured from still water.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics.rotor import Rotor, rotation
from jackettwin.loads.aerodynamics.standing_blades import Places, blade_pieces, grid_nodes, line_pieces
from jackettwin.loads.aerodynamics.turbulence import Coherent, turbulence
from jackettwin.loads.aerodynamics.wind import Wind
from jackettwin.loads.kernels import wind_on_blades

RINGS = (0.3, 0.55, 0.8, 1.0)
"""Radii of the rings as shares of the rotor's radius."""
SPOKES = 12
"""Azimuths of a ring at which the wind is kept: its orders up to six times the rotor's speed."""
PIECE_M = 10.0
"""Largest length of a segment of blade or tower with one wind speed [m]."""


class WindAtPoints(NamedTuple):
    """Wind at points (n_times, n_places, 3) [m/s], and shares at blade elements (n_elements, n_places)."""

    wind: FloatArray
    shares: FloatArray


@dataclass(frozen=True)
class RotorWind:
    """Fluctuations of the wind about its mean, (n_times, n, 3) [m/s] each.

    Attributes
    ----------
    hub : (n_times, 3) at the hub
    rotor : at the segments or nodes of parked blades, or at the hub and on the rings
    tower : on segments of the tower's axis from still water to the hub, or at the grid's nodes on it
    step_s : time between samples
    radius : radius of the rotor [m]
    azimuth : azimuth of the first blade of a parked rotor [rad], None if it rotates
    shares : (n_elements, n) weights of the points in the wind at each element of parked blades
    nodes_z : (n,) heights of the grid's nodes on the tower's axis, ascending [m]; None with segments
    """

    wind: Wind
    hub: FloatArray
    rotor: FloatArray
    tower: FloatArray
    step_s: float
    radius: float
    azimuth: float | None
    shares: FloatArray
    nodes_z: FloatArray | None = None

    @property
    def n_times(self) -> int:
        """Number of samples; the wind repeats after them."""
        return int(self.hub.shape[0])

    def at_hub(self) -> FloatArray:
        """Return the wind at the hub including its mean, (n_times, 3) [m/s]."""
        return np.asarray(self.hub + [self.wind.speed_m_s, 0.0, 0.0])

    def on_blades(self, rotor: Rotor, azimuth: FloatArray, *, yaw: float | FloatArray = 0.0) -> FloatArray:
        """Return the wind at the blade elements (n_times, n_elements, 3); arguments as in ``seen``."""
        wind, shares = self.seen(rotor, azimuth, yaw=yaw)
        return _spread(wind, shares)

    def seen(self, rotor: Rotor, azimuth: FloatArray, *, yaw: float | FloatArray = 0.0) -> WindAtPoints:
        """Return the wind in the nacelle's axes at its points, and their weights at the blade elements.

        Parameters
        ----------
        azimuth : (n_times,) [rad]
            Azimuth of a rotating rotor; that of a parked one is fixed when its wind is generated.
        yaw : float or (n_times,)
            Heading of the nacelle, anticlockwise from +x seen from above [rad].
        """
        turn = np.array([rotation(np.array([0.0, 0.0, 1.0]), float(one)) for one in np.atleast_1d(yaw)])
        r, n = rotor.hub_radius + rotor.blade.z, rotor.n_blades
        if self.azimuth is not None:
            spokes = self.azimuth + 2.0 * np.pi * np.arange(n) / n
            height = self.wind.hub_height_m + np.outer(np.cos(spokes), r).ravel()
            # one more point with a wind of 1 m/s along the mean, whose weight is the mean wind
            # at each element
            places = np.empty((self.n_times, self.rotor.shape[1] + 1, 3))
            places[:, :-1], places[:, -1] = self.rotor, [1.0, 0.0, 0.0]
            shares = np.hstack([self.shares, self.wind.mean(height)[:, None]])
            return WindAtPoints(places @ turn if np.any(yaw) else places, shares)
        knots = np.array([0.0, *RINGS])
        share_of_radius = r / self.radius
        ring = np.clip(np.searchsorted(knots, share_of_radius, side="right") - 1, 0, len(RINGS) - 1)
        share = np.clip((share_of_radius - knots[ring]) / (knots[ring + 1] - knots[ring]), 0.0, 1.0)
        spoke = np.repeat(np.arange(n) * SPOKES / n, r.size)
        samples = self.rotor + self._mean(_disc(self.wind.hub_height_m, self.radius)[:, 1])
        turned = np.ascontiguousarray(samples @ turn)
        on_blades = wind_on_blades(turned, azimuth, spoke, np.tile(ring, n), np.tile(share, n), SPOKES)
        return WindAtPoints(np.asarray(on_blades), np.eye(n * r.size))

    def at_heights(self, z: FloatArray) -> FloatArray:
        """Return the wind on the tower's axis at heights ``z`` (n,) [m], (n_times, n, 3)."""
        shares = np.zeros((z.size, self.tower.shape[1]))
        if self.nodes_z is not None:
            at = np.interp(z, self.nodes_z, np.arange(self.nodes_z.size))
            low = np.minimum(at.astype(np.intp), max(self.nodes_z.size - 2, 0))
            high = np.minimum(low + 1, self.nodes_z.size - 1)
            np.add.at(shares, (np.arange(z.size), low), 1.0 - (at - low))
            np.add.at(shares, (np.arange(z.size), high), at - low)
        else:
            pieces = self.tower.shape[1]
            piece = np.clip((z * pieces / self.wind.hub_height_m).astype(np.intp), 0, pieces - 1)
            shares[np.arange(z.size), piece] = 1.0
        found = _spread(self.tower, shares)
        found[:, :, 0] += self.wind.mean(z)
        return found

    def _mean(self, z: FloatArray) -> FloatArray:
        mean = np.zeros((z.size, 3))
        mean[:, 0] = self.wind.mean(z)
        return mean


def _spread(samples: FloatArray, shares: FloatArray) -> FloatArray:
    """Return shares (m, n) of samples (n_times, n, 3) as (n_times, m, 3), with time contiguous in memory."""
    flat = np.kron(shares, np.eye(3)) @ samples.reshape(samples.shape[0], -1).T
    return np.asarray(flat.reshape(-1, 3, samples.shape[0]).transpose(2, 0, 1))


def rotor_wind(
    wind: Wind,
    rotor: Rotor | None,
    *,
    duration: float,
    step: float,
    seed: int,
    azimuth: float | None = 0.0,
    coherent: Coherent = "all",
    piece: float = PIECE_M,
    grid: float | None = None,
) -> RotorWind:
    """Return wind that is periodic with ``duration`` [s], in steps of ``step`` [s].

    Parameters
    ----------
    rotor : Rotor or None
        With None only the wind on the tower is returned.
    azimuth : float or None
        Azimuth of the first blade of a parked rotor [rad]; None if it rotates.
    piece : float
        Largest length of a segment of blade or tower with one wind speed [m].
    grid : float, optional
        Spacing of a grid [m] from whose nodes the wind on parked blades and tower is interpolated instead.
    """
    hub = wind.hub_height_m
    on_rotor, shares = _on_rotor(hub, rotor, azimuth, piece, grid)
    nodes_z: FloatArray | None = None
    if grid is not None:
        nodes_z = np.asarray(hub - grid * np.arange(int(hub // grid), -1, -1), dtype=np.float64)
    tower = (
        line_pieces(np.zeros(2), np.array([0.0, hub]), piece)
        if nodes_z is None
        else np.stack([np.zeros_like(nodes_z), nodes_z], axis=1)[:, None]
    )
    places = [np.array([[[0.0, hub]]]), on_rotor, tower]
    points = np.concatenate([group.reshape(-1, 2) for group in places])
    size = np.concatenate([np.full(group.shape[0], group.shape[1]) for group in places])
    fluctuation = turbulence(
        wind,
        points,
        duration=duration,
        sample_rate_hz=1.0 / step,
        seed=seed,
        pieces=np.repeat(np.arange(size.size), size),
        coherent=coherent,
    )
    last = 1 + on_rotor.shape[0]
    return RotorWind(
        wind,
        fluctuation[:, 0],
        fluctuation[:, 1:last],
        fluctuation[:, last:],
        step,
        0.0 if rotor is None else rotor.radius,
        azimuth,
        shares,
        nodes_z,
    )


def _on_rotor(
    hub_height: float, rotor: Rotor | None, azimuth: float | None, piece: float, grid: float | None
) -> Places:
    if rotor is None:
        return Places(np.empty((0, 1, 2)), np.empty((0, 0)))
    if azimuth is None:
        return Places(_disc(hub_height, rotor.radius)[:, None, :], np.empty((0, 0)))
    if grid is None:
        return blade_pieces(hub_height, rotor, azimuth, piece)
    return grid_nodes(hub_height, rotor, azimuth, grid)


def _disc(hub_height: float, radius: float) -> FloatArray:
    """Return (y, z) of the hub and the rings; spoke 0 points up, further ones follow the rotation."""
    angle = 2.0 * np.pi * np.arange(SPOKES) / SPOKES
    rings = [radius * share * np.stack([-np.sin(angle), np.cos(angle)], axis=1) for share in RINGS]
    return np.asarray(np.vstack([np.zeros((1, 2)), *rings]) + [0.0, hub_height])
