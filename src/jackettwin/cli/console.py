"""Common parts of all commands: exit codes, progress on stderr, JSON on stdout."""

from __future__ import annotations

import logging
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from itertools import count
from math import isfinite
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from typing import TYPE_CHECKING, Any, ParamSpec

import click
from rich.console import Console

from jackettwin.cli.interrupts import insisting
from jackettwin.cli.plain_progress import EVERY_S, plain_progress
from jackettwin.errors import InputError, JackettwinError
from jackettwin.progress import CallbackProgress

if TYPE_CHECKING:
    from jackettwin.report import Table

P = ParamSpec("P")

OUR_FAULT, BAD_INPUT, INTERRUPTED = 1, 2, 130

_PATIENCE_S = 0.3
"""Time after which a command that is still being imported reports it; NumPy and SciPy take a second or
two."""
messages = Console(stderr=True, highlight=False)
"""Progress, warnings and errors."""
output = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 140)
"""Console for tables; a file or a pipe has a fixed width."""
_reporting = Event()
"""Set while a step of a command reports itself."""


@contextmanager
def _reading_said(command: str, summary: str) -> Iterator[None]:
    """Report that a command is being imported, if this takes long, and once more later."""
    done = Event()
    first = f"{command}: {summary.rstrip('.')} (loading the program)"

    def say() -> None:
        for wait_s, words in ((_PATIENCE_S, first), (EVERY_S, "still loading the program")):
            if done.wait(wait_s):
                return
            messages.print(words, soft_wrap=True, markup=False)

    Thread(target=say, daemon=True).start()
    try:
        yield
    finally:
        done.set()


@contextmanager
def _lasting_said(command: str) -> Iterator[None]:
    """Report that a command continues, wherever no step of it reports this itself."""
    done, started = Event(), monotonic()

    def say() -> None:
        while not done.wait(EVERY_S):
            if not _reporting.is_set():
                line = f"{command}: computing, {monotonic() - started:.0f} s"
                messages.print(line, soft_wrap=True, markup=False)

    thread = Thread(target=say, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


class CommandGroup(click.Group):
    """A group whose help shows the whole first sentence of every command."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the help text of every command."""
        found = [(name, self.get_command(ctx, name)) for name in self.list_commands(ctx)]
        with formatter.section("Commands"):
            formatter.write_dl([(name, one.get_short_help_str(1000)) for name, one in found if one])


class Commands(click.Group):
    """A group whose commands return the documented exit codes and are imported when called.

    Parameters
    ----------
    groups : {heading: {name: sentence}}
        Help text of every command; ``a-b`` is ``a_b_command`` in ``jackettwin.cli.a_b``.
    """

    def __init__(self, *args: Any, groups: Mapping[str, Mapping[str, str]], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.groups = groups
        self.summaries = {name: text for group in groups.values() for name, text in group.items()}

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Remember whether JSON is asked for, also of a command whose own words cannot be read."""
        ctx.meta[_JSON] = "--json" in args
        try:
            return super().parse_args(ctx, args)
        except click.ClickException as error:  # of the words before a command: nothing is invoked
            _document_failure("error", error.format_message(), ctx)
            raise

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return list(self.summaries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command; None if it does not exist."""
        if cmd_name not in self.summaries:
            return None
        name = cmd_name.replace("-", "_")
        with _reading_said(cmd_name, self.summaries[cmd_name]):
            command: click.Command = getattr(import_module(f"jackettwin.cli.{name}"), f"{name}_command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the help text of every command by group."""
        longest = max(map(len, self.summaries))
        for heading, group in self.groups.items():
            with formatter.section(heading):
                formatter.write_dl([(name.ljust(longest), text) for name, text in group.items()])

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; turn errors into one message and an exit code."""
        _hear()
        try:
            with insisting():
                return super().invoke(ctx)
        except InputError as error:
            _failed("error", str(error), ctx, error)
            ctx.exit(BAD_INPUT)
        except KeyboardInterrupt:
            messages.print("interrupted: no incomplete file was left")
            ctx.exit(INTERRUPTED)
        except OSError as error:
            what = f"{error.strerror or error}: {error.filename}" if error.filename else str(error)
            _failed("error", f"{what}; check the path and its rights", ctx)
            ctx.exit(BAD_INPUT)
        except JackettwinError as error:
            _failed("failed", str(error), ctx)
            ctx.exit(OUR_FAULT)
        except click.Abort:
            messages.print("stopped: nothing was changed")
            ctx.exit(INTERRUPTED)
        except click.exceptions.Exit:
            raise
        except click.ClickException as error:  # click prints its message itself
            _document_failure("error", error.format_message(), ctx)
            raise
        except Exception as error:
            if ctx.params.get("traceback"):
                traceback.print_exc()
            fault = "this is a fault in jackettwin: run again with --traceback and report it"
            _failed("internal error", f"{type(error).__name__}: {error}; {fault}", ctx)
            ctx.exit(OUR_FAULT)


_JSON = "jackettwin.json"
"""Whether a command was asked for JSON, among what click remembers of a call."""


def _failed(kind: str, what: str, ctx: click.Context, error: InputError | None = None) -> None:
    """Print a message, and where JSON was asked for a document of it with the parts of bad input."""
    messages.print(f"[bold red]{kind}:[/] {plain(what)}", soft_wrap=True)
    _document_failure(kind, what, ctx, error)


def _document_failure(kind: str, what: str, ctx: click.Context, error: InputError | None = None) -> None:
    if ctx.meta.get(_JSON):
        parts = ("problem", "file", "field", "value", "allowed", "remedy")
        found = {"problem": what} if error is None else {name: getattr(error, name) for name in parts}
        said = {name: None if (part := found.get(name)) is None else str(part) for name in parts}
        print_json({"error": {"kind": kind, "message": what, **said}})


class PageFile(click.Path):
    """Path of an HTML page in an existing folder, so that a typing error creates no folder."""

    name = "file.html"

    def __init__(self) -> None:
        super().__init__(dir_okay=False, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; raise an error unless it ends in .html and its folder exists."""
        path = Path(value)
        if path.suffix.lower() not in (".html", ".htm"):
            self.fail(f"{path.name!r} is not the name of a page, which ends in .html.", param, ctx)
        if not path.absolute().parent.is_dir():
            self.fail(f"there is no folder {str(path.parent)!r}: make it first.", param, ctx)
        return super().convert(value, param, ctx)


class FiniteFloat(click.FloatRange):
    """A finite number: click's own range accepts "nan", and "inf" where it is open."""

    name = "number"

    def _describe_range(self) -> str:
        """Return the range for the help text; click writes a missing one as ``x<=None``."""
        return "" if self.min is None and self.max is None else super()._describe_range()

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number; raise an error if it is not finite."""
        found = float(super().convert(value, param, ctx))
        if not isfinite(found):
            self.fail(f"{found} is not a finite number.", param, ctx)
        return found


class _Messages(logging.Handler):
    """Handler that prints log messages of the package, equal ones once."""

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
    """Print log messages of the computation; a server configures its own log."""
    for package in ("decks", "response", "structure", "study", "twin"):
        log = logging.getLogger(f"jackettwin.{package}")
        log.handlers = [handler for handler in log.handlers if not isinstance(handler, _Messages)]
        log.addHandler(_Messages())
        log.setLevel(logging.INFO)


def plain(text: str) -> str:
    """Return text with rich's markup brackets escaped."""
    return text.replace("[", r"\[")


@contextmanager
def progress(total: int, title: str) -> Iterator[CallbackProgress]:
    """Yield the function that reports the next of ``total`` steps, by a bar on a terminal, else by lines."""
    _reporting.set()
    try:
        with _steps(total, title) as told:
            yield told
    finally:
        _reporting.clear()


@contextmanager
def _steps(total: int, title: str) -> Iterator[CallbackProgress]:
    if not messages.is_terminal:
        with plain_progress(total, lambda line: messages.print(line, soft_wrap=True, markup=False)) as told:
            yield told
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=messages) as bar:
        task = bar.add_task(title, total=total)
        steps = count()
        yield CallbackProgress(
            lambda what: bar.update(task, description=what, completed=next(steps)),
            lambda what: bar.update(task, description=what),
        )
        bar.update(task, completed=total, description=title)


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show a message while the block runs."""
    with progress(1, what) as step:
        step(what)
        yield


def print_json(document: object) -> None:
    """Print one JSON document on stdout: null for unknown values, never NaN."""
    from jackettwin.files import json_pieces

    if (ctx := click.get_current_context(silent=True)) is not None:
        ctx.meta.pop(_JSON, None)  # a refusal after it would be a second document
    sys.stdout.writelines(json_pieces(document))


@dataclass(frozen=True)
class Reply:
    """Result of a command.

    Attributes
    ----------
    document : mapping
        For programs.
    show : function
        Prints it for people.
    exit_code : int
        Of the process.
    """

    document: object
    show: Callable[[], object]
    exit_code: int = 0


def with_omissions(document: object, command: str) -> object:
    """Return a document with what the command always leaves out, unless it says so itself."""
    from jackettwin.cli.omissions import ALWAYS, omitted_by

    if not isinstance(document, Mapping) or command not in ALWAYS:
        return document
    return {**document, "left_out": document.get("left_out", omitted_by(command))}


json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")


def answers(function: Callable[P, Reply]) -> Callable[P, None]:
    """Make a command print its result as text, or with ``--json`` as JSON."""

    @wraps(function)
    def command(*args: P.args, **kwargs: P.kwargs) -> None:
        as_json = kwargs.pop("as_json")
        with _lasting_said(click.get_current_context().info_name or "jackettwin"):
            answer = function(*args, **kwargs)
        if as_json:
            print_json(with_omissions(answer.document, click.get_current_context().info_name or ""))
        else:
            answer.show()
        if answer.exit_code:
            click.get_current_context().exit(answer.exit_code)

    return json_option(command)


def say(line: str) -> None:
    """Print a line of text unchanged."""
    output.print(line, markup=False)


def say_all(lines: Iterable[str], kind: str = "") -> None:
    """Print lines, prefixed with their kind (``warning``) if given."""
    for line in lines:
        say(f"{kind}: {line}" if kind else line)


def show_table(table: Table) -> None:
    """Print a table."""
    from rich.table import Table as Drawn
    from rich.text import Text

    heads = (Text(head.replace("\n", " ")) for head in table.heads)
    drawn = Drawn(title=Text(table.caption) if table.caption else None, title_justify="left")
    for head in heads:
        drawn.add_column(head)
    for i, row in enumerate(table.cells):
        drawn.add_row(*map(Text, row), style="bold red" if i in table.marked else None)
    output.print(drawn)


def numbers_of(
    text: str, option: str, form: str, counts: tuple[int, ...], *, given: str | None = None
) -> tuple[float, ...]:
    """Return the comma-separated numbers of an option.

    Parameters
    ----------
    form : as the help text writes them, e.g. ``X,Y,Z``
    counts : allowed numbers of values
    given : the user's text, if the numbers are only a part of it

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
