"""The entry point as a user starts it."""

import os
import subprocess
import sys

from jackettwin import __version__


def test_the_module_is_a_command() -> None:
    found = subprocess.run(
        [sys.executable, "-m", "jackettwin", "--version"], capture_output=True, text=True, check=True
    )
    assert __version__ in found.stdout


def test_commands_run_on_one_blas_thread_unless_told_otherwise() -> None:
    code = (
        "import os, sys; sys.argv = ['jackettwin', '--help']\n"
        "from jackettwin.__main__ import run\n"
        "try: run()\n"
        "finally: print('threads', os.environ['OMP_NUM_THREADS'], os.environ['OPENBLAS_NUM_THREADS'])"
    )
    environment = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    environment["OMP_NUM_THREADS"] = "3"
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert "threads 3 1" in found.stdout


def test_the_end_is_told_to_who_asked_and_waits_for_no_module() -> None:
    """Output is flushed, handlers of the end run, and the exit code stands."""
    code = (
        "import atexit, sys; sys.argv = ['jackettwin', 'nothing-such']\n"
        "class Slow:\n"
        "    def __del__(self): print('taken down')\n"
        "kept = Slow(); atexit.register(print, 'told')\n"
        "from jackettwin.__main__ import main\n"
        "sys.stdout.write('before '); main()"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (found.returncode, found.stdout) == (2, "before told\n")
    assert "No such command" in found.stderr
