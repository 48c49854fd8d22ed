"""``python -m pictures [FOLDER]``: draw every picture of the documentation, by default into docs/pictures."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import httpx
import plotly.graph_objects as go
from playwright.sync_api import Page, expect, sync_playwright

from jackettwin.client import Client
from jackettwin.errors import InputError
from pictures.drawn import DRAWN
from pictures.table import write_table

DOCS = Path(__file__).parents[2] / "docs" / "pictures"


class Shot(NamedTuple):
    """A picture of one figure on a page that a command wrote, or of the top of the page."""

    name: str
    page: str
    figure: str | None
    """Words of the figure's caption; none for the top of the page."""
    width: int = 760
    height: int = 560


COMMANDS = (
    "run --out demo",
    "view jacket15 --out view.html",
    "law zener:k0=1.48e6,c=5e4,k1=3.1096e5 kelvin-voigt:k=1.48e6,c=5e4 --mass 1.12e6 --out law.html",
    "soil jacket15 --out soil.html",
    "explore thesis_table_6_1 --law kelvin-voigt --over k,c --out explore.html",
    "simulate parked --out parked.parquet",
    "identify parked.parquet --report parked.html",
    "watch table.csv --columns f1,f2,f3 --conditions none --out watched",
)
SHOTS = (
    Shot("report", "demo/report.html", None, 1280, 1200),
    Shot("structure", "view.html", None, 1000, 760),
    Shot("supports", "law.html", "store and lose", 1000),
    Shot("soil", "soil.html", "resist lateral"),
    Shot("updating", "explore.html", "Where is the cost low"),
    Shot("condensed", "explore.html", "as c varies"),
    Shot("response", "demo/report.html", "Pale: at rest", 1000),
    Shot("identification", "demo/report.html", "which poles are stable"),
    Shot("posterior", "demo/report.html", "how are the parameters correlated"),
    Shot("damping_budget", "demo/report.html", "What causes the damping"),
    Shot("closing_loop", "demo/report.html", "What did the data add"),
    Shot("simulation", "parked.html", "Welch"),
    Shot("watching", "watched/report.html", "nine days out of ten"),
)
WINDOW = (
    Shot("window_turbine", "/assets/demo", None, 1280, 900),
    Shot(
        "window_timeline",
        "/assets/demo/timeline?mode=fore_aft_2&from=2023-12-05&to=2025-11-30",
        None,
        1280,
        860,
    ),
    Shot(
        "window_structure",
        "/assets/demo/structure?quantity=life%20left,%20worst%20weld%20%5Byears%5D&motion=fore-aft%202&play=0&phase=0.02",
        None,
        1280,
        1040,
    ),
    Shot("window_record", "/assets/demo/records/{record}", None, 1280, 1100),
    Shot("window_life", "/assets/demo/life", None, 1280, 760),
)
"""Pages of the demonstration, served; ``{record}`` is its newest record."""
ADDRESS, PORT = "http://127.0.0.1:8479", "8479"


def main(out: Path) -> None:
    """Run the commands, open their pages in Chromium, and keep a picture of each figure wanted."""
    out.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        write_table(folder / "table.csv")
        for command in COMMANDS:
            print(f"jackettwin {command}", file=sys.stderr)
            subprocess.run(
                [sys.executable, "-m", "jackettwin", *command.split()],
                cwd=folder,
                check=True,
                stdout=subprocess.DEVNULL,
            )
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium")
        for shot in SHOTS:
            page = browser.new_page(viewport={"width": shot.width, "height": shot.height})
            _take(page, (folder / shot.page).as_uri(), shot, out / f"{shot.name}.png")
            page.close()
        with _demonstration(folder / "live") as record:
            for shot in WINDOW:
                page = browser.new_page(viewport={"width": shot.width, "height": shot.height})
                _take(page, ADDRESS + shot.page.format(record=record), shot, out / f"{shot.name}.png")
                page.close()
        for drawn, figure in DRAWN.items():
            _draw(browser.new_page(viewport={"width": 760, "height": 460}), figure, out / f"{drawn}.png")
        browser.close()


@contextmanager
def _demonstration(store: Path) -> Iterator[str]:
    """Serve the demonstration until its last record is observed and reported; yield that record's number."""
    print("jackettwin serve --demo", file=sys.stderr)
    command = [sys.executable, "-m", "jackettwin", "serve", str(store), "--demo", "--port", PORT]
    server = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield _newest_record()
    finally:
        server.terminate()
        server.wait()


def _newest_record(within_s: float = 600.0) -> str:
    with Client(ADDRESS) as api:
        for _ in range(int(within_s)):
            time.sleep(1.0)
            try:
                known, record = api.twin("demo")["parameters"], next(api.records("demo", limit=1), None)
            except (httpx.TransportError, InputError):  # it has not started, or is being laid out
                continue
            if known["reported"] and record and record["status"] == "observed":
                return str(record["record_id"])
    raise TimeoutError(f"no report of the demonstration within {within_s:g} s")


def _take(page: Page, url: str, shot: Shot, out: Path) -> None:
    """Keep the picture of a figure, without its caption's surroundings."""
    page.goto(url)
    page.wait_for_timeout(1000)
    expect(page.locator(".bones")).to_have_count(0, timeout=60_000)  # what the window shows while it waits
    page.wait_for_timeout(2000)
    if shot.figure is None:
        page.screenshot(path=out)
        return
    page.evaluate("document.querySelectorAll('details.part').forEach(part => { part.open = true })")
    figure = page.locator("figure", has_text=shot.figure).first
    figure.scroll_into_view_if_needed()
    page.wait_for_timeout(500)
    figure.screenshot(path=out)


def _draw(page: Page, figure: Callable[[], go.Figure], out: Path) -> None:
    page.set_content(figure().to_html(include_plotlyjs=True, config={"displayModeBar": False}))
    page.wait_for_timeout(1500)
    page.screenshot(path=out)
    page.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else DOCS)
