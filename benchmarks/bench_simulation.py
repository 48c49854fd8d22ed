"""Speed of simulation: ten minutes at 100 Hz under waves, wind and a parked rotor; a set on all cores."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from time import perf_counter, process_time

from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.batch import run_set
from jackettwin.simulate.scenario.sets import read_set

CASES = 24
"""Of the 306 of dlc64: enough to tell a run's share; the whole set takes as many times longer."""


def main() -> None:
    scenario = read_scenario("parked")
    simulate(scenario)  # compiles
    best = min(simulate(scenario).wall_s for _ in range(3))
    report("ten minutes, 10 channels at 100 Hz", best, f"{600.0 / best:.0f} times real time")
    busy = process_time()
    simulate(scenario)
    busy = process_time() - busy
    report("the same, CPU time", busy, f"{600.0 / busy:.0f} times real time on a core of its own")
    chosen = read_set("dlc64")
    part = replace(chosen, cases=chosen.cases[:: len(chosen.cases) // CASES][:CASES])
    with tempfile.TemporaryDirectory() as folder:
        start = perf_counter()
        run_set(part, Path(folder))
        wall = perf_counter() - start
    report(f"{CASES} cases of dlc64 on all cores", wall, f"{wall / CASES * 324 / 60:.1f} min for 324")


def report(what: str, seconds: float, remark: str) -> None:
    sys.stdout.write(f"{what:45s} {seconds:8.2f} s   {remark}\n")


if __name__ == "__main__":
    main()
