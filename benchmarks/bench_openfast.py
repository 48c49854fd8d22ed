"""CPU seconds a simulated second in an irregular sea, of OpenFAST and of ours.

Runs where ``OPENFAST=/path/openfast`` is set. jacket15 and the OC4 jacket by OpenFAST with SubDyn, HydroDyn
and ElastoDyn, and by ours: jacket15 as scenario ``parked``, with wind as well.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

sys.path.insert(0, str(Path(__file__).parents[1] / "qualify"))
import hydrodyn
import numpy as np
import openfast
import yaml
from common.hydrodyn_deck import Water, write_water
from common.openfast_deck import Run, Turbine, write_case

from jackettwin.decks import read_structure
from jackettwin.decks.subdyn_writer import write_subdyn
from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.soil import read_support, with_static_reactions
from jackettwin.structure import Structure
from jackettwin.structure.cut import at_interface

SEA_M_S = 2.5, 8.0
"""Significant height and peak period of ``parked``."""
STEP_S = 0.01
PIECE_M = 8.0
"""HydroDyn's: OpenFAST starts with the product of dense matrices of 18 rows a piece, so that pieces of 2 m
cost it many times as much before the first step."""
SIMULATED_S = 0.1, 2.1
"""What OpenFAST is asked: the difference is free of its start-up."""
OC4_DEPTH_M, OC4_FEET = 50.0, "kelvin-voigt:k=6e8,c=1.2e7"


def main() -> None:
    program = os.environ.get("OPENFAST", "")
    if not Path(program).is_file():
        sys.stdout.write("OPENFAST is not set to the program: nothing is run\n")
        return
    feet = read_structure("jacket15")
    report("OC4, OpenFAST", theirs(program, oc4(), small_turbine(), OC4_FEET, OC4_DEPTH_M))
    report("OC4, ours", ours(oc4_scenario()))
    report(
        "jacket15, OpenFAST",
        theirs(program, feet, openfast.turbine(), openfast.KELVIN_VOIGT, feet.sea_level_z_m),
    )
    report("jacket15, ours (with wind)", ours(read_scenario("parked")))


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


def oc4() -> Structure:
    """Return the OC4 jacket with its tower named."""
    deck = read_structure(hydrodyn.DECK)
    tower = at_interface(deck)[1]
    assert tower is not None
    above = {(m.start, m.end) for m in tower.members}
    members = tuple(replace(m, part="tower") if (m.start, m.end) in above else m for m in deck.members)
    return replace(deck, members=members)


def small_turbine() -> Turbine:
    """Return one of 5 MW: blades half as long as the IEA 15 MW turbine's and half as heavy a metre."""
    rotor = openfast.turbine().rotor
    blade = replace(rotor.blade, z=0.5 * rotor.blade.z, mass_kg_m=0.5 * rotor.blade.mass_kg_m)
    return Turbine(replace(rotor, blade=blade), 240000.0, 1.9, 1.75, 2607890.0, 0.0, 56780.0, 115926.0)


def theirs(program: str, steel: Structure, turbine: Turbine, feet: str, depth_m: float) -> float:
    others = tuple(m for m in steel.masses if m.node != steel.top_node)
    steel = steel.with_masses((*others, turbine.body(steel.top_node)))
    foundation, _ = at_interface(steel)
    held = with_static_reactions(foundation, read_support(feet, steel))
    spent = []
    for duration in SIMULATED_S:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            write_subdyn(held, folder / "deck.dat")
            write_water(folder, steel, Water(depth_m, *SEA_M_S, waves="2", piece_m=PIECE_M))
            run = Run(duration_s=duration, step_s=STEP_S, sub=1, water=True)
            case = write_case(folder, steel, turbine, run, foundation="deck.dat", depth_m=depth_m)
            spent.append(cpu(lambda case=case: openfast.execute(program, case)))
    return float(np.diff(spent)[0] / np.diff(SIMULATED_S)[0])


def oc4_scenario() -> Scenario:
    height, period = SEA_M_S
    content = {
        "structure": str(hydrodyn.DECK),
        "gravity": True,
        "support": OC4_FEET,
        "water": {"depth_m": OC4_DEPTH_M},
        "waves": {"type": "jonswap", "hs_m": height, "tp_s": period, "seed": 1},
        "rotor": {"data": "none"},
        "time": {"duration_s": 600.0},
        "sensors": [{"channel": "acc_top_x", "node": "74", "direction": [1, 0, 0]}],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "oc4.yaml"
        path.write_text(yaml.safe_dump(content))
        return read_scenario(str(path))


def ours(scenario: Scenario) -> float:
    simulate(scenario)  # compiles
    return cpu(lambda: simulate(scenario)) / scenario.clock.duration_s


if __name__ == "__main__":
    main()
