"""A demonstration asset whose records arrive every few seconds.

It shows a running twin within a minute.
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

from jackettwin.records import read_record
from jackettwin.service.intake.files import accept
from jackettwin.service.store_commands import add_twin
from jackettwin.service.workers.tasks import stored
from jackettwin.store import assets, reading, writing
from jackettwin.twin import read_twin

if TYPE_CHECKING:
    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

ASSET = "demo"
TWIN = "openfast_pile"
_EVERY_S = 4.0


def demonstrate(service: Service) -> Thread:
    """Add the demonstration asset and start a thread in which its records arrive, one every few seconds.

    The shipped records are ten minutes each; they are dated an hour apart, the last one now, so that a
    demonstration started again later continues.
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
            parsed = stored(record, ASSET, service.settings.store)
            with writing(service.database) as connection:
                accept(service.now(), connection, ASSET, parsed, record.name)
            service.wake()
            time.sleep(_EVERY_S)
    except Exception:
        log.exception("the demonstration stopped")
