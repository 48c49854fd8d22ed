"""The spectra that the API gives."""

from __future__ import annotations

import numpy as np

from jackettwin.records import Channel, Record
from jackettwin.service.web.signals import spectra


def test_missing_samples_do_not_lower_the_spectrum(rng: np.random.Generator) -> None:
    """White noise of variance 1 at 20 Hz has 0.100 per Hz, also with 31 % of it missing and an offset."""
    data = 4.0 + rng.standard_normal((1, 60_000))
    data[0, rng.random(60_000) < 0.31] = np.nan
    density = np.array(spectra(Record(data, 20.0, (Channel("a"),))).channels["a"])
    # 0.8 % of standard deviation, as in tests/records/test_spectra.py: four of them
    np.testing.assert_allclose(density[2:-1].mean(), 0.100, rtol=0.032)
