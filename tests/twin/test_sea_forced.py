"""The shape in which the sea forces a structure, against the full model's response and beside the rotor's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from observations import estimate

from jackettwin.decks import read_structure
from jackettwin.identification import ModalEstimate
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.response.system import build_system
from jackettwin.soil.support import standing
from jackettwin.structure import assemble
from jackettwin.structure.assemble import Assembly
from jackettwin.twin.mode_doubts import sea_share
from jackettwin.updating import numbered_modes
from jackettwin.updating.data.foot_stiffness import Feet

AT_M = (140.0, 80.0, 25.0)
SENSORS = tuple(
    Sensor(f"{h:.0f}_{axis}", (float(axis == "x"), float(axis == "y"), 0.0), height_m=h)
    for h in AT_M
    for axis in "xy"
)
BETWEEN_HZ = 0.45
"""Between the first and the second bending modes of the reference jacket on pinned feet."""


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return assemble(read_structure("jacket15"))


@pytest.fixture(scope="module")
def feet(assembly: Assembly) -> Feet:
    numbered = numbered_modes(assembly, 12)
    return Feet(np.inf, numbered.frequency_hz, numbered.shapes)


def forced(assembly: Assembly, nodes: list[str]) -> ModalEstimate:
    """Return a peak of the shape that forces on nodes, along x and a little y, make of the full model."""
    system = build_system(assembly, standing(assembly.structure))
    force = np.zeros(assembly.mesh.n_dof)
    for node in nodes:
        force[assembly.mesh.node_dofs(node)[:2]] = 1.0, 0.3
    pulled = system.expand(np.eye(system.pencil.n)).T @ (assembly.expand.T @ force)
    dynamic = system.pencil.static_stiffness() - (2.0 * np.pi * BETWEEN_HZ) ** 2 * system.pencil.M
    u = spla.spsolve(sp.csc_array(dynamic), pulled)
    shape = observation_matrix(assembly, SENSORS) @ system.expand(u[:, None])[:, 0]
    return replace(estimate(BETWEEN_HZ, 0.03), mode_shape=np.asarray(shape, complex))


def test_forces_at_still_water_are_the_seas_and_those_at_the_top_are_not(
    assembly: Assembly, feet: Feet
) -> None:
    level, at = assembly.structure.sea_level_z_m, observation_matrix(assembly, SENSORS)
    nodes = assembly.structure.nodes
    height = min({z for _, _, z in nodes.values()}, key=lambda z: abs(z - level))
    wet = [name for name, (_, _, z) in nodes.items() if z == height]
    share = sea_share(
        (forced(assembly, wet), forced(assembly, [assembly.structure.top_node])), assembly, at, feet
    )
    assert share[0] > 0.99  # of waves on records the least is 0.967
    assert share[1] < 0.5


def test_at_a_mode_any_force_makes_its_shape(assembly: Assembly, feet: Feet) -> None:
    at = observation_matrix(assembly, SENSORS)
    modes = tuple(
        replace(
            estimate(float(feet.frequency_hz[k]), 0.01), mode_shape=(at @ feet.shapes[:, k]).astype(complex)
        )
        for k in (0, 1)
    )
    np.testing.assert_allclose(sea_share(modes, assembly, at, feet), 1.0, atol=0.01)


def test_a_structure_on_land_has_no_sea(assembly: Assembly, feet: Feet) -> None:
    dry = replace(assembly, structure=replace(assembly.structure, sea_level_z_m=-1e3))
    at = observation_matrix(assembly, SENSORS)
    assert sea_share((forced(assembly, ["tower_top"]),), dry, at, feet) == 0.0
