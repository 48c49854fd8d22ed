"""Tables of the store, with one definition for SQLite and PostgreSQL.

Results of the engine are stored as documents of :mod:`jackettwin.files.stored_schema`; their other columns
are only search keys. All times are UTC.
"""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Column,
    DateTime,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    Text,
    UniqueConstraint,
)
from sqlalchemy.engine import Dialect
from sqlalchemy.types import TypeDecorator

from jackettwin.store import columns

FIRST_SCHEMA, SCHEMA_VERSION = "0100", "0102"
"""Migrations of 0.1.0 and of this version: databases between them are migrated when opened."""


class Utc(TypeDecorator[datetime]):
    """A time in UTC; as SQLite has no time zones, they are removed when storing and set when reading."""

    impl = DateTime(timezone=False)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Return the naive UTC time for the database."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError("a time without a zone cannot be stored")
        return value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: Any, dialect: Dialect) -> datetime | None:
        """Return the time with its zone."""
        return None if value is None else value.replace(tzinfo=UTC)


class Packed(TypeDecorator[str]):
    """A document that is compressed in the database and a text elsewhere."""

    impl = LargeBinary
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Dialect) -> bytes | None:
        """Return the bytes for the database."""
        return None if value is None else columns.pack(value)

    def process_result_value(self, value: Any, dialect: Dialect) -> str | None:
        """Return the text."""
        return None if value is None else columns.unpack(bytes(value))


BigId = BigInteger().with_variant(Integer, "sqlite")
"""A row number; SQLite counts automatically only in a column of type INTEGER."""

metadata = MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s",
        "pk": "pk_%(table_name)s",
    }
)

assets = Table(
    "assets",
    metadata,
    Column("name", String(64), primary_key=True),
    Column("created_utc", Utc, nullable=False),
    Column("adopted_version", Integer, nullable=False),
    Column("archived_utc", Utc, nullable=True),
    Column("latitude_deg", Float),
    Column("longitude_deg", Float),
)

versions = Table(
    "versions",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("version", Integer, primary_key=True),
    Column("model_hash", String(64), nullable=False),
    Column("settings_hash", String(64), nullable=False),
    Column("created_utc", Utc, nullable=False),
    Column("created_by", String(64), nullable=False),
    Column("bundle_hash", String(64), nullable=False),
    Column("bundle", LargeBinary, nullable=False),
    Column("comment", Text, nullable=False, default=""),
)
"""Versions of an asset's twin: the twin file and every file it names, as one archive."""

records = Table(
    "records",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("record_id", String(64), primary_key=True),
    Column("status", String(16), nullable=False),
    Column("start_utc", Utc, nullable=False),
    Column("duration_s", Float, nullable=False),
    Column("sample_rate_hz", Float, nullable=False),
    Column("channels", JSON, nullable=False),
    Column("conditions", JSON, nullable=False),
    Column("source_name", String(255), nullable=False),
    Column("received_utc", Utc, nullable=False),
    Column("waveform", String(255)),
    Column("size_bytes", BigInteger, nullable=False),
    Column("problem", JSON),
    Column("picks", JSON),
    Index("ix_records_time", "asset", "start_utc", "record_id"),
    Index("ix_records_status", "asset", "status"),
    Index("ix_records_content", "record_id"),
)
"""``status``: received, observing, observed, refused (with a problem), mismatched or set_aside (with a
reason)."""

work = Table(
    "work",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("kind", String(16), nullable=False),
    Column("asset", ForeignKey("assets.name"), nullable=False),
    Column("record_id", String(64), nullable=False),
    Column("version", Integer, nullable=False),
    Column("model_hash", String(64), nullable=False),
    Column("settings_hash", String(64), nullable=False),
    Column("code_version", String(32), nullable=False),
    Column("state", String(16), nullable=False),
    Column("priority", Integer, nullable=False, default=0),
    Column("tries", Integer, nullable=False, default=0),
    Column("owner", String(64)),
    Column("created_utc", Utc, nullable=False),
    Column("started_utc", Utc),
    Column("ended_utc", Utc),
    Column("reason", JSON),
    UniqueConstraint("asset", "record_id", "model_hash", "settings_hash", "code_version", "kind"),
    Index("ix_work_queue", "state", "priority", "id"),
    Index("ix_work_state", "state", "id"),
    Index("ix_work_fair", "state", "kind", "priority", "asset", "id"),
)
"""Jobs, one for each key. ``state``: queued, leased, done, failed, set_aside or cancelled."""

servers = Table(
    "servers",
    metadata,
    Column("id", String(64), primary_key=True),
    Column("beat", BigInteger, nullable=False),
    Column("started_utc", Utc, nullable=False),
    Column("about", JSON, nullable=False),
)
"""Servers that lease jobs. A server without heartbeat is dead; clocks are not compared."""

posts = Table(
    "posts",
    metadata,
    Column("name", String(32), primary_key=True),
    Column("server", String(64), nullable=False),
)
"""Duties that one of several servers performs for all, until it leaves or is dead."""

observations = Table(
    "observations",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("model_hash", String(64), primary_key=True),
    Column("settings_hash", String(64), primary_key=True),
    Column("record_id", String(64), primary_key=True),
    Column("start_utc", Utc, nullable=False),
    Column("code_version", String(32), nullable=False),
    Column("document", Packed, nullable=False),
    Index("ix_observations_time", "asset", "model_hash", "start_utc", "record_id"),
)


def _relative_std(context: Any) -> float | None:
    row = context.get_current_parameters()
    std, frequency = row.get("frequency_std_hz"), row["frequency_hz"]
    return None if std is None or not frequency else std / frequency


modes = Table(
    "modes",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("asset", ForeignKey("assets.name"), nullable=False),
    Column("model_hash", String(64), nullable=False),
    Column("model_version", Integer, nullable=False),
    Column("record_id", String(64), nullable=False),
    Column("time_utc", Utc, nullable=False),
    Column("label", String(64), nullable=False),
    Column("frequency_hz", Float, nullable=False),
    Column("frequency_std_hz", Float),
    Column("damping_ratio", Float),
    Column("damping_ratio_std", Float),
    Column("damping_ratio_low_90", Float),
    Column("damping_ratio_high_90", Float),
    Column("status", String(255), nullable=False),
    Column("frequency_relative_std", Float, default=_relative_std),
    Index("ix_modes_label", "asset", "label", "time_utc"),
    Index("ix_modes_least_known", "asset", "model_hash", "frequency_relative_std", "time_utc"),
    Index("ix_modes_record", "asset", "record_id"),
    Index("ix_modes_page", "asset", "model_hash", "id"),
)

mode_days = Table(
    "mode_days",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("model_hash", String(64), primary_key=True),
    Column("day", Integer, primary_key=True, autoincrement=False),
    Column("label", String(64), primary_key=True),
    Column("count", Integer, nullable=False),
    Column("simulated", Integer, nullable=False),
    Column("frequency_min_hz", Float, nullable=False),
    Column("frequency_median_hz", Float, nullable=False),
    Column("frequency_max_hz", Float, nullable=False),
    Column("damping_ratio_min", Float),
    Column("damping_ratio_median", Float),
    Column("damping_ratio_max", Float),
)
"""Modes of past days, which are numbered from 1970-01-01: what a plot of years shows of ``modes``. A day that
is missing is read there."""

states = Table(
    "states",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("model_hash", String(64), primary_key=True),
    Column("day", String(10), primary_key=True),
    Column("n_records", Integer, nullable=False),
    Column("document", Text, nullable=False),
    Column("document_hash", String(64), nullable=False),
)
"""State of each UTC day; the state of a twin is the sum of its days."""

knowledge = Table(
    "knowledge",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("version", Integer, primary_key=True),
    Column("computed_utc", Utc, nullable=False),
    Column("document", JSON, nullable=False),
    Column("report", LargeBinary),
)
"""Estimates from the newest state under a version, computed at low priority: ``known`` for the supports,
``judged`` for the state of monitoring, ``report`` for the compressed report."""

findings = Table(
    "findings",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("asset", ForeignKey("assets.name"), nullable=False),
    Column("model_hash", String(64), nullable=False),
    Column("record_id", String(64), nullable=False),
    Column("origin", String(16), nullable=False),
    Column("time_utc", Utc, nullable=False),
    Column("day", String(10), nullable=False),
    Column("code", String(64), nullable=False),
    Column("severity", String(8), nullable=False),
    Column("subject", String(255)),
    Column("params", JSON, nullable=False),
    Column("text", Text, nullable=False),
    Index("ix_findings_time", "asset", "time_utc"),
    Index("ix_findings_record", "asset", "record_id"),
    Index("ix_findings_page", "asset", "model_hash", "severity", "id"),
)
"""``origin``: observe, advance or watch. Those of advance are replaced when a day is advanced again, those
of watch, which belong to no single record (``record_id`` is empty), when the days are evaluated again."""

handling = Table(
    "handling",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("asset", ForeignKey("assets.name"), nullable=False),
    Column("alarm_key", String(255), nullable=False),
    Column("action", String(16), nullable=False),
    Column("by", String(64), nullable=False),
    Column("time_utc", Utc, nullable=False),
    Column("comment", Text, nullable=False),
    Column("to", String(64)),
    Column("until_utc", Utc),
    Index("ix_handling_finding", "asset", "alarm_key", "id"),
)
"""Actions of people on a finding, which is identified by its content; its status follows from the last
ones."""

conditions = Table(
    "conditions",
    metadata,
    Column("asset", ForeignKey("assets.name"), primary_key=True),
    Column("name", String(64), primary_key=True),
    Column("time_utc", Utc, primary_key=True),
    Column("value", Float),
    Column("text", String(64)),
)

packets = Table(
    "packets",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("asset", String(64), nullable=False),
    Column("channel", String(128), nullable=False),
    Column("t0_utc", Utc, nullable=False),
    Column("window_utc", Utc, nullable=False),
    Column("rate_hz", Float, nullable=False),
    Column("samples", LargeBinary, nullable=False),
    UniqueConstraint("asset", "channel", "t0_utc"),
    Index("ix_packets_window", "asset", "window_utc"),
)
"""Samples of a stream, stored until their window's record is final."""

windows = Table(
    "windows",
    metadata,
    Column("asset", String(64), primary_key=True),
    Column("window_utc", Utc, primary_key=True),
    Column("n_packets", Integer, nullable=False),
    Column("n_known", Integer, nullable=False),
    Column("record_id", String(64)),
)
"""Number of packets of a window, the record made from it, and the number of packets in that."""

users = Table(
    "users",
    metadata,
    Column("name", String(64), primary_key=True),
    Column("role", String(16), nullable=False),
    Column("password_hash", String(255), nullable=False),
    Column("created_utc", Utc, nullable=False),
    Column("disabled", Boolean, nullable=False, default=False),
    Column("scope", JSON(none_as_null=True)),
    Column("expires_utc", Utc),
    Column("password_utc", Utc),
)
"""``scope``: the assets and, after an ``@``, the groups visible to a user; NULL for all."""

asset_groups = Table(
    "asset_groups",
    metadata,
    Column("name", String(64), primary_key=True),
    Column("asset", ForeignKey("assets.name"), primary_key=True),
)

tokens = Table(
    "tokens",
    metadata,
    Column("hash", String(64), primary_key=True),
    Column("kind", String(16), nullable=False),
    Column("user", ForeignKey("users.name", ondelete="CASCADE"), nullable=False),
    Column("label", String(128), nullable=False),
    Column("csrf", String(64), nullable=False),
    Column("created_utc", Utc, nullable=False),
    Column("expires_utc", Utc, nullable=False),
)
"""Sessions of browsers and tokens of machines; only hashes are stored."""

audit = Table(
    "audit",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("time_utc", Utc, nullable=False),
    Column("who", String(64), nullable=False),
    Column("action", String(64), nullable=False),
    Column("subject", String(255), nullable=False),
    Column("outcome", String(64), nullable=False),
)

events = Table(
    "events",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("time_utc", Utc, nullable=False),
    Column("kind", String(16), nullable=False),
    Column("asset", String(64), nullable=False),
    Column("payload", JSON, nullable=False),
    Index("ix_events_asset", "asset", "id"),
)
"""Events in order of commits. Every change of a response about an asset adds one; the newest is the version
of all its responses."""

settings = Table(
    "settings",
    metadata,
    Column("name", String(64), primary_key=True),
    Column("value", JSON, nullable=False),
)

alerts = Table(
    "alerts",
    metadata,
    Column("id", BigId, primary_key=True, autoincrement=True),
    Column("channel", String(64), nullable=False),
    Column("key", String(255), nullable=False),
    Column("asset", String(64), nullable=False),
    Column("message", JSON, nullable=False),
    Column("state", String(16), nullable=False),
    Column("tries", Integer, nullable=False, default=0),
    Column("created_utc", Utc, nullable=False),
    Column("due_utc", Utc, nullable=False),
    Column("ended_utc", Utc),
    Column("problem", Text),
    UniqueConstraint("channel", "key"),
    Index("ix_alerts_due", "state", "due_utc"),
)
"""Alerts, one for each channel and key. ``state``: waiting, sent, withdrawn (it was handled before, or no
longer applies) or given_up."""
