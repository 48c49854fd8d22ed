"""The window in a real browser: every page opens, on a phone and in the dark, for everybody who may."""

from __future__ import annotations

import gzip
import hashlib
import re
import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from importlib.resources import files
from pathlib import Path
from urllib.parse import unquote_plus, urlencode, urlsplit
from xml.etree import ElementTree

import httpx
import numpy as np
import plotly.graph_objects as go
import pytest
import uvicorn
from playwright.sync_api import Browser, Locator, Page, Route, expect, sync_playwright
from tests.service.conftest import NOON, PASSWORD, TWIN, description, hour, make_service, record_file, turn
from tests.service.servers import CHROMIUM, free_port

from jackettwin.decks import read_structure
from jackettwin.files import find_file
from jackettwin.report.pages.page import Embedded, PageSection, Plot, Text, page_text
from jackettwin.report.view.page import View, render_view
from jackettwin.report.view.quantities import thickness_quantities
from jackettwin.service.context import Service
from jackettwin.service.demonstration import lay_out
from jackettwin.service.web import pages
from jackettwin.service.web.app import EXAMPLES, create_app
from jackettwin.service.web.catalogue import add_text_version
from jackettwin.service.web.schemas.modes import TwinOut
from jackettwin.store import Packet, journal, people, results, streams, writing
from jackettwin.store.tables import modes
from jackettwin.structure import assemble

APP = Path(__file__).parents[2] / "app"
AXE = APP / "node_modules" / "axe-core" / "axe.min.js"
PAGES = (
    "/",
    "/jobs",
    "/users",
    "/start",
    "/docs?find=alarms",
    "/assets/wtg",
    "/assets/wtg/live",
    "/assets/wtg/timeline",
    "/assets/wtg/structure",
    "/assets/wtg/explore",
    "/assets/wtg/life",
    "/assets/wtg/records",
    "/assets/wtg/records/ID",
    "/assets/wtg/alarms",
    "/assets/wtg/model",
    "/assets/wtg/reports",
)
"""Every page of the window."""
WIDTHS = {"desk": 1440, "tablet": 768, "phone": 390}

pytestmark = pytest.mark.skipif(
    not CHROMIUM or not pages._built(), reason="Chromium is not installed, or make app was not run"
)


expect.set_options(timeout=20_000)  # a loaded machine is slow, not wrong


class Open:
    """A window that is served: where, by which service, and what its browser complained of."""

    def __init__(self, url: str, service: Service, browser: Browser) -> None:
        self.url, self.service, self.browser = url, service, browser
        self.said: list[str] = []

    def page(self, path: str, *, width: int = 1440, theme: str = "light") -> Page:
        """Open a page in a browser of its own, and wait until nothing on it is awaited."""
        context = self.browser.new_context(
            viewport={"width": width, "height": 900}, color_scheme=theme, base_url=self.url
        )
        page = context.new_page()
        page.on("console", lambda m: self.said.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: self.said.append(str(error)))
        self.goto(page, path)
        return page

    @staticmethod
    def goto(page: Page, path: str) -> None:
        page.goto(path)
        page.wait_for_selector("h1")
        expect(page.locator(".bones")).to_have_count(0)


@contextmanager
def served(service: Service) -> Iterator[str]:
    """Serve from a thread of this process, which ends whatever happens: a thread that stays holds Python."""
    port = free_port()
    config = uvicorn.Config(create_app(service), port=port, log_level="error", timeout_graceful_shutdown=1)
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started:
        time.sleep(0.02)
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        server.should_exit = True
        thread.join(20.0)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    source = [p for p in (APP / "src").rglob("*.*") if p.is_file() and p.name != "schema.d.ts"]
    content = b"".join(p.read_bytes() for p in sorted(source, key=lambda p: p.as_posix()))
    built = (files("jackettwin.service") / "window" / "source").read_text("utf-8").split()[0]
    assert built == hashlib.sha256(content).hexdigest(), "the window is of another source: run make app"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which(CHROMIUM), args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(autouse=True)
def left_open(browser: Browser) -> Iterator[None]:
    """Close what a test leaves open, above all where it fails: a page holds its server."""
    yield
    for context in browser.contexts:
        context.close()


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Open]:
    """A turbine with four records and an alarm whose words are markup."""
    patch = pytest.MonkeyPatch()
    for service in make_service(tmp_path_factory.mktemp("window"), None, patch):
        with served(service) as url:
            for k in range(4):
                send(url, k)
            turn(service, 4)
            add_text_version(service, "bare", TWIN, {}, "test")
            alarm(service, url, SCRIPT)
            yield Open(url, service, browser)
    patch.undo()


RED = "rgb(255, 0, 0)"
SCRIPT = "<img src=x onerror=\"document.title='injected'\"><script>document.title='injected'</script>"


def send(url: str, k: int, *, samples: int = 200) -> httpx.Response:
    return httpx.post(
        f"{url}/api/v1/assets/wtg/records",
        files={"file": (f"r{k}.parquet", record_file(k, samples=samples))},
        data={"description": description(hour(k))},
    )


def alarm(service: Service, url: str, text: str, *, day: int = 1) -> None:
    """Let watching find a change."""
    model = httpx.get(f"{url}/api/v1/assets/wtg").json()["model_hash"]
    row = {"asset": "wtg", "model_hash": model, "record_id": "", "origin": "watch", "day": f"2025-03-0{day}"}
    said = {"code": "structure_changed", "severity": "alarm", "subject": None, "params": {}, "text": text}
    with writing(service.database) as connection:
        results.put_findings(connection, [{**row, **said, "time_utc": NOON + timedelta(days=day)}])
        journal.tell(connection, "finding", "wtg", {}, service.now())


@pytest.mark.parametrize("path", PAGES)
def test_a_page_is_whole_at_every_width_in_both_themes_and_every_state(opened: Open, path: str) -> None:
    """Nothing wider than the window or the paper, no complaint of the browser, no serious finding of axe.

    In the dark only colours are others. Then its answers become old, are awaited, do not come, are not for
    this reader, or hold nothing: each is said.
    """
    opened.said.clear()
    page = opened.page(path.replace("ID", newest(opened.url)))
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        for width in WIDTHS.values():
            page.set_viewport_size({"width": width, "height": 900})
            assert page.evaluate("document.documentElement.scrollWidth") <= width, (path, width)
        assert serious(page, rules="" if theme == "light" else "color-contrast") == [], (path, theme)
    page.emulate_media(media="print")
    page.set_viewport_size({"width": 688, "height": 900})
    assert widest_printed(page) <= 1.001, path
    assert opened.said == []
    if path in EMPTY:
        page.emulate_media(media="screen")
        says_what_it_lacks(opened, page, path)


EMPTY = {
    "/": "No turbine yet",
    "/jobs": "No job yet",
    "/users": "No user yet",
    "/assets/wtg": "No record has been observed",
    "/assets/wtg/live": "Nothing to show yet",
    "/assets/wtg/timeline": "No mode yet",
    "/assets/wtg/structure": "Nothing to draw yet",
    "/assets/wtg/explore": "Nothing to explore yet",
    "/assets/wtg/life": "No life yet",
    "/assets/wtg/records": "No record of this kind",
    "/assets/wtg/records/ID": "None yet.",
    "/assets/wtg/alarms": "No alarm",
    "/assets/wtg/model": "adopted",
    "/assets/wtg/reports": "No report yet",
}
"""What each page says where there is nothing; that of a new turbine asks for nothing."""


def says_what_it_lacks(opened: Open, page: Page, path: str) -> None:
    """Check what a page says while answers are old, awaited, lost, refused to a viewer, and empty."""
    mode, held = "lost", list[Route]()

    def answer(route: Route) -> None:
        if mode == "awaited":
            held.append(route)
        elif mode == "lost":
            route.abort()
        elif mode == "refused":
            route.fulfill(status=403, json={"detail": "this needs the role admin; eva is viewer"})
        elif "wtg/" in path and "ID" not in path:
            route.continue_()
        else:  # what this service has of these
            told = (found := route.fetch()).json()
            route.fulfill(response=found, json=told | {"items": []} if "items" in told else told)

    def viewer(route: Route) -> None:
        route.fulfill(json={**route.fetch().json(), "name": "eva", "role": "viewer"})

    page.route(re.compile(r"/api/v1/(?!events|me|law)"), answer)
    page.route("**/api/v1/me", viewer)
    with writing(opened.service.database) as connection:
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    expect(page.get_by_text("Older than it should be").first, path).to_be_visible()
    mode = "awaited"
    page.reload(wait_until="commit")
    expect(page.get_by_role("status", name="Reading").first, path).to_be_visible()
    while not held:
        page.wait_for_timeout(20)
    mode = "lost"
    for route in held:
        route.abort()
    expect(page.get_by_role("heading", name="No connection").first, path).to_be_visible()
    assert serious(page, rules="color-contrast") == [], path
    mode = "refused"
    page.get_by_role("button", name="Try again").first.click()
    expect(page.get_by_role("heading", name="Not allowed").first, path).to_be_visible()
    assert page.locator("main form, main input[type=file]").count() == 0, path
    mode = "empty"
    page.goto(path.replace("ID", newest(opened.url)) if "ID" in path else path.replace("wtg", "bare"))
    expect(page.get_by_text(EMPTY[path]).first, path).to_be_visible()
    expect(page.locator(".bones"), path).to_have_count(0)


def widest_printed(page: Page) -> float:
    """Return how far to the right anything reaches on A4, in widths of the paper between its margins."""
    reach: float = page.evaluate("""() => {
        const paper = (210 - 2 * 14) / 25.4 * 96;
        document.body.style.width = `${paper}px`;
        const drawn = [...document.querySelectorAll("main canvas, main .card, main td, main th, main p")];
        return Math.max(0, ...drawn.map((e) => e.getBoundingClientRect().right)) / paper;
    }""")
    return reach


def newest(url: str) -> str:
    """Return the number of the newest record."""
    found: str = httpx.get(f"{url}/api/v1/assets/wtg/records?limit=1").json()["items"][0]["record_id"]
    return found


def serious(page: Page, without: str = "[hidden]", rules: str = "") -> list[str]:
    """Return what axe finds of serious or critical impact, but in what is alike many times over."""
    page.evaluate(AXE.read_text("utf-8"))
    options = {"resultTypes": ["violations"]} | ({"runOnly": [rules]} if rules else {})
    run = "([without, options]) => axe.run({exclude: [without]}, options).then(r => r.violations)"
    found = page.evaluate(run, [without, options])
    return [
        f"{v['id']}: {v['nodes'][0]['html'][:200]}" for v in found if v["impact"] in ("serious", "critical")
    ]


def test_axe_finds_what_is_wrong(opened: Open) -> None:
    page = opened.page("/")
    page.evaluate("""document.querySelector("main").innerHTML = "<input><p>pale</p>";
        document.querySelector("main p").style.color = "#ddd";""")
    assert {line.split(":")[0] for line in serious(page)} >= {"label", "color-contrast"}


def test_an_alarm_is_acknowledged_by_keyboard_and_another_reader_sees_it(opened: Open) -> None:
    """Its words are text, whatever they are; who looks elsewhere sees it without loading again."""
    mine, theirs = opened.page("/assets/wtg"), opened.page("/assets/wtg")
    expect(mine.get_by_text("onerror=")).to_be_visible()
    mine.get_by_role("button", name="Acknowledge").press("Enter")
    mine.get_by_label("What you saw").fill("<b>divers</b> looked")
    mine.get_by_role("button", name="Acknowledge").press("Enter")
    for page in (mine, theirs):
        expect(page.get_by_text("<b>divers</b> looked")).to_be_visible()
        assert "injected" not in page.title()


def test_an_alarm_is_handed_on_muted_closed_and_opened_again(opened: Open) -> None:
    """What each did stays in sight, as text; what is closed is not among what asks for a person."""
    alarm(opened.service, opened.url, "A third change.", day=3)
    page = opened.page("/assets/wtg/alarms")
    one = page.get_by_role("listitem").filter(has_text="A third change.")

    def act(name: str, comment: str) -> None:
        one.get_by_role("button", name=name).click()
        one.get_by_role("textbox").last.fill(comment)
        one.locator("form button.main").click()

    one.get_by_role("button", name="Assign").click()
    one.get_by_label("To whom").fill("eva")
    one.locator("form button.main").click()
    expect(one.get_by_text("with eva")).to_be_visible()
    act("Comment", "<b>scour</b> survey ordered")
    expect(one.get_by_text("<b>scour</b> survey ordered")).to_be_visible()
    act("Mute", "until the survey")
    expect(one.locator(".light")).to_have_text("muted")
    act("Close", "rock was placed")
    expect(one).to_have_count(0)
    page.get_by_role("button", name="Closed", exact=True).click()
    expect(one.get_by_text("rock was placed")).to_be_visible()
    act("Reopen", "")
    page.get_by_role("button", name="Open", exact=True).click()
    expect(one.get_by_text("reopened")).to_be_visible()


def test_two_acknowledge_at_once_and_read_the_same(opened: Open) -> None:
    alarm(opened.service, opened.url, "A second change.", day=2)
    pages = [opened.page("/assets/wtg/alarms") for _ in range(2)]
    for page, comment in zip(pages, ("first", "second"), strict=True):
        page.get_by_role("button", name="Acknowledge").first.click()
        page.get_by_label("What you saw").fill(f"the {comment} of two")
    for page in pages:
        page.locator("form button.main").click()
    for page in pages:
        expect(page.get_by_text("the second of two")).to_be_visible()
        expect(page.locator(".error")).to_have_count(0)


def test_a_record_that_arrives_is_seen_without_loading_again(opened: Open) -> None:
    page = opened.page("/")
    own = page.locator("tbody tr", has=page.get_by_role("link", name="wtg", exact=True))
    observed = own.locator("td[data-label^='Records']")
    before = observed.inner_text()
    send(opened.url, int(before) + 20)
    turn(opened.service)
    expect(observed).to_have_text(str(int(before) + 1))


def test_a_record_is_uploaded_and_watched_until_its_state_appears(opened: Open) -> None:
    page = opened.page("/assets/wtg/records")
    one = {"name": "r90.parquet", "mimeType": "application/octet-stream", "buffer": record_file(90)}
    other = {"name": "r90.json", "mimeType": "application/json", "buffer": description(hour(90)).encode()}
    page.get_by_label("Records to send").set_input_files([one, other])
    expect(page.get_by_text("taken; it is observed soon")).to_be_visible()
    newest = page.get_by_role("region", name="Records", exact=True).locator("tbody tr").first
    expect(newest).to_contain_text("received")
    turn(opened.service)
    expect(newest).to_contain_text("observed")
    page.get_by_label("Records to send").set_input_files(
        [{"name": "r.parquet", "mimeType": "application/octet-stream", "buffer": b"rubbish"}]
    )
    expect(page.get_by_label("Sent").locator("li.error")).to_be_visible()


def test_poles_are_picked_kept_and_taken_back(opened: Open) -> None:
    made = send(opened.url, 95, samples=6000).json()["record_id"]
    page = opened.page(f"/assets/wtg/records/{made}")
    page.get_by_role("button", name="Compute the stabilisation chart").click()
    poles = page.get_by_role("group", name="Poles to take").get_by_role("checkbox")
    expect(
        poles.and_(
            page.get_by_role("checkbox", name=re.compile(r"^\d\.\d{4} Hz, [\d.]+ %, MPC [01]\.\d\d$"))
        ).first
    ).to_be_visible()
    poles.first.press("Space")
    page.get_by_role("button", name="Take 1 picked").click()
    expect(page.get_by_text("Picked by local")).to_be_visible()
    page.get_by_role("button", name="Return to the automatic choice").click()
    expect(page.get_by_text("Picked by local")).to_have_count(0)
    expect(page.get_by_role("button", name="Take 0 picked")).to_be_disabled()
    turn(opened.service)


def test_a_place_is_in_its_address(opened: Open) -> None:
    page = opened.page("/assets/wtg/timeline?show=damping&mode=mode_1")
    expect(page.get_by_role("button", name="Damping", exact=True)).to_have_attribute("aria-pressed", "true")
    expect(page.locator("figure.plot")).to_have_count(1)
    page.get_by_role("button", name="Frequency", exact=True).click()
    page.get_by_role("button", name="30 days").click()
    # The address is written at a pace, so it is waited for.
    expect(page).to_have_url(re.compile(r"\?(?!.*show)(?=.*mode=mode_1)(?=.*from=)"))
    lines = saved(page)
    assert len(lines) >= 5 and lines[0].startswith("series,time_utc,")


CONTROLS = """() => Object.fromEntries([...document.querySelectorAll(
  "main .choice button, main select, main input:is([type=range], [type=checkbox]), main th button"
)].filter(e => e.getAttribute("aria-label") !== "Time"
  && !(location.pathname.endsWith("live") && e.closest(".in-space"))).map((e, i) => [
  `${i} ${e.innerText.replace(/ [↑↓]/, "")}`,
  e.matches(".choice button") ? e.getAttribute("aria-pressed") : e.matches("th button")
  ? e.closest("th").getAttribute("aria-sort") : e.type === "checkbox" ? e.checked : e.value]))"""
"""How every control of a page stands, but the clock of a motion, and what moves a record that is awaited."""


@pytest.mark.parametrize(
    "path",
    ["/", "/jobs", "/live", "/timeline", "/structure", "/explore", "/life", "/records", "/ID", "/alarms"],
)
def test_a_link_holds_every_control_and_what_it_asks_for_in_vain_is_said(opened: Open, path: str) -> None:
    """Each is moved, then the address opened again; nonsense in it is told, and the page is as at first."""
    told = {"life": {"items": WELDS}, "watch": EXAMPLES["WatchOut"]}
    page = opened.page("/login")
    page.context.route(
        re.compile(f"/api/v1/assets/wtg/({'|'.join(told)})$"),
        lambda route: route.fulfill(json=told[route.request.url.rsplit("/", 1)[1]]),
    )
    url = path if path in ("/", "/jobs") else f"/assets/wtg{path.replace('ID', 'records/ID')}"
    opened.goto(page, url := url.replace("ID", newest(opened.url)))
    page.wait_for_timeout(300)  # parts that come by themselves
    for box in page.locator("main input[type=checkbox]").all():
        box.click()
    for listed in page.locator("main select").all():
        listed.select_option(index=listed.locator("option").count() - 1)
    for slider in page.locator("main input[type=range]").all():
        slider.press("ArrowLeft" if float(slider.input_value()) > 0.9 else "ArrowRight")
    for choice in reversed(page.locator("main .choice").all()):  # the first says which others there are
        choice.get_by_role("button").last.click()
    for title in page.locator("main tr th:last-child button, main th:nth-child(2) button").all():
        title.click()
    for plot in page.locator(".plot > [role=img]").all():
        plot.press("+")
    expect(page.locator(".bones")).to_have_count(0)
    page.wait_for_timeout(400)  # the address is written at a pace
    stands, address = page.evaluate(CONTROLS), page.url
    asked = {unquote_plus(part.split("=")[0]) for part in urlsplit(address).query.split("&")}
    assert asked != {""} and page.locator(".strange").count() == 0, address
    other = page.context.new_page()
    opened.goto(other, address)
    other.wait_for_function(f"n => Object.keys(({CONTROLS})()).length >= n", arg=len(stands))
    assert other.evaluate(CONTROLS) == stands, address
    opened.said.clear()
    opened.goto(page, f"{url}?{urlencode(dict.fromkeys(asked - UNJUDGED, 'nonsense'))}")
    words = page.locator(".strange")
    for name in asked - UNJUDGED:
        expect(words).to_contain_text(f"{name} = nonsense")
    assert opened.said == []


UNJUDGED = {
    "play",
    "record",
    "zoom-Singular values",
    *"water growth flooded sensors measured dimensions ghost".split(),
}
"""What is so or not, records, of which the server knows more, and the axis of a plot that is not drawn."""


@pytest.fixture(scope="module")
def demonstration(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Open]:
    """The shipped demonstration, as `make live` begins with it."""
    patch = pytest.MonkeyPatch()
    for service in make_service(tmp_path_factory.mktemp("shipped"), None, patch, assets=()):
        assert lay_out(service)
        with served(service) as url:
            yield Open(url, service, browser)
    patch.undo()


@pytest.mark.parametrize("width", [1440, 390])
def test_four_questions_of_a_newcomer_are_answered_within_three_clicks(
    demonstration: Open, width: int
) -> None:
    """Whose damping, when the soil changed, which record is worst, what to install: from the list on."""
    clicks = 0

    def click(where: Locator) -> None:
        nonlocal clicks
        where.click()
        clicks += 1

    page = demonstration.page("/", width=width)
    click(page.get_by_role("link", name="demo", exact=True))
    figures = page.locator(".figures dd")
    expect(page.get_by_role("term").filter(has_text="life left")).to_be_visible()
    assert figures.count() == figures.get_by_role("link").count() == 6  # each leads to its page
    expect(figures.filter(has_text="of the first weld")).to_contain_text(re.compile(r"0\.\d to \d+ \(90.%\)"))
    damping = page.locator(".answers div", has_text="Whose damping is it?")
    expect(damping).to_contain_text(
        re.compile(r"Side-side 1 has a measured damping of 2\.\d.* the rotor 2\.\d")
    )
    reason = damping.get_by_text("Why the rotor: feathered blades")
    if width == 390:
        expect(reason).to_be_hidden()
        click(damping.get_by_text("more sentences"))
    expect(reason).to_be_visible()
    ground = page.get_by_role("region", name="The ground")
    expect(ground).to_contain_text(
        re.compile(r"fell by \d.* between 2025-03-\d\d and 2025-04-\d\d, 90\s% interval")
    )
    changed = page.get_by_role("region", name="What changed, and why")
    expect(changed).to_contain_text(re.compile(r"began 2025-04-\d\d \(2025-04-\d\d to 2025-04-\d\d\)"))
    next_step = page.locator(".answers div", has_text="What to do next?")
    expect(next_step).to_contain_text("low-noise accelerometers on one foot")
    click(page.get_by_role("link", name="Records", exact=True))
    if width == 390:  # what the headings of cards are for
        first = page.locator("thead tr:has(button)").first
        assert "Sort by" in first.evaluate("e => getComputedStyle(e, '::before').content")
    worst = page.get_by_role("region", name="The worst first")
    expect(worst.locator("tbody tr").first).to_contain_text(
        re.compile(r"2025-12-01 1\d:00.*side-side 1.*± [1-9]\.\d", re.S)
    )
    expect(worst).to_contain_text(
        "the less, the more it is damped and the fewer of its cycles the record holds"
    )
    assert clicks <= 3


def test_many_modes_are_drawn_in_bins_until_they_are_few(
    tmp_path: Path, browser: Browser, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 21,000 rows the extremes are drawn, of those of a month each row, and none is lost."""
    for service in make_service(tmp_path, None, monkeypatch):
        with served(service) as url:
            model = httpx.get(f"{url}/api/v1/assets/wtg").json()["model_hash"]
            row = {"asset": "wtg", "model_hash": model, "model_version": 1, "status": "ok"}
            with writing(service.database) as connection:
                told = [
                    {**row, "record_id": f"{k:08x}", "time_utc": NOON + timedelta(hours=k), "label": "mode_1"}
                    | {"frequency_hz": 0.3 + k * 1e-6, "damping_ratio": 0.01}
                    for k in range(21_000)
                ]
                connection.execute(modes.insert(), told)
            page = Open(url, service, browser).page("/assets/wtg/timeline")
            expect(page.get_by_text("Bins of time")).to_be_visible()
            assert len(saved(page)) == 1 + 2 * 1000
            page.get_by_role("button", name="30 days").click()
            expect(page.get_by_text("Bins of time")).to_have_count(0)
            assert len(saved(page)) == 1 + 30 * 24 + 1
            page.locator("figure.plot [role=img]").press("0")
            expect(page.get_by_text("Bins of time")).to_be_visible()


def taken(where: Page | Locator, button: str) -> bytes:
    """Return the file that a button gives."""
    with (where if isinstance(where, Page) else where.page).expect_download() as download:
        where.get_by_role("button", name=button, exact=True).first.click()
    return download.value.path().read_bytes()


def saved(page: Page) -> list[str]:
    """Return the lines of the first plot's CSV."""
    return taken(page, "CSV").decode().splitlines()


def wait_for_change(picture: Locator, before: bytes) -> None:
    """Wait until a picture is no longer what it was: on a loaded machine a frame may take long."""
    for _ in range(100):
        if picture.screenshot() != before:
            return
        picture.page.wait_for_timeout(100)
    raise AssertionError("the picture stays as it was")


def test_the_structure_moves_and_stops(opened: Open) -> None:
    """Its picture changes from frame to frame, until the button is pressed; colours follow the theme."""
    page = opened.page("/assets/wtg/structure")
    picture = page.locator(".picture canvas")
    expect(page.get_by_label("Motion").locator("option")).to_have_text(["still", "fore-aft 1"])
    expect(page.get_by_text("0.2500 Hz")).to_be_visible()
    wait_for_change(picture, picture.screenshot())
    page.get_by_role("button", name="Pause").click()
    before = picture.screenshot()
    page.wait_for_timeout(300)
    assert picture.screenshot() == before
    page.get_by_role("button", name="Show in dark colours").click()
    wait_for_change(picture, before)


WELD = {name: value for name, value in EXAMPLES["LifeOut"].items() if name != "model_version"}
BUTT = {"joint": "leg_1_2 to leg_1_3", "chord": "leg_1_2", "brace": "leg_1_2", "side": "tube"}
WELDS = [
    WELD,
    {**WELD, "side": "brace"},
    {**WELD, **BUTT, "position": "45°", "scf": {"butt weld": {"nominal": {"around": 1.24}}}},
    {**WELD, "joint": "tp_top", "beyond_validity": ["brace 1: τ = 4.71 is not 0.2 to 1"]},
]
"""The example of the answer, its brace's side, a weld around a tube, and one beyond its factors."""


def test_life_is_told_weld_by_weld(opened: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing of it is wider than a phone, nor serious to axe."""
    monkeypatch.setattr(results, "find_life", lambda *_: WELDS)
    with writing(opened.service.database) as connection:
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    page = opened.page("/assets/wtg/life")
    expect(page.get_by_text("The first weld has 130 years left (31 to 540).")).to_be_visible()
    expect(page.get_by_text("Of 1 weld beyond the range of the factors nothing is certain")).to_be_visible()
    expect(page.locator("tbody tr").last).to_contain_text("doubtful")
    for name in ("leg_1_3 – brace_1_2_1, brace", "leg_1_2 to leg_1_3, tube"):
        page.get_by_role("link", name=name).click()
        expect(page.get_by_role("heading", name=name)).to_be_visible()
        expect(page.get_by_role("img", name=f"Damage around {name}")).to_be_visible()
    expect(page.get_by_text("45°", exact=True)).to_be_visible()
    expect(page).to_have_url(re.compile("weld="))
    assert serious(page) == []
    many = [{**WELD, "brace": f"brace_{k}", "rate_per_year": 1e-4 * k} for k in range(9)]
    monkeypatch.setattr(results, "find_life", lambda *_: many)
    with writing(opened.service.database) as connection:
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    page = opened.page("/assets/wtg/life", width=390)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    expect(page.locator("tbody tr")).to_have_count(5)  # each is a card: 26 of them were six screens
    page.get_by_role("button", name="Show all 9").click()
    expect(page.locator("tbody tr")).to_have_count(9)
    page.get_by_role("button", name="Damage a year").click()  # headings sort on a phone, too
    page.get_by_role("button", name="Damage a year").click()
    expect(page.locator("tbody tr").first).to_contain_text("brace_8")


@pytest.mark.parametrize(
    "path",
    ["/", "", "/live", "/timeline", "/explore", "/life", "/records/ID", "/alarms"],
)
def test_every_plot_is_taken_away_as_png_svg_and_csv(opened: Open, path: str) -> None:
    """Each thing that is drawn has three buttons, whose files stand alone; first and last are taken."""
    told = {
        "life": {"items": WELDS},
        "watch": EXAMPLES["WatchOut"],
        "supports": EXAMPLES["SupportsOut"],
        "twin": TwinOut(**EXAMPLES["TwinOut"]).model_dump(mode="json"),
    }
    page = opened.page("/docs?find=nothing")
    page.route(
        re.compile(f"/api/v1/assets/wtg/({'|'.join(told)})$"),
        lambda route: route.fulfill(json=told[route.request.url.rsplit("/", 1)[1]]),
    )
    opened.goto(page, path if path == "/" else f"/assets/wtg{path}".replace("ID", newest(opened.url)))
    drawn, menus = page.locator(".uplot, .drawn"), page.locator(".save")
    expect(drawn.first).to_be_visible()
    if path == "/live":
        expect(drawn.first).to_have_attribute("data-frames", re.compile(r"^\d\d+$"))
    assert drawn.count() == menus.count(), path
    for menu in (menus.nth(k) for k in sorted({0, menus.count() - 1})):
        assert taken(menu, "PNG").startswith(b"\x89PNG")
        svg = ElementTree.fromstring(taken(menu, "SVG"))
        marks = {"path", "rect", "circle", "image", "line"}
        assert svg.tag == f"{SVG}svg" and "class" not in {name for one in svg.iter() for name in one.attrib}
        assert sum(one.tag.removeprefix(SVG) in marks for one in svg.iter()) > 1, menu.get_attribute(
            "aria-label"
        )
        head, *lines = taken(menu, "CSV").decode().splitlines()
        assert len(head.split(",")) > 1 and len(lines) > 0, menu.get_attribute("aria-label")


SVG = "{http://www.w3.org/2000/svg}"


def test_a_turbine_begins_with_answers_and_what_they_hang_on(opened: Open) -> None:
    """Whose damping it is, the twin has told: it is not asked again."""
    page = opened.page("/docs?find=nothing")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    opened.goto(page, "/assets/wtg")
    assert not [url for url in asked if "budget" in url] and any(url.endswith("/twin") for url in asked)
    expect(page.get_by_text("Whose damping is it?")).to_be_visible()
    expect(page.get_by_text("by 12 %; to settle it: weigh it")).to_be_visible()
    page.get_by_role("button", name="Confirm").click()
    expect(page.get_by_label("How it was settled")).to_be_visible()


def test_a_parameter_is_moved_by_keyboard_the_modes_follow_and_a_link_keeps_it(opened: Open) -> None:
    page = opened.page("/assets/wtg/explore")
    cell = page.get_by_label("Modes here").locator("tbody tr td").nth(1)
    expect(cell).to_have_text("0.1810")
    page.get_by_role("slider").first.press("ArrowRight")
    expect(cell).to_have_text("0.1880")
    expect(page.get_by_text("4000 × the median")).to_be_visible()
    own = httpx.get(f"{opened.url}/api/v1/assets/wtg/twin").json()["parameters"]["parameters"]
    first = next(one for one in own.values() if one["unit"] == "N/m")["words"]
    law = page.get_by_role("region", name="Laws").get_by_role("slider", name=re.compile("stiffness"))
    expect(law).to_have_accessible_name(re.compile(rf"stiffness .*\(the twin's {first}\)"))  # where it stands
    law.press("Home")
    expect(page.get_by_text("stiffness 10 MN/m")).to_be_visible()
    page.wait_for_url("**at=*k=7*")
    page.reload()
    expect(cell).to_have_text("0.1880")
    expect(page.get_by_text("stiffness 10 MN/m")).to_be_visible()


def test_a_law_of_several_directions_names_the_one_whose_values_stand_there(opened: Open) -> None:
    page = opened.page("/jobs")
    told = EXAMPLES["ExploredOut"]
    of_two = [{**told["parameters"][0], "name": f"k_{way}", "words": f"{way} stiffness"} for way in WAYS]
    answer = {**told, "parameters": of_two, "loci": [{**told["loci"][0], "words": "stiffness"}]}
    page.route("**/api/v1/assets/wtg/explore", lambda route: route.fulfill(json=answer))
    opened.goto(page, "/assets/wtg/explore")
    expect(page.get_by_label("Parameter", exact=True)).to_have_text("stiffness, every direction")
    expect(page.get_by_role("heading", name="Along the horizontal stiffness")).to_be_visible()
    expect(page.get_by_text("Every direction's moves by the same factor")).to_be_visible()


WAYS = ("horizontal", "vertical")


def test_a_choice_stands_where_it_chooses_something(opened: Open) -> None:
    """The ground is followed over all states and modes; what conditions leave has no state."""
    page = opened.page("/assets/wtg/timeline?show=ground")
    expect(page.get_by_role("heading", name="The ground through time")).to_be_visible()
    page.get_by_role("group", name="Range").wait_for()
    state, mode = page.get_by_role("group", name="State"), page.get_by_label("Mode", exact=True)
    assert (state.count(), mode.count()) == (0, 0)
    page.get_by_role("button", name="Frequency residual").click()
    expect(mode).to_be_visible()
    assert state.count() == 0
    page.get_by_role("button", name="Damping", exact=True).click()
    expect(state).to_be_visible()


def test_a_thousand_turbines_are_on_a_map_and_those_that_need_somebody_come_first(opened: Open) -> None:
    like = httpx.get(f"{opened.url}/api/v1/assets").json()["items"][-1]
    words = {"alarm": "a change since May", "warning": "records: 1 refused", "ok": ""}

    def turbine(k: int) -> dict[str, object]:
        status = {7: "alarm", 8: "warning"}.get(k % 100, "ok")
        own = {
            "name": f"t{k:03d}",
            "status": status,
            "reason": words[status],
            "open_alarms": int(k % 100 == 7),
        }
        at = {"latitude_deg": 55.0 + 0.009 * (k // 32), "longitude_deg": 7.5 + 0.016 * (k % 32)}
        return {**like, **own, **(at if k < 990 else {})}

    page = opened.page("/jobs")
    opened.said.clear()
    answer = {"items": [turbine(k) for k in range(1000)], "next_cursor": None}
    page.route("**/api/v1/assets", lambda route: route.fulfill(json=answer))
    opened.goto(page, "/")
    expect(page.locator(".map a")).to_have_count(1000)
    expect(page.locator(".map")).to_contain_text("10 without a position")
    low, high = (page.locator(f".map a[href$='/t{k}']").bounding_box() for k in ("032", "960"))
    assert low and high and low["y"] > high["y"]  # north is up
    rows = page.locator("tbody tr")
    expect(rows).to_have_count(100)
    expect(rows.first).to_contain_text("t007")
    expect(rows.nth(10)).to_contain_text("Records: 1 refused")
    assert serious(page, ".map a:nth-of-type(n + 20)") == []
    page.get_by_role("button", name="Show all 1000").click()
    expect(rows).to_have_count(1000)
    assert opened.said == []


def test_any_page_is_printed_whole_for_the_stretch_that_it_shows(opened: Open) -> None:
    """On A4 a plot is as wide as the paper: a browser does not draw it anew for print, it is made smaller."""
    page = opened.page("/assets/wtg/timeline?from=2025-03-01T00:00:00Z&to=2025-03-02T00:00:00Z")
    expect(page.locator(".uplot canvas").first).to_be_visible()
    paper = page.pdf(prefer_css_page_size=True)
    assert paper.startswith(b"%PDF") and b"/MediaBox [0 0 594.9" in paper
    page.emulate_media(media="print")
    assert widest_printed(page) <= 1.001
    expect(page.locator(".tools").first).to_be_hidden()


def test_before_it_prints_a_dark_page_is_drawn_light_and_as_wide_as_paper(opened: Open) -> None:
    """A browser's own menu gives no time: what it prints is what stands there when `beforeprint` was told."""
    page = opened.page("/assets/wtg/timeline", theme="dark")
    plot = page.locator(".uplot canvas").first
    expect(plot).to_be_visible()
    look = "e => [e.clientWidth, e.width / devicePixelRatio, e.toDataURL()]"
    wide, _, dark = plot.evaluate(look)
    drawn = """async (e) => {
        dispatchEvent(new Event("beforeprint"));
        for (let i = 0; i < 50; i++) await null; // no frame comes between
        const sheet = document.querySelector(".uplot canvas");
        return [sheet.clientWidth, sheet.width / devicePixelRatio, sheet.toDataURL()];
    }"""
    shown, own, light = plot.evaluate(drawn)
    assert 600 < shown == own <= 687 < wide and light != dark
    assert page.evaluate("document.documentElement.dataset.theme") == "light"
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    expect(page.locator(".uplot").first).to_have_css("width", f"{wide}px")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"


def test_on_paper_columns_have_their_titles_and_nothing_asks_for_input(opened: Open) -> None:
    page = opened.page("/assets/wtg/records")
    page.emulate_media(media="print")
    expect(page.get_by_role("columnheader", name="Began")).to_contain_text("Began")
    expect(page.get_by_role("button", name="Began")).to_be_visible()
    expect(page.locator("main input").first).to_be_hidden()
    expect(page.locator(".where")).to_be_visible()  # of which turbine it is
    opened.goto(page, "/assets/wtg/explore")
    assert page.locator("main input:visible").count() == 0


def test_what_is_not_there_yet_is_said_to_be_laid_out_and_comes_by_itself(
    tmp_path: Path, browser: Browser
) -> None:
    """Every page of the demonstration, and the list of turbines, before there is one and once it is there."""
    patch = pytest.MonkeyPatch()
    for service in make_service(tmp_path, None, patch, assets=()):
        with served(service) as url:
            one, page = Open(url, service, browser), browser.new_page(base_url=url)
            service.laying_out = True
            for path in ("", "live", "explore", "records", f"records/{'0' * 24}", "reports", "/"):
                one.goto(page, path if path == "/" else f"/assets/wtg/{path}")
                expect(page.get_by_text("The demonstration is being laid out").first).to_be_visible()
                expect(page.get_by_text("No such")).to_have_count(0)
            service.laying_out = False
            expect(page.get_by_text("No turbine yet")).to_be_visible()
            service.laying_out = True
            one.goto(page, "/assets/wtg/model")
            add_text_version(service, "wtg", TWIN, {}, "test")
            service.laying_out = False
            expect(page.get_by_role("cell", name="adopted")).to_be_visible()
            page.close()
    patch.undo()


def test_any_page_is_one_file_without_server_or_script(opened: Open, tmp_path: Path) -> None:
    opened.said.clear()
    page = opened.page("/assets/wtg/timeline?show=damping")
    expect(page.locator(".uplot canvas").first).to_be_visible()
    kept = tmp_path / "page.html"
    kept.write_bytes(taken(page, "HTML"))
    page.context.set_offline(True)
    page.goto(kept.as_uri())
    expect(page.get_by_role("heading", name="Modes through time")).to_be_visible()
    picture = page.locator(".uplot img").first
    assert picture.evaluate("e => e.complete && e.naturalWidth > 300 && e.clientWidth > 300")
    assert page.locator("script, link, canvas").count() == 0
    assert opened.said == []


def test_a_part_that_a_newer_server_does_not_have_says_so(opened: Open) -> None:
    page = opened.page("/assets/wtg")
    page.route("**/window/assets/Life*", lambda route: route.fulfill(status=404))
    page.get_by_role("link", name="Life").click()
    expect(page.get_by_text("This page is older than its server.")).to_be_visible()


def test_the_worst_record_is_named_with_its_reason(opened: Open) -> None:
    """The record with the widest frequency, by its mode and the damping that makes it wide."""
    key = {"asset": "wtg", "model_hash": httpx.get(f"{opened.url}/api/v1/assets/wtg").json()["model_hash"]}
    wide = {"frequency_hz": 0.25, "frequency_std_hz": 0.02, "damping_ratio": 0.31, "damping_ratio_std": 0.1}
    row = {**key, **wide, "record_id": "badbadbad", "time_utc": NOON, "label": "fore_aft_1", "status": "ok"}
    with writing(opened.service.database) as connection:
        connection.execute(modes.insert(), {**row, "model_version": 1})
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    page = opened.page("/assets/wtg/records")
    worst = page.get_by_role("region", name="The worst first").locator("tbody tr")
    expect(worst.first).to_contain_text("fore-aft 10.2500 ± 0.032931.00 ± 16.45")
    assert worst.first.get_by_role("link").first.get_attribute("href") == "/assets/wtg/records/badbadbad"
    with writing(opened.service.database) as connection:
        connection.execute(modes.delete().where(modes.c.record_id == "badbadbad"))
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    expect(worst.first).not_to_contain_text("31.00")


SAID = {
    "comment",
    "source_name",
    "detail",
    "text",
    "statement",
    "who",
    "subject",
    "reason",
    "by",
    "law",
    "label",
}
"""Fields of answers that hold what strangers wrote, or names that they gave."""


def test_whatever_strangers_wrote_is_text(opened: Open) -> None:
    """Every comment, name and sentence of every answer is markup; no page makes elements of it."""

    def poisoned(value: object, key: str = "") -> object:
        if isinstance(value, dict):
            return {k: poisoned(v, k) for k, v in value.items()} | (
                {SCRIPT: SCRIPT} if key == "conditions" else {}
            )
        if isinstance(value, list):
            return [poisoned(one, key) for one in value]
        return SCRIPT if key in SAID and isinstance(value, str) else value

    def answer(route: Route) -> None:
        found = route.fetch()
        if "application/json" in found.headers.get("content-type", ""):
            told = found.json()
            if urlsplit(route.request.url).path.endswith("/alarms") and not told["items"]:
                told["items"] = [EXAMPLES["AlarmOut"]]  # whether there are any depends on the tests before
            return route.fulfill(response=found, json=poisoned(told))
        return route.fulfill(response=found)

    page = opened.page("/docs?find=alarms")
    page.route(re.compile(r"/api/v1/(?!events|openapi|me)"), answer)
    record = f"/assets/wtg/records/{newest(opened.url)}"
    for path in (
        "/",
        "/users",
        "/assets/wtg",
        "/assets/wtg/records",
        record,
        "/assets/wtg/alarms",
        "/assets/wtg/model",
    ):
        opened.goto(page, path)
        expect(page.get_by_text("onerror=").first).to_be_attached()
        assert page.locator("main img, main script").count() == 0, path
        assert page.title() != "injected", path


def test_a_report_is_framed_once_there_is_one(opened: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    opened.said.clear()
    page = opened.page("/assets/wtg/reports")
    expect(page.get_by_role("heading", name="No report yet")).to_be_visible()
    assert page.locator("iframe").count() == 0
    monkeypatch.setattr(results, "find_supports", lambda *_: {"law": "zener", "records": 4, "reported": True})
    heat = go.Figure(go.Heatmap(z=[[1, 2], [2, 1]]), {"height": 300})
    inside = render_view(View(jacket := assemble(read_structure("jacket15")), thickness_quantities(jacket)))
    blocks = (
        Text(("five answers",)),
        Plot("heat", "How warm?", heat),
        Embedded("space", "How?", inside, "Look"),
    )
    told = page_text([PageSection("Verdict", blocks)], title="told")
    monkeypatch.setattr(results, "find_report", lambda *_: gzip.compress(told.encode()))
    with writing(opened.service.database) as connection:
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    report = page.frame_locator("iframe.report")
    expect(report.get_by_text("five answers")).to_be_visible()
    expect(report.locator("#heat .heatmaplayer image")).to_be_attached()  # drawn without `unsafe-*`
    report.locator("#heat").hover()
    expect(report.locator("#heat .hovertext")).to_be_attached()
    expect(report.locator("#heat .modebar")).to_have_css("position", "absolute")  # the library's own sheet
    assert report.locator("#heat .modebar-btn").count() and not report.locator("[data-title*=Share]").count()
    with page.expect_download():
        report.locator("#heat .modebar-btn").first.click()
    report.get_by_role("button", name="Look").click()
    expect(report.frame_locator("iframe").locator("canvas").first).to_be_visible()
    policy = httpx.get(opened.url + "/assets/wtg/report").headers["content-security-policy"]
    assert "script-src 'sha256-" in policy and "unsafe" not in policy and "sandbox" in policy
    page.frames[1].evaluate("window.print = () => document.body.append('on paper')")  # the report's own
    page.get_by_role("button", name="Print or PDF").click()
    expect(page.frame_locator("iframe.report").get_by_text("on paper")).to_be_visible()
    page.keyboard.press("Control+p")
    expect(page.frame_locator("iframe.report").get_by_text("on paperon paper")).to_be_visible()
    assert b"five answers" in taken(page, "HTML")
    assert opened.said == []
    hostile = told.replace("<main>", f"<main>{SCRIPT}<p id=red style='color: red'>red</p>")
    monkeypatch.setattr(results, "find_report", lambda *_: gzip.compress(hostile.encode()))
    page.goto("/assets/wtg/report")  # words that nobody escaped
    assert page.title() == "told" and page.locator("#red").evaluate("e => getComputedStyle(e).color") != RED
    assert len(opened.said) >= 3


def test_what_there_is_not_says_so(opened: Open) -> None:
    opened.said.clear()
    page = opened.page("/")
    no_text = (
        ("/assets/%E0%A4", "letters a to z or A to Z, digits, _ and -"),
        ("/assets/wtg/nothing%FF", "no such page"),
    )
    for path, words in (("/assets/none", "no such asset"), ("/assets/wtg/nothing", "no such page"), *no_text):
        page.goto(path)
        expect(page.get_by_text(words).first).to_be_visible()  # each part of the page says so


def test_a_stranger_logs_in_and_comes_back_to_where_he_was(
    tmp_path: Path, browser: Browser, monkeypatch: pytest.MonkeyPatch, password_hash: str
) -> None:
    """And is sent to the login when the session ends; a viewer is told who may acknowledge."""
    for service in make_service(tmp_path / "store", None, monkeypatch):
        with served(service) as url:
            alarm(service, url, "The structure changed.")
            with writing(service.database) as connection:
                people.add_user(connection, people.User("eva", "viewer", password_hash, NOON))
                people.add_user(connection, people.User("ines", "engineer", password_hash, NOON))
            context = browser.new_context(base_url=url)
            page = context.new_page()
            page.goto("/assets/wtg")
            page.get_by_label("Name").fill("eva")
            page.get_by_label("Password").fill("not her password")
            page.get_by_role("button", name="Log in").click()
            expect(page.get_by_role("alert")).to_be_visible()
            page.get_by_label("Password").fill(PASSWORD)
            page.get_by_label("Password").press("Enter")
            page.wait_for_url("**/assets/wtg")
            expect(page.get_by_text("Engineers acknowledge alarms.")).to_be_visible()
            assert page.get_by_role("button", name="Acknowledge").count() == 0
            page.goto("/start")
            expect(page.get_by_text("Engineers add turbines.")).to_be_visible()
            context.clear_cookies()
            page.goto("/assets/wtg/timeline?show=damping")
            page.wait_for_url("**/login?next=*timeline*damping")
            page.get_by_label("Name").fill("eva")
            page.get_by_label("Password").fill(PASSWORD)
            page.get_by_label("Password").press("Enter")
            page.wait_for_url("**/assets/wtg/timeline?show=damping")  # all that the page showed
            context.clear_cookies()
            page.goto("/login?next=/%09/elsewhere.example/")  # of which a browser leaves out the tab
            page.get_by_label("Name").fill("eva")
            page.get_by_label("Password").fill(PASSWORD)
            page.get_by_label("Password").press("Enter")
            page.wait_for_url(f"{url}/")
            context.clear_cookies()
            page.goto("/login?next=/assets/wtg/alarms")
            log_in(page, "ines")
            page.get_by_role("button", name="Comment").click()
            said = page.locator("textarea")
            said.fill("The divers come on Monday.")
            for who, kept in (("ines", True), ("eva", False)):
                context.clear_cookies()  # the session ends under the open page
                page.get_by_role("button", name="Comment").click()
                expect(page.get_by_label("Password")).to_be_visible()
                expect(said).to_be_hidden()
                log_in(page, who)
                expect(page.get_by_label("Password")).to_have_count(0)
                assert (said.count() and said.input_value()) == (kept and "The divers come on Monday.")
            context.close()


def log_in(page: Page, name: str) -> None:
    page.get_by_label("Name").fill(name)
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_label("Password").press("Enter")


def test_first_load_is_small(opened: Open) -> None:
    """Scripts and styles as they are sent; those of plots come when they are asked for."""
    names = httpx.get(opened.url).text.split('"')
    asked = [name for name in names if name.startswith("/window/")]
    sent = [int(httpx.get(opened.url + name).headers.get("content-length", 0)) for name in asked]
    assert len(asked) >= 2 and 0 < sum(sent) < 400_000


def test_no_page_of_the_window_needs_an_unsafe_policy(opened: Open) -> None:
    for path in (*PAGES, "/login"):
        policy = httpx.get(opened.url + path).headers["content-security-policy"]
        assert "default-src" in policy and "unsafe" not in policy and "http" not in policy, path


def test_live_signals_roll_and_the_broker_comes_before_the_replay(opened: Open) -> None:
    """Without packets the newest record is played; with the first packet its channels are shown instead."""
    page = opened.page("/assets/wtg/live")
    expect(page.get_by_text("Nothing streams in")).to_be_visible()
    lanes = page.locator("canvas.lanes")
    expect(lanes).to_have_attribute("data-frames", re.compile(r"^([5-9]|\d\d+)$"))
    wait_for_change(lanes, lanes.screenshot())
    now, rate = opened.service.now(), 50.0
    packets = [
        Packet("wtg", f"strain_{k}", now, rate, np.sin(np.arange(250) / 10.0) * (k + 1)) for k in range(24)
    ]
    with writing(opened.service.database) as connection:
        streams.add_packets(connection, packets, now)
    expect(page.get_by_text("as they arrive from the broker")).to_be_visible()
    expect(lanes).to_have_css("height", "768px")  # once all 24 are there: each comes by itself


def test_residuals_evidence_and_a_planted_change_are_drawn(
    opened: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    years = EXAMPLES["WatchOut"] | {"days": ["2026-03-02", "2028-03-02"]}  # in which two marks are near
    monkeypatch.setattr(results, "find_watch", lambda *_: years)
    with writing(opened.service.database) as connection:
        journal.tell(connection, "state", "wtg", {}, opened.service.now())
    page = opened.page("/assets/wtg/timeline?show=left")
    expect(page.get_by_text("90 % if nothing changes")).to_be_visible()
    page.add_init_script("""window.told = {};
        const write = CanvasRenderingContext2D.prototype.fillText;
        CanvasRenderingContext2D.prototype.fillText = function (words, x, y) {
            window.told[words] = y;
            write.call(this, words, x, y);
        };""")
    opened.goto(page, "/assets/wtg/alarms")
    expect(page.get_by_text("Evidence, at most one false alarm in 10 years")).to_be_visible()
    expect(page.get_by_label("Planted change")).to_contain_text("scour at all feet of 0.34 m")
    told = page.evaluate("told")
    assert told["found by now, with 95 %"] > next(y for words, y in told.items() if "planted" in words)
    assert serious(page) == []


def test_a_record_is_drawn_as_spectrogram_and_by_singular_values(opened: Open) -> None:
    """Whatever the lowest level: from 9.5e-9 to 1e-8 a plot's search for ticks did not end."""

    def low(route: Route) -> None:
        body = (answer := route.fetch()).json()
        values = [0.01, 9.7e-9 * 1.3, *[0.01] * (len(body["frequency_hz"]) - 2)]
        route.fulfill(response=answer, json=body | {"channels": dict.fromkeys(body["channels"], values)})

    opened.said.clear()
    page = opened.page("/jobs")
    page.route("**/spectrum", low)
    opened.goto(page, f"/assets/wtg/records/{newest(opened.url)}")
    drawn = page.locator("svg.surface image")
    expect(drawn).to_have_attribute("href", re.compile("^data:image/png"))
    save = page.get_by_role("group", name="Save acc_").last
    assert all(part in taken(save, "SVG") for part in (b"<image", b"minutes after its start"))
    assert taken(save, "CSV").startswith(b"minutes after its start,frequency [Hz],level [dB of ")
    page.get_by_role("button", name="Singular values").click()
    expect(page.get_by_text("largest", exact=True)).to_be_visible(timeout=30_000)
    expect(page).to_have_url(re.compile("spectrum=singular"))
    assert opened.said == []


def test_a_turbine_begins_from_a_dropped_folder_and_each_guess_is_confirmed(
    opened: Open, tmp_path: Path
) -> None:
    """A deck and a record, dragged there as a folder; the first modes are seen."""
    (tmp_path / "jacket.yaml").write_bytes(find_file("jacket15", "structures").read_bytes())
    (tmp_path / "r7.parquet").write_bytes(record_file(7))
    (tmp_path / "r7.json").write_text(description(hour(7)))
    page = opened.page("/start")
    drop_folder(page, tmp_path)
    draft = page.get_by_role("button", name="Draft a twin")
    page.route("**/drafts", lambda route: route.abort())
    draft.click()
    expect(page.get_by_role("heading", name="No connection")).to_be_visible()
    page.unroute("**/drafts")
    draft.click()
    expect(page.locator(".picture canvas")).to_be_visible()
    guesses = page.get_by_role("checkbox", name=re.compile("^acc_top_"))
    expect(guesses).to_have_count(2)
    page.get_by_label("Name of the turbine").fill("begun")
    page.get_by_role("button", name="Add", exact=True).click()
    assert page.url.endswith("/start")  # nothing is added before each guess is confirmed
    for guess in guesses.all():
        guess.check()
    assert serious(page) == []
    page.get_by_role("button", name="Add", exact=True).click()
    page.wait_for_url("**/assets/begun/records")
    turn(opened.service)
    expect(page.get_by_role("region", name="Records", exact=True).locator("tbody tr")).to_contain_text(
        "observed"
    )
    page.get_by_role("link", name="Turbine", exact=True).click()
    expect(page.get_by_role("region", name="What it does now").locator("tbody tr")).to_have_count(2)
    httpx.delete(f"{opened.url}/api/v1/assets/begun?confirm=begun")


def drop_folder(page: Page, folder: Path) -> None:
    """Drag a folder from the desktop to where files are dropped."""
    box = page.locator(".drop").bounding_box()
    assert box
    data = {"items": [], "files": [str(folder)], "dragOperationsMask": 1}
    devtools = page.context.new_cdp_session(page)
    for kind in ("dragEnter", "dragOver", "drop"):
        at = {"x": box["x"] + 20.0, "y": box["y"] + 20.0}
        devtools.send("Input.dispatchDragEvent", {"type": kind, **at, "data": data})
