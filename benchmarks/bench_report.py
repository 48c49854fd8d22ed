"""How long a report takes to load in a real headless Chromium: first paint, every figure in view drawn.

``python benchmarks/bench_report.py [report.html]``; without a page the shipped twin is run first. The page is
served from this machine, measures itself by the wall clock (no virtual time) while it is scrolled from top to
bottom, screen by screen, and posts what it found. Software rendering, as on a server; the best of three.

Bar: 3 s, first paint and the figures of any one screen.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Event, Thread
from typing import Any

from jackettwin.cli import main

BROWSER = next((p for p in ("chromium", "chromium-browser", "google-chrome") if shutil.which(p)), "")
SCRIPT = """<script>addEventListener("load", async () => {
  const pause = ms => new Promise(done => setTimeout(done, ms));
  const near = p => { const b = p.getBoundingClientRect();
    return b.bottom > 0 && b.top < innerHeight && b.height > 0; };
  const ready = p => p.querySelector(".main-svg, canvas") !== null;
  const paint = performance.getEntriesByName("first-contentful-paint")[0];
  const found = {loaded_s: performance.now() / 1000, screens: []};
  let first = true;
  for (let y = 0; y < document.documentElement.scrollHeight; y += innerHeight) {
    scrollTo(0, y);
    const start = first ? 0 : performance.now(); first = false;
    await pause(20);
    const plots = [...document.querySelectorAll(".plot")].filter(p => !p.dataset.big && near(p));
    while (plots.some(p => !ready(p)) && performance.now() - start < 30000) { await pause(20); }
    found.screens.push([plots.length, (performance.now() - start) / 1000]);
  }
  found.first_paint_s = paint ? paint.startTime / 1000 : null;
  fetch("/", {method: "POST", body: JSON.stringify(found)});
});</script>"""


def measured(page: str) -> dict[str, Any]:
    """Return what a page measures of itself."""
    found: dict[str, Any] = {}
    there = Event()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(page.encode())

        def do_POST(self) -> None:
            found.update(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()
            there.set()

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Handler) as server, tempfile.TemporaryDirectory() as profile:
        Thread(target=server.serve_forever, daemon=True).start()
        browser = subprocess.Popen(
            [
                BROWSER, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}",
                "--window-size=1400,900", "--remote-debugging-port=0",
                f"http://127.0.0.1:{server.server_port}/",
            ],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        there.wait(120)
        browser.terminate()
        browser.wait()
        server.shutdown()
    return found


def report(folder: Path) -> Path:
    """Run the shipped twin; return its page."""
    main(["run", "--out", str(folder)], standalone_mode=False)
    return folder / "report.html"


if __name__ == "__main__":
    if not BROWSER:
        sys.exit("Chromium is not installed")
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(sys.argv[1]) if len(sys.argv) > 1 else report(Path(scratch) / "demo")
        text = path.read_text(encoding="utf-8").replace("</body>", f"{SCRIPT}</body>")
    runs = [measured(text) for _ in range(3)]
    best = min(runs, key=lambda r: r["screens"][0][1])
    worst = max((seconds, i) for i, (_, seconds) in enumerate(best["screens"][1:], start=1))
    print(f"report of {len(text) / 1e6:.1f} MB, {len(best['screens'])} screens of 1400 × 900")
    print(f"first paint {best['first_paint_s']:.2f} s, loaded {best['loaded_s']:.2f} s (bar 3)")
    print(f"first screen with its {best['screens'][0][0]} figures {best['screens'][0][1]:.2f} s")
    print(f"slowest screen on scrolling: number {worst[1]}, {worst[0]:.2f} s (bar 3)")
