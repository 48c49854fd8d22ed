"""How uncertain each frequency is, and the index that finds the modes which are known least."""

import sqlalchemy as sa
from alembic import op

revision = "0102"
down_revision = "0101"

COLUMN, INDEX = "frequency_relative_std", "ix_modes_least_known"


def upgrade() -> None:
    """Add column and index, unless an unreleased version did so within 0101."""
    there = sa.inspect(op.get_bind())
    if COLUMN not in {column["name"] for column in there.get_columns("modes")}:
        op.add_column("modes", sa.Column(COLUMN, sa.Float()))
    op.execute(
        "update modes set frequency_relative_std = frequency_std_hz / frequency_hz where frequency_hz > 0"
    )
    if INDEX not in {index["name"] for index in there.get_indexes("modes")}:
        op.create_index(INDEX, "modes", ["asset", "model_hash", COLUMN, "time_utc"])


def downgrade() -> None:
    """Leave both: a backup of 0101 may hold the column, and one that does not leaves it empty."""
