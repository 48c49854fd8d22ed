"""How fast the window is with much: docs/verification/window.md.

Usage: ``python qualify/window.py [--years 10] [--frames 60]``. The demonstration is given as many rows of
modes as four modes of a ten-minute record have in these years, and a record of a day (nine channels at
50 Hz), and is served by a process of its own. Chromium opens its pages, pans and zooms through all years at
once, opens the day, and shows 24 channels of 50 Hz that stream in.

Bars, on a machine whose 800×800 ``eig`` takes 0.47 s: first useful paint 1 s, 30 frames a second, a day's
signal 1 s, 20 frames a second live. Frames are judged by the CPU time of the page's process, which a loaded
machine does not stretch.
"""

from __future__ import annotations

import argparse
import math
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from datetime import UTC, datetime, time as clock, timedelta
from pathlib import Path
from typing import Any, cast

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from common.pace import eigenvalue_seconds
from common.page import write_page
from playwright.sync_api import Browser, expect, sync_playwright
from sqlalchemy import select
from tests.service.conftest import Here
from tests.service.servers import Server, opened

from jackettwin.records import Channel, Record
from jackettwin.service import ServiceSettings
from jackettwin.service.context import Service
from jackettwin.service.demonstration import ASSET, arrive, lay_out
from jackettwin.service.story import UNTIL
from jackettwin.store import Packet, assets, sqlite_url, streams, tables, writing
from jackettwin.store.mode_bins import keep_days

REFERENCE_S = 0.47
LABELS = {"side_side_1": 0.175, "fore_aft_1": 0.178, "torsion_1": 0.642, "side_side_2": 0.744}
MOVES = """async ([frames, key, rest]) => {
    const box = document.querySelector("figure.plot [role=img]");
    for (let k = 0; k < frames; k++) {
        box.dispatchEvent(new KeyboardEvent("keydown", { key: key[k % key.length], bubbles: true }));
        await new Promise(requestAnimationFrame);
        if (rest && k % 4 === 2) await new Promise((done) => setTimeout(done, rest));
    }
}"""
ONE_AFTER_ANOTHER = """() => {
    const every = ["navigation", "resource"].flatMap((kind) => performance.getEntriesByType(kind));
    const ended = every.filter((e) => e.responseEnd > 0 && !/events|live$/.test(e.name));
    const deep = ended.sort((a, b) => a.startTime - b.startTime).map((e) => ({ e, n: 1 }));
    for (const one of deep)
        for (const o of deep) if (o.e.responseEnd <= one.e.startTime) one.n = Math.max(one.n, o.n + 1);
    return Math.max(...deep.map((one) => one.n));
}"""
"""The longest chain of requests each of which began after another one had ended."""
REST_MS = 1000
"""A reader who stands still so long sees the closer look that he asked for."""


def filled(store: Path, years: int) -> tuple[str, int]:
    """Lay out the demonstration with many modes and a record of a day; return its number and the rows."""
    settings = ServiceSettings(store=store)
    for place in (store, settings.spool, settings.models, settings.inbox):
        place.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(0)
    began = datetime.combine(UNTIL, clock(), UTC) + timedelta(days=1)
    channels = tuple(Channel(f"acc_{k}_x", "acceleration", "m/s^2", 20.0 + k) for k in range(9))
    day = Record(rng.standard_normal((9, 86_400 * 50)), 50.0, channels, began, name="day")
    with opened(settings.database_url) as made:
        service = Service(settings, made, cast(Any, Here()), "window", now=lambda: began + timedelta(days=1))
        lay_out(service)
        arrive(service, day)
        with writing(made) as connection:
            connection.execute(tables.work.delete())
            connection.execute(tables.records.update().values(status="observed"))
            own = tables.records.c.start_utc == began
            number = connection.scalar(select(tables.records.c.record_id).where(own))
            like = assets.found_version(connection, ASSET)
            for year in range(years):
                connection.exec_driver_sql(_INSERT, list(_modes(rng, like.model_hash, year)))
            for _ in range(13 * (years + 3)):  # as records that arrive day by day have them kept
                keep_days(connection, ASSET, like.model_hash, began)
    return str(number), years * 52_560 * len(LABELS)


_INSERT = """insert into modes (asset, model_hash, model_version, status, record_id, time_utc, label,
frequency_hz, frequency_std_hz, frequency_relative_std, damping_ratio)
values (?, ?, 1, 'ok', ?, ?, ?, ?, ?, 0.005, ?)"""


def _modes(rng: np.random.Generator, model_hash: str, year: int) -> Iterator[tuple[object, ...]]:
    """Yield the modes of a year's records, before the demonstration's days, as SQLite keeps them."""
    first = datetime.combine(UNTIL, clock(), UTC) - timedelta(days=365 * (year + 3))
    noise = rng.standard_normal((52_560, len(LABELS), 2))
    for k in range(52_560):
        at = f"{first + timedelta(minutes=10 * k):%Y-%m-%d %H:%M:%S.%f}"
        for (label, f), (x, y) in zip(LABELS.items(), noise[k].tolist(), strict=True):
            now = f * (1.0 + 0.005 * x)
            values = (now, 0.005 * now, 0.01 * math.exp(0.3 * y))
            yield (ASSET, model_hash, f"{year:02d}{k:06d}", at, label, *values)


class Window:
    """A page of the window in an empty browser, and what its process costs."""

    def __init__(self, browser: Browser, url: str, wanted: str) -> None:
        for old in browser.contexts:
            old.close()
        self.devtools = browser.new_browser_cdp_session()
        self.page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
        before = time.perf_counter()
        self.page.goto(url, wait_until="commit")
        self.page.locator(wanted).first.wait_for(timeout=300_000)
        self.opened_s, self.opened_cpu_s = time.perf_counter() - before, self.cpu_s()
        self.in_turn: int = self.page.evaluate(ONE_AFTER_ANOTHER)

    def cpu_s(self) -> float:
        """Return the CPU time of the page's process until now, its helping threads among it [s]."""
        processes = self.devtools.send("SystemInfo.getProcessInfo")["processInfo"]
        return sum(float(one["cpuTime"]) for one in processes if one["type"] == "renderer")

    def frame_ms(self, keys: list[str], frames: int, rest_ms: int = 0) -> float:
        """Return the CPU time of a frame while all plots move together [ms], with a rest in every fourth."""
        before = self.cpu_s()
        self.page.evaluate(MOVES, [frames, keys, rest_ms])
        return 1e3 * (self.cpu_s() - before) / frames


def live(window: Window, store: Path, seconds: int = 8) -> tuple[float, float]:
    """Stream 24 channels of 50 Hz; return frames a second and the CPU time of a frame [ms]."""
    frames = "Number(document.querySelector('canvas.lanes').dataset.frames)"
    with opened(sqlite_url(store)) as made:
        for second in range(30 + seconds):
            now = datetime.now(UTC)
            if second == 30:
                drawn, cpu, at = window.page.evaluate(frames), window.cpu_s(), time.perf_counter()
            t = time.time() + np.arange(50) / 50.0
            packets = [Packet(ASSET, f"strain_{k:02d}", now, 50.0, np.sin((k + 1) * t)) for k in range(24)]
            with writing(made) as connection:
                streams.add_packets(connection, packets, now)
            time.sleep(max(0.0, 1.0 - (datetime.now(UTC) - now).total_seconds()))
    drawn = window.page.evaluate(frames) - drawn
    return drawn / (time.perf_counter() - at), 1e3 * (window.cpu_s() - cpu) / drawn


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--years", type=int, default=10)
    parser.add_argument("--frames", type=int, default=60)
    given = parser.parse_args()
    chromium = next(p for p in ("chromium", "chromium-browser", "google-chrome") if shutil.which(p))
    paces: list[float] = []
    rows: list[tuple[str, float, str, float]] = []

    def opens(what: str, window: Window, bar: str) -> None:
        tell(f"{what} [s]", window.opened_s, bar, window.opened_cpu_s)
        tell("its requests, one after another", window.in_turn, "–", math.nan)

    def tell(what: str, value: float, bar: str, cpu: float) -> None:
        paces.append(REFERENCE_S / eigenvalue_seconds())  # beside each: the machine's other work changes
        rows.append((what, value, bar, cpu * paces[-1]))
        print(rows[-1], file=sys.stderr, flush=True)

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        store = Path(folder) / "store"
        number, n = filled(store, given.years)
        browser = playwright.chromium.launch(executable_path=shutil.which(chromium), args=["--no-sandbox"])
        with Server(store, "--workers", "1") as server:
            own = f"{server.url}/assets/{ASSET}"
            for _ in range(2):  # what a server computes once, it has computed
                first = Window(browser, own, ".figures dd")
            opens("first useful paint of a turbine", first, "1")
            for _ in range(2):
                day = Window(browser, f"{own}/records/{number}", ".uplot canvas")
            opens("a day's signal, three channels of 50 Hz", day, "1")
            worst = Window(browser, f"{own}/records", "[aria-label='The worst first'] tbody tr")
            tell("the worst records of all years [s]", worst.opened_s, "1", worst.opened_cpu_s)
            years = Window(browser, f"{own}/timeline", ".uplot canvas")
            tell("all years of modes opened [s]", years.opened_s, "–", years.opened_cpu_s)
            expect(years.page.get_by_text("Bins of time")).to_be_visible()
            for what, keys in (("panned", ["ArrowRight", "ArrowLeft"]), ("zoomed", ["+", "-"])):
                took = years.frame_ms(keys, given.frames)
                tell(f"a frame of all years {what} [ms]", took, "33", took)
                took = years.frame_ms(keys, given.frames, REST_MS)
                tell("the same, a closer look with every fourth [ms]", took, "33", took)
            rate, took = live(Window(browser, f"{own}/live", "canvas.lanes"), store)
            tell("24 live channels, frames a second", rate, "20 or more", math.nan)
            tell("a frame of 24 live channels [ms]", took, "50", took)
        browser.close()
    write_page("window", page(rows, n, given, paces))


Row = tuple[str, float, str, float]


def _said(cpu: float) -> str:
    return "–" if math.isnan(cpu) else f"{cpu:.2g}"


def page(rows: list[Row], n: int, given: argparse.Namespace, paces: list[float]) -> list[str]:
    """Return the lines of the page."""
    return [
        "# The window with much",
        "",
        f"`python qualify/window.py --years {given.years} --frames {given.frames}`: {n:,} rows of modes, and",
        "a record of a day. Measured in Chromium without a graphics processor; the last",
        "column is the CPU time of the page's process, with its start, scaled to a machine whose",
        f"800×800 `eig` takes 0.47 s: times {min(paces):.2f} to {max(paces):.2f}, measured beside each.",
        "",
        "| | measured | bar | by CPU, scaled |",
        "|---|---|---|---|",
        *[f"| {what} | {value:.3g} | {bar} | {_said(cpu)} |" for what, value, bar, cpu in rows],
    ]


if __name__ == "__main__":
    main()
