"""Upload of records over HTTP, and jobs requested over it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, cast

from fastapi import UploadFile
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service.answer_cache import Answer
from jackettwin.service.intake.bundles import twin_folder
from jackettwin.service.intake.files import Accepted, discard, parse_here, spooled, take_file
from jackettwin.service.web.dependencies import known_asset, known_record, living_asset
from jackettwin.service.web.problems import ApiError, disk_full
from jackettwin.service.web.schemas.assets import Taken
from jackettwin.service.web.schemas.records import PicksIn
from jackettwin.service.work.conditions import add_conditions
from jackettwin.service.workers import record_views
from jackettwin.service.workers.drafts import draft
from jackettwin.service.workers.failures import ROOM_BYTES
from jackettwin.service.workers.tasks import read_conditions
from jackettwin.store import assets, journal, people, reading, records, results, work, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service
    from jackettwin.service.web.auth import Who

_PIECE = 1 << 20
_DESCRIPTION_BYTES = 2**20
"""Largest size of a form field."""


def refuse_unfit(service: Service, asset: str) -> None:
    """Answer 404 if there is no such asset, 409 if it is archived."""
    with reading(service.database) as connection:
        living_asset(connection, asset)


def take(
    service: Service, asset: str, name: str, stream: BinaryIO, description: str | None, by: str
) -> Accepted:
    """Read an upload and store its record; if that fails, nothing is left behind."""
    if description is not None:
        _check(description)
    if service.free_bytes() < ROOM_BYTES:
        raise disk_full()
    path = spooled(
        service.settings.spool,
        name,
        _limited(stream, service.settings.upload_limit_bytes),
        None if description is None else description.encode(),
    )
    try:
        taken = take_file(service, parse_here(service), asset, path, name[:255], by)
    finally:
        discard(path)
    if taken.problem is not None:
        raise ApiError(422, **taken.problem)
    return taken


def text_of(description: UploadFile | str | None) -> str | None:
    """Return a description that came as a field or as a file.

    Raises
    ------
    ApiError
        422 if it is not text, 413 if it is too large.
    """
    if description is None or isinstance(description, str):
        return description
    try:
        return b"".join(_limited(description.file, _DESCRIPTION_BYTES)).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ApiError(422, "the description is not UTF-8 text", field="description") from None


def pick(
    connection: Connection, service: Service, record: records.StoredRecord, body: PicksIn, who: str
) -> int:
    """Store manually selected poles, and queue the record for identification with them."""
    chosen = {"poles": [p.model_dump() for p in body.picks], "by": who, "time_utc": service.now().isoformat()}
    records.set_picks(connection, record.asset, record.record_id, chosen if body.picks else None)
    people.note_down(connection, who, "picks", f"{record.asset}/{record.record_id}", "ok", service.now())
    number = 0
    for version in assets.all_versions(connection, record.asset):
        number = work.enqueue(connection, version, record.record_id, service.now(), priority=20)
        work.renew(connection, number, service.now())
    told = {"record_id": record.record_id, "status": record.status, "picks": len(body.picks)}
    journal.tell(connection, "record", record.asset, told, service.now())
    return number


def take_conditions(
    service: Service, asset: str, stream: BinaryIO, zone: str, end_stamped: bool, by: str
) -> Taken:
    """Read a table of conditions in a worker and store it."""
    path = spooled(
        service.settings.spool, "table.csv", _limited(stream, service.settings.upload_limit_bytes), None
    )
    try:
        asked = partial(read_conditions, asset=asset, zone=zone, end_stamped=end_stamped)
        future = service.cluster.submit(asked, str(path), priority=100)
        values = service.cluster.result(future, service.settings.parse_limit_s)
    except TimeoutError:
        raise ApiError(422, "the table could not be read in time", field="file") from None
    finally:
        discard(path)
    if isinstance(values, InputError):
        raise values
    with writing(service.database) as connection:
        count, again = add_conditions(connection, service, asset, values, by)
    service.wake()
    return Taken(count=count, observed_again=again)


def drafted(
    service: Service, structure: UploadFile, record: UploadFile, description: str | None
) -> dict[str, Any]:
    """Return what a worker drafts from a structure and a record; neither is kept."""
    if description is not None:
        _check(description)
    if service.free_bytes() < ROOM_BYTES:
        raise disk_full()
    paths: list[Path] = []
    try:
        for file, beside in ((structure, None), (record, description)):
            pieces = _limited(file.file, service.settings.upload_limit_bytes)
            said = None if beside is None else beside.encode()
            paths.append(spooled(service.settings.spool, file.filename or "file", pieces, said))
        limits = (service.settings.freedoms_limit, service.settings.worker_memory_bytes)
        future = service.cluster.submit(draft, *map(str, paths), *limits, priority=100)
        found = service.cluster.result(future, service.settings.parse_limit_s)
    except TimeoutError:
        raise ApiError(422, "the files could not be read in time", field="structure") from None
    finally:
        for path in paths:
            discard(path)
    if isinstance(found, InputError):
        raise found
    return cast("dict[str, Any]", found)


def by_worker(
    service: Service, record_id: str, who: Who, task: Callable[..., Any], *more: Any, keep: bool = False
) -> Any:
    """Return what a worker finds in a record; the task is given the twin's folder and the samples' file.

    What it finds in samples alone, which do not change, may be kept for who looks again.
    """
    with reading(service.database) as connection:
        record = known_record(connection, record_id, who)
        if record.waveform is None:
            raise ApiError(404, "the samples of this record were deleted", field="record_id")
        folder = twin_folder(connection, service, record.asset)
    asked = f"{task.__name__} {record.waveform}"
    if keep and (kept := service.answers.find(asked, 0)):
        return json.loads(kept.body)
    waveform = str(service.settings.store / record.waveform)
    future = service.cluster.submit(task, str(folder), waveform, *more, priority=50)
    try:
        found = service.cluster.result(future, service.settings.observe_limit_s)
    except TimeoutError:
        raise ApiError(503, "it takes too long") from None
    if keep:
        service.answers.keep(asked, Answer.of(0, json.dumps(found).encode()))
    return found


def stretches(service: Service, record_id: str, who: Who) -> Any:
    """Return what examination set aside of a record: as observed, else as a worker finds it.

    Nobody tells it of a record that is not observed yet, or was before observations held it.
    """
    with reading(service.database) as connection:
        record = known_record(connection, record_id, who)
        adopted = known_asset(connection, record.asset)
        seen = results.find_observation(connection, record.asset, record_id, adopted.model_hash)
    quality = {} if seen is None else json.loads(seen.document or "{}").get("quality", {})
    if record.waveform is not None and "unused" in quality:
        return record_views.stretches_of(quality)
    return by_worker(service, record_id, who, record_views.stretches, keep=True)


def _limited(stream: BinaryIO, most: int) -> Iterator[bytes]:
    size = 0
    while piece := stream.read(_PIECE):
        size += len(piece)
        if size > most:
            raise ApiError(413, "the file is too large", field="file", allowed=f"up to {most} bytes")
        yield piece


def _check(description: str) -> None:
    try:
        if not isinstance(json.loads(description), dict):
            raise ValueError("not an object")
    except (ValueError, RecursionError) as error:
        raise ApiError(
            422, "the description is not a JSON object", field="description", value=str(error)[:100]
        ) from None
