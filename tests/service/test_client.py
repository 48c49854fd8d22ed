"""The Python client, against the API itself."""

from __future__ import annotations

import asyncio
import inspect
import json
import re
from pathlib import Path
from typing import Any

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient
from tests.service.conftest import HERE, TWIN, description, hour, record_file, turn

from jackettwin.client import AsyncClient, Client
from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.web.app import API, ROUTERS, create_app
from jackettwin.store import reading
from jackettwin.store.assets import bundle_of, unpack

EXAMPLES: dict[str, Any] = {
    "files": {},
    "record": "r.parquet",
    "structure": "r.parquet",
    "description": {},
    "table": "scada.csv",
    "time_utc": ["2025-03-01T12:00:00Z"],
    "values": {"wind": [8.0]},
    "picks": [{"frequency_hz": 0.5}],
    "channel": {"kind": "mail"},
    "to": "all.parquet",
}
"""What methods are given by the name of a parameter; others get a word."""


@pytest.fixture
def twin(service: Service) -> Client:
    made = Client("http://127.0.0.1:8470")
    made._http.close()
    made._http = TestClient(create_app(service), base_url=f"http://127.0.0.1:8470{API}", client=HERE)  # type: ignore[assignment]
    return made


def test_records_in_and_answers_out(twin: Client, service: Service, tmp_path: Path) -> None:
    for k in range(3):
        (tmp_path / f"r{k}.parquet").write_bytes(record_file(k))
        (tmp_path / f"r{k}.json").write_text(description(hour(k)))
        sent = twin.send("wtg", tmp_path / f"r{k}.parquet")
    turn(service, 6)
    assert twin.job(sent["job_id"])["state"] == "done"
    assert [r["status"] for r in twin.records("wtg", limit=2)] == ["observed"] * 3  # over two pages
    assert len(list(twin.modes("wtg", label="mode_1"))) == 3
    assert twin.twin("wtg")["records"] == 3
    assert twin.damping_budget("wtg")[0]["sources"]["soil"]["value"] == 0.01
    assert twin.sensitivity("wtg")[0]["frequency_sensitivity"] == {"k": 0.02}
    assert twin.explored("wtg")["curves"][0]["cost"] == [9.1, 0.4, 2.2]
    assert "explored" not in twin.twin("wtg")["parameters"]
    assert [one["key"] for one in twin.assumptions("wtg")] == ["tolerances.rna_mass"]


def test_a_confirmed_assumption_is_a_version_that_waits_to_be_adopted(
    twin: Client, service: Service, tmp_path: Path
) -> None:
    """Its twin file closes the tolerance and is otherwise as before; what is not open is refused."""
    (tmp_path / "r.parquet").write_bytes(record_file(1))
    twin.send("wtg", tmp_path / "r.parquet", json.loads(description(hour(1))))
    turn(service, 4)
    added = twin.confirm("wtg", "tolerances.rna_mass", "weighed at the quay")
    assert (added["version"], added["adopted"]) == (2, False)
    assert added["comment"] == "tolerances.rna_mass confirmed: weighed at the quay"
    with reading(service.database) as connection:
        files = unpack(bundle_of(connection, "wtg", 2))
    assert files["twin.yaml"].decode() == TWIN + "tolerances: {rna_mass: {weighed: true}}\n"
    with pytest.raises(InputError, match="404") as refused:
        twin.confirm("wtg", "tolerances.growth", "divers")
    assert refused.value.field == "key"


def test_versions_are_compared_before_one_is_adopted(twin: Client, service: Service, tmp_path: Path) -> None:
    """Two versions that differ in their laws alone share observations, and are asked one by one."""
    (tmp_path / "r.parquet").write_bytes(record_file(1))
    twin.send("wtg", tmp_path / "r.parquet", json.loads(description(hour(1))))
    turn(service, 4)
    twin._asked("PUT", "/assets/wtg", json={"twin": TWIN + "update: {laws: [zener]}\n"})
    turn(service, 4)
    found = twin.comparison("wtg", 2)
    assert (found["adopted"]["version"], found["other"]["version"]) == (1, 2)
    changes = {change["quantity"]: change for change in found["changes"]}
    assert [c["difference"] for name, c in changes.items() if name.endswith("frequency_hz")] == [0.0, 0.0]
    assert changes["ln k"]["in_standard_deviations"] == 0.0
    assert twin.twin("wtg")["version"] == 1


def test_refusals_say_what_to_do(twin: Client) -> None:
    with pytest.raises(InputError, match="404") as refused:
        twin.twin("nobody")
    assert refused.value.field == "asset"


def test_the_client_does_all_that_the_api_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every method is called once; what it asks for is a route of the API, and no route is left."""
    monkeypatch.chdir(tmp_path)
    for name in ("r.parquet", "scada.csv"):
        (tmp_path / name).write_text("x")
    asked: list[tuple[str, str]] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append((request.method, request.url.path))
        if request.url.path.endswith(("/events", "/live")):
            return httpx.Response(200, text="event: packet\ndata: {}\n\n")
        return httpx.Response(200, json={"items": [], "next_cursor": None, "csrf_token": "x"})

    client = Client("http://127.0.0.1:8470")
    client._http = httpx.Client(base_url=f"http://127.0.0.1:8470{API}", transport=httpx.MockTransport(answer))
    for name, method in inspect.getmembers(client, callable):
        if name.startswith("_"):
            continue
        wanted = [p for p in inspect.signature(method).parameters.values() if p.default is p.empty]
        given = [EXAMPLES.get(p.name, "x") for p in wanted if p.kind is p.POSITIONAL_OR_KEYWORD]
        found = method(*given)
        if inspect.isgenerator(found):
            next(found, None)
    client.export("modes", "all.arrow")
    left = {
        (method, API + route.path)
        for router in ROUTERS
        for route in router.routes
        for method in route.methods
    }
    for method, path in asked:
        fit = {(m, p) for m, p in left if m == method and re.fullmatch(re.sub(r"{\w+}", "[^/]+", p), path)}
        left -= fit
    assert {path for _, path in left} == {
        f"{API}/oidc/login",
        f"{API}/oidc/callback",
    }  # those are a browser's


def test_awaited_it_answers_the_same(twin: Client, service: Service) -> None:
    waiting = AsyncClient("http://127.0.0.1:8470")
    waiting._client = twin

    async def asked() -> tuple[Any, Any, list[Any]]:
        one, every = await asyncio.gather(waiting.asset("wtg"), waiting.assets())
        return one, every, [version async for version in waiting.versions("wtg")]

    one, every, versions = asyncio.run(asked())
    assert every == [one]
    assert [version["version"] for version in versions] == [1]
    with pytest.raises(InputError, match="404"):
        asyncio.run(waiting.asset("nobody"))
    with pytest.raises(AttributeError):
        waiting.no_such_method()


def test_a_table_is_written_to_a_file(twin: Client, service: Service, tmp_path: Path) -> None:
    (tmp_path / "r.parquet").write_bytes(record_file(1))
    twin.send("wtg", tmp_path / "r.parquet", json.loads(description(hour(1))))
    turn(service, 2)
    rows = pq.read_table(twin.export("modes", tmp_path / "modes.parquet"))
    stream = pa.ipc.open_stream(twin.export("modes", tmp_path / "modes.arrow").read_bytes()).read_all()
    assert rows.to_pylist() == stream.to_pylist() and rows.num_rows == 2
