"""Monte Carlo of the automatic identification: ten modes, one close pair, ten-minute records.

Usage: ``python qualify/identification.py [RECORDS] [OUT.md]``. Two thousand records (twenty sets of a hundred
to fuse) and a tenth as many of each variant take 40 minutes on two idle cores. The records come from the
exact spectral matrix of the modal system (``identification/synthetic.py``); the modes from the automatic
selection, no truth used but to name them afterwards.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from jackettwin.identification import FusedIdentification, Identification, fuse, identify, mac
from jackettwin.identification.synthetic import ModalSystem, simulate

DURATION_S, RATE_HZ = 600.0, 20.0
FREQUENCY_HZ = np.array([0.31, 0.33, 0.62, 0.95, 1.3, 1.75, 2.2, 2.9, 3.5, 4.3])
DAMPING_RATIO = np.array([1.2, 1.5, 1.0, 1.5, 2.0, 1.2, 1.8, 1.0, 1.5, 2.0]) / 100.0
CASES = {
    "orthogonal pair, white forces": (0.0, 0.0, 1.0),
    "pair with MAC 0.5": (0.5, 0.0, 0.1),
    "forces falling as f⁻²": (0.0, 2.0, 0.1),
}
"""MAC of the pair, exponent of the forces, share of the records."""
FEWEST = 40
"""Records of a variant at least."""
SET = 100
EXPLANATION = [
    "Ten modes in eight channels, a pair at 0.31 and 0.33 Hz, 2 % noise, correlated forces. The modes come",
    "from the automatic selection, the truth only names them. Scatter is that of ζ over Au's 1/√(2πζfT).",
]
SAME = 0.7
"""Largest distance, frequency in three half bandwidths plus 1 − MAC, of an estimate and its truth."""


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


def one(seed: int, *, pair_mac: float, force_slope: float) -> tuple[Identification, float]:
    """Return what is identified in one record and the CPU time of it [s]."""
    system = ten_modes(pair_mac, force_slope)
    rng = np.random.default_rng([2026, seed])
    record = simulate(system, rng, duration_s=DURATION_S, sample_rate_hz=RATE_HZ)
    start = process_time()
    return identify(record), process_time() - start


def errors(result: Identification, shapes: np.ndarray) -> np.ndarray:
    """Return errors and standard deviations of ln f and ln ζ of each true mode, NaN where it is missed."""
    out = np.full((10, 4), np.nan)
    f = np.array([mode.frequency_hz for mode in result.modes])
    similarity = mac(shapes, np.array([mode.mode_shape for mode in result.modes]))
    apart = np.abs(np.log(f / FREQUENCY_HZ[:, None])) / (3.0 * DAMPING_RATIO[:, None]) + 1.0 - similarity
    for k, j in enumerate(np.argmin(apart, axis=1)):
        mode = result.modes[j]
        if apart[k, j] < SAME and mode.log_covariance is not None:
            log_error = np.log([mode.frequency_hz / FREQUENCY_HZ[k], mode.damping_ratio / DAMPING_RATIO[k]])
            out[k] = [*log_error, *np.sqrt(np.diag(mode.log_covariance))]
    return out


def table(results: list[Identification], system: ModalSystem) -> list[str]:
    e = np.array([errors(result, system.mode_shapes) for result in results])
    limit = 1.0 / np.sqrt(2.0 * np.pi * DAMPING_RATIO * FREQUENCY_HZ * DURATION_S)
    ratio = np.exp(e[:, :, 1])
    rows = [
        "| f [Hz] | found | bias of ζ [%] | ± | scatter of ζ / limit | coverage f [%] | coverage ζ [%] |",
        "|---|---|---|---|---|---|---|",
    ]
    for k in range(10):
        known = np.isfinite(ratio[:, k])
        if known.sum() < 2:
            rows.append(f"| {FREQUENCY_HZ[k]} | {known.mean():.3f} | – | – | – | – | – |")
            continue
        spread = np.std(ratio[known, k])
        inside = [np.mean(np.abs(e[known, k, i]) < 1.96 * e[known, k, 2 + i]) for i in (0, 1)]
        rows.append(
            f"| {FREQUENCY_HZ[k]} | {known.mean():.3f} | {100 * (ratio[known, k].mean() - 1):.1f} "
            f"| {100 * spread / np.sqrt(known.sum()):.1f} | {spread / limit[k]:.2f} "
            f"| {100 * inside[0]:.1f} | {100 * inside[1]:.1f} |"
        )
    found = np.isfinite(e[:, :, 0]).sum()
    spurious = sum(len(result.modes) for result in results) - found
    refined = np.mean([any(m.unrefined is not None for m in result.modes) for result in results])
    covered = [np.nanmean(np.where(np.isnan(e[:, :, i]), np.nan, np.abs(e[:, :, i]) < 1.96 * e[:, :, 2 + i]))
               for i in (0, 1)]  # fmt: skip
    return [
        *rows,
        "",
        f"All modes together: found {found / e[:, :, 0].size:.4f}, "
        f"spurious a record {spurious / len(results):.3f}, "
        f"coverage f {100 * covered[0]:.1f} %, ζ {100 * covered[1]:.1f} %; "
        f"records refined {refined:.3f}",
        "",
        *fused_sets(results, system, limit),
    ]


def fused_sets(results: list[Identification], system: ModalSystem, limit: np.ndarray) -> list[str]:
    """Fuse sets of a hundred records: error of ζ over the limit of the set, share of intervals that hold."""
    size = min(SET, len(results))
    sets = [fuse(results[k : k + size]) for k in range(0, len(results) - size + 1, size)]
    error, inside = zip(*(errors_of_fused(fused, system) for fused in sets), strict=True)
    rms = np.sqrt(np.mean(np.square(error), axis=0)) / (limit / np.sqrt(size))
    return [
        f"{len(sets)} sets of {size} records fused: rms error of ζ over the limit of a set "
        + ", ".join(f"{x:.2f}" for x in rms)
        + f"; {100 * np.mean(inside):.1f} % of their intervals hold the truth",
        "",
    ]


def errors_of_fused(fused: FusedIdentification, system: ModalSystem) -> tuple[list[float], list[bool]]:
    shapes = np.array([mode.mode_shape for mode in fused.modes])
    f = np.array([mode.frequency_hz for mode in fused.modes])
    apart = np.abs(np.log(f / FREQUENCY_HZ[:, None])) / 0.03 + 1.0 - mac(system.mode_shapes, shapes)
    modes = [fused.modes[int(j)] for j in np.argmin(apart, axis=1)]
    return (
        [m.damping_ratio / zeta - 1.0 for m, zeta in zip(modes, DAMPING_RATIO, strict=True)],
        [
            m.damping_ratio_interval_95[0] < zeta < m.damping_ratio_interval_95[1]
            for m, zeta in zip(modes, DAMPING_RATIO, strict=True)
        ],
    )


def main() -> None:
    n_records = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path("docs/verification/identification.md")
    lines = [f"# Automatic identification of records of {DURATION_S:.0f} s", "", *EXPLANATION, ""]
    for title, (pair_mac, slope, share) in CASES.items():
        n = min(n_records, max(round(share * n_records), FEWEST))
        with ProcessPoolExecutor(os.cpu_count()) as pool:
            work = partial(one, pair_mac=pair_mac, force_slope=slope)
            both = list(pool.map(work, range(n), chunksize=4))
        cpu = np.median([seconds for _, seconds in both])
        lines += [f"## {title}: {n} records, median {cpu:.1f} CPU-s each", ""]
        lines += table([result for result, _ in both], ten_modes(pair_mac, slope))
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text("\n".join(lines), encoding="utf-8")
    sys.stdout.write("\n".join(lines))


if __name__ == "__main__":
    main()
