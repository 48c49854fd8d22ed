"""The demonstration's two years: what was put in stands in them, and they go the way of all records."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import numpy as np
import pytest
from tests.service.conftest import make_service

from jackettwin.service.demonstration import SAID, tell_story
from jackettwin.service.story import DAYS, SCOUR_M, STORM, story
from jackettwin.service.web.catalogue import one
from jackettwin.store import reading, records, results
from jackettwin.twin import read_twin, twin_model

TWIN = Path(__file__).parents[2] / "src" / "jackettwin" / "data" / "twins" / "openfast_pile.yaml"
UNTIL = date(2026, 3, 1)


@pytest.fixture(scope="module")
def days() -> list:
    config = read_twin(TWIN, records_follow=True)
    return list(story(config, twin_model(config), UNTIL))


def test_days_end_before_the_date_and_leave_out_the_stop(days: list) -> None:
    dates = [seen.start_utc.date() for seen in days]
    assert dates[-1].isoformat() == "2026-02-28" and dates == sorted(set(dates))
    assert (dates[-1] - dates[0]).days + 1 == DAYS and len(dates) == DAYS - 4
    assert all("nobody measured" in seen.conditions["simulated"] for seen in days)


def test_season_and_scour_move_the_modes_as_stated(days: list) -> None:
    """By least squares on temperature, sea level and the step: five standard errors about what was put in.

    Scour of 1.4 m takes 0.3 to 0.4 % of the second bending modes and a tenth of that of the first: in these
    the ground takes little of the strain energy.
    """
    step = np.array([float((seen.start_utc.date() - days[0].start_utc.date()).days > STORM) for seen in days])
    air = np.array([seen.conditions["air_temperature_c"] for seen in days])
    level = np.array([seen.conditions["water_level_m"] for seen in days])
    x = np.column_stack([np.ones(len(days)), air, level, step])
    f = np.log([[mode.frequency_hz for mode, _ in seen.modes.values()] for seen in days])
    found, residual, *_ = np.linalg.lstsq(x, f)
    std = np.sqrt(residual / (len(days) - 4) * np.linalg.inv(x.T @ x).diagonal()[:, None])
    np.testing.assert_array_less(np.abs(found[1] + 2.5e-4), 5.0 * std[1])
    np.testing.assert_array_less(np.abs(found[2] + 6e-4), 5.0 * std[2])
    first, second = found[3, :2], found[3, 3:]
    assert (
        (second > -4.5e-3).all()
        and (second < -2.5e-3).all()
        and (np.abs(first) < 8e-4 + 5 * std[3, :2]).all()
    )
    assert SCOUR_M == 1.4


def test_the_story_goes_the_way_of_every_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Records without samples, modes that say they are simulated, a state for each day, one question."""
    for service in make_service(tmp_path / "store", None, monkeypatch):
        tell_story(service)
        tell_story(service)
        with reading(service.database) as connection:
            asset = one(connection, "demo")
            assert asset.records == {"observed": DAYS - 4} and asset.comment == SAID
            listed, _ = records.list_records(connection, "demo", limit=1)
            assert listed[0].waveform is None and listed[0].source_name == f"simulated day {DAYS}"
            assert len(results.state_hashes(connection, "demo", asset.model_hash)) == DAYS - 4
            rows = results.list_modes(connection, "demo", asset.model_hash, limit=6)
            assert {row["status"] for row in rows} == {"simulated"}
            assert all(0.0 < row["frequency_std_hz"] < 2e-3 * row["frequency_hz"] for row in rows)
            assert [row["label"] for row in rows[:2]] == ["side_side_1", "fore_aft_1"]
