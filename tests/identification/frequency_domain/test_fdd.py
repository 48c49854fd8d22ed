"""EFDD on well separated modes of known frequency and damping."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import fdd, mac
from jackettwin.identification.synthetic import ModalSystem, simulate


def test_separate_modes_are_found(rng):
    shapes = np.array([[1.0, 0.6, 0.2], [-0.4, 0.7, 1.0], [0.5, -1.0, 0.6]])
    system = ModalSystem(np.array([0.5, 1.3, 2.6]), np.array([0.02, 0.02, 0.015]), shapes, np.eye(3))
    modes = fdd(simulate(system, rng, duration_s=3600.0, sample_rate_hz=10.0)).modes
    assert len(modes) == 3
    for mode, f, zeta, shape in zip(
        modes, system.frequency_hz, system.damping_ratio, system.mode_shapes, strict=True
    ):
        # five long-data standard deviations of an hour at 0.5 Hz and 2 %
        assert mode.frequency_hz == pytest.approx(f, rel=0.01)
        # the bell is cut where its MAC falls, and the window lends it width: EFDD damping is rough
        assert mode.damping_ratio == pytest.approx(zeta, rel=0.5)
        assert mac(shape, mode.mode_shape) > 0.98
        assert mode.method == "efdd"
        assert (mode.status, [reason.code for reason in mode.reasons]) == ("unchecked", ["unchecked"])
