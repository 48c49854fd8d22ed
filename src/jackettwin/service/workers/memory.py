"""Memory of a process: bounded while a file is read, given back to the system afterwards."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_STATM = Path("/proc/self/statm")
_LEAST_BYTES = 64 * 2**20
"""Room that is always given: a process over its limit must still be able to say so."""


@contextmanager
def at_most(limit_bytes: int) -> Iterator[None]:
    """Raise ``MemoryError`` in the block where this process would come to hold more than ``limit_bytes``.

    So a file is stopped while it expands, in whatever reader. Where there is no ``/proc`` nothing is bounded
    here, and the worker is ended by its watcher.
    """
    if not _STATM.exists():
        yield
        return
    import resource  # of systems with /proc alone

    import pyarrow as pa

    pool = pa.default_memory_pool()
    pa.set_memory_pool(pa.system_memory_pool())  # Arrow's own is given its memory ahead, past any limit
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
    """Return free memory to the system; glibc keeps what lies below the highest block in use, and grows."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:  # other C libraries have no such function
        trim(0)


def one_heap() -> None:
    """Have all threads of this process share one heap; glibc makes many, each with free room of its own."""
    tune = getattr(ctypes.CDLL(None), "mallopt", None)
    if tune is not None:
        tune(_M_ARENA_MAX, 1)


_M_ARENA_MAX = -8
"""Of glibc's ``mallopt``; other C libraries answer that they do not know it."""
