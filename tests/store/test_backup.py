"""A backup restores into either kind of database; a damaged one restores nothing."""

import tarfile
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from sqlalchemy import Engine, func, select, text
from tests.store.test_database import with_next_migration

from jackettwin.cli.restore import restore_command
from jackettwin.errors import InputError
from jackettwin.records import Channel, Record
from jackettwin.store import (
    assets,
    journal,
    open_database,
    records,
    results,
    tables,
    waveform_path,
    write_waveform,
    writing,
)
from jackettwin.store.backup import backup, restore

NOW = datetime(2025, 3, 1, 12, tzinfo=UTC)


def filled(database: Engine, store: Path) -> None:
    place = waveform_path("wtg", NOW, "ab12")
    write_waveform(Record(np.zeros((1, 9)), 1.0, (Channel("a"),), NOW), store / place)
    with writing(database) as c:
        assets.add_version(
            c,
            "wtg",
            {"twin.yaml": b"structure: jacket15"},
            model_hash="m",
            settings_hash="s",
            by="me",
            now=NOW,
        )
        records.add_record(
            c, records.StoredRecord("wtg", "ab12", "received", NOW, 9.0, 1.0, [], {}, "f", NOW, place, 1)
        )
        journal.tell(c, "record", "wtg", {"record_id": "ab12"}, NOW)


def test_a_backup_restores_to_the_same_rows(database: Engine, tmp_path: Path) -> None:
    filled(database, tmp_path / "a")
    backup(database, tmp_path / "a", tmp_path / "all.tar.gz")
    other = open_database(f"sqlite:///{tmp_path / 'other.sqlite'}")
    counts = restore(tmp_path / "all.tar.gz", other, tmp_path / "b")
    assert counts["records"] == counts["assets"] == counts["versions"] == 1
    with writing(database) as one, writing(other) as two:
        for table in (tables.records, tables.versions, tables.events):
            assert one.execute(select(table)).all() == two.execute(select(table)).all()
        journal.tell(two, "record", "wtg", {}, NOW)  # numbers go on
        assert journal.last_event(two) == 2
    place = waveform_path("wtg", NOW, "ab12")
    assert (tmp_path / "b" / place).read_bytes() == (tmp_path / "a" / place).read_bytes()


def test_a_damaged_backup_restores_nothing(database: Engine, tmp_path: Path) -> None:
    filled(database, tmp_path / "a")
    file = tmp_path / "all.tar.gz"
    backup(database, tmp_path / "a", file)
    file.write_bytes(file.read_bytes()[:-200])
    other = open_database(f"sqlite:///{tmp_path / 'other.sqlite'}")
    with pytest.raises(InputError, match="not a complete backup"):
        restore(file, other, tmp_path / "b")
    with writing(other) as c:
        assert c.scalar(select(func.count()).select_from(tables.assets)) == 0


def test_a_store_that_holds_something_is_not_overwritten(database: Engine, tmp_path: Path) -> None:
    filled(database, tmp_path / "a")
    backup(database, tmp_path / "a", tmp_path / "all.tar.gz")
    with pytest.raises(InputError, match="not empty"):
        restore(tmp_path / "all.tar.gz", database, tmp_path / "b")


def test_a_backup_of_an_older_schema_is_read_for_ever(
    database: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is put into tables as they were then, which are then migrated."""
    filled(database, tmp_path / "a")
    with writing(database) as c:
        results.put_knowledge(c, "wtg", 1, {"known": {"law": "zener"}, "judged": None}, None, NOW)
        c.execute(tables.windows.insert().values(asset="wtg", window_utc=NOW, n_packets=2, n_known=2))
    backup(database, tmp_path / "a", tmp_path / "old.tar.gz")
    with_next_migration(tmp_path, monkeypatch)
    other = open_database(f"sqlite:///{tmp_path / 'other.sqlite'}")
    counts = restore(tmp_path / "old.tar.gz", other, tmp_path / "b")
    assert (counts["records"], counts["knowledge"], counts["windows"]) == (1, 1, 1)
    with other.connect() as c:
        assert results.find_supports(c, "wtg", 1) == {"law": "zener", "reported": False}
        assert records.find_record(c, "wtg", "ab12").start_utc == NOW
        assert c.scalar(text("select n_late from windows")) == 0
    other.dispose()


@pytest.mark.parametrize(("schema", "said"), [("0004", "before 0.1.0"), ("9999", "newer version")])
def test_a_backup_of_a_schema_that_cannot_be_migrated_is_refused(
    database: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, schema: str, said: str
) -> None:
    filled(database, tmp_path / "a")
    with monkeypatch.context() as then:
        then.setattr("jackettwin.store.backup.SCHEMA_VERSION", schema)
        backup(database, tmp_path / "a", tmp_path / "other.tar.gz")
    other = open_database(f"sqlite:///{tmp_path / 'other.sqlite'}")
    with pytest.raises(InputError, match=said):
        restore(tmp_path / "other.tar.gz", other, tmp_path / "b")
    other.dispose()


def test_a_failed_restore_leaves_no_store_behind(tmp_path: Path) -> None:
    (tmp_path / "none.tar.gz").write_bytes(b"no backup")
    found = CliRunner().invoke(restore_command, [str(tmp_path / "none.tar.gz"), str(tmp_path / "new")])
    assert isinstance(found.exception, InputError)
    assert not (tmp_path / "new").exists()


def test_backups_that_follow_one_another_are_the_store_again(database: Engine, tmp_path: Path) -> None:
    """Observations that changed, went or came since; waveforms that came or were pruned."""
    store, new = tmp_path / "a", tmp_path / "b"
    filled(database, store)

    def put(day: int, text: str, number: str = "ab12") -> None:
        at = NOW + timedelta(days=day)
        seen = results.StoredObservation("wtg", "m", "s", f"{number}{day}", at, "1", text)
        with writing(database) as c:
            results.put_observation(c, seen, [], [])

    def waveform(number: str) -> Path:
        place = waveform_path("wtg", NOW, number)
        write_waveform(Record(np.ones((1, 9)), 1.0, (Channel("a"),), NOW), store / place)
        with writing(database) as c:
            about = (NOW, 9.0, 1.0, [], {}, "f", NOW, place, 1)
            records.add_record(c, records.StoredRecord("wtg", number, "received", *about))
        return store / place

    files = [tmp_path / f"{k}.tar.gz" for k in range(3)]
    for day in range(3):
        put(day, f'{{"day": {day}}}')
    backup(database, store, files[0])
    put(1, '{"day": "another"}')
    put(3, '{"day": 3}')
    waveform("cd34")
    backup(database, store, files[1], files[0])
    with writing(database) as c:
        results.drop_observation(c, "wtg", "m", "ab122")
        record = records.find_record(c, "wtg", "cd34")
        records.forget_samples(c, record)
    waveform("ef56")
    put(1, '{"day": 1}')  # as it was at first
    backup(database, store, files[2], files[1])
    sizes = [sum(m.name.startswith("records/") for m in tarfile.open(f).getmembers()) for f in files]
    assert sizes == [1, 1, 1]
    with tarfile.open(files[2]) as archive:
        assert archive.extractfile("tables/observations.jsonl").read().count(b"\n") == 1
    other = open_database(f"sqlite:///{tmp_path / 'other.sqlite'}")
    restore(files[2], other, new, files[:2])
    with database.connect() as one, other.connect() as two:
        for table in (tables.observations, tables.records, tables.events):
            rows = select(table).order_by(*table.primary_key.columns)
            assert one.execute(rows).all() == two.execute(rows).all(), table.name
    kept = {p.name for p in new.rglob("*.parquet")}
    assert kept == {"ab12.parquet", "ef56.parquet"}
    other.dispose()
    for wrong in ([files[1]], [files[0]], [files[1], files[0]], []):
        empty = open_database(f"sqlite:///{tmp_path / f'{len(wrong)}{wrong and wrong[0].stem}.sqlite'}")
        with pytest.raises(InputError, match="does not follow"):
            restore(files[2], empty, tmp_path / "c", wrong)
        empty.dispose()


def test_what_is_no_backup_is_followed_by_none(database: Engine, tmp_path: Path) -> None:
    filled(database, tmp_path / "a")
    (tmp_path / "x.tar.gz").write_text("no archive")
    with pytest.raises(InputError, match="another one can follow"):
        backup(database, tmp_path / "a", tmp_path / "y.tar.gz", tmp_path / "x.tar.gz")
    assert not (tmp_path / "y.tar.gz").exists()
