"""A blade as a cantilever: its lowest modes, by beam elements along the pitch axis.

Frame of a blade: z along the pitch axis from the root to the tip, x downwind at zero pitch and twist, y to
complete a right-handed set. Pitch and structural twist turn a section about z: its flap direction is
cos θ x − sin θ y, its edge direction sin θ x + cos θ y (ElastoDyn's n1 and n2), so that at 90° the blade
flaps in the rotor's plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.structure.two_node import BeamSection, beam_matrices

_AXIAL_N = 1e11
_TORSION_N_M2 = 1e12
"""Far stiffer than bending: ElastoDyn's blades neither stretch nor twist, ours only in higher modes."""


@dataclass(frozen=True)
class BladeStructure:
    """Properties of a blade at stations along its pitch axis.

    Attributes
    ----------
    z : (n,) from the root [m], growing from zero
    mass_kg_m : (n,)
    flap_n_m2, edge_n_m2 : (n,) bending stiffness in the flap and in the edge direction
    twist : (n,) structural twist [rad]
    damping_ratio : of every mode
    """

    z: FloatArray
    mass_kg_m: FloatArray
    flap_n_m2: FloatArray
    edge_n_m2: FloatArray
    twist: FloatArray
    damping_ratio: float

    def __post_init__(self) -> None:
        if self.z.size < 3 or np.any(np.diff(self.z) <= 0.0):
            raise InputError(
                "stations must grow from root to tip",
                field="blades",
                value=int(self.z.size),
                allowed="three or more",
            )
        for name in ("mass_kg_m", "flap_n_m2", "edge_n_m2"):
            values = getattr(self, name)
            if not (np.isfinite(values).all() and (values > 0.0).all()):
                raise InputError("must be positive", field=f"blades.{name}", value=float(values.min()))
        if not 0.0 <= self.damping_ratio < 1.0:
            raise InputError(
                "out of range", field="blades.damping", value=self.damping_ratio, allowed="0 to 1"
            )


@dataclass(frozen=True)
class BladeModes:
    """Modes of a blade clamped at its root, of unit modal mass.

    Attributes
    ----------
    omega : (n_modes,) [rad/s]
    z : (n,) middles of the elements from the root [m]
    mass_kg : (n,) of the elements
    shape : (n, 3, n_modes) displacement there in the blade's frame [1/√kg]
    """

    omega: FloatArray
    z: FloatArray
    mass_kg: FloatArray
    shape: FloatArray


def blade_modes(blade: BladeStructure, number: int, *, pitch: float) -> BladeModes:
    """Return the lowest modes of a blade at a pitch [rad]."""
    n = blade.z.size - 1
    K, M = np.zeros((6 * (n + 1),) * 2), np.zeros((6 * (n + 1),) * 2)
    for e in range(n):
        at = slice(6 * e, 6 * e + 12)
        stiffness, mass = _element(blade, e, pitch)
        K[at, at] += stiffness
        M[at, at] += mass
    w2, free = la.eigh(K[6:, 6:], M[6:, 6:], subset_by_index=(0, number - 1))
    u = np.vstack([np.zeros((6, number)), free]).reshape(n + 1, 6, number)[:, :3]
    z = blade.z
    return BladeModes(
        omega=np.sqrt(w2),
        z=0.5 * (z[:-1] + z[1:]),
        mass_kg=0.5 * (blade.mass_kg_m[:-1] + blade.mass_kg_m[1:]) * np.diff(z),
        shape=0.5 * (u[:-1] + u[1:]),
    )


def _element(blade: BladeStructure, e: int, pitch: float) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass (12, 12) of an element with the mean of its ends' properties."""
    m, flap, edge, twist = (
        float(0.5 * (values[e] + values[e + 1]))
        for values in (blade.mass_kg_m, blade.flap_n_m2, blade.edge_n_m2, blade.twist)
    )
    cos, sin = np.cos(pitch + twist), np.sin(pitch + twist)
    # along the beam, then the section's x (edge) and y (flap): it bends towards x about y
    axes = np.array([[0.0, 0.0, 1.0], [sin, cos, 0.0], [-cos, sin, 0.0]])
    A = _AXIAL_N
    section = BeamSection(A=A, A_x=A, A_y=A, I_x=flap, I_y=edge, I_p=flap + edge, J=_TORSION_N_M2)
    L = float(blade.z[e + 1] - blade.z[e])
    return beam_matrices(axes, L, section, E=1.0, G=1.0, rho=m / A, shear=False)
