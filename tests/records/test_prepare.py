from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record, decimate, detrend
from jackettwin.records.processing.prepare import bandpass, highpass

START = datetime(2025, 1, 1, tzinfo=UTC)


def record_of(*rows: np.ndarray, rate: float = 100.0, quantity: str = "acceleration") -> Record:
    channels = tuple(Channel(f"c{i}", quantity=quantity) for i in range(len(rows)))
    return Record(np.vstack(rows), rate, channels, start_utc=START, name="r")


def tone(frequency_hz: float, n: int, rate: float, phase: float = 0.0) -> np.ndarray:
    return np.sin(2 * np.pi * frequency_hz * np.arange(n) / rate + phase)


def test_detrend_removes_an_exact_line_through_gaps() -> None:
    line = 3.0 + 0.01 * np.arange(500)
    line[[0, 40, 41, 499]] = np.nan
    out = detrend(record_of(line)).data[0]
    assert np.array_equal(np.isnan(out), np.isnan(line))
    np.testing.assert_allclose(out[np.isfinite(out)], 0.0, atol=1e-12)  # rounding of values near 8


def test_detrend_is_idempotent_and_leaves_an_empty_channel_empty(rng: np.random.Generator) -> None:
    once = detrend(record_of(rng.normal(size=400), np.full(400, np.nan)))
    np.testing.assert_allclose(detrend(once).data, once.data, atol=1e-14)
    assert np.isnan(once.data[1]).all()


def test_detrend_keeps_the_mean_of_wind_and_yaw() -> None:
    wind = record_of(np.full(50, 12.0), quantity="wind speed")
    assert np.array_equal(detrend(wind).data, wind.data)


@pytest.mark.parametrize(("ratio", "gain"), [(0.1, 0.012), (1.0, 0.70711), (2.0, 0.99264), (4.0, 1.0)])
def test_highpass_gain_is_the_closed_form_with_zero_phase(ratio: float, gain: float) -> None:
    rate, cutoff, n = 20.0, 0.1, 24_000
    f = ratio * cutoff  # whole number of cycles in the record and in its middle half
    out = highpass(record_of(tone(f, n, rate), rate=rate), cutoff_hz=cutoff).data[0]
    middle = slice(n // 4, 3 * n // 4)
    reference = np.exp(-2j * np.pi * f * np.arange(n) / rate)[middle]
    response = 2j * np.mean(out[middle] * reference)
    # The kernel is cut at five standard deviations (6e-7), the overall line leaks a little at 0.1.
    np.testing.assert_allclose(response, gain, atol=1e-3)


def test_highpass_keeps_gaps_exactly_and_fills_none(rng: np.random.Generator) -> None:
    y = rng.normal(size=3000)
    y[700:1500] = np.nan
    out = highpass(record_of(y), cutoff_hz=0.5).data[0]
    assert np.array_equal(np.isnan(out), np.isnan(y))


@pytest.mark.parametrize("new_rate", [50.0, 20.0, 12.8, 5.0])
def test_decimate_passes_a_tone_on_the_same_time_axis(new_rate: float) -> None:
    n, rate, f = 30_000, 100.0, 0.37 * new_rate  # inside the pass band 0.4 of the new rate
    out = decimate(record_of(tone(f, n, rate, 0.3)), sample_rate_hz=new_rate)
    assert out.sample_rate_hz == pytest.approx(new_rate, rel=1e-12)
    assert out.start_utc == START
    edge = int(np.ceil(out.metadata["preparation"][-1]["edge_s"] * new_rate))
    expected = tone(f, out.data.shape[1], new_rate, 0.3)
    # Pass-band ripple of an 80 dB Kaiser design is 1e-4; ends rest on reflected samples.
    np.testing.assert_allclose(out.data[0, edge:-edge], expected[edge:-edge], atol=2e-4)


@pytest.mark.parametrize("f", [2.5, 3.1, 4.9, 5.1, 9.7, 33.0])
def test_decimate_lets_nothing_fold_back(f: float) -> None:
    out = decimate(record_of(tone(f, 60_000, 100.0)), sample_rate_hz=5.0).data[0]
    assert np.abs(out[40:-40]).max() < 2e-4  # 80 dB


def test_decimate_keeps_a_constant_to_the_very_ends() -> None:
    out = decimate(record_of(np.full(5000, 7.0)), sample_rate_hz=5.0).data[0]
    # unit gain at zero frequency, up to rounding and the ripple between polyphase branches
    np.testing.assert_allclose(out, 7.0, rtol=1e-12)


def test_a_long_gap_stays_a_gap_and_single_samples_are_bridged(rng: np.random.Generator) -> None:
    clean = tone(0.18, 30_000, 100.0) + tone(0.75, 30_000, 100.0)
    holed = clean.copy()
    holed[10_000:12_000] = np.nan
    holed[rng.choice(np.arange(15_000, 30_000), 300, replace=False)] = np.nan
    out = decimate(record_of(clean, holed), sample_rate_hz=5.0)
    missing = np.isnan(out.data[1])
    assert missing[500:600].all()
    assert missing.sum() <= 110  # the gap, 100 samples, and at most five at either side
    kept = ~missing
    kept[470:630] = False  # outputs whose filter touches the long gap
    # a line over one lost sample of 0.75 Hz at 100 Hz misses by (2π·0.75·0.01)²/2 = 1.1e-3, two lost
    # in a row by more, of which a filter 20 samples wide sees a fraction
    np.testing.assert_allclose(out.data[1, kept], out.data[0, kept], atol=5e-4)


def test_scattered_losses_are_closed_and_too_many_are_refused(rng: np.random.Generator) -> None:
    clean = tone(0.18, 30_000, 100.0)
    scattered = np.where(rng.random(30_000) < 0.25, np.nan, clean)
    out = decimate(record_of(scattered), sample_rate_hz=5.0).data[0]
    # at 0.18 Hz a line over ten samples misses by (2π·0.18·0.1)²/8 = 1.6e-3 at most
    np.testing.assert_allclose(out[50:-50], tone(0.18, 1500, 5.0)[50:-50], atol=2e-3)
    half = np.where(np.arange(30_000) % 6 < 3, np.nan, clean)
    with pytest.raises(InputError, match="gaps leave nothing of the channel.*'c0'"):
        decimate(record_of(half), sample_rate_hz=50.0)


def test_decimated_yaw_does_not_smear_a_turn() -> None:
    yaw = np.mod(np.linspace(6.2, 6.4, 6000), 2 * np.pi)
    out = decimate(record_of(yaw, quantity="yaw"), sample_rate_hz=5.0).data[0]
    expected = np.linspace(6.2, 6.4, 6000)[::20]
    np.testing.assert_allclose(out, expected, atol=1e-4)


def test_bandpass_separates_three_tones() -> None:
    rate, n = 20.0, 24_000
    y = tone(0.01, n, rate) + tone(0.5, n, rate) + tone(2.0, n, rate)
    out = bandpass(record_of(y, rate=rate), low_hz=0.1, high_hz=1.5).data[0]
    np.testing.assert_allclose(
        out[2000:-2000], tone(0.5, n, rate)[2000:-2000], atol=0.013
    )  # 0.012 of 0.01 Hz


@pytest.mark.parametrize("rate", [200.0, 0.0, -1.0, float("nan"), 100.0 / np.pi])
def test_impossible_rates_are_refused_with_a_remedy(rate: float) -> None:
    with pytest.raises(InputError, match="sample_rate_hz: cannot decimate.*try 20 Hz"):
        decimate(record_of(np.zeros(5000)), sample_rate_hz=rate)


def test_a_record_shorter_than_the_filter_is_refused() -> None:
    with pytest.raises(InputError, match=r"r: duration_s: record is shorter than half the filter"):
        decimate(record_of(np.zeros(300)), sample_rate_hz=5.0)


@pytest.mark.parametrize(("low", "high"), [(2.0, 1.0), (0.1, 50.0), (0.001, 5.0), (float("nan"), 5.0)])
def test_impossible_bands_are_refused(low: float, high: float) -> None:
    with pytest.raises(InputError, match="filter edge outside its range"):
        bandpass(record_of(np.zeros(5000)), low_hz=low, high_hz=high)


def test_same_rate_returns_the_record_itself() -> None:
    record = record_of(np.zeros(100))
    assert decimate(record, sample_rate_hz=100.0) is record
