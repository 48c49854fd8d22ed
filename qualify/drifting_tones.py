"""Count how often a tone that drifts beside a mode is called a mode, without a channel of the rotor's speed.

Usage: ``python qualify/drifting_tones.py [--records 8]`` of each drift and strength, over the random systems
of ``screening.py``. The tone wanders around a frequency within two bandwidths of a mode. Interrupted runs
resume.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import product
from time import process_time

import numpy as np
from common.cases import Result, cases
from common.page import write_page
from common.planted import matched
from screening import tower

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.identification.synthetic import simulate

SEED = 5
KINDS = list(product((0.005, 0.01, 0.02, 0.05), (0.2, 0.5, 1.0)))
"""Half the range over which the tone wanders, relative; its rms over that of the channels."""


KEYS = ("frequency_inside", "damping_inside")


def run(case: int) -> Result:
    """Return what is said of a record with a tone beside a mode."""
    rng = np.random.default_rng((SEED, case))
    drift, strength = KINDS[case % len(KINDS)]
    drawn = tower(rng)
    record = simulate(drawn.system, rng, duration_s=drawn.duration_s, sample_rate_hz=drawn.sample_rate_hz)
    k = int(rng.integers(len(drawn.system.frequency_hz)))
    zeta = drawn.system.damping_ratio[k]
    middle = drawn.system.frequency_hz[k] * (1.0 + rng.uniform(-4.0, 4.0) * zeta)
    t = np.arange(record.data.shape[1]) / record.sample_rate_hz
    wander = drift * np.sin(2.0 * np.pi * t / t[-1] * rng.uniform(0.5, 2.0) + rng.uniform(0.0, 6.0))
    wave = np.sin(2.0 * np.pi * np.cumsum(middle * (1.0 + wander)) / record.sample_rate_hz)
    size = strength * np.sqrt(2.0) * record.data.std(axis=1, keepdims=True)
    size = size * rng.uniform(0.3, 1.0, size.shape)
    start = process_time()
    found = examine(replace(record, data=record.data + size * wave), IdentificationSettings()).identification
    seconds = process_time() - start
    modes = matched(found, drawn.system)
    own = {mode["mode"] for mode in modes}
    phantoms = [m.frequency_hz for i, m in enumerate(found.modes) if i not in own and m.status == "ok"]
    tones = sum("tone" in r.reason for r in found.rejected)
    return {"cpu_s": seconds, "modes": modes, "touched": k, "phantoms": phantoms, "tones": tones}


def row(name: str, results: list[Result]) -> str:
    """Return a row of the table."""
    modes = [mode for r in results for mode in r["modes"]]
    said = [mode for mode in modes if mode["status"] == "ok"]
    touched = [r["modes"][r["touched"]]["status"] or "lost" for r in results]
    cells = [
        f"{len(results)}",
        f"{sum(r['tones'] > 0 for r in results)}",
        f"{len(said) + sum(len(r['phantoms']) for r in results)}",
        f"{sum(len(r['phantoms']) for r in results)}",
        *(f"{100.0 * np.mean([m[key] for m in said]):.1f}" if said else "–" for key in KEYS),
        f"{touched.count('ok')} / {len(touched) - touched.count('ok') - touched.count('lost')} / "
        f"{touched.count('lost')}",
        f"{sum(m['findable'] and m['status'] is None for m in modes)} of {sum(m['findable'] for m in modes)}",
    ]
    return f"| {name} | " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--records", type=int, default=8)
    records = parser.parse_args().records
    results = cases("drifting_tones", records * len(KINDS), run, whole=True)
    lines = [
        "# Tones that drift close to a mode",
        "",
        f"`python qualify/drifting_tones.py --records {records}`: {records} random systems for each",
        "drift and strength, without a channel of the speed; the tone is within two bandwidths of a mode.",
        "",
        "| tone | records | tone subtracted | modes called ok | of these false | f inside [%] "
        "| ζ inside [%] | the mode close to it: ok / flagged / not reported | findable modes lost |",
        "|---" * 9 + "|",
        row("all", results),
    ]
    for drift, strength in KINDS:
        of = [r for r in results if KINDS[r["case"] % len(KINDS)] == (drift, strength)]
        lines.append(row(f"± {100 * drift:g} %, {strength:g} rms", of))
    write_page("drifting_tones", lines)


if __name__ == "__main__":
    main()
