"""The linear law of the ground judged by ground that unloads and reloads: one pile of the reference jacket.

Writes docs/verification/soil_loops.md: secant stiffness and loss factor of cycles of the head, beside those
of c = 2ζk/ω1 (thesis eq. (5.4)) with ζ = 2 %.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
from common.command import arguments

from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.piles.cyclic import CyclicPile, loop
from jackettwin.soil.piles.impedance import head_impedance
from jackettwin.soil.piles.piles import dashpots
from jackettwin.soil.support import ELASTIC

PAGE = Path(__file__).parents[1] / "docs" / "verification" / "soil_loops.md"
AMPLITUDES_MM = (0.1, 0.5, 1.0, 5.0, 20.0)
LATERAL, AXIAL = 0, 2
RATIO, FREQUENCY_HZ = 0.02, 0.183
HEAD = "| amplitude | lateral k/k₀ | lateral η | axial k/k₀ | axial η |"


def main() -> None:
    arguments(__doc__)
    foundation = replace(read_foundation("jacket15"), law=ELASTIC)
    pile = foundation.cyclic()
    springs, law = foundation.springs, dashpots(RATIO, 2.0 * pi * FREQUENCY_HZ)
    K0 = head_impedance(foundation.pile, springs, 0.0)[0].real
    K = head_impedance(foundation.pile, springs, 2j * pi * FREQUENCY_HZ, law=law)[0]
    lines = [
        "# Loops of the ground",
        "",
        "One pile of the foundation `jacket15`, one direction of its head at a time: secant stiffness over",
        "the initial one, and loss factor ΔW/2πW, of cycles in ground that unloads and reloads (Masing).",
        f"Last, the law c = 2ζk/ω1 of thesis eq. (5.4) with ζ = {100 * RATIO:g} % at {FREQUENCY_HZ:g} Hz.",
        "`make qualify` writes this page.",
        "",
        HEAD,
        "|---" * 5 + "|",
        *(row(f"{mm:g} mm", pile, K0, 1e-3 * mm) for mm in AMPLITUDES_MM),
        f"| eq. (5.4), any | 1.00 | {loss(K, LATERAL):.3f} | 1.00 | {loss(K, AXIAL):.3f} |",
    ]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write(PAGE.read_text(encoding="utf-8"))


def row(name: str, pile: CyclicPile, K0: np.ndarray, amplitude: float) -> str:
    cells = [name]
    for axis in (LATERAL, AXIAL):
        found = loop(pile, amplitude * np.eye(6)[axis])
        # an elastic loop has the area of rounding, of either sign
        cells += [f"{found.stiffness / K0[axis, axis]:.2f}", f"{found.loss_factor + 1e-9:.3f}"]
    return f"| {' | '.join(cells)} |"


def loss(K: np.ndarray, axis: int) -> float:
    return float(K[axis, axis].imag / K[axis, axis].real)


if __name__ == "__main__":
    main()
