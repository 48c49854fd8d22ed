"""What stress from sensors costs: a ten-minute record of eight channels, a stream, a year of a turbine.

jacket15 parked in wind and sea. One record as the living twin takes it: the structures that its frequencies
leave likely, levels of the forces, motion, damage at the worst welds. The stream is what remains once levels
are known: a minute of readings at a time to motion, to stress at the eight points of both sides of every
weld, and to cycles with their residues. CPU seconds.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from time import process_time

import numpy as np
import yaml

from jackettwin.decks import read_structure
from jackettwin.fatigue import Counter
from jackettwin.identification import identify
from jackettwin.records import Record
from jackettwin.response import observation_matrix
from jackettwin.sensing import SensorReadings, Weather, estimate_motion, readings_of
from jackettwin.simulate import read_scenario, simulate
from jackettwin.structure import Rayleigh, assemble
from jackettwin.twin import LifeSettings, RestingLoads, StressModel, weld_map
from jackettwin.twin.life.likely_structures import LikelyStructures, likely_structures
from jackettwin.twin.life.sensed_damage import sensed_damage
from jackettwin.updating import numbered_modes

REPEATS = 5
LAG_S, PIECE_S = 10.0, 60.0
DEPTH_M = 72.0
SCENARIO = {
    "structure": "jacket15",
    "gravity": True,
    "support": "kelvin-voigt:k=1.2e9,c=2.5e7",
    "damping": {"rayleigh": {"ratio": 0.0055, "frequency_hz": 0.3}},
    "water": {"depth_m": DEPTH_M},
    "waves": {"type": "jonswap", "hs_m": 2.5, "tp_s": 7.5, "direction_deg": 20.0, "seed": 1},
    "wind": {"speed_m_s": 12.0, "turbulence": "B", "seed": 2},
    "rotor": {"data": "iea15", "state": "parked"},
    "time": {"duration_s": 600.0, "step_s": 0.05, "discard_s": 60.0},
    "sensors": [
        {"channel": f"acc_{h}_{axis}", "height_m": h, "direction": d, "noise": 5e-4}
        for h in (144.0, 77.0, 41.0, 28.0)
        for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    ],
}


def main() -> None:
    matrix = np.random.default_rng(0).standard_normal((800, 800))
    eig_s = timed(lambda: np.linalg.eig(matrix), 1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.yaml"
        path.write_text(yaml.safe_dump(SCENARIO))
        scenario = read_scenario(str(path))
        simulated = simulate(scenario).record
    sensors = tuple(one.sensor for one in scenario.instruments)
    n = len(sensors)
    record = Record(simulated.data[:n], simulated.sample_rate_hz, simulated.channels[:n])
    model, weather = stress_model(), Weather.of(simulated.conditions, DEPTH_M)
    modes = {
        k + 1: mode
        for k, mode in enumerate(m for m in identify(record).modes if m.status.is_a_mode and k_below(m))
    }

    def one() -> LikelyStructures:
        likely = likely_structures(model, modes, 1e9, sensors=observation_matrix(model.assembly, sensors))
        sensed_damage(likely, readings_of(record, sensors, model.assembly), weather)
        return likely

    likely = one()
    record_s = timed(one, REPEATS)
    readings = readings_of(record, sensors, model.assembly)
    duration = readings.y.shape[1] * readings.step_s
    sys.stdout.write(
        f"a record of {n} channels: {record_s:.2f} CPU-s (dense eig of 800: {eig_s:.2f})\n"
        f"a year of records: {record_s * 52_596 / 3600.0:.1f} core-hours\n"
    )
    for most in (20, 10_000):
        stream_s, points = streamed(likely, readings, weather, most)
        sys.stdout.write(f"a stream to {points} points: {duration / stream_s:.0f} times real time\n")


def k_below(mode: object) -> bool:
    """Whether a mode is of the first pair."""
    return float(getattr(mode, "frequency_hz", np.inf)) < 0.25


def stress_model() -> StressModel:
    """Return what jacket15's stresses are told with."""
    structure = read_structure("jacket15")
    assembly = assemble(structure, gravity=True)
    return StressModel(
        LifeSettings(),
        assembly,
        RestingLoads.of(assemble(structure)),
        Rayleigh.minimum(0.005, 0.3),
        numbered_modes(assembly, 12),
        depth_m=DEPTH_M,
    )


def streamed(
    likely: LikelyStructures, readings: SensorReadings, weather: Weather, most: int
) -> tuple[float, int]:
    """Return the CPU seconds of a stream of the readings, and how many points' cycles are counted.

    Parameters
    ----------
    most : number of welds at most, each with eight points of both sides
    """
    system = likely.systems(1)[0]
    estimate = estimate_motion(system, readings, weather)
    chart = weld_map(system, estimate.model, likely.model.rest)
    rows, y = estimate.to_coordinates, readings.y.T
    lag, piece = round(LAG_S / readings.step_s), round(PIECE_S / readings.step_s)
    counters: list[list[Counter]] = []
    for joint in chart.joints:
        left = most - sum(map(len, counters)) // 16
        counters.append([Counter() for _ in range(16 * min(left, len(joint.welds)))])
    start = process_time()
    state = estimate.smoother.stationary[0] * 0.0
    for first in range(0, len(y) - lag, piece):
        motion, state = estimate.smoother.smooth(y[first : first + piece + lag], state, ahead=lag, rows=rows)
        for j, own in enumerate(counters):
            if not own:
                continue
            stress = chart.stress(j, motion, range(len(own) // 16)).reshape(len(own), -1)
            for counter, series in zip(own, stress, strict=True):
                counter.add(series)
                counter.closed()
    return process_time() - start, sum(map(len, counters))


def timed(run: object, repeats: int) -> float:
    """Return the CPU seconds of one run."""
    start = process_time()
    for _ in range(repeats):
        run()  # type: ignore[operator]
    return (process_time() - start) / repeats


if __name__ == "__main__":
    main()
