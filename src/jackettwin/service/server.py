"""Start and orderly stop of a server."""

from __future__ import annotations

import asyncio
import errno
import json
import logging
import os
import signal
import socket
import ssl
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import Any

import uvicorn
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.errors import InputError
from jackettwin.service.alerts.kept_channels import of_file
from jackettwin.service.alerts.outbox import Outbox
from jackettwin.service.context import Service, open_service
from jackettwin.service.intake.files import Accepted, parse_here, take_file
from jackettwin.service.intake.folder import watch_folders
from jackettwin.service.intake.mqtt import MqttIntake
from jackettwin.service.intake.opcua import OpcUaIntake
from jackettwin.service.settings import ServiceSettings, refuse_exposed
from jackettwin.service.systemd import tell_systemd
from jackettwin.service.web.app import create_app
from jackettwin.service.web.oidc import check_settings
from jackettwin.service.work.dispatch import Dispatcher
from jackettwin.service.work.housekeeping import Housekeeping
from jackettwin.service.work.stream_windows import StreamWindows
from jackettwin.service.workers.failures import NoWorker
from jackettwin.service.workers.memory import one_heap
from jackettwin.store import assets, people, reading

log = logging.getLogger(__name__)

REFUSED = ".refused.json"
"""Suffix of the file with the reason why a file could not be read."""


@contextmanager
def running(settings: ServiceSettings) -> Iterator[Service]:
    """Run a server's workers, dispatcher and intake, without its web application.

    Raises
    ------
    InputError
        If the database cannot be opened, the alerts file cannot be read, or the server would be
        reachable by others without users or TLS.
    """
    one_heap()
    told = of_file(settings.alerts)
    with ExitStack() as in_the_end:
        service = open_service(settings)
        in_the_end.callback(service.database.dispose)
        in_the_end.callback(service.cluster.close)
        with reading(service.database) as connection:
            refuse_exposed(settings, people.any_user(connection))
        check_settings(settings)
        service.periodic.append(Housekeeping(service).turn)
        dispatcher, stop = Dispatcher(service), Event()
        service.wake, service.turning = dispatcher.wake.set, lambda: dispatcher.turning
        in_the_end.callback(dispatcher.stop)
        silent = []
        if settings.mqtt is not None:
            mqtt = MqttIntake(service, settings.mqtt)
            silent.append(mqtt.silent)
            service.periodic.append(mqtt.turn)
            service.on_lost.append(mqtt.leave)
            service.broker_connected = lambda: mqtt.connected if service.has_intake else None
            service.packets_refused = lambda: mqtt.refused
            in_the_end.callback(mqtt.stop)
        if settings.opcua is not None:
            opcua = OpcUaIntake(service, settings.opcua)
            silent.append(opcua.silent)
            service.periodic.append(opcua.turn)
            service.on_lost.append(opcua.stop)
            in_the_end.callback(opcua.stop)
        if silent:
            windows = StreamWindows(service, lambda asset: all(of(asset) for of in silent))
            service.periodic.append(lambda: windows.turn() if service.has_intake else None)
        dispatcher.start()
        outbox = Outbox(service, told, settings.alerts_folder)
        outbox.start()
        in_the_end.callback(outbox.stop)
        Thread(target=_watch_inbox, args=(service, stop.is_set), name="inbox", daemon=True).start()
        in_the_end.callback(stop.set)
        yield service


def serve(settings: ServiceSettings, ready: Callable[[Service], None] = lambda _: None) -> None:
    """Run a server until it is stopped; unfinished jobs are leased again later.

    SIGTERM, which service managers send, stops it like Ctrl-C.

    Raises
    ------
    InputError
        If the store or the address cannot be opened, or the server would be reachable without protection.
    """
    signal.signal(signal.SIGTERM, _interrupt)
    _check_tls(settings)
    os.umask(0o077)  # also for workers: stored files are not readable by other users
    with _listening(settings) as door, running(settings) as service:
        config = uvicorn.Config(
            create_app(service),
            log_level="warning",
            access_log=False,
            proxy_headers=False,  # the application itself checks for trusted proxies
            ssl_certfile=settings.tls_certificate,
            ssl_keyfile=settings.tls_key,
            timeout_graceful_shutdown=3,
            server_header=False,
        )
        server = uvicorn.Server(config)

        async def main() -> None:
            task = asyncio.create_task(server.serve([door]))
            while not server.started and not task.done():
                await asyncio.sleep(0.02)
            if server.started:
                ready(service)
                tell_systemd("READY=1")
            await task
            tell_systemd("STOPPING=1")

        asyncio.run(main())


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def _listening(settings: ServiceSettings) -> socket.socket:
    """Return a listening socket, at which connections wait until the server is ready."""
    try:
        family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
        return socket.create_server((settings.host, settings.port), family=family, backlog=2048)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            remedy = "end the other server, or choose another --port"
            raise InputError("is taken", field="port", value=settings.port, remedy=remedy) from None
        problem = f"cannot listen at this address ({(error.strerror or '').partition(' (')[0]})"
        remedy = "give an address of this machine"
        raise InputError(problem, field="host", value=settings.host, remedy=remedy) from None


def _check_tls(settings: ServiceSettings) -> None:
    if settings.tls_certificate is None:
        return
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(settings.tls_certificate, settings.tls_key)
    except ssl.SSLError:
        raise InputError(
            "not a certificate with its key",
            file=settings.tls_certificate,
            field="tls-key",
            value=None if settings.tls_key is None else settings.tls_key.name,
            allowed="PEM, the key in it or by --tls-key",
        ) from None


def _watch_inbox(service: Service, stop: Callable[[], bool]) -> None:
    folder = service.settings.inbox
    with reading(service.database) as connection:
        known = assets.asset_names(connection, archived=False)
    for name in (".", *known):  # folders of a restored store may be missing
        (folder / name).mkdir(parents=True, exist_ok=True)

    def take(path: Path) -> Accepted | None:
        if not service.has_intake:  # another server of this store imports it
            return None
        try:
            return take_from_inbox(service, folder, path)
        except (SQLAlchemyError, OSError, NoWorker) as error:
            log.warning("%s waits in the inbox: %s", path.name, str(error).partition("\n")[0] or "no worker")
        except Exception:  # of this file; others go on
            log.exception("%s waits in the inbox", path.name)
        return None

    watch_folders([folder], take, stop)


def take_from_inbox(service: Service, inbox: Path, path: Path) -> Accepted | None:
    """Import a file from an asset's folder; if it cannot be read, leave it and write the reason next to it.

    Return None for a file outside any asset's folder, which is tried again later.
    """
    asset, reason = path.relative_to(inbox).parts[0], path.with_name(path.name + REFUSED)
    with reading(service.database) as connection:
        known = asset in assets.asset_names(connection, archived=False)
    if not known or path.is_symlink():
        if not reason.exists():
            of_none = _OF_NO_ASSET | {"value": None if path.parent == inbox else asset}
            _leave(path, reason, of_none if not known else _LINK)
        return None
    if not path.name.isprintable():  # also bytes of another code page, which readers cannot open
        _rename(path)
        return None
    before = _lying(path)
    taken = take_file(service, parse_here(service), asset, path, path.name)
    if taken.problem is not None and _lying(path) != before:
        return None  # another server imported it meanwhile, or it is being written again
    if taken.problem is None:
        for file in (path, path.with_suffix(".json"), reason):
            file.unlink(missing_ok=True)
        service.wake()
    else:
        _leave(path, reason, taken.problem)
    return taken


def _rename(path: Path) -> None:
    """Rename a file whose name is no text, and its description, by the bytes that are none."""
    for file in (path.with_suffix(".json"), path):
        if file.exists():
            file.rename(file.with_name(ascii(file.name)[1:-1].replace("\\udc", "_x").replace("\\", "_")))


def _lying(path: Path) -> list[tuple[int, int] | None]:
    """Return identity marks of a record file and its description, to detect changes."""
    return [_mark(file) for file in (path, path.with_suffix(".json"))]


def _mark(file: Path) -> tuple[int, int] | None:
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns


def _leave(path: Path, reason: Path, problem: dict[str, Any]) -> None:
    log.warning("%s stays in the inbox: %s", path.name, problem["detail"])
    reason.write_text(json.dumps(problem, indent=1, ensure_ascii=False), encoding="utf-8")


_LINK = {
    "detail": "the file is a link, which could name any file of the server",
    "field": "file",
    "remedy": "put the file itself into the folder",
}
_OF_NO_ASSET = {
    "detail": "the file is not in the folder of an asset, or the asset is archived",
    "field": "folder",
    "remedy": "move it to inbox/ASSET/; it is imported once that asset exists",
}
