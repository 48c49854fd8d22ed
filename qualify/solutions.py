"""Twenty planted problems: every solution, the same list from five seeds, locked dampers flagged.

Usage: python qualify/solutions.py [n_problems]
"""

from __future__ import annotations

import time

import numpy as np
from common.cases import Result, cases
from common.command import arguments
from common.page import write_page

from jackettwin.decks import read_structure
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Residuals, SupportModel, Target, single, support_model
from jackettwin.updating.search.solutions import LOCKED_DAMPER, Search, search

MODES = (1, 2, 4)
SEEDS = range(5)
LAWS = {
    "kelvin-voigt": ((5e8, 1e8), (1e10, 5e9)),
    "zener": ((5e8, 1e8, 5e8), (1e10, 1e11, 2e10)),
    "maxwell-3": ((5e8, 0.02), (1e10, 0.5)),
}
ORDER = ("kelvin-voigt", "zener", "zener", "maxwell-3")


def targets(which: int, f: np.ndarray, zeta: np.ndarray) -> tuple[Target, ...]:
    """Return f1, f2, f4, ζ1; the frequencies alone; or f1, f4, ζ1, ζ4."""
    if which == 0:
        return (Target(1, f[0], damping_ratio=zeta[0]), Target(2, f[1]), Target(4, f[2]))
    if which == 1:
        return (Target(1, f[0]), Target(2, f[1]), Target(4, f[2]))
    return (Target(1, f[0], damping_ratio=zeta[0]), Target(4, f[2], damping_ratio=zeta[2]))


def same(a: Search, b: Search) -> bool:
    """Return whether two lists name the same solutions: within 2 %, or inside each other's extent."""
    if len(a.solutions) != len(b.solutions):
        return False
    return all(
        any(
            np.abs(np.log(x.theta / y.theta)).max() < 0.02
            or ((y.extent[:, 0] <= x.theta * 1.02) & (x.theta <= y.extent[:, 1] * 1.02)).all()
            for y in b.solutions
        )
        for x in a.solutions
    )


def planted(found: Search, truth: np.ndarray) -> bool:
    """Return whether the truth is on the list, as a point or inside a valley."""
    return any(
        np.abs(np.log(s.theta / truth)).max() < 0.02
        or ((s.extent[:, 0] <= truth * 1.02) & (truth <= s.extent[:, 1] * 1.02)).all()
        for s in found.solutions
    )


def unflagged(model: SupportModel, found: Search) -> int:
    """Return how many unflagged solutions have an undamped frequency more than 5 % off."""
    wrong = 0
    for s in found.solutions:
        exact = model.exact_modes(s.theta, MODES)
        apart = np.abs(exact.undamped_hz / exact.frequency_hz - 1.0)
        wrong += bool((apart > LOCKED_DAMPER + 1e-4).any()) and not (s.locked_damper or s.locks_within)
    return wrong


def planted_problem(models: dict[str, SupportModel], case: int) -> Result:
    """Return what the search makes of one problem from every seed."""
    law, which = ORDER[case % 4], case // 4 % 3
    rng = np.random.default_rng((2026, case))
    truth = np.exp(rng.uniform(*np.log(LAWS[law])))
    poles = models[law].predict(truth, MODES).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    problem = single(models[law], Residuals(targets(which, f, zeta), relative=True))
    found, seconds = [], []
    for seed in SEEDS:
        start = time.process_time()
        found.append(search(problem, seed=seed))
        seconds.append(time.process_time() - start)
    row = (
        law,
        ("f1 f2 f4 ζ1", "f1 f2 f4", "f1 f4 ζ1 ζ4")[which],
        len(found[0].solutions),
        sum(s.locked_damper for s in found[0].solutions),
        sum(planted(f, truth) for f in found),
        sum(same(found[0], f) for f in found),
        sum(unflagged(models[law], f) for f in found),
        f"{max(seconds):.0f} s",
    )
    return {"row": row, "slowest": max(seconds), "cpu_s": sum(seconds)}


def main() -> None:
    number = arguments(__doc__, number=20).number
    assembly = assemble(read_structure("jacket15"))
    steel = Rayleigh.minimum(0.0055, 0.1832)
    models = {law: support_model(assembly, family=family(law), rayleigh=steel) for law in LAWS}
    found = cases("solutions", number, lambda case: planted_problem(models, case))
    write_page(
        "solutions",
        [
            "# Every solution",
            "",
            f"`python qualify/solutions.py {number}`: random true parameters, whose modes are the targets",
            "(relative cost), the search from five seeds with its default settings.",
            f"A search takes {np.mean([r['cpu_s'] for r in found]) / len(SEEDS):.1f} CPU-s in the mean,",
            f"{max(r['slowest'] for r in found):.1f} CPU-s at most.",
            "",
            "| law | targets | solutions | locked | truth listed, of 5 | same list, of 5 | unflagged, wrong "
            "| slowest search |",
            "|---|---|---|---|---|---|---|---|",
            *("| " + " | ".join(map(str, r["row"])) + " |" for r in found),
        ],
    )


if __name__ == "__main__":
    main()
