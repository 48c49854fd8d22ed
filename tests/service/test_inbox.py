"""Files that somebody drops into the inbox of a store."""

from __future__ import annotations

import errno
import json
import os
import shutil
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.service.conftest import TWIN, Done, description, record_file

from jackettwin.service.context import Service
from jackettwin.service.intake import folder
from jackettwin.service.intake.files import Accepted
from jackettwin.service.intake.folder import watch_folders
from jackettwin.service.server import REFUSED, take_from_inbox
from jackettwin.service.web.catalogue import add_text_version
from jackettwin.service.workers.failures import NoWorker
from jackettwin.store import reading, tables
from jackettwin.store.records import find_record


def dropped(service: Service, content: bytes, asset: str = "wtg") -> Path:
    path = service.settings.store / "inbox" / asset / "r1.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    path.with_suffix(".json").write_text(description())
    return path


def taken(service: Service, path: Path) -> Accepted | None:
    return take_from_inbox(service, service.settings.store / "inbox", path)


def test_a_file_becomes_a_record_and_leaves_the_inbox(service: Service) -> None:
    path = dropped(service, record_file(1))
    found = taken(service, path)
    assert found is not None
    with reading(service.database) as connection:
        assert find_record(connection, "wtg", found.record_id) is not None
    assert list(path.parent.iterdir()) == []


def test_a_record_is_carried_over_from_the_folder_of_another_store(service: Service) -> None:
    """Its content, and so its number, stays: a store that cannot be opened any more loses no record."""
    first = taken(service, dropped(service, record_file(1)))
    assert first is not None
    with reading(service.database) as connection:
        before = find_record(connection, "wtg", first.record_id)
    add_text_version(service, "new", TWIN, {}, "test")
    path = service.settings.inbox / "new" / Path(before.waveform).name
    shutil.copy(service.settings.store / before.waveform, path)
    again = taken(service, path)
    assert again is not None and again.new and again.record_id == first.record_id
    with reading(service.database) as connection:
        after = find_record(connection, "new", again.record_id)
    assert (after.start_utc, after.channels, after.conditions) == (
        before.start_utc,
        before.channels,
        before.conditions,
    )


def test_an_asset_has_its_folder_from_the_start(service: Service) -> None:
    assert (service.settings.store / "inbox" / "wtg").is_dir()


def test_what_cannot_be_read_stays_with_the_reason_beside_it_until_it_can(service: Service) -> None:
    path = dropped(service, b"nothing that is read")
    refused = taken(service, path)
    assert refused is not None and refused.problem is not None
    reason = path.with_name("r1.parquet.refused.json")
    assert {"detail", "field"} <= set(json.loads(reason.read_text()))
    path.write_bytes(record_file(1))
    mended = taken(service, path)
    assert mended is not None and mended.new
    assert list(path.parent.iterdir()) == []


def test_a_file_of_no_asset_is_said_and_waits_for_one(service: Service) -> None:
    path = dropped(service, record_file(1), asset="wgt")
    assert taken(service, path) is None and path.exists()
    reason = path.with_name("r1.parquet.refused.json")
    assert json.loads(reason.read_text())["value"] == "wgt"
    add_text_version(service, "wgt", TWIN, {}, "test")
    found = taken(service, path)
    assert found is not None and found.new
    assert list(path.parent.iterdir()) == []


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "full"), OSError(errno.EROFS, "read-only"), NoWorker()]
)
def test_a_full_disk_or_no_worker_is_not_the_files_fault(
    service: Service, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    path = dropped(service, record_file(1))
    monkeypatch.setattr(service.cluster, "submit", lambda *_, **__: Done(error=error))
    with pytest.raises(type(error)):
        taken(service, path)
    assert not path.with_name("r1.parquet.refused.json").exists()
    monkeypatch.undo()


def test_a_name_that_is_no_text_is_taken_like_any_other(
    service: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a logger with an old code page writes it: the watcher once ended at it, and the health was ok."""
    latin, inbox = os.fsdecode(b"Br\xfccke.parquet"), service.settings.store / "inbox"
    good = dropped(service, record_file(1))
    path = good.rename(good.with_name(latin))
    good.with_suffix(".json").rename(path.with_suffix(".json"))
    monkeypatch.setattr(folder, "STILL_S", 0.0)
    monkeypatch.setattr(folder, "_LOOK_S", 0.0)
    turns = iter(range(5))
    watch_folders([inbox], lambda file: take_from_inbox(service, inbox, file), lambda: next(turns) == 4)
    assert list(path.parent.iterdir()) == []
    with reading(service.database) as connection:
        (source,) = connection.scalars(select(tables.records.c.source_name))
    assert source == "Br_xfccke.parquet"


def test_a_link_in_the_inbox_is_not_followed(service: Service, tmp_path: Path) -> None:
    """Who may write to a shared inbox would have files of the server read, and quoted in the reason."""
    secret = tmp_path / "secret.csv"
    secret.write_text("password,hunter2\n", encoding="utf-8")
    path = service.settings.store / "inbox" / "wtg" / "r.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.symlink_to(secret)
    assert taken(service, path) is None
    reason = path.with_name(path.name + REFUSED).read_text(encoding="utf-8")
    assert "is a link" in reason and "hunter2" not in reason
    assert secret.exists() and path.is_symlink()


def test_what_could_not_be_taken_now_is_taken_later(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As while the database is away: the watcher lives on and comes back to the file."""
    monkeypatch.setattr(folder, "STILL_S", 0.0)
    monkeypatch.setattr(folder, "_LATER_S", 0.0)
    monkeypatch.setattr(folder, "_LOOK_S", 0.0)
    (tmp_path / "r1.parquet").write_bytes(b"x")
    tried: list[Path] = []

    def take(path: Path) -> Accepted | None:
        tried.append(path)
        return None if len(tried) == 1 else Accepted("1", 1, True)

    turns = iter(range(6))
    watch_folders([tmp_path], take, lambda: next(turns) == 5)
    assert len(tried) == 2
