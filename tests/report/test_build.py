from __future__ import annotations

import gzip
import json
import re
from base64 import b64decode
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from jackettwin.report import Plot, build_report
from jackettwin.report.build import report_sections
from jackettwin.report.tables.numbers import frequency, percent
from jackettwin.report.tables.records import records_table
from jackettwin.study import TwinResult


class _Page(HTMLParser):
    """Collects addresses, visible text and what is packed in the page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.text: list[str] = []
        self.figures: list[str] = []
        self.names: list[str] = []
        self.ids: list[str] = []
        self.scripts = 0
        self.buttons = 0
        self._inside = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.buttons += tag == "button"
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href")]
        self.ids += [value or "" for name, value in attrs if name == "id"]
        self._inside = tag
        if tag == "script":
            self.scripts += 1
            if ("type", "text/plain") in attrs:
                self._inside = "json"
                self.figures.append("")
                self.names.append(dict(attrs)["id"] or "")

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside == "json":
            self.figures[-1] += data
        elif self._inside not in ("script", "style"):
            self.text.append(data)


def unpacked(text: str) -> str:
    return gzip.decompress(b64decode(text)).decode()


@pytest.fixture(scope="module")
def report(complete: TwinResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_report(complete, tmp_path_factory.mktemp("report"))


def test_report_is_one_small_file_that_needs_no_network(report: Path) -> None:
    html = report.read_text(encoding="utf-8")
    page = _Page(html)
    assert all(address.startswith("#") for address in page.addresses)
    assert page.names.count("plotly") == 1  # the library, once
    assert "plotly.js v" in unpacked(page.figures[page.names.index("plotly")])[:500]
    assert "@import" not in html.split("</style>")[0]
    assert len(set(page.ids)) == len(page.ids)  # a button of one part opens that part
    assert report.stat().st_size < 2.6e6


def test_every_figure_is_valid_json_and_a_file_of_its_own(report: Path, complete: TwinResult) -> None:
    page = _Page(report.read_text(encoding="utf-8"))
    plots = [b for s in report_sections(complete) for b in s.blocks if isinstance(b, Plot)]
    packed = dict(zip(page.names, page.figures, strict=True))
    assert len({plot.name for plot in plots}) == len(plots)
    for plot in plots:
        assert json.loads(unpacked(packed[f"data-{plot.name}"]))["data"]
        assert plot.caption.count("?") >= 1, plot.name  # a figure answers a question
    assert unpacked(packed["data-structure"]).startswith("<!DOCTYPE html>")
    files = {path.name for path in (report.parent / "figures").iterdir()}
    drawings = {name for name in files if name.endswith(".svg")}
    assert files - drawings == {f"{plot.name}.html" for plot in plots} | {"plotly.min.js"}
    assert {"damping.svg", "ground.svg", "mode_shapes_1.svg"} <= drawings
    one = _Page((report.parent / "figures" / f"{plots[0].name}.html").read_text(encoding="utf-8"))
    assert one.addresses == ["plotly.min.js"]


def test_nothing_temporary_is_left(report: Path) -> None:
    names = [path.name for path in report.parent.rglob("*") if path.is_file()]
    assert not [name for name in names if name.startswith(".") or name.endswith(".tmp")]


def test_page_shows_the_numbers_of_the_result(report: Path, complete: TwinResult) -> None:
    text = " ".join(_Page(report.read_text(encoding="utf-8")).text)
    update = complete.updates[0]
    for m, f, zeta in zip(
        complete.measured, update.modes.frequency_hz, update.modes.damping_ratio, strict=True
    ):
        assert frequency(m.frequency_hz) in text
        assert percent(m.damping_ratio) in text
        assert frequency(float(f)) in text
        assert percent(float(zeta)) in text
    for undamped in update.modes.undamped_hz:
        assert frequency(float(undamped)) in text


def test_the_verdict_comes_first_and_the_appendix_last(complete: TwinResult) -> None:
    sections = report_sections(complete)
    assert sections[0].title == "Verdict" and not sections[0].appendix
    first = [section.appendix for section in sections]
    assert first == sorted(first) and sections[-1].title == "Provenance"


def test_what_made_the_report_is_on_it(complete: TwinResult, tmp_path: Path) -> None:
    made = (
        ("made", "2026-01-02 03:04 UTC"),
        ("command", "jackettwin run x.yaml"),
        ("SHA-256 of x.yaml", "ab12"),
    )
    text = " ".join(_Page(build_report(complete, tmp_path, provenance=made).read_text()).text)
    assert all(value in text for _, value in made)


def test_names_are_escaped(report: Path) -> None:
    html = report.read_text(encoding="utf-8")
    assert "<script>alert" not in html
    assert "noise &lt;&amp;&gt; modes" in html


def test_the_report_says_which_mode_is_which_in_every_record(complete: TwinResult) -> None:
    table = records_table(complete)
    assert table.columns == ("mode", *complete.identifications[0].records)
    for row, name, mode in zip(
        table.rows, complete.names[0], complete.identifications[0].modes, strict=False
    ):
        assert row[0] == name.replace("_1", " 1").replace("side_side", "side-side").replace(
            "fore_aft", "fore-aft"
        )
        assert row[1].startswith(f"{mode.frequency_hz:.4f}")


def test_targets_alone_make_a_report(targets_only: TwinResult, tmp_path: Path) -> None:
    page = _Page(build_report(targets_only, tmp_path).read_text(encoding="utf-8"))
    titles = [section.title for section in report_sections(targets_only)]
    assert "Records" not in titles and "Identification" not in titles
    assert "Solutions" in titles
    assert any("given as targets" in text for text in page.text)


def test_a_mode_that_was_lost_shows_as_not_known(complete: TwinResult, tmp_path: Path) -> None:
    update = complete.updates[0]
    poles, undamped = update.modes.poles.copy(), update.modes.undamped_hz.copy()
    shapes = update.modes.shapes.copy()
    poles[1], undamped[1], shapes[:, 1] = np.nan, np.nan, np.nan
    modes = replace(update.modes, poles=poles, undamped_hz=undamped, shapes=shapes)
    result = replace(complete, updates=(replace(update, fit=replace(update.fit, modes=modes)),))
    page = _Page(build_report(result, tmp_path).read_text(encoding="utf-8"))
    assert not re.search(r"\bnan\b", " ".join(page.text), flags=re.IGNORECASE)
    for name, text in zip(page.names, page.figures, strict=True):
        assert name == "plotly" or "NaN" not in unpacked(text)
