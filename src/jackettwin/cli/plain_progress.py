"""Progress as plain lines where there is no terminal, for which Rich prints no progress bar."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from jackettwin.progress import CallbackProgress

EVERY_S = 1.4
"""Least time between two lines, so that a thousand records do not print a thousand lines; with delays on a
busy machine there is still a line every two seconds."""


class PlainProgress:
    """Reports the running step, at most every ``EVERY_S``, and repeats it while it lasts.

    Parameters
    ----------
    total : int
        Number of steps.
    say : callable
        Function that prints a line.
    """

    def __init__(self, total: int, say: Callable[[str], None]) -> None:
        self._total, self._say = total, say
        self._lock = threading.Lock()
        self._step, self._what = 0, ""
        self._started = self._said = -float("inf")

    def announce(self, what: str) -> None:
        """Begin the next step."""
        with self._lock:
            self._step, self._started = self._step + 1, time.monotonic()
        self.within(what)

    def within(self, what: str) -> None:
        """Report the progress within the present step."""
        self._what = what
        self.remind()

    def remind(self) -> None:
        """Report that the present step continues, if there was no line for a while."""
        with self._lock:
            now = time.monotonic()
            if not self._what or now - self._said < EVERY_S:
                return
            self._said, lasts = now, now - self._started
            going = f", {lasts:.0f} s" if lasts >= 1.0 else ""
            self._say(f"{min(self._step, self._total)}/{self._total} {self._what}{going}")


@contextmanager
def plain_progress(total: int, say: Callable[[str], None]) -> Iterator[CallbackProgress]:
    """Yield a progress reporter that prints lines, with a thread that repeats them in long steps."""
    progress, done = PlainProgress(total, say), threading.Event()

    def remind() -> None:
        while not done.wait(0.05 * EVERY_S):
            progress.remind()

    thread = threading.Thread(target=remind, daemon=True)
    thread.start()
    try:
        yield CallbackProgress(progress.announce, progress.within)
    finally:
        done.set()
        thread.join()
