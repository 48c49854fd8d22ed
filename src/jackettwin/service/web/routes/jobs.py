"""Jobs: waiting, running and failed."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query
from sqlalchemy import Connection

from jackettwin.service.web import auth
from jackettwin.service.web.auth import Who
from jackettwin.service.web.dependencies import Asker, Parts, Reads, Route, Writes
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.server import JobOut
from jackettwin.service.work import consequences
from jackettwin.store import journal, people, records, work

router = APIRouter(tags=["jobs"], route_class=Route)

JobId = Annotated[int, Path(ge=1, le=2**53)]
State = Literal["queued", "leased", "done", "failed", "set_aside", "cancelled"]


@router.get("/jobs", dependencies=[auth.VIEWER], responses=answers(401, 422))
def list_jobs(
    who: Asker,
    connection: Reads,
    state: State | None = None,
    cursor: Annotated[int | None, Query(ge=1, le=2**53)] = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> Page[JobOut]:
    """List jobs, newest first."""
    found = work.list_jobs(connection, state=state, before=cursor, limit=limit + 1, seen=who.assets)
    more = str(found[limit - 1].id) if len(found) > limit else None
    return Page(items=[_out(job) for job in found[:limit]], next_cursor=more)


@router.get("/jobs/{job_id}", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def get_job(job_id: JobId, who: Asker, connection: Reads) -> JobOut:
    """Return a job."""
    return _out(_found(connection, job_id, who))


@router.post(
    "/jobs/{job_id}/cancel", dependencies=[auth.ENGINEER], responses=answers(401, 403, 404, 409, 422)
)
def cancel(job_id: JobId, who: Asker, parts: Parts, connection: Writes) -> JobOut:
    """Cancel an unfinished job; its record is set aside until the job is tried again."""
    job = _found(connection, job_id, who)
    if not consequences.cancel(connection, parts, job, who.name):
        raise ApiError(409, f"this work is {job.state} already")
    return _out(_found(connection, job_id, who))


@router.post("/jobs/{job_id}/retry", dependencies=[auth.ENGINEER], responses=answers(401, 403, 404, 409, 422))
def retry(job_id: JobId, who: Asker, parts: Parts, connection: Writes) -> JobOut:
    """Try a failed or cancelled job again, or one whose record was set aside."""
    job = _found(connection, job_id, who)
    if not work.try_again(connection, job_id, parts.now()):
        raise ApiError(409, f"this work is {job.state} already")
    records.set_status(connection, job.asset, job.record_id, "received")
    people.note_down(connection, who.name, "retry", str(job_id), "ok", parts.now())
    journal.tell(connection, "job", job.asset, {"job_id": job_id, "state": "queued"}, parts.now())
    parts.wake()
    return _out(_found(connection, job_id, who))


def _found(connection: Connection, job_id: int, who: Who) -> work.Job:
    job = work.find_job(connection, job_id)
    if job is None or not who.sees(job.asset):
        raise ApiError(404, "no such job", field="job_id", value=str(job_id))
    return job


def _out(job: work.Job) -> JobOut:
    return JobOut(**{name: getattr(job, name) for name in JobOut.model_fields})
