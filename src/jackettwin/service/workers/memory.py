"""Memory of a process: bounded while a file is read, given back to the system afterwards."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_STATM = Path("/proc/self/statm")
_LEAST_BYTES = 64 * 2**20
"""Memory that is always allowed: a process over its limit must still be able to report it."""


@contextmanager
def at_most(limit_bytes: int) -> Iterator[None]:
    """Raise ``MemoryError`` in the block when this process would hold more than ``limit_bytes``.

    This stops a file while it expands, in whatever reader. Without ``/proc`` nothing is limited here, and
    Dask ends the worker.
    """
    if not _STATM.exists():
        yield
        return
    import resource  # of systems with /proc alone

    import pyarrow as pa

    pool = pa.default_memory_pool()
    pa.set_memory_pool(pa.system_memory_pool())  # Arrow's own pool reserves memory past any limit
    fields = _STATM.read_text().split()
    resident, data = (int(fields[i]) * resource.getpagesize() for i in (1, 5))
    before, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (data + max(limit_bytes - resident, _LEAST_BYTES), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (before, hard))
        pa.set_memory_pool(pool)


def give_back() -> None:
    """Return free memory to the system: glibc keeps all that lies below the highest block in use."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:  # other C libraries have no such function
        trim(0)


def one_heap() -> None:
    """Have all threads share one heap: glibc makes many, each with free memory of its own."""
    tune = getattr(ctypes.CDLL(None), "mallopt", None)
    if tune is not None:
        tune(_M_ARENA_MAX, 1)


_M_ARENA_MAX = -8
"""Parameter of glibc's ``mallopt``; other C libraries reject it."""
