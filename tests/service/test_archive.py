"""A turbine that is gone: nothing more is taken of it, what was known stays, and it can come back."""

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner
from fastapi.testclient import TestClient
from sqlalchemy import select
from tests.service.conftest import NOON, TWIN, description, hour, record_file, turn, upload

from jackettwin.cli.asset import asset_command
from jackettwin.errors import InputError
from jackettwin.service import add_conditions, add_twin, take_here
from jackettwin.service.context import Service
from jackettwin.service.server import take_from_inbox
from jackettwin.service.web import catalogue
from jackettwin.store import reading, tables, work, writing
from jackettwin.store.assets import found_version


def names(client: TestClient, query: str = "") -> list[str]:
    return [asset["name"] for asset in client.get(f"/api/v1/assets{query}").json()["items"]]


def test_an_archived_turbine_takes_nothing_and_keeps_what_is_known(
    client: TestClient, service: Service
) -> None:
    upload(client, 1)
    turn(service)
    before = client.get("/api/v1/assets/wtg/modes").json()
    mistaken = client.delete("/api/v1/assets/wtg?confirm=wgt")
    assert (mistaken.status_code, mistaken.json()["field"]) == (422, "confirm")
    assert names(client) == ["wtg"]
    assert client.delete("/api/v1/assets/wtg?confirm=wtg").json()["archived_utc"]
    assert (names(client), names(client, "?archived=true")) == ([], ["wtg"])
    assert "jackettwin_last_record_age_seconds" not in client.get("/api/v1/metrics").text
    assert upload(client, 2).status_code == 409
    twin = {"twin": "structure: jacket15\n"}
    assert client.put("/api/v1/assets/wtg", json=twin).status_code == 409
    assert client.post("/api/v1/assets", json={"name": "wtg", **twin}).status_code == 409
    assert client.get("/api/v1/assets/wtg/modes").json() == before
    assert client.post("/api/v1/assets/wtg/unarchive").json()["archived_utc"] is None
    assert upload(client, 2).status_code == 202
    with reading(service.database) as connection:
        said = connection.scalars(select(tables.audit.c.action).order_by(tables.audit.c.id)).all()
    assert said[-4:] == ["record", "archive", "unarchive", "record"]


def test_a_turbine_has_a_place_and_the_list_renews_it_alone(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    twin = tmp_path / "other.yaml"
    twin.write_text("structure: jacket15\n")
    add_twin(service.database, service.settings.store, "other", twin)
    assert names(client) == ["other", "wtg"]
    made, overview = [], catalogue.overview
    monkeypatch.setattr(
        catalogue, "overview", lambda *args, **more: made.append(args[1:]) or overview(*args, **more)
    )
    said = client.put(
        "/api/v1/assets/wtg/position", json={"latitude_deg": 55.0, "longitude_deg": -7.5}
    ).json()
    assert (said["latitude_deg"], said["longitude_deg"]) == (55.0, -7.5)
    made.clear()
    assert client.get("/api/v1/assets").json()["items"][1] == said and made == [("wtg",)]
    arguments = ["place", "other", "--store", str(service.settings.store), "--", "54.5", "-7.25"]
    assert CliRunner().invoke(asset_command, arguments).output == "other stands at 54.5, -7.25\n"
    made.clear()
    assert client.get("/api/v1/assets").json()["items"][0]["longitude_deg"] == -7.25
    assert names(client) == ["other", "wtg"] and made == [("other",)]
    refused = client.put("/api/v1/assets/wtg/position", json={"latitude_deg": 91.0, "longitude_deg": 0.0})
    assert (refused.status_code, refused.json()["field"]) == (422, "latitude_deg")


def test_files_and_the_command_line_are_refused_too(
    client: TestClient, service: Service, tmp_path: Path
) -> None:
    store = service.settings.store
    arguments = ["archive", "wtg", "--store", str(store)]
    asked = CliRunner().invoke(asset_command, arguments, input="n\n")
    assert asked.exit_code == 1 and names(client) == ["wtg"]
    assert CliRunner().invoke(asset_command, [*arguments, "--yes"]).output == "wtg is archived\n"
    path = store / "inbox" / "wtg" / "r.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("time,a\n0,1\n")
    assert take_from_inbox(service, store / "inbox", path) is None and path.exists()
    assert "archived" in path.with_name("r.csv.refused.json").read_text()
    (tmp_path / "twin.yaml").write_text("structure: jacket15\n")
    refused: list[Callable[[], object]] = [
        lambda: take_here(service.database, store, "wtg", path),
        lambda: add_twin(service.database, store, "wtg", tmp_path / "twin.yaml"),
        lambda: add_conditions(service.database, store, "wtg", path),
    ]
    for take in refused:
        with pytest.raises(InputError, match="archived"):
            take()
    assert CliRunner().invoke(asset_command, [*arguments, "--undo"]).output == "wtg is back\n"
    assert names(client) == ["wtg"]


def test_what_an_archived_turbine_left_waits_for_all_others(client: TestClient, service: Service) -> None:
    """It delays nobody, alarms nobody, and is observed in the end; brought back it waits in line again."""
    catalogue.add_text_version(service, "other", TWIN, {}, "test")
    left = upload(client, 1).json()["record_id"]
    client.delete("/api/v1/assets/wtg?confirm=wtg")
    assert "jackettwin_queue_age_seconds 0.0" in client.get("/api/v1/metrics").text
    later = client.post(
        "/api/v1/assets/other/records",
        files={"file": ("r2.parquet", record_file(2))},
        data={"description": description(hour(2))},
    ).json()["record_id"]
    with writing(service.database) as connection:
        assert [job.record_id for job in work.lease(connection, "x", 9, NOON)] == [later, left]
        work.take_back_orphans(connection, "y", ())
    turn(service, 6)
    assert client.get(f"/api/v1/records/{left}").json()["status"] == "observed"
    client.post("/api/v1/assets/wtg/unarchive")
    with reading(service.database) as connection:
        assert work.any_queued(connection, work.OBSERVE, gone=True) is False


def test_a_version_that_is_not_there_is_refused_with_those_that_are(service: Service) -> None:
    """The names of all assets were given as allowed, and adding the asset as the remedy."""
    with reading(service.database) as connection, pytest.raises(InputError) as refused:
        found_version(connection, "wtg", 9)
    assert refused.value.field == "version" and refused.value.allowed == "1"
