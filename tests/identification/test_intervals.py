"""Intervals of a whole identification over records of systems unlike the one it was qualified on."""

from __future__ import annotations

import numpy as np
from calibration import is_calibrated

from jackettwin.identification import identify
from jackettwin.identification.synthetic import ModalSystem, simulate

RECORDS = 12


def test_intervals_hold_for_five_modes_in_six_channels_under_noise() -> None:
    """A pair at 0.27 and 0.29 Hz, 25 Hz, 5 % noise: all modes in all records, none false, intervals hold.

    120 intervals of 90 % are judged from both sides.
    """
    f = np.array([0.27, 0.29, 0.81, 1.6, 2.7])
    system = ModalSystem(
        frequency_hz=f,
        damping_ratio=np.array([0.012, 0.02, 0.01, 0.015, 0.012]),
        mode_shapes=np.random.default_rng(5).standard_normal((5, 6)),
        force=np.diag(f**-2.0),
        noise_ratio=0.05,
    )
    inside = []
    for seed in range(RECORDS):
        record = simulate(system, np.random.default_rng([7, seed]), sample_rate_hz=25.0)
        modes = identify(record).modes
        np.testing.assert_allclose([mode.frequency_hz for mode in modes], f, rtol=0.03)
        for mode, true_f, true_zeta in zip(modes, f, system.damping_ratio, strict=True):
            assert mode.frequency_interval_90 is not None
            assert mode.damping_ratio_interval_90 is not None
            inside.append(mode.frequency_interval_90[0] < true_f < mode.frequency_interval_90[1])
            inside.append(mode.damping_ratio_interval_90[0] < true_zeta < mode.damping_ratio_interval_90[1])
    assert len(inside) == 120
    assert is_calibrated(sum(inside), 120, 0.9)
