"""The schema of 0.1.0, the first release."""

import sqlalchemy as sa
from alembic import op

revision = "0100"
down_revision = None

ROW_NUMBER = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Make every table; keys and constraints are named by the convention of ``store.tables``."""
    op.create_table(
        "assets",
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("created_utc", sa.DateTime(), nullable=False),
        sa.Column("adopted_version", sa.Integer(), nullable=False),
        sa.Column("archived_utc", sa.DateTime()),
    )
    op.create_table(
        "audit",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("who", sa.String(64), nullable=False),
        sa.Column("action", sa.String(64), nullable=False),
        sa.Column("subject", sa.String(255), nullable=False),
        sa.Column("outcome", sa.String(64), nullable=False),
    )
    op.create_table(
        "events",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("asset", sa.String(64), nullable=False),
        sa.Column("payload", sa.JSON(), nullable=False),
    )
    op.create_index("ix_events_asset", "events", ["asset", "id"])
    op.create_table(
        "packets",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("asset", sa.String(64), nullable=False),
        sa.Column("channel", sa.String(128), nullable=False),
        sa.Column("t0_utc", sa.DateTime(), nullable=False),
        sa.Column("window_utc", sa.DateTime(), nullable=False),
        sa.Column("rate_hz", sa.Float(), nullable=False),
        sa.Column("samples", sa.LargeBinary(), nullable=False),
        sa.UniqueConstraint("asset", "channel", "t0_utc"),
    )
    op.create_index("ix_packets_window", "packets", ["asset", "window_utc"])
    op.create_table(
        "servers",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("beat", sa.BigInteger(), nullable=False),
        sa.Column("started_utc", sa.DateTime(), nullable=False),
        sa.Column("about", sa.JSON(), nullable=False),
    )
    op.create_table(
        "settings",
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("value", sa.JSON(), nullable=False),
    )
    op.create_table(
        "users",
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("role", sa.String(16), nullable=False),
        sa.Column("password_hash", sa.String(255), nullable=False),
        sa.Column("created_utc", sa.DateTime(), nullable=False),
        sa.Column("disabled", sa.Boolean(), nullable=False),
    )
    op.create_table(
        "windows",
        sa.Column("asset", sa.String(64), primary_key=True),
        sa.Column("window_utc", sa.DateTime(), primary_key=True),
        sa.Column("n_packets", sa.Integer(), nullable=False),
        sa.Column("n_known", sa.Integer(), nullable=False),
        sa.Column("record_id", sa.String(64)),
    )
    op.create_table(
        "acknowledgements",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), nullable=False),
        sa.Column("alarm_key", sa.String(255), nullable=False, unique=True),
        sa.Column("by", sa.String(64), nullable=False),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
    )
    op.create_table(
        "conditions",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("time_utc", sa.DateTime(), primary_key=True),
        sa.Column("value", sa.Float()),
        sa.Column("text", sa.String(64)),
    )
    op.create_table(
        "findings",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), nullable=False),
        sa.Column("model_hash", sa.String(64), nullable=False),
        sa.Column("record_id", sa.String(64), nullable=False),
        sa.Column("origin", sa.String(16), nullable=False),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("day", sa.String(10), nullable=False),
        sa.Column("code", sa.String(64), nullable=False),
        sa.Column("severity", sa.String(8), nullable=False),
        sa.Column("subject", sa.String(255)),
        sa.Column("params", sa.JSON(), nullable=False),
        sa.Column("text", sa.Text(), nullable=False),
    )
    op.create_index("ix_findings_page", "findings", ["asset", "model_hash", "severity", "id"])
    op.create_index("ix_findings_record", "findings", ["asset", "record_id"])
    op.create_index("ix_findings_time", "findings", ["asset", "time_utc"])
    op.create_table(
        "knowledge",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("version", sa.Integer(), primary_key=True),
        sa.Column("computed_utc", sa.DateTime(), nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.Column("report", sa.LargeBinary()),
    )
    op.create_table(
        "modes",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), nullable=False),
        sa.Column("model_hash", sa.String(64), nullable=False),
        sa.Column("model_version", sa.Integer(), nullable=False),
        sa.Column("record_id", sa.String(64), nullable=False),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("label", sa.String(64), nullable=False),
        sa.Column("frequency_hz", sa.Float(), nullable=False),
        sa.Column("frequency_std_hz", sa.Float()),
        sa.Column("damping_ratio", sa.Float()),
        sa.Column("damping_ratio_std", sa.Float()),
        sa.Column("damping_ratio_low_95", sa.Float()),
        sa.Column("damping_ratio_high_95", sa.Float()),
        sa.Column("status", sa.String(255), nullable=False),
    )
    op.create_index("ix_modes_label", "modes", ["asset", "label", "time_utc"])
    op.create_index("ix_modes_page", "modes", ["asset", "model_hash", "id"])
    op.create_index("ix_modes_record", "modes", ["asset", "record_id"])
    op.create_table(
        "observations",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("model_hash", sa.String(64), primary_key=True),
        sa.Column("settings_hash", sa.String(64), primary_key=True),
        sa.Column("record_id", sa.String(64), primary_key=True),
        sa.Column("start_utc", sa.DateTime(), nullable=False),
        sa.Column("code_version", sa.String(32), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
    )
    op.create_index("ix_observations_time", "observations", ["asset", "model_hash", "start_utc", "record_id"])
    op.create_table(
        "records",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("record_id", sa.String(64), primary_key=True),
        sa.Column("status", sa.String(16), nullable=False),
        sa.Column("start_utc", sa.DateTime(), nullable=False),
        sa.Column("duration_s", sa.Float(), nullable=False),
        sa.Column("sample_rate_hz", sa.Float(), nullable=False),
        sa.Column("channels", sa.JSON(), nullable=False),
        sa.Column("conditions", sa.JSON(), nullable=False),
        sa.Column("source_name", sa.String(255), nullable=False),
        sa.Column("received_utc", sa.DateTime(), nullable=False),
        sa.Column("waveform", sa.String(255)),
        sa.Column("size_bytes", sa.BigInteger(), nullable=False),
        sa.Column("problem", sa.JSON()),
        sa.Column("picks", sa.JSON()),
    )
    op.create_index("ix_records_content", "records", ["record_id"])
    op.create_index("ix_records_status", "records", ["asset", "status"])
    op.create_index("ix_records_time", "records", ["asset", "start_utc", "record_id"])
    op.create_table(
        "states",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("model_hash", sa.String(64), primary_key=True),
        sa.Column("day", sa.String(10), primary_key=True),
        sa.Column("n_records", sa.Integer(), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.Column("document_hash", sa.String(64), nullable=False),
    )
    op.create_table(
        "tokens",
        sa.Column("hash", sa.String(64), primary_key=True),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("user", sa.String(64), sa.ForeignKey("users.name", ondelete="CASCADE"), nullable=False),
        sa.Column("label", sa.String(128), nullable=False),
        sa.Column("csrf", sa.String(64), nullable=False),
        sa.Column("created_utc", sa.DateTime(), nullable=False),
        sa.Column("expires_utc", sa.DateTime(), nullable=False),
    )
    op.create_table(
        "versions",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("version", sa.Integer(), primary_key=True),
        sa.Column("model_hash", sa.String(64), nullable=False),
        sa.Column("settings_hash", sa.String(64), nullable=False),
        sa.Column("created_utc", sa.DateTime(), nullable=False),
        sa.Column("created_by", sa.String(64), nullable=False),
        sa.Column("bundle_hash", sa.String(64), nullable=False),
        sa.Column("bundle", sa.LargeBinary(), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
    )
    op.create_table(
        "work",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), nullable=False),
        sa.Column("record_id", sa.String(64), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("model_hash", sa.String(64), nullable=False),
        sa.Column("settings_hash", sa.String(64), nullable=False),
        sa.Column("code_version", sa.String(32), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("priority", sa.Integer(), nullable=False),
        sa.Column("tries", sa.Integer(), nullable=False),
        sa.Column("owner", sa.String(64)),
        sa.Column("created_utc", sa.DateTime(), nullable=False),
        sa.Column("started_utc", sa.DateTime()),
        sa.Column("ended_utc", sa.DateTime()),
        sa.Column("reason", sa.JSON()),
        sa.UniqueConstraint("asset", "record_id", "model_hash", "settings_hash", "code_version", "kind"),
    )
    op.create_index("ix_work_queue", "work", ["state", "priority", "id"])
    op.create_index("ix_work_state", "work", ["state", "id"])


def downgrade() -> None:
    """Drop every table, those first that refer to others."""
    for name in (
        "work",
        "versions",
        "tokens",
        "states",
        "records",
        "observations",
        "modes",
        "knowledge",
        "findings",
        "conditions",
        "acknowledgements",
        "windows",
        "users",
        "settings",
        "servers",
        "packets",
        "events",
        "audit",
        "assets",
    ):
        op.drop_table(name)
