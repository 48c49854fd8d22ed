"""Channels that an admin adds to a running server, stored with their secrets in separate files.

Clients send secrets, never names of files. Each secret is written to a file of the server, and the channel is
then like one of the alerts file.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service.alerts.rules import Alerts, read_alerts
from jackettwin.store import settings

FILES = {"password": "password_file", "url": "url_file", "secret": "secret_file", "ca": "ca"}
"""Secrets by field, and the channel's field with the name of their file."""


@cache
def of_file(file: Path | None) -> Alerts | None:
    """Return the server's alerts file as read at its start."""
    return None if file is None else read_alerts(file)


def merged(connection: Connection, store: Path, told: Alerts | None) -> Alerts | None:
    """Return the alerts file with the channels of the store; None if there is neither."""
    kept = settings.get(connection, settings.ALERT_CHANNELS)
    return told if not kept else _merged(kept, store, told)


def add_channel(
    connection: Connection,
    store: Path,
    told: Alerts | None,
    name: str,
    channel: Mapping[str, Any],
    rules: Sequence[Mapping[str, Any]],
) -> Alerts:
    """Store a channel and its rules; return all channels.

    Raises
    ------
    InputError
        If the name is in use, or the channel is not valid.
    """
    kept = settings.get(connection, settings.ALERT_CHANNELS) or {}
    if name in kept or (told is not None and name in told.channels):
        raise InputError("there is a channel of this name", field="name", value=name)
    plain = {field: value for field, value in channel.items() if field not in FILES}
    secrets = {field: str(value) for field, value in channel.items() if field in FILES}
    kept[name] = {"channel": plain, "in_files": sorted(secrets), "rules": list(rules)}
    _write(store, name, secrets)
    try:
        found = _merged(kept, store, told)
        found.channels[name].check(store)
    except InputError as error:
        _forget_files(store, name)
        value = (
            None if str(store.resolve()) in str(error.value) else error.value
        )  # the path is not shown to clients
        raise InputError(error.problem, field=error.field, value=value, allowed=error.allowed) from None
    settings.put(connection, settings.ALERT_CHANNELS, kept)
    return found


def remove_channel(connection: Connection, store: Path, name: str) -> bool:
    """Delete a channel, its secrets and pending alerts; return whether the store had it."""
    kept = settings.get(connection, settings.ALERT_CHANNELS) or {}
    if kept.pop(name, None) is None:
        return False
    settings.put(connection, settings.ALERT_CHANNELS, kept or None)
    _forget_files(store, name)
    return True


def _merged(kept: Mapping[str, Any], store: Path, told: Alerts | None) -> Alerts:
    channels: dict[str, Any] = {} if told is None else dict(told.channels)
    rules: list[Any] = [] if told is None else list(told.rules)
    for name, of in kept.items():
        files = {FILES[field]: _file(store, name, field) for field in of["in_files"]}
        channels[name] = {**of["channel"], **files}
        rules += [{**rule, "channel": name} for rule in of["rules"]]
    own = {} if told is None else told.model_dump(include={"silent_hours", "address"})
    return Alerts(channels=channels, rules=rules, **own)


def _file(store: Path, name: str, field: str) -> Path:
    return store.resolve() / "secrets" / f"{name}.{field}"


def _write(store: Path, name: str, secrets: Mapping[str, str]) -> None:
    for field, value in secrets.items():
        path = _file(store, name, field)
        path.parent.mkdir(mode=0o700, exist_ok=True)
        with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w", encoding="utf-8") as file:
            file.write(value + "\n")


def _forget_files(store: Path, name: str) -> None:
    for field in FILES:
        _file(store, name, field).unlink(missing_ok=True)
