"""Evaluation of a twin file in a worker, within limits, before it is stored."""

from __future__ import annotations

import secrets
import shutil
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service import workers
from jackettwin.service.intake.bundles import twin_folder
from jackettwin.service.workers.failures import NoWorker
from jackettwin.service.workers.tasks import examine_twin

if TYPE_CHECKING:
    from jackettwin.service.context import Place


def examined(place: Place, contents: Mapping[str, bytes]) -> workers.engine.TwinProfile:
    """Return the profile of a twin, given as the files of its bundle.

    Raises
    ------
    InputError
        If it cannot be read, names files that were not sent with it, or exceeds the limits of degrees of
        freedom, time or memory.
    NoWorker
        If every worker is busy.
    """
    folder = place.settings.spool / secrets.token_hex(8)
    try:
        for path, content in contents.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(content)
        return _asked(place, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def profile(
    connection: Connection, place: Place, asset: str, version: int | None = None
) -> workers.engine.TwinProfile:
    """Return the profile of a version, by default of the adopted one.

    It is stored with the version's files. If it is missing, as after a restore or an upgrade, a worker
    computes it.
    """
    folder = twin_folder(connection, place, asset, version)
    if not workers.engine.profile_path(folder).exists():
        workers.engine.keep_profile(folder, _asked(place, folder))
    return _read(workers.engine.profile_path(folder))


@lru_cache(maxsize=256)
def _read(path: Path) -> workers.engine.TwinProfile:
    """Return a profile, cached since that of a version never changes."""
    return workers.engine.read_profile(path)


def _asked(place: Place, folder: Path) -> workers.engine.TwinProfile:
    settings = place.settings
    limits = (settings.freedoms_limit, settings.worker_memory_bytes)
    cluster = getattr(place, "cluster", None)
    if cluster is None:  # the command line computes it in this process
        found = examine_twin(str(folder), *limits)
    else:
        try:
            future = cluster.submit(examine_twin, str(folder), *limits, priority=100)
            found = cluster.result(future, settings.parse_limit_s)
        except NoWorker:
            raise
        except TimeoutError:
            raise _refused("took too long", f"{settings.parse_limit_s:g} s") from None
        except Exception as error:  # its worker died
            raise _refused(f"ended its worker ({type(error).__name__})", "what a worker has") from None
    if isinstance(found, InputError):
        raise found
    return workers.engine.PROFILE.load(found)


def _refused(what: str, allowed: Any) -> InputError:
    return InputError(
        f"evaluating it {what}", field="twin", allowed=f"up to {allowed}", remedy="send a smaller model"
    )
