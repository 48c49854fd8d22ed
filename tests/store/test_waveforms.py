"""Samples are kept to the last bit, as int16 where the sensor's step allows."""

import json
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record
from jackettwin.records.record import record_id
from jackettwin.store import (
    read_extremes,
    read_waveform,
    waveform_path,
    without_false_digits,
    write_waveform,
)
from jackettwin.store.waveforms import packed_samples

START = datetime(2025, 3, 1, 12, tzinfo=UTC)


def record(data: np.ndarray) -> Record:
    channels = tuple(Channel(f"a{i}", direction=(1.0, 0.0, 0.0), height_m=20.0 + i) for i in range(len(data)))
    return Record(data, 20.0, channels, START, {"mean_wind_speed_m_s": 8.5}, {"logger": "x"}, "one")


@pytest.mark.parametrize("step", [0.0001, 0.003, 2.0**-13, 1.0, 0.0025])
def test_a_loggers_steps_become_int16(tmp_path: Path, step: float) -> None:
    rng = np.random.default_rng(1)
    counts = np.round(200 * rng.standard_normal((2, 4000)))
    # what a reader makes of the decimals a logger writes
    data = np.array([[float(f"{c * step:.15g}") for c in row] for row in counts])
    data[0, 100:120] = np.nan
    path = tmp_path / waveform_path("wtg", START, "abc")
    size = write_waveform(record(data), path)
    assert all(str(field.type) == "int16" for field in pq.read_schema(path))
    assert size < 0.4 * data.nbytes
    back = read_waveform(path)
    np.testing.assert_array_equal(back.data, data)
    assert record_id(back) == record_id(record(data))
    second = read_waveform(path, ["a1", "none"])
    np.testing.assert_array_equal(second.data, data[1:])
    assert second.channels == back.channels[1:]
    assert (back.channels, back.conditions, back.start_utc) == (
        record(data).channels,
        {"mean_wind_speed_m_s": 8.5},
        START,
    )


@pytest.mark.parametrize("gain", [1.0, 9.80665, 9.81, 1e-3])
def test_32_bit_floats_in_a_loggers_unit_take_at_most_five_bytes(tmp_path: Path, gain: float) -> None:
    """As HDF5, MATLAB and OpenFAST keep them, put into m/s² by their reader."""
    single = (0.05 * np.random.default_rng(2).standard_normal((4, 12_000))).astype(np.float32)
    data = single.astype(float) * gain
    data[1, 5] = np.nan
    path = tmp_path / "x.parquet"
    size = write_waveform(record(data), path)
    assert size / data.size <= 5.0
    back = read_waveform(path)
    np.testing.assert_array_equal(back.data, data)
    assert record_id(back) == record_id(record(data))


def test_a_logger_of_24_bits_takes_at_most_five_bytes(tmp_path: Path) -> None:
    counts = np.random.default_rng(3).integers(-(2**23), 2**23, (2, 12_000))
    data = np.array([[float(f"{c * 1e-6:.6f}") for c in row] for row in counts])
    data[0, :10] = np.nan
    size = write_waveform(record(data), tmp_path / "x.parquet")
    assert size / data.size <= 5.0
    np.testing.assert_array_equal(read_waveform(tmp_path / "x.parquet").data, data)


@pytest.mark.parametrize("offset", [0.0, 9.81, -3.0])
def test_64_bit_floats_lose_what_is_far_below_their_noise_and_take_at_most_five_bytes(
    tmp_path: Path, offset: float
) -> None:
    """The error is at most half a step, 2⁻¹⁵ of the median change, and has no mean."""
    rng = np.random.default_rng(4)
    data = offset + 1e-3 * rng.standard_normal((2, 12_000)) + 0.05 * np.sin(0.05 * np.arange(12_000))
    data[0, 7] = np.nan
    once = without_false_digits(record(data))
    change = np.nanmedian(np.abs(np.diff(data)), axis=1, keepdims=True)
    error = once.data - data
    assert 0.0 < np.nanmax(np.abs(error / change)) <= 2.0**-15
    assert np.all(
        np.abs(np.nanmean(error, axis=1)) < 5e-7 * change[:, 0]
    )  # three deviations of the mean or more
    assert record_id(without_false_digits(once)) == record_id(once)
    size = write_waveform(once, tmp_path / "x.parquet")
    assert size / data.size <= 5.0
    assert record_id(read_waveform(tmp_path / "x.parquet")) == record_id(once)


@pytest.mark.parametrize(
    "x",
    [
        np.random.default_rng(1).standard_normal(400).astype(np.float32).astype(float) * 9.81,
        np.round(200 * np.random.default_rng(1).standard_normal(400)) * 0.003,
        np.r_[np.zeros(300), np.pi * np.arange(100)],
        np.r_[1e12 * np.pi, np.random.default_rng(1).standard_normal(400)],
        np.r_[np.inf, np.random.default_rng(1).standard_normal(400)],
        np.full(9, np.nan),
    ],
    ids=["32-bit", "steps", "stands still", "range", "infinite", "missing"],
)
def test_what_has_no_false_digits_is_not_rounded(x: np.ndarray) -> None:
    np.testing.assert_array_equal(without_false_digits(record(x[None])).data[0], x)


def test_what_has_no_step_is_kept_as_it_is(tmp_path: Path) -> None:
    data = np.random.default_rng(2).standard_normal((2, 500))
    path = tmp_path / "x.parquet"
    write_waveform(record(data), path)
    np.testing.assert_array_equal(read_waveform(path).data, data)


def test_a_range_beyond_int16_is_not_squeezed_into_it() -> None:
    x = np.arange(-40_000.0, 40_000.0, 2.0) / 8.0
    packed, step = packed_samples(np.append(x, x[0] + 0.125))
    assert (packed.dtype, step) == (np.int32, [0.125, 1.0])


def test_a_value_that_no_integer_or_single_float_is_stays_whole() -> None:
    x = np.append(np.array([1e300, np.inf, -np.inf, np.nan]), np.pi * np.arange(1, 50.0))
    packed, step = packed_samples(x)
    np.testing.assert_array_equal(packed, x)
    assert step is None


@pytest.mark.parametrize(
    ("since_s", "until_s", "points"),
    [(0.0, None, 100), (0.0, None, 7), (4321.0, 9000.0, 40), (100.3, 100.9, 50), (9.9e5, None, 10)],
)
def test_extremes_are_those_of_the_samples_between_their_edges(
    tmp_path: Path, since_s: float, until_s: float | None, points: int
) -> None:
    """Of kept blocks where bins are long, of the samples where they are short; two hours, none in a third."""
    data = np.cumsum(np.random.default_rng(5).standard_normal((3, 200_000)), axis=1)
    data[0, 60_000:130_000] = np.nan
    write_waveform(record(data), tmp_path / "x.parquet")
    found = read_extremes(tmp_path / "x.parquet", ["a2", "a0"], since_s, until_s, points)
    assert found.names == ("a2", "a0") and found.low.shape == found.high.shape == (2, found.time_s.size)
    last = 10_000.0 if until_s is None else until_s
    assert found.time_s.size <= points
    if since_s < last:
        bin_s = (last - since_s) / points
        assert found.time_s.size >= points / 1.3 - 1 or bin_s < 0.05
        assert since_s - 0.25 * bin_s - 0.05 <= found.time_s[0] <= since_s
    edges = np.round(20.0 * found.time_s).astype(int)
    ends = np.append(edges[1:], int(np.ceil(20.0 * last)))[: edges.size]
    for row, low, high in zip(data[[2, 0]], found.low, found.high, strict=True):
        for k, (first, end) in enumerate(zip(edges, ends, strict=True)):
            samples = row[first:end]
            if k == edges.size - 1:  # the last bin ends with a block
                assert low[k] <= np.nanmin(samples) and high[k] >= np.nanmax(samples)
            elif np.isnan(samples).all():
                assert np.isnan(low[k]) and np.isnan(high[k])
            else:
                assert (low[k], high[k]) == (np.nanmin(samples), np.nanmax(samples))
    with pytest.raises(InputError, match="channel"):
        read_extremes(tmp_path / "x.parquet", ["none"], 0.0, None, 10)


def test_a_file_without_extremes_is_drawn_from_its_samples(tmp_path: Path) -> None:
    """As files were written before."""
    data = np.random.default_rng(6).standard_normal((1, 50_000))
    write_waveform(record(data), tmp_path / "new")
    table = pq.read_table(tmp_path / "new")
    about = {**json.loads(table.schema.metadata[b"jackettwin"])}
    del about["block"]
    pq.write_table(table.replace_schema_metadata({b"jackettwin": json.dumps(about)}), tmp_path / "old")
    new, old = (read_extremes(tmp_path / name, None, 0.0, None, 5) for name in ("new", "old"))
    assert (new.low.min(), new.high.max()) == (data.min(), data.max()) == (old.low.min(), old.high.max())
