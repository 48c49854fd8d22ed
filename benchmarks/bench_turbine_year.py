"""A turbine-year of identification, extrapolated: 8 channels, 20 Hz, 600 s, on two processes.

Bars: 52,560 records in 8 hours with uncertainty; memory that does not grow with the number of records.
``python benchmarks/bench_turbine_year.py [RECORDS]``, default 200. What the parent process takes is measured
with the results of these records met over and over: 10, 40 and 160 times.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from jackettwin.files import KeptInFolder
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import write_record
from jackettwin.study.many_records.document import many_document
from jackettwin.study.many_records.export import export_modes
from jackettwin.study.many_records.identify import Batch, observe_many
from jackettwin.study.many_records.summary import fuse_batch
from jackettwin.twin.model import TwinModel

YEAR, WORKERS = 52_560, 2


def turbine() -> ModalSystem:
    """Two close pairs and torsion, as the tower of a parked turbine has them."""
    rng = np.random.default_rng(0)
    f = np.array([0.178, 0.183, 0.74, 0.77, 1.3])
    first, second = np.array([1.0, 0.45, 0.2, 0.1]), np.array([-0.4, 1.0, 0.7, 0.4])
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    rows = [np.kron(first, y), np.kron(first, x), np.kron(second, y), np.kron(second, x)]
    shapes = np.array([*rows, 0.3 * rng.standard_normal(8)])
    return ModalSystem(f, np.array([0.03, 0.01, 0.02, 0.012, 0.01]), shapes, np.diag(f**-2.0))


def measured(folder: Path, n: int) -> Batch:
    files = sorted(folder.glob("*.parquet"))[:n]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    started = time.perf_counter()
    keep = KeptInFolder(folder / f"results{n}")
    batch = observe_many(files, TwinModel("benchmark"), keep=keep, workers=WORKERS)
    wall = time.perf_counter() - started
    document = many_document(batch, fuse_batch(batch))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / n
    say(f"{n} records, {len(batch.failed)} failed, {len(document['modes'])} modes fused")
    say(f"  CPU time a record                    {cpu:8.2f} s")
    say(f"  a year on {WORKERS} cores, CPU time           {cpu * YEAR / WORKERS / 3600.0:8.1f} h")
    say(f"  the same by this run's wall clock    {wall / n * YEAR / 3600.0:8.1f} h")
    say(f"  largest worker so far                {after.ru_maxrss / 1024.0:8.0f} MB")
    say(f"  this process so far                  {own_mb():8.0f} MB")
    return batch


def fused(batch: Batch, times: int, folder: Path) -> None:
    """Fuse and export a batch whose results come many times over."""
    many = Batch(batch.results * times, ())
    started = time.perf_counter()
    document = many_document(many, fuse_batch(many))
    for path in (folder / "modes.json", folder / "modes.csv", folder / "modes.nc"):
        export_modes(document, path)
    seconds = time.perf_counter() - started
    kept = sum(path.stat().st_size for path in batch.results) / len(batch)
    say(f"{len(many)} results of {kept / 1e3:.1f} kB fused and exported, {len(document['modes'])} modes")
    say(f"  time a result                        {1e3 * seconds / len(many):8.2f} ms")
    say(f"  this process so far                  {own_mb():8.0f} MB")


def own_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    system = turbine()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for i in range(n):
            write_record(simulate(system, np.random.default_rng(i)), folder / f"r{i:05d}.parquet")
        measured(folder, n // 4)
        batch = measured(folder, n)
        for times in (10, 40, 160):
            fused(batch, times, folder)


def say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
