"""The wind's force on a rotor that stands, ours and AeroDyn's, in one and the same turbulent wind.

Writes docs/verification/rotor_forces.md where ``OPENFAST=/path/to/openfast`` is set, and ``IEA15=/path`` to
the folder ``OpenFAST`` of the public repository IEAWindSystems/IEA-15-240-RWT, whose AeroDyn files are used
as they are but for what OpenFAST 5 reads otherwise. In two winds the programs differ by chance:
a mode of 0.8 % damping has its level of ten minutes known to 20 %. In one wind only the aerodynamics differ.
"""

from __future__ import annotations

import os
import re
import struct
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
from common.command import arguments
from common.openfast_deck import Run, write_case
from common.page import write_page
from openfast import turbine

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics import rotor_wind
from jackettwin.loads.aerodynamics.turbulence import turbulence
from jackettwin.records.readers.openfast import read_text
from jackettwin.simulate import read_scenario
from jackettwin.simulate.motion.model import aerodynamics
from jackettwin.simulate.motion.wind import rotor_loads_in, wind_field
from jackettwin.simulate.scenario.scenario import Scenario

CASES = ((8.0, 4), (10.0, 2), (12.0, 1), (16.0, 3))
"""Mean wind [m/s] and seed."""
GRID_M, EACH_SIDE = 19.1, 7
DURATION_S, STEP_S = 600.0, 0.05
SLOPE_1_M = 0.012
"""Turn of the tower top over its way in the first modes of the records' asset."""
BANDS = {"0.02–0.12 Hz": (0.02, 0.12), "0.14–0.21 Hz": (0.14, 0.21), "0.3–0.6 Hz": (0.3, 0.6)}
DEPTH_M = 72.0
STANDING = {"Wake_Mod": "0", "UA_Mod": "0"}
"""AeroDyn without induction and unsteady lift."""


def main() -> None:
    arguments(__doc__)
    program, decks = os.environ.get("OPENFAST", ""), Path(os.environ.get("IEA15", ""))
    if not (Path(program).is_file() and (decks / "IEA-15-240-RWT").is_dir()):
        sys.stderr.write(
            "OPENFAST and IEA15 are not set: nothing is run (docs/verification/rotor_forces.md)\n"
        )
        return
    rows, found = [], []
    for speed, seed in CASES:
        with tempfile.TemporaryDirectory() as folder:
            ratios = compared(program, decks, Path(folder), speed, seed)
        found.append(ratios)
        cells = [f"{r:.2f}" for r in ratios.T.ravel()]
        rows.append(f"| {speed:g} m/s | {' | '.join(cells)} |")
    mean = np.exp(np.log(found).mean(axis=0)).T.ravel()
    rows.append(f"| mean | {' | '.join(f'**{r:.2f}**' for r in mean)} |")
    write_page("rotor_forces", [*introduction(), *rows])


def introduction() -> list[str]:
    heads = [f"{side}, {band}" for side in ("fore-aft", "side-side") for band in BANDS]
    return [
        "# Forces on a standing rotor in the same wind field",
        "",
        "The IEA 15 MW rotor, feathered and locked, ten minutes in class B on a grid of 19.1 m: the wind's",
        "generalised force on the first modes (F_x + s M_y, F_y − s M_x at the tower top, s 0.012/m),",
        "rms, ratio of jackettwin to AeroDyn of OpenFAST 5.0.0 (quasi-steady, no induction, its tower's",
        "potential flow and shadow on) in the same wind field. `OPENFAST=… IEA15=… make qualify` writes",
        "this page.",
        "",
        f"| wind | {' | '.join(heads)} |",
        "|---" * (1 + len(heads)) + "|",
    ]


def compared(program: str, decks: Path, folder: Path, speed: float, seed: int) -> FloatArray:
    """Return ours over AeroDyn's, (bands, 2: fore-aft and side-side)."""
    scenario = asset_in(folder, speed, seed)
    assert scenario.air is not None and scenario.turbine is not None
    wind, hub = scenario.air.wind, scenario.air.wind.hub_height_m
    steps = GRID_M * np.arange(-EACH_SIDE, EACH_SIDE + 1)
    nodes = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) + [0.0, hub]
    field = turbulence(wind, nodes, duration=DURATION_S, sample_rate_hz=1.0 / STEP_S, seed=seed, coherent="u")

    def same(_: object, points: FloatArray, **__: object) -> FloatArray:
        nearest = np.linalg.norm(nodes[:, None] - points, axis=-1).argmin(axis=0)
        return np.asarray(field[:, nearest])

    aero = aerodynamics(scenario.air, scenario.turbine)
    with patch.object(rotor_wind, "turbulence", same):
        own = wind_field(scenario.air, aero, duration=DURATION_S, step=STEP_S)
    ours = rotor_loads_in(own, scenario.air, aero).still.T
    box = field.reshape(-1, steps.size, steps.size, 3).transpose(0, 2, 1, 3).copy()
    box[..., 0] += wind.mean(hub + steps)[None, :, None]
    write_box(folder / "wind.bts", box, speed=speed, hub=hub)
    theirs, step = aerodyn(program, decks, folder, scenario)
    return np.array(
        [[a / b for a, b in zip(levels(ours, STEP_S, band), levels(theirs, step, band), strict=True)]
         for band in BANDS.values()]
    )  # fmt: skip


def asset_in(folder: Path, speed: float, seed: int) -> Scenario:
    path = folder / "case.yaml"
    path.write_text(
        f"structure: jacket15\nsupport: clamped\nwind: {{speed_m_s: {speed}, turbulence: B, seed: {seed}}}\n"
        f"rotor: {{state: parked}}\ntime: {{duration_s: {DURATION_S}, step_s: {STEP_S}}}\n",
        encoding="utf-8",
    )
    scenario = read_scenario(path)
    structure = scenario.asset.structure
    held = structure.with_masses((turbine().body(structure.top_node),))
    return replace(scenario, asset=replace(scenario.asset, structure=held))


def levels(loads: FloatArray, step: float, band: tuple[float, float]) -> tuple[float, float]:
    """Return root mean squares of the force on the first modes, fore-aft and side-side."""
    f = np.fft.rfftfreq(loads.shape[1], step)
    inside = (f > band[0]) & (f < band[1])
    force = np.stack([loads[0] + SLOPE_1_M * loads[4], loads[1] - SLOPE_1_M * loads[3]])
    lines = np.abs(np.fft.rfft(force - force.mean(axis=1, keepdims=True)))[:, inside]
    along, across = np.sqrt(2.0 * (lines**2).sum(axis=1)) / loads.shape[1]
    return float(along), float(across)


def write_box(path: Path, box: FloatArray, *, speed: float, hub: float, step_s: float = STEP_S) -> None:
    """Write a periodic wind field (n_times, n_z, n_y, 3) as TurbSim does (TurbSim's manual, appendix D)."""
    low, high = box.min(axis=(0, 1, 2)), box.max(axis=(0, 1, 2))
    slope = 60000.0 / (high - low)
    offset = -30000.0 - slope * low
    n_times, n_z, n_y, _ = box.shape
    title = b"one wind"
    with path.open("wb") as stream:
        bottom = hub - EACH_SIDE * GRID_M
        stream.write(struct.pack("<h4i", 8, n_z, n_y, 0, n_times))
        stream.write(struct.pack("<6f", GRID_M, GRID_M, step_s, speed, hub, bottom))
        for pair in zip(slope, offset, strict=True):
            stream.write(struct.pack("<2f", *pair))
        stream.write(struct.pack("<i", len(title)) + title)
        stream.write(np.round(box * slope + offset).astype("<i2").tobytes())


def aerodyn(program: str, decks: Path, folder: Path, scenario: Scenario) -> tuple[FloatArray, float]:
    """Return AeroDyn's loads at the tower top in global axes (6, n_times), and their step [s]."""
    run = Run(duration_s=DURATION_S, step_s=STEP_S, sub=0, wind=True, fixed=True)
    primary = write_case(
        folder, scenario.asset.structure, turbine(), run, foundation="unused", depth_m=DEPTH_M
    )
    aero_files(decks, folder, inflow={"WindType": "3", "FileName_BTS": '"wind.bts"'}, aero=STANDING)
    log = folder / "log.txt"
    with log.open("w") as stream:
        subprocess.run([program, primary.name], cwd=folder, stdout=stream, stderr=stream, check=True)
    found = read_text(folder / "case.out")
    step = float(np.diff(found.times_s[:2])[0])
    names = [f"RtFld{kind}{axis}h" for kind in "FM" for axis in "xyz"]
    hub = np.array([found.data[found.names.index(name)] for name in names])[:, : round(DURATION_S / step)]
    rotor = turbine().rotor
    cos, sin = np.cos(rotor.tilt), np.sin(rotor.tilt)
    turn = np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
    force, moment = turn @ hub[:3], turn @ hub[3:]
    arm = np.array([-rotor.overhang, 0.0, rotor.hub_height])
    return np.vstack([force, moment + np.cross(arm, force.T).T]), step


def aero_files(decks: Path, folder: Path, *, inflow: dict[str, str], aero: dict[str, str]) -> None:
    """Write the public inflow and AeroDyn files as version 5 reads them, some values changed."""
    public = decks / "IEA-15-240-RWT"
    text = (public / "IEA-15-240-RWT_InflowFile.dat").read_text()
    for keyword, value in inflow.items():
        text = _set(text, keyword, value)
    (folder / "inflow.dat").write_text(text)
    deck = decks / "IEA-15-240-RWT-Monopile" / "IEA-15-240-RWT-Monopile_AeroDyn15.dat"
    text = deck.read_text().replace("../IEA-15-240-RWT/", f"{public.resolve()}/")
    for keyword, value in (aero | {"NumTwrNds": "18"}).items():
        text = _set(text, keyword, value)
    kept = []
    for line in text.splitlines():
        table = re.match(r"^ *\d+\.\d{3} +\d", line)
        # version 5 knows no Buoyancy, and seven columns; its tower stands on ours and ends below our top
        if not (" Buoyancy " in line or line.startswith("  15.000") or " 144.386 " in line):
            kept.append(line + ("   0.0   0.0" if table else ""))
    (folder / "aero.dat").write_text("\n".join(kept))


def _set(text: str, keyword: str, value: str) -> str:
    """Return a deck with another value before a keyword."""
    return re.sub(rf"^\S+(\s+){keyword}\b", rf"{value}\1{keyword}", text, flags=re.MULTILINE)


if __name__ == "__main__":
    main()
