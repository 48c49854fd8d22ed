"""Import of files: read by a worker, stored by content, queued for every living version."""

from __future__ import annotations

import secrets
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection

from jackettwin.service.intake.examination import profile
from jackettwin.service.workers.failures import DISK_FULL, LOST_WORKER, NoWorker
from jackettwin.service.workers.tasks import File, Parsed, read_file
from jackettwin.store import assets, journal, people, reading, records, work, writing

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.service.context import Place, Service

Reader = Callable[[File], tuple[Parsed, ...]]
"""Function that reads a file, in a worker or in this process."""
AHEAD = timedelta(days=7)
"""Largest time by which a record may begin after the present by this server's clock, which may be wrong."""
LIVE = 10
"""Priority of new records over those that are observed again."""
_SUFFIXES = 60
"""Longest part of a client's file name that is kept, including its extension, which gives the format."""


@dataclass(frozen=True)
class Accepted:
    """Result of an import: the record, or the last of several, its job, and whether any was new."""

    record_id: str
    job_id: int | None
    new: bool
    problem: dict[str, Any] | None = None
    records: int = 1


def spooled(spool: Path, name: str, pieces: Iterator[bytes], description: bytes | None) -> Path:
    """Write an upload to its own folder and return its path; only the last part of the name is used."""
    folder = spool / secrets.token_hex(8)
    folder.mkdir(parents=True)
    path = folder / safe_name(name)
    try:
        with path.open("wb") as stream:
            for piece in pieces:
                stream.write(piece)
        if description is not None:
            path.with_suffix(".json").write_bytes(description)
    except BaseException:
        discard(path)
        raise
    return path


def safe_name(name: str) -> str:
    """Return a file name without characters of paths."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    kept = "".join(c if c.isalnum() or c in "._-" else "_" for c in last).lstrip(".")
    return kept[-_SUFFIXES:] or "record"


def discard(path: Path) -> None:
    """Remove an upload's folder."""
    shutil.rmtree(path.parent, ignore_errors=True)


def parse_here(service: Service) -> Reader:
    """Return the reader that uses the server's workers.

    Reading that takes too long is stopped. After the death of a worker the file is read again, as often as a
    record is tried. If there is no worker or no disk space, ``NoWorker`` or ``OSError`` is raised, and the
    file can be sent again.
    """

    def parse(file: File) -> tuple[Parsed, ...]:
        for _ in range(work.MOST_TRIES):
            future = service.cluster.submit(read_file, file, priority=100)
            try:
                found: tuple[Parsed, ...] = service.cluster.result(future, service.settings.parse_limit_s)
                return found
            except NoWorker:
                raise
            except TimeoutError:
                problem = {"detail": "the file could not be read in time", "field": "file"}
                return (Parsed("", problem=problem),)
            except Exception as error:  # any error of a reader is due to the file, not the server
                if isinstance(error, OSError) and error.errno in DISK_FULL:
                    raise
                name = type(error).__name__
                if name not in LOST_WORKER:
                    break
        detail = f"the file could not be read ({name})"
        problem = {"detail": detail, "field": "file", "remedy": "check which program wrote it"}
        return (Parsed("", problem=problem),)

    return parse


def accept(
    service_now: datetime, connection: Connection, asset: str, parsed: Parsed, source_name: str
) -> Accepted:
    """Store a record and queue it for observation; content that is stored already changes nothing."""
    adopted = assets.found_version(connection, asset)
    about = parsed.about
    record = records.StoredRecord(
        asset=asset,
        record_id=parsed.record_id,
        status="received",
        start_utc=datetime.fromisoformat(about["start_utc"]),
        duration_s=about["duration_s"],
        sample_rate_hz=about["sample_rate_hz"],
        channels=about["channels"],
        conditions=about["conditions"],
        source_name=source_name,
        received_utc=service_now,
        waveform=parsed.waveform,
        size_bytes=parsed.size_bytes,
    )
    new = records.add_record(connection, record)
    number = None
    for version in living(connection, asset, adopted):
        urgent = LIVE if version.version == adopted.version else 0
        asked = work.enqueue(connection, version, parsed.record_id, service_now, priority=urgent)
        number = asked if version.version == adopted.version else number
    if new:
        journal.tell(
            connection, "record", asset, {"record_id": parsed.record_id, "status": "received"}, service_now
        )
    return Accepted(parsed.record_id, number, new)


def living(connection: Connection, asset: str, adopted: assets.Version) -> list[assets.Version]:
    """Return the versions that observe new records.

    These are the adopted one and later ones, which may be adopted.
    """
    return [v for v in assets.all_versions(connection, asset) if v.version >= adopted.version]


def take_file(
    place: Place, parse: Reader, asset: str, path: Path, source_name: str, by: str = ""
) -> Accepted:
    """Read a file and store its record, or all records into which a long one is divided, or none.

    ``by`` is the user in the audit log, if known.
    """
    settings = place.settings
    with reading(place.database) as connection:
        defaults = profile(connection, place, asset).defaults
    limits = (settings.samples_limit, settings.worker_memory_bytes, place.now() + AHEAD)
    parsed = parse(File(str(path), asset, str(settings.store), *limits, defaults))
    if parsed[0].problem is not None:
        return Accepted(parsed[0].record_id, None, False, parsed[0].problem)
    with writing(place.database) as connection:
        taken = [accept(place.now(), connection, asset, one, source_name) for one in parsed]
        if by:
            subject, outcome = f"{asset}/{taken[-1].record_id}", "ok" if taken[-1].new else "known"
            people.note_down(connection, by, "record", subject, outcome, place.now())
    return replace(taken[-1], new=any(one.new for one in taken), records=len(taken))
