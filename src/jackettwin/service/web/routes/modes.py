"""Routes for results of a twin: modes, states, tables for other programs."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from jackettwin.service.context import Service
from jackettwin.service.web import answers as said, auth, signals
from jackettwin.service.web.auth import Who
from jackettwin.service.web.dependencies import (
    WAITING,
    AnyVersion,
    Asker,
    AssetName,
    Parts,
    ReadsAtVersion,
    Route,
    known_asset,
    known_version,
)
from jackettwin.service.web.problems import answers
from jackettwin.service.web.schemas.assets import ComparisonOut
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.drawings import ExploredOut, StructureOut
from jackettwin.service.web.schemas.life import LifeOut
from jackettwin.service.web.schemas.modes import (
    BudgetOut,
    ModeBinsOut,
    ModeOut,
    SensitivityOut,
    TwinOut,
    WatchOut,
)
from jackettwin.service.web.schemas.supports import SupportsOut
from jackettwin.store import ADMINS, Exported, exported, people, results, writing
from jackettwin.store.mode_bins import modes_in_bins

router = APIRouter(tags=["answers"], route_class=Route)

Cursor = Annotated[str | None, Query(max_length=500)]
Limit = Annotated[int, Query(ge=1, le=10_000)]
_PARQUET, _ARROW = "application/vnd.apache.parquet", "application/vnd.apache.arrow.stream"
State = Annotated[
    str | None, Query(max_length=64, description="First word of the records' state of operation.")
]
Order = Annotated[
    Literal["found", "least_known"],
    Query(description="least_known: largest relative standard deviation of the frequency first, one page."),
]
When = Annotated[datetime | None, Query(description="Time of the state; default: now.")]


@router.get("/assets/{asset}/modes", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def modes(
    asset: AssetName,
    connection: ReadsAtVersion,
    label: Annotated[str | None, Query(max_length=64)] = None,
    since: Annotated[datetime | None, Query(alias="from")] = None,
    until: Annotated[datetime | None, Query(alias="to")] = None,
    record: Annotated[str | None, Query(max_length=64, description="Only those of this record.")] = None,
    state: State = None,
    cursor: Cursor = None,
    limit: Limit = 1000,
    order: Order = "found",
) -> Page[ModeOut]:
    """List the modes of every record, in the order in which they were found."""
    version = known_asset(connection, asset)
    window = (signals.with_zone(since, "from"), signals.with_zone(until, "to"))
    return said.modes(
        connection, version, label, *window, cursor, limit, state, order == "least_known", record
    )


@router.get("/assets/{asset}/modes/bins", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def mode_bins(
    asset: AssetName,
    connection: ReadsAtVersion,
    label: Annotated[str | None, Query(max_length=64)] = None,
    since: Annotated[datetime | None, Query(alias="from")] = None,
    until: Annotated[datetime | None, Query(alias="to")] = None,
    state: State = None,
    points: Annotated[int, Query(ge=1, le=10_000)] = 1000,
) -> Page[ModeBinsOut]:
    """Return extremes and medians of each mode in at most so many bins of equal length of time."""
    version = known_asset(connection, asset)
    window = {"since": signals.with_zone(since, "from"), "until": signals.with_zone(until, "to")}
    found = modes_in_bins(connection, asset, version.model_hash, points, label=label, **window, state=state)
    return Page(items=[ModeBinsOut.model_validate(one, from_attributes=True) for one in found])


@router.get("/assets/{asset}/twin", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def twin(
    asset: AssetName, parts: Parts, connection: ReadsAtVersion, at: When = None, version: AnyVersion = None
) -> TwinOut:
    """Return the state of the twin at a time: mean modes and parameters with intervals."""
    asked = known_version(connection, asset, version)
    return said.twin(connection, parts, asked, signals.with_zone(at, "at"))


@router.get("/assets/{asset}/supports", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def supports(asset: AssetName, connection: ReadsAtVersion, version: AnyVersion = None) -> SupportsOut:
    """Return the stiffness of the supports on each day, filtered and smoothed, with jumps and forecast."""
    return said.supports(connection, known_version(connection, asset, version))


@router.get("/assets/{asset}/comparison", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def comparison(
    asset: AssetName,
    version: Annotated[int, Query(ge=1, le=1_000_000)],
    parts: Parts,
    connection: ReadsAtVersion,
) -> ComparisonOut:
    """Return the comparison of another version of the twin with the adopted one on the same records."""
    adopted, other = known_asset(connection, asset), known_version(connection, asset, version)
    return said.compared(connection, parts, adopted, other)


@router.get("/assets/{asset}/damping-budget", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def damping_budget(
    asset: AssetName, parts: Parts, connection: ReadsAtVersion, at: When = None, version: AnyVersion = None
) -> Page[BudgetOut]:
    """Return the damping of each mode by source; empty for past times, for which no update exists."""
    asked = known_version(connection, asset, version)
    found = said.twin(connection, parts, asked, signals.with_zone(at, "at"))
    return Page(items=found.parameters.budget)


@router.get("/assets/{asset}/sensitivity", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def sensitivity(
    asset: AssetName, parts: Parts, connection: ReadsAtVersion, version: AnyVersion = None
) -> Page[SensitivityOut]:
    """Return the sensitivity of each measured mode to every updated parameter at the present medians."""
    asked = known_version(connection, asset, version)
    found = said.twin(connection, parts, asked)
    return Page(items=found.parameters.sensitivity)


@router.get("/assets/{asset}/explore", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def explored(asset: AssetName, connection: ReadsAtVersion, version: AnyVersion = None) -> ExploredOut:
    """Return cost over two parameters of the law and over each, and root loci along each."""
    asked = known_version(connection, asset, version)
    return ExploredOut(**results.find_drawn(connection, asset, asked.version, "explored"))


@router.get("/assets/{asset}/structure", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def structure(asset: AssetName, connection: ReadsAtVersion, version: AnyVersion = None) -> StructureOut:
    """Return the structure for drawing, with its updated complex modes and the measured shape of each.

    Members whose welds records damage are coloured by damage and life too.
    """
    asked = known_version(connection, asset, version)
    found = StructureOut(**results.find_drawn(connection, asset, asked.version, "structure"))
    return said.coloured_by_life(found, results.find_life(connection, asset, asked.version))


@router.get("/assets/{asset}/watch", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def watch(asset: AssetName, connection: ReadsAtVersion, version: AnyVersion = None) -> WatchOut:
    """Return what each judged day showed: the part that conditions do not explain, and the evidence."""
    asked = known_version(connection, asset, version)
    return WatchOut(**results.find_watch(connection, asset, asked.version))


@router.get("/assets/{asset}/life", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def life(asset: AssetName, connection: ReadsAtVersion, version: AnyVersion = None) -> Page[LifeOut]:
    """Return the life of the welds that records damage most, the shortest first.

    Welds beyond the range of their factors come last.

    Empty before a record told of damage, or if the twin does not ask for it (``life:``).
    """
    asked = known_version(connection, asset, version)
    found = results.find_life(connection, asset, asked.version)
    return Page(items=[LifeOut(**row, model_version=asked.version) for row in found])


@router.get(
    "/export.parquet",
    dependencies=[auth.VIEWER, WAITING],
    response_class=Response,
    responses={200: {"content": {_PARQUET: {}}}, **answers(401, 403, 422)},
)
def export(who: Asker, parts: Parts, table: Exported = "modes") -> StreamingResponse:
    """Return a whole table of the visible assets as Parquet; those of users and servers need an admin."""
    return _exported(who, parts, table, _PARQUET)


@router.get(
    "/export.arrow",
    dependencies=[auth.VIEWER, WAITING],
    response_class=Response,
    responses={200: {"content": {_ARROW: {}}}, **answers(401, 403, 422)},
)
def export_arrow(who: Asker, parts: Parts, table: Exported = "modes") -> StreamingResponse:
    """Return a whole table as Parquet's route does, as an Arrow stream."""
    return _exported(who, parts, table, _ARROW)


def _exported(who: Who, parts: Service, table: Exported, form: str) -> StreamingResponse:
    if table in ADMINS and not who.may("admin"):
        raise auth.too_little(who, "admin")
    with writing(parts.database) as connection:
        people.note_down(connection, who.name, "download", f"table {table}", "ok", parts.now())
    pieces = exported(parts.database, table, who.assets, arrow=form == _ARROW)
    return StreamingResponse(pieces, media_type=form)
