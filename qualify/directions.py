"""By how much a model that misses frequencies misses what causes do to them.

Usage: python qualify/directions.py [structures a jacket]

The truth is a jacket whose legs, braces by height, tower and masses differ from the model's, and whose feet
differ from each other. The model is fitted to its frequencies as the watch does it. What is missed of a
cause's direction, whatever its size, is set beside what the watch takes the model's error to be.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from common.command import arguments
from common.page import write_page
from diagnosis import jackets, planted, truth

from jackettwin.change.causes import _ONE_SIZE, effect, standings
from jackettwin.change.changed_structures import Happening, Standing
from jackettwin.change.standing_modes import MODES, Modes
from jackettwin.response.modes.labels import LOCAL
from jackettwin.structure import Assembly, Material, Structure, assemble

SPREADS = (0.01, 0.02, 0.04, 0.08)
"""Standard deviations of ln of stiffness and mass, group by group."""
ZETA = np.full(MODES, 0.01)


def other(structure: Structure, spread: float, rng: np.random.Generator) -> Structure:
    """Return the structure with other stiffness and mass by group of members, and another mass on top."""
    low, high = (f(z for _, _, z in structure.nodes.values()) for f in (min, max))
    drawn: dict[tuple[bool, bool, int], np.ndarray] = {}
    members = []
    for m in structure.members:
        a, b = (np.array(structure.nodes[n]) for n in (m.start, m.end))
        climbs = abs((b - a)[2]) > 0.9 * np.linalg.norm(b - a)
        key = bool(climbs), bool(np.hypot(*a[:2]) < 1.0), int(5 * (0.5 * (a + b)[2] - low) / (high - low))
        stiff, heavy = drawn.setdefault(key, np.exp(spread * rng.standard_normal(2)))
        steel = Material(
            m.material.youngs_modulus_pa * stiff, m.material.shear_modulus_pa * stiff,
            m.material.density_kg_m3 * heavy,
        )  # fmt: skip
        members.append(replace(m, material=steel))
    masses = [
        replace(m, mass_kg=m.mass_kg * np.exp(0.5 * spread * rng.standard_normal())) for m in structure.masses
    ]
    return replace(structure, members=tuple(members)).with_masses(tuple(masses))


def direction(event: Happening, standing: Standing, base: Modes) -> np.ndarray:
    after = event.apply(standing)
    there = Modes.of(after, assemble(after.structure, gravity=True), like=base)
    return effect(event, base, there, 0.08, ZETA)[:MODES]


def missed(
    model: Standing, assembly: Assembly, named: Modes, spread: float, rng: np.random.Generator
) -> dict[str, float]:
    """Return what is missed of each cause's direction, root mean square over its length, and the error."""
    structure = other(model.structure, spread, rng)
    standing = truth(structure, rng)
    there = Modes.of(standing, assemble(structure, gravity=True), like=named)
    whole = [i for i, label in enumerate(named.labels) if not label.startswith(LOCAL)]
    _, best, error = standings(model, named, whole, there.modes.frequency_hz[whole], assembly, rng)
    base = Modes.of(best, assembly, like=named)
    out = {"": error}
    for event in planted(model.structure):
        if event.spread > _ONE_SIZE and event.family != "scour at one foot":
            seen = direction(event, best, base)[whole]
            true = direction(event, standing, there)[whole]
            off = true - seen * (true @ seen) / (seen @ seen)
            out[event.family] = float(np.sqrt(off @ off / (true @ true)))
    return out


def main() -> None:
    number = arguments(__doc__, number=8).number
    lines = [
        "# Directions of causes",
        "",
        f"`python qualify/directions.py {number}`: effect of causes on frequencies, in jackets whose legs,",
        "braces, tower and masses differ from the model's, group by group, and whose feet differ from each",
        "other, compared with the model after its fit to their frequencies. Missed: rms error over modes,",
        "as a share of the direction's length, independent of the size. Error: the model's frequency error",
        "that the watch assumes (residual of the fit, with a prior of 1 % worth one mode). Medians.",
        "",
        "| jacket | groups differ by | error | missed | missed over error |",
        "|---|---|---|---|---|",
    ]
    ratios: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        for jacket, (structure, _) in jackets(Path(folder)).items():
            rng = np.random.default_rng(41)
            stiff = np.full(len(structure.reaction_nodes), 2.5e9)
            model, assembly = Standing(structure, stiff, stiff), assemble(structure, gravity=True)
            named = Modes.of(model, assembly)
            for spread in SPREADS:
                found = [missed(model, assembly, named, spread, rng) for _ in range(number)]
                error = np.array([one.pop("") for one in found])
                off = np.array([list(one.values()) for one in found])
                ratios += list((off / error[:, None]).ravel())
                lines.append(
                    f"| {jacket} | {100 * spread:.0f} % | {100 * np.median(error):.2f} % | "
                    f"{100 * np.median(off):.1f} % | {np.median(off / error[:, None]):.1f} |"
                )
                sys.stderr.write(lines[-1] + "\n")
    middle, most = np.quantile(ratios, [0.68, 0.9])
    lines += [
        "",
        f"Of all, 68 % are missed by less than {middle:.1f} times the error, 90 % by less than {most:.1f}.",
    ]
    write_page("directions", lines)


if __name__ == "__main__":
    main()
