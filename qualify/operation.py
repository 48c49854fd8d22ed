"""The rotor at work: our damping and thrust by wind against OpenFAST's free decays.

Writes docs/verification/operation.md where ``OPENFAST=/path/to/openfast`` is set, and ``IEA15=/path`` to the
folder ``OpenFAST`` of the public repository IEAWindSystems/IEA-15-240-RWT, whose AeroDyn files are used as
they are but for what OpenFAST 5 reads otherwise. jacket15 as a superelement under an ElastoDyn tower;
steady even wind, speed and pitch held at what we compute; the tower is drawn aside and let go.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from common.command import arguments
from common.openfast_deck import Run
from common.page import write_page
from openfast import (
    KELVIN_VOIGT,
    Asset,
    ComplexArray,
    FloatArray,
    at_rest,
    execute,
    on_feet,
    ready,
    reduced_to_interface,
    tower_inside,
)
from rotor_forces import aero_files

from jackettwin.loads import Linearised, OperatingPoint, operating_point, read_rotor
from jackettwin.records.readers.openfast import read_text
from jackettwin.response.superelement.files import write_superelement
from jackettwin.simulate import Asset as StandingAsset, asset_model, modes_with_rotor

WINDS = (4.0, 8.0, 12.0, 16.0, 20.0, 25.0)
DURATION_S, OFFSET_M, STEP_S = 45.0, 0.3, 0.02
NEAR_HZ, LIGHT = (0.1, 0.25), 0.03
"""Where the first pair lies, and the damping ratio that parts side-side from fore-aft."""
STARTED_S, EVERY_S, ORDER = 3.0, 0.2, 24
CHANNELS = ("PtfmSurge", "PtfmSway")
LABELS = {"fore-aft": "fore_aft_1", "side-side": "side_side_1"}
AERO = {"TwrPotent": "0", "TwrShadow": "0", "TwrAero": "False", "UA_Mod": "3", "DBEMT_Mod": "2"}


@dataclass(frozen=True)
class Decay:
    """Poles of the first pair by direction, and mean thrust and torque at the hub, of OpenFAST."""

    poles: dict[str, complex]
    thrust_n: float


def main() -> None:
    chosen = tuple(arguments(__doc__, winds=WINDS).winds)
    program, decks = os.environ.get("OPENFAST", ""), Path(os.environ.get("IEA15", ""))
    if not (Path(program).is_file() and (decks / "IEA-15-240-RWT").is_dir()):
        sys.stderr.write("OPENFAST and IEA15 are not set: nothing is run (docs/verification/operation.md)\n")
        return
    lines = introduction()
    rotor, control = read_rotor("iea15")
    for flexible in (True, False):
        lines += heading(flexible=flexible)
        for wind in chosen:
            sys.stderr.write(f"{wind:g} m/s, {'bending' if flexible else 'rigid'} blades\n")
            at = operating_point(rotor, control, wind)
            lines.append(row(program, decks, at, flexible=flexible))
        lines.append("")
    write_page("operation", lines)


def introduction() -> list[str]:
    return [
        "# The operating rotor compared with OpenFAST",
        "",
        "`jacket15` on Kelvin–Voigt feet with its tower as one ExtPtfm superelement (ElastoDyn's tower",
        "does not twist, which changes side-side by a fifth) under the IEA 15 MW rotor of its public",
        "AeroDyn files: OpenFAST 5.0.0, blade element momentum with Øye's dynamic wake (`DBEMT_Mod 2`),",
        "the skewed wake and unsteady aerodynamics (`UA_Mod 3`), steady uniform wind, rotor speed and pitch",
        "fixed at the values of jackettwin, tower displaced by 0.3 m and released. ζ is the whole mode's.",
        "*Ours*: `modes_with_rotor`, the shaft locked in both. Bars: fore-aft ζ within 10 %, side-side 15 %.",
        "`OPENFAST=… IEA15=… python qualify/operation.py` writes this page; `OPERATION_RUNS=FILE` keeps the",
        "results of OpenFAST.",
        "",
    ]


def heading(*, flexible: bool) -> list[str]:
    what = "Bending blades" if flexible else "Rigid blades"
    return [
        f"**{what}**",
        "",
        "| wind [m/s] | rpm, pitch [°] | thrust ours, theirs [MN] | Δ [%] "
        "| fore-aft f, ζ [%] ours | theirs | Δζ/ζ [%] | side-side f, ζ [%] ours | theirs | Δζ/ζ [%] |",
        "|---" * 10 + "|",
    ]


def row(program: str, decks: Path, at: OperatingPoint, *, flexible: bool) -> str:
    rotor, _ = read_rotor("iea15")
    asset = tower_inside(on_feet("at work", KELVIN_VOIGT, np.degrees(at.pitch)))
    still = asset_model(StandingAsset(asset.structure, asset.support))
    mean, modes = modes_with_rotor(still, rotor, at, shaft="locked", bending=flexible)
    theirs = known(
        f"{at.wind_speed:g} m/s, {flexible}", lambda: measured(program, decks, asset, at, mean, flexible)
    )
    ours = {mode.label: mode for mode in modes}
    thrust = float(rotor.shaft @ mean.load[:3])
    cells = [f"{at.wind_speed:g}", f"{at.rotor_speed * 30.0 / np.pi:.2f}, {np.degrees(at.pitch):.2f}"]
    cells += [
        f"{thrust / 1e6:.3f}, {theirs.thrust_n / 1e6:.3f}",
        f"{100 * (thrust / theirs.thrust_n - 1):+.1f}",
    ]
    for side, label in LABELS.items():
        pole, mode = theirs.poles[side], ours[label]
        f, zeta = abs(pole) / 2.0 / np.pi, -pole.real / abs(pole)
        cells += [f"{mode.frequency_hz:.4f}, {100 * mode.damping_ratio:.2f}", f"{f:.4f}, {100 * zeta:.2f}"]
        cells.append(f"{100 * (mode.damping_ratio / zeta - 1.0):+.1f}")
    return f"| {' | '.join(cells)} |"


def known(key: str, found: Callable[[], Decay]) -> Decay:
    """Return a result of an earlier run, or find and keep it: OpenFAST need not run for every page."""
    runs = os.environ.get("OPERATION_RUNS")
    path = Path(runs) if runs else None

    def read() -> dict[str, Any]:
        return json.loads(path.read_text()) if path and path.is_file() else {}

    kept = read()
    if key not in kept:
        decay = found()
        poles = {side: [pole.real, pole.imag] for side, pole in decay.poles.items()}
        # another process may have kept its own meanwhile
        kept = read() | {key: {"poles": poles, "thrust_n": decay.thrust_n}}
        if path:
            path.write_text(json.dumps(kept, indent=1))
    found_poles = {side: complex(*pair) for side, pair in kept[key]["poles"].items()}
    return Decay(found_poles, kept[key]["thrust_n"])


def measured(
    program: str, decks: Path, asset: Asset, at: OperatingPoint, mean: Linearised, flexible: bool
) -> Decay:
    with tempfile.TemporaryDirectory() as folder:
        return decayed(program, decks, Path(folder), asset, at, mean, flexible=flexible)


def decayed(
    program: str,
    decks: Path,
    folder: Path,
    asset: Asset,
    at: OperatingPoint,
    mean: Linearised,
    *,
    flexible: bool,
) -> Decay:
    """Return what OpenFAST's tower does once it is let go beside where it stands in the wind."""
    element = reduced_to_interface(asset)
    write_superelement(element, folder / "jacket.dat")
    wind = {"WindType": "1", "HWindSpeed": f"{at.wind_speed}", "PLExp": "0.0", "RefHt": "150.0"}
    aero_files(decks, folder, inflow=wind, aero=AERO)
    run = Run(
        flexible=flexible,
        duration_s=DURATION_S,
        step_s=STEP_S,
        offset_m=OFFSET_M,
        rest=at_rest(asset.structure, element, thrust=mean.load),
        wind=True,
        rotor_rpm=at.rotor_speed * 30.0 / np.pi,
    )
    execute(program, ready(folder, asset, run))
    found = read_text(folder / "case.out")
    started = found.times_s >= STARTED_S
    every = round(EVERY_S / STEP_S)
    moved = np.array([found.data[found.names.index(name)][started][::every] for name in CHANNELS])
    poles = first_pair(moved)
    thrust = found.data[found.names.index("RtFldFxh")]
    return Decay(poles, float(thrust[found.times_s > 0.6 * DURATION_S].mean()))


def first_pair(moved: FloatArray) -> dict[str, complex]:
    """Return the poles of the first pair from the tower top's decay (2, n_times), along and across the wind.

    By one subspace of both directions, which holds the mean, the wake's answer and the blades' passing, too;
    of the poles near the pair the one with the largest part of its direction.
    """
    rows = moved.shape[1] // 3
    hankel = np.vstack([np.lib.stride_tricks.sliding_window_view(x, x.size - rows + 1) for x in moved])
    basis = np.linalg.svd(hankel, full_matrices=False)[0][:, :ORDER]
    before = np.vstack([basis[: rows - 1], basis[rows : 2 * rows - 1]])
    after = np.vstack([basis[1:rows], basis[rows + 1 :]])
    advance = np.linalg.lstsq(before, after, rcond=None)[0]
    poles: ComplexArray = np.log(np.linalg.eigvals(advance).astype(np.complex128)) / EVERY_S
    modes = np.exp(np.outer(EVERY_S * np.arange(moved.shape[1]), poles))
    part = np.abs(np.linalg.lstsq(modes, moved.T.astype(np.complex128), rcond=None)[0])
    f, zeta = np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles)
    near = (poles.imag > 0.0) & (f > NEAR_HZ[0]) & (f < NEAR_HZ[1]) & (zeta > 0.0)
    found = {}
    for k, (side, wanted) in enumerate((("fore-aft", zeta > LIGHT), ("side-side", zeta <= LIGHT))):
        found[side] = complex(poles[np.argmax(np.where(near & wanted, part[:, k], -1.0))])
    return found


if __name__ == "__main__":
    main()
