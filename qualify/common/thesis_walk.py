"""The commands of the page on the thesis, given with an own structure instead of the shipped one."""

from __future__ import annotations

import io
import json
import re
import shlex
from collections.abc import Callable, Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import yaml

from common.thesis_case import ThesisCase
from jackettwin.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "verification" / "thesis.md"
STANDS_FOR = {
    "jacket15_records": "piles.yaml",
    "thesis_table_6_1": "twin.yaml",
    "parked": "parked.yaml",
    "dlc64": "set.yaml",
    "examples/refine_jacket15.yaml": "refine.yaml",
}
"""What is shipped, and the companion file of an own structure that takes its place."""


@dataclass(frozen=True)
class Row:
    """A row of the page."""

    number: int
    what: str
    state: str
    shown_by: str

    @property
    def codes(self) -> list[tuple[str, str]]:
        """Return the word before each code (``twin``, ``scenario``, ``structure`` or none) and the code."""
        return re.findall(r"(\w*) ?`([^`]+)`", self.shown_by)


@dataclass(frozen=True)
class Answer:
    """What a command said: its JSON, what a person reads, CPU seconds, and those of its longest silence."""

    argv: list[str]
    document: Any
    text: str
    heard: str
    cpu_s: float
    silent_s: float


def rows() -> list[Row]:
    """Return the 74 rows."""
    lines = re.findall(r"^\| (\d+) \|(.*)\|(.*)\|(.*)\|$", PAGE.read_text("utf-8"), re.MULTILINE)
    return [Row(int(number), *(cell.strip() for cell in cells)) for number, *cells in lines]


class _Ear(io.StringIO):
    """Text that remembers the longest processor time between two writings, of all of its kind."""

    last = longest = 0.0

    @classmethod
    def begin(cls) -> None:
        cls.last, cls.longest = process_time(), 0.0

    @classmethod
    def noted(cls) -> None:
        now = process_time()
        cls.longest, cls.last = max(cls.longest, now - cls.last), now

    def write(self, text: str) -> int:
        self.noted()
        return super().write(text)


def said(*argv: str, fails: bool = False) -> Answer:
    """Run a command in this process as the terminal and as JSON would show it."""
    out, err, start = _Ear(), _Ear(), process_time()
    _Ear.begin()
    code: object = 0
    with redirect_stdout(out), redirect_stderr(err):
        try:
            code = main.main(list(argv), prog_name="jackettwin", standalone_mode=False)
        except SystemExit as ended:
            code = ended.code
    _Ear.noted()
    text = out.getvalue()
    if code not in (None, 0) and not fails:
        raise AssertionError(f"jackettwin {shlex.join(argv)}: exit {code}: {err.getvalue()[-800:]}")
    document = json.loads(text) if "--json" in argv and code in (None, 0) else None
    return Answer(list(argv), document, text, err.getvalue(), process_time() - start, _Ear.longest)


def own_command(code: str, case: ThesisCase) -> list[str]:
    """Return the arguments of a command of the page with an own structure in place of the shipped one."""
    found: list[str] = []
    for text in shlex.split(code)[1:]:
        if text == "jacket15":
            piles = found[-1:] == ["--support"] or found == ["soil"]
            text = "piles.yaml" if piles else str(case.file)
        found.append(STANDS_FOR.get(text, text))
    return found


def merged(base: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """Return a document with more keys, those of ``update``, ``support`` and ``water`` beside its own."""
    beside = {key: {**base[key], **more[key]} for key in ("update", "support", "water") if key in more and
              isinstance(base.get(key), dict)}  # fmt: skip
    return {**base, **more, **beside}


def with_girders(case: ThesisCase, sections: dict[str, Any], twist_deg: float) -> dict[str, Any]:
    """Return the structure's file with two of its braces turned into girders."""
    document = yaml.safe_load(case.file.read_text("utf-8"))
    (name,) = sections
    if "jacket" in document:
        of = {"section": name, "twist_deg": twist_deg}
        document["sections"] = {**document.get("sections", {}), **sections}
        document["jacket"]["members"] = {"brace_1_1_*": of, "brace_2_1_*": of}
        return document
    if "foundation" in document:
        raise LookupError("sections of a deck are its own")
    document["sections"] |= sections
    braces = [m for m in document["members"] if m.get("section") == "brace"][:2]
    for member in braces:
        member |= {"section": name, "twist_deg": twist_deg}
    return document


Twins = dict[int, Callable[[ThesisCase, dict[str, Any]], dict[str, Any]]]
"""Rows whose keys have numbers of a structure, and the twin with those of this one."""


def commands(row: Row, case: ThesisCase, twins: Twins) -> Iterator[list[str]]:
    """Yield the commands of a row for an own structure; keys of a file are written into one first."""
    for k, (kind, code) in enumerate(row.codes):
        if code.startswith("jackettwin "):
            name = code.split()[1]
            if name not in ("serve", "verify"):
                yield own_command(code, case)
        elif kind == "twin":
            keys = yaml.safe_load(code)
            document = twins[row.number](case, keys) if row.number in twins else merged(case.twin, keys)
            file = case.write(f"twin_{row.number}_{k}.yaml", document)
            law = ["--law", "zener"] if row.number == 73 else []
            yield ["update", file.name, *law]
        elif kind == "scenario":
            document = merged(case.scenario, yaml.safe_load(code))
            if "flooded" in document["water"]:
                document["water"]["flooded"] = case.parts[:1]
            if "start" in document:
                document = {key: v for key, v in document.items() if key not in ("waves", "wind")}
                document["start"]["node"] = case.top
                document["time"] = {"duration_s": 90, "step_s": 0.05}
            file = case.write(f"scenario_{row.number}_{k}.yaml", document)
            name = "loads" if row.number == 7 else "simulate"
            out = [] if name == "loads" else ["--out", file.with_suffix(".parquet").name]
            yield [name, file.name, *out]


def first_commands(case: ThesisCase) -> list[list[str]]:
    """Return the commands whose files the others read."""
    return [
        ["simulate", "day.yaml", "--out", "day.parquet"],
        ["simulate", "pull.yaml", "--out", "pull.parquet"],
        ["modes", str(case.file), "--support", "pinned", "--shapes", "other.csv"],
    ]


def walked(row: Row, case: ThesisCase, twins: Twins, *, text: bool = False) -> list[Answer]:
    """Run all commands of a row in the case's folder; return their JSON.

    With ``text`` each runs first as a person gives it, and must print something.
    """
    answers = []
    with chdir(case.folder):
        for argv in commands(row, case, twins):
            if text:
                assert said(*argv).text.strip(), argv
            answers.append(said(*argv, "--json"))
    return answers


def prepared(file: Path, folder: Path) -> ThesisCase:
    """Return a structure's case with all companion files in a folder, made by commands where it can be."""
    case = ThesisCase(file.absolute(), folder)
    case.prepare()
    with chdir(folder):
        for argv in first_commands(case):
            said(*argv)
    f = float(case.on_feet[0][0])
    (folder / "picks.yaml").write_text(yaml.safe_dump({"picks": [{"order": 35, "frequency_hz": f}]}))
    return case


def relative(found: Any, wanted: Any) -> float:
    """Return the largest relative difference of two lists of numbers."""
    a, b = np.asarray(found, dtype=float), np.asarray(wanted, dtype=float)
    return float(np.abs(a / b - 1.0).max())
