"""Damage and life of the welds of tubular joints in a scenario."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.checks import joint_plans
from jackettwin.errors import require
from jackettwin.fatigue import (
    POSITIONS,
    SIDES,
    Counter,
    Environment,
    HotSpot,
    LifeModel,
    SpotLife,
    joint_stresses,
)
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import section_forces

_YIELD_PA = 355e6
"""Joints are planned with a yield strength, which fatigue does not use."""


@dataclass(frozen=True)
class WeldLife:
    """The worst of the eight points on one side of a weld.

    Attributes
    ----------
    weld : HotSpot
    side : str
        Chord or brace.
    position : str
        The point, counted from the crown.
    z_m : float
        Elevation of the node in the structure's frame.
    environment : str
    damage_by_point : (8,) by the design curve
    largest_range_pa : float
    life : SpotLife
    """

    weld: HotSpot
    side: str
    position: str
    z_m: float
    environment: Environment
    damage_by_point: FloatArray
    largest_range_pa: float
    life: SpotLife


def scenario_life(
    scenario: Scenario, models: Callable[[float], tuple[Environment, LifeModel]]
) -> tuple[WeldLife, ...]:
    """Return the life of both sides of every weld, shortest first, if all time were like the scenario.

    Parameters
    ----------
    models : from an elevation above the sea [m] to what corrodes a weld there, and its curve

    Raises
    ------
    InputError
        If the structure has no tubular joint, or the scenario is one that cannot be simulated.
    MissingExtra
        If pylife is not installed.
    """
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    structure = assembly.structure
    joints = joint_stresses(structure, joint_plans(assembly, _YIELD_PA))
    require(joints, "no brace stands on a chord", field="structure", remedy="joints of tubes are checked")
    welds = [weld for joint in joints for weld in joint.welds]
    counters = [[[Counter() for _ in POSITIONS] for _ in SIDES] for _ in welds]
    samples = 0
    for u, along in deflections(scenario, motion):
        forces = section_forces(assembly, u, along=along)
        samples += len(u)
        stress = np.concatenate([joint.stress(assembly, forces) for joint in joints])
        for of_weld, counted in zip(stress, counters, strict=True):
            for of_side, points in zip(of_weld, counted, strict=True):
                for series, counter in zip(of_side, points, strict=True):
                    counter.add(series)
    found = []
    duration_s = samples * motion.step_s
    for weld, counted in zip(welds, counters, strict=True):
        z = structure.nodes[weld.node][2]
        environment, model = models(z - structure.sea_level_z_m)
        for side, points, thickness in zip(SIDES, counted, weld.thickness_m, strict=True):
            cycles = [counter.ended() for counter in points]
            lives = [model.life(c, duration_s, thickness) for c in cycles]
            worst = int(np.argmax([life.damage for life in lives]))
            found.append(
                WeldLife(
                    weld,
                    side,
                    POSITIONS[worst],
                    z,
                    environment,
                    np.array([life.damage for life in lives]),
                    float(cycles[worst].ranges.max(initial=0.0)),
                    lives[worst],
                )
            )
    return tuple(sorted(found, key=lambda one: one.life.life_years))
