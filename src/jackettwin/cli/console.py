"""What every command shares: exit codes, progress on stderr, JSON on stdout."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from jackettwin.errors import InputError, JackettwinError
from jackettwin.files import json_pieces

OUR_FAULT, BAD_INPUT, INTERRUPTED = 1, 2, 130

messages = Console(stderr=True, highlight=False)
"""Progress, warnings and errors."""
output = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 140)
"""Tables for people; a file or a pipe has no width of its own."""


class Commands(click.Group):
    """A group whose commands end with the exit codes of the contract."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; turn errors into one message and an exit code."""
        try:
            return super().invoke(ctx)
        except InputError as error:
            messages.print(f"[bold red]error:[/] {_plain(str(error))}", soft_wrap=True)
            ctx.exit(BAD_INPUT)
        except KeyboardInterrupt:
            messages.print("interrupted: nothing half-written is left behind")
            ctx.exit(INTERRUPTED)
        except OSError as error:
            what = f"{error.strerror or error}: {error.filename}" if error.filename else str(error)
            messages.print(
                f"[bold red]error:[/] {_plain(what)}; check the path and its rights", soft_wrap=True
            )
            ctx.exit(BAD_INPUT)
        except JackettwinError as error:
            messages.print(f"[bold red]failed:[/] {_plain(str(error))}", soft_wrap=True)
            ctx.exit(OUR_FAULT)
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except Exception as error:
            if ctx.params.get("traceback"):
                traceback.print_exc()
            messages.print(
                f"[bold red]internal error:[/] {_plain(f'{type(error).__name__}: {error}')}; "
                "this is a fault of jackettwin: run again with --traceback and report it",
                soft_wrap=True,
            )
            ctx.exit(OUR_FAULT)


def _plain(text: str) -> str:
    """Return text with rich's markup brackets escaped."""
    return text.replace("[", r"\[")


@dataclass(frozen=True)
class Step:
    """Announces the next step when called; ``within`` says how far the present one is."""

    announce: Callable[[str], None]
    within: Callable[[str], None]

    def __call__(self, what: str) -> None:
        """Announce the next step."""
        self.announce(what)


@contextmanager
def progress(total: int, title: str) -> Iterator[Step]:
    """Yield what announces the next of ``total`` steps; the bar is shown on stderr."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed}/{task.total}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=messages, disable=not messages.is_terminal) as bar:
        task = bar.add_task(title, total=total)
        started = False

        def announce(what: str) -> None:
            nonlocal started
            bar.update(task, description=what, advance=1 if started else 0)
            started = True

        yield Step(announce, lambda what: bar.update(task, description=what))
        bar.update(task, completed=total, description=title)


def print_json(document: object) -> None:
    """Print one JSON document on stdout: null for what is not known, never NaN."""
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
