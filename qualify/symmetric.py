"""Symmetric structures: poles against the full model, warm starts, cost, and names that do not change.

Bars: nothing missed or surplus; 1e-8 relative in λ; 99 % of the steps of a random walk start warm; an
evaluation costs at most 1.5 times that of the same structure with its turbine 1 m off the axis; the first
modes are fore_aft_1 and side_side_1 with weight and with a finer mesh; ``jackettwin update`` of two
parameters from four targets takes 15 CPU-seconds and ``jackettwin run`` of a twin that is given 60, on a
machine whose dense 800 × 800 ``eig`` takes 0.8.

Usage: python qualify/symmetric.py [n_sets [TWIN]]
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from common.command import arguments
from common.page import write_page

from jackettwin.decks import read_structure
from jackettwin.response.condensation.numbered_modes import Status
from jackettwin.response.condensation.pole_count import all_modes
from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.response.modes.modal import damped_modes
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, Structure, assemble
from jackettwin.updating import SupportModel, numbered_modes, support_model

DECKS = {
    "OC4 jacket, four legs": "qualify/decks/oc4_jacket.dat",
    "OC3 tripod": "qualify/decks/oc3_tripod.dat",
    "three-leg jacket": "examples/three_leg_jacket.yaml",
    "jacket15": "jacket15",
}
LAWS = {"kelvin-voigt": 16, "zener": 16, "springpot": 1}
"""Laws, and how many sets of each where a springpot, whose full model takes a second, has one."""
WALKS, STEPS = 4, 1000
"""Random walks that say how many evaluations start warm, and the sets of each."""
OFFSETS_M = (0.0, 0.01)
"""Of the turbine off the axis; one of them leaves pairs that are nearly equal."""
UNSYMMETRIC_M = 1.0
MODES = (1, 2, 3, 4)
STEEL = Rayleigh.minimum(0.005, 0.3)
STEP = 0.05
"""Of a walk, in widths of the bounds."""
SETS_AT_ONCE = 75
"""As many as a sampler asks for at once."""
SLOW_EIG_S = 0.8
UPDATE = """
structure: {structure}
gravity: true
damping: {{rayleigh: {{ratio: 0.005, frequency_hz: 0.3}}}}
support: {{tie: all}}
targets:
  - {{mode: 1, frequency_hz: {f1}, frequency_std_hz: {s1}, damping_ratio: 0.0067, damping_ratio_std: 0.002}}
  - {{mode: 4, frequency_hz: {f4}, frequency_std_hz: {s4}, damping_ratio: 0.02, damping_ratio_std: 0.004}}
"""


@dataclass(frozen=True)
class Checked:
    """One structure under one law."""

    missed: int
    surplus: int
    uncertified: int
    worst: float
    warm: float


def with_turbine(deck: str, offset_m: float) -> Structure:
    """Return a structure with its turbine a body of equal inertias, so far off the axis along x."""
    structure = read_structure(deck)
    top = structure.top_node
    turbine = max((body for body in structure.masses if body.node == top), key=lambda body: body.mass_kg)
    body = replace(turbine, cg_offset_m=(offset_m, 0.0, 1.9), inertia_kg_m2=(2.5e7, 2.5e7, 2.5e7, 0, 0, 0))
    others = tuple(body for body in structure.masses if body.node != top)
    return structure.with_masses((*others, body))


def model_of(deck: str, offset_m: float, law: str) -> SupportModel:
    assembly = assemble(with_turbine(deck, offset_m), gravity=True)
    return support_model(assembly, family=family(law), rayleigh=STEEL, highest_mode=max(MODES))


def bounds(model: SupportModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of ln θ."""
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    return low, high


def checked(model: SupportModel, n: int, rng: np.random.Generator) -> Checked:
    """Return how poles of random sets compare with the full model's, and how evaluations start."""
    missed = surplus = uncertified = 0
    worst = 0.0
    low, high = bounds(model)
    for theta in np.exp(low + (high - low) * rng.random((n, low.size))):
        points = model.points(theta[None])
        found = all_modes(model.condensed, points.rows[0], points.rayleigh[0])
        full = damped_modes(model.system(theta), below_hz=found.radius / (2.0 * np.pi)).eigenvalues
        missed += max(full.size - found.poles.size, 0)
        surplus += max(found.poles.size - full.size, 0)
        uncertified += not found.certified
        if full.size == found.poles.size and full.size:
            # poles of a pair may be nearer to one another than sorting them bears
            error = np.abs(found.poles[:, None] / full[None, :] - 1.0)
            worst = max(worst, float(error.min(axis=0).max()), float(error.min(axis=1).max()))
    warm, steps = np.sum([warm_steps(model, STEPS, rng) for _ in range(WALKS)], axis=0)
    return Checked(missed, surplus, uncertified, worst, float(warm / steps))


def warm_steps(model: SupportModel, n: int, rng: np.random.Generator) -> tuple[int, int]:
    """Return how many steps of a random walk start warm, and how many there are whose ends have the modes.

    Strong dashpots leave a mode no oscillation: a set without one is no start, and no end of a step. Nor is
    one whose count is not confirmed a start.
    """
    low, high = bounds(model)
    near, steps, warm = None, 0, 0
    z = low + (high - low) * rng.random(low.size)
    for _ in range(n):
        found = model.predict_many(np.exp(z[None]), MODES, near=near, slopes=False)
        whole = not np.isnan(found.poles).any()
        if near is not None and whole:
            steps += 1
            warm += int(found.status[0] == Status.NEIGHBOUR)
        near = found if whole and found.status[0] != Status.UNCERTIFIED else None
        z = np.clip(z + STEP * (high - low) * rng.standard_normal(low.size), low, high)
    return warm, steps


def evaluation_us(models: list[SupportModel]) -> list[float]:
    """Return the CPU time [µs] of one evaluation of each model, taken in turns: the least of twenty."""
    least = [np.inf] * len(models)
    rng = np.random.default_rng(0)
    for _ in range(20):
        for i, model in enumerate(models):
            low, high = bounds(model)
            z = low + 0.5 * (high - low)
            near = model.predict_many(np.exp(z[None]), MODES, slopes=False)
            theta = np.exp(z + 0.005 * (high - low) * rng.standard_normal((SETS_AT_ONCE, z.size)))
            start = time.process_time()
            model.predict_many(theta, MODES, near=near, slopes=False)
            least[i] = min(least[i], (time.process_time() - start) / SETS_AT_ONCE * 1e6)
    return least


def names(deck: str) -> set[tuple[str, ...]]:
    """Return the labels of the first two modes with and without weight, on either mesh."""
    found = set()
    for options in ({}, {"gravity": True}, {"subdivide": 2}, {"gravity": True, "subdivide": 2}):
        assembly = assemble(with_turbine(deck, 0.0), **options)
        modes = numbered_modes(assembly, 5)
        found.add(mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))[:2])
    return found


def command_s(*arguments: str) -> float:
    """Return the CPU-seconds of a command, its processes included."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "jackettwin", *arguments]
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "XDG_CACHE_HOME": cache}
        subprocess.run(command, check=True, capture_output=True, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def eig_s() -> float:
    """Return the CPU-seconds of a dense 800 × 800 ``eig`` here and now: the least of three."""
    matrix = np.random.default_rng(0).standard_normal((800, 800))
    least = np.inf
    for _ in range(3):
        start = time.process_time()
        np.linalg.eig(matrix)
        least = min(least, time.process_time() - start)
    return least


def update_s(deck: str) -> float:
    """Return the CPU-seconds of ``jackettwin update`` of k and c from two modes' frequency and damping."""
    model = model_of(deck, 0.0, "kelvin-voigt")
    poles = model.predict(np.array([6e8, 1.2e7]), (1, 4)).poles
    f1, f4 = np.abs(poles) / (2.0 * np.pi)
    with tempfile.TemporaryDirectory() as folder:
        twin = Path(folder) / "twin.yaml"
        structure = deck if deck == "jacket15" else Path(deck).resolve()
        twin.write_text(UPDATE.format(structure=structure, f1=f1, s1=0.003 * f1, f4=f4, s4=0.003 * f4))
        return command_s("update", str(twin), "--law", "kelvin-voigt")


def rows(n: int) -> Iterator[str]:
    """Yield a line for each structure, place of the turbine and law, of about n sets together."""
    parts = len(DECKS) * len(OFFSETS_M) * sum(LAWS.values())
    for i, (name, deck) in enumerate(DECKS.items()):
        for j, (law, share) in enumerate(LAWS.items()):
            each = max(1, round(n * share / parts))
            for k, offset in enumerate(OFFSETS_M):
                found = checked(model_of(deck, offset, law), each, np.random.default_rng((1, i, j, k)))
                yield (
                    f"| {name} | {offset:g} | {law} | {each} | {found.missed} | {found.surplus} "
                    f"| {found.uncertified} | {found.worst:.0e} | {100.0 * found.warm:.1f} % |"
                )


def costs() -> Iterator[str]:
    """Yield a line for each structure: what an evaluation and an update cost, and the names."""
    eig = eig_s()
    for name, deck in DECKS.items():
        here, beside = evaluation_us([model_of(deck, x, "kelvin-voigt") for x in (0.0, UNSYMMETRIC_M)])
        seconds = update_s(deck)
        labels = " or ".join(", ".join(pair) for pair in sorted(names(deck)))
        slow = seconds / eig * SLOW_EIG_S
        yield f"| {name} | {here:.0f} | {beside:.0f} | {here / beside:.2f} | {slow:.1f} | {labels} |"


def told(lines: Iterator[str]) -> list[str]:
    """Return the lines, each told on stderr as it comes."""
    kept = []
    for line in lines:
        print(line, file=sys.stderr, flush=True)
        kept.append(line)
    return kept


def main() -> None:
    given = arguments(__doc__, n=10_000, twin=None)
    n, twin = given.n, given.twin
    cost = told(costs())
    if twin:
        slow = command_s("run", str(twin), "--out", tempfile.mkdtemp()) / eig_s() * SLOW_EIG_S
        cost += ["", f"`jackettwin run` of the twin that was given: {slow:.0f} CPU-seconds of that machine."]
    write_page(
        "symmetric",
        [
            "# Symmetric structures",
            "",
            f"`python qualify/symmetric.py {n}{' TWIN' if twin else ''}`: structures with a turbine of equal",
            "inertias on the axis or some way off it; random supports, log-uniform over the thesis's bounds,",
            f"feet alike. Warm starts are of {WALKS} random walks of {STEPS} sets, and of their steps from",
            "one that has all the modes to another.",
            "",
            "| structure | offset [m] | law | sets | missed | surplus | uncertified | error in λ | warm |",
            "|---|---|---|---|---|---|---|---|---|",
            *told(rows(n)),
            "",
            f"One evaluation of modes {MODES} and with the turbine {UNSYMMETRIC_M:g} m off, in µs;",
            "`jackettwin update` of two parameters from four targets in CPU-seconds of a machine whose dense",
            "800 × 800 `eig` takes 0.8; the first two modes' names with and without weight, on two meshes.",
            "",
            "| structure | evaluation [µs] | unsymmetric [µs] | ratio | update [CPU-s] | names |",
            "|---|---|---|---|---|---|",
            *cost,
        ],
    )


if __name__ == "__main__":
    main()
