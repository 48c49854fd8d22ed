"""Cycles and S-N curves: the example of ASTM E1049, the printed limits of DNV-RP-C203."""

from __future__ import annotations

import numpy as np

from jackettwin.fatigue import count, read_curve
from jackettwin.verify.rows import Computed

_SERIES = (-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0)
_CURVES = ("B1", "C", "D", "E", "F", "G", "W3")


def weld_benchmarks() -> Computed:
    """Return counted cycles by range, and the ranges [MPa] of ten million cycles by curve."""
    counted = count(np.array(_SERIES))
    found: Computed = {
        f"ASTM-{size}": float(counted.numbers[np.isclose(counted.ranges, size)].sum())
        for size in (3, 4, 6, 8, 9)
    }
    return found | {f"C203-{name}": 1e-6 * read_curve(name, "air").knee_pa for name in _CURVES}
