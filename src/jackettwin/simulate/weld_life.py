"""Damage and life of the welds of tubular joints in a scenario."""

from __future__ import annotations

import numpy as np

from jackettwin.checks import joint_plans
from jackettwin.errors import require
from jackettwin.fatigue import (
    POSITIONS,
    SIDES,
    Counter,
    ModelsAtHeight,
    WeldLife,
    joint_stresses,
    weld_lives,
)
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import section_forces

_YIELD_PA = 355e6
"""Joints are planned with a yield strength, which fatigue does not use."""


def scenario_life(scenario: Scenario, models: ModelsAtHeight) -> tuple[WeldLife, ...]:
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
    cycles = [[[counter.ended() for counter in of_side] for of_side in counted] for counted in counters]
    return weld_lives(structure, welds, cycles, samples * motion.step_s, models)
