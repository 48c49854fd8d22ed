"""Ctrl-C ends a command even if what runs then swallows it."""

import signal
import subprocess
import sys
import time

SWALLOWING = """
import time
from jackettwin.cli.interrupts import insisting
with insisting():
    print("ready", flush=True)
    try:
        time.sleep(20.0)
    except KeyboardInterrupt:
        pass  # as a compiler's callback does
    for _ in range(200):
        time.sleep(0.1)
"""


def test_an_interrupt_that_was_swallowed_comes_again() -> None:
    command = [sys.executable, "-c", SWALLOWING]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        process.send_signal(signal.SIGINT)
        start = time.monotonic()
        assert process.wait(timeout=30.0) != 0
    assert time.monotonic() - start < 15.0  # of 40 s that it would take unheard


def test_another_handler_stays() -> None:
    code = (
        "import signal; from jackettwin.cli.interrupts import insisting; mine = lambda *_: None; "
        "signal.signal(signal.SIGINT, mine); insisting().__enter__(); "
        "assert signal.getsignal(signal.SIGINT) is mine"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
