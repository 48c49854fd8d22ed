"""Damage and life of the welds of tubular joints and around tubes in a scenario."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.checks import joint_plans
from jackettwin.errors import require
from jackettwin.fatigue import (
    POSITIONS,
    SIDES,
    Counter,
    ModelsAtHeight,
    TubeDetails,
    TubeLife,
    WeldLife,
    joint_stresses,
    tube_lives,
    tube_welds,
    weld_lives,
)
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import section_forces

_YIELD_PA = 355e6
"""Joints are planned with a yield strength, which fatigue does not use."""


@dataclass(frozen=True)
class ScenarioLife:
    """Life of every weld, shortest first, if all time were like a scenario.

    Attributes
    ----------
    joints : both sides of the welds of tubular joints
    tubes : welds around tubes
    apart : nodes in line where walls do not meet, so that no butt weld can join them
    duration_s : float
    """

    joints: tuple[WeldLife, ...]
    tubes: tuple[TubeLife, ...]
    apart: tuple[str, ...]
    duration_s: float


def scenario_life(scenario: Scenario, models: ModelsAtHeight, details: TubeDetails) -> ScenarioLife:
    """Return the life of every weld, if all time were like the scenario.

    Parameters
    ----------
    models : from an elevation above the sea [m] to what corrodes a tubular joint there, and its curve
    details : what is assessed of the tubes beside joints

    Raises
    ------
    InputError
        If the structure has no weld, a detail names no member, or the scenario cannot be simulated.
    MissingExtra
        If pylife is not installed.
    """
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    structure = assembly.structure
    joints = joint_stresses(structure, joint_plans(assembly, _YIELD_PA))
    tubes, apart = tube_welds(assembly, details)
    require(
        joints or tubes, "no brace stands on a chord and no tube changes its wall", field="structure",
        remedy="name details of its members",
    )  # fmt: skip
    welds = [weld for joint in joints for weld in joint.welds]
    sides = len(SIDES) * len(welds)
    counters = [[Counter() for _ in POSITIONS] for _ in range(sides + len(tubes))]
    samples = 0
    for u, along in deflections(scenario, motion):
        forces = section_forces(assembly, u, along=along)
        samples += len(u)
        stresses = [side for joint in joints for weld in joint.stress(assembly, forces) for side in weld]
        stresses += [tube.stress(forces) for tube in tubes]
        for points, counted in zip(stresses, counters, strict=True):
            for series, counter in zip(points, counted, strict=True):
                counter.add(series)
    cycles = [[counter.ended() for counter in counted] for counted in counters]
    of_joints = [cycles[i : i + len(SIDES)] for i in range(0, sides, len(SIDES))]
    duration = samples * motion.step_s
    return ScenarioLife(
        weld_lives(structure, welds, of_joints, duration, models),
        tube_lives(structure, tubes, cycles[sides:], duration),
        apart,
        duration,
    )
