"""What the ExtPtfm modules of OpenFAST 3 and 4 themselves read from our files.

Usage: python qualify/extptfm_layouts.py openfast4=READER openfast3=READER

Each READER is ``qualify/decks/read_extptfm.f90`` built with that version (docs/verification/openfast.md).
Without any nothing is run.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from common.command import arguments
from openfast import SPRINGPOTS, on_feet, reduced_to_interface, three_legs

from jackettwin.response.superelement.craig_bampton import Superelement
from jackettwin.response.superelement.extptfm_writer import LAYOUTS, Layout, static_internal
from jackettwin.response.superelement.files import write_superelement


def main() -> None:
    named = arguments(__doc__, readers=()).readers
    if not named:
        sys.stderr.write("no reader is named: nothing is run (docs/verification/openfast.md)\n")
        return
    element = reduced_to_interface(on_feet("", SPRINGPOTS, structure=three_legs(turn_deg=20.0)))
    for argument in named:
        layout, _, program = argument.partition("=")
        for kind in LAYOUTS:
            if layout == kind or kind == LAYOUTS[0]:
                sys.stdout.write(f"{kind}, by the module of {layout}: {found(program, element, kind)}\n")


def found(program: str, element: Superelement, layout: Layout) -> str:
    """Return how far what the program read is from what was written, or what it says."""
    with tempfile.TemporaryDirectory() as folder:
        _, module = write_superelement(element, Path(folder) / "jacket.dat", layout=layout)
        done = subprocess.run(
            [str(Path(program).resolve()), module.name],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
    rows: dict[str, list[list[float]]] = {}
    for line in done.stdout.splitlines():
        name, *values = line.split() or [""]
        if name in ("M", "K", "C", "weight_n", "start"):
            rows.setdefault(name, []).append([float(value) for value in values])
    if not rows:
        said = " ".join(line.strip() for line in (done.stdout + done.stderr).splitlines() if "rror" in line)
        return f"refused: {said[:200]}"
    start = static_internal(element)
    apart = []
    for name, values in rows.items():
        written = start if name == "start" else getattr(element, name)
        apart.append(f"{name} {np.abs(np.array(values) - written).max() / np.abs(written).max():.0e}")
    return "largest difference beside the largest entry: " + ", ".join(apart)


if __name__ == "__main__":
    main()
