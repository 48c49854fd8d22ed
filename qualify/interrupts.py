"""Ctrl-C and silence, command by command: docs/verification/interrupts.md.

Usage: ``python qualify/interrupts.py [--moments 4]``. Each command runs once to its end, which gives its time
and its longest silence, and then again, interrupted by SIGINT at moments spread over that time. Measured: how
long it takes to end, its exit code, a traceback, and what it leaves in its folder. The cache is empty each
time, compiled kernels are there.

Bars: ended within 2 s with exit code 130, no traceback, nothing half-written; no silence over 2 s.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from time import perf_counter, sleep

from common.page import write_page

RECORDS = Path(__file__).parents[1] / "src" / "jackettwin" / "data" / "records"
TWO = [str(RECORDS / f"{name}.parquet") for name in ("pile_U12_s301", "pile_U8_s302")]
COMMANDS: dict[str, list[str]] = {
    "identify, one record": ["identify", TWO[0], "--report", "i.html", "--out", "i.json"],
    "identify, many": ["identify", *TWO, "--out", "many"],
    "run": ["run", "--out", "run"],
    "update": ["update", "thesis_table_6_1", "--json"],
    "init": ["init", "jacket15", *TWO, "--out", "twin.yaml"],
    "follow": ["follow", "openfast_pile", "--out", "follow"],
    "modes": ["modes", "jacket15", "--json"],
    "simulate": ["simulate", "parked", "--out", "s.parquet"],
    "loads": ["loads", "parked", "--json"],
    "check": ["check", "jacket15", "--json"],
    "superelement": ["superelement", "jacket15", "--out", "se.npz"],
    "view": ["view", "jacket15", "--out", "v.html"],
    "soil": ["soil", "jacket15", "--json"],
    "verify": ["verify"],
}
WHOLE = (".html", ".json", ".yaml", ".npz", ".parquet", ".csv", ".nc", ".png", ".gz")
"""Endings of what a command may leave: a file that it had finished."""


@dataclass(frozen=True)
class Ended:
    """How a process ended: seconds from the signal, longest silence [s], exit code, traceback, leftovers."""

    took_s: float
    silence_s: float
    code: int
    traceback: bool
    left: tuple[str, ...]


def ended(command: list[str], after_s: float | None) -> Ended:
    """Run a command in an empty folder and interrupt it after a while, or let it end."""
    with tempfile.TemporaryDirectory(prefix="jackettwin-qualify-") as name:
        folder = Path(name) / "here"
        folder.mkdir()
        environment = os.environ | {"XDG_CACHE_HOME": f"{name}/cache", "COLUMNS": "140"}
        start = perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-m", "jackettwin", *command],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        said: list[tuple[float, bytes]] = []
        assert process.stdout is not None
        listener = Thread(target=lambda: said.extend((perf_counter(), line) for line in process.stdout or ()))
        listener.start()
        if after_s is not None:
            sleep(after_s)
            start = perf_counter()
            process.send_signal(signal.SIGINT)
        code = process.wait()
        end = perf_counter()
        listener.join()
        times = [start, *(t for t, _ in said), end]
        left = sorted(p.name for p in folder.rglob("*") if p.is_file() and not p.name.endswith(WHOLE))
        return Ended(
            end - start,
            max(b - a for a, b in zip(times, times[1:], strict=False)),
            code,
            any(b"Traceback" in line for _, line in said),
            tuple(left),
        )


def main() -> None:
    """Measure every command and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moments", type=int, default=4)
    moments = parser.parse_args().moments
    rows = []
    for name, command in COMMANDS.items():
        whole = ended(command, None)
        stops = [ended(command, whole.took_s * (k + 0.5) / moments) for k in range(moments)]
        codes = sorted({one.code for one in stops})
        faults = [
            *(["a traceback"] if any(one.traceback for one in stops) else []),
            *sorted({left for one in stops for left in one.left}),
        ]
        rows.append(
            f"| {name} | {whole.took_s:.1f} | {whole.silence_s:.1f} | {max(one.took_s for one in stops):.1f} "
            f"| {', '.join(map(str, codes))} | {', '.join(faults) or 'none'} |"
        )
        print(rows[-1], file=sys.stderr, flush=True)
    write_page(
        "interrupts",
        [
            "# Ctrl-C and silence",
            "",
            f"`python qualify/interrupts.py --moments {moments}`: every command ran to its end, and was then",
            f"interrupted at {moments} moments spread over that time. The exit code is 130; −2 if Python",
            "was still starting, 0 if the command had ended before.",
            "",
            "| command | whole [s] | longest silence [s] | ended after Ctrl-C [s] | exit codes | faults |",
            "|---|---|---|---|---|---|",
            *rows,
        ],
    )


if __name__ == "__main__":
    main()
