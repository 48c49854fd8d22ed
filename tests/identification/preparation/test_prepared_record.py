"""What is sampled far too fast is decimated before anything looks at it, and nothing is lost by that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification.preparation import prepared_record as module
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.synthetic import simulate

RATE = 200.0
T = np.arange(60_000) / RATE


@pytest.fixture
def fast(tower, rng):
    """Return five minutes at 200 Hz of two channels and a tone."""
    record = simulate(tower, rng, duration_s=300.0, sample_rate_hz=RATE).select(("a0", "a1"))
    tone = np.array([[1.0], [-0.6]]) * np.sin(2.0 * np.pi * 0.7003 * T)
    return replace(record, data=record.data + record.data.std(axis=1, keepdims=True) * tone)


def test_decimating_first_loses_nothing(fast, monkeypatch):
    settings = IdentificationSettings(lowest_frequency_hz=0.2, sample_rate_hz=10.0)
    rates = []
    search = module.steady_tones
    monkeypatch.setattr(module, "steady_tones", lambda y, rate: (rates.append(rate), search(y, rate))[1])
    thinned = prepare(fast, settings)
    monkeypatch.setattr(module, "TONE_RATE_RATIO", 1e6)
    whole = prepare(fast, settings)
    assert rates == pytest.approx([200.0 / 6.0, 200.0])
    assert thinned.tones_hz == pytest.approx(whole.tones_hz, abs=1e-4)
    inner = slice(100, -100)  # about 25 samples at either end rest on reflected data
    # the filters ripple by 1e-4, and the sinusoids were fitted to noise of other bandwidth
    np.testing.assert_allclose(thinned.y[:, inner], whole.y[:, inner], atol=0.02)


def test_a_band_that_needs_the_rate_keeps_it(fast, monkeypatch):
    rates = []
    search = module.steady_tones
    monkeypatch.setattr(module, "steady_tones", lambda y, rate: (rates.append(rate), search(y, rate))[1])
    prepare(
        fast, IdentificationSettings(lowest_frequency_hz=0.2, highest_frequency_hz=60.0, sample_rate_hz=200.0)
    )
    assert rates == [200.0]
