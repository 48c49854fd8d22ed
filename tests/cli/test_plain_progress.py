"""Progress where there is no terminal: a line now and then, never a thousand, never long silence."""

from __future__ import annotations

import pytest

from jackettwin.cli import plain_progress as module
from jackettwin.cli.plain_progress import PlainProgress


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_lines_come_at_once_then_every_two_seconds_come_what_may(
    clock: list[float],
) -> None:
    lines: list[str] = []
    progress = PlainProgress(3, lines.append)
    progress.remind()
    progress.announce("read A1")
    progress.announce("read A2")
    clock[0] += 2.5
    progress.within("half of A2")
    clock[0] += 5.0
    progress.remind()
    clock[0] += 10.0
    progress.remind()
    progress.announce("write")
    assert lines == ["1/3 read A1", "2/3 half of A2, 2 s", "2/3 half of A2, 8 s", "2/3 half of A2, 18 s"]


def test_the_thread_ends_with_the_block() -> None:
    with module.plain_progress(1, lambda _: None) as step:
        step("work")
    assert not [
        t
        for t in module.threading.enumerate()
        if t.name.startswith("Thread") and t.daemon and "remind" in t.name
    ]
