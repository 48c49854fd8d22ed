"""What we write, read and run by OpenFAST itself; runs where ``OPENFAST=/path/to/openfast`` is set.

Writes docs/verification/openfast.md. jacket15 and a jacket of three legs as ExtPtfm superelements under an
ElastoDyn tower and the IEA 15 MW rotor, with rigid and with bending blades, linearised and in free decay,
against ``modes --gravity``. SubDyn decks are compared by ``subdyn.py``.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from common.command import arguments
from common.openfast_deck import Run, Turbine, write_case
from common.page import write_page

from jackettwin.decks import read_structure
from jackettwin.decks.blade_files import read_flexible_rotor
from jackettwin.records.readers.openfast import read_text
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.modes.own_damping import own_damping
from jackettwin.response.motion.static import self_weight, static_displacement
from jackettwin.response.superelement.craig_bampton import (
    INTERFACE,
    Superelement,
    superelement,
)
from jackettwin.response.superelement.files import write_superelement
from jackettwin.response.system import System, build_system
from jackettwin.soil import Support, read_support
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.support import Spring
from jackettwin.structure import Rayleigh, Structure, assemble
from jackettwin.structure.cut import at_interface
from jackettwin.structure.model import Reaction
from jackettwin.structure.rotor_modes import with_rotor

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

KELVIN_VOIGT, SOFTER = "kelvin-voigt:k=2.5e9,c=7.6e8", "kelvin-voigt:k=8e8,c=1e8"
SPRINGPOTS = "springpot:k=1e9,alpha=0.06,f0=0.2"
DECKS = Path(__file__).parent / "decks"
PITCHES_DEG = (45.0, 0.0)
"""Of blades that are not feathered: the flap bends fore-aft then."""
MODES = 24
BAND_HZ = 1.0
DECAY_S = 150.0
DECAY = "free decay"
FOUR = ("first side-side", "first fore-aft", "second side-side", "second fore-aft")


def main() -> None:
    arguments(__doc__)
    program = os.environ.get("OPENFAST", "")
    if not Path(program).is_file():
        sys.stderr.write(
            "OPENFAST is not set to the program: nothing is run (docs/verification/openfast.md)\n"
        )
        return
    lines = introduction()
    with tempfile.TemporaryDirectory() as folder:
        for k, (asset, flexible) in enumerate(cases()):
            place = Path(folder) / str(k)
            place.mkdir()
            sys.stderr.write(f"{asset.title}, {'bending' if flexible else 'rigid'} blades\n")
            lines += compared(program, place, asset, flexible=flexible)
    write_page("openfast", lines)


def introduction() -> list[str]:
    return [
        "# OpenFAST with exported foundations",
        "",
        "`jacket15`, and a jacket of three legs that is turned or leans (`qualify/decks/three_legs.yaml`),",
        "as ExtPtfm superelements (24 coordinates, `--layout openfast5`, gravity) under an ElastoDyn tower",
        "with the IEA 15 MW rotor, parked and feathered, the steel undamped: OpenFAST 5.0.0, linearised at",
        "rest and in free decay at steps of 0.01 s, compared with `modes --gravity` of the whole.",
        "`ModCoupling` is 3: with 1 that version writes beyond its arrays, whatever the superelement.",
        "ElastoDyn's tower has two shapes in each direction, its blades three: these cause most of the",
        "differences. `OPENFAST=/path make qualify` writes this page.",
        "",
    ]


def turbine(pitch_deg: float = 90.0) -> Turbine:
    """Return the IEA 15 MW turbine: its ElastoDyn file's nacelle, yaw bearing and hub."""
    rotor = replace(read_flexible_rotor("iea15"), pitch=np.radians(pitch_deg))
    return Turbine(rotor, 644857.0, -5.125, 4.315, 32929058.0, 28249.0, 69131.0, 969952.0)


@dataclass(frozen=True)
class Asset:
    """A turbine on a supported structure whose top carries the turbine's body."""

    title: str
    turbine: Turbine
    structure: Structure
    support: Support


def cases() -> Iterator[tuple[Asset, bool]]:
    """Return assets, each with whether its blades bend."""
    feet = f"Kelvin–Voigt feet ({KELVIN_VOIGT.removeprefix('kelvin-voigt:')})"
    for asset in (on_feet(feet, KELVIN_VOIGT), on_piles()):
        yield from ((asset, False), (asset, True))
    for pitch in PITCHES_DEG:
        yield on_feet(f"{feet}, pitch {pitch:g}°", KELVIN_VOIGT, pitch), True
    yield on_feet(f"softer feet ({SOFTER.removeprefix('kelvin-voigt:')})", SOFTER), True
    yield (
        on_feet(
            f"three legs, turned by 20°, on {SPRINGPOTS}", SPRINGPOTS, structure=three_legs(turn_deg=20.0)
        ),
        False,
    )
    yield on_feet(f"three legs, leaning by 0.1, on {SOFTER}", SOFTER, structure=three_legs(lean=0.1)), False
    yield tower_inside(on_feet(feet, KELVIN_VOIGT)), False
    yield tower_inside(on_feet(feet, KELVIN_VOIGT)), True
    yield (
        tower_inside(
            on_feet(
                f"three legs, turned by 20°, on {SPRINGPOTS}", SPRINGPOTS, structure=three_legs(turn_deg=20.0)
            )
        ),
        False,
    )
    leaning = on_feet(f"three legs, leaning by 0.1, on {SOFTER}", SOFTER, structure=three_legs(lean=0.1))
    yield tower_inside(leaning), False


def on_feet(title: str, support: str, pitch_deg: float = 90.0, structure: Structure | None = None) -> Asset:
    machine = turbine(pitch_deg)
    steel = structure or read_structure("jacket15")
    steel = steel.with_masses((machine.body(steel.top_node),))
    return Asset(title, machine, steel, read_support(support, steel))


def three_legs(*, turn_deg: float = 0.0, lean: float = 0.0) -> Structure:
    """Return a jacket of three legs, turned about the vertical or leaning along x."""
    steel = read_structure(DECKS / "three_legs.yaml")
    top = steel.nodes[steel.interface_nodes[0]][2]
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    nodes = {
        name: (c * x - s * y + lean * max(0.0, top - z), s * x + c * y, z)
        for name, (x, y, z) in steel.nodes.items()
    }
    return replace(steel, nodes=nodes)


def tower_inside(asset: Asset) -> Asset:
    """Return an asset whose interface is the tower's top: `superelement --tower-inside`."""
    structure = replace(asset.structure, interface_nodes=(asset.structure.top_node,))
    return replace(asset, title=f"{asset.title}, tower inside", structure=structure)


def without_turbine(structure: Structure) -> Structure:
    """Return what is reduced: without the turbine, where that stands on the interface itself."""
    kept = tuple(mass for mass in structure.masses if mass.node not in structure.interface_nodes)
    inside = structure.interface_nodes == (structure.top_node,)
    return structure.with_masses(kept) if inside else structure


def on_piles() -> Asset:
    asset = on_feet("the records' piles", KELVIN_VOIGT)
    structure, support = read_foundation("jacket15_records").lumped(asset.structure)
    return replace(asset, structure=structure, support=support)


def compared(program: str, folder: Path, asset: Asset, *, flexible: bool) -> list[str]:
    """Return the table of a case: linearised, and with rigid blades in free decay."""
    structure, support = asset.structure, asset.support
    element = reduced_to_interface(asset)
    write_superelement(element, folder / "jacket.dat")
    run = Run(flexible=flexible, linearise=True, rest=at_rest(structure, element))
    columns = {"linearised": linearised(program, folder, asset, run)}
    if not flexible:
        decay = replace(run, linearise=False, duration_s=DECAY_S, offset_m=0.3)
        columns[DECAY] = decayed(program, folder, asset, decay)
    whole = with_rotor(structure, asset.turbine.rotor, structure.top_node) if flexible else structure
    assembly = assemble(whole, gravity=True)
    system = build_system(assembly, support, spread=own_damping(assembly, Rayleigh()))
    heading = f"{asset.title}, {'bending' if flexible else 'rigid'} blades"
    return table(heading, pairs(system, structure), columns)


def reduced_to_interface(asset: Asset) -> Superelement:
    """Return the foundation under the weight of all that stands on it."""
    foundation, _ = at_interface(without_turbine(asset.structure))
    if asset.structure.interface_nodes == (asset.structure.top_node,):
        # of a tower inside OpenFAST adds the turbine's P-Δ itself: with ours, too, f₁ falls 3 to 5 %
        return superelement(build_system(assemble(foundation), asset.support), number=MODES, band_hz=BAND_HZ)
    weight = assemble(asset.structure, gravity=True).weight
    base = build_system(assemble(foundation, gravity=True, weight=weight), asset.support)
    return superelement(base, number=MODES, band_hz=BAND_HZ)


def at_rest(
    structure: Structure, element: Superelement, *, thrust: FloatArray | None = None
) -> tuple[float, ...]:
    """Return the motions of the interface and of the tower top under the weight, on the element's springs.

    ``thrust`` (6,) are forces and moments at the tower top beside it [N, N·m].
    """
    _, tower = at_interface(structure)
    if tower is None:
        return 2 * _top_at_rest(structure, element, thrust)
    base = structure.interface_nodes[0]
    assembly = assemble(replace(tower, reactions=(Reaction(base),)), gravity=True)
    load = self_weight(assembly)
    load[assembly.dofs(base)] += element.weight_n[:INTERFACE]
    if thrust is not None:
        load[assembly.dofs(structure.top_node)] += thrust
    springs = Support(springs=(Spring(base, element.interface_stiffness),))
    u = static_displacement(build_system(assembly, springs), load)
    return tuple(float(v) for node in (base, structure.top_node) for v in u[assembly.dofs(node)])


def _top_at_rest(structure: Structure, element: Superelement, thrust: FloatArray | None) -> tuple[float, ...]:
    """Return the motion (6,) of an interface at the tower's top under the turbine's weight."""
    whole, bare = (assemble(one) for one in (structure, without_turbine(structure)))
    top = whole.dofs(structure.top_node)
    load = (self_weight(whole) - self_weight(bare))[top] + element.weight_n[:INTERFACE]
    load = load if thrust is None else load + thrust
    return tuple(float(v) for v in np.linalg.solve(element.interface_stiffness, load))


def pairs(system: System, structure: Structure) -> dict[str, complex]:
    """Return our poles of the first and second pairs: those that move the tower's top or middle most."""
    found = damped_modes(system, below_hz=BAND_HZ)
    assembly = system.assembly
    tower = [m.end for m in structure.members if m.part == "tower"]
    rows = np.concatenate([assembly.dofs(node)[:2] for node in tower])
    mass = np.einsum("ij,ij->j", found.shapes.conj(), assembly.mass @ found.shapes).real
    moved = np.abs(found.shapes[rows]).reshape(len(tower), 2, -1) ** 2
    share = moved.sum(axis=0) / mass
    poles = found.eigenvalues
    low = np.abs(poles) < 2.0 * np.pi * 0.3
    chosen = [
        int(np.argmax(np.where(low == first, share[axis], -1.0)))
        for first in (True, False)
        for axis in (1, 0)
    ]
    return {name: complex(poles[k]) for name, k in zip(FOUR, chosen, strict=True)}


def table(title: str, ours: dict[str, complex], columns: dict[str, ComplexArray]) -> list[str]:
    heads = [f"{name} f [Hz], ζ [%] | Δf [%], Δζ/ζ [%]" for name in columns]
    lines = [f"**{title}**", "", f"| pair | `modes` f [Hz], ζ [%] | {' | '.join(heads)} |"]
    lines.append("|---" * (2 + 2 * len(columns)) + "|")
    for name, pole in ours.items():
        cells = [name, _pole(pole)]
        for column, poles in columns.items():
            if column == DECAY and not name.startswith("first"):
                # a tower drawn aside and let go moves in its first modes: the others drown
                cells += ["", ""]
                continue
            other = poles[np.argmin(np.abs(poles - pole))]
            apart = 100.0 * (abs(pole) / abs(other) - 1.0), 100.0 * (_ratio(pole) / _ratio(other) - 1.0)
            cells += [_pole(complex(other)), f"{apart[0]:+.2f}, {apart[1]:+.1f}"]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def _pole(pole: complex) -> str:
    return f"{abs(pole) / 2.0 / np.pi:.4f}, {100.0 * _ratio(pole):.3f}"


def _ratio(pole: complex) -> float:
    return float(-pole.real / abs(pole))


def execute(program: str, primary: Path) -> None:
    """Run a case; what the program says is in ``log.txt`` beside it."""
    log = primary.parent / "log.txt"
    with log.open("w") as stream:
        done = subprocess.run(
            [program, primary.name], cwd=primary.parent, stdout=stream, stderr=stream, check=False
        )
    if done.returncode != 0:
        raise SystemExit(f"OpenFAST refused {primary}:\n{log.read_text(errors='replace')[-2000:]}")


def ready(folder: Path, asset: Asset, run: Run) -> Path:
    """Write the files of a case; return its ``.fst``."""
    return write_case(
        folder,
        asset.structure,
        asset.turbine,
        run,
        foundation="jacket_ExtPtfm.dat",
        depth_m=asset.structure.sea_level_z_m,
    )


def linearised(program: str, folder: Path, asset: Asset, run: Run) -> ComplexArray:
    """Return the oscillating poles of the linearised system [rad/s]."""
    primary = ready(folder, asset, run)
    execute(program, primary)
    lines = (folder / "case.1.lin").read_text().splitlines()
    at = next(k for k, line in enumerate(lines) if line.strip().startswith("A:"))
    found = re.search(r"(\d+) *x", lines[at])
    assert found is not None
    n = int(found[1])
    A = np.array([[float(v) for v in line.split()] for line in lines[at + 1 : at + 1 + n]])
    values = np.linalg.eigvals(A)
    return np.asarray(values[values.imag > 0.0])


def decayed(program: str, folder: Path, asset: Asset, run: Run) -> ComplexArray:
    """Return the poles of a free decay by a subspace of each direction's accelerations [rad/s]."""
    primary = ready(folder, asset, run)
    execute(program, primary)
    found = read_text(folder / "case.out")
    started = found.times_s > 5.0
    step = float(np.diff(found.times_s[:2])[0])
    every = max(1, round(0.2 / step))
    rows = [found.data[found.names.index(name)][started][::every] for name in ("YawBrTAxp", "YawBrTAyp")]
    return np.concatenate([_poles_of_decay(row - row.mean(), every * step) for row in rows])


def _poles_of_decay(x: FloatArray, step: float, *, order: int = 12, rows: int = 100) -> ComplexArray:
    hankel = np.lib.stride_tricks.sliding_window_view(x, x.size - rows + 1)
    basis = np.linalg.svd(hankel, full_matrices=False)[0][:, :order]
    advance = np.linalg.lstsq(basis[:-1], basis[1:], rcond=None)[0]
    values = np.log(np.linalg.eigvals(advance).astype(np.complex128)) / step
    return np.asarray(values[values.imag > 0.0])


if __name__ == "__main__":
    main()
