"""Pieces of a long file: nothing lost, nothing twice, cut on the clock, whatever the format."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record, read_record, write_record
from jackettwin.records.readers import delimited, hdf5, parquet, read_record_pieces
from jackettwin.records.readers.channels import FileDefaults

START = datetime(2025, 6, 1, 12, 3, 20, tzinfo=UTC)
RATE = 10.0


def long_record(start: datetime | None = START) -> Record:
    """Return 32 min 40 s of two channels that know which sample they are."""
    n = int(RATE * 1960)
    data = np.vstack([np.arange(n, dtype=float) / 1e3, np.random.default_rng(1).normal(size=n)])
    channels = (Channel("acc_x", direction=(1.0, 0.0, 0.0)), Channel("acc_y", direction=(0.0, 1.0, 0.0)))
    return Record(data, RATE, channels, start, name="day")


@pytest.mark.parametrize("extension", ["csv", "parquet", "h5", "npz", "uff"])
def test_pieces_together_are_the_record(
    extension: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for reader in (delimited, hdf5, parquet):
        monkeypatch.setattr(reader, "ROWS", 1234)  # far from any boundary
    path = tmp_path / f"day.{extension}"
    write_record(long_record(), path)
    whole, pieces = read_record(path), list(read_record_pieces(path))
    assert [piece.name for piece in pieces] == [
        "day_20250601T120320",
        "day_20250601T121000",
        "day_20250601T122000",
        "day_20250601T123000",
    ]
    assert [piece.data.shape[1] for piece in pieces] == [4000, 6000, 6000, 3600]
    assert_allclose(np.hstack([piece.data for piece in pieces]), whole.data, rtol=1e-12)
    assert pieces[2].start_utc == datetime(2025, 6, 1, 12, 20, tzinfo=UTC)
    assert all(piece.channels == whole.channels for piece in pieces)
    assert all(piece.sample_rate_hz == pytest.approx(RATE, rel=1e-6) for piece in pieces)


def test_stamps_with_a_gap_are_cut_by_the_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An hour is missing: its pieces are not there, and those behind it start where the clock says."""
    monkeypatch.setattr(delimited, "ROWS", 777)
    t = np.concatenate([np.arange(0, 1200, 0.5), np.arange(4800, 6000, 0.5)])
    stamps = np.datetime64("2025-06-01T12:00:00.000") + (1e3 * t).astype("timedelta64[ms]")
    lines = [f"{stamp}Z,{v:.3f}" for stamp, v in zip(stamps, t, strict=True)]
    path = tmp_path / "a.csv"
    path.write_text("time,acc_x [m/s^2]\n" + "\n".join(lines) + "\n")
    pieces = list(read_record_pieces(path))
    assert [f"{piece.start_utc:%H%M}" for piece in pieces] == ["1200", "1210", "1320", "1330"]
    assert all(np.isfinite(piece.data).all() and piece.data.shape[1] == 1200 for piece in pieces)
    assert_allclose(pieces[2].data[0, :2], [4800.0, 4800.5])


def test_without_a_start_pieces_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "day.npz"
    record = long_record(None)
    write_record(replace(record, data=record.data[:, :15100]), path)
    pieces = list(read_record_pieces(path))
    assert [(piece.name, piece.data.shape[1]) for piece in pieces] == [
        ("day_0001", 6000),
        ("day_0002", 6000),
        ("day_0003", 3100),
    ]


def test_a_rate_is_asked_for_once_and_faults_name_the_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(delimited, "ROWS", 100)
    path = tmp_path / "a.csv"
    path.write_text("acc_x,acc_y\ng,g\n" + "0.1,0.2\n" * 250 + "0.1,oops\n" + "0.1,0.2\n" * 200)
    with pytest.raises(InputError, match="sample rate is missing"):
        next(read_record_pieces(path))
    with pytest.raises(InputError, match="line 253, channel acc_y") as refused:
        list(read_record_pieces(path, 10.0, FileDefaults(10.0)))
    assert refused.value.file == path


def test_a_channel_empty_for_a_while_stays_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(delimited, "ROWS", 100)
    path = tmp_path / "a.csv"
    path.write_text("acc_x,acc_y\ng,g\n" + "0.1,0.2\n" * 100 + "0.1,\n" * 100 + "0.1,0.2\n" * 100)
    pieces = list(read_record_pieces(path, 10.0, FileDefaults(10.0)))
    assert [piece.channel_names for piece in pieces] == 3 * [("acc_x", "acc_y")]
    assert np.isnan(pieces[1].data[1]).all()
