"""The whole chain: records of a changed jacket are simulated and identified, and their modes fill seasons.

Ten-minute records under waves and wind are simulated before and after a change, with the same few seeds, and
identified as the twin does it. A season's row is one of these records: its ln f and ln ζ with their stated
standard deviations, plus what the seasons of ``common.seasons`` do (tide, steel's temperature, wind, waves,
what is unexplained). A season of records simulated one by one would be hundreds. Hundreds of rows drawn from
a few records know the mean of these, which errs by chance from the mean of all records: a watch that takes
each row for a record of its own is surer of the difference than it can be. So the few records are centred on
the poles of the simulated system, by what identification errs by on average in all states: their scatter is
that of records, and so is the mean of many rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from common.seasons import Kind, Seasons, seasons, unexplained
from jackettwin.change.changed_structures import Standing
from jackettwin.records import Record
from jackettwin.response.modes.labels import LOCAL
from jackettwin.simulate import Scenario, simulate
from jackettwin.simulate.scenario.files import scenario_from
from jackettwin.soil.files import read_support
from jackettwin.soil.support import Spring, Support
from jackettwin.structure import Structure
from jackettwin.twin import read_twin
from jackettwin.twin.model import TwinModel, twin_model
from jackettwin.twin.observe import observe
from jackettwin.watching import History

HEIGHTS = (0.99, 0.62, 0.36)
"""Of pairs of accelerometers on the tower, as shares of its top above the sea."""
_LOSS = "maxwell-3:k=1,loss_factor=0.08,f0=0.3"
_SEEN = 0.7
"""Share of the records before the change in which a mode must be found to be watched."""
_FEW = 3
"""Records below which a mode has no mean."""
_HUBER, _REJECTED = 2.2, 4.5
"""Standard deviations beyond which a record counts less and is rejected, as in ``jackettwin.watching``."""
_NEAR = np.array([0.01, 1.0])
"""Distances in ln f and ln ζ that weigh as much as another label does when modes and poles are paired."""


@dataclass(frozen=True)
class Bench:
    """What records of one jacket are made and identified with."""

    scenario: Scenario
    model: TwinModel


def bench(structure: Structure, source: str, where: Path) -> Bench:
    """Return scenario and model of a jacket; ``source`` is its name or file."""
    sea = structure.sea_level_z_m
    depth = sea - min(structure.nodes[foot][2] for foot in structure.reaction_nodes)
    top = structure.nodes[structure.top_node][2] - sea
    axes = {"x": [1, 0, 0], "y": [0, 1, 0]}
    sensors: list[dict[str, Any]] = [
        {"channel": f"acc_{i}_{a}", "height_m": round(h * top, 1), "direction": d, "noise": 3e-4}
        for i, h in enumerate(HEIGHTS)
        for a, d in axes.items()
    ]
    off_axis = [node for node, at in structure.nodes.items() if np.hypot(*at[:2]) > 1.0]
    leg = max(off_axis, key=lambda node: structure.nodes[node][2])
    x, y, _ = structure.nodes[leg]
    around = [-y / np.hypot(x, y), x / np.hypot(x, y), 0.0]
    sensors.append({"channel": "acc_leg", "node": leg, "direction": around, "noise": 3e-4})
    scenario = scenario_from(
        {
            "structure": source, "gravity": True, "support": "kelvin-voigt:k=2.5e9,c=1e7",
            "damping": {"rayleigh": {"ratio": 0.0055, "frequency_hz": 0.183}},
            "wind": {"speed_m_s": 10, "turbulence": "B", "seed": 1}, "rotor": {"state": "parked"},
            "water": {"depth_m": float(depth)},
            "waves": {"type": "jonswap", "hs_m": 1.5, "tp_s": 7.0, "seed": 1},
            "time": {"duration_s": 600, "step_s": 0.1, "load_step_s": 0.2}, "sensors": sensors,
        },
        where / "scenario.yaml",
    )  # fmt: skip
    twin = where / "twin.yaml"
    twin.write_text(f"structure: {source}\ngravity: true\nsupport: {{law: kelvin-voigt, tie: all}}\n")
    return Bench(scenario, twin_model(read_twin(twin, records_follow=True)))


def record(scene: Scenario, standing: Standing, seed: int, friction: float = 0.0) -> Record:
    """Return ten minutes of a jacket as it stands; ``friction`` is added to Rayleigh's α [1/s]."""
    structure, steel = standing.structure, scene.asset.rayleigh
    law = read_support(_LOSS, structure).springs[0].law
    feet = zip(structure.reaction_nodes, standing.horizontal, standing.vertical, strict=True)
    springs = tuple(Spring(node, np.diag([h, h, v, 0.0, 0.0, 0.0]), law) for node, h, v in feet)
    asset = replace(
        scene.asset, structure=structure, support=Support(springs), support_text=None,
        rayleigh=replace(steel, alpha=steel.alpha + friction),
    )  # fmt: skip
    if scene.sea is None or scene.air is None:
        raise ValueError("a scenario without sea or wind")
    return simulate(
        replace(
            scene, asset=asset, sensor_seed=seed, sea=replace(scene.sea, seed=seed),
            air=replace(scene.air, seed=seed),
        )
    ).record  # fmt: skip


Row = dict[str, list[float]]


def identified(found: Record, model: TwinModel) -> Row:
    """Return {label: [ln f, its standard deviation, ln ζ, its standard deviation]} of one record."""
    out: Row = {}
    for mode, known in observe(found, model).modes.values():
        if mode.log_covariance is not None:
            f, z = np.sqrt(np.diag(mode.log_covariance))
            out[known.label] = [
                float(np.log(mode.frequency_hz)), float(f), float(np.log(mode.damping_ratio)), float(z)
            ]  # fmt: skip
    return out


def poles_of(found: Record) -> dict[str, list[float]]:
    """Return ln f and ln ζ of the simulated system's poles by label."""
    return {
        m["label"]: [float(np.log(m["frequency_hz"])), float(np.log(m["damping_ratio"]))]
        for m in found.metadata["true_modes"]
    }  # fmt: skip


def centres(rows: list[Row], labels: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Return the mean of ln f and ln ζ of each mode and its standard error, (2, 2), as a watch sees it.

    Records count by their stated accuracy, that of ζ at a common ζ on which it depends, and less beyond
    ``_HUBER`` of their standard deviations.
    """
    out = {}
    for label in labels:
        seen = np.array([row[label] for row in rows if label in row])
        if len(seen) < _FEW:
            continue
        f, f_std, z, z_std = seen.T
        z_std = z_std * np.exp(0.5 * (z - np.median(z)))
        out[label] = np.transpose([_mean_of(f, f_std), _mean_of(z, z_std)])
    return out


def _mean_of(x: np.ndarray, std: np.ndarray) -> tuple[float, float]:
    """Return a mean by Huber's weights and its standard error, for standard deviations but for a factor."""
    mean = float(np.median(x))
    for _ in range(30):
        off = np.abs(x - mean) / std
        far = off / (1.4826 * np.median(off))
        weight = np.minimum(1.0, _HUBER / np.maximum(far, 1e-9)) / std**2
        weight[far > _REJECTED] = 0.0
        mean = float(weight @ x / weight.sum())
    return mean, float(np.sqrt(weight**2 @ (x - mean) ** 2) / weight.sum())


def own_poles(
    centre: dict[str, np.ndarray], poles: dict[str, list[float]], like: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return ln f and ln ζ of the pole that each identified mode is: of all pairings the nearest.

    Parameters
    ----------
    like : what each mode had been beside its pole in another state, (2,); empty for nothing
    """
    known, names = np.array(list(poles.values())), list(centre)
    seen = np.array([centre[name][0] - like.get(name, 0.0) for name in names])
    off = np.sum(((seen[:, None] - known) / _NEAR) ** 2, axis=2)
    off += [[float(name != pole) for pole in poles] for name in names]
    chosen = linear_sum_assignment(off)[1]
    return {name: known[k] for name, k in zip(names, chosen, strict=True)}


def moved_to(rows: list[Row], by: dict[str, np.ndarray]) -> list[Row]:
    """Return the rows with ln f and ln ζ of each mode moved; modes of which nothing is known are left out."""
    return [
        {n: [f + by[n][0], f_std, z + by[n][1], z_std] for n, (f, f_std, z, z_std) in row.items() if n in by}
        for row in rows
    ]  # fmt: skip


def watched_labels(before: list[Row]) -> tuple[str, ...]:
    """Return the labels that are found often enough, by frequency; no member's own modes."""
    names = {n for row in before for n in row if not n.startswith(LOCAL)}
    often = [n for n in names if np.mean([n in row for row in before]) >= _SEEN]
    return tuple(sorted(often, key=lambda n: np.mean([row[n][0] for row in before if n in row])))


def season(
    before: list[Row], after: list[Row], labels: tuple[str, ...], begun: float, days: float, seed: int
) -> History:
    """Return seasons whose rows are identified records, changed from a day on."""
    rng = np.random.default_rng((5, seed))
    s = seasons(50_000 + seed, days, Kind(records_a_cluster=1.0))
    n = s.days.size
    # what moves all rows, without the noise of an identification that was never made
    slow = np.concatenate([s.expected, _further(s, days, rng)], axis=2)[:, :, : len(labels)]
    values = np.full((4, n, len(labels)), np.nan)
    for i, day in enumerate(s.days):
        pool = after if day >= begun else before
        row = pool[rng.integers(len(pool))]
        for q, label in enumerate(labels):
            if label in row:
                f, f_std, z, z_std = row[label]
                values[:, i, q] = np.exp(f + slow[0, i, q]), f_std, np.exp(z + slow[1, i, q]), z_std
    values[1] *= values[0]
    values[3] *= values[2]
    beside = np.stack(list(s.conditions.values()), axis=1)
    return History(
        s.days, labels, values[0], values[1], values[2], values[3], beside, tuple(s.conditions),
        np.zeros(n, dtype=np.intp),
    )  # fmt: skip


def _further(s: Seasons, days: float, rng: np.random.Generator) -> np.ndarray:
    """Return what moves four further modes, (2, n, 4): the same conditions, and what they do not explain."""
    own = np.stack([size * unexplained(rng, s.days, days, Kind()) for size in (1.0, 50.0)])
    return s.expected - np.stack([s.process, 0.0 * s.process]) + own


def louder(found: Record, times: float) -> Record:
    """Return the record with white noise on its first channel, so many times what the channel shows."""
    data = found.data.copy()
    noise = np.random.default_rng(7).standard_normal(data.shape[1])
    data[0] += times * data[0].std() * noise
    return replace(found, data=data)


def late(found: Record, by: float) -> Record:
    """Return the record of a clock that runs wrong by a share, and its poles as this clock shows them."""
    faster = 1.0 + by
    poles = [m | {"frequency_hz": faster * m["frequency_hz"]} for m in found.metadata["true_modes"]]
    known = dict(found.metadata) | {"true_modes": poles}
    return replace(found, sample_rate_hz=faster * found.sample_rate_hz, metadata=known)
