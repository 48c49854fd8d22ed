"""A demonstration asset: two years of simulated days, then its records, which arrive in fast motion.

So that a newcomer sees a twin live within a minute, and on every page something that happened. Its dates are
always the same, so that everybody sees the same.
"""

from __future__ import annotations

import gzip
import logging
import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, time as clock, timedelta
from importlib.resources import files
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from jackettwin.records import Record, read_record
from jackettwin.report import with_library
from jackettwin.service.intake.bundles import bundle, twin_folder
from jackettwin.service.intake.examination import examined
from jackettwin.service.intake.files import accept
from jackettwin.service.story import UNTIL, story
from jackettwin.service.web.catalogue import add_version
from jackettwin.service.work.consequences import keep_observation
from jackettwin.service.workers.engine import TWIN_FILE, load_twin, observation_rows
from jackettwin.service.workers.tasks import Outcome, stored
from jackettwin.store import asset_copy, assets, journal, reading, records, work, writing
from jackettwin.twin import read_twin

if TYPE_CHECKING:
    from sqlalchemy import Connection

    from jackettwin.service.context import Place, Service
    from jackettwin.twin import Observation

log = logging.getLogger(__name__)

ASSET = "demo"
TWIN = "openfast_pile"
SAID = "The demonstration: its five records are OpenFAST's, the two years of days before them are simulated."
_LOCKED = b"\noperation: {updates: [parked]} # of the days before its records, those with a locked shaft\n"
"""What the demonstration adds to the shipped twin: the rotor's damping is predicted for a rotor at rest."""
_EVERY_S = 4.0
SHIPPED = Path(str(files("jackettwin.data") / "demonstration.xz"))
"""The asset after its story and all records but the last, with what is known of it."""


def demonstrate(service: Service) -> Thread:
    """Add the demonstration asset and start a thread in which its last record arrives.

    What is known of the days and records before is shipped, as `scripts/write_demonstration.py` made it:
    judging two years takes minutes. If the shipped asset is of another model than the program's, the days are
    told anew and all records arrive, one every few seconds.
    """
    thread = Thread(target=_arrive, args=(service,), name="demonstration", daemon=True)
    thread.start()
    return thread


def _arrive(service: Service) -> None:
    try:
        try:
            if not lay_out(service):
                tell_story(service)
        finally:
            service.laying_out = False
        service.wake()
        for record in shipped_records():
            if arrive(service, record):
                service.wake()
                time.sleep(_EVERY_S)
    except Exception:
        log.exception("the demonstration stopped")


def shipped_records() -> Iterator[Record]:
    """Yield the records of the demonstration: ten minutes each, an hour apart on the day after the story."""
    noon = datetime.combine(UNTIL, clock(12), UTC)
    for i, path in enumerate(read_twin(_source()).records):
        yield replace(read_record(path), start_utc=noon + timedelta(hours=i))


def arrive(service: Place, record: Record) -> bool:
    """Take a record as if it had been sent; return whether it is new. Of a known one the samples are kept."""
    parsed = stored(record, ASSET, service.settings.store)
    with writing(service.database) as connection:
        if records.find_record(connection, ASSET, parsed.record_id) is not None:
            return False  # what it says is shipped, too
        return accept(service.now(), connection, ASSET, parsed, record.name).new


def lay_out(service: Place) -> bool:
    """Add the asset as shipped; return whether it is there: not if the program's twin or model is another.

    An asset that is there already stays as it is.
    """
    with reading(service.database) as connection:
        if ASSET in assets.asset_names(connection):
            return True
    rows, contents = asset_copy.read_copy(SHIPPED.read_bytes()), _contents()
    (version,) = rows["versions"]
    found = examined(service, contents)
    same = (version["model_hash"], version["settings_hash"]) == (found.identity, found.settings_hash)
    if not same or assets.unpack(version["bundle"]) != contents:
        log.warning("the shipped demonstration is of another model; its two years are told anew")
        return False
    (known,) = rows["knowledge"]
    report = with_library(known["report"].decode())  # shipped without the largest part, which is installed
    known["report"] = gzip.compress(report.encode(), mtime=0)
    with writing(service.database) as connection:
        asset_copy.copy_in(connection, rows)
        journal.tell(connection, "asset", ASSET, {"version": 1}, service.now())
    return True


def _contents() -> dict[str, bytes]:
    contents = bundle(_source())
    contents[TWIN_FILE] += _LOCKED
    return contents


def _source() -> Path:
    return Path(str(files("jackettwin.data") / "twins" / f"{TWIN}.yaml"))


def tell_story(service: Place) -> None:
    """Add the asset with two years of simulated days, as if each had been observed: all or none.

    An asset that is there already stays as it is.
    """
    with reading(service.database) as connection:
        if ASSET in assets.asset_names(connection):
            return
    add_version(service, ASSET, _contents(), "demonstration", SAID)
    with reading(service.database) as connection:
        version = assets.found_version(connection, ASSET)
        twin = load_twin(twin_folder(connection, service, ASSET, version.version))
    days = list(story(twin.config, twin.model))
    with writing(service.database) as connection:
        for seen in days:
            _keep(connection, service, version, seen)


def _keep(connection: Connection, service: Place, version: assets.Version, seen: Observation) -> None:
    now = service.now()
    found = observation_rows(seen)
    assert seen.start_utc is not None
    record = records.StoredRecord(
        asset=version.asset,
        record_id=seen.record_id,
        status="received",
        start_utc=seen.start_utc,
        duration_s=seen.duration_s,
        sample_rate_hz=seen.identification.settings.sample_rate_hz,
        channels=[],
        conditions=dict(seen.conditions),
        source_name=seen.name,
        received_utc=now,
        waveform=None,
        size_bytes=0,
    )
    job = work.Job(
        id=0,
        kind=work.OBSERVE,
        asset=version.asset,
        record_id=seen.record_id,
        version=version.version,
        model_hash=version.model_hash,
        settings_hash=version.settings_hash,
        code_version=seen.code_version,
        state="done",
        priority=0,
        tries=1,
        owner=None,
        created_utc=now,
        started_utc=now,
        ended_utc=now,
        reason=None,
    )
    said = tuple({**mode, "status": "simulated"} for mode in found.modes)
    if records.add_record(connection, record):
        keep_observation(connection, service, job, record, Outcome(**found._replace(modes=said)._asdict()))
