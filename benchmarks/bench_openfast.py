"""CPU seconds a simulated second in an irregular sea, of OpenFAST and of ours.

Runs where ``OPENFAST=/path/openfast`` and ``HYDRODYN=/path/hydrodyn_driver`` are set. jacket15 by OpenFAST
with SubDyn, HydroDyn and ElastoDyn, by ours as scenario ``parked``, with wind; the loads on the whole OC4
jacket held still, by HydroDyn's driver and by ours.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

sys.path.insert(0, str(Path(__file__).parents[1] / "qualify"))
import hydrodyn
import numpy as np
import openfast
from common.hydrodyn_deck import Water, write_water
from common.openfast_deck import Run, write_case

from jackettwin.loads.coefficients import Coefficients
from jackettwin.loads.morison import above_bed, morison_points, point_forces, wetness
from jackettwin.loads.waves import irregular_sea
from jackettwin.simulate import read_scenario, simulate
from jackettwin.soil import read_support, with_static_reactions
from jackettwin.structure import assemble, read_structure
from jackettwin.structure.cut import at_interface
from jackettwin.structure.subdyn_deck import write_subdyn

SEA_M_S = 2.5, 8.0
"""Significant height and peak period of ``parked``."""
STEP_S = 0.01
SIMULATED_S = 0.05, 0.15
"""What OpenFAST is asked: the difference is free of its start-up."""


def main() -> None:
    programs = [os.environ.get(name, "") for name in ("OPENFAST", "HYDRODYN")]
    if not all(Path(program).is_file() for program in programs):
        sys.stdout.write("OPENFAST and HYDRODYN are not set to the programs: nothing is run\n")
        return
    report("jacket15, OpenFAST", jacket(programs[0]))
    scenario = read_scenario("parked")
    simulate(scenario)  # compiles
    report("jacket15, ours (with wind)", cpu(lambda: simulate(scenario)) / 600.0)
    report("loads on OC4, HydroDyn", oc4(programs[1]))
    report("loads on OC4, ours", our_oc4())


def report(what: str, seconds: float) -> None:
    sys.stdout.write(f"{what:30s} {seconds:10.5f} CPU-s a simulated second\n")
    sys.stdout.flush()


def cpu(action: Callable[[], object]) -> float:
    """Return the CPU time of an action and of the programs it starts [s]."""

    def spent() -> float:
        return sum(u.ru_utime + u.ru_stime for u in map(getrusage, (RUSAGE_SELF, RUSAGE_CHILDREN)))

    start = spent()
    action()
    return spent() - start


def jacket(program: str) -> float:
    steel = read_structure("jacket15")
    machine = openfast.turbine()
    steel = steel.with_masses((machine.body(steel.top_node),))
    foundation, _ = at_interface(steel)
    support = read_support("kelvin-voigt:k=2.5e9,c=0", steel)
    spent = []
    for duration in SIMULATED_S:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            write_subdyn(with_static_reactions(foundation, support), folder / "deck.dat")
            write_water(folder, steel, Water(openfast.DEPTH_M, *SEA_M_S, waves="2"))
            run = Run(duration_s=duration, step_s=STEP_S, sub=1, water=True)
            case = write_case(folder, steel, machine, run, foundation="deck.dat", depth_m=openfast.DEPTH_M)
            spent.append(cpu(lambda case=case: openfast.execute(program, case)))
    return float(np.diff(spent)[0] / np.diff(SIMULATED_S)[0])


OC4 = Water(50.0, *SEA_M_S, waves="2", duration_s=60.0)


def oc4(program: str) -> float:
    with tempfile.TemporaryDirectory() as name:
        return cpu(lambda: hydrodyn.hydrodyn(program, Path(name), OC4)) / OC4.duration_s


def our_oc4() -> float:
    assembly = assemble(read_structure(hydrodyn.DECK))
    height, period = SEA_M_S
    sea = irregular_sea(Hs=height, Tp=period, depth=OC4.depth_m, duration=OC4.duration_s, seed=1)
    times = np.arange(0.0, OC4.duration_s, hydrodyn.STEP_S)

    def loads() -> None:
        grid = morison_points(
            assembly,
            highest_z=0.0,
            lowest_z=-OC4.depth_m,
            coefficients=Coefficients(),
            spacing=hydrodyn.PIECE_M,
        )
        wet = wetness(grid, sea.surface(grid.points, times)) * above_bed(grid, OC4.depth_m)
        point_forces(grid, *sea.motion(grid.points, times), wet=wet)

    return cpu(loads) / OC4.duration_s


if __name__ == "__main__":
    main()
