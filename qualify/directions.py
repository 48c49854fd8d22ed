"""By how much a model that misses frequencies misses what causes do to them.

Usage: python qualify/directions.py [structures a jacket]

The truth is a jacket whose legs, braces by height, tower and masses differ from the model's, or each member
by itself, and whose feet differ from each other. The model is fitted to its frequencies as the watch does it.
What is missed of a cause's direction, whatever its size, is set beside what the watch takes its error to be:
of each mode by itself and of modes that are mixed otherwise. As there, modes that a cause may turn into
members' own are left out.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from common.command import arguments
from common.page import write_page
from diagnosis import jackets, planted, truth

from jackettwin.change.causes import _KEPT, _MISSES
from jackettwin.change.changed_structures import Happening, Standing
from jackettwin.change.event_effects import effect, mixing
from jackettwin.change.fitted_feet import fitted_feet
from jackettwin.change.standing_modes import MODES, Modes
from jackettwin.response.modes.labels import LOCAL
from jackettwin.structure import Assembly, Material, Structure, assemble
from jackettwin.watching.causes import MISFIT

SPREADS = (0.01, 0.02, 0.04, 0.08)
"""Standard deviations of ln of stiffness and mass, group by group or member by member."""
MODES_SEEN, FEWEST = 5, 3
"""Largest number of modes that are compared, and the smallest."""
ZETA = np.full(MODES, 0.01)


def other(structure: Structure, spread: float, rng: np.random.Generator, *, alone: bool) -> Structure:
    """Return the structure with other stiffness and mass of groups or members, and another mass on top."""
    low, high = (f(z for _, _, z in structure.nodes.values()) for f in (min, max))
    drawn: dict[Any, np.ndarray] = {}
    members = []
    for m in structure.members:
        a, b = (np.array(structure.nodes[n]) for n in (m.start, m.end))
        climbs = abs((b - a)[2]) > 0.9 * np.linalg.norm(b - a)
        key = bool(climbs), bool(np.hypot(*a[:2]) < 1.0), int(5 * (0.5 * (a + b)[2] - low) / (high - low))
        stiff, heavy = drawn.setdefault(m.name if alone else key, np.exp(spread * rng.standard_normal(2)))
        steel = Material(
            m.material.youngs_modulus_pa * stiff, m.material.shear_modulus_pa * stiff,
            m.material.density_kg_m3 * heavy,
        )  # fmt: skip
        members.append(replace(m, material=steel))
    masses = [
        replace(m, mass_kg=m.mass_kg * np.exp(0.5 * spread * rng.standard_normal())) for m in structure.masses
    ]
    return replace(structure, members=tuple(members)).with_masses(tuple(masses))


def direction(event: Happening, standing: Standing, base: Modes) -> tuple[np.ndarray, Modes]:
    """Return what an event does to ln f of all modes, and these after it."""
    after = event.apply(standing)
    there = Modes.of(after, assemble(after.structure, gravity=True), like=base)
    return effect(event, base, there, 0.08, ZETA)[:MODES], there


def missed(
    model: Standing, assembly: Assembly, named: Modes, spread: float, rng: np.random.Generator, *, alone: bool
) -> tuple[float, list[tuple[float, float]]]:
    """Return the model's error, and of each cause what is missed over its length and over what is stated.

    The last is the root mean square of what is missed, whatever the size, in stated standard deviations.
    """
    structure = other(model.structure, spread, rng, alone=alone)
    standing = truth(structure, rng)
    there = Modes.of(standing, assemble(structure, gravity=True), like=named)
    whole = [i for i, label in enumerate(named.labels) if not label.startswith(LOCAL)]
    feet = fitted_feet(model, named, whole, there.modes.frequency_hz[whole], assembly)
    best, error = feet.best(model), feet.error
    base = Modes.of(best, assembly, like=named)
    out = []
    for event in planted(model.structure):
        if event.family == "scour at one foot":
            continue
        (seen, after), (true, truly) = direction(event, best, base), direction(event, standing, there)
        kept = [i for i in whole if min(after.kept[i], truly.kept[i]) >= _KEPT][:MODES_SEEN]
        if len(kept) < FEWEST:
            continue
        mixed = mixing(event, base, after, error)[:, kept]
        seen, true = seen[kept], true[kept]
        misfit = min(_MISSES * error, MISFIT) * np.sqrt(np.mean(seen**2))
        known = np.linalg.inv(misfit**2 * np.eye(len(kept)) + mixed.T @ mixed)
        left = true @ known @ true - (seen @ known @ true) ** 2 / (seen @ known @ seen)
        off = true - seen * (true @ seen) / (seen @ seen)
        out.append((float(np.sqrt(off @ off / (true @ true))), float(np.sqrt(left / (len(kept) - 1)))))
    return error, out


def main() -> None:
    number = arguments(__doc__, number=8).number
    lines = [
        "# Directions of causes",
        "",
        f"`python qualify/directions.py {number}`: effect of causes on frequencies, in jackets whose legs,",
        "braces, tower and masses differ from the model's, group by group or each member by itself, and",
        "whose feet differ from each other, compared with the model after its fit to their frequencies.",
        "Error: the model's frequency error that the watch assumes (residual of the fit, with a prior of 1 %",
        "worth one mode). Missed: of a direction, whatever its size, as a share of its length. Over stated:",
        f"rms of that in the standard deviations that the watch states: {_MISSES:g} times the error of each",
        "mode by itself, and of modes that are mixed otherwise. Medians.",
        "",
        "| jacket | differ by | error | missed | missed over stated |",
        "|---|---|---|---|---|",
    ]
    ratios: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        for jacket, (structure, _) in jackets(Path(folder)).items():
            rng = np.random.default_rng(41)
            stiff = np.full(len(structure.reaction_nodes), 2.5e9)
            model, assembly = Standing(structure, stiff, stiff), assemble(structure, gravity=True)
            named = Modes.of(model, assembly)
            for alone in (False, True):
                for spread in SPREADS:
                    found = [missed(model, assembly, named, spread, rng, alone=alone) for _ in range(number)]
                    error = np.median([one for one, _ in found])
                    share, over = np.median(np.concatenate([each for _, each in found]), axis=0)
                    ratios += [ratio for _, each in found for _, ratio in each]
                    who = "each member" if alone else "groups"
                    lines.append(
                        f"| {jacket} | {who} {100 * spread:.0f} % | {100 * error:.2f} % | "
                        f"{100 * share:.1f} % | {over:.1f} |"
                    )
                    sys.stderr.write(lines[-1] + "\n")
    middle, most = np.quantile(ratios, [0.68, 0.9])
    within, thrice = (100 * np.mean(np.array(ratios) < times) for times in (1.0, 3.0))
    lines += [
        "",
        f"Of {len(ratios)}, 68 % are missed by less than {middle:.1f} times what is stated, 90 % by less",
        f"than {most:.1f} times: {within:.0f} % within it, {thrice:.0f} % within three times it, where the",
        "diagnosis has 68 % and 90 %.",
    ]
    write_page("directions", lines)


if __name__ == "__main__":
    main()
