"""Levels of the tower top's acceleration beside OpenFAST's in the same wind, in records never used before.

Writes docs/verification/unseen_levels.md where ``OPENFAST=/path/to/openfast`` is set, and ``IEA15=/path`` to
the folder ``OpenFAST`` of the public repository IEAWindSystems/IEA-15-240-RWT. The factors that ``simulate``
prints are of seven shipped records (response_level.md). Here winds and seeds are others, and both programs
have one and the same wind field, so that the scatter of minutes does not hide a factor. The tower is inside
OpenFAST's superelement, since ElastoDyn's does not twist, and has no drag in either program.
Usage: python qualify/unseen_levels.py FOLDER; the folder keeps the records that are made.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
from common.command import arguments
from common.openfast_deck import Run, write_case
from common.page import write_page
from openfast import execute, on_piles, tower_inside, turbine, without_turbine
from response_level import BANDS, DIRECTIONS, case_of, power
from rotor_forces import DEPTH_M, EACH_SIDE, GRID_M, STANDING, aero_files, write_box
from scipy import stats

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics import rotor_wind
from jackettwin.loads.aerodynamics.turbulence import turbulence
from jackettwin.loads.aerodynamics.wind import Wind
from jackettwin.records import Channel, Record
from jackettwin.records.readers.openfast import read_text
from jackettwin.response.motion.static import self_weight, static_displacement
from jackettwin.response.superelement.craig_bampton import superelement
from jackettwin.response.superelement.files import write_superelement
from jackettwin.response.system import build_system
from jackettwin.simulate import simulate
from jackettwin.simulate.level import BANDS as LEVEL_BANDS, BESIDE_OPENFAST
from jackettwin.structure import Rayleigh, assemble
from jackettwin.structure.cut import at_interface

CASES = ((9.0, 901), (14.0, 902), (11.0, 903))
"""Mean wind [m/s] and seed; no shipped record has either."""
BAR = (0.85, 1.15)
DISCARD_S, DURATION_S, STEP_S, WIND_STEP_S = 50.0, 300.0, 0.05, 0.05
MODES, BAND_HZ = 24, 1.0
STEEL = Rayleigh.minimum(0.0055, 0.183)
"""Of jacket and tower in both programs."""
LEVELS = tuple(LEVEL_BANDS)
"""Names of the same bands in what `simulate` prints."""
CHANNELS = {"acc_top_x": "YawBrTAxp", "acc_top_y": "YawBrTAyp"}


def main() -> None:
    folder = arguments(__doc__, folder=None).folder
    program, decks = os.environ.get("OPENFAST", ""), Path(os.environ.get("IEA15", ""))
    if not (Path(program).is_file() and (decks / "IEA-15-240-RWT").is_dir() and folder):
        sys.stderr.write("OPENFAST, IEA15, FOLDER: nothing is run (docs/verification/unseen_levels.md)\n")
        return
    folder.mkdir(parents=True, exist_ok=True)
    powers = []
    for speed, seed in CASES:
        kept = folder / f"{speed:g}_{seed}.npz"
        if not kept.exists():
            theirs = made(program, decks, folder / "case", speed, seed)
            np.savez_compressed(kept, theirs=theirs.data, ours=simulated(speed, seed).data)
            shutil.rmtree(folder / "case")
        both = np.load(kept)
        powers.append([power(record(both[name])) for name in ("ours", "theirs")])
    write_page("unseen_levels", page(np.array(powers)))


def record(data: FloatArray) -> Record:
    return Record(data, 1.0 / WIND_STEP_S, tuple(Channel(name) for name in CHANNELS))


def field(wind: Wind, seed: int) -> tuple[FloatArray, FloatArray]:
    """Return the nodes (n, 2) of the records' grid [m], and the turbulence there (n_times, n, 3)."""
    steps = GRID_M * np.arange(-EACH_SIDE, EACH_SIDE + 1)
    nodes = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    nodes = nodes + [0.0, wind.hub_height_m]
    gusts = turbulence(
        wind,
        nodes,
        duration=DISCARD_S + DURATION_S,
        sample_rate_hz=1.0 / WIND_STEP_S,
        seed=seed,
        coherent="u",
    )
    return nodes, gusts


def simulated(speed: float, seed: int) -> Record:
    """Return our record in the wind of :func:`field`."""
    with tempfile.TemporaryDirectory() as folder:
        times = {"duration_s": DURATION_S, "discard_s": DISCARD_S, "load_step_s": WIND_STEP_S}
        scenario = case_of(Path(folder), "parked", speed, seed, **times)
        assert scenario.air is not None
        asset = scenario.asset
        body = turbine().body(asset.structure.top_node)
        scenario = replace(scenario, air=replace(scenario.air, tower_drag=0.0))
        scenario = replace(scenario, asset=replace(asset, structure=asset.structure.with_masses((body,))))
        nodes, gusts = field(scenario.air.wind, seed)

        def same(_: object, points: FloatArray, **__: object) -> FloatArray:
            nearest = np.linalg.norm(nodes[:, None] - points, axis=-1).argmin(axis=0)
            return gusts[:, nearest]

        with patch.object(rotor_wind, "turbulence", same):
            whole = simulate(scenario).record
    return whole.select(list(CHANNELS))


def made(program: str, decks: Path, folder: Path, speed: float, seed: int) -> Record:
    """Return OpenFAST's record in the wind of :func:`field`."""
    folder.mkdir(parents=True, exist_ok=True)
    asset = tower_inside(on_piles())
    foundation, _ = at_interface(without_turbine(asset.structure))
    element = superelement(
        build_system(assemble(foundation), asset.support, rayleigh=STEEL), number=MODES, band_hz=BAND_HZ
    )
    write_superelement(element, folder / "jacket.dat")
    top = asset.structure.nodes[asset.structure.top_node][2] - asset.structure.sea_level_z_m
    hub = top + float(asset.turbine.rotor.hub_height)
    wind = Wind(speed, hub, turbulence="B")
    _, gusts = field(wind, seed)
    side = 2 * EACH_SIDE + 1
    box = gusts.reshape(-1, side, side, 3).transpose(0, 2, 1, 3).copy()
    box[..., 0] += wind.mean(hub + GRID_M * np.arange(-EACH_SIDE, EACH_SIDE + 1))[None, :, None]
    write_box(folder / "wind.bts", box, speed=speed, hub=hub, step_s=WIND_STEP_S)
    inflow = {"WindType": "3", "FileName_BTS": '"wind.bts"'}
    # a tower inside the superelement is none of AeroDyn's
    alone = STANDING | {"TwrPotent": "0", "TwrShadow": "0", "TwrAero": "False"}
    aero_files(decks, folder, inflow=inflow, aero=alone)
    text = (folder / "aero.dat").read_text().partition("====== Outputs for all blade stations")[0]
    text = re.sub(r"^ *\d+\.\d{3} +\d.*\n", "", text, flags=re.MULTILINE)
    (folder / "aero.dat").write_text(re.sub(r"^18(\s+NumTwrNds)", r"0\1", text, flags=re.MULTILINE))
    # OpenFAST's own equilibrium has the turbine's P-Δ: without it the first pair would start 2 cm aside
    whole = assemble(asset.structure, gravity=True)
    settled = static_displacement(build_system(whole, asset.support), self_weight(whole))
    rest = settled[whole.dofs(asset.structure.top_node)]
    run = Run(
        rest=2 * tuple(float(v) for v in rest),
        duration_s=DISCARD_S + DURATION_S,
        step_s=STEP_S,
        wind=True,
        channels=tuple(CHANNELS.values()),
    )
    primary = write_case(
        folder, asset.structure, asset.turbine, run, foundation="jacket_ExtPtfm.dat", depth_m=DEPTH_M
    )
    execute(program, primary)
    found = read_text(folder / "case.out")
    at = DISCARD_S + WIND_STEP_S * np.arange(round(DURATION_S / WIND_STEP_S))
    rows = [np.interp(at, found.times_s, found.data[found.names.index(n)]) for n in CHANNELS.values()]
    return record(np.array(rows))


def page(powers: FloatArray) -> list[str]:
    """Return the page from powers (records, 2: ours and OpenFAST's, bands, directions)."""
    ratio = np.sqrt(powers[:, 0] / powers[:, 1])
    n = len(ratio)
    heads = " | ".join(f"{speed:g} m/s, seed {seed}" for speed, seed in CASES[:n])
    lines = [
        "# Level of response in records never used",
        "",
        "jacket15 on the records' piles, the 15 MW rotor parked, its blades rigid, no waves: OpenFAST 5.0.0",
        f"and `simulate` in one and the same wind field for {DURATION_S:g} s after {DISCARD_S:g} s, at winds",
        "and with seeds of no other record. The tower is inside OpenFAST's superelement (ElastoDyn's does",
        "not twist, and torsion at 0.65 Hz is most of the side-side level of 0.6 to 1.0 Hz), and has no drag",
        "in either program. Root mean square of the acceleration at the tower top, ours over OpenFAST's;",
        "beside it what `simulate` prints, the mean of seven shipped records with its 90 % interval",
        "([there](response_level.md)), and the mean of the records here with its own, by Student's t.",
        "**Agrees**: the two means differ by no more than both intervals allow together, on either side.",
        "`OPENFAST=… IEA15=… python qualify/unseen_levels.py FOLDER` writes this page.",
        "",
        f"| band | direction | {heads} | mean (90 %) | printed (90 %) | agrees | in 0.85–1.15 |",
        "|---|---|" + "---|" * (n + 4),
    ]
    for b, name in enumerate(BANDS):
        for d, side in enumerate(DIRECTIONS):
            one = ratio[:, b, d]
            told = BESIDE_OPENFAST[LEVELS[b], side.replace("-", "_")]
            own, spread = float(np.log(one).mean()), float(np.log(one).std(ddof=1) / np.sqrt(n))
            reach = float(stats.t.ppf(0.95, n - 1)) * spread
            low, high = np.exp([own - reach, own + reach])
            both = np.hypot(reach, np.log(told.interval_90[1] / told.mean))
            agrees = abs(own - np.log(told.mean)) <= both
            inside = BAR[0] <= np.exp(own) <= BAR[1]
            cells = " | ".join(f"{r:.2f}" for r in one)
            printed = f"{told.mean:.2f} ({told.interval_90[0]:.2f}–{told.interval_90[1]:.2f})"
            lines.append(
                f"| {name} | {side} | {cells} | **{np.exp(own):.2f}** ({low:.2f}–{high:.2f}) | {printed} | "
                f"{'yes' if agrees else '**no**'} | {'yes' if inside else '**no**'} |"
            )
    return lines


if __name__ == "__main__":
    main()
