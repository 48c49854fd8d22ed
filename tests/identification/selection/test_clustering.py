"""Groups of poles of one mode."""

from __future__ import annotations

import numpy as np

from jackettwin.identification.estimate import Stabilisation
from jackettwin.identification.selection.clustering import clusters


def two_poles(shift: float) -> Stabilisation:
    """Return one mode's poles of two orders, the second with the less certain damping."""
    flags = np.zeros(2, dtype=bool)
    return Stabilisation(
        order=np.array([2, 4]),
        frequency_hz=np.array([0.3, 0.301 * (1.0 + shift)]),
        damping_ratio=np.array([0.011, 0.012 * (1.0 - shift)]),
        mode_shape=np.ones((2, 3), dtype=complex),
        stable_frequency=flags,
        stable_damping=flags,
        stable_shape=flags,
        cluster=np.full(2, -1),
        log_covariance=None,
        mode_shape_std=None,
    )


def test_rounding_does_not_choose_between_two_poles() -> None:
    """Both are equally far from their median; on another machine the refinement began at the other one."""
    chosen = {
        clusters(two_poles(shift), distance=0.1, orders=[2, 4], scale=np.ones(3))[0].representative
        for shift in (0.0, *np.spacing(1.0) * np.arange(-40, 41))
    }
    assert chosen == {0}
