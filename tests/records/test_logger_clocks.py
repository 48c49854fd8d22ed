"""Loggers out of step are found, brought into step or cut; structures that lag by nature are left alone.

``qualify/screening.py`` counts what they do to modes over many systems.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from types import SimpleNamespace

import numpy as np
import pytest
from common.planted import random_system

from jackettwin.identification.synthetic import simulate
from jackettwin.records import Channel, Record, assess, repair
from jackettwin.records.quality.repair import common_time

UPPER = [0, 1, 4, 5]
LOWER = (2, 3, 6, 7)
CODES = (
    "clock_late",
    "clock_drift",
    "clock_curve",
    "clock_jump",
    "clock_cut",
    "clock_late_or_complex",
    "gain_jump",
    "clocks_wander",
)


def said(record: Record) -> list[str]:
    return [f.code for f in assess(record).findings if f.code in CODES]


def moved(record: Record, rows: list[int], samples: int, start: int = 0) -> Record:
    """The record with some rows late from a sample on."""
    data = record.data.copy()
    data[rows, start + samples :] = record.data[rows, start : record.data.shape[1] - samples]
    return replace(record, data=data)


@pytest.mark.parametrize("share", [0.15, 0.4])
def test_a_long_gap_says_nothing_of_clocks(share: float, tower: SimpleNamespace) -> None:
    for seed, channel in enumerate((0, 3, 5, 6)):
        record = tower.record(seed)
        n = record.data.shape[1]
        long = int(share * n)
        for gap in (slice(0, long), slice(n - long, n), slice(n // 3, n // 3 + long)):
            data = record.data.copy()
            data[channel, gap] = np.nan
            codes = {finding.code for finding in assess(replace(record, data=data)).findings}
            assert not codes & {*CODES, "time_lost", "another_time", "stored_backwards"}


@pytest.mark.parametrize("samples", [2, 4, 60, 400])
def test_a_logger_that_is_late_is_brought_into_step(samples: int, tower: SimpleNamespace) -> None:
    """Which of two halves is right is not known; in step they are."""
    record = tower.record(1)
    quality = assess(moved(record, UPPER, samples))
    (late,) = quality.clocks.late
    assert late.rows == LOWER
    # four milliseconds: the phases of modes that noise bends
    assert late.delay_s == pytest.approx(-samples / 20.0, abs=4e-3)
    ready = common_time(repair(moved(record, UPPER, samples), quality), quality)
    assert np.isfinite(ready.data).all()
    y = record.data[:, : ready.data.shape[1]]
    y -= y.mean(axis=1, keepdims=True)
    # a hundredth of a second of the second mode, 0.75 Hz
    assert np.abs(ready.data - y)[:, 400:-400].max() < 0.1 * y.std(axis=1).max()


def test_one_channel_alone_is_late(tower: SimpleNamespace) -> None:
    (late,) = assess(moved(tower.record(2), [6], 10)).clocks.late
    assert late.rows == (6,)
    assert late.certain
    assert late.delay_s == pytest.approx(0.5, abs=5e-3)


@pytest.mark.parametrize("start", [6_000, 6_700, 3_500])
def test_a_clock_that_jumps_leaves_the_longer_part(start: int, tower: SimpleNamespace) -> None:
    record = replace(tower.record(3), start_utc=datetime(2025, 1, 1, tzinfo=UTC))
    broken = moved(record, UPPER, 4, start)
    quality = assess(broken)
    (jump,) = quality.clocks.jumps
    assert abs(jump.by_s) == pytest.approx(0.2, abs=0.01)
    assert jump.start <= start <= jump.stop
    ready = common_time(repair(broken, quality), quality)
    assert ready.duration_s >= 240.0
    assert ready.start_utc is not None
    # in step again: the upper sensors' phase against the lower ones is that of the sound record
    assert [f for f in said(ready) if f != "clock_late_or_complex"] == []


def test_a_clock_that_runs_fast_is_slowed_down(tower: SimpleNamespace) -> None:
    record = tower.record(4, noise=0.005)
    t = np.arange(record.data.shape[1])
    data = record.data.copy()
    for i in UPPER:
        data[i] = np.interp(t * (1.0 - 200e-6), t, data[i])
    (late,) = assess(replace(record, data=data)).clocks.late
    assert set(late.rows) in ({*UPPER}, {*LOWER})
    assert abs(late.drift) == pytest.approx(200e-6, abs=6.0 * late.drift_std)
    assert late.drift_std < 20e-6


@pytest.mark.parametrize("late_s", [lambda u: 0.3 * u**2, lambda u: -1.2 * u * (1.0 - u)])
def test_a_clock_whose_rate_changes_is_brought_into_step(
    late_s: Callable[[np.ndarray], np.ndarray], tower: SimpleNamespace
) -> None:
    """A quartz that warms up; a line alone would leave up to 0.04 and 0.2 s."""
    record = tower.record(4, noise=0.005)
    n = record.data.shape[1]
    t, truth = np.arange(n) / 20.0, late_s(np.arange(n) / n)
    data = record.data.copy()
    for i in (3, 7):
        data[i] = np.interp(t - truth, t, data[i])
    quality = assess(replace(record, data=data))
    assert said(replace(record, data=data)) == ["clock_curve"]
    (late,) = quality.clocks.late
    assert late.rows == (3, 7)
    # 0.05 rad at the frequency of the second mode
    assert np.abs([late.delay_at(time) for time in t[::100]] - truth[::100]).max() < 0.012
    ready = common_time(repair(replace(record, data=data), quality), quality)
    assert said(ready) == []


@pytest.mark.parametrize("drawn", [(13, 100), (77, 185)])
def test_close_modes_that_take_turns_are_no_drift(drawn: tuple[int, int]) -> None:
    """Sound systems, two of 620 drawn: phases wander by 0.15 and 0.3 rad, each channel its own way."""
    system = random_system(np.random.default_rng(drawn))
    record = simulate(
        system.system,
        np.random.default_rng((*drawn, 0)),
        duration_s=system.duration_s,
        sample_rate_hz=system.sample_rate_hz,
    )
    assert said(record) == []


@pytest.mark.parametrize("seed", [2, 9, 62, 71, 87, 90, 114])
def test_close_modes_along_axes_that_are_not_stated_are_no_fault(seed: int, tower: SimpleNamespace) -> None:
    """Two pairs 1 % apart under two common forces, in four places: seven of 150 drawn.

    What moves in phase along both axes is in antiphase later, by way of all phases: no fault of a logger.
    """
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    load, motion = rng.normal(size=(2, 4_500)), np.zeros((8, 3_000))
    for f, shape in zip((0.4, 1.7), tower.shapes * [[1.0], [0.5]], strict=True):
        modal = [tower.oscillator(rng.normal(size=2) @ load, f * x, 0.01, 10.0)[1_500:] for x in (1.0, 1.01)]
        motion += np.kron(turn @ np.array(modal), shape[:, None])
    motion += 0.02 * motion.std() * rng.normal(size=motion.shape)
    record = Record(motion, 10.0, tuple(Channel(f"a{i}") for i in range(8)))
    assert not [f for f in assess(record).findings if f.code in (*CODES, "sign_turns")]


def test_complex_modes_are_no_delay(tower: SimpleNamespace) -> None:
    """Each mode lags in its own way between the sensors, up to ten degrees: 20 records."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        data = []
        for f_1, f_2 in ((0.178, 0.76), (0.176, 0.74)):
            modal = [tower.oscillator(rng.normal(size=24_000), f, 0.01, 20.0) for f in (f_1, f_2)]
            lines = np.fft.rfft(modal, axis=1)
            lag = np.exp(1j * np.radians(rng.uniform(-10.0, 10.0, (4, 2))))
            data.append(np.fft.irfft((tower.shapes.T * lag) @ lines, axis=1)[:, 12_000:])
        record = replace(tower.record(seed), data=np.vstack(data))
        record = replace(
            record, data=record.data + 0.02 * record.data.std() * rng.normal(size=record.data.shape)
        )
        assert said(record) == []


def test_a_sensor_that_turns_or_dies_is_no_jump_of_its_clock(tower: SimpleNamespace) -> None:
    record = tower.record(6)
    for factor in (-1.0, 1e-3):
        data = record.data.copy()
        data[1, 6_000:] *= factor
        quality = assess(replace(record, data=data))
        assert not quality.clocks.jumps
        assert not quality.clocks.late
