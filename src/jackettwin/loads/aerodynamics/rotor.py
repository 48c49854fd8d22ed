r"""A rotor as blade elements in the frame of the tower top.

Frame: x downwind along the nacelle, y to the left, z up; origin at the tower top. Positive pitch turns the
noses into the wind; at 90° the blades are feathered. Aerodynamics are quasi-steady: the flow at each element
is the wind minus the element's velocity (and minus the wake's induction, if given), and only its component in
the plane of the section matters.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.errors import require
from jackettwin.loads.aerodynamics.blades import ALPHA, Blade
from jackettwin.loads.kernels import blade_elements
from jackettwin.structure import BladeStructure

AIR_KG_M3 = 1.225
"""Density of air at 15 °C and 1013 hPa, at sea level (ISO 2533)."""
SHAFTS = ("locked", "free")


@dataclass(frozen=True)
class Rotor:
    """Blades on a hub: overhang and hub height from the tower top [m], tilt and cone [rad].

    ``bending`` is what the blades are made of, where that is known.
    """

    blade: Blade
    n_blades: int
    hub_radius: float
    overhang: float
    hub_height: float
    tilt: float
    cone: float
    bending: BladeStructure | None = None

    @property
    def hub(self) -> FloatArray:
        """Hub centre (3,) [m]."""
        return np.array([-self.overhang, 0.0, self.hub_height])

    @property
    def shaft(self) -> FloatArray:
        """Unit vector along the shaft, downwind; the rotor turns about it (clockwise seen from upwind)."""
        return np.array([np.cos(self.tilt), 0.0, -np.sin(self.tilt)])

    @property
    def radius(self) -> float:
        """Distance of the tip from the shaft [m]."""
        z, x = self.hub_radius + self.blade.z[-1], self.blade.prebend[-1]
        return float(z * np.cos(self.cone) + x * np.sin(self.cone))

    def scaled(self, factor: float) -> Rotor:
        """Return the similar rotor whose lengths are multiplied by a factor."""
        lengths = ("z", "prebend", "chord", "weight")
        blade = replace(self.blade, **{name: factor * getattr(self.blade, name) for name in lengths})
        own = ("hub_radius", "overhang", "hub_height")
        return replace(self, blade=blade, **{name: factor * getattr(self, name) for name in own})


class Elements(NamedTuple):
    """Blade elements at azimuth zero, (n_blades, n, 3): position from the hub, chord and normal."""

    arm: FloatArray
    chordwise: FloatArray
    normal: FloatArray


def elements(rotor: Rotor, pitch: float) -> Elements:
    """Return the elements of all blades, the first pointing up.

    Prebend rotates with the pitch; sections are normal to the pitch axis.
    """
    d = rotor.shaft
    up = np.array([np.sin(rotor.tilt), 0.0, np.cos(rotor.tilt)])
    blade = rotor.blade
    cos_twist, sin_twist = np.cos(blade.twist)[:, None], np.sin(blade.twist)[:, None]
    parts = []
    for psi in 2.0 * np.pi * np.arange(rotor.n_blades) / rotor.n_blades:
        radial = np.cos(psi) * up + np.sin(psi) * np.cross(d, up)
        z = np.cos(rotor.cone) * radial - np.sin(rotor.cone) * d
        x0 = np.cos(rotor.cone) * d + np.sin(rotor.cone) * radial
        y0 = np.cross(z, x0)
        x, y = np.cos(pitch) * x0 - np.sin(pitch) * y0, np.cos(pitch) * y0 + np.sin(pitch) * x0
        arm = (rotor.hub_radius + blade.z)[:, None] * z + blade.prebend[:, None] * x
        parts.append((arm, cos_twist * y + sin_twist * x, cos_twist * x - sin_twist * y))
    return Elements(*(np.stack(columns) for columns in zip(*parts, strict=True)))


def rotation(axis: FloatArray, angle: float) -> FloatArray:
    """Return the 3×3 rotation by ``angle`` about a unit ``axis``."""
    S = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * S + (1.0 - np.cos(angle)) * S @ S)


def rotor_loads(
    rotor: Rotor,
    wind: FloatArray,
    *,
    pitch: float,
    azimuth: float = 0.0,
    motion: FloatArray | None = None,
    rotor_speed: float = 0.0,
    shaft: str = "locked",
    induced: FloatArray | None = None,
    density: float = AIR_KG_M3,
) -> FloatArray:
    """Return force and moment at the tower top (..., 6) [N, N·m], in the nacelle's frame.

    Parameters
    ----------
    wind : (..., 3) or (..., n_blades, n, 3)
        Wind [m/s] in the nacelle's frame, over the rotor or at every element.
    pitch, azimuth : float
        [rad].
    motion : (..., 6), optional
        Velocity of the tower top [m/s, rad/s].
    rotor_speed : float
        [rad/s].
    shaft : {"locked", "free"}
        A free shaft neither rotates the rotor with the tower nor transmits its torque.
    induced : (n, 2), optional
        Axial and tangential induced velocity at the stations [m/s].
    """
    require(shaft in SHAFTS, "unknown shaft", field="shaft", value=shaft, allowed=", ".join(SHAFTS))
    wind = wind if wind.ndim > 2 else wind[..., None, None, :]
    motion = np.zeros(6) if motion is None else motion
    leading = np.broadcast_shapes(wind.shape[:-3], motion.shape[:-1])
    compiled = compiled_rotor(
        rotor,
        pitch=pitch,
        azimuth=azimuth,
        rotor_speed=rotor_speed,
        shaft=shaft,
        induced=induced,
        density=density,
    )
    n = int(np.prod(leading))
    out = compiled.loads(
        np.broadcast_to(wind, (*leading, rotor.n_blades, rotor.blade.z.size, 3)).reshape(n, -1, 3),
        np.broadcast_to(motion, (*leading, 6)).reshape(n, 6),
        np.zeros(n),
    )
    return out.reshape(*leading, 6)


@dataclass(frozen=True)
class CompiledRotor:
    """A rotor at one pitch and speed as arrays for compiled loops over time; elements blade by blade."""

    fixed: tuple[Any, ...]

    def seeing(self, shares: FloatArray) -> CompiledRotor:
        """Return the rotor whose elements have ``shares`` (n_elements, n) of the wind at n points."""
        table = sp.csr_array(shares)
        return CompiledRotor((*self.fixed[:_SEEN], table.indptr, table.indices, table.data))

    def loads(self, wind: FloatArray, motion: FloatArray, angle: FloatArray) -> FloatArray:
        """Return loads (n, 6) in wind at the elements or points (n, n_places, 3) with motion (n, 6).

        ``angle`` (n,) is the rotation of the rotor from the azimuth for which it was compiled [rad].
        """
        out = np.empty((wind.shape[0], 6))
        blade_elements(*(*self.fixed, angle, wind, motion, out))
        return out


_SEEN = 11
"""Number of arrays of a compiled rotor before those of the wind at its elements."""


def compiled_rotor(
    rotor: Rotor,
    *,
    pitch: float,
    azimuth: float = 0.0,
    rotor_speed: float = 0.0,
    shaft: str = "locked",
    induced: FloatArray | None = None,
    density: float = AIR_KG_M3,
) -> CompiledRotor:
    """Return the rotor prepared for loops over time; arguments as in ``rotor_loads``."""
    blade, B, d = rotor.blade, rotor.n_blades, rotor.shaft
    turn = rotation(d, azimuth)
    arm, chordwise, normal = (part.reshape(-1, 3) @ turn.T for part in elements(rotor, pitch))
    along, across = (np.hstack([part, np.cross(arm, part)]) for part in (chordwise, normal))
    wake = np.zeros((arm.shape[0], 2)) if induced is None else np.tile(induced, (B, 1))
    swirl = np.cross(d, arm)
    swirl *= (wake[:, 1] / np.linalg.norm(swirl, axis=1))[:, None]
    # flow at an element due to the wake and to the rotor's rotation
    lost = wake[:, :1] * d + swirl
    own = [np.sum(lost * part[:, :3], axis=1) + rotor_speed * (part[:, 3:] @ d) for part in (along, across)]
    rotor_alone = CompiledRotor(
        (
            np.ascontiguousarray(along.T),
            np.ascontiguousarray(across.T),
            np.stack(own),
            np.tile(np.arange(blade.z.size), B),
            np.tile(0.5 * density * blade.chord * blade.weight, B),
            np.stack([blade.cl, blade.cd], axis=-1),
            float(ALPHA[0]),
            float(ALPHA[1] - ALPHA[0]),
            d,
            rotor.hub,
            shaft == "free",
        )
    )
    return rotor_alone.seeing(np.eye(arm.shape[0]))


class Linearised(NamedTuple):
    """Mean load (6,) with damping and stiffness matrices (6, 6): F ≈ load − damping·ẋ − stiffness·x."""

    load: FloatArray
    damping: FloatArray
    stiffness: FloatArray


def linearise(
    rotor: Rotor,
    wind_speed: float,
    *,
    pitch: float,
    yaw_error: float = 0.0,
    azimuth: float | None = None,
    rotor_speed: float = 0.0,
    shaft: str = "locked",
    induced: FloatArray | None = None,
    density: float = AIR_KG_M3,
) -> Linearised:
    """Return the rotor linearised about steady uniform wind, at the tower top in the nacelle's frame.

    Parameters
    ----------
    yaw_error : float
        Direction of the wind relative to the nacelle's x axis [rad].
    azimuth : float, optional
        Azimuth of the rotor [rad]; None averages over the angle between two blades.

    Notes
    -----
    The stiffness arises because a small rotation of the tower top changes the angle between rotor and wind
    and rotates the load. In uniform wind, translations have no stiffness.
    """
    wind = wind_speed * np.array([np.cos(yaw_error), np.sin(yaw_error), 0.0])
    places = 2.0 * np.pi / rotor.n_blades * np.arange(12) / 12 if azimuth is None else np.array([azimuth])
    # 0.05 m/s: small compared with the wind, large compared with rounding
    h = np.array([0.05] * 3 + [0.05 / rotor.radius] * 3)
    small = 1e-3
    turns = np.array([rotation(axis, sign * small) for sign in (1.0, -1.0) for axis in np.eye(3)])
    # at rest, with motion and rotation of either sign: all in one call
    winds = np.vstack([np.tile(wind, (13, 1)), turns.swapaxes(1, 2) @ wind])
    motions = np.vstack([np.zeros(6), np.diag(h), -np.diag(h), np.zeros((6, 6))])
    found = np.zeros((winds.shape[0], 6))
    for psi in places:
        found += rotor_loads(
            rotor,
            winds[:, None, None],
            pitch=pitch,
            azimuth=float(psi),
            motion=motions,
            rotor_speed=rotor_speed,
            shaft=shaft,
            induced=induced,
            density=density,
        )
    found /= places.size
    turned = (turns[:, None] @ found[13:].reshape(6, 2, 3, 1)).reshape(6, 6)
    stiffness = np.zeros((6, 6))
    stiffness[:, 3:] = (turned[3:] - turned[:3]).T / (2.0 * small)
    return Linearised(found[0], (found[7:13] - found[1:7]).T / (2.0 * h), stiffness)


def in_global_axes(matrix: FloatArray, yaw: float) -> FloatArray:
    """Return R C Rᵀ, the 6×6 matrix of a nacelle rotated by ``yaw`` [rad] about z."""
    R = np.kron(np.eye(2), rotation(np.array([0.0, 0.0, 1.0]), yaw))
    return np.asarray(R @ matrix @ R.T)
