"""What records show, as the table that ``jackettwin watch`` reads: the way from records to a watch."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from observations import BEGUN, observation, seen

from jackettwin.change.modal_table import read_modal_table
from jackettwin.change.table_monitoring import watch_table
from jackettwin.cli import main
from jackettwin.study.modes_in_time import rows_of_days, rows_of_records, write_modes_in_time
from jackettwin.twin import TwinModel, TwinState, advance_all


def test_what_records_show_is_watched_by_the_command(tmp_path: Path) -> None:
    """Four records a day of two modes under a temperature; both lose 1 % on day 75."""
    records = seen(90, step=-0.01)
    path = tmp_path / "modes_in_time.csv"
    write_modes_in_time(rows_of_records(reversed(records)), path)
    done = CliRunner().invoke(main, ["watch", str(path), "--baseline-days", "60", "--json"])
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    (alarm,) = document["alarms"]
    first = np.datetime64("2025-01-01") + BEGUN
    assert str(first) <= alarm["time_utc"][:10] <= str(first + 8)
    assert alarm["size_interval_90"][0] < -0.01 < alarm["size_interval_90"][1]
    assert set(document["quantities"]["mode_1"]["explained_by"]) == {
        "mean_wind_speed_m_s", "air_temperature_c", "slow, unexplained", "noise"
    }  # fmt: skip


def test_the_table_holds_what_the_records_say(tmp_path: Path) -> None:
    records = seen(2)
    path = tmp_path / "modes_in_time.csv"
    write_modes_in_time(rows_of_records(records), path)
    history = read_modal_table(path).history
    assert history.labels == ("mode_1", "mode_2")
    assert history.condition_names == ("mean_wind_speed_m_s", "air_temperature_c")
    assert history.state_names == ("parked",)
    for row, one in zip(range(len(records)), records, strict=True):
        for q, mode in enumerate(one.identification.modes):
            assert history.frequency[row, q] == pytest.approx(mode.frequency_hz, rel=1e-12)
            assert history.days[row] == pytest.approx(row // 4 + (3 + 6 * (row % 4)) / 24.0)


def test_seeds_and_records_without_a_start_are_left_out(tmp_path: Path) -> None:
    first, second = seen(1)[:2]
    told = replace(first, conditions={**first.conditions, "wind_seed": 7})
    undated = observation({1: second.identification.modes[0]}, None)
    rows = rows_of_records((told, undated))
    assert len(rows) == 2
    assert "wind_seed" not in rows[0]


def test_without_records_nothing_is_written(tmp_path: Path) -> None:
    write_modes_in_time([], tmp_path / "none.csv")
    assert not list(tmp_path.iterdir())


def test_a_state_is_watched_by_the_command_as_well(tmp_path: Path) -> None:
    """A row a day and state of operation: what ``follow`` keeps of records finds the same step."""
    state = advance_all(TwinState("model"), seen(90, step=-0.01))[0]
    path = tmp_path / "modes_in_time.csv"
    write_modes_in_time(rows_of_days(TwinModel("asset"), state), path)
    table = read_modal_table(path)
    assert table.history.frequency.shape == (90, 2)
    assert table.history.days[0] == pytest.approx(0.5)  # the middle of 3, 9, 15 and 21 h
    watched = watch_table(table, baseline_days=60.0)
    (told,) = watched.documents
    first, last = (table.time(BEGUN + days).isoformat() for days in (0, 9))
    assert first <= told["time_utc"] < last
