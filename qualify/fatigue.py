"""Does a twin with a few accelerometers know the stress at welds? Simulated jackets whose stresses are known.

Ground, damping, mass of the rotor, marine growth, wind, sea, state and the sensors' noise are drawn, none of
which the twin is told but the mean wind and the sea's height, period and direction. The twin updates its feet
with the record itself. The truth is the simulation's own: section forces of its model with waves along the
members. Beside the smoother on the updated twin stand the same on stiff feet, modal expansion of
accelerations that are integrated twice, and an augmented Kalman filter with forces on the tower top that walk
at random, both on the updated twin. Usage: python qualify/fatigue.py [n_records]
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import yaml
from common.cases import Result, cases
from common.page import write_page

from jackettwin.errors import JackettwinError
from jackettwin.fatigue import count, equivalent_range
from jackettwin.records import Record, write_record
from jackettwin.response import System, observation_matrix
from jackettwin.sensing import (
    LatentForce,
    MotionEstimate,
    MotionModel,
    SensorReadings,
    Weather,
    moved,
    readings_of,
    section_rows,
    sensed_model,
)
from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.structure import Assembly, SectionForces, assemble, section_forces
from jackettwin.study import updated, updated_systems
from jackettwin.twin import WeldMap, read_twin, weld_map

SEED = 36
STEP_S = 0.05
DEPTH_M = 72.0
M = 4.0
"""Inverse slope of damage-equivalent ranges: between the two of curve T."""
DRAWS, SUPPORTS = 4, 3
SPOTS = 20
"""Hot spots of each record whose intervals are judged: those that are damaged most."""
HEIGHTS_M = (144.0, 28.0, 77.0, 41.0)
BANDS = ((-80.0, -40.0), (-40.0, -15.0), (-15.0, 15.0), (15.0, 40.0))
METHODS = ("smoother", "before updating", "modal expansion", "augmented Kalman", "4 sensors", "1 DC sensor")
STATES = ("parked", "idling", "operating")


def drawn(case: int) -> tuple[str, dict[str, Any]]:
    """Draw a scenario: state of the turbine, and all that the twin is not told."""
    rng = np.random.default_rng((SEED, case))
    state = STATES[case % len(STATES)]
    storm = case % 7 == 3
    hs = 8.0 if storm else float(rng.uniform(1.0, 5.0))
    if state == "operating":
        hs = min(hs, 4.0)
    wind = float(rng.uniform(6.0, 20.0) if state == "operating" else rng.uniform(6.0, 28.0))
    k = 10 ** rng.uniform(8.7, 9.4)
    mass = float(rng.uniform(0.98, 1.02))
    noise = 10 ** rng.uniform(-4.0, -3.0)
    scenario = {
        "structure": "jacket15",
        "gravity": True,
        "support": f"kelvin-voigt:k={k:.4g},c={k * 10 ** rng.uniform(-2.0, -1.4):.4g}",
        "rna": {
            "mass_kg": 808928.0 * mass,
            "static_moment_kg_m": [-5897995.0 * mass, 0.0, 3725438.0 * mass],
            "inertia_about_node_kg_m2": [3.702e8 * mass, 2.472e8 * mass, 2.487e8 * mass, 0.0, 0.0, 0.0],
        },
        "damping": {"rayleigh": {"ratio": float(rng.uniform(0.003, 0.01)), "frequency_hz": 0.3}},
        "water": {
            "depth_m": DEPTH_M,
            "marine_growth": [
                {"top_z_m": 2.0, "bottom_z_m": -40.0, "thickness_m": float(rng.uniform(0.0, 0.15))}
            ],
        },
        "waves": {
            "type": "jonswap",
            "hs_m": hs,
            "tp_s": float(rng.uniform(3.9, 4.8) * np.sqrt(hs) + 1.0),
            "direction_deg": float(rng.uniform(0.0, 360.0)),
            "spreading": 10,
            "seed": int(rng.integers(1_000_000)),
        },
        "wind": {"speed_m_s": wind, "turbulence": "B", "seed": int(rng.integers(1_000_000))},
        "rotor": {"data": "iea15", "state": state},
        "time": {"duration_s": 600.0, "step_s": STEP_S, "discard_s": 60.0},
        "sensor_seed": int(rng.integers(1_000_000)),
        "sensors": [
            {"channel": f"acc_{h:.0f}_{axis}", "height_m": h, "direction": d, "noise": float(noise)}
            for h in HEIGHTS_M
            for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
        ],
    }
    return ("storm, " if storm else "") + state, scenario


def twin_of(record: Path) -> dict[str, Any]:
    """Return the twin: the drawings' jacket, pinned until it is updated."""
    return {
        "structure": "jacket15",
        "gravity": True,
        "rna": {
            "mass_kg": 808928.0,
            "static_moment_kg_m": [-5897995.0, 0.0, 3725438.0],
            "inertia_about_node_kg_m2": [3.702e8, 2.472e8, 2.487e8, 0.0, 0.0, 0.0],
        },
        "damping": {"rayleigh": {"ratio": 0.0055, "frequency_hz": 0.3}},
        "support": {"law": "kelvin-voigt", "tie": "all"},
        "records": [str(record)],
        "update": {"laws": ["kelvin-voigt"], "modes": [1, 2, 4, 5], "starts": 4, "particles": 50},
    }


def mudline_moment(assembly: Assembly, forces: SectionForces) -> np.ndarray:
    """Return the moment (2, n) about the horizontal axes, of all that passes into the feet."""
    mesh, structure = assembly.mesh, assembly.structure
    feet = {mesh.node_names.index(node) for node in structure.reaction_nodes}
    total = np.zeros((3, forces.axial.shape[0]))
    for e in range(mesh.start.size):
        for end, node in ((0, mesh.start[e]), (1, mesh.end[e])):
            if int(node) in feet:
                sign = 1.0 if end == 0 else -1.0
                axes, at = mesh.axes[e].T, mesh.coordinates[node]
                force = axes @ np.array(
                    [forces.axial[:, e, end], forces.shear_y[:, e, end], forces.shear_z[:, e, end]]
                )
                moment = axes @ np.array(
                    [forces.torsion[:, e, end], forces.bending_y[:, e, end], forces.bending_z[:, e, end]]
                )
                total += sign * (moment + np.cross(at, force.T).T)
    return total[:2]


def tower_moments(assembly: Assembly, forces: SectionForces, name: str, end: int) -> np.ndarray:
    """Return both bending moments (2, n) at an end of a member of the tower."""
    names = [assembly.structure.members[m].name for m in assembly.mesh.member]
    e = names.index(name) if end == 0 else len(names) - 1 - names[::-1].index(name)
    return np.array([forces.bending_y[:, e, end], forces.bending_z[:, e, end]])


def sections(assembly: Assembly, forces: SectionForces) -> dict[str, np.ndarray]:
    """Return the moments that are judged, {name: (2, n)}."""
    return {
        "tower base": tower_moments(assembly, forces, "tower_1", 0),
        "tower top": tower_moments(assembly, forces, "tower_12", 0),
        "mud line": mudline_moment(assembly, forces),
    }


def dels(series: np.ndarray) -> np.ndarray:
    """Return damage-equivalent ranges of rows (k, n)."""
    return np.array([equivalent_range(count(np.ascontiguousarray(row)), M, 1.0) for row in series])


class Judge:
    """What is judged of a system: its moments' rows and its welds' stresses."""

    def __init__(self, system: System, model: MotionModel, dry: Assembly) -> None:
        rows = section_rows(model)
        self.rows = sections(model.assembly, rows)
        self.chart: WeldMap = weld_map(system, model, dry)

    def dels(self, motion: np.ndarray, wanted: list[tuple[int, int, int, int]]) -> np.ndarray:
        """Return ranges of the moments, then of wanted points (joint, brace, side, point)."""
        moments = np.concatenate([dels(rows @ motion.T) for rows in self.rows.values()])
        stress = {j: self.chart.stress(j, motion) for j in {key[0] for key in wanted}}
        return np.concatenate([moments, dels(np.array([stress[j][b, s, p] for j, b, s, p in wanted]))])


def truth_of(
    path: Path, system_of: Judge
) -> tuple[Any, np.ndarray, list[tuple[int, int, int, int]], np.ndarray]:
    """Return scenario, true ranges, the worst point of each weld's sides, and displacements."""
    scenario = read_scenario(str(path))
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    blocks, moved_by = [], []
    for u, along in deflections(scenario, motion):
        blocks.append(np.stack(section_forces(assembly, u, along=along), axis=-1))
        moved_by.append(u)
    forces = SectionForces(*np.moveaxis(np.concatenate(blocks), -1, 0))
    moments = np.concatenate([dels(one) for one in sections(assembly, forces).values()])
    wanted, ranges = [], []
    for j, joint in enumerate(system_of.chart.joints):
        stress = joint.stress(assembly, forces)
        for b in range(stress.shape[0]):
            for s in range(2):
                each = dels(stress[b, s])
                p = int(each.argmax())
                wanted.append((j, b, s, p))
                ranges.append(each[p])
    return scenario, np.concatenate([moments, ranges]), wanted, np.concatenate(moved_by)


def kalman(system: System, seen: SensorReadings, weather: Weather) -> tuple[MotionModel, np.ndarray]:
    """Return the motion by an augmented Kalman filter: top forces that walk at random, no look ahead."""
    known = sensed_model(system, weather)
    pick = [i for i, f in enumerate(known.forces) if f.name in ("rotor Fx, slow", "rotor Fy, slow")]
    walking: tuple[LatentForce, ...] = tuple(replace(known.forces[i], rate=1e-3) for i in pick)
    model = replace(known, forces=walking, flexibility=known.flexibility[:, pick])
    found = moved(model, seen)
    return found.model, found.smoother.filtered(seen.y.T) @ found.to_coordinates.T


def expansion(system: System, seen: SensorReadings, weather: Weather) -> tuple[MotionModel, np.ndarray]:
    """Return the motion by modal expansion: modes fitted to accelerations and integrated twice.

    What is slower than 0.05 Hz is left out, as integration would drown it in noise.
    """
    model = sensed_model(system, weather)
    n = seen.y.shape[1]
    keep = min(5, seen.y.shape[0])
    spectrum = np.fft.rfft(np.linalg.pinv(seen.rows @ model.shapes[:, :keep]) @ seen.y, axis=1)
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, seen.step_s)
    band = omega > 2.0 * np.pi * 0.05
    spectrum[:, band] /= -(omega[band] ** 2)
    spectrum[:, ~band] = 0.0
    motion = np.zeros((n, model.n_modes + len(model.forces)))
    motion[:, :keep] = np.fft.irfft(spectrum, n, axis=1).T
    return model, motion


def run(case: int) -> Result:
    """Return what is said of one record, or why nothing is."""
    start = process_time()
    try:
        return judged(case)
    except JackettwinError as error:
        return {"state": drawn(case)[0], "cpu_s": process_time() - start, "lost": str(error)}


def judged(case: int) -> Result:
    """Return, for one record, ranges over true ones by every method, and how far off they were said to be."""
    state, drawing = drawn(case)
    with tempfile.TemporaryDirectory() as folder:
        path, file = Path(folder) / "scenario.yaml", Path(folder) / "record.parquet"
        path.write_text(yaml.safe_dump(drawing))
        simulated = simulate(read_scenario(str(path))).record
        write_record(simulated, file)
        twin = Path(folder) / "twin.yaml"
        twin.write_text(yaml.safe_dump(twin_of(file)))
        config = read_twin(str(twin))
        about: Result = {
            "state": state,
            "hs_m": drawing["waves"]["hs_m"],
            "wind_m_s": drawing["wind"]["speed_m_s"],
        }
        start = process_time()
        update = updated(config)
        update_s = process_time() - start
        systems = updated_systems(update, draws=SUPPORTS - 1)
        weather = Weather.of(simulated.conditions, DEPTH_M)
        dry = assemble(config.structure)
        first = sensed_model(systems[0], weather)
        scenario, true, wanted, displacement = truth_of(path, Judge(systems[0], first, dry))
    sensors = tuple(i.sensor for i in scenario.instruments)
    record = Record(
        simulated.data[: len(sensors)], simulated.sample_rate_hz, simulated.channels[: len(sensors)]
    )
    seen = readings_of(record, sensors, systems[0].assembly)
    estimates: dict[str, np.ndarray] = {}
    start = process_time()
    every = []
    for k, system in enumerate(systems):
        found = moved(sensed_model(system, weather), seen)
        judge = Judge(system, found.model, dry)
        every.append([judge.dels(motion, wanted) for motion in found.draws(DRAWS, seed=k)])
    smoother_s = process_time() - start
    draws = np.log(np.array(every))
    estimates["smoother"] = np.exp(draws[0].mean(axis=0))
    within = draws.var(axis=1, ddof=1).mean(axis=0)
    between = draws.mean(axis=1).var(axis=0, ddof=1)
    std = np.sqrt(within + np.maximum(between - within / DRAWS, 0.0))
    estimates["before updating"] = _mean(update.model.system(_stiffest(update)), seen, weather, dry, wanted)
    for name, method in (("modal expansion", expansion), ("augmented Kalman", kalman)):
        model, motion = method(systems[0], seen, weather)
        estimates[name] = Judge(systems[0], model, dry).dels(motion, wanted)
    few = readings_of(
        Record(record.data[:4], record.sample_rate_hz, record.channels[:4]), sensors[:4], systems[0].assembly
    )
    estimates["4 sensors"] = _mean(systems[0], few, weather, dry, wanted)
    estimates["1 DC sensor"] = _mean(
        systems[0], _felt(record, sensors, displacement, systems[0]), weather, dry, wanted
    )
    heights = [_height(j, first, judge) for j in range(len(judge.chart.joints))]
    z = [heights[j] for j, _, _, _ in wanted]
    worst = 6 + np.argsort(-true[6:])[:SPOTS]
    score = (np.log(true) - draws.mean(axis=(0, 1))) / std
    return about | {
        "cpu_s": update_s + smoother_s,
        "smoother_s": smoother_s / len(systems),
        "ratio": {name: (values / true).tolist() for name, values in estimates.items()},
        "true": true.tolist(),
        "z_m": z,
        "judged": [0, 1, 4, 5, *map(int, worst)],
        "score": score.tolist(),
    }


def _height(joint: int, model: MotionModel, judge: Judge) -> float:
    structure = model.assembly.structure
    return float(structure.nodes[judge.chart.joints[joint].plan.node][2] - structure.sea_level_z_m)


def _stiffest(update: Any) -> np.ndarray:
    """Return the parameters of feet that hardly move: the twin before anything was measured."""
    best = np.log(update.best.theta)
    vector = update.problem.vectors(best[None], update.problem.states[0])[0].copy()
    vector[0] *= 30.0
    return np.asarray(vector)


def _mean(
    system: System,
    seen: SensorReadings,
    weather: Weather,
    dry: Assembly,
    wanted: list[tuple[int, int, int, int]],
) -> np.ndarray:
    found: MotionEstimate = moved(sensed_model(system, weather), seen)
    judge = Judge(system, found.model, dry)
    return np.exp(np.mean([np.log(judge.dels(motion, wanted)) for motion in found.draws(2)], axis=0))


def _felt(record: Record, sensors: Any, displacement: np.ndarray, system: System) -> SensorReadings:
    """Return what one pair of accelerometers at the top reads that feels gravity, too."""
    lean = [replace(s, quantity="inclination") for s in sensors[:2]]
    felt = 9.80665 * (observation_matrix(system.assembly, tuple(lean)) @ displacement.T)
    n = min(record.data.shape[1], felt.shape[1])
    data = record.data[:2, :n] - felt[:, :n]
    one = Record(data, record.sample_rate_hz, record.channels[:2])
    return readings_of(one, sensors[:2], system.assembly, feel_gravity=True)


def quantiles(values: list[float]) -> str:
    """Return the median and the 5 to 95 % range of ratios less one, in per cent."""
    if not values:
        return "– |"
    low, middle, high = 100.0 * (np.quantile(values, [0.05, 0.5, 0.95]) - 1.0)
    size = 100.0 * np.median(np.abs(np.array(values) - 1.0))
    return f"{middle:+.1f} ({low:+.0f} … {high:+.0f}) | {size:.1f} |"


def ratios(results: list[Result], method: str, place: str) -> list[float]:
    """Return ratios at a place: moments by name (the larger of two directions), or hot spots by elevation."""
    found = []
    for one in results:
        values, true = np.array(one["ratio"][method]), np.array(one["true"])
        if place in ("tower base", "tower top", "mud line"):
            at = 2 * ("tower base", "tower top", "mud line").index(place)
            found.append(float(values[at + int(true[at + 1] > true[at])]))
        else:
            low, high = map(float, place.split(" to "))
            z, spots = np.array(one["z_m"]), true[6:]
            inside = (z >= low) & (z < high)
            # what matters: the more damaged half of the level's welds
            inside &= spots >= np.median(spots[inside])
            found += values[6:][inside].tolist()
    return found


def main() -> None:
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 210
    every = cases("fatigue", n, run, whole=True)
    results = [one for one in every if "lost" not in one]
    places = ["tower base", "tower top", "mud line", *(f"{low:g} to {high:g}" for low, high in BANDS)]
    lines = [
        "# Stress at welds from a few accelerometers",
        "",
        f"`python qualify/fatigue.py {n}`: {n} simulated ten-minute records of jacket15; ground, damping, "
        "mass, growth and "
        "weather drawn and unknown to the twin but for mean wind and sea; "
        "it updates its feet with the record itself"
        + (
            f" ({len(every) - len(results)} records gave no result and are left out)."
            if len(every) > len(results)
            else "."
        ),
        f"Damage-equivalent range (m = {M:g}) over the true one, less one, in per cent: "
        "median (5 to 95 % of records), then the "
        "median size of the error. Moments in the direction that is loaded most; hot spots "
        "by elevation [m] above the sea, the more damaged half.",
        "",
        "| method | place | all | size | " + " | ".join(f"{state} | size" for state in STATES) + " |",
        "|---|---|---|---|" + "---|---|" * len(STATES),
    ]
    for method in METHODS:
        for place in places:
            parts = [quantiles(ratios(results, method, place))]
            parts += [
                quantiles(ratios([r for r in results if r["state"].endswith(s)], method, place))
                for s in STATES
            ]
            lines.append(f"| {method} | {place} | " + " ".join(parts))
    scores = np.concatenate([np.array(one["score"])[one["judged"]] for one in results])
    lines += [
        "",
        "| 90 % intervals of the smoother | judged | inside | true above | true below |",
        "|---|---|---|---|---|",
    ]
    groups = [("all", results), *((s, [r for r in results if r["state"].endswith(s)]) for s in STATES)]
    groups.append(("storm, Hs 8 m", [r for r in results if r["hs_m"] >= 8.0]))
    for name, group in groups:
        if group:
            scores = np.concatenate([np.array(one["score"])[one["judged"]] for one in group])
            above, below = (scores > 1.645).mean(), (scores < -1.645).mean()
            shares = " | ".join(f"{100 * share:.0f} %" for share in (1.0 - above - below, above, below))
            lines.append(f"| {name} | {scores.size} | {shares} |")
    seconds = np.median([one["smoother_s"] for one in results])
    lines += [
        "",
        f"The smoother with {DRAWS} motions and all welds took {seconds:.2f} CPU-s a record and support.",
    ]
    write_page("fatigue", lines)


if __name__ == "__main__":
    main()
