"""Times as tables of other people hold them: the same instants, whatever they are called and written like."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np
import pytest

from jackettwin.change.table_times import table_times
from jackettwin.errors import InputError

WHEN = [datetime(2024, 1, 9, 0, 30, tzinfo=UTC) + timedelta(hours=12 * i) for i in range(60)]
TRUE = np.array([t.replace(tzinfo=None) for t in WHEN], "datetime64[ms]")


def written(way: str) -> np.ndarray:
    return np.array([t.strftime(way) for t in WHEN])


@pytest.mark.parametrize(
    "way",
    ["%Y-%m-%dT%H:%M:%SZ", "%Y-%m-%d %H:%M", "%d.%m.%Y %H:%M", "%d/%m/%Y %H:%M:%S", "%m/%d/%Y %H:%M",
     "%Y/%m/%d %H:%M:%S.%f", "%d-%b-%Y %I:%M:%S %p", "%Y%m%dT%H%M%S"],
)  # fmt: skip
@pytest.mark.parametrize("name", ["time_utc", "Date/Time", "Zeit", ""])
def test_words(name: str, way: str) -> None:
    names, found, _ = table_times({"f1": np.ones(60), name: written(way)})
    assert names == (name,)
    np.testing.assert_array_equal(found, TRUE)


@pytest.mark.parametrize("unit", [1.0, 1e3, 1e6, 1e9])
def test_unix_times_of_any_unit(unit: float) -> None:
    seconds = np.array([t.timestamp() for t in WHEN])
    np.testing.assert_array_equal(table_times({"timestamp": unit * seconds})[1], TRUE)


def test_serial_days_of_excel_and_matlab() -> None:
    """Excel's day 45300 is 2024-01-09, MATLAB's datenum of it 739260."""
    for first in (45300.0, 739260.0):
        days = first + np.arange(60) / 2.0 + 0.5 / 24.0
        np.testing.assert_array_equal(table_times({"time": days})[1], TRUE)


def test_a_date_and_a_clock_in_two_columns() -> None:
    for names in (("Date", "Time"), ("Time", "Date")):
        cells = {"Date": written("%d.%m.%Y"), "Time": written("%H:%M")}
        used, found, _ = table_times({name: cells[name] for name in names})
        assert used == ("Date", "Time")
        np.testing.assert_array_equal(found, TRUE)


def test_years_months_days_and_hours_in_columns_of_their_own() -> None:
    parts = {
        name: np.array([float(getattr(t, name)) for t in WHEN]) for name in ("year", "month", "day", "hour")
    }
    parts["minute"] = np.full(60, 30.0)
    names, found, _ = table_times({"f1": np.ones(60), **parts})
    assert names == ("year", "month", "day", "hour", "minute")
    np.testing.assert_array_equal(found, TRUE)


def test_days_and_months_that_may_be_either_are_refused() -> None:
    either = np.array(["01/02/2024 12:00", "02/03/2024 12:00", "03/04/2024 12:00"])
    with pytest.raises(InputError, match="either way"):
        table_times({"time": either})


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        (["2024-01-01", "2024-01-02", "soon"], "is no time"),
        (["01.01.2024", "45.01.2024"], "is no time"),
        (["2024-01-01", ""], "is no time"),
        (["2024-01-02", "2024-01-01"], "not sorted"),
        ([1.0, 2.0], "origin is not known"),
    ],
)
def test_what_is_no_time_is_named(cells: list, said: str) -> None:
    with pytest.raises(InputError, match=said) as refused:
        table_times({"time": np.array(cells)})
    assert refused.value.field == "time"


def test_a_table_without_times_is_refused() -> None:
    with pytest.raises(InputError, match="no column of times"):
        table_times({"f1": np.ones(3), "label": np.array(["a", "b", "c"])})


BERLIN = ZoneInfo("Europe/Berlin")


def shown_in_berlin(first: str, hours: int, way: str) -> tuple[np.ndarray, np.ndarray]:
    """Return what a clock in Berlin shows every 20 minutes, for two modes each, and the same in UTC."""
    true = np.repeat(np.datetime64(first, "ms") + np.arange(3 * hours) * np.timedelta64(20, "m"), 2)
    local = [t.replace(tzinfo=UTC).astimezone(BERLIN) for t in true.tolist()]
    return np.array([t.strftime(way) for t in local]), true


@pytest.mark.parametrize("way", ["%d.%m.%Y %H:%M", "%Y-%m-%d %H:%M:%S"])
@pytest.mark.parametrize("first", ["2023-10-28T21:00", "2024-03-30T21:00", "2024-07-01T00:00"])
def test_a_clock_that_is_put_back_and_forward_is_read_in_its_zone(first: str, way: str) -> None:
    """The hour that is there twice: the second one begins where the clock goes back."""
    cells, true = shown_in_berlin(first, 6, way)
    _, found, said = table_times({"Zeit": cells}, BERLIN)
    np.testing.assert_array_equal(found, true)
    assert said == ()


def test_a_clock_that_is_put_back_asks_for_its_zone() -> None:
    cells, _ = shown_in_berlin("2023-10-28T21:00", 6, "%Y-%m-%d %H:%M")
    with pytest.raises(InputError, match="not sorted") as refused:
        table_times({"Zeit": cells})
    assert "--timezone" in refused.value.remedy
    once = cells[: len(cells) // 2 + 3]  # nobody knows which of the two it was
    assert "summer time" in table_times({"Zeit": once}, BERLIN)[2][0]
    assert "taken as UTC" in table_times({"Zeit": once})[2][0]
    assert table_times({"time_utc": once})[2] == ()


def test_a_zone_is_refused_where_it_cannot_be() -> None:
    with pytest.raises(InputError, match="the clock was not"):
        table_times({"time": np.array(["2024-03-31 02:10", "2024-03-31 02:20"])}, BERLIN)
    for name, cells in (("time_utc", WHEN), ("time", [f"{t:%Y-%m-%dT%H:%M}Z" for t in WHEN])):
        with pytest.raises(InputError, match="say their zone"):
            table_times({name: np.array([str(t) for t in cells])}, BERLIN)
