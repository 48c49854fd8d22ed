"""Samples of observed records are kept for as long as the store's policy says."""

from datetime import timedelta

from fastapi.testclient import TestClient
from tests.service.conftest import NOON, turn, upload

from jackettwin.service.context import Service
from jackettwin.service.work.housekeeping import Housekeeping, prune


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
