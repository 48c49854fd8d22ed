"""SubDyn's frequencies on decks that ``export`` writes; runs where ``OPENFAST=/path/to/openfast`` is set.

Writes docs/verification/subdyn.md. Foundations that are free at their tops, on springs and on piles as
members, by SubDyn's own finite elements (its summary file) and by ours.
"""

from __future__ import annotations

import os
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import yaml
from common.command import arguments
from common.openfast_deck import Run, write_case
from common.page import write_page
from openfast import DECKS, execute, three_legs, turbine

from jackettwin.decks import read_structure
from jackettwin.decks.subdyn_writer import write_subdyn
from jackettwin.response import build_system
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.superelement.craig_bampton import interface_centroid
from jackettwin.soil import (
    Support,
    held_where_sprung,
    read_foundation,
    read_support,
    with_static_reactions,
)
from jackettwin.structure import Structure, assemble
from jackettwin.structure.cut import at_interface

SPRINGS = "kelvin-voigt:k=2.5e9,c=0"
MODES = 40
EXAMPLE = Path(__file__).parents[1] / "examples" / "three_leg_jacket.yaml"


@dataclass(frozen=True)
class Case:
    """A foundation, and the support file of its piles; without one it stands on springs."""

    title: str
    structure: Structure
    piles: str | Path | None = None


def cases() -> list[Case]:
    return [
        Case("jacket15", read_structure("jacket15")),
        Case("three legs, turned by 20°", three_legs(turn_deg=20.0)),
        Case("three legs, leaning by 0.1", three_legs(lean=0.1)),
        Case("OC4 (its own SubDyn deck)", read_structure(DECKS / "oc4_jacket.dat")),
        Case("jacket15", read_structure("jacket15"), "jacket15"),
        Case("`examples/three_leg_jacket.yaml`", read_structure(EXAMPLE), DECKS / "piles.yaml"),
        Case("three legs, leaning by 0.1", three_legs(lean=0.1), DECKS / "piles.yaml"),
    ]


def main() -> None:
    arguments(__doc__)
    program = os.environ.get("OPENFAST", "")
    if not Path(program).is_file():
        sys.stderr.write("OPENFAST is not set to the program: nothing is run\n")
        return
    lines = [
        "# SubDyn on exported decks",
        "",
        "`export` writes a foundation as a SubDyn input file, with piles by `--pile-model members`.",
        "Its frequencies, free at the top, are by the finite elements of SubDyn 5.0.0 (from its summary",
        "file) and by those of jackettwin on the same structure (`rotary_inertia`, as SubDyn has it). SubDyn",
        "prints seven figures: half a unit of the last is at most 5e-7 of a frequency.",
        "`OPENFAST=/path python qualify/subdyn.py` writes this page.",
        "",
        f"| foundation | support | members | furthest apart of the first {MODES} frequencies |",
        "|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        for k, case in enumerate(cases()):
            place = Path(folder) / str(k)
            place.mkdir()
            sys.stderr.write(f"{case.title}\n")
            members, apart = compared(program, place, case)
            support = (
                f"springs, {SPRINGS}" if case.piles is None else f"piles as members, {members[1]} of these"
            )
            lines.append(f"| {case.title} | {support} | {members[0]} | {apart:.1e} |")
    write_page("subdyn", [*lines, ""])


def compared(program: str, place: Path, case: Case) -> tuple[tuple[int, int], float]:
    """Return the numbers of members and of those in piles, and how far SubDyn's frequencies are from ours.

    A tower stands on the deck at the height of its interface: SubDyn runs under ElastoDyn, and its own
    frequencies know nothing of that.
    """
    foundation, _ = at_interface(case.structure)
    foundation = replace(foundation, rotary_inertia=True)
    support: Support = read_support(SPRINGS, foundation)
    legs = len(foundation.members)
    if case.piles is not None:
        foundation, support = read_foundation(case.piles).piled(foundation)
        foundation = held_where_sprung(foundation, support)
    write_subdyn(with_static_reactions(foundation, support), place / "deck.dat")
    ours = undamped_modes(build_system(assemble(foundation), support), MODES).frequency_hz
    tower = read_structure("jacket15")
    tower = tower.with_masses((turbine().body(tower.top_node),))
    base = tower.nodes[tower.interface_nodes[0]][2]
    above = interface_centroid(case.structure)[2] - case.structure.sea_level_z_m
    primary = write_case(
        place,
        replace(tower, sea_level_z_m=base - above),
        turbine(),
        Run(duration_s=0.1, step_s=0.002, sub=1),
        foundation="deck.dat",
        depth_m=case.structure.sea_level_z_m - min(z for _, _, z in case.structure.nodes.values()),
    )
    execute(program, primary)
    summary = yaml.safe_load(next(place.glob("*.SD.sum.yaml")).read_text())
    full = "Full_frequencies" if "Full_frequencies" in summary else "FEM_frequencies"
    theirs: npt.NDArray[np.float64] = np.sort(np.ravel(summary[full]))
    theirs = theirs[theirs > 1e-3][: ours.size]
    return (len(foundation.members), len(foundation.members) - legs), float(abs(ours / theirs - 1.0).max())


if __name__ == "__main__":
    main()
