"""A store of every released version is opened by this one, says what it said, and is rebuilt to the same."""

import json
import sqlite3
import tarfile
from contextlib import closing
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import MetaData, create_engine, select
from tests.service.servers import opened
from tests.store.conftest import fresh
from tests.store.old_stores import documents, lay_out, schemas

from jackettwin.intervals import NORMAL_90, NORMAL_95
from jackettwin.service.store_commands import rebuild
from jackettwin.store import backup, handling, people, reading, results, sqlite_url, tables, writing
from jackettwin.store.columns import rounded


def test_a_store_is_kept_of_every_migration_that_was_released() -> None:
    released = set(Path(tables.__file__).parent.glob("migrations/versions/0*.py"))
    assert len(schemas()) == len(released) - 1  # of the newest there is none to upgrade


@pytest.mark.parametrize("schema", schemas())
def test_an_old_store_says_what_it_said(schema: str, tmp_path: Path) -> None:
    store = lay_out(schema, tmp_path / "store")
    level, share = (95, NORMAL_90 / NORMAL_95) if schema == "0100" else (90, 1.0)
    named = f"damping_ratio, damping_ratio_low_{level}, frequency_std_hz / frequency_hz"
    with closing(sqlite3.connect(store / "jackettwin.sqlite")) as old:
        said = old.execute(f"select {named} from modes order by id").fetchall()
    with opened(sqlite_url(store)) as database:
        with reading(database) as connection:
            modes = tables.modes.c
            now = select(modes.damping_ratio_low_90, modes.frequency_relative_std).order_by(modes.id)
            low, relative = zip(*connection.execute(now), strict=True)
            assert low == pytest.approx([ratio * (end / ratio) ** share for ratio, end, _ in said], rel=1e-12)
            assert relative == tuple(std for _, _, std in said) and None not in relative
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
            assert results.open_alarms(connection) == {"wtg_01": []}
            before = connection.execute(select(tables.states)).one()
        assert rebuild(database, store, None, None)["days"] == 1
        with reading(database) as connection:
            assert connection.execute(select(tables.states)).one() == before
    assert (store / f"jackettwin.schema-{schema}.sqlite").exists()


@pytest.mark.parametrize("schema", schemas())
def test_its_packed_observations_are_rebuilt_within_their_rounding(schema: str, tmp_path: Path) -> None:
    """What is observed from now on is rounded: what the day says moves by no more than 2⁻¹⁸."""
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
    assert _numbers(after) == pytest.approx(_numbers(before), rel=4e-4)  # sums of differences: 100 times 2⁻¹⁸


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


def test_a_store_of_an_unreleased_version_has_the_column_already(tmp_path: Path) -> None:
    """Versions between 0.1.0 and the next one had it in 0101, filled for what came since."""
    store = lay_out("0101", tmp_path / "store")
    with closing(sqlite3.connect(store / "jackettwin.sqlite")) as old, old:
        old.execute("alter table modes add column frequency_relative_std float")
        least_known = "asset, model_hash, frequency_relative_std, time_utc"
        old.execute(f"create index ix_modes_least_known on modes ({least_known})")
        old.execute("update modes set frequency_relative_std = frequency_std_hz / frequency_hz where id > 3")
    with opened(sqlite_url(store)) as database, reading(database) as connection:
        modes = tables.modes.c
        rows = select(modes.frequency_relative_std, modes.frequency_std_hz / modes.frequency_hz)
        assert all(kept == std for kept, std in connection.execute(rows).all())
        assert not compare_metadata(MigrationContext.configure(connection), tables.metadata)


def test_who_took_note_of_an_alarm_is_known_whatever_its_key(tmp_path: Path) -> None:
    """0.1.0 kept keys as long as they were; they are shortened since, and must still match."""
    store = lay_out("0100", tmp_path / "store")
    finding = {"asset": "wtg_01", "day": "2025-03-01", "code": "changed", "subject": "ü" * 240}
    with closing(sqlite3.connect(store / "jackettwin.sqlite")) as old, old:
        key = "/".join(finding.values())
        row = ("wtg_01", key, "anna", "2025-03-02 08:00:00.000000", "seen")
        old.execute(
            'insert into acknowledgements (asset, alarm_key, "by", time_utc, comment) values (?,?,?,?,?)', row
        )
    with opened(sqlite_url(store)) as database, reading(database) as connection:
        (act,) = handling.handled(connection, "wtg_01").history(finding)
        assert (act.action, act.by, act.comment) == ("acknowledge", "anna", "seen")


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
@pytest.mark.parametrize("schema", schemas())
def test_a_backup_that_an_old_version_wrote_is_restored(
    kind: str, schema: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """Its tables are those of then: some there are no more, some there were not yet."""
    written = _backup_of(schema, tmp_path)
    url = sqlite_url(tmp_path) if kind == "sqlite" else fresh(request.getfixturevalue("postgresql_url"))
    with opened(url) as database:
        counts = backup.restore(written, database, tmp_path / "new")
        assert counts["acknowledgements" if schema == "0100" else "handling"] == 1
        with reading(database) as connection:
            kept = connection.scalars(select(tables.observations.c.document))
            assert sorted(kept) == sorted(documents(schema))
            assert results.open_alarms(connection) == {"wtg_01": []}


def _backup_of(schema: str, folder: Path) -> Path:
    """Write a backup of an old store as its version did: every table but that of the servers."""
    engine = create_engine(sqlite_url(lay_out(schema, folder / "old")))
    there = MetaData()
    there.reflect(engine)
    with engine.connect() as connection, tarfile.open(folder / "old.tar.gz", "w:gz") as out:
        counts = {}
        for table in there.sorted_tables:
            if table.name in ("servers", "alembic_version"):
                continue
            rows = connection.execute(select(table)).mappings().all()
            lines = [{k: backup.plain_value(v) for k, v in row.items()} for row in rows]
            content = "".join(json.dumps(line) + "\n" for line in lines)
            backup._add(out, f"tables/{table.name}.jsonl", content.encode())
            counts[table.name] = len(lines)
        manifest = {"schema_version": schema, "tables": counts}
        backup._add(out, "manifest.json", json.dumps(manifest).encode())
    engine.dispose()
    return folder / "old.tar.gz"


def _numbers(value: object) -> list[float]:
    """Return every number of a document, in its order."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [x for part in value for x in _numbers(part)]
    return [float(value)] if isinstance(value, int | float) and not isinstance(value, bool) else []
