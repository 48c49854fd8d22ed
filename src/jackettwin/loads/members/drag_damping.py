r"""Linearised drag damping of members in a random sea, from its spectrum.

.. math:: σ^2 = \tfrac{1}{2} \operatorname{tr}(P Σ), \qquad
          Σ = \int S_η ω^2 (h^2\, d d^T + v^2\, e_z e_z^T)\, df

with P the projector normal to the member, h and v the depth functions of Airy waves and d the sea's heading.
σ² is the mean variance of the two velocity components normal to a member, which the simulation computes from
its time series. Damping by radiated waves is in ``radiation_damping``.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.loads.members.morison import MorisonPoints, above_bed, drag_damping
from jackettwin.loads.sea.waves import SeaState, depth_functions, jonswap, wave_number

_STEP_HZ = 1e-3
"""Spacing of the spectrum's frequencies: a tenth of the width of the peak of a sea of 10 s."""
_HIGHEST = 4.0
"""The spectrum ends at this multiple of its peak frequency, as in the simulation."""


def velocity_std(grid: MorisonPoints, sea: SeaState, depth: float) -> FloatArray:
    """Return the standard deviation of the water's velocity normal to the members, (n_points,) [m/s].

    The sea is long-crested, and members are wet up to still water; ``depth`` is in m.
    """
    f = np.arange(1, int(_HIGHEST / sea.Tp / _STEP_HZ) + 1, dtype=np.float64) * _STEP_HZ
    omega = 2.0 * np.pi * f
    power = jonswap(f, Hs=sea.Hs, Tp=sea.Tp, gamma=sea.gamma) * _STEP_HZ * omega**2
    # legs and braces of all faces share their levels
    levels, level = np.unique(np.minimum(grid.points[:, 2], 0.0).round(6), return_inverse=True)
    horizontal, vertical = (
        (part**2 @ power)[level] for part in depth_functions(wave_number(omega, depth), levels, depth)
    )
    heading = np.array([np.cos(sea.direction), np.sin(sea.direction), 0.0])
    along = np.einsum("i,nij,j->n", heading, grid.normal, heading)
    variance = along * horizontal + grid.normal[:, 2, 2] * vertical
    return np.asarray(np.sqrt(0.5 * np.maximum(variance, 0.0)))


def sea_drag_damping(
    grid: MorisonPoints, sea: SeaState, depth: float, speed_std: FloatArray | None = None
) -> sp.csr_array:
    """Return the linearised drag damping (Borgman 1967) of members in a random sea, (n_dof, n_dof).

    Parameters
    ----------
    speed_std : (n_points,) :func:`velocity_std`, if it is known
    """
    speed = velocity_std(grid, sea, depth) if speed_std is None else speed_std
    return drag_damping(grid, speed * above_bed(grid, depth))
