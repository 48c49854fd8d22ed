"""A line at the mains, or where sampling folds it to, is named electrical; another tone is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.synthetic import ModalSystem, simulate


@pytest.mark.parametrize(("rate", "heard_hz"), [(24.0, 2.0), (12.8, 1.2), (27.0, 4.0)])
def test_a_folded_line_of_the_mains_is_electrical(rate: float, heard_hz: float) -> None:
    shapes = np.random.default_rng(2).standard_normal((3, 4))
    system = ModalSystem(np.array([0.4, 0.9, 3.1]), np.full(3, 0.01), shapes, np.eye(3), 0.02)
    record = simulate(system, np.random.default_rng(5), duration_s=600.0, sample_rate_hz=rate)
    t = np.arange(record.data.shape[1]) / rate
    size = record.data.std(axis=1, keepdims=True)
    settings = IdentificationSettings(lowest_frequency_hz=0.3, highest_frequency_hz=4.5, refine=False)
    for mains_hz, status in ((50.0, "not a mode: electrical"), (50.23, "not a mode: tone")):
        humming = replace(record, data=record.data + size * np.sin(2.0 * np.pi * mains_hz * t))
        found = identify(humming, settings)
        (line,) = [r for r in found.rejected if abs(r.frequency_hz - heard_hz) < 0.3 and "tone" in r.reason]
        assert line.status == status
