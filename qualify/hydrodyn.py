"""Wave loads on the OC4 jacket beside HydroDyn; runs where ``HYDRODYN=/path/to/hydrodyn_driver`` is set.

Writes docs/verification/hydrodyn.md. Marine growth, drag, inertia and pressure on members and on their ends.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
from common.command import arguments
from common.hydrodyn_deck import Water, write_driver, write_water
from common.page import write_page

from jackettwin.decks import read_structure
from jackettwin.loads.members.coefficients import Coefficients, GrowthBand
from jackettwin.loads.members.ends import EndCoefficients, end_forces, member_ends
from jackettwin.loads.members.morison import above_bed, morison_points, point_forces, wetness
from jackettwin.loads.sea.wave_series import resultant_columns
from jackettwin.loads.sea.waves import airy_wave
from jackettwin.records.readers.openfast import read_text
from jackettwin.structure import assemble

FloatArray = npt.NDArray[np.float64]

DECK = Path(__file__).parent / "decks/oc4_jacket.dat"
PIECE_M, STEP_S = 0.5, 0.1
"""Of our members and, where a case says nothing else, of HydroDyn's; and of its output."""
ROWS = {"Fx": ("HydroFxi", 0), "Fz": ("HydroFzi", 2), "My": ("HydroMyi", 4)}
CASES = {
    "6 m, 10 s, feet 1 mm under the bed": Water(50.0, 6.0, 10.0, axial=(1.0, 1.0, 1.0), growth_m=0.1),
    "2 m, 5 s": Water(
        50.0, 2.0, 5.0, axial=(1.0, 1.0, 1.0), growth_m=0.1, piece_m=0.25, wave_step_s=0.1, duration_s=20.0
    ),
    "6 m, 10 s, four metres of it buried": Water(46.0, 6.0, 10.0, axial=(1.0, 1.0, 1.0), growth_m=0.1),
    "no growth, no ends": Water(50.0, 6.0, 10.0),
}
FEET_Z_M = -50.001
"""Where the deck's feet stand, from still water."""
ABOVE_BED_MM = (-11, -6, -1, 1, 6, 11, 20)
"""Where a bed stated to the centimetre leaves them, both sides of it; then two places in the water."""


def main() -> None:
    arguments(__doc__)
    program = os.environ.get("HYDRODYN", "")
    if not Path(program).is_file():
        sys.stderr.write(
            "HYDRODYN is not set to its driver: nothing is run (docs/verification/hydrodyn.md)\n"
        )
        return
    lines = introduction()
    for title, water in CASES.items():
        sys.stderr.write(f"{title}\n")
        with tempfile.TemporaryDirectory() as folder:
            times, theirs = hydrodyn(program, Path(folder), water)
        mine = ours(water, times)
        cells = []
        for name, (_, column) in ROWS.items():
            a, b = (x - x.mean() for x in (mine[:, column], theirs[name]))
            cells.append(f"{np.ptp(b) / 1e6:.3f}, {100.0 * np.abs(a - b).max() / np.abs(b).max():.3f} %")
        lines.append(f"| {title} | {' | '.join(cells)} |")
    write_page("hydrodyn", [*lines, "", *feet(program)])


def feet(program: str) -> list[str]:
    """Return the table of feet close to the bed: the vertical force's range by both."""
    lines = [
        "The first case with its bed moved, its feet above (+) or below (−) it: the range of Fz [MN].",
        "",
        "| feet [mm] | HydroDyn | ours |",
        "|---|---|---|",
    ]
    for gap in ABOVE_BED_MM:
        water = Water(round(gap / 1e3 - FEET_Z_M, 6), 6.0, 10.0, axial=(1.0, 1.0, 1.0), growth_m=0.1)
        with tempfile.TemporaryDirectory() as folder:
            times, theirs = hydrodyn(program, Path(folder), water)
        both = (np.ptp(x) / 1e6 for x in (theirs["Fz"], ours(water, times)[:, 2]))
        lines.append(f"| {gap:+d} | {' | '.join(f'{x:.3f}' for x in both)} |".replace("| -", "| −"))
    return lines


def introduction() -> list[str]:
    return [
        "# Wave loads compared with HydroDyn",
        "",
        "The OC4 jacket of OpenFAST's tests in a regular Airy wave, by HydroDyn of OpenFAST 5.0.0 (its",
        f"members in pieces of {PIECE_M} m, of 0.25 m in the short wave) and jackettwin: range of",
        "force [MN] and moment at the origin [MN·m], and the largest difference at any instant over",
        "the largest value. C_D = C_a = C_p = 1; with growth of 0.1 m and axial coefficients of 1",
        "unless stated otherwise; without buoyancy.",
        "`HYDRODYN=/path/hydrodyn_driver make qualify` writes this page.",
        "",
        f"| wave | {' | '.join(ROWS)} |",
        "|---" * (1 + len(ROWS)) + "|",
    ]


def hydrodyn(program: str, folder: Path, water: Water) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return times [s] and the jacket's forces and moments by HydroDyn."""
    write_water(folder, read_structure(DECK), water)
    driver = write_driver(folder, water, step_s=STEP_S)
    log = folder / "log.txt"
    with log.open("w") as stream:
        done = subprocess.run([program, driver.name], cwd=folder, stdout=stream, stderr=stream, check=False)
    if done.returncode != 0:
        raise SystemExit(f"HydroDyn refused {driver}:\n{log.read_text(errors='replace')[-2000:]}")
    found = read_text(folder / "out.out")
    return found.times_s, {k: found.data[found.names.index(name)] for k, (name, _) in ROWS.items()}


def ours(water: Water, times: FloatArray) -> FloatArray:
    """Return force and moment about still water, (n_times, 6)."""
    assembly = assemble(read_structure(DECK))
    growth = (GrowthBand(2.0, -water.depth_m - 2.0, water.growth_m),) if water.growth_m else ()
    coefficients = Coefficients(growth=growth, density_kg_m3=water.density_kg_m3)
    wave = airy_wave(height=water.height_m, period=water.period_s, depth=water.depth_m)
    grid = morison_points(
        assembly, highest_z=0.0, lowest_z=-water.depth_m, coefficients=coefficients, spacing=PIECE_M
    )
    wet = wetness(grid, wave.surface(grid.points, times)) * above_bed(grid, water.depth_m)
    force = point_forces(grid, *wave.motion(grid.points, times), wet=wet)
    total = force.reshape(times.size, -1) @ resultant_columns(grid.points)
    drag, added_mass, pressure = water.axial
    on_ends = EndCoefficients(pressure=pressure, added_mass=added_mass, drag=drag)
    if on_ends.any:
        ends = member_ends(assembly, on_ends, coefficients, highest_z=0.0, lowest_z=-water.depth_m)
        total += end_forces(ends, wave, times).reshape(times.size, -1) @ resultant_columns(ends.points)
    return np.asarray(total)


if __name__ == "__main__":
    main()
