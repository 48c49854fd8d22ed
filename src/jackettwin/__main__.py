"""Start the command line, here and as ``python -m jackettwin``."""

from __future__ import annotations

import atexit
import os
import sys
import threading
from contextlib import suppress


def main() -> None:
    """Run a command and end the process, without taking down what was imported."""
    try:
        run()
    except SystemExit as end:
        _leave(end)


def run() -> None:
    """Run a command on one BLAS thread: our matrices are small, and two threads are slower than one."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # they are slow to look for
    try:
        from jackettwin.cli import main as command  # after the limits: NumPy reads them once
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)
    sys.exit(command())


def _leave(end: SystemExit) -> None:
    """End the process at once: to free a thousand modules takes half a second, on a busy machine two.

    What asked to be told of the end is told. Where threads are at work, Python waits for them as ever.
    """
    others = (thread for thread in threading.enumerate() if thread is not threading.main_thread())
    if any(not thread.daemon for thread in others) or not isinstance(end.code, int | None):
        raise end
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # a reader that left before the end
            stream.flush()
    os._exit(end.code or 0)


if __name__ == "__main__":
    main()
