"""Channels that change while a record runs are found and told from forces that change."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.records import Record, assess, repair
from jackettwin.records.quality.sensor_changes import PARTS, SensorChange, changes

N = 12_000
PART = N // PARTS


def changed(record: Record, i: int, at: int, factor: float, *, before: bool = False) -> Record:
    """The channel times a factor after (or before) a sample."""
    data = record.data.copy()
    data[i, slice(0, at) if before else slice(at, None)] *= factor
    return replace(record, data=data)


@pytest.mark.parametrize("rows", [range(8), [0, 1], [0, 4], [0, 1, 2], [0, 4, 5]])
def test_sound_channels_do_not_change(rows: list[int], tower: SimpleNamespace) -> None:
    """20 records each: no false alarm in 400 channels is a rate below 0.75 % in 95 %."""
    for seed in range(20):
        record = tower.record(seed)
        assert changes(record.data[list(rows)]) == []


def test_the_ends_of_a_long_record_are_no_change(tower: SimpleNamespace) -> None:
    """Its modes lie a hundred times above the lowest band, into which a jump between the ends would leak."""
    for seed in range(3):
        rng = np.random.default_rng(seed)
        modes = [tower.oscillator(rng.standard_normal(90_000), f, 0.01, 50.0) for f in (1.2, 2.7)]
        y = tower.shapes.T @ np.array(modes)
        assert changes(y + 0.05 * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)) == []


def test_a_force_that_changes_is_no_change_of_a_sensor(tower: SimpleNamespace) -> None:
    data = tower.record(1).data
    data[:, N // 2 :] *= 3.0
    assert changes(data) == []
    data[:4, N // 3 :] *= 4.0
    assert changes(data) == []


def test_a_structure_that_comes_to_rest_in_noise_breaks_no_sensor(tower: SimpleNamespace) -> None:
    """At rest every channel shows its own noise, and nothing of what the others do."""
    for seed in range(5):
        data = tower.record(seed).data * np.exp(-np.arange(N) / 1_000.0)
        noise = np.random.default_rng(seed).standard_normal(data.shape)
        assert changes(data + 0.2 * data.std(axis=1, keepdims=True) * noise) == []


@pytest.mark.parametrize("factor", [3.0, 0.3, -1.0])
@pytest.mark.parametrize(("at", "before"), [(6_000, False), (3_777, True), (9_000, False)])
def test_gain_and_sign_are_found_where_they_change(
    factor: float, at: int, before: bool, tower: SimpleNamespace
) -> None:
    (found,) = changes(changed(tower.record(2), 1, at, factor, before=before).data)
    assert found.row == 1
    assert found.certain
    # a tenth: two per cent of noise, in parts of some seven cycles
    assert found.gain == pytest.approx(factor, rel=0.1)
    edge = found.stop if before else found.start
    assert abs(edge - at) <= PART


def test_a_sensor_that_dies_is_found_whatever_it_reads_then(
    rng: np.random.Generator, tower: SimpleNamespace
) -> None:
    data = tower.record(3).data
    for std in (1e-3, 1.0):
        broken = data.copy()
        broken[5, 4_000:] = std * data[5].std() * rng.standard_normal(N - 4_000)
        (found,) = changes(broken)
        assert (found.row, found.gain, found.certain) == (5, 0.0, True)
        assert abs(found.start - 4_000) <= PART or abs(found.stop - 4_000) <= PART


def test_two_at_once_are_both_found(tower: SimpleNamespace) -> None:
    record = changed(changed(tower.record(4), 0, 6_000, -1.0), 5, 8_000, 3.0)
    assert {(c.row, round(c.gain)) for c in changes(record.data)} == {(0, -1), (5, 3)}


def test_of_two_sensors_nobody_knows_which_changed(tower: SimpleNamespace) -> None:
    record = changed(tower.record(5), 1, 6_000, 3.0).select(["acc_144_x", "acc_77_x"])
    (found,) = changes(record.data)
    assert not found.certain
    # whichever it was, their ratio after the repair is that of the earlier half
    ready = repair(record, assess(record)).data
    sound = tower.record(5).select(["acc_144_x", "acc_77_x"]).data
    ratio = [
        np.nanstd(ready[1, part]) / np.nanstd(ready[0, part]) for part in (slice(5_000), slice(7_000, None))
    ]
    # two per cent of noise
    assert ratio == pytest.approx([sound[1].std() / sound[0].std()] * 2, rel=0.1)


def test_a_sign_that_turned_is_that_of_the_longer_side(tower: SimpleNamespace) -> None:
    sound = tower.record(6)
    record = changed(sound, 2, 4_200, -1.0, before=True)
    quality = assess(record)
    (finding,) = quality.findings
    assert (finding.code, finding.repaired) == ("sign_turns", True)
    ready = repair(record, quality).data[2]
    known = np.isfinite(ready)
    assert known.mean() > 0.9
    np.testing.assert_allclose(ready[known], sound.data[2][known])


@pytest.mark.parametrize("rows", [[2], [0, 1, 4, 5]])
@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_a_gain_that_jumps_is_scaled_back(rows: list[int], factor: float, tower: SimpleNamespace) -> None:
    """Of one channel, and of a logger's."""
    sound = tower.record(6)
    data = sound.data.copy()
    data[rows, :4_200] *= factor
    quality = assess(replace(sound, data=data))
    (finding,) = quality.findings
    assert (finding.code, finding.repaired) == ("gain_jump", True)
    ready = repair(replace(sound, data=data), quality).data
    known = np.isfinite(ready)
    # a window of a tenth of the record at most is lost; noise of two per cent moves the gain by less
    assert known.mean() > 0.9
    assert known[np.setdiff1d(range(8), rows)].all()
    np.testing.assert_allclose(
        ready[known], sound.data[known], atol=0.05 * sound.data.std(axis=1).max(), rtol=0.05
    )


def test_a_change_shows_beside_gaps(tower: SimpleNamespace) -> None:
    record = changed(tower.record(7), 0, 6_000, 3.0)
    data = record.data.copy()
    data[1, 1_000:2_500] = np.nan
    data[0, 7_000:8_000] = np.nan
    (found,) = changes(data)
    assert found == SensorChange(0, 6_000, N, found.gain, True)
    assert found.gain == pytest.approx(3.0, rel=0.1)


@pytest.mark.parametrize("shape", [(0, 0), (1, 100), (3, 10), (3, 100), (2, 3_000)])
def test_short_silent_and_empty_data_have_no_changes(shape: tuple[int, int]) -> None:
    assert changes(np.zeros(shape)) == []
    assert changes(np.full(shape, np.nan)) == []
