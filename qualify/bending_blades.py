"""The ground from the record whose blades bend, with the rotor's first modes and with a lumped rotor.

Writes docs/verification/bending_blades.md: the shipped twin on ``pile_flexible_U12_s202`` alone, its 90 %
intervals of the ground's stiffness beside that of the records' piles, which their formulas say.
"""

from __future__ import annotations

import re
import tempfile
from importlib import resources
from pathlib import Path

from common.command import arguments
from common.page import write_page

from jackettwin.decks import read_structure
from jackettwin.soil.foundation import read_foundation
from jackettwin.study import TwinResult, run_twin
from jackettwin.twin import read_twin

DATA = Path(str(resources.files("jackettwin") / "data"))
RECORD = "pile_flexible_U12_s202"
BLADES = {"the rotor's first modes": "  blades: {rotor: iea15, pitch_deg: 90}\n", "lumped": ""}
DIRECTIONS = {"vertical": 2, "horizontal": 0}


def updated(folder: Path, blades: str) -> TwinResult:
    """Return the shipped twin's result on that record alone."""
    text = (DATA / "twins" / "openfast_pile.yaml").read_text(encoding="utf-8")
    text = re.sub(r"records:\n(  - .*\n)+", f"records: [{DATA / 'records' / RECORD}.parquet]\n", text)
    path = folder / "twin.yaml"
    path.write_text(text.replace("beam: euler", f"{blades}beam: euler"), encoding="utf-8")
    return run_twin(read_twin(path))


def rows(name: str, result: TwinResult) -> list[str]:
    """Return the table's rows: law, stiffness with interval and truth, frequencies of the second pair."""
    _, support = read_foundation("jacket15_records").lumped(read_structure("jacket15"))
    foot = support.springs[0].node
    # two springs a head: the ground's share, which damps, and the pile's own steel
    truth = sum(spring.matrix for spring in support.springs if spring.node == foot)
    update = next(u for u in result.updates if u.uncertainty is not None)
    found = []
    for direction, axis in DIRECTIONS.items():
        names = [p.name for p in update.problem.parameters]
        at = next(k for k, p in enumerate(names) if p.startswith("k") and p.endswith(direction))
        low, high = update.uncertainty.interval_90[at]
        true = float(truth[axis, axis])
        inside = "yes" if low < true < high else "no"
        found.append(f"| {name} | {names[at]} | {low:.3g}–{high:.3g} | {true:.3g} | {inside} |")
    return found


def main() -> None:
    arguments(__doc__)
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        for name, blades in BLADES.items():
            lines += rows(name, updated(Path(folder), blades))
    write_page(
        "bending_blades",
        [
            "# Bending blades and the ground",
            "",
            f"`python qualify/bending_blades.py`: the shipped twin `openfast_pile` on `{RECORD}` alone,",
            "ten minutes of OpenFAST with bending blades, with the rotor's first modes",
            "(`blades: {rotor: iea15, pitch_deg: 90}`) and with a lumped rotor. 90 % intervals of the",
            "stiffness at a foot [N/m], with the true head of the records' piles. OpenFAST's second bending",
            "modes are at 0.82 and 0.85 Hz; with a lumped rotor at 0.76 and 0.79. Intervals from one record",
            "do not distinguish the two rotors; the frequencies on the true ground do",
            "(`tests/twin/test_bending_blades.py`).",
            "",
            "| rotor | stiffness | 90 % interval | true | inside |",
            "|---|---|---|---|---|",
            *lines,
        ],
    )


if __name__ == "__main__":
    main()
