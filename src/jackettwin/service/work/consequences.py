"""Consequences of a result, stored in the same transaction.

These are modes, findings, and the states of the day and of later ones.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection, select

from jackettwin.findings import Finding
from jackettwin.service import workers
from jackettwin.service.intake.bundles import twin_folder
from jackettwin.service.intake.examination import profile
from jackettwin.service.intake.files import living
from jackettwin.service.workers.question import Question
from jackettwin.service.workers.tasks import Outcome, Task
from jackettwin.store import (
    StoredObservation,
    assets,
    journal,
    people,
    records,
    results,
    rounded,
    streams,
    tables,
    work,
)
from jackettwin.store.columns import FORGOTTEN
from jackettwin.store.mode_bins import keep_days
from jackettwin.store.results import StoredState

if TYPE_CHECKING:
    from jackettwin.service.context import Place, Service


_SUBJECT = 255
"""Longest subject of a finding in the table, which PostgreSQL enforces."""
NEWEST = 24
"""Number of newest observations that a turbine's page lists; its results are of all."""


def task_of(connection: Connection, service: Place, job: work.Job) -> Task:
    """Return the task of a job for a worker, after extracting the twin's files."""
    record = records.find_record(connection, job.asset, job.record_id)
    if record is None or record.waveform is None:
        raise LookupError(f"record {job.record_id} of {job.asset} has no samples")
    end = record.start_utc + timedelta(seconds=record.duration_s)
    site = streams.conditions_between(connection, job.asset, record.start_utc, end)
    return Task(
        waveform=str(service.settings.store / record.waveform),
        twin_folder=str(twin_folder(connection, service, job.asset, job.version)),
        asset=job.asset,
        version=job.version,
        conditions={**site, **record.conditions},
        picks=record.picks,
    )


def observing(connection: Connection, service: Service, job: work.Job) -> None:
    """Set a record's status to being observed, unless the adopted version has observed it."""
    record = records.find_record(connection, job.asset, job.record_id)
    if record is not None and record.status == "received":
        records.set_status(connection, job.asset, job.record_id, "observing")
        journal.tell(connection, "job", job.asset, {"job_id": job.id, "state": "leased"}, service.now())


def question_of(connection: Connection, service: Place, job: work.Job, *, every_day: bool) -> Question:
    """Return the task of estimating a turbine's supports from its state.

    It contains the days that are not in the stored sums and those of the stiffness track's window, or every
    day if the worker requested them.
    """
    key = (job.asset, job.model_hash)
    identities = results.state_hashes(connection, *key)
    kept = results.find_kept(connection, job.asset, job.version)
    if workers.engine.days_unsummed(kept.get("past"), identities) is None:
        kept = {name: kept.get(name) for name in ("judged", "followed")}
    after = None if every_day else _days_known(kept, identities)
    return Question(
        job.asset,
        job.version,
        str(twin_folder(connection, service, job.asset, job.version)),
        identities,
        {state.day: state.document for state in results.states_until(connection, *key, after=after)},
        tuple(seen.document for seen in results.newest_observations(connection, *key, NEWEST)),
        results.observed_time(connection, *key),
        kept,
        results.identity_of(identities),
    )


def _days_known(kept: Mapping[str, Any], identities: Mapping[str, str]) -> str | None:
    """Return the day after which days must be sent; None for all."""
    unsummed = workers.engine.days_unsummed(kept.get("past"), identities)
    needed = workers.stiffness.days_needed(kept.get("followed"), identities)
    if unsummed is None or (needed is None and kept.get("followed") is not None):
        return None
    return unsummed if needed is None else min(unsummed, needed)


def keep_known(connection: Connection, service: Service, job: work.Job, outcome: Outcome) -> None:
    """Store the estimates of a turbine's supports and the findings on changes."""
    if work.finish(connection, job, service.server_id, "done", service.now()):
        put_known(connection, service, assets.found_version(connection, job.asset, job.version), outcome)


def put_known(connection: Connection, service: Place, version: assets.Version, outcome: Outcome) -> None:
    """Store what is known of a version's supports; ask again if a day changed meanwhile."""
    now, asset, model_hash = service.now(), version.asset, version.model_hash
    document = json.loads(outcome.document or "{}")
    page = outcome.page
    if outcome.same_page:
        page = results.find_report(connection, asset, version.version)
    results.put_knowledge(connection, asset, version.version, document, page, now)
    results.drop_findings(connection, asset, model_hash, origin="work")
    journal.tell(connection, "state", asset, {"known": document["known"]["status"]}, now)
    if outcome.of != results.identity_of(results.state_hashes(connection, asset, model_hash)):
        ask_known(connection, service, version)
    adopted = assets.found_version(connection, asset)
    if version.version != adopted.version and model_hash == adopted.model_hash:
        return  # only the adopted version reports changes
    key = {"asset": asset, "model_hash": model_hash, "record_id": ""}
    rows = [
        _finding_row(f, key, datetime.fromisoformat(f["time_utc"]), f["day"], "watch")
        for f in outcome.findings
    ]
    for new in results.put_watched(connection, asset, model_hash, rows):
        if new["severity"] != "info":
            said = {name: new[name] for name in ("code", "severity", "subject", "params", "text")}
            journal.tell(connection, "finding", asset, said, now)


def ask_known(connection: Connection, service: Place, version: assets.Version) -> None:
    """Queue the estimation from the present state, after all observations.

    It is repeated after a running estimation with fewer records.
    """
    named = replace(
        version, settings_hash=f"version {version.version}"
    )  # laws and priors belong to its settings
    number = work.enqueue(connection, named, "", service.now(), kind=work.KNOW, priority=-10)
    work.try_again(connection, number, service.now())


def keep(connection: Connection, service: Service, job: work.Job, outcome: Outcome) -> None:
    """Store the outcome of a job and all its consequences, unless another server has taken the job."""
    now, me = service.now(), service.server_id
    if outcome.document is None:
        if work.finish(connection, job, me, "failed", now, outcome.problem):
            _end_open(connection, job, "refused", outcome.problem or {}, now)
        return
    lock(connection, job.asset)
    if not work.finish(connection, job, me, "done", now):
        return
    record = records.find_record(connection, job.asset, job.record_id)
    if record is None or record.status == "set_aside":
        return
    keep_observation(connection, service, job, record, outcome)


def keep_observation(
    connection: Connection, service: Place, job: work.Job, record: records.StoredRecord, outcome: Outcome
) -> None:
    """Keep what was observed in a record, and advance the state of its day."""
    assert outcome.document is not None
    now, adopted = service.now(), assets.found_version(connection, job.asset)
    key = {"asset": job.asset, "model_hash": job.model_hash, "record_id": job.record_id}
    again = results.find_observation(connection, job.asset, job.record_id, job.model_hash) is not None
    observation = StoredObservation(
        settings_hash=job.settings_hash,
        start_utc=record.start_utc,
        code_version=job.code_version,
        document=rounded(
            outcome.document
        ),  # rounded as stored, so that summing the day again gives the same state
        **key,
    )
    day = f"{record.start_utc:%Y-%m-%d}"
    keep_days(connection, job.asset, job.model_hash, record.start_utc)
    results.put_observation(
        connection,
        observation,
        [
            {**mode, **key, "model_version": job.version, "time_utc": record.start_utc}
            for mode in outcome.modes
        ],
        [_finding_row(f, key, record.start_utc, day, "observe") for f in outcome.findings],
    )
    if job.model_hash == adopted.model_hash or record.status not in ("observed", "mismatched"):
        status = "observed" if outcome.problem is None else "mismatched"
        records.set_status(connection, job.asset, job.record_id, status, outcome.problem)
    fold(connection, service, job.asset, job.version, observation, anew=again)
    journal.tell(
        connection,
        "observation",
        job.asset,
        {
            "record_id": job.record_id,
            "version": job.version,
            "modes": len(outcome.modes),
            "adopted": adopted.version,
        },
        now,
    )
    for finding in [f for f in outcome.findings if f["severity"] != "info"]:
        journal.tell(connection, "finding", job.asset, {**finding, "record_id": job.record_id}, now)
    for version in living(connection, job.asset, adopted):
        if version.model_hash == job.model_hash:
            ask_known(connection, service, version)
    journal.tell(connection, "state", job.asset, {"day": day, "version": job.version}, now)


def failed(connection: Connection, service: Service, job: work.Job, reason: str) -> None:
    """Return a job to the queue after its worker ended, or set its record aside after the last try."""
    problem = {"detail": reason, **_TRY_AGAIN}
    state = work.put_back(connection, job, service.server_id, problem)
    if state == "set_aside" and job.kind != work.KNOW:
        _end(connection, job.asset, job.record_id, state, problem, service.now())
    elif state == "set_aside":
        _alarm_unknown(connection, job, reason, service.now())


def _alarm_unknown(connection: Connection, job: work.Job, reason: str, now: datetime) -> None:
    """Raise an alarm that a turbine's days cannot be evaluated, so that no change would be detected."""
    said = Finding("study_set_aside", None, {"job": job.id, "tries": work.MOST_TRIES, "reason": reason})
    row = {name: getattr(said, name) for name in ("code", "severity", "subject", "params", "text")}
    key = {"asset": job.asset, "model_hash": job.model_hash, "record_id": ""}
    results.put_findings(connection, [_finding_row(row, key, now, f"{now:%Y-%m-%d}", "work")])
    journal.tell(connection, "finding", job.asset, row, now)


_TRY_AGAIN = {"field": "record", "remedy": "try the job again, on the page of jobs"}


def cancel(connection: Connection, service: Place, job: work.Job, by: str) -> bool:
    """Cancel an unfinished job, and set its record aside if the adopted version has not observed it."""
    if not work.cancel(connection, job.id, service.now()):
        return False
    people.note_down(connection, by, "cancel", str(job.id), "ok", service.now())
    journal.tell(connection, "job", job.asset, {"job_id": job.id, "state": "cancelled"}, service.now())
    if job.version == assets.found_version(connection, job.asset).version:
        problem = {"detail": f"cancelled by {by}", **_TRY_AGAIN}
        _end_open(connection, job, "set_aside", problem, service.now())
    return True


def set_aside(connection: Connection, service: Place, asset: str, record_id: str, why: str) -> None:
    """Withdraw all results of a record that another one includes, or on request."""
    lock(connection, asset)
    for job in work.jobs_of(connection, asset, record_id):
        work.cancel(connection, job.id, service.now())
    for version in assets.all_versions(connection, asset):
        gone = results.find_observation(connection, asset, record_id, version.model_hash)
        if gone is not None:
            results.drop_observation(connection, asset, version.model_hash, record_id)
            fold(connection, service, asset, version.version, gone, anew=True)
            ask_known(connection, service, version)
    _end(connection, asset, record_id, "set_aside", {"detail": why, **_TRY_AGAIN}, service.now())


def fold(
    connection: Connection,
    service: Place,
    asset: str,
    version: int,
    changed: StoredObservation,
    *,
    anew: bool = False,
) -> None:
    """Bring the state of a day up to date.

    A day is a sum over its records that does not depend on their order. New records are added; after a
    repeated observation or a removal the day is summed again, unless its observations were deleted, in which
    case it is not changed.
    """
    day, model_hash = f"{changed.start_utc:%Y-%m-%d}", changed.model_hash
    stored = None if anew else results.find_state(connection, asset, model_hash, day)
    if stored is None:
        start = datetime.fromisoformat(day).replace(tzinfo=UTC)
        todo = list(
            results.observations_between(connection, asset, model_hash, start, start + timedelta(days=1))
        )
        if any(seen.document == FORGOTTEN for seen in todo):
            return
        results.drop_state(connection, asset, model_hash, day)
    else:
        todo = [changed]
    if not todo:
        return
    model = profile(connection, service, asset, version)
    before, new = stored.document if stored else None, [observation.document for observation in todo]
    folded = workers.engine.advance_day(model, day, before, new)
    if folded.n_records:  # none, if all are of another structure
        results.put_state(connection, StoredState(asset, model_hash, day, folded.n_records, folded.document))
    key = {"asset": asset, "model_hash": model_hash}
    rows = [
        _finding_row(
            finding, {**key, "record_id": observation.record_id}, observation.start_utc, day, "advance"
        )
        for observation, found in zip(todo, folded.findings, strict=True)
        for finding in found
    ]
    results.put_findings(connection, rows)


def lock(connection: Connection, asset: str) -> None:
    """Lock an asset until the transaction ends, so that servers update its days one after the other."""
    connection.execute(select(tables.assets.c.name).where(tables.assets.c.name == asset).with_for_update())


def _end_open(
    connection: Connection, job: work.Job, status: str, problem: Mapping[str, Any], now: datetime
) -> None:
    """Store the reason why an unobserved record will not be observed."""
    record = records.find_record(connection, job.asset, job.record_id)
    if record is not None and record.status in ("received", "observing"):
        _end(connection, job.asset, job.record_id, status, problem, now)


def _end(
    connection: Connection, asset: str, record_id: str, status: str, problem: Mapping[str, Any], now: datetime
) -> None:
    records.set_status(connection, asset, record_id, status, problem)
    told = {"record_id": record_id, "status": status, "detail": problem.get("detail", "")}
    journal.tell(connection, "record", asset, told, now)


def _finding_row(
    finding: Mapping[str, Any], key: Mapping[str, Any], time: datetime, day: str, origin: str
) -> dict[str, Any]:
    """Return the row of a finding, whose words a channel of a stranger's file may have named."""
    words = {
        name: finding[name] and str(finding[name]).replace("\0", "\ufffd") for name in ("subject", "text")
    }
    subject = words["subject"] and words["subject"][:_SUBJECT]
    return {**finding, **words, "subject": subject, **key, "time_utc": time, "day": day, "origin": origin}
