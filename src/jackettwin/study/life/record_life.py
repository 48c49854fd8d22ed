"""Fatigue damage and life of every weld of a structure from a record of a few sensors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.fatigue import (
    POSITIONS,
    SIDES,
    Cycles,
    ModelsAtHeight,
    SNCurve,
    TubeDetails,
    TubeLife,
    WeldLife,
    count,
    tube_lives,
    tube_welds,
    weld_lives,
)
from jackettwin.records import assess, read_record, repair, to_global_axes, with_conditions
from jackettwin.response import System
from jackettwin.sensing import (
    MotionEstimate,
    SensorReadings,
    Weather,
    likely_motions,
    readings_of,
    section_rows,
    stress_remainder,
)
from jackettwin.study.life.updated_system import updated_systems
from jackettwin.twin import (
    RestingLoads,
    TwinConfig,
    WeldMap,
    assembled_dry,
    rotor_by_wind,
    twin_model,
    weld_map,
)
from jackettwin.twin.calibration import calibrated
from jackettwin.updating import Update

DRAWS = 2
"""Number of sampled motions about the mean, in antithetic pairs, whose damage is averaged."""


@dataclass(frozen=True)
class RecordLife:
    """Life of every weld, shortest first, assuming that all time is like the record.

    Attributes
    ----------
    welds : tuple of WeldLife
    tubes : tuple of TubeLife
        Welds around tubes.
    apart : nodes in line where walls do not meet, so that no butt weld can join them
    estimate : MotionEstimate
    chart : WeldMap
        From the estimate's motion to stress.
    duration_s : float
    """

    welds: tuple[WeldLife, ...]
    tubes: tuple[TubeLife, ...]
    apart: tuple[str, ...]
    estimate: MotionEstimate
    chart: WeldMap
    duration_s: float


def readings_and_weather(
    config: TwinConfig, path: Path, *, feel_gravity: bool = False
) -> tuple[SensorReadings, Weather]:
    """Return a record's repaired sensor readings on a twin's structure, and its wind and sea.

    Parameters
    ----------
    feel_gravity : whether accelerometers also read −g times their tilt

    Raises
    ------
    InputError
        If the record cannot be read, measures no motion, or its sensors do not fit the structure.
    """
    record = with_conditions(calibrated(read_record(path, config.defaults), config.calibrations))
    model = twin_model(config)
    record = model.directed(record)
    record = repair(record, assess(record))
    if record.metadata.get("axes") == "rotor" or any(c.frame == "nacelle" for c in record.channels):
        record = to_global_axes(record, rename=not model.sensors)
    record = model.felt(record)
    water, numbered = config.water, model.numbered
    return (
        readings_of(record, model.placed(record), model.structure, feel_gravity=feel_gravity),
        Weather.of(
            config.operation.with_state(record.conditions),
            None if water is None else water.depth_m,
            None if water is None else water.coefficients,
            None if numbered is None else rotor_by_wind(config, float(numbered.frequency_hz[0])),
        ),
    )


def life_of_record(
    config: TwinConfig,
    update: Update,
    readings: SensorReadings,
    weather: Weather,
    models: ModelsAtHeight,
    *,
    draws: int = DRAWS,
    supports: int = 1,
    details: TubeDetails | None = None,
) -> RecordLife:
    """Return the life of a twin's welds from a record, on its updated supports.

    Parameters
    ----------
    draws : number of motions on each of the supports
    supports : number of the posterior's supports, the most probable first
    details : what is assessed of the tubes beside joints; nothing without it
    """
    rest = RestingLoads.of(assembled_dry(config), config.water)
    systems = updated_systems(update, draws=supports - 1)
    return record_life(systems, readings, weather, models, rest, draws=draws, details=details)


def record_life(
    systems: Sequence[System],
    readings: SensorReadings,
    weather: Weather,
    models: ModelsAtHeight,
    rest: RestingLoads,
    *,
    draws: int = DRAWS,
    seed: int = 0,
    details: TubeDetails | None = None,
) -> RecordLife:
    """Return damage and life of every weld from sensor readings.

    Damage is the mean over motions drawn from their posterior. The damage of the mean motion would be too
    low, as it lacks the motion that the sensors do not measure.

    Parameters
    ----------
    systems : the most probable structure, then draws of the posterior
    draws : number of motions on each
    details : what is assessed of the tubes beside joints; nothing without it

    Raises
    ------
    InputError
        If no brace is welded to a chord, or no tube reaches below the water level.
    """
    estimates = likely_motions(systems, readings, weather)
    rest = rest.under(weather, systems[0].assembly)
    charts = [weld_map(system, e.model, rest) for system, e in zip(systems, estimates, strict=True)]
    estimate, welds = estimates[0], [weld for joint in charts[0].joints for weld in joint.welds]
    motions = [list(own.draws(draws, seed=seed + k)) for k, own in enumerate(estimates)]
    every = [chart.cycles(motion) for chart, own in zip(charts, motions, strict=True) for motion in own]
    duration = readings.y.shape[1] * readings.step_s
    structure = estimate.model.assembly.structure
    above = [structure.nodes[w.node][2] - structure.sea_level_z_m for w in welds]
    curves, left = [models(z)[1].curve for z in above], partial(stress_remainder, working=weather.working)
    damages = np.array(
        [
            [
                [
                    [curve.damage(c.ranges, c.numbers, thickness_m=t) for c in side]
                    for side, t in zip(points, weld.thickness_m, strict=True)
                ]
                for points, weld, curve in zip(one, welds, curves, strict=True)
            ]
            for one in every
        ]
    )
    by_system = damages.reshape(len(systems), -1, *damages.shape[1:])
    others = [
        _variances(by_system[:, :, i], curve, left(z))
        for i, (curve, z) in enumerate(zip(curves, above, strict=True))
    ]
    cycles = [
        [[_all_of([one[i][s][p] for one in every]) for p in range(len(POSITIONS))] for s in range(len(SIDES))]
        for i in range(len(welds))
    ]
    lives = weld_lives(structure, welds, cycles, duration, models, times=len(every), others=others)
    tubes, apart = _tubes(estimates, motions, details, duration, left)
    return RecordLife(lives, tubes, apart, estimate, charts[0], duration)


def _tubes(
    estimates: Sequence[MotionEstimate],
    motions: Sequence[Sequence[FloatArray]],
    details: TubeDetails | None,
    duration_s: float,
    left: Callable[[float], float],
) -> tuple[tuple[TubeLife, ...], tuple[str, ...]]:
    """Return the life of the welds around tubes in motions of every structure.

    Parameters
    ----------
    left : from an elevation above the sea [m] to what no motion covers of ln of ranges
    """
    if details is None:
        return (), ()
    every: list[list[list[Cycles]]] = []
    for estimate, own in zip(estimates, motions, strict=True):
        welds, apart = tube_welds(estimate.model.assembly, details)
        moving = section_rows(estimate.model)
        rows = [weld.stress(moving) for weld in welds]
        every += [[[count(series) for series in row @ motion.T] for row in rows] for motion in own]
    structure = estimates[0].model.assembly.structure
    others, cycles = [], []
    for i, weld in enumerate(welds):
        above, t = weld.z_m - structure.sea_level_z_m, weld.section.thickness_m
        curve = weld.models(above)[1].curve
        damages = [[curve.damage(c.ranges, c.numbers, thickness_m=t) for c in one[i]] for one in every]
        by_system = np.array(damages).reshape(len(estimates), -1, len(POSITIONS))
        others.append(_variances(by_system, curve, left(above)))
        cycles.append([_all_of([one[i][p] for one in every]) for p in range(len(POSITIONS))])
    return tube_lives(structure, welds, cycles, duration_s, times=len(every), others=others), apart


def _all_of(cycles: list[Cycles]) -> Cycles:
    return Cycles(np.concatenate([c.full for c in cycles]), np.concatenate([c.half for c in cycles]))


def _variances(damage: FloatArray, curve: SNCurve, left: float) -> dict[str, FloatArray]:
    """Return the variance of ln D (…, 8) by source, from damages (n_systems, n_draws, …, 8).

    Parameters
    ----------
    left : standard deviation of ln of ranges that no draw covers
    """
    with np.errstate(divide="ignore"):
        logs = np.log(np.maximum(damage, 1e-300))
    within = logs.var(axis=1, ddof=1).mean(axis=0) if logs.shape[1] > 1 else np.zeros(logs.shape[2:])
    means = np.log(np.maximum(damage.mean(axis=1), 1e-300))
    between = means.var(axis=0, ddof=1) if len(means) > 1 else np.zeros(means.shape[1:])
    beyond = np.maximum(between - within / damage.shape[1], 0.0)
    return {
        "what sensors do not see": within,
        "structure and force levels": beyond,
        "simplified waves and modes": np.full(within.shape, (float(np.mean(curve.m)) * left) ** 2),
    }
