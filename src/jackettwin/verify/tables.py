"""One geometry for the tables of chapters 3 and 5: their frequencies do not contradict each other.

The drawings of the thesis's jacket are not published. ``jacket_of_tables.yaml`` and ``jacket_of_rosap.yaml``
are the same steel with the masses of the thesis's own model and of the second program. Sizes, masses and the
pile heads were searched until all forty frequencies were met: that they are says nothing of the sizes, which
are no jacket's that anyone would build.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from jackettwin.decks import read_structure
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import Spring, Support
from jackettwin.structure import STEEL, Structure, assemble
from jackettwin.updating import numbered_modes, only_parts
from jackettwin.verify.rows import Computed

PILE_HEAD = np.diag([1.74937e10, 1.74937e10, 1.21332e10, 2.95120e11, 2.95120e11, 4.85523e07])
"""Of the second program's piles, (6, 6) [N/m, N·m/rad], found with the structure."""


def table_structures() -> tuple[Structure, Structure]:
    """Return the structure with the masses of the thesis's model, and with those of the second program."""
    folder = Path(__file__).parent
    ours, second = (read_structure(str(folder / f"jacket_of_{name}.yaml")) for name in ("tables", "rosap"))
    return ours, second


def tables() -> Computed:
    """Return the frequencies [Hz] of Tables 3.3, 5.1, 5.2 and 5.4 from one geometry."""
    ours, second = table_structures()
    steel = replace(ours, members=tuple(replace(m, material=STEEL) for m in ours.members))
    piles = Support(springs=tuple(Spring(node, PILE_HEAD) for node in second.reaction_nodes))
    found = {
        "T3.3": numbered_modes(assemble(steel), 10).frequency_hz,
        "T5.1": undamped_modes(build_system(assemble(second), piles), 10).frequency_hz,
        **{
            f"T5.2{column}": numbered_modes(assemble(only_parts(one, ("jacket",))), 5).frequency_hz
            for column, one in (("", ours), ("-ROSAP", second))
        },
        "T5.4-ROSAP": numbered_modes(assemble(second), 5).frequency_hz,
        "one-geometry-T5.4": numbered_modes(assemble(ours), 5).frequency_hz,
        "one-geometry-T5.1": undamped_modes(build_system(assemble(second), piles), 5).frequency_hz,
    }
    by_id = {f"{key}-f{k}": float(f) for key, values in found.items() for k, f in enumerate(values, start=1)}
    return {key: f for key, f in by_id.items() if key not in {f"T5.1-f{k}" for k in range(1, 6)}}
