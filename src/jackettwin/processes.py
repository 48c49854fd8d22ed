"""Processes that share a job: one BLAS thread each, deaf to Ctrl-C, gone with the job or the parent."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from functools import wraps
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")
R = TypeVar("R")

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_AHEAD = 2
"""Items handed out for every worker: the others are not even opened."""
GRACE_S = 0.6
"""Time that a process gets to end by itself: Ctrl-C answers within two seconds."""
ASKED_EVERY_S = 0.1
"""Time between two requests to end: enough to remove a file."""
_ORPHANED = 1
"""Exit code of a worker whose parent died."""


def on_one_blas_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Return a function that runs with one BLAS thread, whatever its process has.

    Matrices are small here: threads that wait for each other take three times the CPU seconds, and longer.
    """

    @wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        from threadpoolctl import threadpool_limits  # a help text needs none of it

        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return run


def give_back() -> None:
    """Return free memory to the system; glibc keeps all below the highest used block, and so grows."""
    arrow = sys.modules.get("pyarrow")
    if arrow is not None:
        arrow.default_memory_pool().release_unused()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:  # only glibc has this function
        trim(0)


@contextmanager
def worker_pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Start a pool of processes; they end with the block, at once if it ends by an error or Ctrl-C.

    They are spawned, not forked: a forked child shares locks and BLAS threads it cannot use.
    """
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_prepare_worker)
    with _one_thread_each():
        before = set(active_children())
        try:
            yield pool
        except BaseException:
            _stop([child for child in active_children() if child not in before])
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def in_processes(work: Callable[[T], R], items: Sequence[T], workers: int) -> Iterator[tuple[int, R | None]]:
    """Yield position and result of every item as they come; None for one that takes its process with it.

    A process that ends abruptly (out of memory, a crash in a library) breaks its pool. The items under way
    are then run once more, each in a process of its own, so that only the one to blame is lost. A bounded
    number of items is under way.
    """
    waiting = iter(range(len(items)))
    broken = True
    while broken:
        lost: list[int] = []
        yield from _until_broken(work, items, waiting, workers, lost)
        for i in lost:
            yield i, _alone(work, items[i])
        broken = bool(lost)


def _until_broken(
    work: Callable[[T], R], items: Sequence[T], waiting: Iterator[int], workers: int, lost: list[int]
) -> Iterator[tuple[int, R]]:
    """Yield results until all are there or the pool breaks; then ``lost`` holds what was under way."""
    under_way: dict[Future[R], int] = {}
    with worker_pool(workers) as pool:
        while True:
            for i in waiting:
                try:
                    under_way[pool.submit(work, items[i])] = i
                except BrokenExecutor:
                    lost.extend([*under_way.values(), i])
                    return
                if len(under_way) >= _AHEAD * workers:
                    break
            if not under_way:
                return
            for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                if isinstance(future.exception(), BrokenExecutor):
                    lost.append(under_way.pop(future))
                else:
                    yield under_way.pop(future), future.result()
            if lost:
                lost.extend(under_way.values())
                return


def _alone(work: Callable[[T], R], item: T) -> R | None:
    """Return the result of one item in a process of its own; None if the process ends abruptly."""
    with worker_pool(1) as pool:
        try:
            return pool.submit(work, item).result()
        except BrokenExecutor:
            return None


def _stop(children: Sequence[BaseProcess]) -> None:
    """End processes within ``GRACE_S``: asked, so that they remove what is half-written, then killed.

    They are asked again and again: a worker takes the end of its item for a result, and goes on to the next.
    """
    deadline = time.monotonic() + GRACE_S
    while any(child.is_alive() for child in children) and time.monotonic() < deadline:
        for child in children:
            child.terminate()
        time.sleep(ASKED_EVERY_S)
    for child in children:
        child.kill()


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


def _prepare_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it."""
    # a child that dies with the queue's lock in hand hangs its brothers
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end(*_: object) -> None:
    """End by an exception, which removes temporary files, wherever the work is."""
    raise SystemExit(_ORPHANED)


def _end_with_parent() -> None:
    """Wait for the parent's end, and end this process then, whatever it is doing.

    A worker waits for work on a pipe whose other end it holds itself, so it never learns that nobody is left
    to send any. The parent's sentinel becomes ready when the parent is gone, also by ``kill -9``, on every
    platform. ``PR_SET_PDEATHSIG`` would not do: it tells of the end of the thread that started the worker.
    """
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(_ORPHANED)
