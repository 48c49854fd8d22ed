"""Wind: profile, the normal turbulence model with Kaimal spectra and coherence, and drag on the tower."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.loads.members.morison import MorisonPoints, point_forces, spread

TOWER_DRAG = 0.5
"""Drag coefficient of a tower at supercritical Reynolds number, as in the reference turbine's aeroelastic
model (TwrCd of IEA-15-240-RWT_AeroDyn15.dat)."""

REFERENCE_INTENSITY = {"A+": 0.18, "A": 0.16, "B": 0.14, "C": 0.12}
"""Expected turbulence intensity at 15 m/s, IEC 61400-1 (2019) table 1."""

SIGMA_RATIOS = (1.0, 0.8, 0.5)
SCALE_RATIOS = (8.1, 2.7, 0.66)
"""σ_k/σ_1 and L_k/Λ_1 of u, v, w: IEC 61400-1 (2019) table C.1."""

DECAY, SCALE_TERM = 12.0, 0.12
"""Coherence of u: exp(−12 √((f r/V)² + (0.12 r/L_1)²)), IEC 61400-1 (2019) eq. (C.16)."""


@dataclass(frozen=True)
class Wind:
    """Mean wind at hub height and its turbulence.

    ``turbulence`` is a class (A+, A, B, C) or an intensity; ``shear`` the power law's exponent
    (IEC 61400-3-1: 0.14 offshore).
    """

    speed_m_s: float
    hub_height_m: float
    turbulence: str | float = "B"
    shear: float = 0.14

    def __post_init__(self) -> None:
        if not (np.isfinite(self.speed_m_s) and 0.0 < self.speed_m_s <= 100.0):
            raise InputError("out of range", field="speed_m_s", value=self.speed_m_s, allowed="0 to 100 m/s")
        if isinstance(self.turbulence, str) and self.turbulence not in REFERENCE_INTENSITY:
            raise InputError(
                "unknown turbulence class",
                field="turbulence",
                value=self.turbulence,
                allowed=", ".join(REFERENCE_INTENSITY),
            )

    @property
    def sigma(self) -> float:
        """σ_1 [m/s]: normal turbulence model I_ref (0.75 V + 5.6), IEC 61400-1 (2019) eq. (10).

        >>> round(Wind(12.0, 150.0, "B").sigma, 3)
        2.044
        """
        if isinstance(self.turbulence, str):
            return REFERENCE_INTENSITY[self.turbulence] * (0.75 * self.speed_m_s + 5.6)
        return self.turbulence * self.speed_m_s

    @property
    def scale_m(self) -> float:
        """Λ_1 [m]: 0.7 z up to 60 m, then 42 m."""
        return 0.7 * min(self.hub_height_m, 60.0)

    def mean(self, height_m: FloatArray | float) -> FloatArray:
        """Return V(z) = V_hub (z/z_hub)^α [m/s]; zero below the water."""
        height = np.maximum(np.asarray(height_m, dtype=np.float64), 0.0)
        return np.asarray(self.speed_m_s * (height / self.hub_height_m) ** self.shear)


def coherence(wind: Wind, frequency_hz: FloatArray | float, distance_m: FloatArray | float) -> FloatArray:
    """Return the coherence |S_ij|/√(S_ii S_jj) of u between points ``distance_m`` apart across the wind."""
    L = SCALE_RATIOS[0] * wind.scale_m
    f, r = np.asarray(frequency_hz, dtype=np.float64), np.asarray(distance_m, dtype=np.float64)
    return np.asarray(np.exp(-DECAY * np.hypot(f / wind.speed_m_s, SCALE_TERM / L) * r))


def tower_drag(grid: MorisonPoints, wind: FloatArray) -> FloatArray:
    """Return drag on members above water (..., n, 3) [N]: Morison's equation in air (no inertia).

    ``grid`` comes from ``morison_points`` with air's density; ``wind`` (..., n, 3) [m/s].
    """
    # the grid in air has no inertia, so that the acceleration argument (here the wind again) has no effect
    return point_forces(grid, wind, wind)


def tower_drag_damping(grid: MorisonPoints, wind: FloatArray) -> sp.csr_array:
    """Return the damping matrix of members in steady wind (n, 3), on the assembly's DOFs.

    d(½ρC_D D|v|v)/dv = ½ρC_D D (|v| I + v vᵀ/|v|), v normal to the member.
    """
    v = np.einsum("nij,nj->ni", grid.normal, wind)
    speed = np.maximum(np.linalg.norm(v, axis=1), 1e-12)[:, None, None]
    tangent = speed * grid.normal + v[:, :, None] * v[:, None, :] / speed
    return spread(grid, grid.drag_per_length[:, None, None] * tangent)
