from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import read_record

NAMES = ["Time", "YawBrTAxp", "YawBrTAyp", "RotSpeed", "Wind1VelX", "RootMxb1"]
UNITS = ["(s)", "(m/s^2)", "(m/s^2)", "(rpm)", "(m/s)", "(kN-m)"]


def samples() -> np.ndarray:
    k = np.arange(200.0)
    rows = [
        0.05 * k,
        np.sin(0.1 * k),
        np.cos(0.1 * k),
        5.0 + 0 * k,
        10 + np.sin(0.02 * k),
        1e4 * np.cos(0.3 * k),
    ]
    return np.vstack(rows)


def binary(identifier: int, constant_scale: float = 1.0) -> bytes:
    """Write samples as WrBinFAST of the NWTC library does."""
    y = samples()
    n, m = len(y) - 1, y.shape[1]
    low, span = y[1:].min(axis=1), np.ptp(y[1:], axis=1)
    slope = np.where(span > 0.0, 65535.0 / np.where(span > 0.0, span, 1.0), constant_scale).astype("<f4")
    offset = np.where(span > 0.0, -32768.0 - low * slope, -low * slope).astype("<f4")
    width = 20 if identifier == 4 else 10
    parts = [struct.pack("<h", identifier)]
    parts += [struct.pack("<h", width)] if identifier == 4 else []
    parts += [struct.pack("<ii", n, m)]
    parts += [struct.pack("<dd", 1000.0, 0.0) if identifier == 1 else struct.pack("<dd", 0.0, 0.05)]
    parts += [slope.tobytes(), offset.tobytes()] if identifier != 3 else []
    parts += [struct.pack("<i", 6), b"a test"]
    parts += [text.ljust(width).encode() for text in NAMES + UNITS]
    parts += [np.round(y[0] * 1000.0).astype("<i4").tobytes()] if identifier == 1 else []
    packed = y[1:].T if identifier == 3 else np.round(np.nan_to_num(y[1:].T * slope + offset))
    return b"".join([*parts, packed.astype("<f8" if identifier == 3 else "<i2").tobytes()])


@pytest.mark.parametrize("identifier", [1, 2, 3, 4])
def test_every_binary_layout_reads(identifier: int, tmp_path: Path) -> None:
    (tmp_path / "r.outb").write_bytes(binary(identifier))
    record = read_record(tmp_path / "r.outb")
    y = samples()[1:]
    y[2] *= 2 * np.pi / 60
    y[4] *= 1e3
    # int16 over the span of a channel: half a step, and the float32 scales
    step = 1e-12 if identifier == 3 else 2.0 / 65535
    np.testing.assert_allclose(
        record.data / np.abs(y).max(axis=1)[:, None], y / np.abs(y).max(axis=1)[:, None], atol=step
    )
    assert record.sample_rate_hz == 20.0
    assert record.channel_names == tuple(NAMES[1:])
    assert [c.quantity for c in record.channels] == [
        "acceleration",
        "acceleration",
        "rotor speed",
        "wind speed",
        "moment",
    ]
    assert record.channels[1].direction == (0.0, 1.0, 0.0)
    assert (record.channels[2].unit, record.channels[4].unit) == ("rad/s", "N m")
    assert record.metadata["source"] == "a test"


def test_a_constant_channel_with_an_undefined_scale_is_zero_not_nan(tmp_path: Path) -> None:
    (tmp_path / "r.outb").write_bytes(binary(4, constant_scale=float("nan")))
    assert not read_record(tmp_path / "r.outb").data[2].any()


def out_text() -> str:
    head = "\nPredictions were generated on 1-Jan-2025 using OpenFAST v5\n\n\n\n\n"
    lines = ["\t".join(NAMES), "\t".join(UNITS)] + [
        "\t".join(f"{x:.10e}" for x in row) for row in samples().T
    ]
    return head + "\n".join(lines) + "\n"


def test_text_output_reads_and_a_cut_last_row_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "r.out").write_text(out_text()[:-40])
    record = read_record(tmp_path / "r.out")
    np.testing.assert_allclose(record.data[0], np.sin(0.1 * np.arange(199)), atol=1e-10)  # ten decimals
    assert record.sample_rate_hz == 20.0
    assert "OpenFAST v5" in record.metadata["source"]


def test_a_binary_file_by_a_text_name_reads(tmp_path: Path) -> None:
    (tmp_path / "r.out").write_bytes(binary(4))
    assert read_record(tmp_path / "r.out").data.shape == (5, 200)


def test_stars_of_fortran_are_missing_samples(tmp_path: Path) -> None:
    (tmp_path / "r.out").write_text(out_text().replace("\t1.0000000000e+00\t", "\t***********\t", 1))
    assert np.isnan(read_record(tmp_path / "r.out").data).sum() == 1


@pytest.mark.parametrize(
    ("name", "raw", "message"),
    [
        ("r.outb", b"\x09\x00" + bytes(60), "identifier: is not an OpenFAST binary.*got 9.*1 to 4"),
        ("r.outb", binary(4)[:-1], "ends before the data it announces"),
        ("r.outb", binary(2)[:2] + b"\xff\xff\xff\xff" + binary(2)[6:], "ends before the data it announces"),
        ("r.out", b"nothing here\n", "no line of names starting with Time"),
        ("r.out", out_text().replace("(rpm)\t", "").encode(), "rows, names and units differ"),
    ],
)
def test_damaged_outputs_are_refused(name: str, raw: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(raw)
    with pytest.raises(InputError, match=message):
        read_record(tmp_path / name)
