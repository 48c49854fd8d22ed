"""Operations of the command line on a store, with or without a running server."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, select

from jackettwin.errors import InputError
from jackettwin.service.context import OpenStore
from jackettwin.service.intake.bundles import bundle
from jackettwin.service.intake.files import Accepted, take_file
from jackettwin.service.settings import read_settings
from jackettwin.service.web.catalogue import add_version, adopt, archive, place
from jackettwin.service.web.schemas.assets import Position
from jackettwin.service.work import consequences
from jackettwin.service.work.conditions import add_conditions as keep_conditions
from jackettwin.service.workers.condition_tables import read_table
from jackettwin.service.workers.tasks import read_file
from jackettwin.store import StoredObservation, assets, journal, reading, records, work, writing
from jackettwin.store.tables import observations


def _opened(database: Engine, store: Path) -> OpenStore:
    return OpenStore(read_settings(store=store), database)


def add_twin(database: Engine, store: Path, name: str, twin: Path, comment: str = "") -> dict[str, Any]:
    """Add an asset or a version of it from a local twin file, and return its document.

    Raises
    ------
    InputError
        If the twin or a file it names cannot be read, or the asset is archived.
    """
    assets.check_name(name)
    contents = bundle(twin)
    opened = _opened(database, store)
    fit = partial(_refuse_archived, asset=name)
    version = add_version(opened, name, contents, "command line", comment, if_fit=fit)
    return {
        "asset": name,
        "version": version.version,
        "model_hash": version.model_hash,
        "settings_hash": version.settings_hash,
        "files": sorted(contents),
    }


def adopt_version(database: Engine, store: Path, name: str, version: int) -> None:
    """Adopt a version of an asset.

    Raises
    ------
    InputError
        If there is no such asset or version.
    """
    with writing(database) as connection:
        adopt(connection, _opened(database, store), name, version, "command line")


def archive_asset(database: Engine, store: Path, name: str, *, undo: bool = False) -> None:
    """Archive an asset, or undo this.

    Raises
    ------
    InputError
        If there is no such asset.
    """
    with writing(database) as connection:
        archive(connection, _opened(database, store), name, "command line", undo=undo)


def place_asset(database: Engine, store: Path, name: str, latitude_deg: float, longitude_deg: float) -> None:
    """Set the position of an asset (WGS 84).

    Raises
    ------
    InputError
        If there is no such asset.
    """
    at = Position(latitude_deg=latitude_deg, longitude_deg=longitude_deg)
    with writing(database) as connection:
        place(connection, _opened(database, store), name, at, "command line")


def take_here(database: Engine, store: Path, asset: str, path: Path) -> Accepted:
    """Read a file in this process and store its record, which a server then observes.

    Raises
    ------
    InputError
        If there is no such asset, or it is archived.
    """
    with reading(database) as connection:
        _refuse_archived(connection, asset)
    return take_file(_opened(database, store), read_file, asset, path, path.name, "command line")


def _refuse_archived(connection: Connection, asset: str) -> None:
    if assets.is_archived(connection, asset):
        raise InputError(
            "the asset is archived",
            field="asset",
            value=asset,
            remedy="restore it with `jackettwin asset archive NAME --undo --store STORE`",
        )


def add_conditions(database: Engine, store: Path, asset: str, table: Path, **how: Any) -> tuple[int, int]:
    """Store the conditions of a table; return the numbers of new ones and of records to observe again.

    Raises
    ------
    InputError
        If there is no such asset, it is archived, or the table cannot be read.
    """
    with reading(database) as connection:
        assets.found_version(connection, asset)
        _refuse_archived(connection, asset)
    values = read_table(table, asset=asset, **how)
    with writing(database) as connection:
        return keep_conditions(connection, _opened(database, store), asset, values, "command line")


def rebuild(
    database: Engine,
    store: Path,
    asset: str | None,
    since: datetime | None,
    *,
    observe: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Make states again from stored observations, and with ``observe`` queue raw records for observation."""
    opened = _opened(database, store)
    start = datetime(1900, 1, 1, tzinfo=UTC) if since is None else since.replace(tzinfo=UTC)
    with reading(database) as connection:
        if asset is not None:
            assets.found_version(connection, asset)
        names = assets.asset_names(connection) if asset is None else [asset]
    days = queued = 0
    for name in names:
        progress(f"rebuild {name} …")
        with writing(database) as connection:
            consequences.lock(connection, name)
            for version in assets.all_versions(connection, name):
                for first in _first_of_days(connection, name, version.model_hash, start):
                    consequences.fold(connection, opened, name, version.version, first, anew=True)
                    days += 1
                if observe:
                    queued += _queue_all(connection, opened, version, start)
            journal.tell(connection, "state", name, {"rebuilt": True}, opened.now())
    return {"assets": names, "days": days, "queued": queued}


def _first_of_days(connection: Any, asset: str, model_hash: str, start: datetime) -> list[StoredObservation]:
    """Return one observation of each UTC day with observations."""
    where = (observations.c.asset == asset, observations.c.model_hash == model_hash)
    query = select(observations).where(*where, observations.c.start_utc >= start)
    first: dict[str, StoredObservation] = {}
    for row in connection.execute(query.order_by(observations.c.start_utc)):
        first.setdefault(f"{row.start_utc:%Y-%m-%d}", StoredObservation(**row._mapping))
    return list(first.values())


def _queue_all(connection: Any, opened: OpenStore, version: assets.Version, start: datetime) -> int:
    count = 0
    for record in records.all_with_samples(connection, version.asset):
        if record.start_utc >= start:
            number = work.enqueue(connection, version, record.record_id, opened.now())
            count += work.try_again(connection, number, opened.now())
    return count
