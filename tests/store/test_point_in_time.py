"""Recovery of PostgreSQL to a moment, as docs/reference/service.md says it: tried, on a server of our own."""

from __future__ import annotations

import re
import shutil
import subprocess
import time
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import text
from tests.service.servers import Database, found, opened

from jackettwin.store import assets, people, reading, writing

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "service.md"
NOW = datetime(2025, 3, 1, 12, tzinfo=UTC)


def documented(archive: Path) -> dict[str, str]:
    """Return the settings of PostgreSQL that the page gives, with an archive of ours."""
    block = re.search(r"```ini\n(archive_mode.*?)```", PAGE.read_text(), re.DOTALL)[1]
    pairs = (line.split(" = ", 1) for line in block.strip().splitlines())
    return {name: value.strip("'").replace("/backup/wal", str(archive)) for name, value in pairs}


def test_a_database_is_as_it_was_at_a_moment(tmp_path: Path) -> None:
    """Somebody deletes the users; what was there a second before comes back, and what came before it."""
    archive, base = tmp_path / "wal", tmp_path / "again" / "data"
    archive.mkdir(mode=0o777)
    archive.chmod(0o777)
    given = documented(archive)
    recovery = {name: given.pop(name) for name in ("restore_command", "recovery_target_action")}
    recovery["recovery_target_time"] = given.pop("recovery_target_time")
    first = Database(tmp_path / "first", **given)
    first.start()
    try:
        with opened(first.url) as database:
            version = {"model_hash": "m", "settings_hash": "s", "by": "me", "now": NOW}
            with writing(database) as connection:
                assets.add_version(connection, "wtg", {"twin.yaml": b"x"}, **version)
            base.parent.mkdir()
            basebackup = [found("pg_basebackup"), "-D", str(base), "-h", "127.0.0.1", "-p", str(first.port)]
            subprocess.run([*basebackup, "-U", "postgres", "-c", "fast"], check=True, capture_output=True)
            with writing(database) as connection:
                people.add_user(connection, people.User("anna", "admin", "", NOW))
            time.sleep(1.5)
            with reading(database) as connection:
                moment = connection.scalar(text("select now()::text"))
            time.sleep(1.5)
            with database.begin() as connection:
                connection.execute(text("delete from users"))
            with database.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
                connection.execute(text("select pg_switch_wal()"))
    finally:
        first.stop()
    again = Database(base.parent, **{**recovery, "recovery_target_time": moment})
    for path in (base, *base.rglob("*")):
        shutil.chown(path, "postgres")
    (base / "recovery.signal").touch()
    again.start()
    try:
        with opened(again.url) as database, reading(database) as connection:
            assert [user.name for user in people.list_users(connection)] == ["anna"]
            assert assets.asset_names(connection) == ["wtg"]
    finally:
        again.stop()
