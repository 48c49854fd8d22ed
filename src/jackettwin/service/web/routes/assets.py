"""Assets and the versions of their twins."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, File, Form, Path, Query, UploadFile
from fastapi.responses import Response
from sqlalchemy import Connection

from jackettwin.service.web import auth, catalogue, uploads
from jackettwin.service.web.dependencies import (
    WAITING,
    Asker,
    AssetName,
    Parts,
    ReadsAtVersion,
    Route,
    Writes,
    known_asset,
    known_version,
    living_asset,
)
from jackettwin.service.web.problems import ApiError, answers, laid_out_soon
from jackettwin.service.web.schemas.assets import (
    AssetOut,
    ConditionsIn,
    DraftOut,
    NewAsset,
    NewVersion,
    Position,
    Taken,
    VersionOut,
)
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.work import conditions
from jackettwin.store import assets, reading

router = APIRouter(tags=["assets"], route_class=Route)


@router.get(
    "/assets",
    response_model=Page[AssetOut],
    dependencies=[auth.VIEWER],
    responses=answers(401, 422, 503),
)
def list_assets(who: Asker, parts: Parts, connection: ReadsAtVersion, archived: bool = False) -> Response:
    """List the assets, or the archived ones, with status, last data and findings."""
    if archived:
        rows = catalogue.overview(connection, archived=True, seen=who.assets)
    else:
        rows = catalogue.fleet(connection, parts.fleet, seen=who.assets)
        if parts.laying_out and not rows:
            raise laid_out_soon()
    # written here: FastAPI would check a thousand rows once more
    return Response(Page(items=rows).model_dump_json(), media_type="application/json")


@router.post(
    "/assets",
    status_code=201,
    dependencies=[auth.ENGINEER, WAITING],
    responses=answers(400, 401, 403, 409, 422, 503),
)
def add_asset(body: NewAsset, who: Asker, parts: Parts) -> AssetOut:
    """Add an asset with its twin file and the files that this one names; a worker evaluates it."""
    if who.assets is not None:
        raise ApiError(403, f"{who.name} may only see some assets, which exclude a new one")

    def is_new(connection: Connection) -> None:
        if body.name in assets.asset_names(connection):
            raise ApiError(409, "an asset of this name exists already", field="name", value=body.name)

    given = (body.twin, body.files, who.name, body.comment)
    catalogue.add_text_version(parts, body.name, *given, if_fit=is_new)
    with reading(parts.database) as connection:
        return catalogue.one(connection, body.name)


@router.post(
    "/drafts", dependencies=[auth.ENGINEER, WAITING], responses=answers(400, 401, 403, 413, 422, 503, 507)
)
def draft_twin(
    parts: Parts,
    structure: Annotated[UploadFile, File(description="A SACS deck, SubDyn input or YAML file.")],
    record: Annotated[UploadFile, File(description="A record in any supported format.")],
    description: Annotated[
        UploadFile | str | None,
        Form(description="The description of the record in JSON, as a field or a file."),
    ] = None,
) -> DraftOut:
    """Draft a twin file from a structure and a record, as ``jackettwin init`` does; nothing is stored.

    Each channel is placed by its name, and what was guessed is drawn and said.
    """
    return DraftOut(**uploads.drafted(parts, structure, record, uploads.text_of(description)))


@router.get("/assets/{asset}", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def get_asset(asset: AssetName, connection: ReadsAtVersion) -> AssetOut:
    """Return one asset."""
    known_asset(connection, asset)
    return catalogue.one(connection, asset)


@router.delete("/assets/{asset}", dependencies=[auth.ADMIN], responses=answers(401, 403, 404, 422))
def archive_asset(
    asset: AssetName,
    confirm: Annotated[str, Query(description="The asset's name once more.", examples=["demo"])],
    who: Asker,
    parts: Parts,
    connection: Writes,
) -> AssetOut:
    """Archive an asset: it accepts no more records and is not listed; all its data remain stored."""
    known_asset(connection, asset)
    if confirm != asset:
        raise ApiError(
            422, "the name differs from the asset's", field="confirm", value=confirm, allowed=asset
        )
    catalogue.archive(connection, parts, asset, who.name)
    return catalogue.one(connection, asset)


@router.post("/assets/{asset}/unarchive", dependencies=[auth.ADMIN], responses=answers(401, 403, 404, 422))
def unarchive_asset(asset: AssetName, who: Asker, parts: Parts, connection: Writes) -> AssetOut:
    """Undo the archiving of an asset."""
    known_asset(connection, asset)
    catalogue.archive(connection, parts, asset, who.name, undo=True)
    return catalogue.one(connection, asset)


@router.put(
    "/assets/{asset}",
    dependencies=[auth.ENGINEER, WAITING],
    responses=answers(400, 401, 403, 404, 409, 422, 503),
)
def put_asset(asset: AssetName, body: NewVersion, who: Asker, parts: Parts) -> VersionOut:
    """Add a version, which also observes records and is used once it is adopted."""
    given = (body.twin, body.files, who.name, body.comment)
    version = catalogue.add_text_version(parts, asset, *given, if_fit=partial(living_asset, name=asset))
    with reading(parts.database) as connection:
        return catalogue.version_out(connection, version)


@router.put(
    "/assets/{asset}/position", dependencies=[auth.ENGINEER], responses=answers(400, 401, 403, 404, 422)
)
def put_position(asset: AssetName, body: Position, who: Asker, parts: Parts, connection: Writes) -> AssetOut:
    """Set where an asset stands, for the map."""
    known_asset(connection, asset)
    catalogue.place(connection, parts, asset, body, who.name)
    return catalogue.one(connection, asset)


@router.get("/assets/{asset}/versions", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def versions(asset: AssetName, connection: ReadsAtVersion) -> Page[VersionOut]:
    """List the versions of an asset's twin, oldest first."""
    known_asset(connection, asset)
    return Page(items=catalogue.versions_out(connection, asset))


@router.post(
    "/assets/{asset}/versions/{version}/adopt",
    dependencies=[auth.ENGINEER],
    responses=answers(401, 403, 404, 422),
)
def adopt(
    asset: AssetName,
    version: Annotated[int, Path(ge=1, le=1_000_000)],
    who: Asker,
    parts: Parts,
    connection: Writes,
) -> VersionOut:
    """Adopt a version, whose answers are then used."""
    found = known_version(connection, asset, version)
    catalogue.adopt(connection, parts, asset, version, who.name)
    return catalogue.version_out(connection, found)


@router.post(
    "/assets/{asset}/conditions",
    dependencies=[auth.ENGINEER],
    responses=answers(400, 401, 403, 404, 409, 422),
)
def add_conditions(
    asset: AssetName, body: ConditionsIn, who: Asker, parts: Parts, connection: Writes
) -> Taken:
    """Add conditions of the site over time; affected records are observed again."""
    living_asset(connection, asset)
    for name, values in body.values.items():
        if len(values) != len(body.time_utc):
            raise ApiError(422, "times and values differ in number", field=f"values.{name}")
    given = {name: dict(zip(body.time_utc, values, strict=True)) for name, values in body.values.items()}
    count, again = conditions.add_conditions(connection, parts, asset, given, who.name)
    return Taken(count=count, observed_again=again)


@router.post(
    "/assets/{asset}/conditions.csv",
    dependencies=[auth.ENGINEER, WAITING],
    responses=answers(400, 401, 403, 404, 409, 413, 422, 503),
)
def add_table(
    asset: AssetName,
    who: Asker,
    parts: Parts,
    file: Annotated[
        UploadFile, File(description="Ten-minute statistics: a line of names, a column of times.")
    ],
    zone: Annotated[str, Form(max_length=64, description="Time zone of times without one.")] = "UTC",
    end_stamped: Annotated[bool, Form(description="Whether times are the ends of the intervals.")] = False,
) -> Taken:
    """Add a table of conditions as a SCADA system exports it."""
    uploads.refuse_unfit(parts, asset)
    return uploads.take_conditions(parts, asset, file.file, zone, end_stamped, who.name)
