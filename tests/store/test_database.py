"""A database of the schema before: migrated when it is opened, kept as it was, once for all who start."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from sqlalchemy import Engine, inspect, text
from tests.service.servers import opened
from tests.store.conftest import fresh

from jackettwin.errors import InputError
from jackettwin.store import database as module, open_database, reading, streams, tables, writing

BEFORE = "0001"


def at(minute: int) -> str:
    """Return a time as SQLite keeps it."""
    return f"2025-03-01 12:{minute:02d}:00.000000"


@pytest.fixture(params=["sqlite", "postgresql"])
def old(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """A database of the schema before, with a turbine whose stream has an open and a closed window."""
    url = f"sqlite:///{tmp_path / 'twin.sqlite'}"
    if request.param == "postgresql":
        url = fresh(request.getfixturevalue("postgresql_url"))
    engine = open_database(url, migrate=False)
    with writing(engine) as connection:
        config = Config()
        config.set_main_option("script_location", str(Path(module.__file__).with_name("migrations")))
        config.attributes["connection"] = connection
        command.upgrade(config, BEFORE)
        connection.execute(
            text("insert into assets (name, created_utc, adopted_version) values ('wtg', :t, 1)"),
            {"t": at(0)},
        )
        for k, minute in enumerate((0, 0, 10)):
            row = {
                "t": f"2025-03-01 12:{minute + k:02d}:00.000000",
                "w": f"2025-03-01 12:{minute:02d}:00.000000",
            }
            connection.execute(
                text(
                    "insert into packets (asset, channel, t0_utc, window_utc, rate_hz, samples) "
                    "values ('wtg', 'a', :t, :w, 1.0, :s)"
                ),
                {**row, "s": b"\0" * 8},
            )
        connection.execute(
            text("insert into windows (asset, window_utc, n_packets, record_id) values ('wtg', :t, 2, 'r')"),
            {"t": at(0)},
        )
    engine.dispose()
    yield url


def differences(engine: Engine) -> list[object]:
    with engine.connect() as connection:
        return list(compare_metadata(MigrationContext.configure(connection), tables.metadata))


def test_it_is_migrated_and_a_copy_is_kept(old: str, tmp_path: Path) -> None:
    with opened(old) as engine:
        assert differences(engine) == []
        with reading(engine) as connection:
            assert [row.name for row in connection.execute(tables.assets.select())] == ["wtg"]
            assert [w.n_known for w in streams.open_windows(connection)] == [1]  # of the second window
    if old.startswith("sqlite"):
        copy, schema = f"sqlite:///{tmp_path / 'twin.schema-0001.sqlite'}", None
    else:
        copy, schema = old, "schema_0001"
    engine = open_database(copy, migrate=False)
    assert "n_known" not in [c["name"] for c in inspect(engine).get_columns("windows", schema=schema)]
    with reading(engine) as connection:
        name = "packets" if schema is None else f"{schema}.packets"
        assert connection.scalar(text(f"select count(*) from {name}")) == 3
    engine.dispose()


def test_servers_that_start_together_migrate_it_once(old: str) -> None:
    def start(_: int) -> int:
        with opened(old) as engine:
            return len(differences(engine))

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(start, range(4))) == [0] * 4


def test_a_migration_that_fails_leaves_everything_as_it_was(old: str, monkeypatch) -> None:
    original = module.command.upgrade

    def breaking(*arguments: object) -> None:
        original(*arguments)
        raise OSError("no space left")

    monkeypatch.setattr(module.command, "upgrade", breaking)
    with pytest.raises(OSError, match="no space"):
        open_database(old)
    monkeypatch.undo()
    with opened(old) as engine:
        assert differences(engine) == []


def test_a_newer_one_is_refused(old: str) -> None:
    with opened(old) as engine, writing(engine) as connection:
        connection.execute(text("update alembic_version set version_num = '9999'"))
    with pytest.raises(InputError, match="newer version"):
        open_database(old)
