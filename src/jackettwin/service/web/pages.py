"""Pages for browsers: the window built by ``make app``, and each turbine's newest report."""

from __future__ import annotations

import gzip
import re
from functools import cache
from html import unescape
from importlib.resources import files
from typing import Annotated

from fastapi import APIRouter, Path
from fastapi.responses import HTMLResponse, Response

from jackettwin.service.web import auth
from jackettwin.service.web.dependencies import Asker, AssetName, Parts, Reads, Route, known_version
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.store import people, results, writing

router = APIRouter(include_in_schema=False, route_class=Route)

_SANDBOX = "sandbox allow-scripts allow-downloads allow-modals; frame-ancestors 'self'; "
"""Leaves a report no origin, so that it reaches none of this server's data."""
_RULES = re.compile(
    r'<!DOCTYPE html>\s*<html lang="en">\s*<head>\s*<meta charset="utf-8">\s*'
    r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">'
)
"""The rules for browsers that a report begins with, before anything that depends on what it tells."""
_KINDS = {"html": "text/html", "js": "text/javascript", "css": "text/css"}
_FOR_EVER = {"Cache-Control": "public, max-age=31536000, immutable"}
_UNBUILT = """<!doctype html><html lang="en"><meta charset="utf-8"><title>jackettwin</title>
<h1>The window is not built</h1>
<p>This installation was made from the sources, which do not contain the pages. With Node 20 or newer, run
<code>make app</code> in the repository and load this page again.</p>
<p>The server itself works: its API is described by <a href="/api/v1/openapi.json">a document</a>.</p>
</html>"""


@cache
def _built() -> dict[str, bytes]:
    """Return the files of the window by name, so that no request becomes a path; empty if not built."""
    folder = files("jackettwin.service") / "window"
    if not (folder / "index.html").is_file():
        return {}
    scripts = {file.name: file.read_bytes() for file in (folder / "assets").iterdir()}
    return {"index.html": (folder / "index.html").read_bytes(), **scripts}


@router.get("/assets/{asset}/report", dependencies=[auth.VIEWER], responses=answers(401, 404))
def report(
    asset: AssetName, who: Asker, parts: Parts, connection: Reads, version: int | None = None
) -> Response:
    """The newest report on a turbine, as ``jackettwin run`` writes it, of all records in the store.

    A sandbox keeps it from this server's data, and nothing runs in it but what it begins with by hash.
    """
    known = known_version(connection, asset, version)
    page = results.find_report(connection, asset, known.version)
    if page is None:
        raise ApiError(
            404, "there is no report yet; it is written when no record is waiting", field="asset", value=asset
        )
    with writing(parts.database) as noting:
        people.note_down(
            noting, who.name, "download", f"report of {asset}/{known.version}", "ok", parts.now()
        )
    text = gzip.decompress(page).decode()
    found = _RULES.match(text)
    rules = unescape(found[1]) if found else "default-src 'none'"
    headers = {"Content-Security-Policy": _SANDBOX + rules, "X-Frame-Options": "SAMEORIGIN"}
    return HTMLResponse(text, headers=headers)


@router.get("/window/assets/{name}", responses=answers(404))
def part_of_the_window(name: Annotated[str, Path(max_length=100)]) -> Response:
    """A script or style of the window; its name changes with its content."""
    content = _built().get(name)
    if content is None:
        raise ApiError(404, "no such file", field="name", value=name)
    kind = _KINDS.get(name.rpartition(".")[2], "application/octet-stream")
    return Response(content, media_type=kind, headers=_FOR_EVER)


@router.get("/")
@router.get("/login")
@router.get("/jobs")
@router.get("/docs")
@router.get("/start")
@router.get("/users")
@router.get("/assets/{path:path}")
def window() -> HTMLResponse:
    """The window: one page that reads its own address, and calls the API with the session of the user."""
    page = _built().get("index.html")
    if page is None:
        return HTMLResponse(_UNBUILT, status_code=503)
    return HTMLResponse(page, headers={"Cache-Control": "no-cache"})
