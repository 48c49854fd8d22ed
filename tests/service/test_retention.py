"""Samples of observed records are kept for as long as the store's policy says."""

from datetime import timedelta

from fastapi.testclient import TestClient
from tests.service.conftest import NOON, turn, upload

from jackettwin.service import rebuild
from jackettwin.service.context import Service
from jackettwin.service.work.consequences import set_aside
from jackettwin.service.work.housekeeping import Housekeeping, forget, prune
from jackettwin.store import assets, people, reading, results, work, writing


def waveforms(service: Service) -> int:
    return len([p for p in service.settings.store.rglob("*.parquet") if "spool" not in p.parts])


def test_old_samples_go_and_what_they_said_stays(client: TestClient, service: Service) -> None:
    upload(client, 1)
    turn(service)
    upload(client, 2)  # not observed yet
    upload(client, 3, start=NOON + timedelta(days=9))
    assert waveforms(service) == 3
    service.settings = service.settings.model_copy(update={"raw_days": 7.0})
    Housekeeping(service)
    service.now = lambda: NOON + timedelta(days=10)
    assert prune(service) == 1
    assert waveforms(service) == 2
    assert len(client.get("/api/v1/assets/wtg/modes").json()["items"]) == 2
    turn(service)
    assert prune(service) == 1  # observed now, and as old
    assert waveforms(service) == 1


def test_zero_days_keep_everything_again(client: TestClient, service: Service) -> None:
    upload(client, 1)
    turn(service)
    service.now = lambda: NOON + timedelta(days=4000)
    assert prune(service) == 0  # without a policy
    for days in (1.0, 0.0):
        service.settings = service.settings.model_copy(update={"raw_days": days})
        Housekeeping(service)
    assert prune(service) == 0


def keeping(service: Service, **days: float) -> None:
    """Have a server start with a policy."""
    service.settings = service.settings.model_copy(update=days)
    Housekeeping(service)


def test_what_records_said_is_forgotten_and_their_day_stays(client: TestClient, service: Service) -> None:
    """Not a day of which something is forgotten is summed anew: it would be of fewer records then."""
    old = [upload(client, k).json()["record_id"] for k in (1, 2)]
    upload(client, 3, start=NOON + timedelta(days=9))
    turn(service)
    with reading(service.database) as connection:
        model = assets.found_version(connection, "wtg").model_hash
        before = results.state_hashes(connection, "wtg", model)
        seen = results.observed_time(connection, "wtg", model)
    etag = client.get("/api/v1/assets/wtg/twin").headers["etag"]
    keeping(service, observation_days=7.0)
    service.now = lambda: NOON + timedelta(days=10)
    forget(service)
    assert client.get("/api/v1/assets/wtg/twin").headers["etag"] != etag
    with reading(service.database) as connection:
        kept = [bool(o.document) for o in results.newest_observations(connection, "wtg", model, 9)]
        assert kept == [True]
        assert results.find_observation(connection, "wtg", old[0], model).document == ""
        assert results.observed_time(connection, "wtg", model) == seen
    rebuild(service.database, service.settings.store, None, None)
    with writing(service.database) as connection:
        set_aside(connection, service, "wtg", old[1], "a test")
    upload(client, 4, start=NOON + timedelta(hours=8))  # late, of the old day
    turn(service)
    with reading(service.database) as connection:
        after = results.state_hashes(connection, "wtg", model)
        (day, last) = sorted(after)
        assert after[last] == before[last]
        assert results.find_state(connection, "wtg", model, day).n_records == 3
    assert len(client.get("/api/v1/assets/wtg/modes").json()["items"]) == 6


def test_ended_work_and_old_lines_of_the_audit_log_go(client: TestClient, service: Service) -> None:
    upload(client, 1)
    turn(service)
    keeping(service, job_days=30.0, audit_days=400.0)
    forget(service)
    assert len(client.get("/api/v1/jobs").json()["items"]) == 2
    later = service.now() + timedelta(days=500)
    service.now = lambda: later
    forget(service)
    assert [job["kind"] for job in client.get("/api/v1/jobs").json()["items"]] == [work.KNOW]
    with reading(service.database) as connection:
        (line,) = people.read_audit(connection, 10)
        assert (line.who, line.subject) == ("jackettwin", "400 days are kept")
    table = {"time_utc": [(NOON + timedelta(hours=1)).isoformat()], "values": {"wind": [8.0]}}
    answer = client.post("/api/v1/assets/wtg/conditions", json=table).json()
    assert answer == {"count": 1, "observed_again": 1}
    turn(service)
    assert len(client.get("/api/v1/assets/wtg/modes").json()["items"]) == 2  # observed again, counted once
