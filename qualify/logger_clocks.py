"""Loggers out of step on random structures: false alarms, and delays found by their size.

Usage: python qualify/logger_clocks.py [n_structures]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from common.page import write_page
from common.structures import bridge, building, cantilever

from jackettwin.records import Record, assess
from jackettwin.records.time_shift import earlier

STRUCTURES: dict[str, Callable[[np.random.Generator], Record]] = {
    "cantilevers": cantilever,
    "bridges": bridge,
    "buildings": building,
}
DELAYS = (0.03, 0.1, 0.3)
"""In cycles of the frequency below which half of the power above the noise floor lies."""
NEAR = 0.1
"""Relative error of a delay that is found."""


def middle_hz(record: Record) -> float:
    """Return the frequency below which half of the power above the noise floor lies."""
    power = np.abs(np.fft.rfft(record.data, axis=1)) ** 2
    power = np.maximum(power - 3.0 * np.median(power, axis=1, keepdims=True), 0.0)
    power /= np.maximum(power.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    return float(np.searchsorted(np.cumsum(power.mean(axis=0)), 0.5)) / record.duration_s


def alarmed(record: Record) -> bool:
    """Tell whether anything is repaired in a record."""
    clocks = assess(record).clocks
    return bool(any(late.certain for late in clocks.late) or clocks.jumps or clocks.gains)


def outcome(record: Record, i: int, delay_s: float) -> str:
    """Return what becomes of one channel read late: found, wrong or silent."""
    data = record.data.copy()
    data[i] = np.nan_to_num(earlier(data[i], -delay_s * record.sample_rate_hz))
    late = [one for one in assess(replace(record, data=data)).clocks.late if one.certain]
    if not late:
        return "silent"
    others = tuple(k for k in range(len(data)) if k != i)
    right = all(one.rows in ((i,), others) for one in late)
    return "found" if right and abs(abs(late[0].delay_s) / delay_s - 1.0) < NEAR else "wrong"


def counted(make: Callable[[np.random.Generator], Record], n: int) -> list[str]:
    """Return false alarms, then found and wrong by size of the delay."""
    false, found = 0, {size: {"found": 0, "wrong": 0, "silent": 0} for size in DELAYS}
    for seed in range(n):
        rng = np.random.default_rng([seed, 13])
        record = make(rng)
        false += alarmed(record)
        i, f = int(rng.integers(len(record.channels))), middle_hz(record)
        for size in DELAYS:
            found[size][outcome(record, i, size / f)] += 1
    return [str(false), *(f"{found[size]['found']} / {found[size]['wrong']}" for size in DELAYS)]


def main(n: int) -> None:
    """Count and write the page."""
    rows = [f"| {kind} | {' | '.join(counted(make, n))} |" for kind, make in STRUCTURES.items()]
    write_page(
        "logger_clocks",
        [
            "# Loggers out of step",
            "",
            f"`python qualify/logger_clocks.py {n}`: {n} random structures a row, forces white to $f^{{-3}}$",
            "in power, waves in 40 %, noise of 0.1 to 20 % of every channel, 15 to 3,600 cycles of mode 1.",
            "Once in step (false alarm: anything repaired), then with one channel late, in cycles of the",
            "frequency below which half of the power lies. Found: that channel, within 10 %; wrong: another.",
            "The rest is silent: too short or too noisy to tell.",
            "",
            "| structures | false alarms | " + " | ".join(f"{d:g}: found / wrong" for d in DELAYS) + " |",
            "|---|---|" + "---|" * len(DELAYS),
            *rows,
        ],
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
