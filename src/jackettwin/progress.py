"""Progress and cancellation of long work: one protocol, down to inner loops.

Whoever runs a job hands it a :class:`Progress`. The job calls it often; the caller may show what it is told,
or raise from the call, which ends the job where it stands: nothing below the edge asks a clock, a terminal or
a queue.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from jackettwin.errors import JackettwinError


class Cancelled(JackettwinError):
    """The work is no longer wanted; raised by a :class:`Progress` through whatever is running."""


class Progress(Protocol):
    """Is told of every step, and within a step of how far it is."""

    def __call__(self, what: str) -> None:
        """Begin the next step; may raise to end the work."""
        ...

    def within(self, what: str) -> None:
        """Say how far the present step is; may raise to end the work."""
        ...


@dataclass(frozen=True)
class CallbackProgress:
    """A progress that calls functions.

    Attributes
    ----------
    step, inside : callable
        Take the words of a step, and of how far it is.
    """

    step: Callable[[str], None] = lambda _: None
    inside: Callable[[str], None] = lambda _: None

    def __call__(self, what: str) -> None:
        """Begin the next step."""
        self.step(what)

    def within(self, what: str) -> None:
        """Say how far the present step is."""
        self.inside(what)

    def about(self, subject: str) -> CallbackProgress:
        """Return a progress whose steps are within the present one, each with its subject before it."""
        return CallbackProgress(
            lambda what: self.inside(f"{subject}: {what}"), lambda what: self.inside(f"{subject}: {what}")
        )


SILENT = CallbackProgress()
"""Tells nobody and never ends the work."""
