"""Gaps that all channels share, and gusts: findings on clocks and signs that are untrue, intervals that hold.

Usage: ``python qualify/gaps_and_gusts.py [--towers 24]``, ten minutes each. The world is not the product's: a
cantilever of eight masses, with forces on every mass that are held for 10 ms, superposed exactly.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from time import process_time

import numpy as np
from common.page import write_page
from scipy import linalg, signal

from jackettwin.identification import IdentificationSettings, ModalEstimate, examine
from jackettwin.identification.mode_shapes import mac
from jackettwin.records import Channel, Record

SEED, MASSES, HEIGHT_M, FINE_HZ, RATE_HZ, DURATION_S, RUN_IN_S = 77, 8, 80.0, 100.0, 20.0, 600.0, 60.0
FIRST_HZ, APART, NOISE = 0.3, 1.03, 0.03
LEVELS = (7, 4, 2)
"""Masses that carry a sensor along each axis."""
UNTRUE = ("sign_turned", "sign_unclear", "clock_late", "clock_jump", "clock_drift", "unit", "changed")
"""Findings that these records, whose sensors and clocks are right, do not deserve."""
KINDS = {
    "whole": "nothing is missing",
    "a gap": "125 s in the middle are missing",
    "two gaps of zeros": "30 and 15 s hold the value zero",
    "a gap joined": "30 s are a straight line from end to end",
    "many gaps": "60 gaps of up to 5 s at random times",
    "gusts": "nothing is missing; five gusts of five times the usual forces, 15 s each",
}


@dataclass
class Count:
    """What is found in the records of one kind."""

    untrue: int = 0
    found: int = 0
    false: int = 0
    modes: int = 0
    inside: dict[str, list[bool]] = field(default_factory=lambda: {"f": [], "ζ": []})
    errors: list[float] = field(default_factory=list)
    seconds: float = 0.0


def tower(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return heights [m], frequencies [Hz], damping ratios and shapes (modes, masses × axes)."""
    x = np.linspace(HEIGHT_M / MASSES, HEIGHT_M, MASSES)
    low, high = np.minimum.outer(x, x), np.maximum.outer(x, x)
    mass = np.ones(MASSES)
    mass[-1] = 6.0  # a nacelle
    squares, shapes = linalg.eigh(np.linalg.inv(low**2 * (3.0 * high - low) / 6.0), np.diag(mass))
    f = FIRST_HZ * np.sqrt(squares / squares[0])
    own = np.concatenate([f, APART * f])
    along = np.concatenate([np.kron(shapes.T, axis) for axis in np.eye(2)])
    return x, own, 0.01 * (1.0 + 0.15 * rng.standard_normal(len(own))), along


def motion(rng: np.random.Generator, f: np.ndarray, zeta: np.ndarray, phi: np.ndarray, *, gusts: bool):
    """Return accelerations (masses × axes, samples) at ``FINE_HZ`` under forces held for a step."""
    n = round((RUN_IN_S + DURATION_S) * FINE_HZ)
    t = np.arange(n) / FINE_HZ - RUN_IN_S
    force = rng.standard_normal((phi.shape[1], n))
    if gusts:
        force *= 0.4 + 2.0 * sum(np.exp(-(((t - at) / 15.0) ** 2)) for at in rng.uniform(0.0, DURATION_S, 5))
    out = np.zeros_like(force)
    for f_i, zeta_i, phi_i in zip(f, zeta, phi, strict=True):
        if f_i > 0.45 * FINE_HZ:
            continue
        w = 2.0 * np.pi * f_i
        a, b = np.array([[0.0, 1.0], [-(w**2), -2.0 * zeta_i * w]]), np.array([[0.0], [1.0]])
        held = linalg.expm(np.block([[a, b], [np.zeros((1, 3))]]) / FINE_HZ)
        top, bottom = signal.ss2tf(held[:2, :2], held[:2, 2:], a[1:], np.ones((1, 1)))
        out += np.outer(phi_i, signal.lfilter(top[0], bottom, phi_i @ force))
    return out[:, round(RUN_IN_S * FINE_HZ) :]


def spoilt(y: np.ndarray, kind: str, rng: np.random.Generator) -> np.ndarray:
    """Return the samples (n_channels, n_samples) with the gaps of a kind."""
    out = y.copy()
    if kind == "a gap":
        out[:, 5000:7500] = np.nan
    elif kind == "two gaps of zeros":
        out[:, 5000:5600] = out[:, 8000:8300] = 0.0
    elif kind == "a gap joined":
        out[:, 5000:5600] = np.linspace(y[:, 5000], y[:, 5599], 600, axis=1)
    elif kind == "many gaps":
        for start, length in zip(
            rng.integers(0, y.shape[1] - 200, 60), rng.integers(5, 100, 60), strict=True
        ):
            out[:, start : start + length] = np.nan
    return out


def one(kind: str, seed: int, count: Count) -> None:
    """Add what is found in one record."""
    rng = np.random.default_rng([SEED, seed])
    x, f, zeta, phi = tower(rng)
    y = signal.resample_poly(
        motion(rng, f, zeta, phi, gusts=kind == "gusts"), 1, round(FINE_HZ / RATE_HZ), axis=1
    )
    rows = [2 * level + axis for level in LEVELS for axis in (0, 1)]
    y = y[rows] + NOISE * y[rows].std(axis=1, keepdims=True) * rng.standard_normal((len(rows), y.shape[1]))
    channels = tuple(
        Channel(f"{'xy'[axis]}{x[level]:.0f}", height_m=x[level], direction=(1.0 - axis, float(axis), 0.0))
        for level in LEVELS
        for axis in (0, 1)
    )
    started = process_time()
    seen = examine(Record(spoilt(y, kind, rng), RATE_HZ, channels), IdentificationSettings())
    count.seconds += process_time() - started
    count.untrue += sum(finding.code in UNTRUE for finding in seen.quality.findings)
    low, high = (
        seen.identification.settings.lowest_frequency_hz,
        seen.identification.settings.highest_frequency_hz,
    )
    ok = [m for m in seen.identification.modes if m.status == "ok"]
    true = [k for k in np.argsort(f) if low < f[k] < high]
    count.modes += len(true)
    for k in true:
        near = [
            m
            for m in ok
            if abs(np.log(m.frequency_hz / f[k])) < 0.03 and mac(m.mode_shape, phi[k, rows]) > 0.6
        ]
        if near:
            best = min(near, key=lambda m: abs(m.frequency_hz - f[k]))
            ok.remove(best)
            judge(best, f[k], zeta[k], count)
    count.false += len(ok)


def judge(mode: ModalEstimate, f: float, zeta: float, count: Count) -> None:
    """Add whether the intervals of a true mode contain the truth."""
    count.found += 1
    for name, value, interval in (
        ("f", f, mode.frequency_interval_90),
        ("ζ", zeta, mode.damping_ratio_interval_90),
    ):
        assert interval is not None
        count.inside[name].append(interval[0] <= value <= interval[1])
    count.errors.append(float(np.log(mode.damping_ratio / zeta)))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--towers", type=int, default=24)
    number = parser.parse_args().towers
    lines = [
        "# Gaps and gusts",
        "",
        f"`python qualify/gaps_and_gusts.py --towers {number}`: {number} cantilevers with close pairs at",
        "0.3 and 2.8 Hz, six sensors at three levels, ten minutes each; sensors and clocks are right.",
        "*Untrue*: findings on clocks, signs, units and changes of a sensor. *Ok*: true modes in the band",
        "that are found and `ok`; the 90 % intervals are theirs. *False*: further modes that are `ok`.",
        "Error: rms of ln ζ.",
        "",
        "| record | untrue | ok | false | f inside [%] | ζ inside [%] | error of ln ζ | CPU-s a record |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind, words in KINDS.items():
        count = Count()
        for seed in range(number):
            one(kind, seed, count)
        inside = " | ".join(f"{100.0 * np.mean(of):.0f}" for of in count.inside.values())
        lines.append(
            f"| {kind}: {words} | {count.untrue} | {count.found} of {count.modes} | {count.false} | {inside} "
            f"| {np.sqrt(np.mean(np.square(count.errors))):.2f} | {count.seconds / number:.2f} |"
        )
        print(lines[-1], flush=True)
    write_page("gaps_and_gusts", lines)


if __name__ == "__main__":
    main()
