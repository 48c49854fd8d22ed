"""Settings of a whole store, common to all its servers."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, delete, insert, select

from jackettwin.store.tables import settings

RAW_DAYS, OBSERVATION_DAYS = "raw_days", "observation_days"
JOB_DAYS, AUDIT_DAYS = "job_days", "audit_days"
"""Settings of the days for which raw samples of observed records, observations, finished jobs and the audit
log are stored; without a value there is no limit."""


MQTT_CLIENT = "mqtt_client"
"""Client identifier of the store at the broker."""

ALERTED = "alerted"
"""Numbers of the newest finding when alerts began, and of the last processed one."""

ALERT_CHANNELS = "alert_channels"
"""Channels that were added to a running server, and the rules of each; their secrets are in files."""


def get(connection: Connection, name: str) -> Any:
    """Return a setting, or None."""
    return connection.scalar(select(settings.c.value).where(settings.c.name == name))


def put(connection: Connection, name: str, value: Any) -> None:
    """Store a setting; None deletes it."""
    connection.execute(delete(settings).where(settings.c.name == name))
    if value is not None:
        connection.execute(insert(settings).values(name=name, value=value))
