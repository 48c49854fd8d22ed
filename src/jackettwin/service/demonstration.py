"""A demonstration asset whose records arrive in fast motion.

So that a newcomer sees a twin live within a minute.
"""

from __future__ import annotations

import logging
import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from importlib.resources import files
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from jackettwin.records import Record, read_record
from jackettwin.records.identity import record_id
from jackettwin.service.desk import add_twin
from jackettwin.service.intake.files import Accepted, accept
from jackettwin.service.tasks import Parsed, about
from jackettwin.store import assets, reading, waveform_path, write_waveform, writing
from jackettwin.twin import read_twin

if TYPE_CHECKING:
    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

ASSET = "demo"
TWIN = "openfast_pile"
_EVERY_S = 4.0


def demonstrate(service: Service) -> Thread:
    """Add the demonstration asset and start a thread in which its records arrive, one every few seconds.

    The shipped records are ten minutes each; they arrive as if measured an hour apart, ending now, so that
    the same demonstration started tomorrow goes on.
    """
    thread = Thread(target=_arrive, args=(service,), name="demonstration", daemon=True)
    thread.start()
    return thread


def _arrive(service: Service) -> None:
    try:
        source = Path(str(files("jackettwin.data") / "twins" / f"{TWIN}.yaml"))
        with reading(service.database) as connection:
            known = ASSET in assets.asset_names(connection)
        if not known:
            add_twin(service.database, service.settings.store, ASSET, source, "the shipped demonstration")
        hour = datetime.now(UTC).replace(minute=0, second=0, microsecond=0)
        paths = read_twin(source).records
        for i, path in enumerate(paths):
            record = replace(read_record(path), start_utc=hour - timedelta(hours=len(paths) - i))
            take_record(service, ASSET, record)
            service.wake()
            time.sleep(_EVERY_S)
    except Exception:
        log.exception("the demonstration stops")


def take_record(service: Service, asset: str, record: Record) -> Accepted:
    """Keep a record that is in memory, and queue it."""
    assert record.start_utc is not None
    number = record_id(record)
    place = waveform_path(asset, record.start_utc, number)
    size = write_waveform(record, service.settings.store / place)
    with writing(service.database) as connection:
        return accept(
            service.now(), connection, asset, Parsed(number, place, size, about(record)), record.name
        )
