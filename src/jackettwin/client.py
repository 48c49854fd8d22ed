"""A Python client of the living twin: records in, answers out, as data frames where wanted.

>>> from jackettwin.client import Client
>>> with Client("http://127.0.0.1:8470", token="…") as twin:  # doctest: +SKIP
...     twin.send("demo", "day1.parquet")
...     frequencies = [m["frequency_hz"] for m in twin.modes("demo", label="fore_aft_1")]
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import httpx

from jackettwin.errors import InputError

API = "/api/v1"


class Client:
    """A session with a server.

    Parameters
    ----------
    url : str
        Of the server, such as ``http://127.0.0.1:8470``.
    token : str, optional
        Of ``jackettwin token add``; an open server on this machine needs none.
    timeout_s : float
        For one request.
    """

    def __init__(self, url: str, *, token: str | None = None, timeout_s: float = 60.0) -> None:
        headers = {} if token is None else {"Authorization": f"Bearer {token}"}
        self._http = httpx.Client(base_url=url.rstrip("/") + API, headers=headers, timeout=timeout_s)

    def __enter__(self) -> Client:
        """Return the client itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the connections."""
        self._http.close()

    def assets(self) -> list[dict[str, Any]]:
        """Return the turbines with their status."""
        return list(self._pages("/assets"))

    def add_asset(self, name: str, twin: str, files: Mapping[str, str] | None = None) -> dict[str, Any]:
        """Add a turbine with the text of its twin file and of the files that this one names."""
        return self._asked("POST", "/assets", json={"name": name, "twin": twin, "files": dict(files or {})})

    def send(
        self, asset: str, record: Path | str, description: Mapping[str, Any] | None = None
    ) -> dict[str, Any]:
        """Send a record file, and what lies beside it; return ``record_id`` and ``job_id``.

        Raises
        ------
        InputError
            If the file is refused; names field, value and remedy.
        """
        path = Path(record)
        beside = path.with_suffix(".json")
        if description is None and beside.exists() and beside != path:
            description = json.loads(beside.read_text())
        data = {} if description is None else {"description": json.dumps(description)}
        with path.open("rb") as stream:
            return self._asked(
                "POST", f"/assets/{asset}/records", files={"file": (path.name, stream)}, data=data
            )

    def send_conditions(
        self, asset: str, table: Path | str, *, zone: str = "UTC", end_stamped: bool = False
    ) -> dict[str, Any]:
        """Send a CSV of ten-minute statistics; return how many are new, and how many records they concern."""
        path = Path(table)
        data = {"zone": zone, "end_stamped": str(end_stamped).lower()}
        with path.open("rb") as stream:
            files = {"file": (path.name, stream)}
            return self._asked("POST", f"/assets/{asset}/conditions.csv", files=files, data=data)

    def records(self, asset: str, **query: Any) -> Iterator[dict[str, Any]]:
        """Yield the records of a turbine, latest first; ``status``, ``from``, ``to`` choose."""
        return self._pages(f"/assets/{asset}/records", **query)

    def modes(self, asset: str, label: str | None = None, **query: Any) -> Iterator[dict[str, Any]]:
        """Yield the modes of every record; ``label``, ``from``, ``to`` choose."""
        chosen = query if label is None else {**query, "label": label}
        return self._pages(f"/assets/{asset}/modes", **chosen)

    def twin(self, asset: str, at: str | None = None) -> dict[str, Any]:
        """Return what the twin knows, now or at a time (ISO 8601 with zone)."""
        return self._asked("GET", f"/assets/{asset}/twin", params={} if at is None else {"at": at})

    def comparison(self, asset: str, version: int) -> dict[str, Any]:
        """Return what another version of the twin knows of the same records beside the adopted one."""
        return self._asked("GET", f"/assets/{asset}/comparison", params={"version": version})

    def damping_budget(self, asset: str) -> list[dict[str, Any]]:
        """Return whose damping each mode's is, by source."""
        return list(self._pages(f"/assets/{asset}/damping-budget"))

    def sensitivity(self, asset: str) -> list[dict[str, Any]]:
        """Return by how much every updated parameter moves each measured mode."""
        return list(self._pages(f"/assets/{asset}/sensitivity"))

    def structure(self, asset: str) -> dict[str, Any]:
        """Return the structure to draw, its updated complex modes and what was measured of each."""
        return self._asked("GET", f"/assets/{asset}/structure")

    def explored(self, asset: str) -> dict[str, Any]:
        """Return cost surface, cost curves and root loci of the updated law around its medians."""
        return self._asked("GET", f"/assets/{asset}/explore")

    def assumptions(self, asset: str) -> list[dict[str, Any]]:
        """Return what the answer takes for granted, and what nobody has confirmed."""
        return list(self._pages(f"/assets/{asset}/assumptions"))

    def confirm(self, asset: str, key: str, comment: str) -> dict[str, Any]:
        """Say that a tolerance was settled; return the version of the twin that says so."""
        return self._asked("POST", f"/assets/{asset}/assumptions/{key}/confirm", json={"comment": comment})

    def findings(self, asset: str, **query: Any) -> Iterator[dict[str, Any]]:
        """Yield what was worth saying, newest first."""
        return self._pages(f"/assets/{asset}/findings", **query)

    def alarms(self, asset: str) -> Iterator[dict[str, Any]]:
        """Yield what asks for a person, newest first."""
        return self._pages(f"/assets/{asset}/alarms")

    def acknowledge(self, alarm_id: int, comment: str) -> dict[str, Any]:
        """Note that you took note of an alarm."""
        return self._asked("POST", f"/alarms/{alarm_id}/acknowledge", json={"comment": comment})

    def job(self, job_id: int) -> dict[str, Any]:
        """Return a piece of work."""
        return self._asked("GET", f"/jobs/{job_id}")

    def events(self, last_event_id: int | None = None) -> Iterator[dict[str, Any]]:
        """Yield what happens, for ever: ``{"id", "event", "data"}``."""
        headers = {} if last_event_id is None else {"Last-Event-ID": str(last_event_id)}
        while True:  # the server ends each stream after some minutes
            with self._http.stream("GET", "/events", headers=headers, timeout=None) as answer:
                _refuse(answer)
                event: dict[str, Any] = {}
                for line in answer.iter_lines():
                    name, _, value = line.partition(": ")
                    if name == "id":
                        headers = {"Last-Event-ID": value}
                    if not line and "data" in event:
                        yield {**event, "data": json.loads(event["data"])}
                    event = {} if not line else {**event, name: value}

    def _asked(self, method: str, path: str, **more: Any) -> dict[str, Any]:
        answer = self._http.request(method, path, **more)
        _refuse(answer)
        found: dict[str, Any] = answer.json()
        return found

    def _pages(self, path: str, **query: Any) -> Iterator[dict[str, Any]]:
        while True:
            page = self._asked("GET", path, params=query)
            yield from page["items"]
            if page["next_cursor"] is None:
                return
            query["cursor"] = page["next_cursor"]


def _refuse(answer: httpx.Response) -> None:
    """Raise what a problem document says.

    Raises
    ------
    InputError
        If the server refused the request.
    """
    if answer.is_success:
        return
    answer.read()
    try:
        problem = answer.json()
    except ValueError:
        answer.raise_for_status()
        raise
    parts = {key: problem.get(key) for key in ("field", "value", "allowed", "remedy")}
    raise InputError(f"{answer.status_code} {problem['detail']}", **parts)
