"""Long records are cut while they are read: memory does not grow with them, and nothing short is touched."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from jackettwin.records import read_record
from jackettwin.records.readers.channels import FileDefaults
from jackettwin.study.many_records.long_records import without_long

CHANNELS = 6
CHILD = """
import sys
from pathlib import Path
from jackettwin.records.readers.channels import FileDefaults
from jackettwin.study.many_records.long_records import without_long

files = without_long([Path(sys.argv[1])], Path(sys.argv[2]), FileDefaults())
# not ru_maxrss: that begins with the memory of the parent
print(len(files), open("/proc/self/status").read().split("VmHWM:")[1].split()[0])
"""


def csv(path: Path, hours: float) -> Path:
    """Write hours at 10 Hz; the same ten minutes again and again, which a reader cannot know."""
    y = np.random.default_rng(7).normal(size=(6000, CHANNELS))
    block = "".join(",".join(f"{v:.6f}" for v in row) + "\n" for row in y)
    path.write_text(",".join(f"acc_{i}" for i in range(CHANNELS)) + "\n" + block * round(6 * hours))
    channels = {f"acc_{i}": {"unit": "m/s^2"} for i in range(CHANNELS)}
    path.with_suffix(".json").write_text(json.dumps({"sample_rate_hz": 10.0, "channels": channels}))
    return path


def parquet(path: Path, hours: float) -> Path:
    """Write hours at 50 Hz."""
    rng = np.random.default_rng(7)
    columns = {f"acc_{i}": rng.normal(size=round(hours * 180_000)) for i in range(CHANNELS)}
    pq.write_table(pa.table(columns), path)
    channels = {name: {"unit": "m/s^2"} for name in columns}
    path.with_suffix(".json").write_text(json.dumps({"sample_rate_hz": 50.0, "channels": channels}))
    return path


def peak_mb(file: Path, pieces: int) -> float:
    """Return the peak memory of a process that cuts a file [MB]."""
    command = [sys.executable, "-c", CHILD, str(file), str(file.parent / "pieces")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    count, kilobytes = map(int, done.stdout.split())
    assert count == pieces
    return kilobytes / 1e3


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize(("written", "short_h", "long_h"), [(csv, 1.5, 6.0), (parquet, 6.0, 15.0)])
def test_memory_does_not_grow_with_the_record(written, short_h: float, long_h: float, tmp_path: Path) -> None:
    """At once, the samples alone would add 76 MB (Parquet), the cells as texts 70 MB (CSV).

    Parquet is compared from a full row group (a million rows) on, of which Arrow holds one.
    """
    short = peak_mb(written(tmp_path / f"short.{written.__name__}", short_h), round(6 * short_h))
    long = peak_mb(written(tmp_path / f"long.{written.__name__}", long_h), round(6 * long_h))
    assert long < short + 40.0  # what allocators and caches keep
    assert long < 400.0


def test_short_records_and_unreadable_ones_stay_as_they_are(tmp_path: Path) -> None:
    short = csv(tmp_path / "short.csv", 1.0)
    broken = tmp_path / "broken.parquet"
    broken.write_bytes(b"no parquet" * 100_000)
    missing = tmp_path / "missing.csv"
    files = (short, broken, missing)
    assert without_long(files, tmp_path / "pieces", FileDefaults()) == files


def test_pieces_stand_in_the_place_of_the_record(tmp_path: Path) -> None:
    long, short = csv(tmp_path / "long.csv", 1.5), csv(tmp_path / "short.csv", 0.5)
    said: list[str] = []
    files = without_long((short, long, short), tmp_path / "pieces", FileDefaults(), said.append)
    assert [file.stem for file in files] == ["short", *(f"long_{i:04d}" for i in range(1, 10)), "short"]
    assert read_record(files[3]).data.shape == (CHANNELS, 6000)
    assert said == ["divide long.csv into pieces of 600 s"]
