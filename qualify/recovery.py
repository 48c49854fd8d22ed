"""Section forces from an interface's motion alone, against the members' forces that SubDyn wrote itself.

``OPENFAST=/path/to/openfast python qualify/recovery.py`` writes docs/verification/recovery.md.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from common.command import arguments
from common.openfast_deck import Run, write_case
from common.page import write_page
from openfast import at_rest, execute, turbine

from jackettwin.decks import read_structure
from jackettwin.decks.subdyn_writer import write_subdyn
from jackettwin.records.readers.openfast import read_text
from jackettwin.response.superelement.craig_bampton import interface_centroid, superelement
from jackettwin.response.system import build_system
from jackettwin.simulate import read_interface_motion, read_scenario, recovered
from jackettwin.soil import read_support, with_static_reactions
from jackettwin.structure import assemble, at_interface

FEET = "kelvin-voigt:k=2.5e9,c=0"
MEMBERS = (1, 6, 27, 40, 62, 83)
"""Legs and braces of jacket15's exported deck at all heights."""
DURATION_S, STEP_S, OFFSET_M, SETTLED_S = 30.0, 0.005, 0.3, 10.0
EVERY = 5
"""SubDyn's steps from one that is written to the next."""
OURS = {"FKze": "axial_n", "MKxe": "bending_y_nm", "MKye": "bending_z_nm", "MKze": "torsion_nm"}


def main() -> None:
    given = arguments(__doc__, folder=None)
    program = os.environ.get("OPENFAST", "")
    if not Path(program).is_file():
        sys.stderr.write("OPENFAST is not set: nothing is run (docs/verification/recovery.md)\n")
        return
    with tempfile.TemporaryDirectory() as scratch:
        # a named folder keeps the run for the next page
        place = given.folder or Path(scratch)
        place.mkdir(exist_ok=True)
        if not (place / "case.out").is_file():
            execute(program, prepared(place))
        write_page("recovery", [*introduction(), *compared(place)])


def introduction() -> list[str]:
    return [
        "# Forces below the interface compared with SubDyn",
        "",
        "`jackettwin recover` gets the motion of the interface that OpenFAST 5.0.0 wrote (`IntfTDXss` …) and",
        "nothing else; SubDyn wrote the forces of its members in the same run. The exported jacket15 (24",
        "modes at 5 %, `SttcSolve`) on feet of 2.5e9 N/m carries a tower that is let go 0.3 m aside; here",
        "its steel has Rayleigh damping of 5 % at 2 Hz, so that both forget how they began. σ is SubDyn's;",
        "the errors are of σ, with as many internal coordinates as SubDyn has, and with the usual 120.",
        "`OPENFAST=/path/to/openfast python qualify/recovery.py [FOLDER]` writes this page.",
        "",
        "| member, end | axial σ [kN] | 24, 120 [%] | bending σ [kN·m] | 24, 120 [%] | mean axial [kN] |",
        "|---|---|---|---|---|---|",
    ]


def prepared(place: Path) -> Path:
    """Write the files of the case; return its ``.fst``."""
    deck = written(place)
    structure = read_structure("jacket15")
    above = interface_centroid(structure)[2] - structure.sea_level_z_m
    machine = turbine()
    tower = structure.with_masses((machine.body(structure.top_node),))
    base = tower.nodes[tower.interface_nodes[0]][2]
    foundation, _ = at_interface(structure)
    element = superelement(build_system(assemble(foundation), read_support(FEET, foundation)), number=24)
    primary = write_case(
        place,
        replace(tower, sea_level_z_m=base - above),
        machine,
        Run(duration_s=DURATION_S, step_s=STEP_S, offset_m=OFFSET_M, rest=at_rest(tower, element), sub=1),
        foundation=deck.name,
        depth_m=structure.sea_level_z_m - min(z for _, _, z in structure.nodes.values()),
    )
    text = primary.read_text()
    primary.write_text(re.sub(r"^\S+  DT_Out", f"{EVERY * STEP_S}  DT_Out", text, flags=re.MULTILINE))
    (place / "scenario.yaml").write_text(
        "structure: deck.dat\ngravity: false\ndamping: {rayleigh: {ratio: 0.05, frequency_hz: 2.0}}\n"
    )
    return primary


def compared(place: Path) -> list[str]:
    """Return a row for both ends of each member."""
    theirs = read_text(place / "case.out")
    scenario, motion = read_scenario(place / "scenario.yaml"), read_interface_motion(place / "case.out")
    names = [str(number) for number in MEMBERS]
    found = [recovered(scenario, motion, names, number=number).series for number in (24, 120)]
    settled = theirs.times_s > SETTLED_S
    rows = []
    for k, name in enumerate(names):
        for end, node in (("start", 1), ("end", 2)):
            sub = {key: theirs.data[theirs.names.index(f"M{k + 1}N{node}{key}")][settled] for key in OURS}
            own = [
                {key: s.values[s.names.index(f"{name}.{end}.{part}")][settled] for key, part in OURS.items()}
                for s in found
            ]
            rows.append(row(f"{name}, {end}", own, sub))
    return rows


def row(title: str, own: list[dict[str, np.ndarray]], sub: dict[str, np.ndarray]) -> str:
    """Return how far apart the parts that vary are, and the means of what does not."""

    def spread(one: dict[str, np.ndarray], *keys: str) -> float:
        # about axes that each program turns as it likes
        return float(np.sqrt(sum(one[key].var() for key in keys)))

    cells = [title]
    for keys in (("FKze",), ("MKxe", "MKye")):
        wanted = spread(sub, *keys)
        errors = ", ".join(f"{100 * (spread(one, *keys) / wanted - 1.0):+.2f}" for one in own)
        cells += [f"{wanted / 1e3:.1f}", errors]
    cells.append(f"{own[0]['FKze'].mean() / 1e3:.1f}, {sub['FKze'].mean() / 1e3:.1f}")
    return f"| {' | '.join(cells)} |"


def written(place: Path) -> Path:
    """Write the deck, which asks for the members' forces and the interface's motion."""
    foundation, _ = at_interface(read_structure("jacket15"))
    support = read_support(FEET, foundation)
    path = place / "deck.dat"
    write_subdyn(with_static_reactions(foundation, support), path)
    lines = path.read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if "JDampings" in line)
    lines[at] = "5   JDampings"
    at = next(i for i, line in enumerate(lines) if "NMOutputs" in line)
    lines[at] = f"{len(MEMBERS)}   NMOutputs"
    lines[at + 3 : at + 3] = [f"{number} 2 1 2" for number in MEMBERS]
    at = next(i for i, line in enumerate(lines) if "IntfFXss" in line)
    motion = ", ".join(f"Intf{kind}D{axis}ss" for kind in "TR" for axis in "XYZ")
    forces = [
        '"' + ", ".join(f"M{k + 1}N{node}{key}" for key in OURS) + '"'
        for k in range(len(MEMBERS))
        for node in (1, 2)
    ]
    lines[at : at + 1] = [f'"{motion}"', *forces]
    path.write_text("\n".join(lines) + "\n")
    return path


if __name__ == "__main__":
    main()
