"""What every command shares: exit codes, progress on stderr, JSON on stdout."""

from __future__ import annotations

import logging
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from math import isfinite
from pathlib import Path
from threading import Event, Thread
from typing import Any

import click
from rich.console import Console

from jackettwin.cli.interrupts import insisting
from jackettwin.cli.plain_progress import EVERY_S, plain_progress
from jackettwin.errors import InputError, JackettwinError

OUR_FAULT, BAD_INPUT, INTERRUPTED = 1, 2, 130

_PATIENCE_S = 0.3
"""Time after which a command that is still being read says so: NumPy and SciPy take a second or two."""
messages = Console(stderr=True, highlight=False)
"""Progress, warnings and errors."""
output = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 140)
"""Tables for people; a file or a pipe has no width of its own."""


@contextmanager
def _reading_said(command: str, summary: str) -> Iterator[None]:
    """Say what a command does while it is still being read, as often as any progress is told."""
    done = Event()

    def say() -> None:
        waits, words = _PATIENCE_S, f"{command}: {summary.rstrip('.')} (reading the program)"
        while not done.wait(waits):
            messages.print(words, soft_wrap=True, markup=False)
            waits, words = EVERY_S, "still reading the program"

    thread = Thread(target=say, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()


class Commands(click.Group):
    """A group whose commands end with the exit codes of the contract, each read when it is called.

    Parameters
    ----------
    summaries : {name: sentence}
        Of every command; ``a-b`` is ``a_b_command`` in ``jackettwin.cli.a_b``.
    """

    def __init__(self, *args: Any, summaries: Mapping[str, str], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.summaries = summaries

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return sorted(self.summaries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Read a command; None if there is no such one."""
        if cmd_name not in self.summaries:
            return None
        name = cmd_name.replace("-", "_")
        with _reading_said(cmd_name, self.summaries[cmd_name].split(": ")[0]):
            command: click.Command = getattr(import_module(f"jackettwin.cli.{name}"), f"{name}_command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write what every command does, in a line each."""
        width = formatter.width - 6 - max(map(len, self.summaries))
        rows = []
        for name in self.list_commands(ctx):
            summary = click.Command(name, help=self.summaries[name])
            rows.append((name, summary.get_short_help_str(width)))
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; turn errors into one message and an exit code."""
        _hear()
        try:
            with insisting():
                return super().invoke(ctx)
        except InputError as error:
            messages.print(f"[bold red]error:[/] {plain(str(error))}", soft_wrap=True)
            ctx.exit(BAD_INPUT)
        except KeyboardInterrupt:
            messages.print("interrupted: nothing half-written is left behind")
            ctx.exit(INTERRUPTED)
        except OSError as error:
            what = f"{error.strerror or error}: {error.filename}" if error.filename else str(error)
            messages.print(
                f"[bold red]error:[/] {plain(what)}; check the path and its rights", soft_wrap=True
            )
            ctx.exit(BAD_INPUT)
        except JackettwinError as error:
            messages.print(f"[bold red]failed:[/] {plain(str(error))}", soft_wrap=True)
            ctx.exit(OUR_FAULT)
        except click.Abort:
            messages.print("stopped: nothing was changed")
            ctx.exit(INTERRUPTED)
        except (click.ClickException, click.exceptions.Exit):
            raise
        except Exception as error:
            if ctx.params.get("traceback"):
                traceback.print_exc()
            messages.print(
                f"[bold red]internal error:[/] {plain(f'{type(error).__name__}: {error}')}; "
                "this is a fault of jackettwin: run again with --traceback and report it",
                soft_wrap=True,
            )
            ctx.exit(OUR_FAULT)


class PageFile(click.Path):
    """The file of an option that a page is written to."""

    name = "file.html"

    def __init__(self) -> None:
        super().__init__(dir_okay=False, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; refuse one that no browser takes for a page."""
        path = Path(value)
        if path.suffix.lower() not in (".html", ".htm"):
            self.fail(f"{path.name!r} is no name of a page: it ends in .html.", param, ctx)
        return super().convert(value, param, ctx)


class FiniteFloat(click.FloatRange):
    """A number of an option: click's own range lets "nan" through, and "inf" where it is open."""

    name = "number"

    def _describe_range(self) -> str:
        """Return the range for the help, which click writes as ``x<=None`` where there is none."""
        return "" if self.min is None and self.max is None else super()._describe_range()

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number; refuse what is not finite."""
        found = float(super().convert(value, param, ctx))
        if not isfinite(found):
            self.fail(f"{found} is not a finite number.", param, ctx)
        return found


class _Messages(logging.Handler):
    """Prints what the package logs among the messages, the same line once."""

    def __init__(self) -> None:
        super().__init__()
        self.said: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Print one line."""
        line = record.getMessage()
        if line not in self.said:
            messages.print(line, soft_wrap=True, markup=False)
        self.said.add(line)


def _hear() -> None:
    """Print what the computing part logs; a server says for itself where its log goes."""
    for package in ("decks", "response", "structure", "study", "twin"):
        log = logging.getLogger(f"jackettwin.{package}")
        log.handlers = [handler for handler in log.handlers if not isinstance(handler, _Messages)]
        log.addHandler(_Messages())
        log.setLevel(logging.INFO)


def plain(text: str) -> str:
    """Return text with rich's markup brackets escaped."""
    return text.replace("[", r"\[")


@dataclass(frozen=True)
class ConsoleStep:
    """Announces the next step when called; ``within`` says how far the present one is."""

    announce: Callable[[str], None]
    within: Callable[[str], None]

    def __call__(self, what: str) -> None:
        """Announce the next step."""
        self.announce(what)


@contextmanager
def progress(total: int, title: str) -> Iterator[ConsoleStep]:
    """Yield what announces the next of ``total`` steps: a bar on a terminal, else plain lines, on stderr."""
    if not messages.is_terminal:
        with plain_progress(total, lambda line: messages.print(line, soft_wrap=True, markup=False)) as say:
            yield ConsoleStep(say.announce, say.within)
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed}/{task.total}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=messages) as bar:
        task = bar.add_task(title, total=total)
        started = False

        def announce(what: str) -> None:
            nonlocal started
            bar.update(task, description=what, advance=1 if started else 0)
            started = True

        yield ConsoleStep(announce, lambda what: bar.update(task, description=what))
        bar.update(task, completed=total, description=title)


@contextmanager
def working(what: str) -> Iterator[None]:
    """Say what is being done for as long as the block takes."""
    with progress(1, what) as step:
        step(what)
        yield


def print_json(document: object) -> None:
    """Print one JSON document on stdout: null for what is not known, never NaN."""
    from jackettwin.files import json_pieces

    sys.stdout.writelines(json_pieces(document))


def number(value: float | None, digits: int = 4) -> str:
    """Return a number for a table, a dash if it is not known."""
    return "–" if value is None or value != value else f"{value:.{digits}g}"


def fixed(value: float, decimals: int) -> str:
    """Return a number with so many decimals; what rounds to zero has no sign.

    >>> fixed(-1e-9, 2)
    '0.00'
    """
    return f"{round(value, decimals) + 0.0:,.{decimals}f}"


def numbers_of(
    text: str, option: str, form: str, counts: tuple[int, ...], *, given: str | None = None
) -> tuple[float, ...]:
    """Return the numbers of an option that takes some, joined by commas.

    Parameters
    ----------
    form : as the help text writes them, e.g. ``X,Y,Z``
    counts : how many there may be
    given : what the user wrote, if the numbers are only a part of it

    Raises
    ------
    InputError
        If they are not finite numbers, or too few or too many.
    """
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) not in counts or not all(map(isfinite, values)):
        allowed = f"{' or '.join(map(str, counts))} numbers joined by commas"
        raise InputError(f"not {form}", field=option, value=given or text, allowed=allowed)
    return values
