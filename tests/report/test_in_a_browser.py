"""The report as Chromium lays it out: nothing wider than the page, nothing in the way of the verdict."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from base64 import b64encode
from hashlib import sha256
from html import unescape
from pathlib import Path

import numpy as np
import pytest
import yaml

from jackettwin.identification import Examination, parse_picks
from jackettwin.report import build_report
from jackettwin.report.pages.identification import build_identification_page
from jackettwin.study import TwinResult

CHROMIUM = next((p for p in ("chromium", "chromium-browser", "google-chrome") if shutil.which(p)), "")
MEASURE = """<script>setTimeout(() => { const r = e => e.getBoundingClientRect();
const parts = [...document.querySelectorAll("details.part")], closed = parts.filter(d => !d.open).length;
const screens = document.documentElement.scrollHeight / 900;
const answered = Math.max(...[...document.querySelectorAll("p.answer")].map(e => r(e).bottom));
const appendix = r(document.getElementById("appendix")).top / 900;
dispatchEvent(new Event("beforeprint"));
const printed = [...document.querySelectorAll("details")].every(d => d.open);
const wide = [...document.querySelectorAll("p, li, figcaption, caption, svg, h1, h2, td")].filter(
  e => r(e).width > 0 && !e.closest(".plot, .scroll, .wide") && r(e).right > innerWidth + 1);
const boxes = [...document.querySelectorAll("svg text")].map(e => [r(e), r(e.ownerSVGElement)]);
const cut = [...document.querySelectorAll(".wide")].filter(e => e.scrollWidth > e.clientWidth + 1);
document.title = JSON.stringify({page: document.documentElement.scrollWidth, window: innerWidth,
  wide: wide.length, tables: cut.map(e => e.innerText.slice(0, 60)),
  outside: boxes.filter(([a, b]) => a.left < b.left - 1 || a.right > b.right + 1).length,
  parts: parts.length, closed, answered, screens, appendix, printed, ms: performance.timing.domInteractive
  - performance.timing.fetchStart});
}, 200);</script>"""

pytestmark = pytest.mark.skipif(not CHROMIUM, reason="Chromium is not installed: pages are not laid out")


@pytest.fixture(scope="module")
def page(complete: TwinResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return with_script(build_report(complete, tmp_path_factory.mktemp("browser")), MEASURE)


def with_script(page: Path, script: str) -> Path:
    """Let a page run one more script, which its own rules would refuse."""
    code = script.removeprefix("<script>").removesuffix("</script>").encode()
    allowed = f"script-src 'sha256-{b64encode(sha256(code).digest()).decode()}'".replace("'", "&#39;")
    text = page.read_text("utf-8").replace("script-src", allowed, 1).replace("</body>", f"{script}</body>")
    page.write_text(text, "utf-8")
    return page


def laid_out(page: Path, width: int) -> dict:
    """Return what the page measured of itself; a window narrower than 500 px is an iframe's."""
    frame = page.with_name(f"at_{width}.html")
    frame.write_text(f'<iframe src="{page.name}" style="width:{width}px;height:900px;border:0"></iframe>')
    done = subprocess.run(
        [
            CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files",
            f"--window-size={width},900", "--virtual-time-budget=1500", "--dump-dom",
            str(page if width >= 500 else _measured_inside(frame)),
        ],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    found = re.search(r"<title>(\{.*?\})</title>", done.stdout)
    assert found, done.stderr[-500:]
    return json.loads(unescape(found.group(1)))


def _measured_inside(frame: Path) -> Path:
    """Let a frame take its page's title: headless windows are never narrower than 500 px."""
    script = (
        "<script>setInterval(() => {"
        "document.title = document.querySelector('iframe').contentDocument.title; }, 50)</script>"
    )
    frame.write_text(f"<html><head><title>-</title></head><body>{frame.read_text()}{script}</body></html>")
    return frame


@pytest.mark.parametrize("width", [1400, 1024, 768, 400])
def test_nothing_is_cut_off(page: Path, width: int) -> None:
    """With every section open, as before it prints; on a phone all are folded, elsewhere the appendix."""
    found = laid_out(page, width)
    assert found["printed"]
    if width == 400:
        assert found["closed"] == found["parts"] > 5 and found["screens"] < 6.0
    else:
        assert 0 < found["closed"] < found["parts"]
    assert 300 < found["answered"] < (1200 if width == 400 else 900)  # all five, in one look
    assert found["page"] <= found["window"]
    assert found["wide"] == found["outside"] == 0
    assert found["tables"] == []


def test_the_appendix_begins_within_twelve_screens_and_the_page_is_there_at_once(page: Path) -> None:
    found = laid_out(page, 1400)
    assert 1.0 < found["appendix"] <= 12.0
    assert found["ms"] < 3000.0  # parsed and laid out; figures follow when they come into view


CLICKS = """<script>window.addEventListener("load", () => { const again = () => {
  const d = document.getElementById("stabilisation_frequency");
  if (!d.data || !d.emit) { setTimeout(again, 100); return; }
  const t = d.data.filter(t => (t.mode || "").includes("markers")).pop();
  const x = t.x._inputArray || t.x, y = t.y._inputArray || t.y;
  [0, 1, 1].forEach(i => d.emit("plotly_click", {points: [{data: t, x: x[i], y: y[i]}]}));
}; again(); });</script>"""


def test_a_click_on_a_pole_picks_it_and_a_second_takes_it_back(
    observation: Examination, tmp_path: Path
) -> None:
    """The list that the page writes is one that ``--picks`` reads."""
    page = with_script(build_identification_page(observation, tmp_path / "page.html"), CLICKS)
    done = subprocess.run(
        [
            CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=20000",
            "--dump-dom", page.as_uri(),
        ],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    found = re.search(
        r'<textarea id="picks-stabilisation_frequency"[^>]*>(.*?)</textarea>', done.stdout, re.S
    )
    assert found, done.stderr[-500:]
    (pick,) = parse_picks(yaml.safe_load(unescape(found.group(1))))
    poles = observation.identification.stabilisation
    first = int(np.flatnonzero(poles.stable)[0])
    assert (pick.record, pick.order) == (observation.record.name, poles.order[first])
    assert pick.frequency_hz == pytest.approx(poles.frequency_hz[first], abs=1e-5)
