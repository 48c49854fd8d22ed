"""A server's outbox, turned by hand; somebody who reads what it posts; findings to tell."""

from __future__ import annotations

import json
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import yaml

from jackettwin.service.alerts.outbox import Outbox
from jackettwin.service.alerts.rules import read_alerts
from jackettwin.service.context import Service
from jackettwin.store import alerts, assets, handling, reading, results, writing

SECRET = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"


class Receiver:
    """A server that keeps what is posted to it, and answers what it is told to."""

    def __init__(self) -> None:
        self.got: list[tuple[dict[str, str], bytes]] = []
        self.answer = 200
        outer = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                body = self.rfile.read(int(self.headers["content-length"]))
                outer.got.append(({name.lower(): value for name, value in self.headers.items()}, body))
                self.send_response(outer.answer)
                self.send_header("Content-Length", "0")
                self.end_headers()

            def log_message(self, *_: Any) -> None:
                """Say nothing."""

        self.server = HTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}/hook"
        Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()

    @property
    def bodies(self) -> list[dict[str, Any]]:
        return [json.loads(body) for _, body in self.got]


def write(folder: Path, **document: Any) -> Path:
    (folder / "key").write_text(SECRET + "\n")
    file = folder / "alerts.yaml"
    file.write_text(yaml.safe_dump(document))
    return file


def outbox(service: Service, **document: Any) -> Outbox:
    """Return a server's outbox that has looked for the first time."""
    made = Outbox(
        service,
        read_alerts(write(service.settings.store, **{"silent_hours": None, **document})),
        service.settings.store,
    )
    made.turn()
    return made


def hook(receiver: Receiver, **more: Any) -> dict[str, Any]:
    return {"kind": "webhook", "url": receiver.url, **more}


def found(service: Service, code: str = "structure_changed", severity: str = "alarm", **more: Any) -> str:
    """Have something found; return its key."""
    asset = more.get("asset", "wtg")
    with writing(service.database) as connection:
        row = {
            "asset": asset,
            "model_hash": assets.found_version(connection, asset).model_hash,
            "record_id": "",
            "origin": "watch",
            "time_utc": service.now(),
            "day": "2025-03-01",
            "code": code,
            "severity": severity,
            "subject": "fore_aft_1",
            "params": {},
            "text": "it fell by 2 %",
            **more,
        }
        results.put_findings(connection, [row])
    return handling.finding_key(row)


def states(service: Service) -> dict[str, str]:
    with reading(service.database) as connection:
        return {f"{a.channel} {a.key}": a.state for a in alerts.newest(connection, 100)}
