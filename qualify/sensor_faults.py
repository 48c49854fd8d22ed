"""Swapped signs and wrong units on random structures: how many are found, how many falsely.

Usage: python qualify/sensor_faults.py [n_structures]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from common.command import arguments
from common.page import write_page
from common.structures import bridge, building, cantilever

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.records import Record, assess

STRUCTURES: dict[str, Callable[[np.random.Generator], Record]] = {
    "cantilevers, two to six heights": cantilever,
    "bridges, sensors without a place": bridge,
    "bridges, one `height_m` for all": lambda rng: bridge(rng, height_m=20.0),
    "buildings, sensors beside the axis": building,
}
CODES = {"sign": ("sign",), "unit": ("unit", "strong", "weak")}
"""Beginnings of the codes of findings on a fault; `strong` and `weak` are an rms of another unit."""
FACTORS = (GRAVITY_M_S2, 1.0 / GRAVITY_M_S2, 1e3, 1e-3, 1e3 / GRAVITY_M_S2)


def named(record: Record, fault: str) -> set[str]:
    """Return the channels with a fault, and those that are as likely."""
    findings = [f for f in assess(record).findings if f.code.startswith(CODES[fault])]
    doubt = fault == "sign" and not all(f.repaired for f in findings)
    words = {f.subject for f in findings} | {word for f in findings for word in f.text.split()}
    return {name for name in record.channel_names if doubt or name in words}


def times(record: Record, i: int, factor: float) -> Record:
    """Return the record with one channel multiplied."""
    data = record.data.copy()
    data[i] *= factor
    return replace(record, data=data)


def counted(make: Callable[[np.random.Generator], Record], n: int, fault: str) -> list[int]:
    """Return false alarms on sound channels; planted faults found, found among others, put on others."""
    out = np.zeros(4, dtype=int)
    for seed in range(n):
        rng = np.random.default_rng([seed, 5])
        record = make(rng)
        i = int(rng.integers(len(record.channels)))
        factor = -1.0 if fault == "sign" else float(rng.choice(FACTORS))
        found, own = named(times(record, i, factor), fault), record.channels[i].name
        out += [
            bool(named(record, fault)),
            found == {own},
            own in found != {own},
            bool(found) and own not in found,
        ]
    return [int(x) for x in out]


def main(n: int) -> None:
    """Count and write the page."""
    rows = []
    for kind, make in STRUCTURES.items():
        for fault in ("sign", "unit"):
            false, *found = counted(make, n, fault)
            rows.append(f"| {kind} | {fault} | {false} | {' | '.join(map(str, found))} |")
    write_page(
        "sensor_faults",
        [
            "# Wrong signs and units",
            "",
            f"`python qualify/sensor_faults.py {n}`: {n} random structures a row, forces white to $f^{{-3}}$",
            "in power, waves in 40 %, noise of 0.1 to 20 % of every channel, 15 to 3,600 cycles of mode 1.",
            "Once with correct sensors (false alarms), once with one channel reversed, or multiplied by",
            "9.81, 102, 1000 or an inverse. If two sensors disagree, both are reported.",
            "",
            "| structures | fault | false alarms | found | found as one of two | wrong sensor |",
            "|---|---|---|---|---|---|",
            *rows,
        ],
    )


if __name__ == "__main__":
    main(arguments(__doc__, n=1000).n)
