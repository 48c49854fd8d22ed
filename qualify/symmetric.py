"""Symmetric jackets: all poles of random supports against the full model, and how evaluations start.

Bars: nothing missed or surplus; 1e-8 relative in λ; 99 % of the steps of a random walk start warm.

Usage: python qualify/symmetric.py [n_sets]
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from common.page import write_page

from jackettwin.response.certified import all_modes
from jackettwin.response.modal import damped_modes
from jackettwin.response.numbered import Status
from jackettwin.structure import Assembly, Rayleigh, assemble, read_structure
from jackettwin.updating import SupportModel, family, support_model

DECK = "qualify/decks/oc4_jacket.dat"
OFFSETS_M = (0.0, 0.01, 0.1, 1.0)
LAWS = ("kelvin-voigt", "zener", "springpot")
MODES = (1, 2, 3, 4)
STEP = 0.05
"""Of a walk, in widths of the bounds."""


def symmetric(offset_m: float) -> Assembly:
    """Return the OC4 jacket with one body of equal inertias on its top, so far off the axis along x."""
    structure = read_structure(DECK)
    top = structure.top_node
    own = [body for body in structure.masses if body.node == top]
    body = replace(
        own[0], cg_offset_m=(offset_m, 0.0, 1.9), inertia_kg_m2=(2.5e7, 2.5e7, 2.5e7, 0.0, 0.0, 0.0)
    )
    others = tuple(body for body in structure.masses if body.node != top)
    return assemble(structure.with_masses((*others, body)), gravity=True)


def against_full_model(model: SupportModel, n: int, rng: np.random.Generator) -> tuple[int, int, int, float]:
    """Return how many poles are missed and surplus, how many sets uncertified, and the largest error."""
    missed = surplus = uncertified = 0
    worst = 0.0
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    for theta in np.exp(low + (high - low) * rng.random((n, low.size))):
        points = model.points(theta[None])
        found = all_modes(model.condensed, points.rows[0], points.rayleigh[0])
        full = damped_modes(model.system(theta), below_hz=found.radius / (2.0 * np.pi)).eigenvalues
        missed += max(full.size - found.poles.size, 0)
        surplus += max(found.poles.size - full.size, 0)
        uncertified += not found.certified
        if full.size == found.poles.size and full.size:
            error = np.abs(np.sort_complex(found.poles) / np.sort_complex(full) - 1.0)
            worst = max(worst, float(error.max()))
    return missed, surplus, uncertified, worst


def warm_share(model: SupportModel, n: int, rng: np.random.Generator) -> float:
    """Return the share of the steps of random walks that start warm."""
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    near, warm = None, 0
    z = low + (high - low) * rng.random(low.size)
    for _ in range(n):
        found = model.predict_many(np.exp(z[None]), MODES, near=near, slopes=False)
        warm += int(near is not None and found.status[0] == Status.NEIGHBOUR)
        near = None if np.isnan(found.poles).any() else found
        z = np.clip(z + STEP * (high - low) * rng.standard_normal(low.size), low, high)
    return warm / (n - 1)


def main() -> None:
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    each = max(1, n // (len(OFFSETS_M) * len(LAWS)))
    lines = []
    for i, offset in enumerate(OFFSETS_M):
        assembly = symmetric(offset)
        for j, law in enumerate(LAWS):
            steel = Rayleigh.minimum(0.005, 0.3)
            model = support_model(assembly, family=family(law), rayleigh=steel, highest_mode=max(MODES))
            rng = np.random.default_rng((1, i, j))
            missed, surplus, uncertified, worst = against_full_model(model, each, rng)
            share = warm_share(model, 10 * each, rng)
            lines.append(
                f"| {offset:g} | {law} | {each} | {missed} | {surplus} | {uncertified} | {worst:.0e} "
                f"| {100.0 * share:.1f} % of {10 * each - 1} |"
            )
    write_page(
        "symmetric",
        [
            "# Symmetric structures",
            "",
            f"`python qualify/symmetric.py {n}`: the OC4 jacket with a body of equal inertias on its top, on",
            "the axis or some way off it; random supports, log-uniform over the thesis's bounds, legs alike.",
            "",
            "| offset [m] | law | sets | missed | surplus | uncertified | largest error in λ | warm starts |",
            "|---|---|---|---|---|---|---|---|",
            *lines,
        ],
    )


if __name__ == "__main__":
    main()
