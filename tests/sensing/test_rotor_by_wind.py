"""A rotor at work on the tower top."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.sensing.rotor_by_wind import RotorAtTop


@pytest.mark.parametrize("heading", [0.4, -1.9])
def test_a_rotor_turned_to_the_wind_damps_the_turned_motion(heading: float) -> None:
    """A dashpot d dᵀ along a motion d of the rotor becomes the one along d turned anticlockwise with it."""
    moved, turned = np.array([1.0, 0.5, 0.3, 0.2, -0.4, 0.1]), np.empty(6)
    for first in (0, 3):
        plane = complex(moved[first], moved[first + 1]) * np.exp(1j * heading)
        turned[first : first + 3] = plane.real, plane.imag, moved[first + 2]
    found = RotorAtTop(np.outer(moved, moved), 1.0).towards(heading)
    assert_allclose(found, np.outer(turned, turned), atol=1e-12)
