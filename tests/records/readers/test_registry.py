from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record, read_record, write_record
from jackettwin.records.readers import formats

WRITABLE = [form.extensions[0] for form in formats() if form.write]


def edit(path: Path, **changes: object) -> None:
    """Change keys of a JSON file; None removes a key."""
    data = json.loads(path.read_text()) | changes
    path.write_text(json.dumps({key: value for key, value in data.items() if value is not None}))


@pytest.mark.parametrize("extension", WRITABLE)
def test_what_is_written_is_read_back_whole(extension: str, record: Record, tmp_path: Path) -> None:
    path = tmp_path / f"r{extension}"
    write_record(record, path)
    back = read_record(path)
    assert np.array_equal(back.data, record.data, equal_nan=True)  # every format keeps float64
    assert back.channels == record.channels
    assert (back.sample_rate_hz, back.start_utc, back.name) == (12.5, record.start_utc, "r")
    assert back.conditions == record.conditions
    assert back.metadata.items() >= record.metadata.items()
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_failed_write_leaves_the_old_files(record: Record, tmp_path: Path) -> None:
    path = tmp_path / "r.parquet"
    write_record(record, path)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    (tmp_path / "r.json").unlink()
    (tmp_path / "r.json").mkdir()  # the description cannot be put into place
    with pytest.raises(OSError, match="irectory"):
        write_record(record.select(["acc_top_x"]), path)
    (tmp_path / "r.json").rmdir()
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == {"r.parquet": before["r.parquet"]}


def test_shipped_openfast_record_reads_as_the_contract_says() -> None:
    """Two seconds of a ten-minute OpenFAST record, its JSON as it came."""
    record = read_record(Path(__file__).parents[1] / "data" / "pile_U12_s301.parquet")
    assert record.channel_names[:2] == ("acc_top_x", "acc_top_y")
    assert record.sample_rate_hz == 100.0
    assert record.start_utc is not None and record.start_utc.isoformat() == "2025-01-01T13:00:00+00:00"
    assert record.conditions["mean_wind_speed_m_s"] == 12.0
    assert record.metadata["asset"] == "pile"
    assert record.channels[-1].quantity == "wind speed"


def test_units_are_brought_to_si(record: Record, tmp_path: Path) -> None:
    path = tmp_path / "r.parquet"
    write_record(record, path)
    channels = json.loads((tmp_path / "r.json").read_text())["channels"]
    channels["acc_top_x"]["unit"] = "mg"
    edit(tmp_path / "r.json", channels=channels)
    back = read_record(path)
    np.testing.assert_allclose(back.data[0], record.data[0] * 9.80665e-3, rtol=1e-15)
    assert back.channels[0].unit == "m/s^2"


def test_description_chooses_and_orders_channels(record: Record, tmp_path: Path) -> None:
    path = tmp_path / "r.parquet"
    write_record(record, path)
    channels = json.loads((tmp_path / "r.json").read_text())["channels"]
    edit(tmp_path / "r.json", channels={k: channels[k] for k in ("acc_top_y", "acc_top_x")})
    assert read_record(path).channel_names == ("acc_top_y", "acc_top_x")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sample_rate_hz": None}, "sample rate is missing.*sample_rate_hz.*r.json"),
        ({"sample_rate_hz": -5}, r"r.json: sample_rate_hz: .*got -5.*> 0"),
        ({"sample_rate_hz": "fast"}, "r.json: sample_rate_hz"),
        (
            {"sample_rate_hz": None, "sample_rate_Hz": 5},
            "looks like a known one.*did you mean 'sample_rate_hz'",
        ),
        ({"start_utc": "yesterday"}, "start_utc: is not an ISO 8601 time.*yesterday"),
        ({"channels": {"acc_top_z": {}}}, "described but not in the data file.*did you mean 'acc_top_"),
        ({"channels": {"acc_top_x": {"unit": "m/s^3"}}}, "channels.acc_top_x"),
        (
            {"channels": {"acc_top_x": {"quantity": "acceleration", "unit": "m/s^3"}}},
            r"channels.acc_top_x.unit: wrong unit.*m/s\^3.*allowed",
        ),
        (
            {"channels": {"acc_top_x": {"quantity": "accelaration", "unit": "g"}}},
            "unknown quantity.*did you mean 'acceleration'",
        ),
        ({"channels": {"acc_top_x": {"quantity": "acceleration"}}}, "acc_top_x.unit: unit is missing"),
        ({"channels": {"acc_top_x": {"unit": "g", "heigth_m": 3}}}, "did you mean 'height_m'"),
        ({"channels": {"acc_top_x": {"unit": "g", "direction": [1, 0]}}}, "channels.acc_top_x.direction"),
        ({"channels": ["acc_top_x"]}, "r.json: channels"),
    ],
)
def test_wrong_descriptions_are_refused(
    changes: dict[str, object], message: str, record: Record, tmp_path: Path
) -> None:
    path = tmp_path / "r.parquet"
    write_record(record, path)
    edit(tmp_path / "r.json", **changes)
    with pytest.raises(InputError, match=message) as caught:
        read_record(path)
    assert caught.value.file is not None
    assert caught.value.remedy or caught.value.allowed


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.parquet", None, "no such file"),
        ("r.parquet", b"", "is empty"),
        ("r.parquet", b"PAR1 not really", "is not readable as Parquet"),
        ("r.npz", b"PK not really", "is not readable as NumPy archive"),
        ("r.xyz", b"1", "unknown record format.*allowed: .parquet"),
        ("r.json", b"{}", "give the data file"),
    ],
)
def test_unreadable_files_are_refused(name: str, content: bytes | None, message: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_record(tmp_path / name)
    assert str(tmp_path) not in caught.value.problem  # a service shows it to strangers


def test_missing_file_suggests_its_neighbour(record: Record, tmp_path: Path) -> None:
    write_record(record, tmp_path / "pile_U12.parquet")
    with pytest.raises(InputError, match=r"no such file; did you mean 'pile_U12.parquet'"):
        read_record(tmp_path / "pile_u12.parquet")


@pytest.mark.parametrize("text", ["{", "[]", '{"sample_rate_hz": NaN}', "[" * 100_000])
def test_broken_json_is_refused(text: str, record: Record, tmp_path: Path) -> None:
    write_record(record, tmp_path / "r.parquet")
    (tmp_path / "r.json").write_text(text)
    with pytest.raises(InputError, match=r"r\.json: is not"):
        read_record(tmp_path / "r.parquet")


def test_constant_and_empty_channels_are_read_for_quality_to_judge(record: Record, tmp_path: Path) -> None:
    data = record.data.copy()
    data[0], data[1] = 3.0, np.nan
    write_record(Record(data, 12.5, record.channels), tmp_path / "r.parquet")
    back = read_record(tmp_path / "r.parquet").data
    assert (back[0] == 3.0).all() and np.isnan(back[1]).all()


def test_one_description_serves_a_folder(record: Record, tmp_path: Path) -> None:
    """A record's own JSON goes before it, and it may choose channels."""
    for name in ("a", "b"):
        write_record(record, tmp_path / f"{name}.parquet")
    (tmp_path / "a.json").rename(tmp_path / "records.json")
    assert read_record(tmp_path / "a.parquet").channels == record.channels
    (tmp_path / "records.json").write_text(
        '{"sample_rate_hz": 12.5, "channels": {"acc_top_x": {"unit": "g", "height_m": 90.0}}}',
        encoding="utf-8",
    )
    assert [c.height_m for c in read_record(tmp_path / "a.parquet").channels] == [90.0]
    assert read_record(tmp_path / "b.parquet").channels == record.channels
