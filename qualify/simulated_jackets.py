"""Is what is called ok a mode of the jacket, where wind and sea force it? Simulated records of several.

Sea, wind, state of the rotor, ground, steel's damping, levels and noise of the sensors are drawn; each record
is identified as ``jackettwin identify`` does it, without a model. The sea presses on all legs at once where
its waves fit their distance: its forces have peaks between the structure's modes, narrow and steady as those
of modes. Usage: python qualify/simulated_jackets.py [n_records]
"""

from __future__ import annotations

import tempfile
from collections import Counter
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import yaml
from common.cases import Result, cases
from common.command import arguments
from common.page import write_page

from jackettwin.identification import IdentificationSettings, ModalEstimate, examine
from jackettwin.simulate import read_scenario, simulate

ROOT = Path(__file__).parents[1]
SEED = 41
JACKETS: dict[str, tuple[str, float, tuple[float, ...]]] = {
    "jacket15": ("jacket15", 72.0, (144.0, 95.0, 30.0)),
    "three-leg jacket": (str(ROOT / "examples/three_leg_jacket.yaml"), 45.0, (119.0, 70.0, 25.0)),
    "OC4 jacket": (str(ROOT / "qualify/decks/oc4_jacket.dat"), 50.0, (88.0, 55.0, 21.0)),
}
"""Structure, depth of the water [m], and levels of two sensors each above it [m]."""
TRUTH_TO_HZ = 2.9
"""True modes are known a little further."""
STEPS_APART = 0.003
"""Relative distance that a frequency may have beyond its interval: the linear model is not all that moves."""


def scenario(case: int) -> tuple[str, str, dict[str, Any]]:
    """Draw jacket, state of the rotor and scenario of a case."""
    rng = np.random.default_rng((SEED, case))
    name = list(JACKETS)[case % len(JACKETS)]
    structure, depth, heights = JACKETS[name]
    states = ("no rotor", "parked", "idling", "operating") if name == "jacket15" else ("no rotor", "parked")
    state = str(rng.choice(states))
    hs, k = rng.uniform(0.3, 4.0), 10 ** rng.uniform(8.4, 9.3)
    c = k * 10 ** rng.uniform(-2.2, -1.5)
    seeds = [int(seed) for seed in rng.integers(1_000_000, size=3)]
    sensors = [
        {
            "channel": f"acc_{h:.0f}_{axis}",
            "height_m": h,
            "direction": d,
            "noise": 10 ** rng.uniform(-4, -2.3),
        }
        for h in heights[: int(rng.integers(1, 4))]
        for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    ]
    drawn = {
        "structure": structure,
        "gravity": True,
        "support": f"kelvin-voigt:k={k:.4g},c={c:.4g}",
        "damping": {"rayleigh": {"ratio": float(rng.uniform(0.002, 0.01)), "frequency_hz": 0.3}},
        "water": {"depth_m": depth},
        "waves": {
            "type": "jonswap",
            "hs_m": float(hs),
            "tp_s": float(max(4.0, rng.uniform(3.2, 5.0) * np.sqrt(hs))),
            "direction_deg": float(rng.uniform(0.0, 360.0)),
            "spreading": 10,
            "seed": seeds[0],
        },
        "wind": {"speed_m_s": float(rng.uniform(5.0, 20.0)), "turbulence": "C", "seed": seeds[1]},
        "rotor": {"data": "none"} if state == "no rotor" else {"data": "iea15", "state": state},
        "time": {"duration_s": float(rng.choice([600.0, 1200.0]))},
        "sensors": [{**s, "noise": float(s["noise"])} for s in sensors],
        "sensor_seed": seeds[2],
    }
    return name, state, drawn


def run(case: int) -> Result:
    """Return what is said of one record, and whether the jacket has such a mode."""
    name, state, drawn = scenario(case)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scenario.yaml"
        path.write_text(yaml.safe_dump(drawn))
        record = simulate(read_scenario(str(path))).record
    true = [(m["frequency_hz"], m["damping_ratio"]) for m in record.metadata["true_modes"]]
    start = process_time()
    found = examine(record, IdentificationSettings()).identification
    seconds = process_time() - start
    modes = [judged(m, true) for m in found.modes if m.frequency_hz < TRUTH_TO_HZ]
    told = [mode["frequency_hz"] for mode in modes if mode["true"]]
    first = [any(abs(f / m - 1.0) < 0.03 for m in told) for f, _ in true[:2]]
    about = {"jacket": name, "state": state, "levels": len(drawn["sensors"]) // 2}
    return about | {"cpu_s": seconds, "modes": modes, "first_pair": first}


def judged(mode: ModalEstimate, true: list[tuple[float, float]]) -> Result:
    """Return what is said of a mode, and whether its intervals hold one of the jacket's.

    Of a pair at one frequency it is held against the one of its damping: nothing else in a record's truth
    tells which is which.
    """
    low, high = mode.frequency_interval_90 or (0.0, np.inf)
    reach = 1.5 * max(high - mode.frequency_hz, mode.frequency_hz - low)
    near = [(f, zeta) for f, zeta in true if abs(f - mode.frequency_hz) < reach + STEPS_APART * f]
    held = min(near, key=lambda t: abs(np.log(t[1] / mode.damping_ratio)), default=None)
    interval = mode.damping_ratio_interval_90
    return {
        "frequency_hz": mode.frequency_hz,
        "status": mode.status.value,
        "reasons": [finding.code for finding in mode.reasons],
        "true": held is not None,
        "damping_inside": held is not None and interval is not None and interval[0] <= held[1] <= interval[1],
    }


def row(what: str, results: list[Result]) -> str:
    """Return a line: modes called ok, how many are none, doubted ones by what they are, first pair told."""
    modes = [mode for result in results for mode in result["modes"]]
    ok = [mode for mode in modes if mode["status"] == "ok"]
    right = [mode for mode in ok if mode["true"]]
    other = Counter(mode["true"] for mode in modes if mode["status"] != "ok")
    inside = np.mean([bool(mode["damping_inside"]) for mode in right]) if right else np.nan
    told = np.mean([one for result in results for one in result["first_pair"]])
    share = len(right) / len(ok) if ok else np.nan
    return (
        f"| {what} | {len(results)} | {len(ok)} | {len(ok) - len(right)} | {100 * share:.1f} "
        f"| {100 * inside:.0f} | {other[True]} | {other[False]} | {100 * told:.0f} |"
    )


def main() -> None:
    n = arguments(__doc__, n=120).n
    results = cases("simulated_jackets", n, run, whole=True)
    rows = [row("all", results)]
    for key in ("jacket", "state", "levels"):
        for value in sorted({result[key] for result in results}):
            rows.append(
                row(f"{value} {key}" if key == "levels" else value, [r for r in results if r[key] == value])
            )
    seconds = [result["cpu_s"] for result in results]
    write_page(
        "simulated_jackets",
        [
            "# Simulated jackets",
            "",
            f"`python qualify/simulated_jackets.py {n}`: records of jackets in drawn seas, winds and states,",
            "on drawn ground, identified without a model. A mode is false (*none*) if no mode of the linear",
            f"model is within 1.5 times its interval and {100 * STEPS_APART:.1f} %. *Pair found*: the share",
            "of the first pair's modes that are reported, whatever their status.",
            "",
            "| | records | ok | none | true [%] | ζ inside [%] | doubtful: true | none | pair found [%] |",
            "|---|---|---|---|---|---|---|---|---|",
            *rows,
            "",
            f"CPU-seconds a record: median {np.median(seconds):.2f}, most {max(seconds):.2f}.",
        ],
    )


if __name__ == "__main__":
    main()
