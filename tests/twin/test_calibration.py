"""What held of a sensor for a while: gain, sign and place, of the record's time."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record
from jackettwin.records.record import record_id
from jackettwin.twin import observe, read_twin, twin_model
from jackettwin.twin.calibration import calibrated

MOVED = datetime(2025, 6, 1, tzinfo=UTC)
TWIN = """structure: jacket15
identification: {max_order: 12}
sensors:
  - channel: x
    height_m: 120.0
    direction: [1, 0, 0]
    calibrations:
      - {to_utc: 2025-06-01T00:00:00Z, gain: 2.0, sign: -1}
      - {from_utc: 2025-06-01T00:00:00Z, to_utc: 2025-07-01T00:00:00Z, height_m: 80.0, direction: [0, 1, 0]}
  - {channel: y, height_m: 120.0, direction: [0, 1, 0]}
"""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("twin") / "twin.yaml"
    path.write_text(TWIN)
    return twin_model(read_twin(path, records_follow=True))


def record(start: datetime | None) -> Record:
    """Two channels that move together at 0.5 Hz, y half as much as x."""
    noise = np.random.default_rng(0).standard_normal((3, 4000))
    pole = np.exp((-0.02 + 1j) * np.pi / 20.0)
    moved = lfilter([1.0 - abs(pole)], [1.0, -2 * pole.real, abs(pole) ** 2], noise[0])
    data = np.array([moved, 0.5 * moved]) + 0.02 * noise[1:]
    return Record(data, 20.0, (Channel("x"), Channel("y")), start)


def test_gain_and_sign_hold_from_and_before_their_times(model) -> None:
    before, after = record(MOVED - timedelta(seconds=1)), record(MOVED)
    np.testing.assert_array_equal(calibrated(before, model.calibrations).data[0], -2.0 * before.data[0])
    np.testing.assert_array_equal(calibrated(before, model.calibrations).data[1], before.data[1])
    assert calibrated(after, model.calibrations) is after


def test_a_sensor_sits_where_it_sat_then(model) -> None:
    x = [model.placed(record(t))[0] for t in (MOVED - timedelta(days=1), MOVED, MOVED + timedelta(days=60))]
    assert [s.height_m for s in x] == [120.0, 80.0, 120.0]


def test_an_observation_keeps_the_identity_of_what_was_logged(model) -> None:
    """Corrected samples are identified, those that were logged are the record."""
    logged = record(MOVED - timedelta(days=1))
    plain = replace(model, calibrations=())
    seen, uncorrected = observe(logged, model), observe(logged, plain)
    assert seen.record_id == uncorrected.record_id == record_id(logged)
    ratios = [
        (m.mode_shape[0] / m.mode_shape[1]).real
        for m in (seen.identification.modes[0], uncorrected.identification.modes[0])
    ]
    np.testing.assert_allclose(ratios, [-4.0, 2.0], rtol=0.05)  # noise of the shape
    assert model.model_hash != plain.model_hash


def test_a_gap_in_the_history_is_said(model) -> None:
    codes = [(f.code, f.subject) for f in observe(record(MOVED + timedelta(days=60)), model).findings]
    assert ("sensor_uncalibrated", "x") in codes


def test_two_at_a_time_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "twin.yaml"
    path.write_text(TWIN.replace("to_utc: 2025-06-01", "to_utc: 2025-06-02"))
    with pytest.raises(InputError, match="two calibrations hold at the same time"):
        read_twin(path, records_follow=True)
