"""Routes for records: upload, list, signals and spectra."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, File, Form, Header, Query, Response, UploadFile

from jackettwin.service import workers
from jackettwin.service.web import auth, signals, uploads
from jackettwin.service.web.dependencies import (
    WAITING,
    Asker,
    AssetName,
    Parts,
    ReadsAtVersion,
    RecordId,
    Route,
    Writes,
    known_asset,
    known_record,
)
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.drawings import MotionOut
from jackettwin.service.web.schemas.findings import Acknowledgement
from jackettwin.service.web.schemas.records import (
    PicksIn,
    RecordAccepted,
    RecordOut,
    Signal,
    Spectra,
    SpectrogramOut,
    StabilisationOut,
    StretchOut,
)
from jackettwin.service.work import consequences
from jackettwin.store import people, records, writing

router = APIRouter(tags=["records"], route_class=Route)

Status = Literal["received", "observing", "observed", "refused", "mismatched", "set_aside"]
Limit = Annotated[int, Query(ge=1, le=1000)]


@router.post(
    "/assets/{asset}/records",
    status_code=202,
    dependencies=[auth.ENGINEER, WAITING],
    responses={
        200: {"description": "This content is stored already.", "model": RecordAccepted},
        **answers(400, 401, 403, 404, 409, 413, 422, 503, 507),
    },
)
def add_record(
    asset: AssetName,
    who: Asker,
    parts: Parts,
    response: Response,
    file: Annotated[UploadFile, File(description="A record in any supported format.")],
    description: Annotated[
        UploadFile | str | None,
        Form(description="The description of the record in JSON, as a field or a file."),
    ] = None,
) -> RecordAccepted:
    """Upload a record: it is read at once and then queued for observation."""
    uploads.refuse_unfit(parts, asset)
    taken = uploads.take(
        parts, asset, file.filename or "record", file.file, uploads.text_of(description), who.name
    )
    if not taken.new:
        response.status_code = 200
    parts.wake()
    return RecordAccepted(record_id=taken.record_id, job_id=taken.job_id, records=taken.records)


@router.get("/assets/{asset}/records", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def list_records(
    asset: AssetName,
    connection: ReadsAtVersion,
    since: Annotated[datetime | None, Query(alias="from")] = None,
    until: Annotated[datetime | None, Query(alias="to")] = None,
    status: Status | None = None,
    cursor: Annotated[str | None, Query(max_length=500)] = None,
    limit: Limit = 100,
) -> Page[RecordOut]:
    """List the records of an asset, latest first."""
    known_asset(connection, asset)
    found, more = records.list_records(
        connection,
        asset,
        since=signals.with_zone(since, "from"),
        until=signals.with_zone(until, "to"),
        status=status,
        cursor=cursor,
        limit=limit,
    )
    return Page(items=[signals.record_out(r) for r in found], next_cursor=more)


@router.get("/records/{record_id}", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def get_record(record_id: RecordId, who: Asker, connection: ReadsAtVersion) -> RecordOut:
    """Return a record with its status."""
    return signals.record_out(known_record(connection, record_id, who))


@router.get(
    "/records/{record_id}/signal",
    dependencies=[auth.VIEWER, WAITING],
    response_model=Signal,
    responses={
        200: {"content": {"application/vnd.apache.arrow.stream": {}}},
        **answers(401, 404, 422),
    },
)
def signal(
    record_id: RecordId,
    who: Asker,
    parts: Parts,
    channels: Annotated[list[str] | None, Query(max_length=100)] = None,
    since: Annotated[float, Query(alias="from", ge=0.0, le=1e9)] = 0.0,
    until: Annotated[float | None, Query(alias="to", gt=0.0, le=1e9)] = None,
    points: Annotated[int, Query(ge=1, le=10_000)] = 1000,
    accept: Annotated[str, Header()] = "application/json",
) -> Any:
    """Return the extremes of each bin of time [s after the start], as JSON or Arrow."""
    found = signals.extremes(parts, record_id, who, channels, since, until, points)
    if "application/vnd.apache.arrow.stream" in accept:
        with writing(parts.database) as connection:
            people.note_down(connection, who.name, "download", f"samples of {record_id}", "ok", parts.now())
        return Response(signals.as_arrow(found), media_type="application/vnd.apache.arrow.stream")
    return found


@router.get(
    "/records/{record_id}/spectrum", dependencies=[auth.VIEWER, WAITING], responses=answers(401, 404, 422)
)
def spectrum(record_id: RecordId, who: Asker, parts: Parts) -> Spectra:
    """Return the power spectral densities of a record's channels."""
    return signals.spectra(signals.samples(parts, record_id, who))


@router.get(
    "/records/{record_id}/stabilisation",
    dependencies=[auth.VIEWER, WAITING],
    responses=answers(401, 404, 422, 503),
)
def stabilisation(record_id: RecordId, who: Asker, parts: Parts) -> StabilisationOut:
    """Return the poles of every model order, computed by a worker."""
    return StabilisationOut(**uploads.by_worker(parts, record_id, who, workers.engine.stabilisation))


@router.get(
    "/records/{record_id}/spectrogram",
    dependencies=[auth.VIEWER, WAITING],
    responses=answers(401, 404, 422),
)
def spectrogram(
    record_id: RecordId,
    who: Asker,
    parts: Parts,
    channel: Annotated[str | None, Query(max_length=128)] = None,
    up_to_hz: Annotated[float, Query(gt=0.0, le=1e6)] = 2.0,
    segment_s: Annotated[float, Query(ge=1.0, le=600.0)] = 60.0,
) -> SpectrogramOut:
    """Return the spectral density of a channel through time; default: the first channel."""
    found = signals.samples(parts, record_id, who, None if channel is None else [channel])
    return signals.spectrogram(found, channel, up_to_hz, segment_s)


@router.get(
    "/records/{record_id}/motion",
    dependencies=[auth.VIEWER, WAITING],
    responses=answers(401, 404, 422, 503),
)
def motion(
    record_id: RecordId,
    who: Asker,
    parts: Parts,
    duration_s: Annotated[float, Query(gt=0.0, le=600.0)] = 60.0,
) -> MotionOut:
    """Return the liveliest part of a record as a motion of the structure, computed by a worker."""
    return MotionOut(**uploads.by_worker(parts, record_id, who, workers.record_views.motion, duration_s))


@router.get(
    "/records/{record_id}/stretches",
    dependencies=[auth.VIEWER, WAITING],
    responses=answers(401, 404, 422, 503),
)
def stretches(record_id: RecordId, who: Asker, parts: Parts) -> Page[StretchOut]:
    """Return where in a record samples are missing or left out, and the moments that findings name."""
    return Page(items=uploads.stretches(parts, record_id, who))


@router.put(
    "/records/{record_id}/picks",
    status_code=202,
    dependencies=[auth.ENGINEER],
    responses=answers(400, 401, 403, 404, 422),
)
def picks(record_id: RecordId, body: PicksIn, who: Asker, parts: Parts, connection: Writes) -> RecordAccepted:
    """Select the poles of a record manually; it is identified again, and user and time are logged."""
    record = known_record(connection, record_id, who)
    if record.waveform is None:
        raise ApiError(404, "the samples of this record were deleted", field="record_id")
    job_id = uploads.pick(connection, parts, record, body, who.name)
    return RecordAccepted(record_id=record_id, job_id=job_id)


@router.post(
    "/records/{record_id}/set-aside",
    dependencies=[auth.ENGINEER],
    responses=answers(400, 401, 403, 404, 422),
)
def set_aside(
    record_id: RecordId, body: Acknowledgement, who: Asker, parts: Parts, connection: Writes
) -> RecordOut:
    """Withdraw all results of a record on request; trying its job again restores them."""
    asset = known_record(connection, record_id, who).asset
    consequences.set_aside(connection, parts, asset, record_id, f"{body.comment} ({who.name})")
    people.note_down(connection, who.name, "set aside", f"{asset}/{record_id}", "ok", parts.now())
    return signals.record_out(known_record(connection, record_id, who))
