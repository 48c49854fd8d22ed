"""Does a twin with a few accelerometers know the stress at welds? Simulated jackets whose stresses are known.

Of every asset feet (each another), damping, stiffness and mass of its steel, mass of the rotor, marine
growth, drag and added mass are drawn, of every record wind, sea and the sensors' noise; the twin is told its
turbine, state, mean wind and the sea's height, period and direction. It updates its feet with two records
of its own; then four others are judged:
parked, idling, operating and in a storm. The truth is the simulation's own: section forces of its model with
waves along the members. Beside the smoother stand modal expansion of accelerations that are integrated twice,
the same in three bands, and an augmented Kalman filter with forces on the tower top that walk at random and
forget, each on the updated twin and on feet thirty times stiffer.

Usage: python qualify/fatigue.py [n_records] [seed: other assets and weathers, printed alone]
"""

from __future__ import annotations

import pickle
import sys
import tempfile
from dataclasses import replace
from functools import partial
from importlib.resources import files
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np
import yaml
from common.cases import KEPT, Result, cases, digest
from common.command import arguments
from common.page import write_page

from jackettwin.decks import read_structure
from jackettwin.errors import JackettwinError
from jackettwin.fatigue import count, equivalent_range
from jackettwin.intervals import NORMAL_90
from jackettwin.loads import Coefficients, read_rotor
from jackettwin.records import Record, write_record
from jackettwin.response import Sensor, System, observation_matrix
from jackettwin.sensing import (
    SECTION_REMAINDER,
    LatentForce,
    MotionEstimate,
    MotionModel,
    RotorByWind,
    SensorReadings,
    Weather,
    likely_motions,
    motion_from,
    readings_of,
    section_rows,
    sensed_model,
    stress_remainder,
)
from jackettwin.simulate import Scenario, read_scenario, simulate
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.structure import Assembly, SectionForces, assemble, section_forces
from jackettwin.study import updated, updated_systems
from jackettwin.twin import RestingLoads, WeldMap, read_twin, weld_map

USUAL_SEED = 36
GIVEN = arguments(__doc__, n=48, seed=USUAL_SEED) if __name__ == "__main__" else None
SEED = GIVEN.seed if GIVEN else USUAL_SEED
STEP_S = 0.05
DEPTH_M = 72.0
M = 4.0
"""Inverse slope of damage-equivalent ranges: between the two of curve T."""
DRAWS, SUPPORTS = 2, 7
"""Motions of each of the structures that the update leaves likely."""
SPOTS = 20
"""Hot spots of each record whose intervals are judged: those that are damaged most."""
HEIGHTS_M = (144.0, 28.0, 77.0, 41.0)
OF_BAND = 8
"""Hot spots of each band of elevation whose errors are told: those that are damaged most."""
BANDS = ((-80.0, -40.0), (-40.0, -15.0), (-15.0, 15.0), (15.0, 40.0))
SEEN = 0.4
"""Motion of sensors in a mode over that in the best seen of a band, from which it is fitted."""
FORGET_HZ = 0.02
MOMENTS = ("tower base", "tower top", "mud line")
METHODS = (
    "smoother",
    "4 sensors",
    "1 DC sensor",
    "smoother, not updated",
    "modal expansion",
    "modal expansion, not updated",
    "multi-band expansion",
    "multi-band expansion, not updated",
    "augmented Kalman",
    "augmented Kalman, not updated",
)
STATES = ("parked", "idling", "operating", "storm, parked")
"""Of the records of each asset."""
DRAWINGS = files("jackettwin") / "data" / "structures" / "jacket15.yaml"
FEET = {"k": {"median": 1.2e9, "log_std": 1.0}, "c": {"median": 2.5e7, "log_std": 1.0}}
"""What a pile's design says of its head, to a factor of e."""
ROTOR = RotorByWind(*read_rotor("iea15"), 0.17)
"""The twin is told its turbine."""
UPDATING = 2
"""Records that an asset updates itself with."""


def asset(number: int) -> dict[str, Any]:
    """Draw what the twin is not told of an asset: its feet, damping, mass, growth and coefficients."""
    rng = np.random.default_rng((SEED, number))
    k, mass = 10 ** rng.uniform(8.7, 9.4), float(rng.normal(1.0, 0.015))
    tau = 10 ** rng.uniform(-2.0, -1.4)
    feet = [
        {
            "nodes": [node],
            "stiffness": [float(k * np.exp(0.15 * rng.standard_normal()))] * 3,
            "law": {"type": "kelvin-voigt", "tau_s": float(tau)},
        }
        for node in read_structure("jacket15").reaction_nodes
    ]
    drawn = {
        "feet": {"supports": feet},
        "rna": _rna(mass),
        "damping": {"rayleigh": {"ratio": float(rng.uniform(0.003, 0.01)), "frequency_hz": 0.3}},
        "water": {
            "depth_m": DEPTH_M,
            "drag": float(rng.uniform(0.65, 1.2)),
            "added_mass": float(rng.normal(1.0, 0.1)),
            "marine_growth": [grown(float(np.exp(0.47 * rng.standard_normal())))],
        },
        "noise": float(10 ** rng.uniform(-4.0, -3.0)),
    }
    return drawn | {"steel": steel(rng)}


def steel(rng: np.random.Generator) -> dict[str, Any]:
    """Draw what the drawings do not tell of stiffness and mass, as the twin's tolerances have it."""
    found: dict[str, Any] = yaml.safe_load(DRAWINGS.read_text())
    for part, stiffer, heavier in (
        ("lattice", 0.015, 0.02),
        ("transition_piece", 0.1, 0.02),
        ("tower", 0.015, 0.01),
    ):
        material = found["jacket"][part]["material"]
        # YAML reads 2.1e11 as text
        for name, std in (("youngs_modulus_pa", stiffer), ("density_kg_m3", heavier)):
            material[name] = float(material[name]) * float(np.exp(std * rng.standard_normal()))
    return found


def weather(case: int) -> tuple[str, dict[str, Any]]:
    """Draw wind, sea and state of a record; negative cases are those that an asset updates itself with."""
    rng = np.random.default_rng((SEED, 1000 + case))
    state = "parked" if case < 0 else STATES[case % len(STATES)]
    storm = state.startswith("storm")
    if case < 0:
        hs, wind = float(rng.uniform(1.0, 2.0)), float(rng.uniform(8.0, 14.0))
    elif state == "operating":
        hs, wind = float(rng.uniform(1.0, 4.0)), float(rng.uniform(6.0, 20.0))
    else:
        hs = 8.0 if storm else float(rng.uniform(1.0, 5.0))
        wind = float(rng.uniform(18.0, 28.0) if storm else rng.uniform(6.0, 24.0))
    return state, {
        "waves": {
            "type": "jonswap",
            "hs_m": hs,
            "tp_s": float(rng.uniform(3.9, 4.8) * np.sqrt(hs) + 1.0),
            "direction_deg": float(rng.uniform(0.0, 360.0)),
            "spreading": 10,
            "seed": int(rng.integers(1_000_000)),
        },
        "wind": {"speed_m_s": wind, "turbulence": "B", "seed": int(rng.integers(1_000_000))},
        "rotor": {"data": "iea15", "state": state.split()[-1]},
        "sensor_seed": int(rng.integers(1_000_000)),
    }


def write_scenario(folder: Path, case: int) -> Path:
    """Write the scenario of a record, and the feet that it names."""
    drawing = asset(abs(case) // 10 if case < 0 else case // len(STATES))
    (folder / "feet.yaml").write_text(yaml.safe_dump(drawing.pop("feet")))
    (folder / "steel.yaml").write_text(yaml.safe_dump(drawing.pop("steel")))
    noise = drawing.pop("noise")
    sensors = [
        {"channel": f"acc_{h:.0f}_{axis}", "height_m": h, "direction": d, "noise": noise}
        for h in HEIGHTS_M
        for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    ]
    scenario = {
        "structure": str(folder / "steel.yaml"),
        "gravity": True,
        "support": str(folder / "feet.yaml"),
        "time": {"duration_s": 600.0, "step_s": STEP_S, "discard_s": 60.0},
        "sensors": sensors,
        **drawing,
        **weather(case)[1],
    }
    path = folder / f"scenario{case}.yaml"
    path.write_text(yaml.safe_dump(scenario))
    return path


def grown(factor: float) -> dict[str, float]:
    """Return growth of so many times the design's thickness."""
    return {"top_z_m": 2.0, "bottom_z_m": -40.0, "thickness_m": 0.08 * factor}


def _rna(mass: float) -> dict[str, Any]:
    return {
        "mass_kg": 808928.0 * mass,
        "static_moment_kg_m": [-5897995.0 * mass, 0.0, 3725438.0 * mass],
        "inertia_about_node_kg_m2": [3.702e8 * mass, 2.472e8 * mass, 2.487e8 * mass, 0.0, 0.0, 0.0],
    }


class Known(NamedTuple):
    """A twin that updated itself: likely structures, one on stiff feet, what it bears at rest, its water."""

    systems: tuple[System, ...]
    before: System
    rest: RestingLoads
    coefficients: Coefficients


def known_asset(number: int) -> Known:
    """Return the twin of an asset, updated by records of its own; kept beside the results."""
    path = KEPT / f"fatigue{SEED}-asset{number}-{digest('fatigue', whole=True)}.pickle"
    if not path.exists():
        path.write_bytes(pickle.dumps(updated_asset(number)))
    known: Known = pickle.loads(path.read_bytes())
    return known


def updated_asset(number: int) -> Known:
    """Return the drawings' jacket with the design's growth, on feet that two records update."""
    with tempfile.TemporaryDirectory() as name:
        folder, records = Path(name), []
        for k in range(UPDATING):
            scenario = read_scenario(str(write_scenario(folder, -10 * number - k - 1)))
            write_record(simulate(scenario).record, folder / f"r{k}.parquet")
            records.append(f"r{k}.parquet")
        twin = {
            "structure": "jacket15",
            "gravity": True,
            "rna": _rna(1.0),
            "damping": {"rayleigh": {"ratio": 0.0055, "frequency_hz": 0.3}},
            "water": {"depth_m": DEPTH_M, "marine_growth": [grown(1.0)]},
            "support": {"law": "kelvin-voigt", "tie": "all"},
            "records": records,
            # second modes mix with those of braces
            "update": {
                "laws": ["kelvin-voigt"],
                "modes": [1, 2],
                "starts": 4,
                "particles": 50,
                "priors": FEET,
                # 28 m over 144 m: a first frequency hardly tells feet from the mass on top
                "profile_std": 0.003,
            },
        }
        (folder / "twin.yaml").write_text(yaml.safe_dump(twin))
        config = read_twin(str(folder / "twin.yaml"))
        update = updated(config)
    assert config.water is not None
    return Known(
        updated_systems(update, draws=SUPPORTS - 1),
        update.model.system(_stiffest(update)),
        RestingLoads.of(assemble(config.structure), config.water),
        config.water.coefficients,
    )


def mudline_moment(assembly: Assembly, forces: SectionForces, about_z_m: float = 0.0) -> np.ndarray:
    """Return the moment (2, n) about horizontal axes at a height, of all that passes into the feet."""
    mesh, structure = assembly.mesh, assembly.structure
    feet = {mesh.node_names.index(node) for node in structure.reaction_nodes}
    total = np.zeros((3, forces.axial.shape[0]))
    for e in range(mesh.start.size):
        for end, node in ((0, mesh.start[e]), (1, mesh.end[e])):
            if int(node) in feet:
                sign = 1.0 if end == 0 else -1.0
                axes, at = mesh.axes[e].T, mesh.coordinates[node] - [0.0, 0.0, about_z_m]
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

    def __init__(self, system: System, model: MotionModel, rest: RestingLoads) -> None:
        rows = section_rows(model)
        self.rows = sections(model.assembly, rows)
        self.chart: WeldMap = weld_map(system, model, rest)

    def dels(self, motion: np.ndarray, wanted: list[tuple[int, int, int, int]]) -> np.ndarray:
        """Return ranges of the moments, then of wanted points (joint, brace, side, point)."""
        moments = np.concatenate([dels(rows @ motion.T) for rows in self.rows.values()])
        stress = {j: self.chart.stress(j, motion) for j in {key[0] for key in wanted}}
        return np.concatenate([moments, dels(np.array([stress[j][b, s, p] for j, b, s, p in wanted]))])


def truth_of(
    scenario: Scenario, judge: Judge, first: MotionModel
) -> tuple[np.ndarray, list[tuple[int, int, int, int]], np.ndarray]:
    """Return true ranges, the worst points of sides of welds, and displacements.

    Of sides those are told that are damaged most of all and of each band of elevation.
    """
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    blocks, moved_by = [], []
    for u, along in deflections(scenario, motion):
        blocks.append(np.stack(section_forces(assembly, u, along=along), axis=-1))
        moved_by.append(u)
    forces = SectionForces(*np.moveaxis(np.concatenate(blocks), -1, 0))
    moments = np.concatenate([dels(one) for one in sections(assembly, forces).values()])
    wanted, ranges = [], []
    for j, joint in enumerate(judge.chart.joints):
        stress = joint.stress(assembly, forces)
        for b in range(stress.shape[0]):
            for s in range(2):
                each = dels(stress[b, s])
                p = int(each.argmax())
                wanted.append((j, b, s, p))
                ranges.append(each[p])
    z = np.array([_height(j, first, judge) for j, _, _, _ in wanted])
    order = np.argsort(-np.array(ranges))
    of_bands = [order[(z[order] >= low) & (z[order] < high)][:OF_BAND] for low, high in BANDS]
    told = sorted({*order[:SPOTS].tolist(), *np.concatenate(of_bands).tolist()})
    return (
        np.concatenate([moments, np.array(ranges)[told]]),
        [wanted[i] for i in told],
        np.concatenate(moved_by),
    )


def kalman(system: System, seen: SensorReadings, sea: Weather) -> tuple[MotionModel, np.ndarray]:
    """Return the motion by an augmented Kalman filter: top forces that walk and forget, no look ahead."""
    known = sensed_model(system, sea)
    pick = [i for i, f in enumerate(known.forces) if f.name in ("rotor Fx", "rotor Fy")]
    walking: tuple[LatentForce, ...] = tuple(
        replace(known.forces[i], rate=2.0 * np.pi * FORGET_HZ) for i in pick
    )
    model = replace(known, forces=walking, flexibility=known.flexibility[:, pick], local=(), bent=())
    found = motion_from(model, seen)
    return found.model, found.smoother.filtered(seen.y.T) @ found.to_coordinates.T


def expansion(
    system: System, seen: SensorReadings, sea: Weather, bands: tuple[tuple[float, float], ...]
) -> tuple[MotionModel, np.ndarray]:
    """Return the motion by modal expansion: modes fitted to accelerations and integrated twice.

    In each band [Hz] those modes are fitted that lie in it and that sensors see well, half as many as there
    are sensors at most. What is slower than 0.05 Hz is left out, as integration would drown it in noise.
    """
    model = sensed_model(system, sea)
    n, n_channels = seen.y.shape[1], seen.y.shape[0]
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, seen.step_s)
    spectrum = np.fft.rfft(seen.y, axis=1)
    motion = np.zeros((n, model.n_modes + len(model.forces) + len(model.local)))
    for low, high in bands:
        inside = (model.omega >= 2.0 * np.pi * low) & (model.omega < 2.0 * np.pi * high)
        strength = np.where(inside, np.linalg.norm(seen.rows @ model.shapes, axis=0), -1.0)
        seen_well = int((strength > SEEN * strength.max()).sum())
        modes = np.argsort(-strength)[: min(n_channels // 2, seen_well)]
        here = (omega >= 2.0 * np.pi * max(low, 0.05)) & (omega < 2.0 * np.pi * high)
        fitted = np.zeros((modes.size, omega.size), dtype=complex)
        to_modes = np.linalg.pinv(seen.rows @ model.shapes[:, modes])
        fitted[:, here] = -(to_modes @ spectrum[:, here]) / omega[here] ** 2
        motion[:, modes] = np.fft.irfft(fitted, n, axis=1).T
    return model, motion


PEERS = {
    "modal expansion": partial(expansion, bands=((0.0, 2.2),)),
    "multi-band expansion": partial(expansion, bands=((0.0, 0.4), (0.4, 1.0), (1.0, 2.2))),
    "augmented Kalman": kalman,
}


def run(case: int) -> Result:
    """Return what is said of one record, or why nothing is."""
    start = process_time()
    try:
        return judged(case)
    except JackettwinError as error:
        return {"state": weather(case)[0], "cpu_s": process_time() - start, "lost": str(error)}


def judged(case: int) -> Result:
    """Return, for one record, ranges over true ones by every method, and how far off they were said to be."""
    state, drawing = weather(case)
    start = process_time()
    systems, before, rest, coefficients = known_asset(case // len(STATES))
    update_s = process_time() - start
    with tempfile.TemporaryDirectory() as folder:
        scenario = read_scenario(str(write_scenario(Path(folder), case)))
        simulated = simulate(scenario).record
    sea = Weather.of(simulated.conditions, DEPTH_M, coefficients, ROTOR)
    rest = rest.under(sea, systems[0].assembly)
    first = sensed_model(systems[0], sea)
    true, wanted, displacement = truth_of(scenario, Judge(systems[0], first, rest), first)
    sensors = tuple(i.sensor for i in scenario.instruments)
    record = Record(
        simulated.data[: len(sensors)], simulated.sample_rate_hz, simulated.channels[: len(sensors)]
    )
    seen = readings_of(record, sensors, systems[0].assembly)
    start = process_time()
    every, judges = [], []
    for k, (system, found) in enumerate(zip(systems, likely_motions(systems, seen, sea), strict=True)):
        judges.append(Judge(system, found.model, rest))
        every.append([judges[k].dels(motion, wanted) for motion in found.draws(DRAWS, seed=k)])
    smoother_s = process_time() - start
    draws = np.log(np.array(every))
    z = [_height(j, first, judges[0]) for j, _, _, _ in wanted]
    left = [stress_remainder(at, working=sea.working) for at in z]
    remainder = np.array([SECTION_REMAINDER] * 6 + left)
    within = draws.var(axis=1, ddof=1).mean(axis=0)
    between = draws.mean(axis=1).var(axis=0, ddof=1)
    std = np.sqrt(within + np.maximum(between - within / DRAWS, 0.0) + remainder**2)
    estimates = {
        "smoother": np.exp(draws.mean(axis=(0, 1))),
        "smoother, not updated": _mean(before, seen, sea, rest, wanted),
        "4 sensors": _mean(systems[0], _of(record, sensors, systems[0], 4), sea, rest, wanted),
        "1 DC sensor": _mean(systems[0], _felt(record, sensors, displacement, systems[0]), sea, rest, wanted),
    }
    for name, method in PEERS.items():
        for system, told in ((systems[0], name), (before, f"{name}, not updated")):
            model, motion = method(system, seen, sea)
            estimates[told] = Judge(system, model, rest).dels(motion, wanted)
    worst = 6 + np.argsort(-true[6:])[:SPOTS]
    score = (np.log(true) - draws.mean(axis=(0, 1))) / std
    return {
        "state": state,
        "hs_m": drawing["waves"]["hs_m"],
        "wind_m_s": drawing["wind"]["speed_m_s"],
        "cpu_s": update_s + smoother_s,
        "smoother_s": smoother_s / len(systems),
        "ratio": {name: (values / true).tolist() for name, values in estimates.items()},
        "true": true.tolist(),
        "z_m": z,
        "judged": [0, 1, 4, 5, *map(int, worst)],
        "score": score.tolist(),
        "std": std.tolist(),
    }


def _of(record: Record, sensors: tuple[Sensor, ...], system: System, number: int) -> SensorReadings:
    few = Record(record.data[:number], record.sample_rate_hz, record.channels[:number])
    return readings_of(few, sensors[:number], system.assembly)


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
    sea: Weather,
    rest: RestingLoads,
    wanted: list[tuple[int, int, int, int]],
) -> np.ndarray:
    found: MotionEstimate = motion_from(sensed_model(system, sea), seen)
    judge = Judge(system, found.model, rest)
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
        if place in MOMENTS:
            at = 2 * MOMENTS.index(place)
            found.append(float(values[at + int(true[at + 1] > true[at])]))
        else:
            low, high = map(float, place.split(" to "))
            found += values[6:][most_damaged(one, low, high)].tolist()
    return found


def most_damaged(one: Result, low: float, high: float) -> np.ndarray:
    """Return which hot spots of a record between two heights are damaged most."""
    z, spots = np.array(one["z_m"]), np.array(one["true"])[6:]
    inside = np.flatnonzero((z >= low) & (z < high))
    return np.asarray(inside[np.argsort(-spots[inside])[:OF_BAND]])


def main() -> None:
    n = arguments(__doc__, n=48, seed=USUAL_SEED).n
    every = cases("fatigue", n, run, part=str(SEED), whole=True)
    results = [one for one in every if "lost" not in one]
    lost = len(every) - len(results)
    lines = [*introduction(n, lost), *errors(results), *coverage(results), *cost(results)]
    if SEED == USUAL_SEED:
        write_page("fatigue", lines)
    else:
        sys.stdout.write("\n".join(lines) + "\n")


def introduction(n: int, lost: int) -> list[str]:
    """Return the page's head."""
    return [
        "# Stress at welds from a few accelerometers",
        "",
        f"`python qualify/fatigue.py {' '.join(sys.argv[1:])}`: {n} simulated ten-minute records of "
        f"{-(-n // len(STATES))} assets like jacket15; feet, damping, steel, mass, growth, coefficients "
        "of the water and weather are drawn and unknown to "
        "the twin but for mean wind and sea. It updates its feet with two other records of the "
        f"asset{f' ({lost} records gave no result and are left out)' if lost else ''}.",
        f"Damage-equivalent range (m = {M:g}) over the true one, less one, in per cent: median (5 to 95 % of "
        "records), then the median size of the error. Moments in the direction that is loaded most; hot "
        f"spots by elevation [m] above the sea, the {OF_BAND} that are damaged most.",
    ]


def errors(results: list[Result]) -> list[str]:
    """Return the errors of the smoother by state, and of every method in all records."""
    places = [*MOMENTS, *(f"{low:g} to {high:g}" for low, high in BANDS)]
    groups = {"all": results} | {s: [r for r in results if r["state"] == s] for s in STATES}
    lines = ["", "| place | " + " | size | ".join(groups) + " | size |", "|---|" + "---|---|" * len(groups)]
    for place in places:
        parts = [quantiles(ratios(group, "smoother", place)) for group in groups.values()]
        lines.append(f"| {place} | " + " ".join(parts))
    lines += ["", "| method | " + " | size | ".join(places) + " | size |", "|---|" + "---|---|" * len(places)]
    for method in METHODS:
        parts = [quantiles(ratios(results, method, place)) for place in places]
        lines.append(f"| {method} | " + " ".join(parts))
    return lines


def coverage(results: list[Result]) -> list[str]:
    """Return how many of the true ranges lie in the intervals of 90 %, by state and place."""
    lines = [
        "",
        "| 90 % intervals of the smoother | judged | inside | true above | true below | typical width |",
        "|---|---|---|---|---|---|",
    ]
    rows = {"all": np.concatenate([scored(one, one["judged"]) for one in results])}
    for state in STATES:
        own = [scored(one, one["judged"]) for one in results if one["state"] == state]
        rows |= {state: np.concatenate(own)} if own else {}
    rows["tower base"] = np.concatenate([scored(one, [0, 1]) for one in results])
    rows["mud line"] = np.concatenate([scored(one, [4, 5]) for one in results])
    for low, high in BANDS:
        rows[f"hot spots {low:g} to {high:g}"] = np.concatenate(
            [
                scored(one, [i for i in one["judged"][4:] if low <= one["z_m"][i - 6] < high])
                for one in results
            ]
        )
        most = [scored(one, [6 + i for i in most_damaged(one, low, high)]) for one in results]
        rows[f"{OF_BAND} spots of {low:g} to {high:g} (not in all)"] = np.concatenate(most)
    rows["tower top (not in all)"] = np.concatenate([scored(one, [2, 3]) for one in results])
    for name, row in rows.items():
        if len(row):
            above, below = (row[:, 0] > NORMAL_90).mean(), (row[:, 0] < -NORMAL_90).mean()
            shares = " | ".join(f"{100 * share:.0f} %" for share in (1.0 - above - below, above, below))
            width = np.expm1(NORMAL_90 * np.median(row[:, 1]))
            lines.append(f"| {name} | {len(row)} | {shares} | ±{100 * width:.0f} % |")
    return lines


def scored(one: Result, which: list[int]) -> np.ndarray:
    """Return scores and standard deviations (n, 2) of some quantities of a record."""
    return np.array([[one["score"][i], one["std"][i]] for i in which]).reshape(-1, 2)


def cost(results: list[Result]) -> list[str]:
    """Return what the smoother cost."""
    seconds = np.median([one["smoother_s"] for one in results])
    return [
        "",
        f"The smoother with {DRAWS} motions and all welds took {seconds:.2f} CPU-s a record and "
        f"structure, of {SUPPORTS} structures.",
    ]


if __name__ == "__main__":
    main()
