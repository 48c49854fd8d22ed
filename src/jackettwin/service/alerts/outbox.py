"""Outbox of alerts: collects, sends, repeats and withdraws them."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from itertools import groupby
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

import httpx
from sqlalchemy import Connection
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.service.alerts.channels import AnyChannel
from jackettwin.service.alerts.kept_channels import merged
from jackettwin.service.alerts.notice import NotDelivered, Notice
from jackettwin.service.alerts.rules import Alerts, Rule, is_fresh, read_alerts
from jackettwin.store import (
    alerts,
    assets,
    handling,
    journal,
    reading,
    results,
    rights,
    settings,
    work,
    writing,
)

if TYPE_CHECKING:
    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

_TURN_S = 2.0
_FIRST_WAIT, _LONGEST_WAIT = timedelta(seconds=30), timedelta(hours=1)
MOST_TRIES = 30
"""Tries of a failing channel, about a day, before its pending alerts are dropped."""
_AT_ONCE = 500
"""Largest number of findings in one message."""
_SILENCE = "silence"
"""Origin of findings on assets that send no records."""


class Outbox(Thread):
    """Thread that sends alerts; of several servers on one store only one does."""

    def __init__(self, service: Service, file: Alerts | None, folder: Path) -> None:
        super().__init__(name="alerts", daemon=True)
        self._service, self._file, self._folder = service, file, folder
        self._told = file or Alerts(channels={}, rules=[])
        self._stop_asked = Event()
        self._looked_at: set[int] = set()

    def run(self) -> None:
        """Run until stopped, waiting while the database is not available."""
        while not self._stop_asked.wait(_TURN_S):
            try:
                self.turn()
            except (SQLAlchemyError, OSError, InputError) as error:
                log.warning("alerts wait: %s", str(error).partition("\n")[0])
            except Exception:
                log.exception("alerts continue after an internal error")

    def stop(self) -> None:
        """Stop after the current message; the next server sends the remaining ones."""
        self._stop_asked.set()

    def turn(self) -> None:
        """Collect new findings and send due alerts."""
        with reading(self._service.database) as connection:
            told = merged(connection, self._service.settings.store, self._file)
        if told is None:
            return
        self._told = told
        with writing(self._service.database) as connection:
            if not work.hold_duty(connection, "alerts", self._service.server_id):
                return
            self._note_silence(connection)
            self._note_new(connection)
        for name, group in groupby(sorted(self._due(), key=lambda alert: alert.channel), lambda a: a.channel):
            self._send(name, list(group)[:_AT_ONCE])

    def _note_silence(self, connection: Connection) -> None:
        """Add findings on assets without recent records, and withdraw those on assets that send again."""
        hours, now = self._told.silent_hours, self._service.now()
        if hours is None:
            return
        said = results.silent_assets(connection)
        for asset in assets.summaries(connection):
            last = asset.last_record_utc or asset.created_utc
            silent = now - last > timedelta(hours=hours)
            named = f"{'latest record' if asset.last_record_utc else 'added'} {last:%Y-%m-%d %H:%M} UTC"
            if silent and said.get(asset.name) != named:
                results.drop_findings(connection, asset.name, asset.model_hash, origin=_SILENCE)
                self._say_silent(connection, asset, last, named)
            elif not silent and asset.name in said:
                results.drop_findings(connection, asset.name, asset.model_hash, origin=_SILENCE)
                journal.tell(connection, "finding", asset.name, {"code": "asset_silent", "over": True}, now)

    def _say_silent(self, connection: Connection, asset: assets.Summary, last: datetime, named: str) -> None:
        now = self._service.now()
        said = Finding("asset_silent", named, {"hours": self._told.silent_hours})
        row = {name: getattr(said, name) for name in ("code", "severity", "subject", "params", "text")}
        key = {"asset": asset.name, "model_hash": asset.model_hash, "record_id": "", "origin": _SILENCE}
        results.put_findings(connection, [{**row, **key, "time_utc": now, "day": f"{last:%Y-%m-%d}"}])
        journal.tell(connection, "finding", asset.name, row, now)

    def _note_new(self, connection: Connection) -> None:
        """Apply the rules to findings since the last call; the first call only marks the start."""
        seen = settings.get(connection, settings.ALERTED)
        if seen is None:
            newest = alerts.newest_finding(connection)
            settings.put(connection, settings.ALERTED, {"first": newest, "last": newest})
            return
        after = max(seen["first"], seen["last"] - alerts.LOOK_BACK)
        found = alerts.findings_after(connection, after)
        new = [finding for finding in found if finding["id"] not in self._looked_at]
        for rule in self._told.rules if new else ():
            named = rights.visible(connection, rule.assets)
            for finding in new:
                if rule.tells(finding, named) and is_fresh(finding, self._service.now()):
                    self._add(connection, rule, finding)
        self._looked_at = {finding["id"] for finding in found}
        if new and new[-1]["id"] > seen["last"]:
            settings.put(connection, settings.ALERTED, {**seen, "last": new[-1]["id"]})

    def _add(self, connection: Connection, rule: Rule, finding: dict[str, Any]) -> None:
        now, key = self._service.now(), handling.finding_key(finding)
        named = ("asset", "code", "severity", "subject", "text", "day", "params")
        message = {name: finding[name] for name in named}
        message |= {"time_utc": finding["time_utc"].isoformat(), "key": key}
        alerts.add(connection, rule.channel, key, finding["asset"], message, now, rule.due(finding, now))
        if rule.escalate is not None:
            after, to = rule.escalate.after_minutes, rule.escalate.channel
            later = {**message, "unanswered_minutes": after}
            due = now + timedelta(minutes=after)
            alerts.add(connection, to, f"unanswered {key}", finding["asset"], later, now, due)

    def _due(self) -> list[alerts.Alert]:
        """Return the alerts to send now.

        Acknowledged alerts and those that no longer apply are withdrawn; muted ones wait.
        """
        now = self._service.now()
        with reading(self._service.database) as connection:
            found = alerts.due(connection, now)
            if not found:
                return []
            handled = handling.handled(connection)
            stands = {alert.id: handled.standing(alerts.finding_of(alert)) for alert in found}
            gone = {
                alert.id
                for alert in found
                if stands[alert.id].answered or not alerts.still_found(connection, alert)
            }
        if gone:
            with writing(self._service.database) as connection:
                alerts.end(connection, gone, alerts.WITHDRAWN, now)
        return [alert for alert in found if stands[alert.id].open and alert.id not in gone]

    def _send(self, name: str, group: Sequence[alerts.Alert]) -> None:
        channel = self._told.channels.get(name)
        problem = None if channel is not None else "the channel no longer exists"
        ids, now = [alert.id for alert in group], self._service.now()
        if channel is not None:
            notice = Notice([alert.message for alert in group], self._told.address)
            problem = _sent(channel, notice, self._folder)
        with writing(self._service.database) as connection:
            if problem is None:
                alerts.end(connection, ids, alerts.SENT, now)
                return
            log.warning("%d alerts were not delivered by %s: %s", len(ids), name, problem)
            for alert in group:
                wait = min(_FIRST_WAIT * 2 ** min(alert.tries, 20), _LONGEST_WAIT)
                alerts.try_again(connection, [alert.id], now + wait, problem)
            out = [alert.id for alert in group if alert.tries + 1 >= MOST_TRIES]
            if out:
                alerts.end(connection, out, alerts.GIVEN_UP, now)


def tried_channels(file: Path) -> dict[str, str | None]:
    """Send a test message by each channel of an alerts file; return the error of each channel, or None.

    Raises
    ------
    InputError
        If the file is not valid.
    """
    told = read_alerts(file)
    return {name: tried(channel, told.address, file.parent) for name, channel in told.channels.items()}


def tried(channel: AnyChannel, address: str | None, folder: Path) -> str | None:
    """Send a test message by a channel; return the reason if it was not accepted, otherwise None.

    Parameters
    ----------
    address : of the server for users, or None
    folder : of the files that the channel names
    """
    now = datetime.now(UTC)
    said: dict[str, Any] = {
        "asset": "none",
        "code": "try",
        "severity": "info",
        "subject": None,
        "text": "this is a test message: its recipients will receive alerts",
        "day": f"{now:%Y-%m-%d}",
        "time_utc": now.isoformat(),
        "params": {},
        "key": f"try {now.isoformat()}",
    }
    return _sent(channel, Notice([said], address), folder)


def _sent(channel: AnyChannel, notice: Notice, folder: Path) -> str | None:
    """Send a message; return the reason if it was not accepted, otherwise None."""
    try:
        channel.send(notice, folder)
    except (OSError, httpx.HTTPError, NotDelivered, InputError) as error:
        return str(error) or type(error).__name__
    return None
