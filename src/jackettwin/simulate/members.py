"""What a scenario demands of every member."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jackettwin.loads.water import water_weight
from jackettwin.response.static import self_weight, static_displacement
from jackettwin.response.system import build_system
from jackettwin.simulate.motion import Motion, simulate_motion
from jackettwin.simulate.scenario import Scenario
from jackettwin.simulate.water import water_points
from jackettwin.structure import Assembly, assemble
from jackettwin.structure.member_check import DesignBasis, MemberUse, member_uses

FloatArray = npt.NDArray[np.float64]


def scenario_uses(scenario: Scenario, basis: DesignBasis | None = None) -> tuple[MemberUse, ...]:
    """Return the worst use of every member over a scenario, its weight in air and water included.

    Forces follow from the motion, whose coordinates hold modes up to the simulation's band: the bending of a
    single brace between its joints under the wave on it alone is not among them.

    Raises
    ------
    InputError
        If parts of the scenario do not fit each other, or it cannot stand.
    NumericalError
        If the motion grows without bound.
    """
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    kept = round(scenario.clock.discard_s / motion.step_s)
    q = motion.states[kept:, : motion.space.n]
    return member_uses(assembly, at_rest(scenario, motion) + q @ motion.model.reduced.basis.T, basis)


def at_rest(scenario: Scenario, motion: Motion) -> FloatArray:
    """Return displacements under the weight in air, and under that of water and growth less buoyancy."""
    asset, sea = scenario.asset, scenario.sea
    assembly = motion.model.assembly
    load = self_weight(_dry(scenario, assembly))
    if sea is not None and sea.water is not None:
        load = load + water_weight(assembly, water_points(assembly, sea), sea.water)
    return static_displacement(build_system(assembly, asset.support), load)


def _dry(scenario: Scenario, assembly: Assembly) -> Assembly:
    """Return the assembly without the water that moves with it: added mass weighs nothing."""
    asset = scenario.asset
    return assemble(
        assembly.structure,
        beam_theory=asset.beam,
        rotary_inertia=asset.rotary_inertia,
        subdivide=asset.subdivide,
    )
