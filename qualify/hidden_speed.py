"""Orders of a rotor whose speed no channel tells: what fused records say of them, and of the modes.

Usage: ``python qualify/hidden_speed.py [--turbines 2]`` of each kind, eight records of ten minutes each, of
six channels and of two. The orders are random within a per cent or so of three and six times the speed, as
turbulence is that the blades cut.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace

import numpy as np
from common.page import write_page

from jackettwin.identification import FusedMode, fuse, identify
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

SEED, RECORDS, RATE_HZ = 31, 8, 10.0
KINDS = {
    "operating, 8.5 to 11 rpm": (8.5, 11.0, 0.0),
    "operating, half of the time at 10 rpm": (8.0, 10.0, 0.5),
    "idling, 1.5 to 5 rpm": (1.5, 5.0, 0.0),
    "parked, no orders": None,
}
"""Range of the speed [rpm], and the share of records at its upper end."""
CHANNELS = {"six": slice(None), "two": slice(2)}
"""At three levels of the tower, or at its top alone, along both axes."""


def peak(rng: np.random.Generator, n: int, middle_hz: float, width: float) -> np.ndarray:
    """Return a random process of unit variance around a frequency, part of a longer one: it has two ends."""
    lines = np.fft.rfftfreq(2 * n, 1.0 / RATE_HZ)
    drawn = rng.standard_normal(lines.size) + 1j * rng.standard_normal(lines.size)
    x = np.fft.irfft(drawn * np.exp(-0.5 * ((lines - middle_hz) / (width * middle_hz)) ** 2), 2 * n)[:n]
    return np.asarray(x / x.std())


def tower(rng: np.random.Generator) -> ModalSystem:
    shapes = np.kron(np.array([[1.0, 0.55, 0.2], [-0.5, 1.0, 0.8]]), np.eye(2))
    first, second = rng.uniform(0.26, 0.34), rng.uniform(1.2, 1.6)
    f = np.array([first, 1.02 * first, second, 1.05 * second])
    return ModalSystem(f, rng.uniform(0.008, 0.016, 4), shapes, np.diag([1.0, 1.0, 0.3, 0.3]))


def record(rng: np.random.Generator, system: ModalSystem, speed_hz: float | None) -> Record:
    made = simulate(system, rng, duration_s=600.0, sample_rate_hz=RATE_HZ)
    if speed_hz is None:
        return made
    n, rms, one, two = made.data.shape[1], made.data.std(), system.mode_shapes[0], system.mode_shapes[3]
    width = rng.uniform(0.008, 0.02)
    third = 0.6 * np.outer(one + 0.3 * two, peak(rng, n, 3.0 * speed_hz, width))
    sixth = 0.4 * np.outer(0.3 * one + 0.9 * two, peak(rng, n, 6.0 * speed_hz, width))
    return replace(made, data=made.data + rms * (third + sixth))


def turbine(kind: str, channels: str, seed: int) -> tuple[list[int], list[int], list[int]]:
    """Return numbers of (modes, no modes): single ok estimates, fused ones held for modes, fused others."""
    rng = np.random.default_rng([SEED, list(KINDS).index(kind), seed])
    system, limits = tower(rng), KINDS[kind]
    found = []
    for _ in range(RECORDS):
        speed = None
        if limits is not None:
            speed = (limits[1] if rng.random() < limits[2] else rng.uniform(*limits[:2])) / 60.0
        made, few = record(rng, system, speed), CHANNELS[channels]
        found.append(identify(replace(made, data=made.data[few], channels=made.channels[few])))
    single = [m.frequency_hz for one in found for m in one.modes if m.status == "ok"]
    fused = fuse(found).modes
    held = [m.frequency_hz for m in fused if m.status.is_a_mode]
    others: list[FusedMode] = [m for m in fused if not m.status.is_a_mode]
    return tuple(_split(f, system) for f in (single, held, [m.frequency_hz for m in others]))  # type: ignore[return-value]


def _split(found_hz: list[float], system: ModalSystem) -> list[int]:
    true = [np.min(np.abs(np.log(f / system.frequency_hz))) < 0.015 for f in found_hz]
    return [sum(true), len(true) - sum(true)]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--turbines", type=int, default=2)
    number = parser.parse_args().turbines
    lines = [
        "# A rotor whose speed is not measured",
        "",
        f"`python qualify/hidden_speed.py --turbines {number}`: {number} towers of two close pairs of each",
        f"kind, {RECORDS} records of ten minutes; 3P and 6P random within 0.8 to 2 % of themselves. Four",
        "modes a tower are to be found. In every column: true modes / false modes.",
        "",
        "| rotor | channels | ok in single records | fused and taken as a mode | fused and taken as none |",
        "|---|---|---|---|---|",
    ]
    for channels in CHANNELS:
        for kind in KINDS:
            total = np.sum([turbine(kind, channels, seed) for seed in range(number)], axis=0)
            lines.append(f"| {kind} | {channels} | " + " | ".join(f"{a} / {b}" for a, b in total) + " |")
            sys.stderr.write(lines[-1] + "\n")
    write_page("hidden_speed", lines)


if __name__ == "__main__":
    main()
