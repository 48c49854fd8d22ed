"""Parquet files as others write them; our own are covered by the registry's round trip."""

from __future__ import annotations

import hashlib
from datetime import UTC, datetime, timedelta
from importlib.resources import files
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from jackettwin.errors import InputError
from jackettwin.records import read_record
from jackettwin.records.readers import parquet
from jackettwin.records.readers.parquet import ENCODING
from pack_records import differences

STAMPS = [datetime(2025, 1, 1, 13, tzinfo=UTC) + timedelta(milliseconds=50 * k) for k in range(40)]


@pytest.mark.parametrize("name", ["time", "__index_level_0__", "when"])
@pytest.mark.parametrize("zone", ["UTC", "Europe/Copenhagen", None])
def test_a_column_of_timestamps_is_the_time(name: str, zone: str | None, tmp_path: Path) -> None:
    stamps = STAMPS if zone else [stamp.replace(tzinfo=None) for stamp in STAMPS]
    columns = {"acc_x": pa.array(np.arange(40.0)), name: pa.array(stamps, pa.timestamp("us", tz=zone))}
    pq.write_table(pa.table(columns), tmp_path / "r.parquet")
    (tmp_path / "r.json").write_text('{"channels": {"acc_x": {"unit": "g"}}}')
    record = read_record(tmp_path / "r.parquet")
    assert (record.sample_rate_hz, record.start_utc) == (20.0, STAMPS[0])


def test_integers_nulls_and_words(tmp_path: Path) -> None:
    columns = {"x": pa.array([1, None, 3]), "y": pa.array([1.0, 2.0, None]), "state": pa.array(list("abc"))}
    pq.write_table(pa.table(columns), tmp_path / "r.parquet")
    (tmp_path / "r.json").write_text('{"sample_rate_hz": 5}')
    record = read_record(tmp_path / "r.parquet")
    np.testing.assert_array_equal(record.data, [[1, np.nan, 3], [1, 2, np.nan]])
    assert record.metadata["remarks"] == ["columns without numbers are left out: state"]


def test_a_file_without_numbers_is_refused(tmp_path: Path) -> None:
    pq.write_table(pa.table({"state": pa.array(["a", "b"])}), tmp_path / "r.parquet")
    with pytest.raises(InputError, match="r.parquet: channels: holds no channels"):
        read_record(tmp_path / "r.parquet")


def test_a_record_stored_as_differences_is_read_bit_by_bit(tmp_path: Path) -> None:
    bits = np.random.default_rng(1).integers(-(2**31), 2**31, 70_000, dtype=np.int64).astype(np.int32)
    values = bits.view(np.float32)
    values[np.isnan(values)] = np.nan  # a quiet one
    stored = pa.table({"acc": differences(values)}).replace_schema_metadata({ENCODING: b"1"})
    pq.write_table(stored, tmp_path / "r.parquet")
    expected = values.astype(float)
    np.testing.assert_array_equal(parquet.read(tmp_path / "r.parquet").data[0], expected)
    parts = [part.data[0] for part in parquet.pieces(tmp_path / "r.parquet")]
    assert len(parts) > 2
    np.testing.assert_array_equal(np.concatenate(parts), expected)


def test_the_shipped_records_are_as_openfast_wrote_them() -> None:
    """Hash of the float32 columns before they were packed."""
    path = Path(str(files("jackettwin") / "data" / "records" / "pile_U12_s301.parquet"))
    samples = hashlib.sha256()
    for column in parquet.read(path).data:
        samples.update(np.asarray(column).astype(np.float32).tobytes())
    assert samples.hexdigest()[:16] == "97371af87f412ac1"
