"""The demonstration's two years: what was put in stands in them, and they go the way of all records."""

from __future__ import annotations

import gzip
import json
import re
from base64 import b64encode
from datetime import timedelta
from hashlib import sha256
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from plotly.offline import get_plotlyjs
from tests.service.conftest import make_service

from jackettwin.service import demonstration
from jackettwin.service.demonstration import SAID, SHIPPED, arrive, lay_out, shipped_records, tell_story
from jackettwin.service.story import DAYS, SCOUR_M, STORM, UNTIL, story
from jackettwin.service.web.catalogue import one
from jackettwin.store import assets, reading, records, results, work
from jackettwin.twin import OBSERVATION, read_twin, twin_model

TWIN = Path(__file__).parents[2] / "src" / "jackettwin" / "data" / "twins" / "openfast_pile.yaml"


@pytest.fixture(scope="module")
def days() -> list:
    config = read_twin(TWIN, records_follow=True)
    return list(story(config, twin_model(config), UNTIL))


def test_days_end_before_the_date_and_leave_out_the_stop(days: list) -> None:
    dates = [seen.start_utc.date() for seen in days]
    assert dates[-1].isoformat() == "2025-11-30" and dates == sorted(set(dates))
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
    monkeypatch.setattr(demonstration, "story", lambda *given: islice(story(*given), 20))
    for service in make_service(tmp_path / "store", None, monkeypatch):
        tell_story(service)
        tell_story(service)
        with reading(service.database) as connection:
            asset = one(connection, "demo")
            assert asset.records == {"observed": 20} and asset.comment == SAID
            listed, _ = records.list_records(connection, "demo", limit=1)
            assert listed[0].waveform is None and listed[0].source_name == "simulated day 20"
            assert len(results.state_hashes(connection, "demo", asset.model_hash)) == 20
            rows = results.list_modes(connection, "demo", asset.model_hash, limit=6)
            assert {row["status"] for row in rows} == {"simulated"}
            assert all(0.0 < row["frequency_std_hz"] < 2e-3 * row["frequency_hz"] for row in rows)
            assert [row["label"] for row in rows[:2]] == ["side_side_1", "fore_aft_1"]


def test_the_shipped_demonstration_is_of_this_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, days: list
) -> None:
    """Of today's twin and model, with the days of the story; its last record is still to come.

    If this fails, run `python scripts/write_demonstration.py` (minutes).
    """
    assert SHIPPED.stat().st_size < 2e6
    for service in make_service(tmp_path / "store", None, monkeypatch):
        assert lay_out(service), "the shipped demonstration is of another model"
        with reading(service.database) as connection:
            asset = one(connection, "demo")
            assert asset.records == {"observed": DAYS} and asset.open_alarms == 1  # 726 days, 4 records
            told = days[DAYS - 200]  # after the storm
            times = (told.start_utc, told.start_utc + timedelta(days=1))
            (said,) = results.observations_between(connection, "demo", asset.model_hash, *times)
            kept = OBSERVATION.load(json.loads(said.document))
            rests_on = results.find_supports(connection, "demo", 1)["records"]
            assert 20 < rests_on < 40  # its days with a locked shaft and its records; all 730 were told once
            assert results.find_drawn(connection, "demo", 1, "explored")["loci"]
            assert results.find_watch(connection, "demo", 1)["days"]
            assert results.find_stiffness(connection, "demo", 1)["stiffness_in_time"]
            page = gzip.decompress(results.find_report(connection, "demo", 1) or b"").decode()
            assert "Is the model right?" in page and len(page) > 1_500_000  # with the library of its plots
            ran = re.findall(r"<(?:style|script)>(.*?)</", page, re.DOTALL) + [get_plotlyjs()]
            hashes = [b64encode(sha256(text.encode()).digest()).decode() for text in ran]
            assert len(ran) == 3 and all(one in page[: page.index("<title>")] for one in hashes)
            assert page.index('id="verdict"') < page.index('id="stiffness-through-time"')
        assert [arrive(service, record) for record in shipped_records()] == 4 * [False] + [True]
        with reading(service.database) as connection:
            assert len(work.list_jobs(connection, limit=9)) == 1  # what the first four say is not asked again
    assert told.name == kept.name
    for (mode, _), (other, _) in zip(told.modes.values(), kept.modes.values(), strict=True):
        assert other.frequency_hz == pytest.approx(mode.frequency_hz, rel=1e-5)  # six digits are told


def test_a_demonstration_of_another_model_is_told_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(demonstration, "_LOCKED", b"\noperation: {updates: [parked, idling]}\n")
    for service in make_service(tmp_path / "store", None, monkeypatch):
        assert not lay_out(service)
        with reading(service.database) as connection:
            assert "demo" not in assets.asset_names(connection)
    assert "told anew" in caplog.text
