"""A turbine that is gone: nothing more is taken of it, what was known stays, and it can come back."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from fastapi.testclient import TestClient
from sqlalchemy import select
from tests.service.conftest import turn, upload

from jackettwin.cli.asset import asset_command
from jackettwin.errors import InputError
from jackettwin.service import take_here
from jackettwin.service.context import Service
from jackettwin.service.server import take_from_inbox
from jackettwin.store import reading, tables


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
    assert said[-2:] == ["archive", "unarchive"]


def test_files_and_the_command_line_are_refused_too(
    client: TestClient, service: Service, tmp_path: Path
) -> None:
    store = service.settings.store
    arguments = ["archive", "wtg", "--store", str(store)]
    asked = CliRunner().invoke(asset_command, arguments, input="n\n")
    assert asked.exit_code == 1 and names(client) == ["wtg"]
    assert CliRunner().invoke(asset_command, [*arguments, "--yes"]).output == "wtg is archived\n"
    path = store / "inbox" / "wtg" / "r.csv"
    path.parent.mkdir(parents=True)
    path.write_text("time,a\n0,1\n")
    refused = take_from_inbox(service, store / "inbox", path)
    assert refused.problem is not None and "archived" in refused.problem["detail"] and path.exists()
    with pytest.raises(InputError, match="archived"):
        take_here(service.database, store, "wtg", path)
    assert CliRunner().invoke(asset_command, [*arguments, "--undo"]).output == "wtg is back\n"
    assert names(client) == ["wtg"]
