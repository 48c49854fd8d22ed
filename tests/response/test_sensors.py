"""Sensors on nodes and between them."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure.check import rigid_body_motion


def test_a_sensor_on_a_node_reads_its_motion(jacket15, rng) -> None:
    x = rng.standard_normal(jacket15.n_dof)
    sensors = (
        Sensor("x", (1, 0, 0), node="tower_top"),
        Sensor("skew", (0, 3, 4), node="tp_top"),
    )
    seen = observation_matrix(jacket15, sensors) @ x
    top, tp = x[jacket15.dofs("tower_top")], x[jacket15.dofs("tp_top")]
    np.testing.assert_allclose(seen, [top[0], 0.6 * tp[1] + 0.8 * tp[2]], rtol=1e-12)


@pytest.mark.parametrize("height", [28.0, 41.0, 77.0, 100.3, 144.0])
def test_rigid_motion_is_read_exactly_at_every_height(jacket15, height: float) -> None:
    """Invariant: a rotation about x at the mudline moves a gauge at height h by −(h + 72) in y."""
    motion = rigid_body_motion(jacket15)
    sensors = tuple(Sensor("xyz"[k], tuple(np.eye(3)[k]), height_m=height) for k in range(3))
    seen = observation_matrix(jacket15, sensors) @ motion
    z = height + 72.0
    expected = np.hstack([np.eye(3), [[0, z, 0], [-z, 0, 0], [0, 0, 0]]])
    np.testing.assert_allclose(seen, expected, atol=1e-9 * z)


def test_a_gauge_between_nodes_reads_the_beam_s_own_curve(jacket15) -> None:
    """Cubic shape functions: a static tip load bends unloaded elements into cubics, exact in between."""
    from jackettwin.structure import assemble

    structure = jacket15.structure
    fine = assemble(structure, subdivide=4)
    height = 41.0
    readings = []
    for assembly in (jacket15, fine):
        held = np.concatenate([assembly.dofs(node) for node in structure.reaction_nodes])
        free = np.setdiff1d(np.arange(assembly.n_dof), held)
        load = np.zeros(assembly.n_dof)
        load[assembly.dofs("tower_top")[0]] = 1e6
        x = np.zeros(assembly.n_dof)
        x[free] = np.linalg.solve(assembly.stiffness[free][:, free].toarray(), load[free])
        readings.append((observation_matrix(assembly, (Sensor("a", (1, 0, 0), height_m=height),)) @ x)[0])
    assert readings[0] == pytest.approx(readings[1], rel=1e-7)


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        (Sensor("a", (0, 0, 0), node="tower_top"), r"sensors.a.direction: direction must not be zero"),
        (Sensor("a", (np.nan, 0, 0), node="tower_top"), "direction must not be zero"),
        (Sensor("a", (1, 0, 0)), "give node or height_m"),
        (Sensor("a", (1, 0, 0), node="tower_top", height_m=3.0), "give node or height_m"),
        (Sensor("a", (1, 0, 0), node="tower_tip"), "no such node .got 'tower_tip'.*did you mean 'tower_top'"),
        (Sensor("a", (1, 0, 0), height_m=200.0), "not on the tower axis .got 200.0.; allowed: 22 to 144 m"),
    ],
)
def test_bad_sensors_are_refused(jacket15, sensor: Sensor, message: str) -> None:
    with pytest.raises(InputError, match=message):
        observation_matrix(jacket15, (sensor,))


def test_no_sensors_give_an_empty_matrix(jacket15) -> None:
    assert observation_matrix(jacket15, ()).shape == (0, jacket15.n_dof)
