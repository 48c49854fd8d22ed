r"""Bending blades of a turning rotor: their modes as coordinates of the rotor.

Each mode φ of a blade clamped to the hub, of unit mass, has one coordinate for every order m of the azimuth:
in the frame of the tower a displacement φ(ψ)e^{imψ} grows with λ + imΩ, and its second derivative there holds
Coriolis' and the centripetal terms. The centrifugal tension N stiffens by ∫N φ′·φ′ dz.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import interp1d

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.rotor import Rotor
from jackettwin.loads.operation.rotor_kinematics import arms, blade_frames, prebend
from jackettwin.structure import BladeModes, blade_modes

MODES_PER_BLADE = 3
"""First flap, first edge and second flap."""


@dataclass(frozen=True)
class BendingBlades:
    """Blades' pieces and modes at a pitch and a rotor speed.

    Attributes
    ----------
    mass : (n,) of the pieces of all blades [kg]
    z : (n,) their distance from the root [m]
    shape : (n, 3, k) modes there, and ``aero_shape`` (m, 3, k) at the aerodynamic stations [1/√kg]
    aero_slope : (m, k) dx/dz of the modes there
    stiffness : (k, k) of all blades, centrifugal tension included
    damping : (k, k) of the steel of all blades
    """

    mass: FloatArray
    z: FloatArray
    shape: FloatArray
    aero_shape: FloatArray
    aero_slope: FloatArray
    stiffness: FloatArray
    damping: FloatArray


def bending_blades(rotor: Rotor, *, pitch: float, rotor_speed: float) -> BendingBlades:
    """Return the bending blades of a rotor.

    Raises
    ------
    InputError
        If the rotor's file does not say what its blades are made of.
    """
    if rotor.bending is None:
        raise InputError(
            "the blades' stiffness is not known",
            field="rotor",
            allowed="a windIO file with the blades' mass and stiffness",
        )
    modes = blade_modes(rotor.bending, MODES_PER_BLADE, pitch=pitch)
    n_modes = modes.omega.size
    z = np.concatenate([[0.0], modes.z])
    nodes = np.concatenate([np.zeros((1, 3, n_modes)), modes.shape])
    # the last piece's middle lies within the tip: straight on from there
    stations = np.asarray(interp1d(z, nodes, axis=0, fill_value="extrapolate")(rotor.blade.z), np.float64)
    return BendingBlades(
        mass=rotor.n_blades * modes.mass_kg,
        z=modes.z,
        shape=modes.shape,
        aero_shape=stations,
        aero_slope=np.asarray(np.gradient(stations[:, 0], rotor.blade.z, axis=0)),
        stiffness=rotor.n_blades
        * (np.diag(modes.omega**2) + _tension(rotor, modes, z, nodes, rotor_speed=rotor_speed)),
        damping=rotor.n_blades * np.diag(2.0 * rotor.bending.damping_ratio * modes.omega),
    )


def _tension(
    rotor: Rotor, modes: BladeModes, z: FloatArray, nodes: FloatArray, *, rotor_speed: float
) -> FloatArray:
    """Return ∫ N φ′·φ′ dz (k, k) of one blade, N the centrifugal force of what lies beyond."""
    pull = modes.mass_kg * rotor_speed**2 * (rotor.hub_radius + modes.z)
    beyond = np.cumsum(pull[::-1])[::-1]
    slope = np.diff(nodes, axis=0) / np.diff(z)[:, None, None]
    return np.asarray(np.einsum("e,eik,eil,e->kl", beyond, slope, slope, np.diff(z)))


def pieces(rotor: Rotor, blades: BendingBlades, pitch: float) -> FloatArray:
    """Return the pieces' arms (places, n, 3) from the hub, prebent and not loaded."""
    return arms(rotor, blades.z, prebend(rotor, blades.z, pitch))


def turning_shapes(rotor: Rotor, shape: FloatArray) -> FloatArray:
    """Return modes (n, 3, k) in the tower's frame by azimuth, (places, n, 3, k)."""
    return np.asarray(np.einsum("pij,njk->pnik", blade_frames(rotor), shape))


def softening(rotor: Rotor, blades: BendingBlades, rotor_speed: float) -> FloatArray:
    """Return by how much turning lowers the stiffness (k, k) of a steady deflection in the rotor's plane."""
    shapes = turning_shapes(rotor, blades.shape)[0]
    d = rotor.shaft
    across = shapes - d[None, :, None] * np.einsum("i,nik->nk", d, shapes)[:, None]
    return np.asarray(rotor_speed**2 * np.einsum("n,nik,nil->kl", blades.mass, across, across))


def centrifugal(rotor: Rotor, blades: BendingBlades, arm: FloatArray, rotor_speed: float) -> FloatArray:
    """Return the centrifugal force (places, n, 3) of the pieces of all blades [N]."""
    out = arm - rotor.shaft * (arm @ rotor.shaft)[..., None]
    return np.asarray(rotor_speed**2 * blades.mass[:, None] * out)
