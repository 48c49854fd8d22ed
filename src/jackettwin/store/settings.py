"""What holds for a whole store, whoever serves it."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, delete, insert, select

from jackettwin.store.tables import settings

RAW_DAYS, OBSERVATION_DAYS = "raw_days", "observation_days"
JOB_DAYS, AUDIT_DAYS = "job_days", "audit_days"
"""How many days raw samples of observed records, observations, ended work and the audit log are kept; without
one, for ever."""


MQTT_CLIENT = "mqtt_client"
"""The name by which the broker knows the store."""

ALERTED = "alerted"
"""The numbers of the newest finding when alerts began, and of the last one that was looked at."""

ALERT_CHANNELS = "alert_channels"
"""Channels that were added to a running server, and the rules of each; their secrets lie in files."""


def get(connection: Connection, name: str) -> Any:
    """Return a setting, or None."""
    return connection.scalar(select(settings.c.value).where(settings.c.name == name))


def put(connection: Connection, name: str, value: Any) -> None:
    """Keep a setting; None takes it away."""
    connection.execute(delete(settings).where(settings.c.name == name))
    if value is not None:
        connection.execute(insert(settings).values(name=name, value=value))
