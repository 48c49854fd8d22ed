"""Loads of waves and current evaluated point by point and instant by instant, without any series."""

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads.members.morison import MorisonPoints, nodal_loads, point_forces, wetness
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.waves import Waves


def wave_loads(
    grid: MorisonPoints,
    waves: Waves,
    t: FloatArray,
    *,
    current: Current | None = None,
    velocity: FloatArray | None = None,
) -> FloatArray:
    """Return loads on the assembly's DOFs (n_times, n_dof) [N] of waves and current.

    Linear theory without stretching wets the members up to still water, the other theories up to the
    surface.
    """
    t = np.atleast_1d(np.asarray(t, dtype=np.float64))
    u, du = waves.motion(grid.points, t)
    if current is not None:
        u = u + current.velocity(grid.points[:, 2])
    forces = point_forces(grid, u, du, velocity=velocity, wet=wetness(grid, waves.surface(grid.points, t)))
    return nodal_loads(grid, forces)
