"""Do intervals hold over systems, not over one? Records of many random systems of known truth.

Usage: ``python qualify/random_systems.py [--systems 320] [--records 1]``. What is drawn anew for every
system: channels, modes, sample rate, length, noise, damping, spacing, colour and rank of the forces.
Interrupted runs resume.
"""

from __future__ import annotations

import argparse
from functools import partial
from time import process_time

import numpy as np
from common.cases import Result, cases
from common.pace import eigenvalue_seconds
from common.page import write_page
from common.planted import RandomSystem, matched, random_system

from jackettwin.identification import identify
from jackettwin.identification.synthetic import simulate

SEED = 13
FEWEST = 60
"""Intervals a class must have to be judged."""
CLASSES = {
    "channels": (2, 4, 8, 13),
    "modes": (2, 4, 7, 11),
    "cycles of the first mode": (0, 150, 400, 3000),
    "noise [%]": (0, 2, 8, 31),
    "damping [%]": (0.2, 0.8, 2.0, 6.1),
    "nearest mode [half bandwidths]": (0, 3, 10, 1000),
    "exponent of the forces": (-0.1, 0.7, 2.0, 3.1),
    "rank of the forces": (0, 2, 4, 11),
    "samples a second over the highest mode": (2, 4, 8, 100),
}


def run(case: int, systems: int) -> Result:
    """Return what is identified in a record of a system: first one of each, then the next of each."""
    drawn = random_system(np.random.default_rng((SEED, case % systems)))
    rng = np.random.default_rng((SEED, case % systems, case // systems))
    record = simulate(drawn.system, rng, duration_s=drawn.duration_s, sample_rate_hz=drawn.sample_rate_hz)
    start = process_time()
    try:
        found = identify(record)
    except Exception as error:
        return {"stopped": repr(error)}
    seconds = process_time() - start
    pairs = matched(found, drawn.system)
    own = {pair["mode"] for pair in pairs if pair["mode"] is not None}
    others = [
        {"frequency_hz": m.frequency_hz, "status": m.status}
        for k, m in enumerate(found.modes)
        if k not in own
    ]
    features = [features_of(drawn, k) for k in range(len(pairs))]
    return {
        "cpu_s": seconds,
        "modes": [a | b for a, b in zip(pairs, features, strict=True)],
        "others": others,
        "band_hz": [found.settings.lowest_frequency_hz, found.settings.highest_frequency_hz],
    }


def features_of(drawn: RandomSystem, k: int) -> Result:
    """Return what a mode is classed by."""
    s = drawn.system
    f, zeta = s.frequency_hz, s.damping_ratio
    apart = np.delete(np.abs(f - f[k]), k) / (zeta[k] * f[k])
    return {
        "channels": s.mode_shapes.shape[1],
        "modes": len(f),
        "cycles of the first mode": float(f[0] * drawn.duration_s),
        "noise [%]": 100.0 * s.noise_ratio,
        "damping [%]": float(100.0 * zeta[k]),
        "nearest mode [half bandwidths]": float(apart.min()),
        "exponent of the forces": s.force_slope,
        "rank of the forces": drawn.rank,
        "samples a second over the highest mode": float(drawn.sample_rate_hz / f[-1]),
    }


def share(inside: list[bool]) -> str:
    return f"{100.0 * np.mean(inside):.1f} ({len(inside)})" if inside else "–"


def row(name: str, modes: list[Result], which: tuple[str, ...] = ("ok",)) -> str:
    """Return a row of the table: coverage of f and ζ of what has one of the statuses."""
    said = [m for m in modes if m["status"] in which]
    damping = [m["damping_inside"] for m in said if m["damping_inside"] is not None]
    clear = [m for m in modes if m["findable"]]
    lost = np.mean([m["status"] is None for m in clear]) if clear else 0.0
    scatter = np.sqrt(np.mean(np.square([m["damping_z"] for m in said]))) if said else np.nan
    frequency = share([m["frequency_inside"] for m in said])
    return f"| {name} | {len(modes)} | {frequency} | {share(damping)} | {scatter:.2f} | {100 * lost:.1f} |"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--systems", type=int, default=320)
    parser.add_argument("--records", type=int, default=1)
    n, records = vars(parser.parse_args()).values()
    results = cases("random_systems", n * records, partial(run, systems=n), part=f"-{n}", whole=True)
    stopped = [r for r in results if "stopped" in r]
    results = [r for r in results if "stopped" not in r]
    modes = [m for r in results for m in r["modes"]]
    false = sum(o["status"] == "ok" for r in results for o in r["others"])
    ok = sum(m["status"] == "ok" for m in modes)
    head = (
        "| class | true modes | f inside [%] | ζ inside [%] | rms error of ln ζ / std | findable lost [%] |"
    )
    lines = [
        "# Intervals over random systems",
        "",
        f"`python qualify/random_systems.py --systems {n} --records {records}`: each of {n} random systems "
        f"{records} times; modes that are `ok`, their number in brackets.",
        "",
        head,
        "|---" * 6 + "|",
        row("all", modes),
        row("all, and doubtful", modes, ("ok", "doubtful", "damping unknown")),
    ]
    for name, edges in CLASSES.items():
        for low, high in zip(edges[:-1], edges[1:], strict=True):
            lines.append(row(f"{name} {low:g} to {high:g}", [m for m in modes if low <= m[name] < high]))
    cpu = [r["cpu_s"] for r in results]
    lines += [
        "",
        f"Stopped: {len(stopped)}. Called ok: {ok + false}, of which no mode: {false}. "
        f"CPU-seconds a record: median {np.median(cpu):.2f}, most {max(cpu):.2f}, "
        f"where a dense 800 × 800 eigenvalue problem takes {eigenvalue_seconds():.2f}.",
    ]
    write_page("random_systems", lines)


if __name__ == "__main__":
    main()
