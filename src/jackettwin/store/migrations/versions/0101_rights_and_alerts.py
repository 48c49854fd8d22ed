"""Rights by asset, positions, findings that people deal with, alerts, shared posts, observations in columns, intervals of 90 %."""

import hashlib

import sqlalchemy as sa
from alembic import op

revision = "0101"
down_revision = "0100"

TO_90 = 1.6448536269514722 / 1.959963984540054
"""Logarithm of half a 90 % interval over that of a 95 % one."""
ROW_NUMBER = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Add columns and tables; observations become bytes, those that are there as the text they were."""
    with op.batch_alter_table("users") as users:
        users.add_column(sa.Column("scope", sa.JSON()))
        users.add_column(sa.Column("expires_utc", sa.DateTime()))
        users.add_column(sa.Column("password_utc", sa.DateTime()))
    op.add_column("assets", sa.Column("latitude_deg", sa.Float()))
    op.add_column("assets", sa.Column("longitude_deg", sa.Float()))
    op.create_table(
        "asset_groups",
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
    )
    op.create_table(
        "mode_days",
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), primary_key=True),
        sa.Column("model_hash", sa.String(64), primary_key=True),
        sa.Column("day", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("label", sa.String(64), primary_key=True),
        sa.Column("count", sa.Integer(), nullable=False),
        sa.Column("simulated", sa.Integer(), nullable=False),
        *(sa.Column(f"frequency_{what}_hz", sa.Float(), nullable=False) for what in ("min", "median", "max")),
        *(sa.Column(f"damping_ratio_{what}", sa.Float()) for what in ("min", "median", "max")),
    )
    op.create_table(
        "posts",
        sa.Column("name", sa.String(32), primary_key=True),
        sa.Column("server", sa.String(64), nullable=False),
    )
    op.create_table(
        "handling",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), nullable=False),
        sa.Column("alarm_key", sa.String(255), nullable=False),
        sa.Column("action", sa.String(16), nullable=False),
        sa.Column("by", sa.String(64), nullable=False),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
        sa.Column("to", sa.String(64)),
        sa.Column("until_utc", sa.DateTime()),
    )
    op.create_index("ix_handling_finding", "handling", ["asset", "alarm_key", "id"])
    _acknowledgements_become_lines()
    op.create_table(
        "alerts",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("channel", sa.String(64), nullable=False),
        sa.Column("key", sa.String(255), nullable=False),
        sa.Column("asset", sa.String(64), nullable=False),
        sa.Column("message", sa.JSON(), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("tries", sa.Integer(), nullable=False),
        sa.Column("created_utc", sa.DateTime(), nullable=False),
        sa.Column("due_utc", sa.DateTime(), nullable=False),
        sa.Column("ended_utc", sa.DateTime()),
        sa.Column("problem", sa.Text()),
        sa.UniqueConstraint("channel", "key"),
    )
    op.create_index("ix_alerts_due", "alerts", ["state", "due_utc"])
    op.create_index("ix_work_fair", "work", ["state", "kind", "priority", "asset", "id"])
    _intervals("95", "90", TO_90)
    if op.get_bind().dialect.name == "postgresql":
        op.execute("alter table observations alter document type bytea using convert_to(document, 'UTF8')")
    else:
        with op.batch_alter_table("observations") as observations:
            observations.alter_column("document", type_=sa.LargeBinary(), existing_nullable=False)
        op.execute("update observations set document = cast(document as blob)")


def _intervals(level: str, new: str, share: float) -> None:
    """Rename the ends of the intervals of damping, and bring them to another level, on the logarithm."""
    own = op.get_bind().connection.driver_connection
    if own is not None and op.get_bind().dialect.name == "sqlite":
        own.create_function("power", 2, pow)
    with op.batch_alter_table("modes") as modes:
        for end in ("low", "high"):
            modes.alter_column(f"damping_ratio_{end}_{level}", new_column_name=f"damping_ratio_{end}_{new}")
    ends = [f"damping_ratio_{end}_{new}" for end in ("low", "high")]
    table = sa.table("modes", *(sa.column(name, sa.Float) for name in ("damping_ratio", *ends)))
    zeta = table.c.damping_ratio
    for bound in (table.c[name] for name in ends):
        known = sa.and_(zeta > 0.0, bound.is_not(None))
        scaled = zeta * sa.func.power(bound / zeta, share)
        op.execute(sa.update(table).where(known).values({bound: scaled}))


def _acknowledgements_become_lines() -> None:
    """Keep who took note of what among all that people did; long keys end in a hash from now on."""
    named = ("asset", "alarm_key", "by", "time_utc", "comment")
    handling = sa.table("handling", *(sa.column(name) for name in (*named, "action")))
    known = sa.table("acknowledgements", *(sa.column(name) for name in ("id", *named)))
    query = sa.select(*(known.c[name] for name in named)).order_by(known.c.id)
    for row in op.get_bind().execute(query).mappings().all():
        key = row["alarm_key"]
        short = key if len(key) <= 240 else f"{key[:175]} {hashlib.sha256(key.encode()).hexdigest()}"
        line = {**row, "alarm_key": short, "action": "acknowledge"}
        op.get_bind().execute(sa.insert(handling).values(**line))
    op.drop_table("acknowledgements")


def downgrade() -> None:
    """Take an empty database back, into which a backup of the version before is to be restored."""
    if op.get_bind().scalar(sa.text("select count(*) from observations")):
        raise NotImplementedError("put back the copy that was made before the upgrade")
    op.create_table(
        "acknowledgements",
        sa.Column("id", ROW_NUMBER, primary_key=True),
        sa.Column("asset", sa.String(64), sa.ForeignKey("assets.name"), nullable=False),
        sa.Column("alarm_key", sa.String(255), nullable=False, unique=True),
        sa.Column("by", sa.String(64), nullable=False),
        sa.Column("time_utc", sa.DateTime(), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
    )
    op.drop_index("ix_work_fair", "work")
    _intervals("90", "95", 1.0 / TO_90)
    for table in ("alerts", "handling", "posts", "mode_days", "asset_groups"):
        op.drop_table(table)
    with op.batch_alter_table("users") as users:
        for column in ("scope", "expires_utc", "password_utc"):
            users.drop_column(column)
    with op.batch_alter_table("assets") as assets:
        assets.drop_column("latitude_deg")
        assets.drop_column("longitude_deg")
    if op.get_bind().dialect.name == "postgresql":
        op.execute("alter table observations alter document type text using ''")
    else:
        with op.batch_alter_table("observations") as observations:
            observations.alter_column("document", type_=sa.Text(), existing_nullable=False)
