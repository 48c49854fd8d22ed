"""Indexes for many records; windows count their packets as they come."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Add them, and count the packets that are there."""
    op.create_index("ix_work_state", "work", ["state", "id"])
    op.create_index("ix_records_content", "records", ["record_id"])
    op.create_index("ix_modes_page", "modes", ["asset", "model_hash", "id"])
    op.create_index("ix_findings_page", "findings", ["asset", "model_hash", "severity", "id"])
    with op.batch_alter_table("windows") as windows:
        windows.add_column(sa.Column("n_known", sa.Integer(), nullable=False, server_default="0"))
    op.execute(
        "update windows set n_known = (select count(*) from packets where packets.asset = windows.asset "
        "and packets.window_utc = windows.window_utc)"
    )
    op.execute(
        "insert into windows (asset, window_utc, n_packets, n_known, record_id) "
        "select asset, window_utc, 0, count(*), null from packets p where not exists "
        "(select 1 from windows w where w.asset = p.asset and w.window_utc = p.window_utc) "
        "group by asset, window_utc"
    )


def downgrade() -> None:
    """Take them away again; windows without a record are found by their packets."""
    op.execute("delete from windows where n_packets = 0")
    with op.batch_alter_table("windows") as windows:
        windows.drop_column("n_known")
    op.drop_index("ix_findings_page", table_name="findings")
    op.drop_index("ix_modes_page", table_name="modes")
    op.drop_index("ix_work_state", table_name="work")
    op.drop_index("ix_records_content", table_name="records")
