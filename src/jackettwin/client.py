"""A Python client of the living twin: all that its API does, at once or awaited.

>>> from jackettwin.client import Client
>>> with Client("http://127.0.0.1:8470", token="…") as twin:  # doctest: +SKIP
...     twin.send("demo", "day1.parquet")
...     frequencies = [m["frequency_hz"] for m in twin.modes("demo", label="fore_aft_1")]
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import Any

import httpx

from jackettwin.errors import InputError

API = "/api/v1"
Answer = dict[str, Any]
Answers = Iterator[Answer]


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

    def login(self, name: str, password: str) -> Answer:
        """Open a session instead of a token; return who you are."""
        found = self._asked("POST", "/login", json={"name": name, "password": password})
        self._http.headers["X-CSRF-Token"] = str(found["csrf_token"])
        return found

    def logout(self) -> None:
        """End the session or token."""
        self._asked("POST", "/logout")

    def me(self) -> Answer:
        """Return who you are."""
        return self._asked("GET", "/me")

    def change_password(self, old: str, new: str) -> None:
        """Change your own password."""
        self._asked("POST", "/me/password", json={"old": old, "new": new})

    def audit(self) -> Answers:
        """Yield who did what, newest first."""
        return self._pages("/audit")

    def users(self) -> Answers:
        """Yield the users."""
        return self._pages("/users")

    def add_user(self, name: str, role: str, **more: Any) -> Answer:
        """Add a user: ``password``, ``assets``, ``expires_utc``."""
        return self._asked("POST", "/users", json={"name": name, "role": role, **more})

    def groups(self) -> Answers:
        """Yield the groups of turbines."""
        return self._pages("/groups")

    def put_group(self, name: str, assets: Sequence[str]) -> Answer:
        """Say which turbines a group has."""
        return self._asked("PUT", f"/groups/{name}", json={"assets": list(assets)})

    def add_token(self, label: str, days: int = 365) -> Answer:
        """Make a token with your own role, which is told this once."""
        return self._asked("POST", "/tokens", json={"label": label, "days": days})

    def assets(self, *, archived: bool = False) -> list[Answer]:
        """Return the turbines with their status, or those that are archived."""
        return list(self._pages("/assets", archived=archived))

    def asset(self, name: str) -> Answer:
        """Return a turbine with its status."""
        return self._asked("GET", f"/assets/{name}")

    def add_asset(self, name: str, twin: str, files: Mapping[str, str] | None = None) -> Answer:
        """Add a turbine with the text of its twin file and of the files that this one names."""
        return self._asked("POST", "/assets", json={"name": name, "twin": twin, "files": dict(files or {})})

    def put_asset(
        self, name: str, twin: str, files: Mapping[str, str] | None = None, comment: str = ""
    ) -> Answer:
        """Put a new version of a turbine's twin; the old one's answers count until this one is adopted."""
        body = {"twin": twin, "files": dict(files or {}), "comment": comment}
        return self._asked("PUT", f"/assets/{name}", json=body)

    def draft(self, structure: Path | str, record: Path | str) -> Answer:
        """Return a twin drafted from files of a structure and a record, with its guesses; none is stored.

        Raises
        ------
        InputError
            If a file is refused; names field, value and remedy.
        """
        with Path(structure).open("rb") as deck, Path(record).open("rb") as samples:
            files = {"structure": (Path(structure).name, deck), "record": (Path(record).name, samples)}
            return self._asked("POST", "/drafts", files=files)

    def versions(self, asset: str) -> Answers:
        """Yield the versions of a turbine's twin."""
        return self._pages(f"/assets/{asset}/versions")

    def adopt(self, asset: str, version: int) -> Answer:
        """Make a version the one whose answers count."""
        return self._asked("POST", f"/assets/{asset}/versions/{version}/adopt")

    def archive(self, asset: str) -> Answer:
        """Take a turbine out of service; what it knew stays."""
        return self._asked("DELETE", f"/assets/{asset}", params={"confirm": asset})

    def unarchive(self, asset: str) -> Answer:
        """Bring a turbine back."""
        return self._asked("POST", f"/assets/{asset}/unarchive")

    def place(self, asset: str, latitude_deg: float, longitude_deg: float) -> Answer:
        """Say where a turbine stands (WGS 84)."""
        at = {"latitude_deg": latitude_deg, "longitude_deg": longitude_deg}
        return self._asked("PUT", f"/assets/{asset}/position", json=at)

    def send(self, asset: str, record: Path | str, description: Mapping[str, Any] | None = None) -> Answer:
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

    def put_conditions(
        self, asset: str, time_utc: Sequence[str], values: Mapping[str, Sequence[float | str | None]]
    ) -> Answer:
        """Send conditions of the site; return how many are new, and how many records they concern."""
        body = {"time_utc": list(time_utc), "values": {name: list(row) for name, row in values.items()}}
        return self._asked("POST", f"/assets/{asset}/conditions", json=body)

    def send_conditions(
        self, asset: str, table: Path | str, *, zone: str = "UTC", end_stamped: bool = False
    ) -> Answer:
        """Send a CSV of ten-minute statistics; return how many are new, and how many records they concern."""
        path = Path(table)
        data = {"zone": zone, "end_stamped": str(end_stamped).lower()}
        with path.open("rb") as stream:
            files = {"file": (path.name, stream)}
            return self._asked("POST", f"/assets/{asset}/conditions.csv", files=files, data=data)

    def records(self, asset: str, **query: Any) -> Answers:
        """Yield the records of a turbine, latest first; ``status``, ``from``, ``to`` choose."""
        return self._pages(f"/assets/{asset}/records", **query)

    def record(self, record_id: str) -> Answer:
        """Return a record and how far it got."""
        return self._asked("GET", f"/records/{record_id}")

    def signal(self, record_id: str, **query: Any) -> Answer:
        """Return extremes of its channels in bins: ``channels``, ``from``, ``to``, ``points``."""
        return self._asked("GET", f"/records/{record_id}/signal", params=query)

    def spectrum(self, record_id: str) -> Answer:
        """Return the power spectral densities of its channels."""
        return self._asked("GET", f"/records/{record_id}/spectrum")

    def spectrogram(self, record_id: str, **which: Any) -> Answer:
        """Return the density of a channel through time: ``channel``, ``up_to_hz``, ``segment_s``."""
        return self._asked("GET", f"/records/{record_id}/spectrogram", params=which)

    def motion(self, record_id: str, duration_s: float = 60.0) -> Answer:
        """Return its liveliest part as a motion of the structure."""
        return self._asked("GET", f"/records/{record_id}/motion", params={"duration_s": duration_s})

    def stretches(self, record_id: str) -> Answers:
        """Yield where its samples are missing or left out."""
        return self._pages(f"/records/{record_id}/stretches")

    def stabilisation(self, record_id: str) -> Answer:
        """Return its poles of every model order."""
        return self._asked("GET", f"/records/{record_id}/stabilisation")

    def pick(self, record_id: str, picks: Sequence[Mapping[str, Any]]) -> Answer:
        """Take the poles nearest to ``{"frequency_hz", "order"}`` instead of the automatic choice."""
        return self._asked("PUT", f"/records/{record_id}/picks", json={"picks": list(map(dict, picks))})

    def set_aside(self, record_id: str, comment: str) -> Answer:
        """Take back what a wrong record gave rise to."""
        return self._asked("POST", f"/records/{record_id}/set-aside", json={"comment": comment})

    def modes(self, asset: str, label: str | None = None, **query: Any) -> Answers:
        """Yield the modes of every record; ``label``, ``from``, ``to`` choose."""
        chosen = query if label is None else {**query, "label": label}
        return self._pages(f"/assets/{asset}/modes", **chosen)

    def mode_bins(self, asset: str, **query: Any) -> list[Answer]:
        """Return extremes and medians of modes in bins: ``label``, ``from``, ``to``, ``points``."""
        return list(self._pages(f"/assets/{asset}/modes/bins", **query))

    def twin(self, asset: str, at: str | None = None, **query: Any) -> Answer:
        """Return what the twin knows, now or at a time (ISO 8601 with zone); of a ``version``."""
        chosen = query if at is None else {**query, "at": at}
        return self._asked("GET", f"/assets/{asset}/twin", params=chosen)

    def supports(self, asset: str, **query: Any) -> Answer:
        """Return the stiffness of the supports on each day."""
        return self._asked("GET", f"/assets/{asset}/supports", params=query)

    def comparison(self, asset: str, version: int) -> Answer:
        """Return what another version of the twin knows of the same records beside the adopted one."""
        return self._asked("GET", f"/assets/{asset}/comparison", params={"version": version})

    def damping_budget(self, asset: str, **query: Any) -> list[Answer]:
        """Return whose damping each mode's is, by source."""
        return list(self._pages(f"/assets/{asset}/damping-budget", **query))

    def sensitivity(self, asset: str, **query: Any) -> list[Answer]:
        """Return by how much every updated parameter moves each measured mode."""
        return list(self._pages(f"/assets/{asset}/sensitivity", **query))

    def explored(self, asset: str, **query: Any) -> Answer:
        """Return cost surface, cost curves and root loci of the updated law around its medians."""
        return self._asked("GET", f"/assets/{asset}/explore", params=query)

    def assumptions(self, asset: str) -> list[Answer]:
        """Return what the answer takes for granted, and what nobody has confirmed."""
        return list(self._pages(f"/assets/{asset}/assumptions"))

    def confirm(self, asset: str, key: str, comment: str) -> Answer:
        """Say that a tolerance was settled; return the version of the twin that says so."""
        return self._asked("POST", f"/assets/{asset}/assumptions/{key}/confirm", json={"comment": comment})

    def structure(self, asset: str, **query: Any) -> Answer:
        """Return the structure to draw."""
        return self._asked("GET", f"/assets/{asset}/structure", params=query)

    def laws(self) -> list[Answer]:
        """Return the support laws that the server knows, with their parameters."""
        return list(self._pages("/laws"))

    def law(self, of: str, low_hz: float = 0.01, high_hz: float = 10.0) -> Answer:
        """Return storage, loss, creep and relaxation of a support law."""
        return self._asked("GET", "/law", params={"of": of, "low_hz": low_hz, "high_hz": high_hz})

    def watch(self, asset: str) -> Answer:
        """Return what each judged day showed, and the evidence for a change."""
        return self._asked("GET", f"/assets/{asset}/watch")

    def life(self, asset: str) -> Answers:
        """Yield the life at every joint."""
        return self._pages(f"/assets/{asset}/life")

    def export(self, table: str, to: Path | str) -> Path:
        """Write a whole table into a file: Parquet, or a stream of Arrow if its name ends in ``.arrow``."""
        path = Path(to)
        form = "arrow" if path.suffix == ".arrow" else "parquet"
        with self._http.stream("GET", f"/export.{form}", params={"table": table}) as answer:
            _refuse(answer)
            with path.open("wb") as out:
                for piece in answer.iter_bytes():
                    out.write(piece)
        return path

    def findings(self, asset: str, **query: Any) -> Answers:
        """Yield what was worth saying, newest first."""
        return self._pages(f"/assets/{asset}/findings", **query)

    def alarms(self, asset: str) -> Answers:
        """Yield what asks for a person, newest first."""
        return self._pages(f"/assets/{asset}/alarms")

    def acknowledge(self, alarm_id: int, comment: str) -> Answer:
        """Note that you took note of an alarm."""
        return self._asked("POST", f"/alarms/{alarm_id}/acknowledge", json={"comment": comment})

    def finding(self, finding_id: int) -> Answer:
        """Return a finding with all that people did with it."""
        return self._asked("GET", f"/findings/{finding_id}")

    def assign(self, finding_id: int, to: str | None, comment: str = "") -> Answer:
        """Say whose a finding is to look after; None for nobody's."""
        return self._asked("POST", f"/findings/{finding_id}/assign", json={"to": to, "comment": comment})

    def comment(self, finding_id: int, comment: str) -> Answer:
        """Say something of a finding."""
        return self._asked("POST", f"/findings/{finding_id}/comment", json={"comment": comment})

    def mute(self, finding_id: int, until_utc: datetime | str, comment: str = "") -> Answer:
        """Have nobody told of a finding, nor of the like of later days, until a time with its zone."""
        until = until_utc if isinstance(until_utc, str) else until_utc.isoformat()
        return self._asked(
            "POST", f"/findings/{finding_id}/mute", json={"until_utc": until, "comment": comment}
        )

    def close_finding(self, finding_id: int, reason: str) -> Answer:
        """Say that a finding needs nobody any more, and why."""
        return self._asked("POST", f"/findings/{finding_id}/close", json={"reason": reason})

    def reopen(self, finding_id: int, comment: str = "") -> Answer:
        """Have a finding need somebody after all."""
        return self._asked("POST", f"/findings/{finding_id}/reopen", json={"comment": comment})

    def alert_channels(self) -> Answers:
        """Yield the ways by which people are told."""
        return self._pages("/alert-channels")

    def add_alert_channel(
        self, name: str, channel: Mapping[str, Any], rules: Sequence[Mapping[str, Any]] = ({},)
    ) -> Answer:
        """Add a channel (``kind`` mail, webhook or mqtt) and what is told through it."""
        body = {"name": name, "channel": dict(channel), "rules": list(map(dict, rules))}
        return self._asked("POST", "/alert-channels", json=body)

    def try_alert_channel(self, name: str) -> Answer:
        """Send a message through a channel; return whether it was taken."""
        return self._asked("POST", f"/alert-channels/{name}/test")

    def remove_alert_channel(self, name: str) -> None:
        """Forget a channel that was added."""
        self._asked("DELETE", f"/alert-channels/{name}")

    def jobs(self, **query: Any) -> Answers:
        """Yield work, newest first; ``state`` chooses."""
        return self._pages("/jobs", **query)

    def job(self, job_id: int) -> Answer:
        """Return a piece of work."""
        return self._asked("GET", f"/jobs/{job_id}")

    def cancel(self, job_id: int) -> Answer:
        """Cancel work that is not done."""
        return self._asked("POST", f"/jobs/{job_id}/cancel")

    def retry(self, job_id: int) -> Answer:
        """Try work again that was set aside, failed or was cancelled."""
        return self._asked("POST", f"/jobs/{job_id}/retry")

    def health(self) -> Answer:
        """Return whether the server turns, and what it lacks."""
        return self._asked("GET", "/health")

    def ready(self) -> bool:
        """Tell whether records can be taken and observed now."""
        return self._http.get("/ready").is_success

    def metrics(self) -> str:
        """Return what an operator can alarm on, in the text form of Prometheus."""
        answer = self._http.get("/metrics")
        _refuse(answer)
        return answer.text

    def events(self, last_event_id: int | None = None) -> Answers:
        """Yield what happens, for ever: ``{"id", "event", "data"}``."""
        return self._streamed("/events", None if last_event_id is None else str(last_event_id))

    def live(self, asset: str) -> Answers:
        """Yield the packets of a turbine's stream as they arrive, for ever."""
        return (one for one in self._streamed(f"/assets/{asset}/live") if one["event"] == "packet")

    def _streamed(self, path: str, last: str | None = None) -> Answers:
        headers = {} if last is None else {"Last-Event-ID": last}
        while True:  # the server ends each stream after some minutes
            with self._http.stream("GET", path, headers=headers, timeout=None) as answer:
                _refuse(answer)
                event: dict[str, Any] = {}
                for line in answer.iter_lines():
                    name, _, value = line.partition(": ")
                    if name == "id":
                        headers = {"Last-Event-ID": value}
                    if not line and "data" in event:
                        yield {**event, "data": json.loads(event["data"])}
                    event = {} if not line else {**event, name: value}

    def _asked(self, method: str, path: str, **more: Any) -> Answer:
        answer = self._http.request(method, path, **more)
        _refuse(answer)
        found: Answer = answer.json() if answer.content else {}
        return found

    def _pages(self, path: str, **query: Any) -> Answers:
        while True:
            page = self._asked("GET", path, params=query)
            yield from page["items"]
            if page["next_cursor"] is None:
                return
            query["cursor"] = page["next_cursor"]


class AsyncClient:
    """The same for programs that wait for many things at once: every method of :class:`Client`, awaited.

    What yields there is gone through by ``async for``. Requests are sent by the threads of asyncio.

    >>> async def frequencies() -> list[float]:
    ...     async with AsyncClient("http://127.0.0.1:8470", token="…") as twin:
    ...         return [m["frequency_hz"] async for m in twin.modes("demo", label="fore_aft_1")]
    """

    def __init__(self, url: str, *, token: str | None = None, timeout_s: float = 60.0) -> None:
        self._client = Client(url, token=token, timeout_s=timeout_s)

    async def __aenter__(self) -> AsyncClient:
        """Return the client itself."""
        return self

    async def __aexit__(self, *_: object) -> None:
        """Close the connections."""
        self._client.__exit__(None, None, None)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """Return a method of the client, to be awaited."""
        method = getattr(self._client, name)
        if name.startswith("_") or not callable(method):
            raise AttributeError(name)
        if method.__annotations__["return"] == "Answers":
            return lambda *given, **named: _each(method(*given, **named))
        return lambda *given, **named: asyncio.to_thread(method, *given, **named)


async def _each(items: Answers) -> AsyncIterator[Answer]:
    end: Answer = {}
    while (item := await asyncio.to_thread(next, items, end)) is not end:
        yield item


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
