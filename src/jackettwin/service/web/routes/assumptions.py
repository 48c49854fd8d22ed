"""Routes for the assumptions of a twin's result, and for closing tolerances."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Path

from jackettwin.caveats import TOLERANCES
from jackettwin.files import parse_yaml, with_key
from jackettwin.service.web import auth, catalogue
from jackettwin.service.web.dependencies import (
    WAITING,
    AnyVersion,
    Asker,
    AssetName,
    Parts,
    Route,
    Told,
    known_asset,
    known_version,
    living_asset,
)
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.service.web.schemas import Acknowledgement, AssumptionOut, Page, VersionOut
from jackettwin.service.workers import engine
from jackettwin.store import assets, reading, results

router = APIRouter(tags=["assumptions"], route_class=Route)


@router.get("/assets/{asset}/assumptions", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def assumptions(asset: AssetName, connection: Told, version: AnyVersion = None) -> Page[AssumptionOut]:
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
        version = assets.found_version(connection, asset)
        found = results.find_drawn(connection, asset, version.version, "assumptions")
        contents = assets.unpack(assets.bundle_of(connection, asset, version.version))
    still_open = [one["key"] for one in found if one["confirmed"] is False]
    if key not in still_open:
        raise ApiError(
            404, "no such assumption is open", field="key", value=key, allowed=", ".join(still_open)
        )
    text = contents[engine.TWIN_FILE].decode()
    given = parse_yaml(text, engine.TWIN_FILE).get("tolerances") or {}
    settled = {**given, key.removeprefix(TOLERANCES): {"weighed": True}}
    contents[engine.TWIN_FILE] = with_key(text, "tolerances", settled).encode()
    comment = f"{key} confirmed: {body.comment}"
    added = catalogue.add_version(
        parts, asset, contents, who.name, comment, if_fit=partial(living_asset, name=asset)
    )
    with reading(parts.database) as connection:
        return catalogue.version_out(connection, added)
