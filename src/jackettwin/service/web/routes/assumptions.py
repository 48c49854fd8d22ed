"""Routes for the assumptions of a twin's result, and for closing tolerances."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Path

from jackettwin.service.web import auth, catalogue
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
    living_asset,
)
from jackettwin.service.web.problems import answers
from jackettwin.service.web.schemas.assets import AssumptionOut, VersionOut
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.findings import Acknowledgement
from jackettwin.store import reading, results

router = APIRouter(tags=["assumptions"], route_class=Route)


@router.get("/assets/{asset}/assumptions", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def assumptions(
    asset: AssetName, connection: ReadsAtVersion, version: AnyVersion = None
) -> Page[AssumptionOut]:
    """List the assumptions of the result; open tolerances are sorted by their effect."""
    asked = known_version(connection, asset, version)
    found = results.find_drawn(connection, asset, asked.version, "assumptions")
    return Page(items=[AssumptionOut(**one) for one in found])


@router.post(
    "/assets/{asset}/assumptions/{key}/confirm",
    status_code=201,
    dependencies=[auth.ENGINEER, WAITING],
    responses=answers(400, 401, 403, 404, 409, 422, 503),
)
def confirm(
    asset: AssetName,
    key: Annotated[str, Path(max_length=100, examples=["tolerances.rna_mass"])],
    body: Acknowledgement,
    who: Asker,
    parts: Parts,
) -> VersionOut:
    """Add a version in which a tolerance is closed; it is used once it is adopted."""
    with reading(parts.database) as connection:
        known_asset(connection, asset)
    added = catalogue.close_tolerance(
        parts, asset, key, body.comment, who.name, if_fit=partial(living_asset, name=asset)
    )
    with reading(parts.database) as connection:
        return catalogue.version_out(connection, added)
