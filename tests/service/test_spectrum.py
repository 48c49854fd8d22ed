"""The spectra that the API gives."""

from __future__ import annotations

import numpy as np
from scipy import signal

from jackettwin.records import Channel, Record
from jackettwin.service.web.signals import spectra


def test_missing_samples_do_not_lower_the_spectrum(rng: np.random.Generator) -> None:
    """White noise of variance 1 at 20 Hz has 0.100 per Hz, also with 31 % of it missing and an offset."""
    data = 4.0 + rng.standard_normal((1, 60_000))
    data[0, rng.random(60_000) < 0.31] = np.nan
    density = np.array(spectra(Record(data, 20.0, (Channel("a"),))).channels["a"])
    # 0.8 % of standard deviation, as in tests/records/test_spectra.py: four of them
    np.testing.assert_allclose(density[2:-1].mean(), 0.100, rtol=0.032)


def test_without_gaps_it_is_scipys(rng: np.random.Generator) -> None:
    """Ten minutes with an offset, in segments whose mean is taken out, down to the lowest line."""
    data = 4.0 + np.cumsum(rng.standard_normal((2, 12_000)), axis=1)
    found = spectra(Record(data, 20.0, (Channel("a"), Channel("b"))))
    f, density = signal.welch(data, 20.0, nperseg=2 * round(found.frequency_hz[-1] / found.frequency_hz[1]))
    np.testing.assert_allclose(found.frequency_hz, f)
    # the same sums in another order
    np.testing.assert_allclose(list(found.channels.values()), density, rtol=1e-9, atol=1e-12 * density.max())
