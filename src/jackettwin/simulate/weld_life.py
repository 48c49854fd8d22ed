"""Damage and life of the welds of tubular joints and around tubes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray
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
from jackettwin.simulate.given_sections import GivenSections
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import Assembly, SectionForces, few, section_forces

_YIELD_PA = 355e6
"""Joints are planned with a yield strength, which fatigue does not use."""


@dataclass(frozen=True)
class ScenarioLife:
    """Life of every weld, shortest first, if all time were like a scenario or another program's forces.

    Attributes
    ----------
    joints : both sides of the welds of tubular joints
    tubes : welds around tubes
    apart : nodes in line where walls do not meet, so that no butt weld can join them
    duration_s : float
    unknown : joints and welds around tubes whose section forces are not all given
    """

    joints: tuple[WeldLife, ...]
    tubes: tuple[TubeLife, ...]
    apart: tuple[str, ...]
    duration_s: float
    unknown: tuple[str, ...] = ()


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
    forces = (section_forces(assembly, u, along=along) for u, along in deflections(scenario, motion))
    every = np.ones((assembly.mesh.start.size, 2), dtype=bool)
    return _life(assembly, forces, every, motion.step_s, models, details)


def given_life(
    given: GivenSections, step_s: float, models: ModelsAtHeight, details: TubeDetails
) -> ScenarioLife:
    """Return the life of the welds whose section forces another program told, in steps of ``step_s``.

    Raises
    ------
    InputError
        If no weld has all of its section forces, or a detail names no member.
    """
    return _life(given.assembly, given.blocks(), given.known, step_s, models, details)


def _life(
    assembly: Assembly,
    blocks: Iterable[SectionForces],
    known: BoolArray,
    step_s: float,
    models: ModelsAtHeight,
    details: TubeDetails,
) -> ScenarioLife:
    """Return the life of the welds whose forces are known at the ends of elements (n_elements, 2)."""
    structure = assembly.structure
    every = joint_stresses(structure, joint_plans(assembly, _YIELD_PA))
    around, apart = tube_welds(assembly, details)
    require(
        every or around, "no brace stands on a chord and no tube changes its wall", field="structure",
        remedy="name details of its members",
    )  # fmt: skip
    joints = [j for j in every if all(known[end.element, end.at_end] for end in j.plan.braces)]
    tubes = [
        t for t in around
        if all(known[t.element, e] for e, share in enumerate((1.0 - t.share, t.share)) if share > 0.0)
    ]  # fmt: skip
    unknown = [j.plan.node for j in every if j not in joints] + [t.name for t in around if t not in tubes]
    require(
        joints or tubes, "no weld has all of its section forces", field="columns", value=few(unknown),
        remedy="give all braces of a joint at its node: axial force and both bending moments",
    )  # fmt: skip
    welds = [weld for joint in joints for weld in joint.welds]
    sides = len(SIDES) * len(welds)
    counters = [[Counter() for _ in POSITIONS] for _ in range(sides + len(tubes))]
    samples = 0
    for forces in blocks:
        samples += len(forces.axial)
        stresses = [side for joint in joints for weld in joint.stress(assembly, forces) for side in weld]
        stresses += [tube.stress(forces) for tube in tubes]
        for points, counted in zip(stresses, counters, strict=True):
            for series, counter in zip(points, counted, strict=True):
                counter.add(series)
    cycles = [[counter.ended() for counter in counted] for counted in counters]
    of_joints = [cycles[i : i + len(SIDES)] for i in range(0, sides, len(SIDES))]
    duration = samples * step_s
    return ScenarioLife(
        weld_lives(structure, welds, of_joints, duration, models),
        tube_lives(structure, tubes, cycles[sides:], duration),
        apart,
        duration,
        tuple(unknown),
    )
