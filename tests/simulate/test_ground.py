"""Ground that unloads and reloads in time: linear when little moves, softer and lossy when much does."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.simulate import read_scenario
from jackettwin.simulate.motion.motion import simulate_motion

PILES = {"length_m": 40.0, "outer_diameter_m": 2.0, "thickness_m": 0.05, "element_m": 2.0}
CLAY = {
    "thickness_m": 60.0,
    "effective_weight_n_m3": 8e3,
    "clay": {"strength_pa": [20e3, 100e3], "strain_50": 0.002},
}
TIME = {"duration_s": 20.0, "step_s": 0.05}


def motion(scenario_file, height: float, *, hysteresis: bool):
    return simulate_motion(
        read_scenario(
            scenario_file(
                soil={"layers": [CLAY], "hysteresis": hysteresis},
                piles=PILES,
                damping={"rayleigh": {"ratio": 0.01, "frequency_hz": 0.2}},
                water={"depth_m": 72.0},
                waves={"type": "airy", "height_m": height, "period_s": 10.0},
                time=TIME,
            )
        )
    )


def test_little_motion_is_linear(scenario_file) -> None:
    """1 mm of waves: feet move by micrometres, below where the first sliders yield."""
    n = slice(0, 6)
    linear, loops = (motion(scenario_file, 1e-3, hysteresis=h) for h in (False, True))
    tops = [m.states[:, : m.space.n] @ m.model.top[n].T for m in (linear, loops)]
    np.testing.assert_allclose(tops[1], tops[0], atol=0.01 * np.abs(tops[0]).max())


def test_much_motion_softens_the_ground_and_takes_energy(scenario_file) -> None:
    """Under 12 m of waves the ground gives way: the feet go further, and their forces do work on it."""
    linear, loops = (motion(scenario_file, 12.0, hysteresis=h) for h in (False, True))
    structure = loops.model.assembly.structure
    foot = loops.model.assembly.mesh.node_dofs(structure.reaction_nodes[0])
    rows = np.asarray(loops.model.assembly.expand[foot] @ loops.model.reduced.basis)
    q = loops.states[:, : loops.space.n] @ rows.T
    at_rest = linear.states[:, : linear.space.n] @ rows.T
    assert np.abs(q[:, 0]).max() > 1.1 * np.abs(at_rest[:, 0]).max()
    # what the feedback adds does no work in a closed linear cycle; loops take it
    added = loops.force - linear.force
    last = slice(200, 401)  # the second period
    v = loops.states[last, loops.space.n : 2 * loops.space.n]
    assert np.einsum("ti,ti->t", added[last], v).sum() < 0.0


def test_what_has_no_loops_is_refused(scenario_file) -> None:
    linear = {"linear": {"lateral_n_m3": 4e7, "axial_n_m2": 1.6e8, "tip_n_m": 4e8}, "hysteresis": True}
    with pytest.raises(InputError, match="linear ground has no loops"):
        read_scenario(scenario_file(soil=linear, piles=PILES))
    twice = {"layers": [CLAY], "hysteresis": True, "damping": {"ratio": 0.02, "frequency_hz": 0.2}}
    with pytest.raises(InputError, match="damping already"):
        read_scenario(scenario_file(soil=twice, piles=PILES))
