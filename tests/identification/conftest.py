from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.synthetic import ModalSystem


@pytest.fixture
def tower() -> ModalSystem:
    """Two close pairs of orthogonal directions and a single mode, as a parked turbine has them."""
    first, second = np.array([1.0, 0.42, 0.2, 0.1]), np.array([-0.25, 0.6, 0.8, 0.6])
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    shapes = np.array([np.kron(first, y), np.kron(first, x), np.kron(second, y), np.kron(second, x)])
    return ModalSystem(
        frequency_hz=np.array([0.290, 0.300, 1.20, 1.26]),
        damping_ratio=np.array([0.030, 0.010, 0.015, 0.012]),
        mode_shapes=shapes,
        force=np.diag([2.0, 1.0, 0.3, 0.3])
        + 0.1 * np.diag([1.0, 0.0, 0.0], 1)
        + 0.1 * np.diag([1.0, 0.0, 0.0], -1),
    )
