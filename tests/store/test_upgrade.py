"""A store of every released version is opened by this one, says what it said, and is rebuilt to the same."""

import json
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.service.servers import opened
from tests.store.old_stores import documents, lay_out, schemas

from jackettwin.service.store_commands import rebuild
from jackettwin.store import backup, people, reading, results, sqlite_url, tables, writing
from jackettwin.store.columns import rounded


def test_a_store_is_kept_of_every_migration_that_was_released() -> None:
    released = set(Path(tables.__file__).parent.glob("migrations/versions/0*.py"))
    assert len(schemas()) == len(released) - 1  # of the newest there is none to upgrade


@pytest.mark.parametrize("schema", schemas())
def test_an_old_store_says_what_it_said(schema: str, tmp_path: Path) -> None:
    store = lay_out(schema, tmp_path / "store")
    with opened(sqlite_url(store)) as database:
        with reading(database) as connection:
            kept = connection.execute(
                select(tables.observations.c.document).order_by(tables.observations.c.record_id)
            )
            assert [document for (document,) in kept] == documents(schema)
            assert [user.name for user in people.list_users(connection)] == [
                "admin_1",
                "engineer_1",
                "viewer_1",
            ]
            assert all(user.scope is None for user in people.list_users(connection))  # they see all
            assert results.unacknowledged_alarms(connection) == {"wtg_01": 0}
            before = connection.execute(select(tables.states)).one()
        assert rebuild(database, store, None, None)["days"] == 1
        with reading(database) as connection:
            assert connection.execute(select(tables.states)).one() == before
    assert (store / f"jackettwin.schema-{schema}.sqlite").exists()


@pytest.mark.parametrize("schema", schemas())
def test_its_packed_observations_are_rebuilt_within_their_rounding(schema: str, tmp_path: Path) -> None:
    """What is observed from now on is rounded: what the day says moves by no more than 2⁻²³."""
    store = lay_out(schema, tmp_path / "store")
    with opened(sqlite_url(store)) as database:
        with reading(database) as connection:
            before = json.loads(connection.scalar(select(tables.states.c.document)))
        with writing(database) as connection:
            rows = connection.execute(select(tables.observations)).all()
            for row in rows:
                same = tables.observations.c.record_id == row.record_id
                short = rounded(row.document)
                assert short != row.document
                connection.execute(tables.observations.update().where(same).values(document=short))
        rebuild(database, store, None, None)
        with reading(database) as connection:
            after = json.loads(connection.scalar(select(tables.states.c.document)))
    assert _numbers(after) == pytest.approx(_numbers(before), rel=1e-5)  # sums of differences: 100 times 2⁻²³


def test_a_backup_of_it_restores_into_this_version(tmp_path: Path) -> None:
    store = lay_out("0100", tmp_path / "store")
    with opened(sqlite_url(store)) as database:
        backup.backup(database, store, tmp_path / "all.tar.gz")
        new = tmp_path / "new"
        new.mkdir()
        with opened(sqlite_url(new)) as other:
            backup.restore(tmp_path / "all.tar.gz", other, new)
            with reading(database) as one, reading(other) as two:
                for table in (tables.observations, tables.users, tables.states):
                    rows = select(table).order_by(*table.primary_key.columns)
                    assert one.execute(rows).all() == two.execute(rows).all()


def _numbers(value: object) -> list[float]:
    """Return every number of a document, in its order."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [x for part in value for x in _numbers(part)]
    return [float(value)] if isinstance(value, int | float) and not isinstance(value, bool) else []
