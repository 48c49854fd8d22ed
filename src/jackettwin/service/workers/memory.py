"""Memory of a process: limited while a file is read, and in one heap."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_STATM = Path("/proc/self/statm")
_LEAST_BYTES = 64 * 2**20
"""Memory above the limit so that a process can still report the error."""


@contextmanager
def at_most(limit_bytes: int) -> Iterator[None]:
    """Raise ``MemoryError`` in the block if this process would use more than ``limit_bytes``.

    This stops the expansion of a file in any reader. Without ``/proc`` there is no limit here, and Dask's
    nanny ends the worker.
    """
    if not _STATM.exists():
        yield
        return
    import resource  # only on systems with /proc

    import pyarrow as pa

    pool = pa.default_memory_pool()
    pa.set_memory_pool(pa.system_memory_pool())  # Arrow's own pool reserves memory in advance, past any limit
    fields = _STATM.read_text().split()
    resident, data = (int(fields[i]) * resource.getpagesize() for i in (1, 5))
    before, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (data + max(limit_bytes - resident, _LEAST_BYTES), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (before, hard))
        pa.set_memory_pool(pool)


def one_heap() -> None:
    """Make all threads of this process share one heap; glibc's separate heaps each keep free memory."""
    tune = getattr(ctypes.CDLL(None), "mallopt", None)
    if tune is not None:
        tune(_M_ARENA_MAX, 1)


_M_ARENA_MAX = -8
"""Parameter of glibc's ``mallopt``; other C libraries reject it."""
