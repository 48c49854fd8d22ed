"""Tables of ten-minute statistics: read as SCADA writes them, joined by time, late ones observed again."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from tests.service.conftest import NOON, hour, turn, upload

from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.workers.condition_tables import read_table
from jackettwin.store import results, streams, writing

T0 = datetime(2025, 3, 1, 12, tzinfo=UTC)
ENGLISH = "Timestamp,Wind Speed (m/s),state\n2025-03-01T12:00:00Z,8.5,parked\n2025-03-01T12:10:00Z,,idling\n"
GERMAN = "Zeit;Wind Speed (m/s);state\n01.03.2025 13:00;8,5;parked\n01.03.2025 13:10;;idling\n"


@pytest.mark.parametrize(
    ("text", "how"),
    [
        (ENGLISH, {}),
        (GERMAN, {"zone": "Europe/Berlin"}),
        ("\ufeff" + ENGLISH.replace(",", "\t"), {}),
        (GERMAN.replace("13:10", "13:20").replace("13:00", "13:10"), {"zone": "+01:00", "end_stamped": True}),
    ],
)
def test_the_forms_that_scada_writes(tmp_path: Path, text: str, how: dict) -> None:
    path = tmp_path / "scada.csv"
    path.write_text(text, encoding="utf-8")
    table = read_table(path, **how)
    assert table["wind_speed_m_s"] == {T0: 8.5, T0 + timedelta(minutes=10): None}
    assert table["state"] == {T0: "parked", T0 + timedelta(minutes=10): "idling"}


@pytest.mark.parametrize(
    "text", ["", "a,b\n1,2\n", "time,b\nlunch,2\n", "\x00\xff", "time,b\n2025-03-01\n1,2,3\n"]
)
def test_what_is_no_table_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "scada.csv"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(InputError):
        read_table(path)


def test_an_hour_that_the_zone_never_has_is_refused(tmp_path: Path) -> None:
    """The clock of the table was not put forward: its whole summer would be an hour off."""
    path, spring = tmp_path / "scada.csv", "time,wind\n2025-03-30 01:50,7\n2025-03-30 02:00,8\n"
    path.write_text(spring)
    with pytest.raises(InputError, match=r"never has this time.*2025-03-30 02:00.*offset"):
        read_table(path, zone="Europe/Berlin")
    # ends of intervals that begin before the hour
    for end in ("02:00", "03:00"):
        path.write_text(spring.replace("02:00", end))
        ends = read_table(path, zone="Europe/Berlin", end_stamped=True)["wind"]
        assert list(ends) == [datetime(2025, 3, 30, 0, minute, tzinfo=UTC) for minute in (40, 50)]
    assert read_table(path, zone="+01:00")["wind"]
    path.write_text("begin,end,category\n2025-03-30 02:10,2025-03-30 04:00,Forced outage\n")
    with pytest.raises(InputError, match="never has this time"):
        read_table(path, zone="Europe/Berlin")


def test_rows_count_that_overlap_by_half(service: Service) -> None:
    minutes = {T0 + timedelta(minutes=m): v for m, v in ((0, 4.0), (10, 8.0), (20, 100.0))}
    with writing(service.database) as connection:
        streams.put_conditions(connection, "wtg", "wind", minutes)

        def wind(first: float, last: float) -> object:
            start, end = T0 + timedelta(minutes=first), T0 + timedelta(minutes=last)
            return streams.conditions_between(connection, "wtg", start, end).get("wind")

        assert wind(0, 10) == 4.0
        assert wind(3, 13) == 4.0  # seven minutes of the first row
        assert wind(0, 20) == 6.0
        assert wind(12, 14) == 8.0  # a short record within one row
        assert wind(40, 50) is None


def test_late_conditions_observe_their_records_again_once(client: TestClient, service: Service) -> None:
    for k in (0, 1, 2):
        upload(client, k)
    turn(service, 6)
    sent = [
        client.post("/api/v1/assets/wtg/conditions.csv", files={"file": ("scada.csv", ENGLISH)}).json()
        for _ in range(2)
    ]
    assert sent == [{"count": 4, "observed_again": 1}, {"count": 0, "observed_again": 0}]
    turn(service, 6)
    with writing(service.database) as connection:
        model_hash = client.get("/api/v1/assets/wtg").json()["model_hash"]
        seen = list(results.observations_between(connection, "wtg", model_hash, hour(0), hour(9)))
    assert ['"parked"' in one.document for one in seen] == [True, False, False]
    assert client.get("/api/v1/assets/wtg/twin").json()["records"] == 3


def test_a_table_that_cannot_be_read_says_why(client: TestClient) -> None:
    answer = client.post("/api/v1/assets/wtg/conditions.csv", files={"file": ("x.csv", "a;b\n1;2\n")})
    assert (answer.status_code, answer.json()["field"]) == (422, "time")
    assert "/" not in answer.json().get("value", "")
    assert NOON == T0


OPENOA = (
    "time,asset_id,WTUR_W,WMET_HorWdSpd,WMET_HorWdDirRel,WROT_BlPthAngVal,WMET_EnvTmp\n"
    "2025-03-01T12:00:00Z,wtg,4980.5,11.2,-3.5,4.1,6.0\n"
    "2025-03-01T12:00:00Z,other,0.0,3.1,90.0,85.0,6.5\n"
)
"""As OpenOA's schema for SCADA has it: names of IEC 61400-25, rows of all turbines in one table."""


def test_names_of_the_standard_are_ours_and_rows_of_others_are_not(tmp_path: Path) -> None:
    path = tmp_path / "scada.csv"
    path.write_text(OPENOA)
    table = read_table(path, asset="wtg")
    assert {name: values[T0] for name, values in table.items()} == {
        "power_kw": 4980.5,
        "mean_wind_speed_m_s": 11.2,
        "yaw_deg": -3.5,
        "pitch_deg": 4.1,
        "air_temperature_c": 6.0,
    }
    with pytest.raises(InputError, match="several turbines") as refused:
        read_table(path, asset="third")
    assert refused.value.allowed == "other, wtg"


EVENTS = (
    "Time On;Time Off;Category\n"
    "2025-03-01 12:00;2025-03-01 12:30;Forced outage\n"
    "2025-03-01 12:25;2025-03-01 12:44;Curtailment by grid operator\n"
    "2025-03-01 13:00;;Scheduled maintenance\n"
    "2025-03-01 13:20;2025-03-01 13:30;Ice\n"
)


def test_stops_and_curtailments_are_states_of_ten_minutes(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    path.write_text(EVENTS)
    states = read_table(path, zone="UTC")["state"]
    told = {f"{time:%H:%M}": state for time, state in states.items()}
    assert told == {
        "12:00": "stopped",
        "12:10": "stopped",
        "12:20": "stopped",
        "12:30": "curtailed",
        "12:40": "changing",
        "13:00": "stopped",
        "13:10": "stopped",
        "13:20": "stopped",
    }
    path.write_text(EVENTS.replace("12:44", "11:44"))
    with pytest.raises(InputError, match="ends before it begins"):
        read_table(path)


def test_a_record_within_a_stop_is_of_that_state(client: TestClient, service: Service) -> None:
    """And one that a stop cuts through is of none that updates; before, it was of what it said itself."""
    for k in (0, 1):
        upload(client, k)
    turn(service)
    begins, ends = hour(0) - timedelta(minutes=20), hour(0) + timedelta(minutes=40)
    events = f"begin,end,event\n{begins:%Y-%m-%d %H:%M},{ends:%Y-%m-%d %H:%M},fault\n"
    answer = client.post("/api/v1/assets/wtg/conditions.csv", files={"file": ("e.csv", events.encode())})
    assert answer.json()["observed_again"] == 1
    with writing(service.database) as connection:
        found = streams.conditions_between(connection, "wtg", hour(0), hour(0) + timedelta(minutes=10))
        assert found["state"] == "stopped"
