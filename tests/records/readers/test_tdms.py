from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import read_record

DATA = Path(__file__).parents[1] / "data"
UNIT, RATE = b"unit_string", b"wf_increment"


def text(value: bytes, order: str = "<") -> bytes:
    return struct.pack(f"{order}I", len(value)) + value


def channel(
    name: bytes, count: int, order: str = "<", step: float = 0.1, extra: bytes = b"", extras: int = 0
) -> bytes:
    """Metadata of one float64 channel of the group ``g``."""
    head = text(b"/'g'/'" + name + b"'", order) + struct.pack(f"{order}IIIQ", 20, 10, 1, count)
    properties = text(UNIT, order) + struct.pack(f"{order}I", 0x20) + text(b"m/s^2", order)
    properties += text(RATE, order) + struct.pack(f"{order}Id", 10, step)
    return head + struct.pack(f"{order}I", 2 + extras) + properties + extra


def segment(flags: int, metadata: bytes, data: bytes) -> bytes:
    order = ">" if flags & 64 else "<"
    lead = b"TDSm" + struct.pack("<I", flags) + struct.pack(f"{order}I", 4713)
    return lead + struct.pack(f"{order}QQ", len(metadata) + len(data), len(metadata)) + metadata + data


def test_a_file_of_the_reference_library_reads_to_the_numbers_written() -> None:
    """File written by npTDMS 1.13 in three segments: y_i(k) = sin(0.1 k (i + 1)) + i, in g."""
    record = read_record(DATA / "nptdms.tdms")
    k = np.arange(60)
    np.testing.assert_allclose(record.data[0], np.sin(0.1 * k) * 9.80665, rtol=1e-15, atol=1e-15)
    np.testing.assert_allclose(
        record.data[1], (np.sin(0.2 * k) + 1.0) * 9.80665, rtol=1e-7
    )  # stored as float32
    assert record.channel_names == ("top_x", "top_y")
    assert record.sample_rate_hz == 20.0
    assert record.start_utc is not None and record.start_utc.isoformat() == "2025-01-01T13:00:00.250000+00:00"
    assert record.metadata == {"turbine": "A3"}


@pytest.mark.parametrize("big_endian", [False, True])
@pytest.mark.parametrize("interleaved", [False, True])
def test_layouts_of_raw_data(big_endian: bool, interleaved: bool, tmp_path: Path) -> None:
    order, flags = (">", 64) if big_endian else ("<", 0)
    flags |= 2 | 4 | 8 | (32 if interleaved else 0)
    y = np.arange(12.0).reshape(2, 6)
    chunks = [y[:, :3], y[:, 3:]]  # two chunks behind one set of metadata
    data = b"".join((c.T if interleaved else c).astype(f"{order}f8").tobytes() for c in chunks)
    objects = struct.pack(f"{order}I", 2) + channel(b"ax", 3, order) + channel(b"ay", 3, order)
    # a segment without metadata repeats the last; the truncated one after it is left out
    raw = segment(flags, objects, data) + segment(flags & ~6, b"", data) + segment(flags & ~6, b"", data[:5])
    (tmp_path / "r.tdms").write_bytes(raw)
    record = read_record(tmp_path / "r.tdms")
    assert np.array_equal(record.data, np.hstack([y, y]))
    assert record.sample_rate_hz == 10.0


def test_a_linear_scale_is_applied(tmp_path: Path) -> None:
    extra = text(b"NI_Scaling_Status") + struct.pack("<I", 0x20) + text(b"unscaled")
    extra += text(b"NI_Number_Of_Scales") + struct.pack("<II", 7, 1)
    extra += text(b"NI_Scale[0]_Scale_Type") + struct.pack("<I", 0x20) + text(b"Linear")
    extra += text(b"NI_Scale[0]_Linear_Slope") + struct.pack("<Id", 10, 2.0)
    extra += text(b"NI_Scale[0]_Linear_Y_Intercept") + struct.pack("<Id", 10, 0.5)
    metadata = struct.pack("<I", 1) + channel(b"ax", 3, extra=extra, extras=5)
    (tmp_path / "r.tdms").write_bytes(segment(14, metadata, np.arange(3.0).tobytes()))
    assert read_record(tmp_path / "r.tdms").data.tolist() == [[0.5, 2.5, 4.5]]


@pytest.mark.parametrize(
    ("metadata", "message"),
    [
        (text(b"/'g'/'a'") + struct.pack("<I", 0x69120000), "holds DAQmx raw data"),
        (text(b"/'g'/'a'") + struct.pack("<IIIQ", 20, 99, 1, 3), "unknown data type.*99"),
        (struct.pack("<I", 1_000_000), "ends before the data it announces"),
    ],
)
def test_what_is_not_understood_is_refused(metadata: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / "r.tdms").write_bytes(segment(14, struct.pack("<I", 1) + metadata, b""))
    with pytest.raises(InputError, match=message):
        read_record(tmp_path / "r.tdms")


def test_slower_channels_are_left_out_and_named(tmp_path: Path) -> None:
    metadata = struct.pack("<I", 3) + channel(b"ax", 4) + channel(b"wind", 2, step=0.2) + channel(b"ay", 4)
    (tmp_path / "r.tdms").write_bytes(segment(14, metadata, np.arange(10.0).tobytes()))
    record = read_record(tmp_path / "r.tdms")
    assert record.sample_rate_hz == 10.0
    assert record.channel_names == ("ax", "ay")
    np.testing.assert_array_equal(record.data, [[0.0, 1.0, 2.0, 3.0], [6.0, 7.0, 8.0, 9.0]])
    assert record.metadata["remarks"] == ["channels at lower rates are left out: wind"]


def test_channels_of_one_rate_are_equally_long(tmp_path: Path) -> None:
    metadata = struct.pack("<I", 2) + channel(b"ax", 3) + channel(b"ay", 2)
    (tmp_path / "r.tdms").write_bytes(segment(14, metadata, np.arange(5.0).tobytes()))
    with pytest.raises(InputError, match="data: channels differ in length"):
        read_record(tmp_path / "r.tdms")
