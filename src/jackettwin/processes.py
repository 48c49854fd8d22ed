"""Processes that share a job: one BLAS thread each, deaf to Ctrl-C, gone when the job ends."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@contextmanager
def worker_pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Start a pool of processes; at the end, whatever ends it, what runs is finished and the rest dropped.

    They are spawned, not forked: a forked child shares locks and BLAS threads it cannot use.
    """
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_ignore_interrupt)
    with _one_thread_each():
        try:
            yield pool
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Have processes that start meanwhile use one BLAS thread: they are as many as the cores."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update({name: value or "1" for name, value in before.items()})
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]


def _ignore_interrupt() -> None:
    """Leave Ctrl-C to the parent: a child that dies with the queue's lock in hand hangs its brothers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
