"""Reliable Ctrl-C, also in code that discards the exception, such as a compiler's callbacks."""

from __future__ import annotations

import signal
from _thread import interrupt_main
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread, current_thread, main_thread
from types import FrameType

_AGAIN_S = 1.0
"""Time after which a discarded interrupt is raised again; cleaning up takes less."""


@contextmanager
def insisting() -> Iterator[None]:
    """Raise ``KeyboardInterrupt`` in the block again each second after a Ctrl-C, until the block is left.

    A handler of SIGINT other than Python's own is not replaced.
    """
    ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not ours or current_thread() is not main_thread():
        yield
        return
    left, asked = Event(), Event()

    def insist() -> None:
        while not left.wait(_AGAIN_S):
            interrupt_main()

    def interrupted(number: int, frame: FrameType | None) -> None:
        if not asked.is_set():
            asked.set()
            Thread(target=insist, daemon=True).start()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, interrupted)
    try:
        yield
    finally:
        left.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)
