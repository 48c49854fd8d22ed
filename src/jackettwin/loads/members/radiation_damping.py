r"""Damping by the waves that moving members radiate, from the forces of waves on them.

The Haskind relation (Newman 1962, J. Ship Res. 6; Falnes 2002, Ocean Waves and Oscillating Systems, section
5.4) gives the radiation damping of a motion from the force X(β) that a wave of unit amplitude and heading β
exerts on it:

.. math:: B = \frac{k}{8π ρ g c_g} \int_0^{2π} |X(β)|^2\, dβ

X is the inertia force of Morison's equation on all members with their phases, times the factor of MacCamy and
Fuchs for diameters that are not small beside the wave's length: exact for one vertical cylinder.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.loads.members.morison import MorisonPoints, above_bed, wetness
from jackettwin.loads.sea.diffraction import scattered
from jackettwin.loads.sea.waves import depth_functions, wave_number

_HEADINGS = 180
"""Directions of the waves that are sent out, 2° apart; their power is smooth and periodic."""


def radiation_damping(grid: MorisonPoints, shape: FloatArray, omega: float, depth: float) -> float:
    """Return the damping coefficient B of a motion that radiates waves.

    Parameters
    ----------
    grid : points of members up to still water
    shape : (n_dof,) the motion for a unit of its coordinate
    omega : its angular frequency [rad/s]
    depth : of the water [m]

    Returns
    -------
    float
        [kg/s] for a shape in metres; for a shape of unit modal mass [1/s], and ζ = B/2ω.
    """
    k = float(wave_number(omega, depth))
    kd2 = 2.0 * k * depth
    group = 0.5 * omega / k * (1.0 + kd2 / np.sinh(min(kd2, 700.0)))
    horizontal, vertical = depth_functions(np.array([k]), np.minimum(grid.points[:, 2], 0.0), depth)
    wet = grid.weight * above_bed(grid, depth) * wetness(grid, np.zeros(grid.weight.size))
    pushed = (grid.inertia_per_length * wet * omega**2)[:, None] * scattered(np.array([k]), grid.diameter)
    across = np.einsum("nij,nj->ni", grid.normal, grid.motion(shape)) * pushed
    beta = np.arange(_HEADINGS) * (2.0 * np.pi / _HEADINGS)
    d = np.stack([np.cos(beta), np.sin(beta)])
    along = across[:, :2] @ d * horizontal + 1j * across[:, 2:] * vertical
    force = np.sum(along * np.exp(-1j * k * grid.points[:, :2] @ d), axis=0)
    density = grid.density_kg_m3 * GRAVITY_M_S2
    return float(k / (4.0 * density * group) * np.mean(np.abs(force) ** 2))
