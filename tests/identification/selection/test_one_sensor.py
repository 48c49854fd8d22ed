"""A sensor that shakes beside a mode is told by the plane of the two shapes; a pair of modes is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import ModalEstimate, identify
from jackettwin.identification.selection.one_sensor import of_one_sensor
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

SHAPES = np.random.default_rng(4).standard_normal((3, 6))
ALL = np.ones((6, 6), dtype=bool)


def estimate(frequency_hz: float, shape: np.ndarray) -> ModalEstimate:
    return ModalEstimate(frequency_hz, 0.01, shape.astype(complex), 1.0, 0.0, 1.0)


def test_the_mode_that_moves_the_sensor_more_is_told() -> None:
    sensor = np.eye(6)[2]
    # both shapes are mixtures of the mode's and the sensor's own
    mixed = [SHAPES[0] + 0.1 * sensor, 0.4 * SHAPES[0] + 2.0 * sensor]
    pair = [estimate(0.70, mixed[0]), estimate(0.705, mixed[1])]
    found = of_one_sensor(pair, np.ones(6), ALL, 2.0)
    assert list(found) == [1]
    assert found[1] > 0.5
    assert of_one_sensor([pair[0], replace(pair[1], frequency_hz=0.8)], np.ones(6), ALL, 2.0) == {}


def test_a_pair_of_modes_is_not() -> None:
    pair = [estimate(0.70, SHAPES[0]), estimate(0.705, SHAPES[1])]
    assert of_one_sensor(pair, np.ones(6), ALL, 2.0) == {}


def test_a_pair_that_is_a_tenth_of_what_lower_sensors_show_is_not() -> None:
    """First bending pair of a jacket whose lower levels move in higher modes: scaled, it is its top."""
    levels, axes = np.array([1.0, 0.34, 0.13, 0.08]), np.array([[1.0, 0.7], [-0.4, 1.0]])
    pair = [estimate(0.163, np.kron(levels, axis)) for axis in axes]
    scale = np.kron([0.03, 0.13, 0.1, 0.09], [1.0, 1.0])
    along = np.kron(np.ones((4, 4)), np.eye(2)).astype(bool)
    assert of_one_sensor(pair, scale, along, 2.0) == {}
    # the mount of the top's sensor along x shakes beside the pair's other member
    shaken = [pair[1], estimate(0.1632, np.eye(8)[0] + 0.1 * pair[1].mode_shape.real)]
    assert list(of_one_sensor(shaken, scale, along, 2.0)) == [1]


def test_the_only_sensor_of_a_direction_is_not() -> None:
    """A pair along x and y, seen by five sensors along x and one along y: the plane holds that one."""
    x, y = np.append(SHAPES[0][:5], 0.0), np.eye(6)[5]
    comparable = np.kron(np.eye(2), np.ones((5, 5)))[:6, :6].astype(bool)
    pair = [estimate(0.70, x), estimate(0.705, y)]
    assert list(of_one_sensor(pair, np.ones(6), ALL, 2.0)) == [1]
    assert of_one_sensor(pair, np.ones(6), comparable, 2.0) == {}


def shaken(record: Record, frequency_hz: float, rng: np.random.Generator) -> Record:
    """Add a resonance of 1 % in channel 3 alone, as strong as all it shows."""
    n, data = record.data.shape[1], record.data.copy()
    f = np.fft.rfftfreq(n, 1.0 / record.sample_rate_hz)
    force = rng.normal(size=(len(f), 2)) @ np.array([1.0, 1j])
    own = np.fft.irfft(force * f**2 / (frequency_hz**2 - f**2 + 0.02j * frequency_hz * f + 1e-12), n)
    data[3] += data[3].std() * own / own.std()
    return replace(record, data=data)


@pytest.mark.parametrize("seed", range(3))
def test_a_mount_that_shakes_half_a_bandwidth_from_a_mode_is_never_ok(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = ModalSystem(np.array([0.3, 0.7, 1.6]), np.full(3, 0.012), SHAPES, np.diag([0.1, 1.0, 5.0]), 0.02)
    record = simulate(system, rng, duration_s=1200.0, sample_rate_hz=8.0)
    sound = identify(record)
    assert [round(m.frequency_hz, 1) for m in sound.modes if m.status == "ok"] == [0.3, 0.7, 1.6]
    found = identify(shaken(record, 0.71, rng))
    fine = [m for m in found.modes if m.status == "ok"]
    assert len(fine) <= 3
    assert all(np.min(np.abs(m.frequency_hz / system.frequency_hz - 1.0)) < 0.01 for m in fine)
