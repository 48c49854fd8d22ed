"""Speed of SSI-cov side by side with pyOMA2 and koma, one thread, the same samples and block rows.

And of identify on the shipped OpenFAST records, step by step, beside a dense eigenvalue problem.

koma asks for a 3D viewer its SSI does not use: ``pip install --no-deps koma-python`` puts it beside us.

Bars: 8 channels, 600 s, 100 Hz, order 80, every order: 0.15 s and a third of pyOMA2's fastest without
uncertainty; with it 1 CPU-s at 50 block rows and 5 at 100 (pyOMA2: 100 CPU-s, about 1400).
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np

import jackettwin
from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.subspace.covariances import block_covariances, covariances
from jackettwin.identification.subspace.ssi_cov import frequency_and_damping, order_poles, ssi_cov
from jackettwin.identification.subspace.ssi_uncertainty import (
    block_deviations,
    order_poles_with_uncertainty,
    propagation,
)
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import assess, read_record

RECORDS = Path(jackettwin.__file__).parent / "data" / "records"
RATE, MAX_ORDER, BLOCKS = 100.0, 80, 50
ORDERS = range(1, MAX_ORDER + 1)


def ten_modes() -> ModalSystem:
    f = np.array([0.31, 0.33, 0.62, 0.95, 1.3, 1.75, 2.2, 2.9, 3.5, 4.3])
    shapes = np.random.default_rng(42).standard_normal((10, 8))
    return ModalSystem(f, np.full(10, 0.015), shapes, np.diag(f**-2.0))


def seconds(work: Callable[[], object], repeats: int) -> float:
    """Median CPU time of the process."""
    times = []
    for _ in range(repeats):
        start = process_time()
        work()
        times.append(process_time() - start)
    return median(times)


def poles(y: np.ndarray, block_rows: int) -> None:
    lagged = covariances(y, 2 * block_rows)
    order_poles(ssi_cov(lagged, block_rows=block_rows, max_order=MAX_ORDER, factors=False), ORDERS)


def poles_with_uncertainty(y: np.ndarray, block_rows: int) -> None:
    def keep(mu: np.ndarray) -> np.ndarray:
        _, zeta = frequency_and_damping(mu, RATE)
        return np.asarray((zeta > 0.0) & (zeta < 0.1))

    subspace = ssi_cov(covariances(y, 2 * block_rows), block_rows=block_rows, max_order=MAX_ORDER)
    blocks = block_covariances(y, 2 * block_rows, BLOCKS)
    order_poles_with_uncertainty(propagation(subspace, block_deviations(blocks, block_rows)), ORDERS, keep)


def pyoma(y: np.ndarray, block_rows: int, method: str) -> None:
    from pyoma2.functions import ssi

    hankel, _ = ssi.build_hank(y, y, block_rows, method)
    observability, a, c, _ = ssi.SSI_fast(hankel, block_rows, MAX_ORDER, step=1)
    ssi.SSI_poles(observability, a, c, MAX_ORDER, 1.0 / RATE, xi_max=0.1)


def koma(y: np.ndarray, block_rows: int) -> None:
    from koma import oma

    oma.covssi(y.T, RATE, block_rows, np.arange(2, MAX_ORDER + 1), weighting="br", showinfo=False)


def real_records(dense: np.ndarray) -> None:
    """Print what the shipped records of an independent program cost, and each step; reading is left out.

    Bars, beside a dense eigenvalue problem of 0.47 s: 1.0 in the median and 2.5 at most, ``--quick`` 0.3.
    Each record is judged beside that problem before and after it, since a machine changes its pace.
    """
    spent: dict[str, list[float]] = {"identify": [], "with its quality check": [], "quick": []}
    quick = IdentificationSettings(refine=False, blocks=0)
    for path in sorted(RECORDS.glob("*.parquet")):
        record, times = read_record(path), []
        before = seconds(lambda: np.linalg.eig(dense), 1)
        start = process_time()
        identify(record, progress=lambda step: times.append((step, process_time())))  # noqa: B023
        ends = [*(at for _, at in times[1:]), process_time()]
        checked = ends[-1] - start + seconds(lambda: assess(record), 1)  # noqa: B023
        quickly = seconds(lambda: identify(record, quick), 1)  # noqa: B023
        scale = 2.0 * 0.47 / (before + seconds(lambda: np.linalg.eig(dense), 1))
        for what, own in zip(spent, (ends[-1] - start, checked, quickly), strict=True):
            spent[what].append(scale * own)
        report(f"identify {path.stem}", ends[-1] - start)
        steps = (f"{step} {end - at:.2f}" for (step, at), end in zip(times, ends, strict=True))
        sys.stdout.write("  " + ", ".join(steps) + "\n")
    for what, scaled in spent.items():
        sys.stdout.write(f"{what}: median {median(scaled):.2f}, most {max(scaled):.2f} CPU-s scaled\n")


def main() -> None:
    warnings.simplefilter("ignore")
    dense = np.random.default_rng(0).standard_normal((800, 800))
    report("dense 800 × 800 eigenvalue problem", seconds(lambda: np.linalg.eig(dense), 3))
    record = simulate(ten_modes(), np.random.default_rng(1), sample_rate_hz=RATE)
    y = record.data / record.data.std(axis=1, keepdims=True)
    for block_rows in (50, 100):
        ours = seconds(lambda: poles(y, block_rows), 5)  # noqa: B023
        report(f"SSI-cov, {block_rows} block rows, every order to 80", ours)
        for method in ("cov_R", "cov") if find_spec("pyoma2") is not None else ():
            theirs = seconds(lambda: pyoma(y, block_rows, method), 1)  # noqa: B023
            report(f"  pyOMA2 {method}", theirs, theirs / ours)
        if find_spec("koma") is not None:
            theirs = seconds(lambda: koma(y, block_rows), 1)  # noqa: B023
            report("  koma", theirs, theirs / ours)
        report("  with uncertainty", seconds(lambda: poles_with_uncertainty(y, block_rows), 1))  # noqa: B023
    plain = IdentificationSettings(refine=False)
    without = seconds(lambda: identify(record, plain), 3)
    report("identify, automatic, with uncertainty", without)
    report("  and refined by maximum likelihood", seconds(lambda: identify(record), 3) - without)
    real_records(dense)


def report(what: str, time_s: float, ratio: float | None = None) -> None:
    beside = "" if ratio is None else f"   {ratio:6.1f} times ours"
    sys.stdout.write(f"{what:52s} {time_s:9.3f} CPU-s{beside}\n")


if __name__ == "__main__":
    main()
