"""What a parked rotor's damping is in closed form."""

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics.blades import Blade
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3, Rotor


def lift_slope(blade: Blade, alpha: FloatArray) -> FloatArray:
    """Return dCl/dα [1/rad] by central differences; measured polars are rough below half a degree."""
    step = np.radians(0.5)
    high, low = (blade.coefficients(alpha + sign * step)[0] for sign in (1.0, -1.0))
    return np.asarray((high - low) / (2.0 * step))


def parked_closed_form(
    rotor: Rotor,
    wind_speed: float,
    *,
    pitch: float = 0.5 * np.pi,
    shaft: str = "locked",
    density: float = AIR_KG_M3,
) -> FloatArray:
    """Return the damping matrix (6×6) at the tower top of a feathered rotor in closed form.

    Flow along the feathered chords, blades straight in a vertical plane, azimuth-averaged; per unit length
    c_dd = ρVcC_d along the flow and c_ll = ½ρVc(C_l′ + C_d) across it. At the hub

    C_xx = B ρV∫cC_d dr, C_yy = C_zz = ¼Bρ V∫c(C_l′ + C_d)dr, C_φφ = ½BρV∫c(C_l′ + C_d)r²dr (locked shaft)

    with B blades.
    """
    blade, B = rotor.blade, rotor.n_blades
    alpha = 0.5 * np.pi - pitch - blade.twist
    cd = blade.coefficients(alpha)[1]
    lift = lift_slope(blade, alpha) + cd
    dr = density * wind_speed * blade.chord * blade.weight
    r = rotor.hub_radius + blade.z
    drag, across = B * (dr @ cd), 0.25 * B * (dr @ lift)
    C = np.diag([drag, across, across, 0.0, 0.0, 0.0])
    if shaft == "locked":
        C[3, 3] = 0.5 * B * (dr @ (lift * r**2))
    x, _, z = rotor.hub
    # velocity of the hub from that of the tower top
    T = np.eye(6)
    T[:3, 3:] = [[0.0, z, 0.0], [-z, 0.0, x], [0.0, -x, 0.0]]
    return np.asarray(T.T @ C @ T)


def added_damping_ratio(damping: FloatArray, shape: FloatArray, *, modal_mass: float, omega: float) -> float:
    """Return ζ = φᵀCφ/(2Mω): what damping at the tower top adds to a mode with shape φ (6,) there."""
    return float(shape @ damping @ shape / (2.0 * modal_mass * omega))
