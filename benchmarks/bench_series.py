"""Searches for free Prony series beside one for Zener's law, on the OC4 jacket.

Run by ``make bench``; prints a Markdown table. One BLAS thread; processor time, 32 starts.
The data are frequencies and damping ratios of five modes on a law of one, two or three branches; then those
of the thesis, f1, f2, f4 and ζ1, which determine no law of several branches.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from jackettwin.decks import read_structure
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Problem, Residuals, SupportModel, Target, single, support_model
from jackettwin.updating.search.solutions import search

DECK = Path(__file__).parents[1] / "qualify" / "decks" / "oc4_jacket.dat"
MODES = (1, 2, 3, 4, 5)
TRUTHS = (
    ("zener", [5e8, 1e8, 3e8]),
    ("prony-2", [5e8, 0.2, 0.5, 0.3, 8.0]),
    ("prony-2", [2e9, 0.05, 2.0, 0.4, 30.0]),
    ("prony-3", [5e8, 0.2, 3.0, 0.3, 6.0, 0.5, 6.0]),
)
LAWS = ("zener", "prony-2", "prony-3", "prony-4")


def targets(model: SupportModel, theta: list[float]) -> tuple[Target, ...]:
    exact = model.exact_modes(np.array(theta), MODES)
    values = zip(MODES, exact.frequency_hz, exact.damping_ratio, strict=True)
    return tuple(Target(m, float(f), damping_ratio=float(z)) for m, f, z in values)


def few(whole: tuple[Target, ...]) -> tuple[Target, ...]:
    first, second, _, fourth, _ = whole
    return first, *(Target(t.mode, t.frequency_hz) for t in (second, fourth))


def seconds(problem: Problem) -> float:
    start = time.process_time()
    search(problem)
    return time.process_time() - start


def main() -> None:
    oc4, steel = assemble(read_structure(DECK)), Rayleigh.minimum(0.005, 0.3)
    models = {
        law: support_model(oc4, family=family(law), rayleigh=steel, highest_mode=max(MODES)) for law in LAWS
    }
    search(
        single(models["zener"], Residuals(targets(models["zener"], TRUTHS[0][1]), relative=True)), starts=2
    )
    print("| data of | zener [CPU-s] | prony-2 | prony-3 | prony-4 |")
    print("|---|---|---|---|---|")
    known = [(f"{law} {theta}", targets(models[law], theta)) for law, theta in TRUTHS]
    known.append((f"{known[1][0]}, f1, f2, f4, ζ1", few(known[1][1])))
    for name, values in known:
        data = Residuals(values, relative=True)
        times = [seconds(single(models[other], data)) for other in LAWS]
        ratios = " | ".join(f"× {t / times[0]:.1f}" for t in times[1:])
        print(f"| {name} | {times[0]:.2f} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
