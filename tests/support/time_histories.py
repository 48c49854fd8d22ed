"""Motion of small models under a step of force."""

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response.motion.time import first_order_hold, march, state_space
from jackettwin.response.system import Pencil


def step_response(pencil: Pencil, force: FloatArray, *, step_s: float, n_steps: int) -> FloatArray:
    """Return displacements (n_steps + 1, n) under a constant force applied at t = 0 to the model at rest."""
    space = state_space(pencil)
    hold = first_order_hold(space.A, space.B, step_s)
    f = np.broadcast_to(force, (n_steps + 1, pencil.n))
    return march(hold, np.zeros(space.A.shape[0]), f)[:, : pencil.n]
