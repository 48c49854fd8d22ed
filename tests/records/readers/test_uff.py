from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record, read_record, write_record

DATA = Path(__file__).parents[1] / "data"


@pytest.mark.parametrize(("kind", "rows"), [("text", [0, 1]), ("binary", [1])])
def test_files_of_the_reference_library_read_to_the_numbers_written(kind: str, rows: list[int]) -> None:
    """Files written by pyuff 2.5.8 (whose binary form keeps one set): y_i(k) = sin(0.1 k (i + 1)) + i."""
    record = read_record(DATA / f"pyuff_{kind}.uff")
    k = np.arange(60)
    # the text form keeps eleven decimals
    np.testing.assert_allclose(record.data, [np.sin(0.1 * k * (i + 1)) + i for i in rows], atol=1e-11)
    assert record.channel_names == tuple(f"top_{'xy'[i]}" for i in rows)
    assert record.sample_rate_hz == 20.0
    for i, channel in zip(rows, record.channels, strict=True):
        assert channel.direction == ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0))[i]
        assert (channel.quantity, channel.unit, channel.node) == ("acceleration", "m/s^2", str(i + 1))


def test_the_file_alone_keeps_what_the_format_can_hold(record: Record, tmp_path: Path) -> None:
    write_record(record, tmp_path / "r.uff")
    (tmp_path / "r.json").unlink()
    back = read_record(tmp_path / "r.uff")
    assert np.array_equal(back.data, record.data, equal_nan=True)
    assert (back.sample_rate_hz, back.start_utc) == (record.sample_rate_hz, record.start_utc)
    assert [c.direction for c in back.channels] == [c.direction for c in record.channels]
    assert back.channels[2].quantity == "wind speed"  # guessed from the name and the unit


def test_other_data_sets_and_doubled_marks_are_passed_over(tmp_path: Path) -> None:
    other = b"    -1\n   151\nmodel file\n    -1\n    -1\n"
    (tmp_path / "r.uff").write_bytes(other + (DATA / "pyuff_text.uff").read_bytes())
    assert read_record(tmp_path / "r.uff").data.shape == (2, 60)


def test_a_shared_title_gets_numbers(tmp_path: Path) -> None:
    raw = (DATA / "pyuff_text.uff").read_bytes().replace(b"top_y", b"top_x")
    (tmp_path / "r.uff").write_bytes(raw)
    record = read_record(tmp_path / "r.uff")
    assert record.channel_names == ("top_x_1", "top_x_2")
    assert record.metadata["remarks"] == [
        "2 data sets are called 'top_x': numbered top_x_1 to top_x_2 in their order"
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"    1         0 ", b"    4         0 ", "holds no time response"),
        (
            b"         4        60         1",
            b"         6        60         1",
            "not an evenly sampled real signal",
        ),
        (
            b"         4        60         1",
            b"         4        60         0",
            "not an evenly sampled real signal",
        ),
        (b"         4        60         1", b"         4        x0         1", "is not a whole number"),
        (
            b"         4        60         1",
            b"         4        90         1",
            "fewer values than it announces",
        ),
        (b"\n    -1", b"\n      ", "not closed|holds no time response"),
    ],
)
def test_damaged_files_are_refused(old: bytes, new: bytes, message: str, tmp_path: Path) -> None:
    raw = (DATA / "pyuff_text.uff").read_bytes()
    assert old in raw
    (tmp_path / "r.uff").write_bytes(raw.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_record(tmp_path / "r.uff")


def test_a_sample_that_spells_the_end_mark_ends_nothing(record: Record, tmp_path: Path) -> None:
    write_record(record, tmp_path / "r.uff")
    raw = (tmp_path / "r.uff").read_bytes()
    at = raw.index(record.data[1].tobytes()) + 800
    (tmp_path / "r.uff").write_bytes(raw[:at] + b"\n    -1\n" + raw[at + 8 :])
    assert read_record(tmp_path / "r.uff").data.shape == record.data.shape


def test_a_file_cut_off_is_refused_not_read_in_part(record: Record, tmp_path: Path) -> None:
    write_record(record, tmp_path / "r.uff")
    raw = (tmp_path / "r.uff").read_bytes()
    (tmp_path / "r.uff").write_bytes(raw[: len(raw) * 5 // 6])
    with pytest.raises(InputError, match="cut off"):
        read_record(tmp_path / "r.uff")
