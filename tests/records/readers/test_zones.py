"""Clocks: what says its zone is UTC; what does not is said, and can be told."""

from __future__ import annotations

import json
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record, read_record
from jackettwin.records.readers import delimited, read_record_pieces
from jackettwin.records.readers.channels import FileDefaults
from jackettwin.records.readers.stamps import NEVER, PASSED, TWICE, in_utc, read_zone

LOCAL = datetime(2025, 6, 1, 14, 0, 0)
TWELVE = datetime(2025, 6, 1, 12, tzinfo=UTC)


def written(path: Path, ending: str = "") -> Path:
    rows = [f"2025-06-01 14:{i // 600:02d}:{i % 600 / 10:04.1f}{ending},{i % 7}" for i in range(13000)]
    path.write_text("time,acc_x [g]\n" + "\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize("text", ["+02:00", "UTC+2", "utc +02:00", "Europe/Berlin", "+0200"])
def test_zones_of_one_summer_clock(text: str) -> None:
    assert in_utc(LOCAL, read_zone(text)) == TWELVE


def test_zones_of_utc_and_none() -> None:
    assert in_utc(LOCAL, read_zone("Z")) == LOCAL.replace(tzinfo=UTC)
    assert in_utc(datetime(2025, 1, 1, 14), read_zone("Europe/Berlin")).hour == 13
    with pytest.raises(InputError, match="is not a time zone"):
        read_zone("Mars/Base")


def test_a_clock_without_zone_is_said_or_told(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv")
    silent = read_record(path)
    assert silent.start_utc == LOCAL.replace(tzinfo=UTC)
    assert any("does not say its zone" in text for text in silent.metadata["remarks"])
    told = read_record(path, FileDefaults(timezone="Europe/Berlin"))
    assert told.start_utc == TWELVE
    assert "remarks" not in told.metadata
    path.with_suffix(".json").write_text(json.dumps({"clock": "UTC+2"}))
    assert read_record(path).start_utc == TWELVE
    (first, *_) = read_record_pieces(path)
    assert (first.start_utc, first.name) == (TWELVE, "a_20250601T120000")
    path.with_suffix(".json").write_text(json.dumps({"clock": "local"}))
    with pytest.raises(InputError, match="is not a time zone") as refused:
        read_record(path)
    assert refused.value.file == path.with_suffix(".json")


@pytest.mark.parametrize(
    "line",
    [
        "# Time zone: Europe/Berlin (local time)",
        "# timezone=UTC+2",
        "# Zeitzone: GMT +2 (Sommer)",
        "# TZ: (UTC+02:00) Berlin",
    ],
)
def test_a_zone_that_the_comments_name_is_the_clocks(line: str, tmp_path: Path) -> None:
    """What lies beside the file is stronger than they are, and they than what is assumed of all files."""
    path = written(tmp_path / "a.csv")
    path.write_text(line + "\n" + path.read_text())
    record = read_record(path, FileDefaults(timezone="+05:00"))
    assert record.start_utc == TWELVE
    assert "remarks" not in record.metadata
    (first, *_) = read_record_pieces(path)
    assert first.start_utc == TWELVE
    path.with_suffix(".json").write_text(json.dumps({"clock": "+03:00"}))
    assert read_record(path).start_utc == TWELVE - timedelta(hours=1)


def test_a_comment_that_names_no_zone_is_not_taken_for_one(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv")
    path.write_text("# clock: quartz, 20 ppm\n# Time zone: local\n" + path.read_text())
    record = read_record(path)
    assert record.start_utc == LOCAL.replace(tzinfo=UTC)
    assert any("does not say its zone" in text for text in record.metadata["remarks"])


@pytest.mark.parametrize("ending", ["Z", "+02:00"])
def test_a_clock_with_zone_needs_no_telling(ending: str, tmp_path: Path) -> None:
    record = read_record(written(tmp_path / "a.csv", ending), FileDefaults(timezone="+05:00"))
    assert record.start_utc == (TWELVE if ending != "Z" else LOCAL.replace(tzinfo=UTC))
    assert "remarks" not in record.metadata


def test_stamps_of_parquet_say_their_zone_or_not(tmp_path: Path) -> None:
    stamps = np.datetime64("2025-06-01T14:00:00", "ns") + np.arange(50) * np.timedelta64(100, "ms")
    y = pa.array(np.arange(50.0))
    for name, kind in (("naive", pa.timestamp("ns")), ("utc", pa.timestamp("ns", tz="UTC"))):
        pq.write_table(
            pa.table({"time": pa.array(stamps).cast(kind), "acc_x": y}), tmp_path / f"{name}.parquet"
        )
    defaults = FileDefaults(unit="g", timezone="+02:00")
    assert read_record(tmp_path / "naive.parquet", defaults).start_utc == TWELVE
    assert read_record(tmp_path / "utc.parquet", defaults).start_utc == LOCAL.replace(tzinfo=UTC)


def test_an_hour_that_is_there_twice_is_said(tmp_path: Path) -> None:
    """Clocks went back at three on the 26th of October 2025: 02:15 was 00:15 and 01:15 UTC."""
    path = written(tmp_path / "a.csv")
    path.write_text(path.read_text().replace("2025-06-01 14", "2025-10-26 02"))
    record = read_record(path, FileDefaults(timezone="Europe/Berlin"))
    assert record.start_utc == datetime(2025, 10, 26, 0, tzinfo=UTC)
    assert TWICE in record.metadata["remarks"]
    assert TWICE not in read_record(path, FileDefaults(timezone="+02:00")).metadata.get("remarks", ())


def at_night(path: Path, shown: Iterable[datetime]) -> Record:
    """Return a record of one sample a second, written with the times that a clock in Berlin showed."""
    path.write_text("time,acc_x [g]\n" + "".join(f"{t:%Y-%m-%d %H:%M:%S},{t.second % 7}\n" for t in shown))
    return read_record(path, FileDefaults(timezone="Europe/Berlin"))


def seconds_from(begin: datetime) -> list[datetime]:
    return [begin + timedelta(seconds=k) for k in range(600)]


def test_a_clock_that_is_put_forward_loses_no_hour(tmp_path: Path) -> None:
    """The stamps jump by an hour at two on the 30th of March 2025: the record had an hour without samples."""
    two, hour = datetime(2025, 3, 30, 2), timedelta(hours=1)
    shown = [t if t < two else t + hour for t in seconds_from(datetime(2025, 3, 30, 1, 55))]
    record = at_night(tmp_path / "a.csv", shown)
    assert record.start_utc == datetime(2025, 3, 30, 0, 55, tzinfo=UTC)
    assert record.duration_s == 600.0 and np.isfinite(record.data).all()
    assert "remarks" not in record.metadata


@pytest.mark.parametrize("begin", [(1, 55), (2, 10), (2, 55)])
def test_an_hour_that_is_never_there_is_said(begin: tuple[int, int], tmp_path: Path) -> None:
    """Clocks went from two to three: a logger that shows 02:10 was not put forward, 02:10 is 01:10 UTC."""
    record = at_night(tmp_path / "a.csv", seconds_from(datetime(2025, 3, 30, *begin)))
    assert record.metadata["remarks"] == [NEVER]
    assert record.start_utc == datetime(2025, 3, 30, begin[0] - 1, begin[1], tzinfo=UTC)
    assert record.duration_s == 600.0


def test_a_clock_that_is_not_put_back_is_said(tmp_path: Path) -> None:
    record = at_night(
        tmp_path / "a.csv",
        [
            t
            for k in range(9)
            for t in seconds_from(datetime(2025, 10, 26, 1, 55) + k * timedelta(minutes=10))
        ],
    )
    assert record.metadata["remarks"] == [PASSED]


@pytest.mark.parametrize("begin", [(1, 55), (2, 55)])
def test_a_clock_that_is_put_back_has_its_hour_twice(
    begin: tuple[int, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """02:59:59 of summer time is followed by 02:00:00 of winter time, on no other day or hour."""
    monkeypatch.setattr(delimited, "ROWS", 300 if begin[0] == 1 else 1000)  # between parts, and within one
    third = datetime(2025, 10, 26, 3)
    shown = [t if t < third else t - timedelta(hours=1) for k in (0, 600, 1200, 1800, 2400, 3000, 3600)
             for t in seconds_from(datetime(2025, 10, 26, *begin) + timedelta(seconds=k))]  # fmt: skip
    record = at_night(tmp_path / "a.csv", shown)
    assert record.start_utc == datetime(2025, 10, 25, 23, 55, tzinfo=UTC) + timedelta(hours=begin[0] - 1)
    assert record.duration_s == 4200.0 and np.isfinite(record.data).all()
    assert "remarks" not in record.metadata
    pieces = list(read_record_pieces(tmp_path / "a.csv", 600.0, FileDefaults(timezone="Europe/Berlin")))
    starts = [(piece.start_utc - record.start_utc).total_seconds() for piece in pieces if piece.start_utc]
    assert starts == [300.0 + 600.0 * k for k in range(6)]
    np.testing.assert_array_equal(np.hstack([piece.data for piece in pieces]), record.data[:, 300:3900])
    assert not any(PASSED in piece.metadata.get("remarks", ()) for piece in pieces)
    with pytest.raises(InputError, match="--timezone"):
        list(read_record_pieces(tmp_path / "a.csv", 600.0))
    for off in (timedelta(days=1), timedelta(hours=1)):
        with pytest.raises(InputError, match="do not increase"):
            at_night(tmp_path / "a.csv", [t + off for t in shown])


def test_the_statistics_of_stamps_stay_metadata(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "Z")
    path.with_suffix(".json").write_text(json.dumps({"clock": {"jitter_s": 0.5}}))
    assert "jitter_s" in read_record(path).metadata["clock"]
