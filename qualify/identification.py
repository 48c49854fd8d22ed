"""Monte Carlo of the automatic identification: ten-minute records of systems whose truth is known.

Usage: ``python qualify/identification.py [--records 2000] [--variant 100] [--seed 2026] [--sets 20]``.
Two thousand records, so that twenty sets of a hundred share none, and a hundred of each variant take about
80 CPU-minutes, on two processes. What is identified is kept in ``out/qualify`` as it comes, so that an
interrupted run resumes; a change of the code starts afresh. The tables go between two markers of the
verification page, whose other text stays.

The records come from the exact spectral matrix of the modal system (``identification/synthetic.py``); the
modes from the automatic selection, no truth used but to name them afterwards.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from jackettwin import identification
from jackettwin.files.codec import decode, encode
from jackettwin.identification import FusedIdentification, Identification, fuse, identify, mac
from jackettwin.identification.preparation.resolve import guarded_band_hz
from jackettwin.identification.synthetic import ModalSystem, cramer_rao, simulate

PAGE = Path("docs/verification/identification.md")
KEPT = Path("out/qualify/identification")
START, END = "<!-- qualify/identification.py writes below -->", "<!-- and above -->"
FREQUENCY_HZ = np.array([0.31, 0.33, 0.62, 0.95, 1.3, 1.75, 2.2, 2.9, 3.5, 4.3])
DAMPING_RATIO = np.array([1.2, 1.5, 1.0, 1.5, 2.0, 1.2, 1.8, 1.0, 1.5, 2.0]) / 100.0
DURATION_S = 600.0
SET = 100
PROCESSES = 2
SAME = 0.7
"""Largest distance, frequency in three half bandwidths plus 1 − MAC, of an estimate and its truth."""
STAGES = ("preparing", "poles", "selection", "refinement")
HEAD = "| f [Hz] | found | bias of ζ [%] | ± | scatter / Au | bound / Au | coverage f [%] | coverage ζ [%] |"


@dataclass(frozen=True)
class Case:
    """A system and how its records are taken."""

    title: str
    system: ModalSystem
    sample_rate_hz: float = 20.0


def ten_modes(pair_mac: float, force_slope: float) -> ModalSystem:
    """Return the system, the shapes of its close pair having the given MAC."""
    rng = np.random.default_rng(42)
    shapes = rng.standard_normal((10, 8))
    shapes /= np.linalg.norm(shapes, axis=1, keepdims=True)
    aside = shapes[1] - shapes[0] * (shapes[0] @ shapes[1])
    aside /= np.linalg.norm(aside)
    shapes[1] = np.sqrt(pair_mac) * shapes[0] + np.sqrt(1.0 - pair_mac) * aside
    mixing = rng.standard_normal((10, 20))
    force = mixing @ mixing.T / 20.0 / np.outer(FREQUENCY_HZ, FREQUENCY_HZ)
    return ModalSystem(FREQUENCY_HZ, DAMPING_RATIO, shapes, force, 0.02, force_slope)


def other(
    frequency_hz: list[float], damping_percent: list[float], n_channels: int, noise: float, lag_deg: float
) -> ModalSystem:
    """Return a system of random shapes whose entries lag by angles of the given standard deviation."""
    f = np.array(frequency_hz)
    rng = np.random.default_rng(7)
    shapes = rng.standard_normal((len(f), n_channels))
    lag = np.deg2rad(lag_deg) * rng.standard_normal(shapes.shape)
    mixing = rng.standard_normal((len(f), 2 * len(f)))
    force = mixing @ mixing.T / (2.0 * len(f)) / np.outer(f, f)
    turned = shapes * np.exp(1j * lag) if lag_deg else shapes
    return ModalSystem(f, np.array(damping_percent) / 100.0, turned, force, noise)


CASES = (
    Case("orthogonal pair, white forces", ten_modes(0.0, 0.0)),
    Case("pair with MAC 0.5", ten_modes(0.5, 0.0)),
    Case("forces falling as f⁻²", ten_modes(0.0, 2.0)),
    Case(
        "five channels, 10 % noise, shapes that lag by 5°",
        other([0.18, 0.44, 0.9, 1.1, 2.1], [1.5, 1.0, 2.0, 0.8, 1.2], 5, 0.1, 5.0),
        50.0,
    ),
    Case(
        "twelve channels, 0.2 % noise, a pair at 0.25 and 0.256 Hz",
        other([0.25, 0.256, 0.75, 0.79, 1.9, 2.6], [1.0, 1.5, 1.2, 2.5, 0.8, 1.5], 12, 0.002, 0.0),
    ),
)


def one(seed: tuple[int, int], *, case: Case) -> dict[str, object]:
    """Return what is identified in one record and the CPU time of each stage [s], as plain data."""
    record = simulate(
        case.system,
        np.random.default_rng(seed),
        duration_s=DURATION_S,
        sample_rate_hz=case.sample_rate_hz,
    )
    at: list[float] = []
    found = identify(record, progress=lambda _: at.append(process_time()))
    seconds = np.diff([*at, process_time()])
    return {"seed": seed[1], "seconds": seconds.tolist(), "found": encode(found.without_figures)}


def identified(case: Case, n: int, seed: int) -> tuple[list[Identification], np.ndarray]:
    """Return the identifications of ``n`` records, those kept and those missing, and CPU times (n, 4)."""
    file = KEPT / digest() / f"{hashlib.sha256(case.title.encode()).hexdigest()[:8]}-{seed}.jsonl"
    file.parent.mkdir(parents=True, exist_ok=True)
    lines = list(read_lines(file)) if file.exists() else []
    missing = sorted(set(range(n)) - {line["seed"] for line in lines})
    start = perf_counter()
    context = multiprocessing.get_context("spawn")
    with file.open("a", encoding="utf-8") as out, ProcessPoolExecutor(PROCESSES, mp_context=context) as pool:
        work = pool.map(partial(one, case=case), [(seed, k) for k in missing], chunksize=4)
        for done, line in enumerate(work, start=1):
            out.write(json.dumps(line) + "\n")
            lines.append(line)
            if done % 20 == 0 or done == len(missing):
                out.flush()
                left = (perf_counter() - start) * (len(missing) / done - 1.0) / 60.0
                say(f"{case.title}: {n - len(missing) + done} of {n}, {left:.1f} min left")
    chosen = sorted((line for line in lines if line["seed"] < n), key=lambda line: line["seed"])
    return [decode(Identification, line["found"]) for line in chosen], np.array(
        [line["seconds"] for line in chosen]
    )


def read_lines(file: Path) -> Iterator[dict]:
    """Yield the records of a file; a last line that was cut off is none."""
    for line in file.read_text(encoding="utf-8").splitlines():
        try:
            yield json.loads(line)
        except json.JSONDecodeError:
            continue


def digest() -> str:
    """Return a name for the code that identifies."""
    files = sorted(Path(identification.__file__).parent.rglob("*.py"))
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:12]


def errors(result: Identification, system: ModalSystem) -> np.ndarray:
    """Return errors and standard deviations of ln f and ln ζ of each true mode, NaN where it is missed."""
    out = np.full((len(system.frequency_hz), 4), np.nan)
    if not result.modes:
        return out
    f = np.array([mode.frequency_hz for mode in result.modes])
    similarity = mac(system.mode_shapes, np.array([mode.mode_shape for mode in result.modes]))
    apart = np.abs(np.log(f / system.frequency_hz[:, None])) / (3.0 * system.damping_ratio[:, None])
    apart += 1.0 - similarity
    for k, j in enumerate(np.argmin(apart, axis=1)):
        mode = result.modes[j]
        if apart[k, j] < SAME and mode.log_covariance is not None:
            truth = np.array([system.frequency_hz[k], system.damping_ratio[k]])
            error = np.log([mode.frequency_hz, mode.damping_ratio] / truth)
            out[k] = [*error, *np.sqrt(np.diag(mode.log_covariance))]
    return out


def table(results: list[Identification], case: Case) -> list[str]:
    """Return a row for each mode and a line on all of them."""
    system = case.system
    e = np.array([errors(result, system) for result in results])
    au = 1.0 / np.sqrt(2.0 * np.pi * system.damping_ratio * system.frequency_hz * DURATION_S)
    band = guarded_band_hz(results[0].settings)
    bound = cramer_rao(system, duration_s=DURATION_S, sample_rate_hz=case.sample_rate_hz, band_hz=band)[1]
    ratio, known = np.exp(e[:, :, 1]), np.isfinite(e[:, :, 0])
    count = known.sum(axis=0)
    inside = [np.where(known, np.abs(e[:, :, i]) < 1.96 * e[:, :, 2 + i], np.nan) for i in (0, 1)]
    spread = np.nanstd(ratio, axis=0)
    rows = [HEAD, "|---" * 8 + "|"]
    for k, f in enumerate(system.frequency_hz):
        rows.append(
            f"| {f:g} | {known[:, k].mean():.3f} | {100 * (np.nanmean(ratio[:, k]) - 1):.1f} "
            f"| {100 * spread[k] / np.sqrt(count[k]):.1f} | {spread[k] / au[k]:.2f} | {bound[k] / au[k]:.2f} "
            f"| {100 * np.nanmean(inside[0][:, k]):.1f} | {100 * np.nanmean(inside[1][:, k]):.1f} |"
        )
    spurious = sum(len(result.modes) for result in results) - known.sum()
    refined = np.mean([all(m.unrefined is not None for m in result.modes) for result in results])
    return [
        *rows,
        "",
        f"All modes together: found {known.mean():.4f}, spurious a record {spurious / len(results):.3f}, "
        f"median scatter {np.median(spread / au):.2f}, coverage f {100 * np.nanmean(inside[0]):.1f} %, "
        f"ζ {100 * np.nanmean(inside[1]):.1f} %; records refined {refined:.3f}.",
        "",
    ]


def fused_sets(results: list[Identification], system: ModalSystem, n_sets: int) -> list[str]:
    """Fuse sets of a hundred records: error of ζ over the limit of the set, share of intervals that hold.

    Sets of neighbours first, then sets that take every n-th record: no two of one kind share a record.
    """
    size = min(SET, len(results))
    parts = len(results) // size
    sets = [results[k * size : (k + 1) * size] for k in range(parts)]
    sets += [results[k : parts * size : parts] for k in range(parts) if parts > 1]
    both = [errors_of_fused(fuse(part), system) for part in sets[:n_sets]]
    error, inside = (np.array(x, dtype=float) for x in zip(*both, strict=True))
    au = 1.0 / np.sqrt(2.0 * np.pi * system.damping_ratio * system.frequency_hz * DURATION_S)
    rms = np.sqrt(np.nanmean(error**2, axis=0)) / (au / np.sqrt(size))
    return [
        f"{len(both)} sets of {size} records fused: rms error of ζ over the limit of a set "
        + ", ".join(f"{x:.2f}" for x in rms)
        + f"; {100 * np.nanmean(inside):.1f} % of their intervals contain the truth.",
        "",
    ]


def errors_of_fused(fused: FusedIdentification, system: ModalSystem) -> tuple[list[float], list[float]]:
    """Return the relative error of ζ of each true mode, and whether its interval holds the truth."""
    shapes = np.array([mode.mode_shape for mode in fused.modes])
    f = np.array([mode.frequency_hz for mode in fused.modes])
    apart = np.abs(np.log(f / system.frequency_hz[:, None])) / 0.03 + 1.0 - mac(system.mode_shapes, shapes)
    modes = [fused.modes[int(j)] for j in np.argmin(apart, axis=1)]
    both = list(zip(modes, system.damping_ratio, strict=True))
    ends = [mode.damping_ratio_interval_90 for mode in modes]
    held = [low < zeta < high for (low, high), zeta in zip(ends, system.damping_ratio, strict=True)]
    return [mode.damping_ratio / zeta - 1.0 for mode, zeta in both], [float(one) for one in held]


def section(case: Case, n: int, seed: int, n_sets: int) -> list[str]:
    """Return the part of the page about one case."""
    results, seconds = identified(case, n, seed)
    times = ", ".join(f"{name} {s:.2f}" for name, s in zip(STAGES, np.median(seconds, axis=0), strict=True))
    return [
        f"### {case.title}: {n} records",
        "",
        f"Median CPU-seconds a record: {times}.",
        "",
        *table(results, case),
        *fused_sets(results, case.system, n_sets),
    ]


def write(lines: list[str]) -> None:
    """Put lines between the markers of the page."""
    before, rest = PAGE.read_text(encoding="utf-8").split(START)
    after = rest.split(END)[1]
    PAGE.write_text("\n".join([before + START, "", *lines, END + after]), encoding="utf-8")


def say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--records", type=int, default=2000)
    parser.add_argument("--variant", type=int, default=100)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--sets", type=int, default=20)
    chosen = parser.parse_args()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    lines = [f"`python qualify/identification.py {' '.join(sys.argv[1:])}`".replace(" `", "`"), ""]
    for k, case in enumerate(CASES):
        n = chosen.records if k == 0 else min(chosen.records, chosen.variant)
        lines += section(case, n, chosen.seed, chosen.sets)
        write(lines)
    say("\n".join(lines))


if __name__ == "__main__":
    main()
