"""The way to the database is cut while records arrive: nothing is lost, doubled or half-kept."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import make_url
from sqlalchemy.exc import OperationalError
from tests.service.conftest import make_service, turn, upload
from tests.service.servers import Relay
from tests.store.conftest import fresh

from jackettwin.service.context import Service


@pytest.fixture
def relay(postgresql_url: str) -> Iterator[Relay]:
    made = Relay(make_url(postgresql_url).port or 5432)
    yield made
    made.cut()


@pytest.fixture
def service(
    relay: Relay, postgresql_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Service]:
    url = make_url(fresh(postgresql_url)).set(port=relay.port)
    yield from make_service(tmp_path / "store", url.render_as_string(hide_password=False), monkeypatch)


def test_what_was_refused_meanwhile_is_sent_again_and_counts_once(
    client: TestClient, service: Service, relay: Relay
) -> None:
    assert upload(client, 1).status_code == 202
    turn(service)
    relay.cut()
    refused = upload(client, 2)
    assert (refused.status_code, refused.headers["retry-after"]) == (503, "5")
    assert client.get("/api/v1/assets").status_code == 503
    said = client.get("/api/v1/health").json()
    assert "the database does not answer" in said["problems"]
    assert client.get("/api/v1/ready").status_code == 503
    with pytest.raises(OperationalError):
        turn(service)
    relay.mend()
    assert upload(client, 2).status_code == 202
    assert upload(client, 1).status_code == 200
    turn(service)
    (asset,) = client.get("/api/v1/assets").json()["items"]
    assert asset["records"] == {"observed": 2}
    assert client.get("/api/v1/ready").json()["database"]
