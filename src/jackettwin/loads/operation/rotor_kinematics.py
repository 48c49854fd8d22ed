"""Kinematics of a turning rotor: blade elements by azimuth, and harmonics of what varies with it.

Arrays over azimuth have it first, (places, ...): what one blade does over a revolution. The mean over azimuth
of what all blades do is what they do together; multiples of the blades' passing drop out.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.loads.aerodynamics.rotor import Rotor
from jackettwin.structure import cross_matrix

PLACES = 12
"""Azimuths of a revolution: products of three quantities that vary once a revolution are still exact."""
AZIMUTH = 2.0 * np.pi / PLACES * np.arange(PLACES)
ORDERS = np.fft.fftfreq(PLACES, 1.0 / PLACES)
"""Multiples of the rotor's speed that these azimuths tell apart."""

Array = TypeVar("Array", FloatArray, ComplexArray)


def in_plane(rotor: Rotor) -> FloatArray:
    """Return two unit vectors (2, 3) of the rotor's plane: of azimuth zero, and of a quarter turn on."""
    up = np.array([np.sin(rotor.tilt), 0.0, np.cos(rotor.tilt)])
    return np.stack([up, np.cross(rotor.shaft, up)])


def radial(rotor: Rotor) -> FloatArray:
    """Return the unit vectors (places, 3) from the shaft along the blade."""
    return np.asarray(np.stack([np.cos(AZIMUTH), np.sin(AZIMUTH)], axis=1) @ in_plane(rotor))


def blade_frames(rotor: Rotor) -> FloatArray:
    """Return x downwind, y against the rotation and z along the pitch axis as columns (places, 3, 3)."""
    out, d = radial(rotor), rotor.shaft
    z = np.cos(rotor.cone) * out - np.sin(rotor.cone) * d
    x = np.cos(rotor.cone) * d + np.sin(rotor.cone) * out
    return np.stack([x, np.cross(z, x), z], axis=-1)


def arms(rotor: Rotor, z: FloatArray, offset: FloatArray) -> FloatArray:
    """Return elements (places, n, 3) from the hub, at ``z`` (n,) along the blade with ``offset`` (n, 3)."""
    along = offset + (rotor.hub_radius + z)[:, None] * np.array([0.0, 0.0, 1.0])
    return np.asarray(np.einsum("pij,nj->pni", blade_frames(rotor), along))


def prebend(rotor: Rotor, z: FloatArray, pitch: float) -> FloatArray:
    """Return how far the unloaded blade lies from its pitch axis in the unpitched blade's frame, (n, 3)."""
    off = np.interp(z, rotor.blade.z, rotor.blade.prebend)
    return np.stack([np.cos(pitch) * off, -np.sin(pitch) * off, np.zeros_like(off)], axis=1)


def flow_directions(rotor: Rotor, slope: FloatArray) -> FloatArray:
    """Return the directions (places, n, 2, 3) of the flow that elements see: normal to the blade, and swirl.

    ``slope`` (n,) is dx/dz of the bent blade's axis.
    """
    frames = blade_frames(rotor)[:, None]
    angle = np.arctan(slope)[:, None]
    normal = np.cos(angle) * frames[..., 0] - np.sin(angle) * frames[..., 2]
    return np.stack([normal, np.broadcast_to(frames[..., 1], normal.shape)], axis=-2)


def motions(rotor: Rotor, arm: FloatArray, *, shaft: str) -> FloatArray:
    """Return the velocity of elements of the tower top's, (places, n, 3, 6).

    A free shaft does not turn the blades with the tower.
    """
    out = np.empty((*arm.shape, 6))
    out[..., :3] = np.eye(3)
    out[..., 3:] = -cross_matrix(rotor.hub) - cross_matrix(arm) @ handed_on(rotor, shaft)
    return out


def handed_on(rotor: Rotor, shaft: str) -> FloatArray:
    """Return the part (3, 3) of a turn or moment that the shaft hands on: a free one none about itself."""
    return np.eye(3) - (np.outer(rotor.shaft, rotor.shaft) if shaft == "free" else 0.0)


def through(values: FloatArray | ComplexArray, gain: FloatArray | ComplexArray) -> ComplexArray:
    """Return what a filter makes of ``values`` (places, ...); ``gain`` (places, ...) is by ``ORDERS``."""
    padded = gain.reshape(gain.shape + (1,) * (values.ndim - gain.ndim))
    return np.asarray(np.fft.ifft(padded * np.fft.fft(values, axis=0), axis=0))


def rates(pole: complex, speed: float) -> ComplexArray:
    """Return λ + imΩ by order: the time derivative, of e^{λt}, in axes that do not turn with the blade."""
    return np.asarray(pole + 1j * ORDERS * speed)
