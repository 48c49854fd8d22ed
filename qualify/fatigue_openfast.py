"""Moments and leg stresses from eight accelerometers against OpenFAST, which knows them.

Writes docs/verification/fatigue_openfast.md from the records in a folder. With ``--make`` those that it lacks
are run: ``OPENFAST=/path/to/openfast``, and ``IEA15=/path`` to the folder ``OpenFAST`` of the public
repository IEAWindSystems/IEA-15-240-RWT. The twin is told drawings, turbine and mean wind; it finds its feet
from the first pair of the first record. Usage: python qualify/fatigue_openfast.py FOLDER [--make]
"""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from common.command import arguments
from common.openfast_records import (
    ACCELERATIONS,
    BED,
    DURATION_S,
    GAUGES,
    STEP_S,
    TOWER_BASE,
    Asset,
    Weather,
    kept,
    leg_channels,
    made,
    tower_height_m,
)
from common.page import write_page
from openfast import on_feet, three_legs

from fatigue import DRAWS, SUPPORTS, M, dels, mudline_moment, quantiles, tower_moments
from jackettwin.arrays import FloatArray
from jackettwin.decks import read_structure
from jackettwin.identification import identify
from jackettwin.intervals import NORMAL_90
from jackettwin.loads import Coefficients, Water, read_rotor
from jackettwin.records import Channel, Record
from jackettwin.response import Sensor, observation_matrix
from jackettwin.sensing import (
    SECTION_REMAINDER,
    MotionModel,
    RotorByWind,
    Weather as KnownWeather,
    likely_motions,
    readings_of,
    section_rows,
    stress_remainder,
)
from jackettwin.structure import Rayleigh, Structure, assemble
from jackettwin.twin import LifeSettings, RestingLoads, StressModel
from jackettwin.twin.life.likely_structures import LikelyStructures, likely_structures
from jackettwin.twin.water import WaterConfig, moving_mass
from jackettwin.updating import numbered_modes

JACKET15 = Asset(read_structure("jacket15"), 1.4e9, 0.9, 1.0, 0.06, 3.0, 72.0)
THREE_LEGS = Asset(three_legs(turn_deg=20.0), 9e8, 0.9, 1.0, 0.06, 3.0, 45.0)
CASES = {
    "parked": Weather("parked", 10.0, 0.0, 6.0, 0.0, 11),
    "idling": Weather("idling", 13.0, 0.0, 6.0, 0.0, 12),
    "operating_8": Weather("operating", 8.0, 0.0, 6.0, 0.0, 13),
    "operating_14": Weather("operating", 14.0, 0.0, 6.0, 0.0, 14),
    "parked_gale": Weather("parked", 20.0, 0.0, 6.0, 0.0, 15),
    "operating_11": Weather("operating", 11.0, 0.0, 6.0, 0.0, 16),
    "operating_18": Weather("operating", 18.0, 0.0, 6.0, 0.0, 17),
    "storm": Weather("parked", 24.0, 8.0, 12.5, 0.0, 18),
    "three_parked": Weather("parked", 14.0, 0.0, 6.0, 0.0, 31),
    "three_operating": Weather("operating", 11.0, 0.0, 6.0, 0.0, 32),
}
ASSETS = {name: THREE_LEGS if name.startswith("three_") else JACKET15 for name in CASES}
COEFFICIENTS = Coefficients()
"""Of the water, as the twin knows it: the truth has growth, and less drag."""
NOISE_M_S2 = 5e-4
FIRST_PAIR_HZ = (0.13, 0.22)
DIRECTIONS = np.linspace(0.0, np.pi, 12, endpoint=False)
"""In which moments are judged: the worst, as the programs' axes are not the same."""


def make(folder: Path) -> None:
    """Run those of the cases by OpenFAST that the folder does not hold."""
    program, decks = os.environ["OPENFAST"], Path(os.environ["IEA15"])
    folder.mkdir(parents=True, exist_ok=True)
    for name, weather in CASES.items():
        if not (folder / f"{name}.npz").exists():
            result = made(program, decks, folder / name, ASSETS[name], weather)
            np.savez_compressed(folder / f"{name}.npz", **kept(result, ASSETS[name]))
            shutil.rmtree(folder / name)


def main() -> None:
    given = arguments(__doc__, folder=Path("missing"), make=False)
    folder = given.folder
    if given.make:
        make(folder)
    found = {
        name: dict(np.load(folder / f"{name}.npz")) for name in CASES if (folder / f"{name}.npz").exists()
    }
    if not found:
        sys.stderr.write("no records: nothing is judged (docs/verification/fatigue_openfast.md)\n")
        return
    lines = []
    for asset in (JACKET15, THREE_LEGS):
        likely, judged = {}, {}
        for seed, (name, told) in enumerate(found.items()):
            if ASSETS[name] is not asset:
                continue
            structure = on_feet("the twin's", "kelvin-voigt:k=1e9,c=0", structure=asset.structure).structure
            wet = CASES[name].height_m > 0.0
            if wet not in likely:
                likely[wet] = known(asset, structure, record(told, 0), wet=wet)
            judged[name] = of_record(likely[wet], asset, structure, name, told, seed)
        if judged:
            lines += [*feet_words(asset, likely), *rows(asset, judged)]
    write_page("fatigue_openfast", [*introduction(len(found)), *lines])


def record(told: dict[str, FloatArray], seed: int) -> Record:
    """Return the accelerations with noise, each channel with its sensor's place."""
    rng = np.random.default_rng((35, seed))
    data = np.array([told[name] for name in ACCELERATIONS])
    data = data + NOISE_M_S2 * rng.standard_normal(data.shape)
    return Record(data, 1.0 / STEP_S, tuple(Channel(name) for name in ACCELERATIONS))


def sensors(structure: Structure) -> tuple[Sensor, ...]:
    """Return where the accelerometers sit, along the wind and across it."""
    top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
    base = structure.nodes[structure.interface_nodes[0]][2] - structure.sea_level_z_m
    heights = (top, *(tower_height_m(structure, gauge) for gauge in GAUGES), base)
    ways = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    return tuple(Sensor(name, ways[k % 2], height_m=heights[k // 2]) for k, name in enumerate(ACCELERATIONS))


def known(asset: Asset, structure: Structure, parked: Record, *, wet: bool) -> LikelyStructures:
    """Return the structures that the first pair of a record leaves likely, in water or without."""
    assembly = assemble(structure, gravity=True)
    if wet:
        water = WaterConfig(asset.depth_m, COEFFICIENTS, Water(), True, None)
        assembly = replace(assembly, mass=assembly.mass + moving_mass(water, assembly).tocsc())
    model = StressModel(
        LifeSettings(),
        assembly,
        RestingLoads.of(assemble(structure)),
        Rayleigh.minimum(0.005, 0.3),
        numbered_modes(assembly, 12),
        depth_m=asset.depth_m,
    )
    low, high = FIRST_PAIR_HZ
    pair = [m for m in identify(parked).modes if m.status.is_a_mode and low < m.frequency_hz < high]
    modes = {k + 1: mode for k, mode in enumerate(pair[:2])}
    return likely_structures(model, modes, 1e9, sensors=observation_matrix(assembly, sensors(structure)))


def of_record(
    likely: LikelyStructures,
    asset: Asset,
    structure: Structure,
    name: str,
    told: dict[str, FloatArray],
    seed: int,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return estimated over true ranges, scores of the truth in the interval, and its std (n_places,)."""
    readings = readings_of(record(told, seed), sensors(structure), likely.model.assembly)
    case = CASES[name]
    sea: dict[str, Any] = {"waves": "none"}
    if case.height_m > 0.0:
        sea = {
            "wave_height_m": case.height_m,
            "wave_period_s": case.period_s,
            "wave_direction_deg": case.direction_deg,
        }
    weather = KnownWeather.of(
        {"mean_wind_speed_m_s": case.wind, "state": case.state, **sea},
        asset.depth_m,
        COEFFICIENTS,
        rotor=RotorByWind(*read_rotor("iea15"), FIRST_PAIR_HZ[0], shaft="locked"),
    )
    draws = []
    for k, estimate in enumerate(likely_motions(likely.systems(SUPPORTS), readings, weather)):
        ways = moments_and_legs(estimate.model, asset, bed_m=asset.depth_m if case.height_m > 0.0 else 0.0)
        draws.append([[worst(way @ motion.T) for way in ways] for motion in estimate.draws(DRAWS, seed=k)])
    true = np.array([worst(way) for way in true_ways(asset, told)])
    logs = np.log(np.array(draws))
    within = logs.var(axis=1, ddof=1).mean(axis=0)
    between = np.maximum(logs.mean(axis=1).var(axis=0, ddof=1) - within / DRAWS, 0.0)
    left = [
        stress_remainder(structure.nodes[node][2] - structure.sea_level_z_m, working=weather.working)
        for node in leg_starts(asset)
    ]
    remainder = np.array([SECTION_REMAINDER] * 2 + left)
    mean = logs.mean(axis=(0, 1))
    std = np.sqrt(within + between + remainder**2)
    return np.exp(mean) / true, (np.log(true) - mean) / std, std


def leg_starts(asset: Asset) -> list[str]:
    """Return the lower nodes of the legs, bay by bay."""
    members = {m.name: m for m in asset.structure.members}
    return [members[leg].start for bay in asset.legs for leg in bay]


def moments_and_legs(model: MotionModel, asset: Asset, *, bed_m: float) -> list[FloatArray]:
    """Return rows from coordinates to moments by direction, then to stresses around the legs.

    Parameters
    ----------
    bed_m : depth of the height about which the feet's moments are
    """
    rows, assembly = section_rows(model), model.assembly
    base = tower_moments(assembly, rows, "tower_1", 0)
    names = [assembly.structure.members[m].name for m in assembly.mesh.member]
    found = [turned(base), turned(mudline_moment(assembly, rows, assembly.structure.sea_level_z_m - bed_m))]
    for leg in (name for bay in asset.legs for name in bay):
        e = names.index(leg)
        parts = [rows.axial[:, e, 0], rows.bending_y[:, e, 0], rows.bending_z[:, e, 0]]
        found.append(around(assembly.structure, leg, np.array(parts)))
    return found


def true_ways(asset: Asset, told: dict[str, FloatArray]) -> list[FloatArray]:
    """Return the same of OpenFAST's channels, over time."""
    kilo = 1e3
    base = kilo * np.array([told[name] for name in TOWER_BASE])
    bed = np.array([told[name] for name in BED])
    found = [turned(base), turned(bed)]
    for k, name in enumerate(leg for bay in asset.legs for leg in bay):
        found.append(around(asset.structure, name, np.array([told[channel] for channel in leg_channels(k)])))
    return found


def turned(moments: FloatArray) -> FloatArray:
    """Return moments (2, n) in all directions, (n_directions, n)."""
    return np.asarray(np.column_stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)]) @ moments)


def around(structure: Structure, name: str, forces: FloatArray) -> FloatArray:
    """Return the stress around a tube, (2 n_directions, n), under axial force and both moments (3, n)."""
    section = next(m.section_start for m in structure.members if m.name == name)
    outer, inner = section.outer_diameter_m, section.outer_diameter_m - 2.0 * section.thickness_m
    area, modulus = 0.25 * np.pi * (outer**2 - inner**2), np.pi * (outer**4 - inner**4) / (32.0 * outer)
    bent = turned(forces[1:]) / modulus
    return np.concatenate([forces[0] / area + bent, forces[0] / area - bent])


def worst(series: FloatArray) -> float:
    """Return the largest damage-equivalent range of rows (k, n)."""
    return float(dels(series).max())


def introduction(n: int) -> list[str]:
    """Return the page's head."""
    return [
        "# Stress from a few accelerometers compared with OpenFAST",
        "",
        f"`python qualify/fatigue_openfast.py FOLDER`: {n} records of {DURATION_S / 60.0:g} minutes by "
        "OpenFAST 5.0.0, none used for tuning: jackets in SubDyn on springs, ElastoDyn's tower and bending "
        "blades of the IEA 15 MW turbine, AeroDyn in turbulence of class B, storms in HydroDyn's waves "
        "(one way, growth of 6 cm and C_D = 0.9 that the twin is not told); the working rotor at "
        "fixed speed and pitch. Eight accelerometers, at the tower's top, two gauges and its bottom, noise "
        f"{1e3 * NOISE_M_S2:g} mm/s². The twin has rigid blades and is told drawings, state and wind; the "
        "first pair of the first record without waves gives it its feet, of one in waves those in water.",
        "",
        f"Damage-equivalent range (m = {M:g}) over OpenFAST's, less one, in per cent: moments in the "
        "direction, and stress at the point around each leg (at its lower end in each bay), where it is "
        "largest. The feet's reaction is about the sea level, as SubDyn tells it without a sea, in waves "
        "about the bed.",
    ]


def feet_words(asset: Asset, likely: dict[bool, LikelyStructures]) -> list[str]:
    """Return an asset's heading, and the feet that its twin found."""
    feet = {
        wet: "{:.2f} GN/m (sideways, log-deviation {:.2f}) and {:.2f} (upright, {:.2f})".format(
            *np.column_stack([np.exp(one.mean[:2]) / 1e9, np.sqrt(np.diag(one.covariance)[:2])]).ravel()
        )
        for wet, one in likely.items()
    }
    found = [f"{'in waves' if wet else 'without waves'} {words}" for wet, words in feet.items()]
    name = f"{asset.structure.name}, {asset.depth_m:g} m of water"
    return ["", f"## {name}", "", f"Feet: {', '.join(found)}; in truth {asset.feet_n_m / 1e9:g}.", ""]


def rows(asset: Asset, judged: dict[str, tuple[FloatArray, FloatArray, FloatArray]]) -> list[str]:
    """Return errors by record and place, then how often intervals hold."""
    places = ("tower base", "feet", *(f"legs, bay {bay + 1}" for bay in range(len(asset.legs))))
    ends = np.cumsum([2, *map(len, asset.legs)])
    of = [slice(0, 1), slice(1, 2), *(slice(*pair) for pair in pairwise(ends.tolist()))]
    lines = [f"| record | {' | '.join(places)} |", "|---" * (1 + len(places)) + "|"]
    for name, (ratio, *_) in judged.items():
        cells = [f"{100.0 * (np.median(ratio[at]) - 1.0):+.1f}" for at in of]
        sea = f", waves of {CASES[name].height_m:g} m" if CASES[name].height_m else ""
        lines.append(f"| {CASES[name].state}, {CASES[name].wind:g} m/s{sea} | {' | '.join(cells)} |")
    ratios, scores, stds = (np.array(values) for values in zip(*judged.values(), strict=True))
    heads = ("place", "median (5 to 95 %)", "size", "intervals of 90 % inside", "true above", "true below")
    lines += ["", f"| {' | '.join(heads)} | width by record |", "|---" * 7 + "|"]
    for place, at in (dict(zip(places, of, strict=True)) | {"all": slice(0, None)}).items():
        own = scores[:, at]
        shares = [np.abs(own) <= NORMAL_90, own > NORMAL_90, own < -NORMAL_90]
        cells = [f"{100.0 * share.mean():.0f} %" for share in shares]
        widths = [f"±{100.0 * np.expm1(NORMAL_90 * np.median(std)):.0f} %" for std in stds[:, at]]
        ratio = quantiles(ratios[:, at].ravel().tolist())
        lines.append(f"| {place} | {ratio} {' | '.join(cells)} | {', '.join(widths)} |")
    return lines


if __name__ == "__main__":
    main()
