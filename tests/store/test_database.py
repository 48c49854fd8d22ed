"""The schema: one migration a release, never edited; older stores migrated once, with a copy, or refused."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import Engine, inspect, text
from tests.service.servers import opened
from tests.store.conftest import fresh

from jackettwin.errors import InputError
from jackettwin.store import backup, database as module, open_database, reading, tables, writing

NOW = datetime(2025, 3, 1, 12, tzinfo=UTC)
MIGRATIONS = Path(module.__file__).with_name("migrations")
RELEASED = {
    "0100_initial.py": "17d3a6aed6d1a270cf0bdfcb0335e61bbb664104849f32d2576a0eff7502b203",
    "0101_rights_and_alerts.py": "7586106d1360c5c7d65249c3d832c02ad5bb6aa09268c68ac33aa99816e457d1",
}
"""SHA-256 of every migration that stores have run. Whatever changes since is a migration of its own."""
NEXT = """
import sqlalchemy as sa
from alembic import op

revision = "0103"
down_revision = "0102"


def upgrade() -> None:
    op.add_column("windows", sa.Column("n_late", sa.Integer(), nullable=False, server_default="0"))


def downgrade() -> None:
    op.drop_column("windows", "n_late")
"""


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Of an empty database."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'twin.sqlite'}"
    return fresh(request.getfixturevalue("postgresql_url"))


@pytest.fixture
def old(url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A database of today's schema, with a turbine, in the hands of a version with one migration more."""
    with opened(url) as engine, writing(engine) as connection:
        row = {"name": "wtg", "created_utc": NOW, "adopted_version": 1}
        connection.execute(tables.assets.insert().values(**row))
    with_next_migration(tmp_path, monkeypatch)
    yield url


def with_next_migration(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(MIGRATIONS, folder / "migrations", ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "migrations" / "versions" / "0103_next.py").write_text(NEXT)
    monkeypatch.setattr(module, "_MIGRATIONS", folder / "migrations")
    for user in (module, backup):
        monkeypatch.setattr(user, "SCHEMA_VERSION", "0103")


def windows(engine: Engine, schema: str | None = None) -> list[str]:
    return [column["name"] for column in inspect(engine).get_columns("windows", schema=schema)]


def test_a_new_database_is_what_the_tables_say(url: str) -> None:
    with opened(url) as engine, engine.connect() as connection:
        strict = {"compare_type": True, "compare_server_default": True}
        context = MigrationContext.configure(connection, opts=strict)
        assert compare_metadata(context, tables.metadata) == []
        found = inspect(connection)
        for table in tables.metadata.sorted_tables:  # what the comparison leaves out
            key = found.get_pk_constraint(table.name)
            assert key["constrained_columns"] == [c.name for c in table.primary_key.columns]
            assert key["name"] == f"pk_{table.name}"


def test_released_migrations_are_never_edited() -> None:
    found = {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted((MIGRATIONS / "versions").glob("*.py"))
    }
    assert {name: found.get(name) for name in RELEASED} == RELEASED


def test_it_is_migrated_and_a_copy_is_kept(old: str, tmp_path: Path) -> None:
    with opened(old) as engine:
        assert "n_late" in windows(engine)
        with reading(engine) as connection:
            assert [row.name for row in connection.execute(tables.assets.select())] == ["wtg"]
    if old.startswith("sqlite"):
        copy, schema = f"sqlite:///{tmp_path / 'twin.schema-0102.sqlite'}", None
    else:
        copy, schema = old, "schema_0102"
    engine = open_database(copy, migrate=False)
    assert "n_late" not in windows(engine, schema)
    with reading(engine) as connection:
        name = "assets" if schema is None else f"{schema}.assets"
        assert connection.scalar(text(f"select count(*) from {name}")) == 1
    engine.dispose()


def test_servers_that_start_together_migrate_it_once(old: str) -> None:
    def start(_: int) -> bool:
        with opened(old) as engine:
            return "n_late" in windows(engine)

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(start, range(4))) == [True] * 4


def test_a_migration_that_fails_changes_nothing(old: str, monkeypatch: pytest.MonkeyPatch) -> None:
    original = command.upgrade

    def breaking(*arguments: object) -> None:
        original(*arguments)
        raise OSError("no space left")

    with monkeypatch.context() as broken:
        broken.setattr(command, "upgrade", breaking)
        with pytest.raises(OSError, match="no space"):
            open_database(old)
    engine = open_database(old, migrate=False)
    assert "n_late" not in windows(engine)
    engine.dispose()
    with opened(old) as engine:
        assert "n_late" in windows(engine)


@pytest.mark.parametrize(
    ("schema", "said"),
    [("9999", "newer version"), ("0004", "before 0.1.0"), ("0001", "jackettwin intake OLD/records")],
)
def test_a_schema_that_cannot_be_migrated_is_refused(url: str, schema: str, said: str) -> None:
    """The databases of versions that were never released had schemas 0001 to 0004."""
    with opened(url) as engine, writing(engine) as connection:
        connection.execute(text(f"update alembic_version set version_num = '{schema}'"))
    with pytest.raises(InputError, match=said):
        open_database(url)
