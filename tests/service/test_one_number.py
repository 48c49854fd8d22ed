"""One quantity, one central value and one interval: on page and terminal, in JSON, and of a living asset."""

from __future__ import annotations

import gzip
import html
import json
import re
from base64 import b64decode
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import timedelta
from math import pi
from pathlib import Path
from typing import Any

import pytest
from tests.service.conftest import NOON
from tests.support.observations import estimate, observation

from jackettwin.answers import answer
from jackettwin.cli.answers import answers_document, print_answers
from jackettwin.cli.console import output
from jackettwin.cli.update import print_updates
from jackettwin.files import encode
from jackettwin.service.workers import engine
from jackettwin.service.workers.question import Question
from jackettwin.service.workers.tasks import know
from jackettwin.study import run_document
from jackettwin.study.measure import Measured
from jackettwin.study.run import updated_twin
from jackettwin.twin import OBSERVATION

TWIN = """structure: jacket15
gravity: true
damping: {rayleigh: {ratio: 0.0055, frequency_hz: 0.183}}
update: {laws: [kelvin-voigt], particles: 20, starts: 2, damping_of: all}
"""
SHOWN = {1: estimate(0.1755, 0.012, 2e-3, 0.1), 2: estimate(0.1785, 0.013, 2e-3, 0.1)}
DAY = f"{NOON:%Y-%m-%d}"
Value = tuple[float, float, float]


@dataclass(frozen=True)
class Outlets:
    """What one set of records gave, by run and by a living asset."""

    document: dict[str, Any]
    terminal: str
    page: str
    figures: dict[str, Any]
    known: dict[str, Any]
    drawn: dict[str, Any]
    modes: list[dict[str, Any]]


@pytest.fixture(scope="module")
def outlets(tmp_path_factory: pytest.TempPathFactory) -> Outlets:
    folder: Path = tmp_path_factory.mktemp("twin")
    (folder / engine.TWIN_FILE).write_text(TWIN)
    twin = engine.load_twin(folder)
    made = [observation(SHOWN, NOON + timedelta(minutes=10 * k), name=f"r{k}") for k in range(3)]
    seen = [type(one)(**{**vars(one), "model_hash": twin.model.model_hash}) for one in made]
    texts = tuple(json.dumps(OBSERVATION.dump(one)) for one in seen)
    day = engine.advance_day(twin.model, DAY, None, texts).document
    asked = Question("wtg", 1, str(folder), {DAY: "a"}, {DAY: day}, texts, (3, 1800.0), of="it")
    outcome = know(asked)
    assert outcome is not None and outcome.document is not None and outcome.page is not None
    told = json.loads(outcome.document)
    sums, _ = engine.summed(twin, None, asked.identities, asked.days)
    measured = Measured(tuple(seen), sums.state, in_all=(3, 1800.0))
    result = updated_twin(twin.config, twin.model, measured, laws=("kelvin-voigt",), posteriors="likely")
    answers, shown = answer(result), replace(result, observations=())
    with output.capture() as printed:
        print_answers(answers)
        print_updates(result, only=answers.law)
    return Outlets(
        encode(run_document(shown, report=None) | answers_document(answers)),
        re.sub(r"\s+", " ", printed.get()),
        _text(gzip.decompress(outcome.page).decode()),
        _figures(gzip.decompress(outcome.page).decode()),
        told["known"],
        told["together"]["known"],
        engine.knowledge(twin.model, sums)["modes"],
    )


def _text(page: str) -> str:
    """Return what a page shows: its words, without scripts, styles and packed figures."""
    bare = re.sub(r"(?s)<(script|style)\b.*?</\1>|<[^>]+>", " ", page)
    return re.sub(r"\s+", " ", html.unescape(bare))


def _figures(page: str) -> dict[str, Any]:
    """Return the data of a page's figures by name, unpacked as its script does."""
    found = re.findall(r'<script type="text/plain" class="packed" id="data-(\w+)">([^<]+)</script>', page)
    texts = {name: gzip.decompress(b64decode(text)).decode() for name, text in found}
    return {name: json.loads(text) for name, text in texts.items() if text.startswith("{")}


def values(o: Outlets) -> Iterator[tuple[str, str, Value | float]]:
    """Yield every number as (quantity, outlet, value): with its interval, if the outlet gives one."""
    yield from of_parameters(o)
    for m in o.document["answers"]["modes"]:
        yield from of_mode(m)
    for outlet, modes in (("result.json, modes", o.document["modes"]), ("API", o.modes)):
        for m in modes:
            yield f"f of {m['label']}", outlet, m["frequency_hz"]
            yield f"ζ of {m['label']}", outlet, m["damping_ratio"]
    yield from of_update(o.document["updates"][0])
    for m in o.known["budget"]:
        yield f"ζ of {m['label']}", "API, budget", m["measured"]["value"]
        for source, span in m["sources"].items():
            yield f"{source} in {m['label']}", "API, budget", _span(span)


def of_parameters(o: Outlets) -> Iterator[tuple[str, str, Value | float]]:
    for name, p in o.document["updates"][0]["parameters"].items():
        yield name, "result.json, updates", (p["value"], *p["interval_90"])
        yield name, "result.json, updates, median", p["median"]
    for g in o.document["answers"]["ground"]:
        yield g["name"], "result.json, answers", _span(g["value"])
    for name, p in o.known["parameters"].items():
        yield name, "API", (p["median"], *p["interval_90"])
    yield from of_corner(o)


def of_corner(o: Outlets) -> Iterator[tuple[str, str, Value | float]]:
    """Yield what the figure of the posterior marks: medians in its cells, ends of intervals as lines."""
    figure = o.figures["correlation"]
    names = list(o.document["updates"][0]["parameters"])
    n = len(names)
    for trace in (t for t in figure["data"] if t.get("name") == "medians"):
        cell = int(trace["xaxis"].removeprefix("x") or 1) - 1
        for name, axis in ((names[cell % n], "x"), (names[cell // n], "y")):
            yield name, f"posterior, cell {cell}, {axis}", 10.0 ** trace[axis][0]
    lines = figure["layout"]["shapes"]
    for i, name in enumerate(names):
        number = i * (n + 1) + 1
        own = "x" if number == 1 else f"x{number}"
        ends = sorted(10.0 ** line["x0"] for line in lines if line["xref"] == own)
        yield name, "posterior, ends", (o.known["parameters"][name]["median"], *ends)


def of_mode(m: dict[str, Any]) -> Iterator[tuple[str, str, Value | float]]:
    yield f"f of {m['label']}", "result.json, answers", m["measured_hz"]["value"]
    yield f"ζ of {m['label']}", "result.json, answers", m["measured_damping"]["value"]
    yield f"model's f of {m['label']}", "result.json, answers", _span(m["model_hz"])
    yield f"model's ζ of {m['label']}", "result.json, answers", _span(m["model_damping"])
    for source, span in m["sources"].items():
        yield f"{source} in {m['label']}", "result.json, answers", _span(span)


def of_update(update: dict[str, Any]) -> Iterator[tuple[str, str, Value | float]]:
    labels = {m["mode"]: m["label"] for m in update["modes"]}
    for m in update["modes"]:
        yield f"f of {m['label']}", "result.json, updates", m["measured_frequency_hz"]
        yield f"ζ of {m['label']}", "result.json, updates", m["measured_damping_ratio"]
        yield f"model's f of {m['label']}", "result.json, updates", m["frequency_hz"]
        yield f"model's ζ of {m['label']}", "result.json, updates", m["damping_ratio"]
    for m in (m for m in update["predictions"] if m["mode"] in labels):
        for short, key in (("f", "frequency_hz"), ("ζ", "damping_ratio")):
            spread = (m[key]["median"], *m[key]["interval_90"])
            yield f"model's {short} of {labels[m['mode']]}", "result.json, predictions", spread


def _span(span: dict[str, Any]) -> Value | float:
    low, high = span.get("low"), span.get("high")
    return span["value"] if low is None or high is None else (span["value"], low, high)


def test_every_quantity_has_one_value_and_one_interval(outlets: Outlets) -> None:
    """To the last digits that sums in another order leave."""
    found: dict[str, dict[str, Value | float]] = defaultdict(dict)
    for quantity, outlet, value in values(outlets):
        found[quantity][outlet] = value
    assert {"k", "c", "f of side_side_1", "model's f of fore_aft_1", "soil in fore_aft_1"} <= set(found)
    for quantity, by_outlet in found.items():
        assert len(by_outlet) > 1, (quantity, by_outlet)
        centres = {outlet: v[0] if isinstance(v, tuple) else v for outlet, v in by_outlet.items()}
        first = next(iter(centres.values()))
        assert centres == pytest.approx(dict.fromkeys(centres, first), rel=1e-9), (quantity, by_outlet)
        spans = [v[1:] for v in by_outlet.values() if isinstance(v, tuple)]
        for span in spans:
            assert span == pytest.approx(spans[0], rel=1e-9), (quantity, by_outlet)


def test_a_parameter_reads_alike_on_terminal_page_and_api(outlets: Outlets) -> None:
    """One formatter: stiffness with its prefix and its interval, nowhere in powers of ten."""
    text = outlets.known["parameters"]["k"]["text"]
    assert re.fullmatch(r"[\d.]+ [MG]N/m \([\d.]+( [MG]N/m)? to [\d.]+ [MG]N/m\)", text)
    for place in (outlets.terminal, outlets.page):
        assert text in place
        assert not re.search(r"\d(e\+\d|\s*×\s*10[⁰-⁹])\d*\s*N", place)


def test_tables_and_drawings_of_the_page_say_what_the_document_says(outlets: Outlets) -> None:
    """The model's frequencies and damping ratios as the page's tables and drawings print them."""
    for m in outlets.document["updates"][0]["modes"]:
        assert (
            f"{m['frequency_hz']:.4f}" in outlets.page and f"{100 * m['damping_ratio']:.2f}" in outlets.page
        )
        assert f"{m['frequency_hz']:.3f} Hz" in outlets.page


def test_a_mode_is_explored_and_drawn_at_its_reported_frequency(outlets: Outlets) -> None:
    """At the medians each locus has it, and its poles have it everywhere; the structure moves with it."""
    reported = {m["label"]: m for m in outlets.document["updates"][0]["modes"]}
    for locus in outlets.drawn["explored"]["loci"]:
        measured = [b for b in locus["branches"] if b["label"] in reported]
        assert len(measured) == len(reported)
        for b in measured:
            at_medians = b["frequency_hz"][locus["origin"]]
            assert at_medians == pytest.approx(reported[b["label"]]["frequency_hz"], rel=1e-5)  # six digits
            omega = abs(complex(b["pole_real_rad_s"][0], b["pole_imag_rad_s"][0]))
            assert omega == pytest.approx(2.0 * pi * b["frequency_hz"][0], rel=1e-5)
    for drawn, m in zip(outlets.drawn["structure"]["motions"], reported.values(), strict=True):
        assert drawn["note"] == f"{m['frequency_hz']:.4f} Hz, ζ = {100 * m['damping_ratio']:.2f} %"


def test_shares_of_damping_are_of_what_was_measured(outlets: Outlets) -> None:
    told = {m["label"]: m for m in outlets.document["answers"]["modes"]}
    for row in outlets.document["updates"][0]["damping_budget"]:
        m = told[row["label"]]
        assert row["share_of"] == "measured"
        for source, span in m["sources"].items():
            part = row["share"][source] * m["measured_damping"]["value"]
            assert part == pytest.approx(span["value"], rel=1e-9)


def test_modes_are_named_and_counted_alike(outlets: Outlets) -> None:
    for m in outlets.modes:
        words = m["label"].replace("_", "-", m["label"].count("_") - 1).replace("_", " ")
        for place in (outlets.terminal, outlets.page):
            assert words in place and f"{m['frequency_hz']:.4f}" in place
        assert m["label"] not in outlets.terminal


def test_what_no_source_explains_is_said_drawn_and_told(outlets: Outlets) -> None:
    """Sources and what is beyond them make up the measured ratio."""
    beyond = [m for m in outlets.known["budget"] if m["unexplained"]]
    for m in beyond:
        parts = [span["value"] for span in m["sources"].values()]
        assert sum(parts) + m["unexplained"] == pytest.approx(m["measured"]["value"])
    told = {m["label"]: m["unexplained"] for m in outlets.document["answers"]["modes"]}
    assert told == pytest.approx({m["label"]: m["unexplained"] for m in outlets.known["budget"]})
    assert bool(re.search(r"unexplained [\d.]+ %", outlets.page)) == bool(beyond)
