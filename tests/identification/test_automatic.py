"""From a record to its modes: found apart, by themselves, or refused with a reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.files import validate
from jackettwin.identification import IdentificationSettings, identify, mac
from jackettwin.identification.synthetic import simulate
from jackettwin.records import Channel, Record


def matched(result, system):
    """Return for each true mode the identified one nearest in frequency and shape."""
    shapes = np.array([m.mode_shape for m in result.modes])
    f = np.array([m.frequency_hz for m in result.modes])
    similarity = mac(system.mode_shapes, shapes)
    apart = np.abs(np.log(f / system.frequency_hz[:, None])) + 0.2 * (1.0 - similarity)
    return np.argmin(apart, axis=1), similarity


def test_close_pairs_are_found_apart(tower, rng):
    result = identify(simulate(tower, rng))
    nearest, similarity = matched(result, tower)
    assert len(set(nearest)) == 4
    for k, mode in enumerate(nearest):
        # five standard deviations of the best possible estimate from 600 s: √(ζ/2πfT)
        limit = 5 * np.sqrt(tower.damping_ratio[k] / (2 * np.pi * tower.frequency_hz[k] * 600))
        assert result.modes[mode].frequency_hz == pytest.approx(tower.frequency_hz[k], rel=limit)
        assert similarity[k, mode] > 0.8


def test_the_band_follows_from_the_lowest_peak(tower, rng):
    result = identify(simulate(tower, rng, sample_rate_hz=100.0))
    assert 0.1 < result.settings.lowest_frequency_hz < 0.29
    assert result.settings.sample_rate_hz < 20.0
    # the lag window holds several cycles of the lowest mode
    assert result.settings.lag_window_s > 3 / 0.3


def test_the_result_is_the_same_every_time(tower, rng):
    record = simulate(tower, rng)
    once, twice = identify(record), identify(record)
    assert [m.frequency_hz for m in once.modes] == [m.frequency_hz for m in twice.modes]


def test_five_per_cent_gaps_move_nothing_by_more_than_its_uncertainty(tower, rng):
    record = simulate(tower, rng)
    y = record.data.copy()
    for row in y:
        start = rng.integers(0, y.shape[1] - 600)
        row[start : start + 600] = np.nan
    whole, gappy = identify(record), identify(replace(record, data=y))
    first, second = matched(whole, tower)[0], matched(gappy, tower)[0]
    for k in range(4):
        # one standard deviation of SSI, up to twice that of the best estimate
        limit = 2 * np.sqrt(tower.damping_ratio[k] / (2 * np.pi * tower.frequency_hz[k] * 600))
        a, b = whole.modes[first[k]].frequency_hz, gappy.modes[second[k]].frequency_hz
        assert a == pytest.approx(b, rel=limit)


def test_a_dead_channel_is_left_out_with_a_warning(tower, rng):
    record = simulate(tower, rng)
    y = record.data.copy()
    y[2] = 0.3
    y[3] = np.nan
    result = identify(replace(record, data=y))
    assert [c.name for c in result.channels] == ["a0", "a1", "a4", "a5", "a6", "a7"]
    assert "a2: is constant; left out" in result.warnings[0]
    assert "a3: 100% of the samples are missing; left out" in result.warnings[1]


def test_wind_speed_takes_no_part(tower, rng):
    record = simulate(tower, rng)
    wind = Channel("wind", quantity="wind speed", unit="m/s")
    both = Record(np.vstack([record.data, record.data[:1]]), record.sample_rate_hz, (*record.channels, wind))
    assert identify(both).channels == record.channels


def test_a_record_without_a_live_channel_is_refused():
    record = Record(np.ones((1, 1000)), 10.0, (Channel("a"),), name="dead.parquet")
    with pytest.raises(InputError, match=r"no usable vibration channel.*constant"):
        identify(record)


def test_a_record_shorter_than_its_lag_window_is_refused(tower, rng):
    record = simulate(tower, rng, duration_s=60.0)
    with pytest.raises(InputError, match=r"too short for its lag window.*got 60.*≥ 100 s.*longer record"):
        identify(record, IdentificationSettings(lowest_frequency_hz=0.2))


def test_settings_from_a_mapping():
    settings = validate(IdentificationSettings, {"max_order": 40, "weighting": "cva"})
    assert settings == IdentificationSettings(max_order=40, weighting="cva")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"max_oder": 40}, "max_oder: unknown key.*did you mean 'max_order'"),
        ({"weighting": "pc"}, "weighting: not one of the choices.*br.*cva"),
        ({"max_order": 4.5}, "max_order: not a whole number"),
        ({"lowest_frequency_hz": 0.0}, "lowest_frequency_hz: .*> 0"),
        ({"mac_tolerance": "x"}, "mac_tolerance: not a number"),
        ({"lowest_frequency_hz": 2.0, "highest_frequency_hz": 1.0}, "bounds reversed"),
    ],
)
def test_bad_settings_say_what_is_allowed(values, message):
    with pytest.raises(InputError, match=message):
        validate(IdentificationSettings, values)
