from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record, read_record
from jackettwin.records.readers.channels import FileDefaults


def read_text(text: str, tmp_path: Path, encoding: str = "utf-8") -> Record:
    path = tmp_path / "r.csv"
    path.write_bytes(text.encode(encoding))
    return read_record(path)


ROWS = [(0.0, 1.5, -0.25), (0.1, 2.5, 0.5), (0.2, -3.5, 1.0), (0.3, 0.5, 2.0)]


def table(delimiter: str, decimal: str, units: bool) -> str:
    lines = [delimiter.join(["time", "acc_x", "acc_y"])]
    lines += [delimiter.join(["s", "g", "m/s^2"])] if units else []
    lines += [delimiter.join(str(x).replace(".", decimal) for x in row) for row in ROWS]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("delimiter", "decimal"),
    [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), ("  ", "."), ("|", ".")],
)
def test_every_dialect_reads_the_same(delimiter: str, decimal: str, tmp_path: Path) -> None:
    record = read_text(table(delimiter, decimal, units=True), tmp_path)
    np.testing.assert_allclose(record.data[0], np.array([1.5, 2.5, -3.5, 0.5]) * 9.80665, rtol=1e-15)
    np.testing.assert_allclose(record.data[1], [-0.25, 0.5, 1.0, 2.0], rtol=1e-15)
    assert record.sample_rate_hz == 10.0
    assert [c.direction for c in record.channels] == [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]


@pytest.mark.parametrize("header", ["time [s],acc_x [g],acc_y (m/s²)", '"time","acc_x (g)","acc_y [m/s**2]"'])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_units_in_brackets_in_any_encoding(header: str, encoding: str, tmp_path: Path) -> None:
    text = "\n".join([header] + [",".join(map(str, row)) for row in ROWS])
    record = read_text(text, tmp_path, encoding)
    assert record.channel_names == ("acc_x", "acc_y")
    np.testing.assert_allclose(record.data[0, 0], 1.5 * 9.80665, rtol=1e-15)


def test_rate_in_a_comment_and_other_comments_as_metadata(tmp_path: Path) -> None:
    text = "# logger: 7\n# sample_rate_hz: 50 Hz\nacc_x;acc_y\nm/s^2;m/s^2\n1;2\n3;4\n"
    record = read_text(text, tmp_path)
    assert record.sample_rate_hz == 50.0
    assert record.metadata == {"logger": "7"}


def test_what_a_logger_writes_above_its_table_is_no_table(tmp_path: Path) -> None:
    """Lines of another length than the rows of numbers; a rate among them counts, pairs do not mislead."""
    top = 'Logger: XYZ 4000\nSerial;0815\nSite: "North; 7"\nSample rate: 25,0 Hz\n\n'
    table = "acc_x;acc_y;acc_z\ng;g;g\n" + "".join(f"{k},5;{-k};0\n" for k in range(4))
    record = read_text(top + table, tmp_path)
    assert record.channel_names == ("acc_x", "acc_y", "acc_z")
    assert record.sample_rate_hz == 25.0
    assert record.metadata["Logger"] == "XYZ 4000"
    np.testing.assert_allclose(record.data[0] / 9.80665, [0.5, 1.5, 2.5, 3.5])


def test_a_clock_or_count_of_another_name_is_no_channel(tmp_path: Path) -> None:
    rows = "".join(f"{0.2167 * k:.4f},{k % 3},1\n" for k in range(20))
    record = read_text("epoch,acc_x_g,disp_y_mm\n" + rows, tmp_path)
    assert record.channel_names == ("acc_x_g", "disp_y_mm")
    assert record.sample_rate_hz == pytest.approx(1.0 / 0.2167, rel=1e-3)
    assert record.data[0, 1] == pytest.approx(9.80665)
    assert record.data[1, 1] == pytest.approx(1e-3)
    remarks = " ".join(record.metadata["remarks"])
    assert "column epoch climbs evenly" in remarks
    assert "in g (acc_x_g)" in remarks
    counted = read_text(
        "# fs: 5\nSample,acc_x_g\n" + "".join(f"{k},{k % 3}\n" for k in range(1, 9)), tmp_path
    )
    assert counted.channel_names == ("acc_x_g",)
    assert "column Sample counts rows" in counted.metadata["remarks"][0]


@pytest.mark.parametrize(
    ("heads", "time", "left"),
    [
        ("time,Time_UTC", "{s},2026-03-05T10:00:0{s}Z", "time"),
        ("Time_UTC,t", "2026-03-05T10:00:0{s}Z,{s}", "t"),
        ("nr,elapsed", "{n},{s}", "nr"),
        ("index,time_ms", "{k},{n}", "index"),
    ],
)
def test_a_second_clock_or_a_count_is_told_and_no_channel(
    heads: str, time: str, left: str, tmp_path: Path
) -> None:
    """Ten rows a second; ``nr`` counts hundreds, as milliseconds do."""
    cells = [time.format(k=k, n=100 * k, s=f"{k / 10:.1f}") for k in range(40)]
    record = read_text(
        f"{heads},acc_x_g\n" + "".join(f"{c},{k % 3}\n" for k, c in enumerate(cells)), tmp_path
    )
    assert record.channel_names == ("acc_x_g",)
    assert record.sample_rate_hz == pytest.approx(10.0)
    assert any(f"left out: {left}" in remark for remark in record.metadata["remarks"])
    # pandas writes the index of a table first, without a name
    indexed = read_text(
        ",time_s,acc_x_g\n" + "".join(f"{k},{0.2 * k:.1f},{k % 3}\n" for k in range(8)), tmp_path
    )
    assert indexed.channel_names == ("acc_x_g",) and indexed.sample_rate_hz == pytest.approx(5.0)


def test_words_with_numbers_among_them_are_no_record(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no"):
        read_text("Measured by Bob on turbine 7. Call 0800.\nLogger 3, all fine.\n", tmp_path)
    with pytest.raises(InputError, match="holds no samples"):
        read_text("time [s],acc_x [g]\n", tmp_path)


def test_missing_cells_are_missing_samples(tmp_path: Path) -> None:
    text = "# fs: 5\nacc_x,acc_y\ng,g\n1,\n,NaN\nnull,2\n#N/A,3\n1e999,4\n5\n"
    data = read_text(text, tmp_path).data / 9.80665
    expected = [[1, np.nan, np.nan, np.nan, np.nan, 5], [np.nan, np.nan, 2, 3, 4, np.nan]]
    np.testing.assert_allclose(data, expected, rtol=1e-15)


def test_iso_stamps_give_rate_start_and_gap(tmp_path: Path) -> None:
    stamps = [f"2025-01-01T13:00:00.{ms:03d}+01:00" for ms in (0, 100, 200, 500, 600, 700)]
    text = "timestamp,acc_x [g]\n" + "\n".join(f"{stamp},{i}" for i, stamp in enumerate(stamps))
    record = read_text(text, tmp_path)
    assert record.start_utc is not None and record.start_utc.isoformat() == "2025-01-01T12:00:00+00:00"
    assert record.sample_rate_hz == 10.0
    np.testing.assert_array_equal(np.isnan(record.data[0]), [0, 0, 0, 1, 1, 0, 0, 0])
    assert record.metadata["clock"]["missing"] == 2


@pytest.mark.parametrize(
    ("stamp", "hour"),
    [("02/14/2025 {} AM", 11), ("2/14/2025 {} pm", 23), ("2025-02-14 {}PM", 23), ("14/02/2025 {} AM", 11)],
)
def test_hours_of_half_a_day_are_read_and_quoted_as_they_stand(stamp: str, hour: int, tmp_path: Path) -> None:
    """Midnight and noon are twelve; what cannot be read is quoted as the file has it."""
    first = "02/14/2025 12:00:00 AM"
    rows = [f"{stamp.format(f'11:00:00.{25 * k:02}')},{k}" for k in range(4)]
    record = read_text("\n".join(["time,acc_x [g]", *rows]), tmp_path)
    assert record.start_utc is not None and record.start_utc.isoformat() == f"2025-02-14T{hour}:00:00+00:00"
    midnight = read_text(f"time,acc_x [g]\n{first},1\n{first.replace('0 A', '1 A')},2\n", tmp_path)
    assert midnight.start_utc is not None and midnight.start_utc.hour == 0
    with pytest.raises(InputError, match="line 3: is no time .*got '02/14/2025 13:00:00 AM'"):
        read_text(f"time,acc_x [g]\n{first},1\n02/14/2025 13:00:00 AM,2\n", tmp_path)


@pytest.mark.parametrize(("noon", "digits"), [(45950.5, 6), (45950.5, 10), (739910.5, 10)])
@pytest.mark.parametrize("heading", ["time", "Zeitstempel", "t [d]"])
def test_days_of_a_spreadsheet_are_dates(heading: str, noon: float, digits: int, tmp_path: Path) -> None:
    """Day 45950, MATLAB's 739910, is the 20th of October 2025; six decimals are 0.09 s, a coarse clock."""
    rows = "".join(f"{noon + k / 25 / 86400:.{digits}f},{k % 7}\n" for k in range(500))
    record = read_text(f"{heading},acc_x [g]\n{rows}", tmp_path)
    assert record.sample_rate_hz == pytest.approx(25.0, rel=1e-3)
    assert record.start_utc is not None and record.start_utc.isoformat()[:19] == "2025-10-20T12:00:00"
    assert any("counts days as spreadsheets or MATLAB do" in text for text in record.metadata["remarks"])
    seconds = read_text(f"{heading[:4]}_s,acc_x [g]\n45950.0,1\n45950.04,2\n45950.08,3\n", tmp_path)
    assert (seconds.sample_rate_hz, seconds.start_utc) == (25.0, None)


def test_times_without_a_unit_that_are_no_seconds_are_refused(tmp_path: Path) -> None:
    """Milliseconds and hours; with their unit they are read."""
    for step, unit in ((40.0, "ms"), (0.04 / 3600, "h")):
        rows = "".join(f"{step * k:.9f},{k % 7}\n" for k in range(30))
        assert read_text(f"time [{unit}],acc_x [g]\n{rows}", tmp_path).sample_rate_hz == pytest.approx(25.0)
        with pytest.raises(InputError, match=r"column of times has no unit.*time \[ms\]"):
            read_text(f"time,acc_x [g]\n{rows}", tmp_path)


@pytest.mark.parametrize("day", ["2025-02-14T", "2025/02/14 ", "14.02.2025 ", "14/02/2025 ", "02/14/2025 "])
def test_dates_of_loggers_are_read(day: str, tmp_path: Path) -> None:
    """With strokes where only one of the two numbers can be a month."""
    rows = [f"{day}13:00:00,{250 + 50 * k};{k},5" for k in range(5)]
    record = read_text("\n".join(["Zeit;acc_x [g]", *rows]), tmp_path)
    assert record.start_utc is not None and record.start_utc.isoformat() == "2025-02-14T13:00:00.250000+00:00"
    assert record.sample_rate_hz == 20.0
    np.testing.assert_allclose(record.data[0] / 9.80665, np.arange(5) + 0.5, rtol=1e-15)


def test_date_and_time_in_two_columns_are_one_stamp(tmp_path: Path) -> None:
    """From one day into the next, with and without a zone."""
    clocks = [("17.03.2025", "23:59:59,950"), ("18.03.2025", "00:00:00,000"), ("18.03.2025", "0:00:00,050")]
    for zone, hour in (("", "23"), ("+01:00", "22")):
        rows = [f"{k};{day};{clock}{zone};{k},5" for k, (day, clock) in enumerate(clocks)]
        record = read_text("\n".join(["Nr;Datum;Uhrzeit;acc_x [g]", *rows]), tmp_path)
        assert record.start_utc is not None
        assert record.start_utc.isoformat() == f"2025-03-17T{hour}:59:59.950000+00:00"
        assert record.sample_rate_hz == 20.0
        np.testing.assert_allclose(record.data[0] / 9.80665, np.arange(3) + 0.5, rtol=1e-15)


def test_a_time_of_day_alone_gives_the_rate_and_no_start(tmp_path: Path) -> None:
    clocks = ("23:59:59.9", "00:00:00.0", "00:00:00.1", "00:00:00.3")
    rows = [f"{clock},{k}" for k, clock in enumerate(clocks)]
    record = read_text("\n".join(["Uhrzeit,acc_x [g]", *rows]), tmp_path)
    assert record.start_utc is None and record.sample_rate_hz == 10.0
    np.testing.assert_array_equal(np.isnan(record.data[0]), [0, 0, 0, 1, 0])
    with pytest.raises(InputError, match="line 6: is not a time of day.*noon"):
        read_text("\n".join(["Uhrzeit,acc_x [g]", *rows, "noon,4"]), tmp_path)


def test_plain_times_and_others_are_the_same_times(tmp_path: Path) -> None:
    """Times of one plain form are read at once, others one by one; an empty or impossible one is refused."""
    seconds = [f"{0.1 * k:06.3f}" for k in range(5)]
    texts = {
        form: "\n".join(["time;acc_x [g]", *(form.format(s) + f";{k},5" for k, s in enumerate(seconds))])
        for form in ("2025-06-01 12:00:{}Z", "2025-06-01T12:00:{}", "2025-06-01T14:00:{}+02:00")
    }
    starts = {read_text(text, tmp_path).start_utc for text in texts.values()}
    assert len(starts) == 1
    for wrong in ("", "2025-06-31 12:00:00.400"):
        rows = [*(f"2025-06-01 12:00:{s};1" for s in seconds[:4]), f"{wrong};1"]
        with pytest.raises(InputError, match="line 6"):
            read_text("\n".join(["time;acc_x [g]", *rows]), tmp_path)


def test_the_first_day_settles_the_order_of_the_next(tmp_path: Path) -> None:
    rows = ["31/01/2025 23:59:59.95,1", "01/02/2025 00:00:00.00,2", "01/02/2025 00:00:00.05,3"]
    record = read_text("\n".join(["time,acc_x [g]", *rows]), tmp_path)
    assert record.sample_rate_hz == 20.0 and record.data.shape == (1, 3)


def test_ambiguous_dates_are_refused(tmp_path: Path) -> None:
    """Whatever the column is called, and in a column beside that of the time of day."""
    for name in ("time", "logged at", ""):
        with pytest.raises(InputError, match=r"date is ambiguous.*01/02/2025.*2025-02-01 or 2025-01-02"):
            read_text(f"{name},acc_x [g]\n01/02/2025 13:00:00,1\n01/02/2025 13:00:01,2\n", tmp_path)
    rows = "".join(f"02/03/2026,13:00:0{k},{k % 3}\n" for k in range(9))
    record = read_text("day,clock,acc_x [g]\n" + rows, tmp_path)
    assert (record.sample_rate_hz, record.start_utc) == (1.0, None)
    assert any("02/03/2026 may begin with its day" in text for text in record.metadata["remarks"])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,2\n3,1\n", "sample rate is missing"),
        ("# fs: 5\nacc_x\ng\n1\nx1\n3\n", r"line 5, channel acc_x: is not a number \(got 'x1'\)"),
        ("# fs: fast\nacc_x\ng\n1\n2\n", "fs: is not a rate.*fast"),
        ("# fs: 5\nacc_x,acc_x\ng,g\n1,2\n3,4\n", "channel name is given twice.*acc_x"),
        ("# fs: 5\nacc_x,,acc_y\ng,g,g\n1,2,3\n", "column 2: a column has no name"),
        ("# fs: 5\nacc_x\n1\n2\n", "channels.acc_x.unit: unit is missing"),
        ("acc_x\ng\n1\n2\n", "sample rate is missing"),
        ("# fs: 5\nacc_x\ng\n1\n", "holds no samples"),
        ("time,acc_x\ns,g\n0,1\n1,2\n1,2\n0,3\n", "time stamps do not increase"),
        ("# fs: 5\ntime,acc_x\ns,g\n0,1\n1,2\n2,2\n3,3\n", "contradicts the time stamps"),
        ("time\ns\n0\n1\n", "holds no channels"),
        ("\x00\x01\x02", r"r\.csv"),
    ],
)
def test_wrong_text_is_refused_with_its_place(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message) as caught:
        read_text(text, tmp_path)
    assert str(caught.value.file).endswith("r.csv")


def test_an_index_without_a_name_is_a_count_or_a_time(tmp_path: Path) -> None:
    counted = read_text("# fs: 5\n,acc_x [g]\n0,1\n1,2\n2,3\n", tmp_path)
    assert counted.channel_names == ("acc_x",) and counted.sample_rate_hz == 5.0
    rows = [f"2025-01-01 00:00:00.{2 * k},{k}" for k in range(4)]
    dated = read_text("\n".join([",acc_x [g]", *rows]), tmp_path)
    assert dated.channel_names == ("acc_x",) and dated.sample_rate_hz == 5.0


def test_a_column_of_words_is_left_out_and_named(tmp_path: Path) -> None:
    record = read_text("time [s],acc_x [g],state\n0,1,idling\n0.2,2,idling\n0.4,3,parked\n", tmp_path)
    assert record.channel_names == ("acc_x",)
    assert record.metadata["remarks"] == ["columns without numbers are left out: state"]


def test_columns_without_names_are_numbered(tmp_path: Path) -> None:
    path = tmp_path / "bare.txt"
    path.write_text("1.5e0 2\n-1 3\n0.5 1\n")
    record = read_record(path, FileDefaults(sample_rate_hz=20.0, unit="g"))
    assert record.channel_names == ("column_1", "column_2")
    assert {c.quantity for c in record.channels} == {"acceleration"}
    np.testing.assert_allclose(record.data[0], np.array([1.5, -1.0, 0.5]) * 9.80665, rtol=1e-15)
    assert record.sample_rate_hz == 20.0
    path.write_text("0.0 2\n0.1 3\n0.2 1\n")
    timed = read_record(path, FileDefaults(unit="mm/s"))
    assert (timed.channel_names, timed.sample_rate_hz) == (("column_2",), 10.0)
    assert timed.channels[0].quantity == "velocity"


def test_what_a_file_says_wins_over_what_is_assumed(tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    path.write_text("# fs: 5\nacc_x [g],ch2,wind\n1,2,3\n2,3,4\n")
    record = read_record(path, FileDefaults(sample_rate_hz=20.0, unit="mm/s"))
    assert record.sample_rate_hz == 5.0
    assert [c.quantity for c in record.channels] == ["acceleration", "velocity", "other"]


def test_a_table_of_a_campbell_logger_reads(tmp_path: Path) -> None:
    text = (
        '"TOA5","CR6","CR6","1234","CR6.Std.10","CPU:prog.CR6","5555","fast"\n'
        '"TIMESTAMP","RECORD","Acc_X"\n"TS","RN","g"\n"","","Smp"\n'
        '"2024-03-01 12:00:00",0,0.5\n"2024-03-01 12:00:00.1",1,0.25\n"2024-03-01 12:00:00.2",2,-1\n'
    )
    record = read_text(text, tmp_path).select(["Acc_X"])
    np.testing.assert_allclose(record.data[0], np.array([0.5, 0.25, -1.0]) * 9.80665, rtol=1e-15)
    assert record.sample_rate_hz == pytest.approx(10.0)
    assert record.start_utc is not None and record.start_utc.hour == 12


def test_a_unit_in_the_name_of_the_time(tmp_path: Path) -> None:
    record = read_text(
        "timestamp_ms,acc_x [g]\n1709290800000,1\n1709290800050,2\n1709290800100,3\n", tmp_path
    )
    assert record.sample_rate_hz == pytest.approx(20.0)
    assert record.start_utc is not None and record.start_utc.year == 2024


def test_decimal_commas_between_commas_are_told_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"r\.csv: line 2: decimal commas and commas.*semicolon between"
    ) as e:
        read_text("time,acc_x,acc_y\n0,0,1,5,-0,25\n0,1,2,5,0,5\n", tmp_path)
    assert e.value.allowed == "3 cells: time, acc_x, acc_y"


def test_rows_longer_than_the_header_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 3: row has more cells than there are names"):
        read_text("time,acc_x,acc_y,acc_z\n0.0,1,2,3\n0.1,1,2,3,4\n", tmp_path)


@pytest.mark.parametrize(
    "stamps",
    [
        ("2025-01-01T12:00:00Z", "2025-01-01T12:00:01Z", "2025-01-01T12:00:02Z"),
        ("2025-01-01 13:00:00+01:00", "2025-01-01 13:00:01+01:00", "2025-01-01 13:00:02+01:00"),
        ("2025/01/01 12:00:00.000", "2025/01/01 12:00:01.000", "2025/01/01 12:00:02.000"),
        ("01.01.2025 12:00:00", "01.01.2025 12:00:01", "01.01.2025 12:00:02"),
    ],
)
def test_stamps_with_and_without_zone(stamps: tuple[str, ...], tmp_path: Path) -> None:
    rows = "\n".join(f"{stamp};{k}" for k, stamp in enumerate(stamps))
    record = read_text(f"time;acc_x [g]\n{rows}\n", tmp_path)
    assert record.sample_rate_hz == 1.0
    assert record.start_utc is not None and record.start_utc.isoformat() == "2025-01-01T12:00:00+00:00"


def test_a_clock_put_back_without_a_zone_is_refused(tmp_path: Path) -> None:
    """Local time at the end of summer: half of the stamps come twice."""
    rows = [f"2025-10-26T02:{m:02d}:{s:02d},1" for _ in range(2) for m in range(60) for s in (0, 30)]
    with pytest.raises(InputError, match="put back by an hour.*--timezone"):
        read_text("time,acc_x [g]\n" + "\n".join(rows) + "\n", tmp_path)


def test_numbers_that_stand_for_none_become_gaps(tmp_path: Path) -> None:
    values = ["0.1", "-9999", "0.3", "-9999.0", "0.2", "-0.1"]
    text = "time,acc_x [g],power [kW]\n" + "".join(
        f"{0.1 * k:.1f},{v},{8000 + 400 * k if k < 5 else 9999}\n" for k, v in enumerate(values)
    )
    record = read_text(text, tmp_path)
    assert np.isnan(record.data[0]).tolist() == [False, True, False, True, False, False]
    assert np.isfinite(record.data[1]).all()
    assert record.metadata["remarks"] == [
        "acc_x: 2 samples read -9999, a sign for no value; declared missing"
    ]
