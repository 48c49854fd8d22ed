"""Start a server and stop it well."""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import Any

import uvicorn
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.service.app import create_app
from jackettwin.service.begun import NoWorker, one_heap
from jackettwin.service.chores import Housekeeping
from jackettwin.service.context import Service, open_service
from jackettwin.service.dispatch import Dispatcher
from jackettwin.service.intake.files import Accepted, parse_here, take_file
from jackettwin.service.intake.folder import watch_folders
from jackettwin.service.intake.mqtt import MqttIntake
from jackettwin.service.settings import ServiceSettings, refuse_exposed
from jackettwin.store import assets, people, reading

log = logging.getLogger(__name__)

INBOX = "inbox"
"""Folder of the store whose folders, named like assets, take records."""
REFUSED = ".refused.json"
"""What is added to the name of a file that could not be read, for the file that says why."""


@contextmanager
def running(settings: ServiceSettings) -> Iterator[Service]:
    """Run everything of a server but its web application: workers, dispatcher, intake.

    Raises
    ------
    InputError
        If the database cannot be opened, or others could reach a server without users or TLS.
    """
    one_heap()
    service = open_service(settings)
    try:
        with reading(service.database) as connection:
            refuse_exposed(settings, people.any_user(connection))
        mqtt = None if settings.mqtt is None else MqttIntake(service, settings.mqtt)
        service.chores.append(Housekeeping(service))
        if mqtt is not None:
            service.chores.append(mqtt)
            service.broker_connected = lambda: mqtt.connected
            mqtt.start()
        dispatcher, stop = Dispatcher(service), Event()
        service.wake, service.turning = dispatcher.wake.set, dispatcher.is_alive
        dispatcher.start()
        inbox = Thread(target=_watch_inbox, args=(service, stop.is_set), name="inbox", daemon=True)
        inbox.start()
        yield service
        stop.set()
        if mqtt is not None:
            mqtt.stop()
        dispatcher.stop()
    finally:
        service.compute.close()
        service.database.dispose()


def serve(settings: ServiceSettings, ready: Callable[[Service], None] = lambda _: None) -> None:
    """Serve until told to stop; requests under way are answered, work under way is leased again later."""
    with running(settings) as service:
        config = uvicorn.Config(
            create_app(service),
            host=settings.host,
            port=settings.port,
            log_level="warning",
            access_log=False,
            proxy_headers=settings.behind_proxy,
            forwarded_allow_ips="*" if settings.behind_proxy else None,
            ssl_certfile=settings.tls_certificate,
            ssl_keyfile=settings.tls_key,
            timeout_graceful_shutdown=3,
            server_header=False,
        )
        server = uvicorn.Server(config)

        async def main() -> None:
            task = asyncio.create_task(server.serve())
            while not server.started and not task.done():
                await asyncio.sleep(0.02)
            if server.started:
                ready(service)
            await task

        asyncio.run(main())


def _watch_inbox(service: Service, stop: Callable[[], bool]) -> None:
    folder = service.settings.store / INBOX
    folder.mkdir(exist_ok=True)

    def take(path: Path) -> Accepted | None:
        try:
            return take_from_inbox(service, folder, path)
        except (SQLAlchemyError, OSError, NoWorker) as error:
            log.warning("%s waits in the inbox: %s", path.name, str(error).partition("\n")[0] or "no worker")
            return None

    watch_folders([folder], take, stop)


def take_from_inbox(service: Service, inbox: Path, path: Path) -> Accepted | None:
    """Take a file that lies in an asset's folder; what could not be read stays, with the reason beside it.

    Return None for a file of no asset, which is looked at again: there may be one by then.
    """
    asset, reason = path.relative_to(inbox).parts[0], path.with_name(path.name + REFUSED)
    with reading(service.database) as connection:
        known = asset in assets.asset_names(connection, archived=False)
    if not known:
        if not reason.exists():
            _leave(path, reason, _OF_NO_ASSET | {"value": None if path.parent == inbox else asset})
        return None
    taken = take_file(service.database, service.now, parse_here(service), asset, path, path.name)
    if taken.problem is None:
        for file in (path, path.with_suffix(".json"), reason):
            file.unlink(missing_ok=True)
        service.wake()
    else:
        _leave(path, reason, taken.problem)
    return taken


def _leave(path: Path, reason: Path, problem: dict[str, Any]) -> None:
    log.warning("%s stays in the inbox: %s", path.name, problem["detail"])
    reason.write_text(json.dumps(problem, indent=1, ensure_ascii=False), encoding="utf-8")


_OF_NO_ASSET = {
    "detail": "lies in the folder of no asset, or of one that is archived",
    "field": "folder",
    "remedy": "put it into inbox/ASSET/; it is taken once there is that asset",
}
