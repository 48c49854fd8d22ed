"""``jackettwin compare``: differences between two runs."""

from __future__ import annotations

import json
from math import expm1
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jackettwin.cli.console import Reply, answers, say, show_table
from jackettwin.errors import InputError
from jackettwin.report import Table, TableColumn, quantity, words

if TYPE_CHECKING:
    from jackettwin.answers import ChangedInput, ChangedNumber


@click.command("compare")
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@answers
def compare_command(a: Path, b: Path) -> Reply:
    """Compare run B with run A, relative to their uncertainty.

    A and B are folders that `jackettwin run` wrote, or their result.json.
    """
    from jackettwin.answers import changed_inputs
    from jackettwin.answers.compare import compare

    before, after = _result(a), _result(b)
    changes, inputs = compare(before, after), changed_inputs(before, after)
    document = {
        "changes": [
            {
                **{key: getattr(c, key) for key in ("what", "unit", "before", "after")},
                "relative_change": None if c.log_change is None else expm1(c.log_change),
                "sigmas": c.sigmas,
                "verdict": c.verdict,
            }
            for c in changes
        ],
        "inputs": [{"what": i.what, "before": i.before, "after": i.after} for i in inputs],
        "headline": {"before": before.get("headline"), "after": after.get("headline")},
    }

    def show() -> None:
        for line in _input_lines(inputs):
            say(line)
        say(_summary(changes))
        for name, run in ((a, before), (b, after)):
            if not ((run.get("answers") or {}).get("fit") or {}).get("fits", True):
                say(f"Beware, {name}: {run['headline'][0]}")
        show_table(Table("", _COLUMNS, changes))

    return Reply(document, show)


def _input_lines(inputs: tuple[ChangedInput, ...]) -> list[str]:
    """Return a line for each differing input; equal differences in several places are counted in one."""
    groups: dict[tuple[str, str, object, object], list[ChangedInput]] = {}
    for i in inputs:
        parts = i.what.split(".")
        place = ".".join(parts[:2]) if len(parts) > 3 else i.what
        groups.setdefault((place, parts[-1], i.before, i.after), []).append(i)
    lines = []
    for same in groups.values():
        first, more = same[0], len(same) - 1
        places = f" (and {more} more alike)" if more else ""
        values = ["none" if v is None or v == "" else v for v in (first.before, first.after)]
        lines.append(f"Other input: {first.what}: {values[0]} → {values[1]}{places}")
    return lines


def _summary(changes: tuple[ChangedNumber, ...]) -> str:
    """Return a sentence on the changes, the largest first."""
    changed = sorted((c for c in changes if c.verdict == "changed"), key=lambda c: -abs(c.sigmas or 0.0))
    if not changed:
        return "Nothing changed by more than two standard deviations of the difference."
    texts = [f"{_words(c.what)} by {_percent(c.log_change or 0.0)} % ({c.sigmas:+.1f} σ)" for c in changed]
    return f"Changed: {', '.join(texts)}."


def _words(what: str) -> str:
    """Return the name of a quantity, its mode or parameter in words."""
    from jackettwin.soil import parameter_words

    kind, of, label = what.rpartition(" of ")
    if of:
        return f"{kind} of {words(label)}"
    name, _, law = what.partition(" (")
    return f"{parameter_words(name)} ({law}" if law else what


def _value(value: float | None, unit: str) -> str | None:
    return None if value is None else quantity(value, unit, digits=4)


def _percent(log_change: float) -> str:
    """Return a change in per cent with its sign, with two significant digits and without exponent."""
    return f"{float(f'{100.0 * expm1(log_change):.2g}'):+g}"


def _result(path: Path) -> dict[str, Any]:
    file = path / "result.json" if path.is_dir() else path
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError("no such run", file=file, remedy="a folder that `jackettwin run` wrote") from None
    except (json.JSONDecodeError, UnicodeDecodeError):
        document = None
    if not isinstance(document, dict) or "updates" not in document:
        raise InputError("not the result of a run", file=file, remedy="result.json of `jackettwin run`")
    return document


_COLUMNS = (
    TableColumn("what", lambda c: _words(c.what)),
    TableColumn("before", lambda c: _value(c.before, c.unit)),
    TableColumn("after", lambda c: _value(c.after, c.unit)),
    TableColumn("change [%]", lambda c: None if c.log_change is None else _percent(c.log_change)),
    TableColumn("over its σ", lambda c: c.sigmas, "+.1f"),
    TableColumn("verdict", lambda c: c.verdict),
)
