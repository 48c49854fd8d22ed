"""Assets and the versions of their twins."""

from __future__ import annotations

import hashlib
import io
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, func, insert, select, update

from jackettwin.errors import InputError
from jackettwin.files import atomic_folder
from jackettwin.store.tables import assets, records, versions

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
"""Pattern of an asset's name, which becomes part of paths and topics."""
_FIXED_TIME = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class Version:
    """One version of an asset's twin, without its files."""

    asset: str
    version: int
    model_hash: str
    settings_hash: str
    created_utc: datetime
    created_by: str
    bundle_hash: str
    comment: str


def check_name(name: str) -> str:
    """Return the name of an asset after checking it.

    Raises
    ------
    InputError
        If it has other characters than letters, digits, ``_`` and ``-``, or more than 64.
    """
    if NAME.fullmatch(name) is None:
        raise InputError(
            "the name is not allowed for an asset",
            field="name",
            value=name[:80],
            allowed="1 to 64 letters, digits, _ and -, a letter or digit first",
            remedy="choose a short name such as wtg_01",
        )
    return name


def pack(files: Mapping[str, bytes]) -> bytes:
    """Return files as one archive, whose bytes depend only on the files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name, _FIXED_TIME), files[name], zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def unpack(bundle: bytes) -> dict[str, bytes]:
    """Return the files of an archive that :func:`pack` made."""
    with zipfile.ZipFile(io.BytesIO(bundle)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def lay_out(bundle: bytes, place: Path) -> None:
    """Write the files of a bundle into a folder, completely or not at all, also if others do so at once."""
    with atomic_folder(place) as temporary:
        for name, content in unpack(bundle).items():
            (temporary / name).parent.mkdir(parents=True, exist_ok=True)
            (temporary / name).write_bytes(content)
        try:
            temporary.rename(place)
        except OSError:
            if not place.is_dir():
                raise
        temporary.mkdir(exist_ok=True)


def add_version(
    connection: Connection,
    name: str,
    files: Mapping[str, bytes],
    *,
    model_hash: str,
    settings_hash: str,
    by: str,
    now: datetime,
    comment: str = "",
) -> Version:
    """Add an asset or a version of it; the first version is adopted, later ones must be by a person."""
    check_name(name)
    bundle = pack(files)
    last = connection.scalar(select(func.max(versions.c.version)).where(versions.c.asset == name))
    number = 1 if last is None else last + 1
    if last is None:
        connection.execute(insert(assets).values(name=name, created_utc=now, adopted_version=1))
    row: dict[str, Any] = {
        "asset": name,
        "version": number,
        "model_hash": model_hash,
        "settings_hash": settings_hash,
        "created_utc": now,
        "created_by": by,
        "bundle_hash": hashlib.sha256(bundle).hexdigest(),
        "comment": comment,
    }
    connection.execute(insert(versions).values(**row, bundle=bundle))
    return Version(**row)


def adopt(connection: Connection, name: str, version: int) -> None:
    """Adopt a version."""
    found_version(connection, name, version)
    connection.execute(update(assets).where(assets.c.name == name).values(adopted_version=version))


def place(connection: Connection, name: str, latitude_deg: float, longitude_deg: float) -> None:
    """Set the position of an asset (WGS 84)."""
    found_version(connection, name)
    at = {"latitude_deg": latitude_deg, "longitude_deg": longitude_deg}
    connection.execute(update(assets).where(assets.c.name == name).values(**at))


def archive(connection: Connection, name: str, at: datetime | None) -> None:
    """Archive an asset from a time on; None restores it."""
    found_version(connection, name)
    connection.execute(update(assets).where(assets.c.name == name).values(archived_utc=at))


def is_archived(connection: Connection, name: str) -> bool:
    """Return whether an asset is archived."""
    return connection.scalar(select(assets.c.archived_utc).where(assets.c.name == name)) is not None


def asset_names(connection: Connection, *, archived: bool = True) -> list[str]:
    """Return the sorted names of all assets, with or without archived ones."""
    query = select(assets.c.name).order_by(assets.c.name)
    return list(connection.scalars(query if archived else query.where(assets.c.archived_utc.is_(None))))


@dataclass(frozen=True)
class Summary:
    """An asset, its adopted version and the comment on it, its latest record, archiving and position."""

    name: str
    version: int
    model_hash: str
    created_utc: datetime
    last_record_utc: datetime | None
    archived_utc: datetime | None
    comment: str
    latitude_deg: float | None
    longitude_deg: float | None


def summaries(connection: Connection, name: str | None = None, *, archived: bool = False) -> list[Summary]:
    """Return all living or all archived assets by name, or one of either kind."""
    start = records.c.start_utc
    last = select(func.max(start, type_=start.type)).where(records.c.asset == assets.c.name)
    last = last.where(records.c.status != "mismatched")
    adopted = (versions.c.asset == assets.c.name) & (versions.c.version == assets.c.adopted_version)
    query = select(
        assets.c.name,
        versions.c.version,
        versions.c.model_hash,
        assets.c.created_utc,
        last.correlate(assets).scalar_subquery().label("last_record_utc"),
        assets.c.archived_utc,
        versions.c.comment,
        assets.c.latitude_deg,
        assets.c.longitude_deg,
    ).join(versions, adopted)
    of = assets.c.archived_utc.is_not(None) if archived else assets.c.archived_utc.is_(None)
    query = query.where(of if name is None else assets.c.name == name)
    return [Summary(*row) for row in connection.execute(query.order_by(assets.c.name))]


def found_version(connection: Connection, name: str, version: int | None = None) -> Version:
    """Return a version of an asset, by default the adopted one.

    Raises
    ------
    InputError
        If there is no such asset or version.
    """
    columns = [column for column in versions.c if column.name != "bundle"]
    query = select(*columns).join(assets, assets.c.name == versions.c.asset).where(versions.c.asset == name)
    wanted = assets.c.adopted_version if version is None else version
    row = connection.execute(query.where(versions.c.version == wanted)).one_or_none()
    if row is None:
        known = asset_names(connection)
        if name in known:
            numbers = connection.scalars(select(versions.c.version).where(versions.c.asset == name))
            raise InputError(
                "no such version of the asset",
                field="version",
                value=version,
                allowed=", ".join(map(str, sorted(numbers))),
                remedy=f"`jackettwin asset show {name} --store STORE` lists them",
            )
        raise InputError(
            "no such asset",
            field="asset",
            value=name,
            allowed=", ".join(known[:20]) or "none yet",
            remedy="add it with `jackettwin asset add NAME TWIN --store STORE`",
        )
    return Version(**row._mapping)


def all_versions(connection: Connection, name: str) -> list[Version]:
    """Return every version of an asset, oldest first."""
    columns = [column for column in versions.c if column.name != "bundle"]
    rows = connection.execute(select(*columns).where(versions.c.asset == name).order_by(versions.c.version))
    return [Version(**row._mapping) for row in rows]


def bundle_of(connection: Connection, name: str, version: int) -> bytes:
    """Return the archive of a version's files."""
    query = select(versions.c.bundle).where(versions.c.asset == name, versions.c.version == version)
    return bytes(connection.execute(query).scalar_one())
