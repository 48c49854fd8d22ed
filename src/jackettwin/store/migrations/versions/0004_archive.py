"""An asset can be archived."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Add when it was; nothing is yet."""
    with op.batch_alter_table("assets") as assets:
        assets.add_column(sa.Column("archived_utc", sa.DateTime(), nullable=True))


def downgrade() -> None:
    """Forget it: everything is back."""
    with op.batch_alter_table("assets") as assets:
        assets.drop_column("archived_utc")
