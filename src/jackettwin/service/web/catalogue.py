"""Assets and versions for the API and the command line."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection

from jackettwin.caveats import TOLERANCES
from jackettwin.errors import InputError
from jackettwin.files import parse_yaml, with_key
from jackettwin.service import workers
from jackettwin.service.intake.examination import examined
from jackettwin.service.web.problems import ApiError
from jackettwin.service.web.schemas.assets import AssetOut, Position, VersionOut
from jackettwin.service.work.consequences import ask_known
from jackettwin.store import assets, journal, people, reading, records, results, rights, work, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Place
    from jackettwin.service.fleet_cache import FleetCache

_PART = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
"""Pattern of a part of a file's path, which keeps paths within their folder."""


def add_text_version(
    service: Place,
    name: str,
    twin: str,
    files: Mapping[str, str],
    by: str,
    comment: str = "",
    *,
    if_fit: Callable[[Connection], None] = lambda connection: None,
) -> assets.Version:
    """Add a version of a twin given as text; see :func:`add_version`."""
    contents = {path: text.encode() for path, text in {workers.engine.TWIN_FILE: twin, **files}.items()}
    return add_version(service, name, contents, by, comment, if_fit=if_fit)


def add_version(
    service: Place,
    name: str,
    contents: Mapping[str, bytes],
    by: str,
    comment: str = "",
    *,
    if_fit: Callable[[Connection], None] = lambda connection: None,
) -> assets.Version:
    """Check a twin and add it as a version; existing records are observed with it at low priority.

    The twin is evaluated before the transaction in which it is added, so that no writer waits. ``if_fit``
    raises an error if the asset accepts no version; it is called before and in that transaction.

    Raises
    ------
    InputError
        If the twin cannot be read, or a file's name could lead out of its folder.
    """
    with reading(service.database) as connection:
        if_fit(connection)
    _check_names(contents)
    found = examined(service, contents)
    with writing(service.database) as connection:
        if_fit(connection)
        return _add(connection, service, name, contents, found, by, comment)


def close_tolerance(
    service: Place,
    asset: str,
    key: str,
    comment: str,
    by: str,
    *,
    if_fit: Callable[[Connection], None] = lambda connection: None,
) -> assets.Version:
    """Add a version of the adopted twin in which an open tolerance is closed.

    Raises
    ------
    ApiError
        404 if no such tolerance is open.
    """
    with reading(service.database) as connection:
        version = assets.found_version(connection, asset)
        found = results.find_drawn(connection, asset, version.version, "assumptions")
        contents = assets.unpack(assets.bundle_of(connection, asset, version.version))
    still_open = [one["key"] for one in found if one["confirmed"] is False]
    if key not in still_open:
        raise ApiError(
            404, "no such assumption is open", field="key", value=key, allowed=", ".join(still_open)
        )
    file = workers.engine.TWIN_FILE
    text = contents[file].decode()
    given = parse_yaml(text, file).get("tolerances") or {}
    settled = {**given, key.removeprefix(TOLERANCES): {"weighed": True}}
    contents[file] = with_key(text, "tolerances", settled).encode()
    return add_version(service, asset, contents, by, f"{key} confirmed: {comment}", if_fit=if_fit)


def _check_names(contents: Mapping[str, bytes]) -> None:
    for path in contents:
        if not all(_PART.fullmatch(part) for part in path.split("/")):
            raise InputError(
                "the name of the file is not allowed",
                field="files",
                value=path[:100],
                allowed="relative paths of letters, digits, ., _ and -",
                remedy="rename the file, also in the twin file",
            )


def _add(
    connection: Connection,
    service: Place,
    name: str,
    contents: Mapping[str, bytes],
    found: workers.engine.TwinProfile,
    by: str,
    comment: str,
) -> assets.Version:
    model_hash = found.identity
    version = assets.add_version(
        connection,
        name,
        contents,
        model_hash=model_hash,
        settings_hash=found.settings_hash,
        by=by,
        now=service.now(),
        comment=comment,
    )
    workers.engine.keep_profile(service.settings.models / version.bundle_hash, found)
    (service.settings.inbox / name).mkdir(parents=True, exist_ok=True)
    for record in records.all_with_samples(connection, name):
        work.enqueue(connection, version, record.record_id, service.now())
    if results.state_hashes(connection, name, model_hash):
        ask_known(connection, service, version)  # the same model under another law
    people.note_down(connection, by, "asset version", f"{name}/{version.version}", "ok", service.now())
    journal.tell(connection, "asset", name, {"version": version.version}, service.now())
    return version


def adopt(connection: Connection, service: Place, name: str, version: int, by: str) -> None:
    """Adopt a version, and queue the estimation of its supports.

    Raises
    ------
    InputError
        If there is no such version.
    """
    assets.adopt(connection, name, version)
    ask_known(connection, service, assets.found_version(connection, name, version))
    people.note_down(connection, by, "adopt", f"{name}/{version}", "ok", service.now())
    journal.tell(connection, "asset", name, {"version": version, "adopted": True}, service.now())


def place(connection: Connection, service: Place, name: str, at: Position, by: str) -> None:
    """Set the position of an asset.

    Raises
    ------
    InputError
        If there is no such asset.
    """
    assets.place(connection, name, **at.model_dump())
    people.note_down(connection, by, "position", name, "ok", service.now())
    journal.tell(connection, "asset", name, at.model_dump(), service.now())


def archive(connection: Connection, service: Place, name: str, by: str, *, undo: bool = False) -> None:
    """Archive an asset, or undo this. It accepts no more records; its results remain available.

    Its stored records are still observed, after those of other assets.

    Raises
    ------
    InputError
        If there is no such asset.
    """
    assets.archive(connection, name, None if undo else service.now())
    work.reorder(connection, name, 0 if undo else work.GONE)
    people.note_down(connection, by, "unarchive" if undo else "archive", name, "ok", service.now())
    journal.tell(connection, "asset", name, {"archived": not undo}, service.now())


def overview(
    connection: Connection,
    name: str | None = None,
    *,
    archived: bool = False,
    seen: rights.Assets = None,
) -> list[AssetOut]:
    """Return the visible assets, the archived ones, or one, with status.

    The number of queries does not depend on the number of assets.
    """
    counts, said = records.count_by_status(connection, name), results.count_findings(connection, name)
    unseen, known = results.open_alarms(connection, name), results.estimated(connection, name)
    return [
        AssetOut(
            **vars(row),
            **_status(row, counts.get(row.name, {}), unseen.get(row.name, []), estimate.reliable),
            records=counts.get(row.name, {}),
            findings=said.get(row.name, {}),
            remaining_years=estimate.remaining_years,
            remaining_years_interval_90=interval and list(interval),
        )
        for row in assets.summaries(connection, name, archived=archived)
        for estimate in [known.get(row.name, results.Estimated())]
        for interval in [estimate.remaining_years_interval_90]
        if seen is None or row.name in seen
    ]


def fleet(connection: Connection, cache: FleetCache[AssetOut], seen: rights.Assets = None) -> list[AssetOut]:
    """Return the visible living assets as :func:`overview` does, renewing only rows of what changed."""

    def make(name: str | None) -> dict[str, AssetOut]:
        return {row.name: row for row in overview(connection, name) if row.archived_utc is None}

    rows = cache.rows(connection, make)
    return [row for row in rows.values() if seen is None or row.name in seen]


def one(connection: Connection, name: str) -> AssetOut:
    """Return an asset with its status."""
    return overview(connection, name)[0]


def versions_out(connection: Connection, asset: str) -> list[VersionOut]:
    """Return every version of an asset in the form of the API, oldest first."""
    seen, adopted = results.count_observations(connection, asset), assets.found_version(connection, asset)
    return [
        VersionOut(
            **{name: getattr(version, name) for name in VersionOut.model_fields if hasattr(version, name)},
            adopted=version.version == adopted.version,
            observations=seen.get(version.model_hash, 0),
        )
        for version in assets.all_versions(connection, asset)
    ]


def version_out(connection: Connection, version: assets.Version) -> VersionOut:
    """Return a version in the form of the API."""
    return next(v for v in versions_out(connection, version.asset) if v.version == version.version)


_LEFT_OUT = {"refused": "refused", "mismatched": "of another structure", "set_aside": "set aside"}
"""Sentences about records of each status, if there are any."""


_UNRELIABLE = "the model cannot reproduce the measurements: what the twin says of the ground is not reliable"


def _status(row: assets.Summary, counts: dict[str, int], unseen: list[str], reliable: bool) -> dict[str, Any]:
    """Return what the light of a turbine shows, and why.

    It is the newest open alarm; or a model that does not reproduce the measurements, or records left out.
    """
    left_out = [f"{counts[status]} {words}" for status, words in _LEFT_OUT.items() if counts.get(status)]
    warnings = [] if reliable else [_UNRELIABLE]
    warnings += [f"records: {', '.join(left_out)}"] if left_out else []
    status = "alarm" if unseen else "warning" if warnings else "ok"
    status = "no data" if row.last_record_utc is None else status
    reasons = {"alarm": unseen[-1:], "warning": ["; ".join(warnings)]}.get(status, [])
    return {"status": status, "open_alarms": len(unseen), "reason": "".join(reasons)}
