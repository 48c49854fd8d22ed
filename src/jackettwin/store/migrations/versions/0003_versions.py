"""The newest event of an asset is found at once; what days say of the supports is kept by version, with a page."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Add the index; every version of a model is said to know what the model did."""
    op.create_index("ix_events_asset", "events", ["asset", "id"])
    op.rename_table("knowledge", "knowledge_before")
    op.create_table(
        "knowledge",
        sa.Column("asset", sa.String(length=64), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("computed_utc", sa.DateTime(), nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.Column("report", sa.LargeBinary(), nullable=True),
        sa.ForeignKeyConstraint(["asset"], ["assets.name"], name=op.f("fk_knowledge_version_asset")),
        sa.PrimaryKeyConstraint("asset", "version", name=op.f("pk_knowledge_version")),
    )
    op.execute(
        "insert into knowledge (asset, version, computed_utc, document) select k.asset, v.version, "
        "k.computed_utc, k.document from knowledge_before k "
        "join versions v on k.asset = v.asset and k.model_hash = v.model_hash"
    )
    op.drop_table("knowledge_before")


def downgrade() -> None:
    """Take the index away, and what is not of the adopted version."""
    op.drop_index("ix_events_asset", table_name="events")
    op.rename_table("knowledge", "knowledge_after")
    op.create_table(
        "knowledge",
        sa.Column("asset", sa.String(length=64), nullable=False),
        sa.Column("model_hash", sa.String(length=64), nullable=False),
        sa.Column("computed_utc", sa.DateTime(), nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["asset"], ["assets.name"], name=op.f("fk_knowledge_asset")),
        sa.PrimaryKeyConstraint("asset", "model_hash", name=op.f("pk_knowledge")),
    )
    op.execute(
        "insert into knowledge (asset, model_hash, computed_utc, document) "
        "select k.asset, v.model_hash, k.computed_utc, k.document from knowledge_after k "
        "join versions v on k.asset = v.asset and k.version = v.version "
        "join assets a on a.name = k.asset and a.adopted_version = k.version"
    )
    op.drop_table("knowledge_after")
