r"""What a rotor at work takes from the motion of its tower, and how its wake answers that motion.

The wake follows what balances momentum through two lags in series, Øye's model (Snel & Schepers 1995,
ECN-C--94-107; OpenFAST's DBEMT): of a harmonic motion a blade element sees the share

.. math:: H(ω) = \frac{1 + i k ω τ_1}{(1 + i ω τ_1)(1 + i ω τ_2)}, \quad k = 0.6

of the wake in balance, with τ₁ = 1.1 R/((1 − 1.3 ā) V) and τ₂ = (0.39 − 0.26 (r/R)²) τ₁. The wake is known
to the turning blade: what moves with the tower's ω reaches it at ω − Ω, ω and ω + Ω.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3, Linearised, Rotor, linearise
from jackettwin.loads.operation.bem import (
    OperatingPoint,
    balanced_wake,
    normal_wind,
    ring_forces,
    ring_radius,
)

OPERATING_LOG_STD = {"fore_aft": 0.2, "side_side": 0.5}
"""How far the rotor's part of the first bending modes' damping may be off, as a standard deviation of its
logarithm: docs/verification/operation.md, with bending blades."""
_FAST_SHARE = 0.6
_HIGHEST_INDUCTION = 0.5
"""Beyond which τ₁ grows no further."""
_STEP_M_S = 0.01
"""Of velocity by which rings are differenced: within a tenth of the polars' spacing at the tip."""


def operating_damping(
    rotor: Rotor,
    operation: OperatingPoint,
    *,
    omega: float | None = None,
    shaft: str = "locked",
    yaw_error: float = 0.0,
    density: float = AIR_KG_M3,
) -> Linearised:
    """Return a rotor linearised about an operating point, pitch held.

    Parameters
    ----------
    omega : float, optional
        At which the tower moves [rad/s]; None freezes the wake, which answers within R/V.
    shaft : {"locked", "free"}
        Whether the speed against the nacelle is held ("locked"), or the generator's torque ("free"): then the
        inertia of the rotor keeps it turning evenly whatever the tower does, and the torque's changes stay in
        it. A turbine at work is nearer to the latter.
    """
    still = linearise(
        rotor,
        operation.wind_speed,
        pitch=operation.pitch,
        yaw_error=yaw_error,
        rotor_speed=operation.rotor_speed,
        induced=operation.induced,
        density=density,
    )
    damping = still.damping
    if shaft == "free":
        damping = linearise(
            rotor,
            operation.wind_speed,
            pitch=operation.pitch,
            yaw_error=yaw_error,
            rotor_speed=operation.rotor_speed,
            shaft=shaft,
            induced=operation.induced,
            density=density,
        ).damping
    if omega is None:
        return Linearised(still.load, damping, still.stiffness)
    wake = wake_damping(rotor, operation, omega, shaft=shaft, density=density)
    # C ẋ with ẋ = iωx: the imaginary part of C is a stiffness
    return Linearised(still.load, damping + wake.real, still.stiffness - omega * wake.imag)


def wake_damping(
    rotor: Rotor,
    operation: OperatingPoint,
    omega: float,
    *,
    shaft: str = "locked",
    density: float = AIR_KG_M3,
) -> ComplexArray:
    """Return what the wake's answer adds to the frozen wake's damping at the tower top, (6, 6) complex.

    The sum over stations and over m = −1, 0, 1 of Bₘᴴ H(ω + mΩ) (D_balanced − D_frozen) Bₘ, with Bₘ e^{imψ}
    the motion of an element along the shaft and around it. The wind is square to the rotor.
    """
    change = _sections(rotor, operation, density=density)
    motion = _element_motion(rotor, shaft=shaft)
    found = np.zeros((6, 6), dtype=np.complex128)
    for m, B in motion.items():
        share = wake_share(rotor, operation, omega + m * operation.rotor_speed)
        found += np.einsum("nai,n,nab,nbj->ij", B.conj(), share, change, B)
    return found


def wake_share(rotor: Rotor, operation: OperatingPoint, omega: float) -> ComplexArray:
    """Return H(ω) at the stations (n,)."""
    r = ring_radius(rotor)
    area = r * rotor.blade.weight
    a = float(area @ operation.induced[:, 0] / area.sum()) / operation.wind_speed
    tau = 1.1 / (1.0 - 1.3 * min(a, _HIGHEST_INDUCTION)) * rotor.radius / operation.wind_speed
    near = (0.39 - 0.26 * (r / rotor.radius) ** 2) * tau
    s = 1j * omega
    return np.asarray((1.0 + _FAST_SHARE * tau * s) / ((1.0 + tau * s) * (1.0 + near * s)))


def _sections(rotor: Rotor, operation: OperatingPoint, *, density: float) -> FloatArray:
    """Return by how much sections with a wake in balance differ from those with a frozen one, (n, 2, 2).

    Forces along the shaft and around it lost with the blade's own velocity along the shaft and around it.
    """
    r = ring_radius(rotor)
    wind, swirl = normal_wind(rotor, operation.wind_speed), operation.rotor_speed * r

    def forces(dv: float, du: float, *, balanced: bool) -> FloatArray:
        at = wind + dv, swirl + du
        wake = balanced_wake(rotor, *at, operation.pitch) if balanced else operation.induced
        return np.stack(ring_forces(rotor, *at, operation.pitch, wake, density=density), axis=1)

    def derivative(dv: float, du: float) -> FloatArray:
        both = [
            forces(dv, du, balanced=balanced) - forces(-dv, -du, balanced=balanced)
            for balanced in (True, False)
        ]
        return np.asarray((both[0] - both[1]) / (2.0 * _STEP_M_S))

    # a blade that moves downwind sees less wind, one that moves as it turns sees more swirl
    return np.stack([derivative(_STEP_M_S, 0.0), -derivative(0.0, _STEP_M_S)], axis=2)


def _element_motion(rotor: Rotor, *, shaft: str) -> dict[int, ComplexArray]:
    """Return Bₘ (n, 2, 6) by m: motion of elements along the shaft and around it from the tower top's."""
    d, hub = rotor.shaft, rotor.hub
    up = np.array([np.sin(rotor.tilt), 0.0, np.cos(rotor.tilt)])
    side = np.cross(d, up)
    r = ring_radius(rotor)
    ahead = rotor.blade.prebend * np.cos(rotor.cone) - (rotor.hub_radius + rotor.blade.z) * np.sin(rotor.cone)
    # e_r = Σ ρ_m e^{imψ} and e_t = d × e_r
    radial = {1: 0.5 * (up - 1j * side), -1: 0.5 * (up + 1j * side)}
    motion = {0: np.zeros((r.size, 2, 6), dtype=np.complex128)}
    motion[0][:, 0] = [*d, *np.cross(hub, d)]
    if shaft == "locked":
        motion[0][:, 1, 3:] = r[:, None] * d
    for m, e in radial.items():
        t = np.cross(d, e)
        B = np.zeros((r.size, 2, 6), dtype=np.complex128)
        B[:, 0, 3:] = -r[:, None] * t
        B[:, 1, :3] = t
        B[:, 1, 3:] = np.cross(hub, t) - ahead[:, None] * e
        motion[m] = B
    return motion
