"""Monte Carlo of the automatic identification: ten modes, one close pair, ten-minute records.

Usage: ``python qualify/identification.py [RECORDS] [OUT.md]``. The records come from the exact spectral
matrix of the modal system (``identification/synthetic.py``); the modes from the automatic selection, no
truth used but to name them afterwards.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from jackettwin.identification import Identification, fuse, identify, mac
from jackettwin.identification.synthetic import ModalSystem, simulate

DURATION_S, RATE_HZ = 600.0, 20.0
FREQUENCY_HZ = np.array([0.31, 0.33, 0.62, 0.95, 1.3, 1.75, 2.2, 2.9, 3.5, 4.3])
DAMPING_RATIO = np.array([1.2, 1.5, 1.0, 1.5, 2.0, 1.2, 1.8, 1.0, 1.5, 2.0]) / 100.0
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


def one(seed: int, *, pair_mac: float, force_slope: float) -> Identification:
    system = ten_modes(pair_mac, force_slope)
    rng = np.random.default_rng([2026, seed])
    return identify(simulate(system, rng, duration_s=DURATION_S, sample_rate_hz=RATE_HZ))


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
    rows += ["", f"Spurious modes a record: {spurious / len(results):.3f}", ""]
    fused = errors_of_fused(results, system)
    text = ", ".join(f"{100 * x:+.1f}" for x in fused)
    return [*rows, f"All {len(results)} records fused, error of ζ [%]: {text}", ""]


def errors_of_fused(results: list[Identification], system: ModalSystem) -> list[float]:
    fused = fuse(results)
    shapes = np.array([mode.mode_shape for mode in fused.modes])
    f = np.array([mode.frequency_hz for mode in fused.modes])
    apart = np.abs(np.log(f / FREQUENCY_HZ[:, None])) / 0.03 + 1.0 - mac(system.mode_shapes, shapes)
    return [
        fused.modes[int(j)].damping_ratio / DAMPING_RATIO[k] - 1.0
        for k, j in enumerate(np.argmin(apart, axis=1))
    ]


def main() -> None:
    n_records = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path("out/qualify/identification.md")
    lines = [f"# Automatic identification, {n_records} records of {DURATION_S:.0f} s", ""]
    cases = {
        "orthogonal pair, white forces": (0.0, 0.0),
        "pair with MAC 0.5": (0.5, 0.0),
        "forces falling as f⁻²": (0.0, 2.0),
    }
    for title, (pair_mac, slope) in cases.items():
        with ProcessPoolExecutor(2) as pool:
            work = partial(one, pair_mac=pair_mac, force_slope=slope)
            results = list(pool.map(work, range(n_records), chunksize=4))
        lines += [f"## {title}", "", *table(results, ten_modes(pair_mac, slope))]
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n".join(lines), encoding="utf-8")
    sys.stdout.write("\n".join(lines))


if __name__ == "__main__":
    main()
