"""The API as its users meet it: records in, answers out, errors that say what to do."""

import io
import json
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient
from httpx import Response
from tests.service.conftest import HERE, Done, description, hour, record_file, turn, upload

from jackettwin.files import find_file
from jackettwin.service.context import Service
from jackettwin.service.web import pages
from jackettwin.store import journal, results, writing


def test_a_record_is_taken_observed_and_asked_for(client: TestClient, service: Service) -> None:
    sent = upload(client, 1)
    assert sent.status_code == 202, sent.text
    record_id = sent.json()["record_id"]
    assert client.get(f"/api/v1/records/{record_id}").json()["status"] == "received"
    turn(service)
    assert client.get(f"/api/v1/records/{record_id}").json()["status"] == "observed"
    assert client.get(f"/api/v1/jobs/{sent.json()['job_id']}").json()["state"] == "done"
    modes = client.get("/api/v1/assets/wtg/modes?label=mode_1").json()["items"]
    assert [m["record_id"] for m in modes] == [record_id]
    assert modes[0]["damping_ratio_interval_90"] == [0.01, 0.02]
    (bins,) = client.get("/api/v1/assets/wtg/modes/bins?label=mode_1&points=10").json()["items"]
    assert (bins["count"], bins["time_s"]) == ([1], [0.0])
    assert bins["frequency_hz"] == {name: [modes[0]["frequency_hz"]] for name in ("min", "median", "max")}
    assert client.get("/api/v1/assets/wtg/modes/bins?label=nobody").json()["items"] == []
    assert client.get("/api/v1/assets/nobody/modes/bins").status_code == 404
    twin = client.get("/api/v1/assets/wtg/twin").json()
    assert (twin["records"], twin["days"]) == (1, 1)
    assert twin["parameters"]["status"] == "ok"
    assert twin["modes"][0]["frequency_hz"] == pytest.approx(
        modes[0]["frequency_hz"],
        rel=2.0**-18,  # numbers of an observation that is kept have 18 binary digits
    )


def test_what_a_turbine_does_now_is_the_mean_of_the_last_month(client: TestClient, service: Service) -> None:
    """A change is in it after a month; in the mean of all records it never is whole."""
    for k, days in enumerate((0, 20, 31)):
        upload(client, k, start=hour(24 * days))
    turn(service)
    now = client.get("/api/v1/assets/wtg/twin").json()
    assert (now["modes"][0]["records"], now["recent_modes"][0]["records"]) == (3, 2)
    assert now["recent_modes"][0]["frequency_hz"] != now["modes"][0]["frequency_hz"]
    at = client.get("/api/v1/assets/wtg/twin", params={"at": hour(24 * 20).isoformat()}).json()
    assert at["recent_modes"] == at["modes"] and at["modes"][0]["records"] == 2


def test_the_same_content_is_one_record_whatever_the_file_is_called(
    client: TestClient, service: Service
) -> None:
    first = upload(client, 1)
    turn(service)
    again = client.post(
        "/api/v1/assets/wtg/records",
        files={"file": ("renamed.parquet", record_file(1))},
        data={"description": description(hour(1))},
    )
    assert (first.status_code, again.status_code) == (202, 200)
    assert again.json()["record_id"] == first.json()["record_id"]
    turn(service)
    assert len(client.get("/api/v1/assets/wtg/modes").json()["items"]) == 2
    assert client.get("/api/v1/assets/wtg/twin").json()["records"] == 1


def test_what_cannot_be_read_is_refused_with_field_value_and_remedy(client: TestClient) -> None:
    sent = client.post(
        "/api/v1/assets/wtg/records",
        files={"file": ("x.parquet", record_file(1))},
        data={"description": json.dumps({"sample_rate_hz": -1})},
    )
    assert sent.status_code == 422
    assert sent.headers["content-type"] == "application/problem+json"
    problem = sent.json()
    assert "sample_rate_hz" in problem["field"]
    assert problem["status"] == 422
    assert problem["detail"]


def test_a_record_without_a_start_is_refused(client: TestClient) -> None:
    body = json.loads(description())
    del body["start_utc"]
    sent = client.post(
        "/api/v1/assets/wtg/records",
        files={"file": ("x.parquet", record_file(1))},
        data={"description": json.dumps(body)},
    )
    assert sent.status_code == 422
    assert sent.json()["field"] == "start_utc"


def test_a_record_that_is_wrong_is_set_aside_and_brought_back(client: TestClient, service: Service) -> None:
    def twin() -> dict[str, Any]:
        turn(service)
        return dict(client.get("/api/v1/assets/wtg/twin").json())

    upload(client, 1)
    one = twin()
    wrong = upload(client, 2).json()
    both = twin()
    path = f"/api/v1/records/{wrong['record_id']}"
    aside = client.post(f"{path}/set-aside", json={"comment": "the sensor lay on the floor"}).json()
    assert aside["problem"]["detail"] == "the sensor lay on the floor (local)"
    again = twin()
    assert (again["state_hash"], again["records"]) == (one["state_hash"], 1)
    assert again["parameters"] == one["parameters"]
    assert len(client.get("/api/v1/assets/wtg/modes").json()["items"]) == 2
    upload(client, 2)  # sent again it is known, and stays aside
    assert twin()["records"] == 1
    client.post(f"/api/v1/jobs/{wrong['job_id']}/retry")
    assert twin()["state_hash"] == both["state_hash"]


def test_a_record_whose_work_is_cancelled_waits_for_a_person(client: TestClient, service: Service) -> None:
    sent = upload(client, 1).json()
    job, record = f"/api/v1/jobs/{sent['job_id']}", f"/api/v1/records/{sent['record_id']}"
    assert client.post(f"{job}/cancel").json()["state"] == "cancelled"
    turn(service)
    found = client.get(record).json()
    assert (found["status"], found["problem"]["detail"]) == ("set_aside", "cancelled by local")
    assert client.post(f"{job}/cancel").status_code == 409
    client.post(f"{job}/retry")
    turn(service)
    found = client.get(record).json()
    assert (found["status"], found["problem"]) == ("observed", None)


@pytest.mark.parametrize("start", [datetime(1970, 1, 1, tzinfo=UTC), datetime.now(UTC) + timedelta(days=30)])
def test_a_record_of_a_clock_that_was_wrong_is_refused(client: TestClient, start: datetime) -> None:
    """It would stand at the beginning of what is normal, or make a turbine seem to send for years."""
    sent = upload(client, 1, start=start)
    assert (sent.status_code, sent.json()["field"]) == (422, "start_utc")
    assert client.get("/api/v1/assets/wtg").json()["last_record_utc"] is None


def test_what_a_file_does_not_say_its_twin_does(client: TestClient, service: Service) -> None:
    twin = "structure: jacket15\nlogger: {unit: mg, clock: Europe/Berlin}\n"
    assert client.put("/api/v1/assets/wtg", json={"twin": twin}).status_code == 200
    rows = [f"2025-03-01 12:00:{k / 20:06.3f},{2 + k % 2}" for k in range(1000)]
    table = "\n".join(["time,acc_top_x", *rows])
    file = {"file": ("logger.csv", table)}
    refused = client.post("/api/v1/assets/wtg/records", files=file)
    assert (refused.status_code, refused.json()["field"]) == (422, "channels.acc_top_x.unit")
    client.post("/api/v1/assets/wtg/versions/2/adopt")
    taken = client.post("/api/v1/assets/wtg/records", files=file).json()
    assert client.get(f"/api/v1/records/{taken['record_id']}").json()["start_utc"] == "2025-03-01T11:00:00Z"
    signal = client.get(f"/api/v1/records/{taken['record_id']}/signal?points=1").json()
    assert signal["channels"]["acc_top_x"]["max"] == [pytest.approx(3 * 9.80665e-3)]


def test_a_file_of_more_than_an_hour_is_records_of_ten_minutes(client: TestClient, service: Service) -> None:
    """As ``jackettwin identify`` cuts it; one of the records that came by itself is known."""
    two_hours = record_file(1, samples=20 * 7200)

    def send(file: bytes) -> Any:
        described = {"description": description(hour(0))}
        return client.post(
            "/api/v1/assets/wtg/records", files={"file": ("day.parquet", file)}, data=described
        )

    first = pq.read_table(io.BytesIO(two_hours)).slice(0, 20 * 600)
    pq.write_table(first, buffer := io.BytesIO())
    alone = send(buffer.getvalue()).json()
    sent = [send(two_hours), send(two_hours)]
    assert [(answer.status_code, answer.json()["records"]) for answer in sent] == [(202, 12), (200, 12)]
    turn(service, 12)
    listed = client.get("/api/v1/assets/wtg/records").json()["items"]
    assert [one["start_utc"][11:16] for one in listed] == [
        f"{12 + k // 6}:{k % 6}0" for k in reversed(range(12))
    ]
    assert {(one["status"], one["duration_s"]) for one in listed} == {("observed", 600.0)}
    assert listed[-1]["record_id"] == alone["record_id"]
    assert listed[0]["record_id"] == sent[0].json()["record_id"]


@pytest.mark.parametrize(
    "name", ["../../../etc/passwd", "..\\..\\x.parquet", "/etc/shadow", ".bashrc", "a" * 500]
)
def test_no_name_leads_out_of_the_store(client: TestClient, service: Service, name: str) -> None:
    client.post("/api/v1/assets/wtg/records", files={"file": ("first", b"not a record")})  # lays the twin out
    before = {p for p in service.settings.store.parent.rglob("*") if p.is_file()}
    client.post("/api/v1/assets/wtg/records", files={"file": (name, b"not a record")})
    after = {p for p in service.settings.store.parent.rglob("*") if p.is_file()}
    assert {p for p in after - before if "sqlite" not in p.name} == set()


def test_an_upload_over_the_limit_is_refused_and_leaves_nothing(tmp_path, monkeypatch) -> None:
    from tests.service.conftest import make_service

    from jackettwin.service.web.app import create_app

    for small in make_service(tmp_path, None, monkeypatch, upload_limit_bytes=1000):
        with TestClient(create_app(small), base_url="http://127.0.0.1:8470", client=HERE) as client:
            assert upload(client, 1).status_code == 413
        assert list(small.settings.spool.iterdir()) == []


def test_lists_go_on_by_cursor(client: TestClient, service: Service) -> None:
    for k in range(5):
        upload(client, k)
    turn(service, 6)
    seen, cursor = [], ""
    while True:
        page = client.get(f"/api/v1/assets/wtg/records?limit=2{cursor}").json()
        seen += [r["start_utc"] for r in page["items"]]
        if page["next_cursor"] is None:
            break
        cursor = f"&cursor={page['next_cursor']}"
    assert seen == sorted(seen, reverse=True)
    assert len(seen) == 5
    assert client.get("/api/v1/assets/wtg/records?cursor=nonsense").status_code == 422
    since = hour(3).isoformat().replace("+00:00", "Z")
    assert len(client.get(f"/api/v1/assets/wtg/records?from={since}").json()["items"]) == 2
    assert client.get("/api/v1/assets/wtg/records?from=2025-03-01T00:00:00").json()["field"] == "from"


def test_signals_come_as_extremes_in_json_and_arrow(client: TestClient) -> None:
    record_id = upload(client, 1).json()["record_id"]
    path = f"/api/v1/records/{record_id}/signal?points=10"
    plain = client.get(path).json()
    assert len(plain["time_s"]) == 10
    bins = plain["channels"]["acc_top_x"]
    assert all(low <= high for low, high in zip(bins["min"], bins["max"], strict=True))
    samples = pq.read_table(io.BytesIO(record_file(1)))["acc_top_x"].to_numpy()
    rounded = 2.0**-14 * np.median(np.abs(np.diff(samples)))  # how coarsely 64-bit samples are kept
    assert min(bins["min"]) == pytest.approx(samples.min(), abs=rounded)
    assert max(bins["max"]) == pytest.approx(samples.max(), abs=rounded)
    arrow = client.get(path, headers={"Accept": "application/vnd.apache.arrow.stream"})
    table = pa.ipc.open_stream(arrow.content).read_all()
    assert table["acc_top_x.min"].to_pylist() == bins["min"]
    assert client.get(path + "&channels=nope").status_code == 422
    spectrum = client.get(f"/api/v1/records/{record_id}/spectrum").json()
    assert spectrum["units"]["acc_top_x"] == "(m/s^2)^2/Hz"


def test_a_twin_whose_model_does_not_fit_is_not_in_order(client: TestClient, service: Service) -> None:
    """The report called it not reliable, and the turbine's light said that there was nothing to do."""
    upload(client, 1)
    assert client.get("/api/v1/assets/wtg").json()["status"] == "ok"
    for reliable, status in ((False, "warning"), (True, "ok"), (None, "ok")):
        known = {} if reliable is None else {"reliable": reliable}
        with writing(service.database) as connection:
            results.put_knowledge(connection, "wtg", 1, {"known": known}, None, service.now())
            journal.tell(connection, "state", "wtg", {}, service.now())
        found = client.get("/api/v1/assets/wtg").json()
        assert found["status"] == status
        assert ("cannot reproduce" in found["reason"]) is (status == "warning")
    (listed,) = client.get("/api/v1/assets").json()["items"]
    assert listed["status"] == "ok"


def test_an_unchanged_answer_is_not_sent_again(client: TestClient) -> None:
    first = client.get("/api/v1/assets")
    again = client.get("/api/v1/assets", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    upload(client, 1)
    assert client.get("/api/v1/assets", headers={"If-None-Match": first.headers["etag"]}).status_code == 200


def test_large_answers_are_compressed(client: TestClient) -> None:
    assert client.get("/api/v1/openapi.json").headers["content-encoding"] == "gzip"


def test_picks_are_kept_with_who_and_when_and_the_record_is_observed_anew(
    client: TestClient, service: Service
) -> None:
    record_id = upload(client, 1).json()["record_id"]
    turn(service)
    done = client.put(f"/api/v1/records/{record_id}/picks", json={"picks": [{"frequency_hz": 0.18}]})
    assert done.status_code == 202, done.text
    turn(service)
    picks = client.get(f"/api/v1/records/{record_id}").json()["picks"]
    assert (picks["by"], picks["poles"][0]["frequency_hz"]) == ("local", 0.18)
    assert client.get("/api/v1/assets/wtg/twin").json()["records"] == 1


def test_a_new_version_observes_everything_beside_the_old_and_waits_for_a_person(
    client: TestClient, service: Service
) -> None:
    upload(client, 1)
    turn(service)
    old = client.get("/api/v1/assets/wtg/twin").json()
    twin = "structure: jacket15\nidentification: {highest_frequency_hz: 2.0}\n"
    added = client.put("/api/v1/assets/wtg", json={"twin": twin, "comment": "narrower"})
    assert added.status_code == 200, added.text
    turn(service)
    versions = client.get("/api/v1/assets/wtg/versions").json()["items"]
    assert [(v["version"], v["adopted"], v["observations"]) for v in versions] == [
        (1, True, 1),
        (2, False, 1),
    ]
    assert client.get("/api/v1/assets/wtg/twin").json() == old
    turn(service, 4)
    client.post("/api/v1/assets/wtg/versions/2/adopt")
    assert client.get("/api/v1/assets/wtg/twin").json()["version"] == 2
    asked = client.get("/api/v1/jobs?state=queued").json()["items"]
    assert [(job["kind"], job["version"]) for job in asked] == [("know", 2)]  # what its days say, anew


def test_a_twin_that_cannot_be_read_is_no_version(client: TestClient) -> None:
    sent = client.put("/api/v1/assets/wtg", json={"twin": "structure: nowhere\n"})
    assert sent.status_code == 422
    assert len(client.get("/api/v1/assets/wtg/versions").json()["items"]) == 1
    bad = client.post(
        "/api/v1/assets", json={"name": "b", "twin": "structure: jacket15\n", "files": {"../x": "y"}}
    )
    assert bad.json()["field"] == "files"


def test_conditions_are_joined_to_records_by_time(client: TestClient, service: Service) -> None:
    times = [hour(1).isoformat(), hour(2).isoformat()]
    body = {"time_utc": times, "values": {"mean_wind_speed_m_s": [9.0, 12.0], "state": ["parked", "idling"]}}
    assert client.post("/api/v1/assets/wtg/conditions", json=body).json() == {"count": 4, "observed_again": 0}
    upload(client, 2)
    turn(service)
    from jackettwin.store import reading, results

    with reading(service.database) as connection:
        stored = next(results.observations_between(connection, "wtg", _model_hash(client), hour(0), hour(9)))
    conditions = json.loads(stored.document)["conditions"]
    assert (conditions["mean_wind_speed_m_s"], conditions["state"]) == (12.0, "idling")


def test_tables_are_exported_as_parquet(client: TestClient, service: Service) -> None:
    upload(client, 1)
    turn(service)
    table = pq.read_table(io.BytesIO(client.get("/api/v1/export.parquet?table=modes").content))
    assert table["label"].to_pylist() == ["mode_1", "mode_3"]


def test_metrics_name_what_an_operator_alarms_on(client: TestClient) -> None:
    upload(client, 1)
    text = client.get("/api/v1/metrics").text
    for name in ("queue_age_seconds", "last_record_age_seconds", "worker_restarts_total", "disk_free_bytes"):
        assert f"jackettwin_{name}" in text


def test_a_disk_that_is_read_only_has_no_room(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.access", lambda *_: False)
    assert client.get("/api/v1/ready").status_code == 503
    assert "jackettwin_disk_free_bytes 0.0" in client.get("/api/v1/metrics").text
    assert upload(client, 1).status_code == 507


def test_health_and_readiness_need_no_login(client: TestClient) -> None:
    assert client.get("/api/v1/health").json()["status"] == "ok"
    assert client.get("/api/v1/ready").json()["ready"]


def test_without_its_built_files_the_window_says_what_to_do(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pages, "_built", dict)
    for path in ("/", "/assets/wtg", "/assets/wtg/timeline"):
        answer = client.get(path)
        assert (answer.status_code, "make app" in answer.text) == (503, True)
    assert client.get("/window/assets/index.js").status_code == 404


def test_no_name_leads_out_of_the_window(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "_built", lambda: {"index.html": b"<title>", "a.js": b"1"})
    assert client.get("/assets/wtg/timeline?from=x").text == "<title>"
    found = client.get("/window/assets/a.js")
    assert found.headers["content-type"].startswith("text/javascript")
    assert "immutable" in found.headers["cache-control"]
    for name in ("../index.html", "..%2f..%2fcontext.py", "%2e%2e/context.py", "b.js"):
        assert client.get(f"/window/assets/{name}").status_code == 404


def _model_hash(client: TestClient) -> str:
    found: str = client.get("/api/v1/assets/wtg").json()["model_hash"]
    return found


class KilledWorker(Exception):
    """As Dask calls it."""


@pytest.mark.parametrize(("deaths", "status"), [(2, 202), (3, 422)])
def test_a_file_is_read_again_when_its_reader_was_killed(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch, deaths: int, status: int
) -> None:
    tried = 0

    def submit(task: Callable[..., Any], *args: Any, **_: Any) -> Done:
        nonlocal tried
        tried += 1
        return Done(error=KilledWorker()) if tried <= deaths else Done(task(*args))

    monkeypatch.setattr(service.cluster, "submit", submit)
    assert upload(client, 1).status_code == status
    assert tried == 3


@pytest.mark.parametrize(
    "path", ["modes?lable=mode_1", "twin?model_version=3", "records?cursor=&limit=5&since=2"]
)
def test_a_query_that_nobody_reads_is_refused(client: TestClient, path: str) -> None:
    answer = client.get(f"/api/v1/assets/wtg/{path}")
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert problem["field"] in path and problem["detail"] == "no such query parameter"
    assert problem["allowed"]


def test_more_requests_at_once_than_threads_are_all_answered(client: TestClient, service: Service) -> None:
    """Each holds a connection and needs a thread to go on, while the others wait for SQLite's only writer."""
    body = {"time_utc": ["2025-03-01T12:00:00Z"], "values": {"wind": [8.0]}}

    def send(k: int) -> int:
        if k % 2:
            return client.get("/api/v1/jobs").status_code
        return client.post("/api/v1/assets/wtg/conditions", json=body).status_code

    with ThreadPoolExecutor(120) as pool:
        assert set(pool.map(send, range(240))) == {200}


def test_a_description_may_be_a_file(client: TestClient) -> None:
    """As many clients send what has a type of its own; it is the same record as with a field."""
    record = ("r1.parquet", record_file(1))
    beside = ("r1.json", description(hour(1)).encode(), "application/json")
    as_file = client.post("/api/v1/assets/wtg/records", files={"file": record, "description": beside})
    as_field = upload(client, 1)
    assert (as_file.status_code, as_field.status_code) == (202, 200)
    assert as_file.json()["record_id"] == as_field.json()["record_id"]
    for wrong, status in ((b"\xff\xfe", 422), (b"[]", 422), (b" " * 2_000_000, 413)):
        files = {"file": record, "description": ("r1.json", wrong)}
        answer = client.post("/api/v1/assets/wtg/records", files=files)
        assert answer.status_code == status
        assert "UploadFile" not in answer.text


def test_a_twin_is_drafted_from_a_structure_and_a_record(client: TestClient) -> None:
    """As `init` does, with what was guessed and a drawing; what is drafted can be added."""
    deck = find_file("jacket15", "structures").read_bytes()
    sent = {"structure": ("my deck.yaml", deck), "record": ("r.parquet", record_file())}

    def asked(**files: tuple[str, bytes]) -> Response:
        return client.post("/api/v1/drafts", files={**sent, **files}, data={"description": description()})

    found = asked().json()
    assert [place["channel"] for place in found["places"]] == ["acc_top_x", "acc_top_y"]
    assert all(place["why"] and not place["lacks"] for place in found["places"])
    assert len(found["drawn"]["sensors"]) == 2 and "records:" not in found["twin"]
    body = {"name": "new", "twin": found["twin"], "files": {found["structure"]: deck.decode()}}
    added = client.post("/api/v1/assets", json=body)
    assert added.status_code == 201, added.text
    broken = asked(structure=("a.yaml", b"nodes: 3\n"))
    assert broken.status_code == 422 and broken.json()["remedy"]
