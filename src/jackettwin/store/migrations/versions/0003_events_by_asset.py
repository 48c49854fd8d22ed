"""The newest event of an asset is found at once: it tells whether an answer is still what it was."""

from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Add the index."""
    op.create_index("ix_events_asset", "events", ["asset", "id"])


def downgrade() -> None:
    """Take it away again."""
    op.drop_index("ix_events_asset", table_name="events")
