"""The pages a browser sees without the application: the list of assets, and each one's newest report."""

from __future__ import annotations

import gzip
from importlib.resources import files
from typing import Literal

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from jinja2 import Environment, PackageLoader, StrictUndefined

from jackettwin.service.web import auth, catalogue
from jackettwin.service.web.dependencies import (
    Asker,
    AssetName,
    Parts,
    Reads,
    Route,
    known_asset,
    known_version,
)
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.store import people, results, writing

router = APIRouter(include_in_schema=False, route_class=Route)

_SANDBOX = {
    "Content-Security-Policy": (
        "sandbox allow-scripts allow-downloads; default-src 'none'; style-src 'unsafe-inline'; "
        "script-src 'unsafe-inline' 'unsafe-eval' blob:; img-src data: blob:; font-src data:; "
        "worker-src blob:; frame-src blob: data: 'self'; frame-ancestors 'self'"
    ),
    "X-Frame-Options": "SAMEORIGIN",
}
_templates = Environment(
    loader=PackageLoader("jackettwin.service", "templates"), autoescape=True, undefined=StrictUndefined
)


@router.get("/")
def home(request: Request, connection: Reads) -> Response:
    """The list of assets, or the login."""
    if request.state.who is None:
        return RedirectResponse("/login")
    page = _templates.get_template("home.html.j2")
    who = request.state.who
    return HTMLResponse(page.render(assets=catalogue.overview(connection, seen=who.assets), who=who))


@router.get("/login")
def login() -> HTMLResponse:
    """Ask for name and password."""
    return HTMLResponse(_templates.get_template("login.html.j2").render())


@router.get("/assets/{asset}", dependencies=[auth.VIEWER], responses=answers(401, 404))
def asset_page(asset: AssetName, connection: Reads) -> HTMLResponse:
    """One turbine: what it does, what changed, how sure."""
    known_asset(connection, asset)
    page = _templates.get_template("asset.html.j2")
    return HTMLResponse(page.render(asset=catalogue.one(connection, asset)))


@router.get("/assets/{asset}/report", dependencies=[auth.VIEWER], responses=answers(401, 404))
def report(
    asset: AssetName, who: Asker, parts: Parts, connection: Reads, version: int | None = None
) -> Response:
    """The newest report on a turbine, as ``jackettwin run`` writes it, of all records in the store.

    It brings its own scripts; in a sandbox they can reach nothing of ours, whatever a twin file is called.
    """
    known = known_version(connection, asset, version)
    page = results.find_report(connection, asset, known.version)
    if page is None:
        raise ApiError(404, "no report yet: it is written when no record waits", field="asset", value=asset)
    with writing(parts.database) as noting:
        people.note_down(
            noting, who.name, "download", f"report of {asset}/{known.version}", "ok", parts.now()
        )
    return HTMLResponse(gzip.decompress(page), headers=_SANDBOX)


@router.get("/static/{name}")
def static(name: Literal["style.css", "home.js", "asset.js", "login.js"]) -> Response:
    """What our pages consist of besides their text."""
    content = (files("jackettwin.service") / "static" / name).read_bytes()
    kind = "text/css" if name.endswith(".css") else "text/javascript"
    return Response(content, media_type=kind, headers={"Cache-Control": "public, max-age=60"})


@router.get("/library/plotly.js")
def plotly() -> Response:
    """The drawing library, from the package that we install anyway."""
    script = (files("plotly") / "package_data" / "plotly.min.js").read_bytes()
    return Response(script, media_type="text/javascript", headers={"Cache-Control": "public, max-age=604800"})
