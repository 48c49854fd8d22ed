"""How fast this machine is: what costs are compared with."""

from __future__ import annotations

from statistics import median
from time import process_time

import numpy as np

SIZE = 800
REPEATS = 3


def eigenvalue_seconds() -> float:
    """Return the CPU time of ``numpy.linalg.eig`` of a dense matrix of 800 rows, the median of three [s]."""
    a = np.random.default_rng(0).standard_normal((SIZE, SIZE))
    times = []
    for _ in range(REPEATS):
        start = process_time()
        np.linalg.eig(a)
        times.append(process_time() - start)
    return median(times)
