"""Sensors on nodes and between them."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response import sensors as sensors_module
from jackettwin.response.sensors import Sensor, SensorKind, observation_matrix
from jackettwin.structure import Assembly, assemble
from jackettwin.structure.beam import rotation_shape
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


def bent(assembly: Assembly, force: np.ndarray) -> np.ndarray:
    """Return the displacement of a structure held at its feet under a force on its top."""
    held = np.concatenate([assembly.dofs(node) for node in assembly.structure.reaction_nodes])
    free = np.setdiff1d(np.arange(assembly.n_dof), held)
    load = np.zeros(assembly.n_dof)
    load[assembly.dofs("tower_top")[:3]] = force
    x = np.zeros(assembly.n_dof)
    x[free] = np.linalg.solve(assembly.stiffness[free][:, free].toarray(), load[free])
    return x


@pytest.mark.parametrize("beam", ["euler-bernoulli", "timoshenko"])
def test_strain_on_the_tower_is_bending_over_its_section_modulus(jacket15, beam: str) -> None:
    """ε = −F (h_top − h) R/EI on the side to which a tip load pulls, +F/EA under one that lifts."""
    assembly = assemble(jacket15.structure, beam_theory=beam)
    height, F = 77.0, 1e6
    sides = {"x": (1.0, 0.0, 0.0), "back": (-2.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
    gauges = tuple(Sensor(n, d, height_m=height, quantity="strain") for n, d in sides.items())
    mesh, sea = assembly.mesh, assembly.structure.sea_level_z_m
    low, high = mesh.coordinates[mesh.start, 2], mesh.coordinates[mesh.end, 2]
    on_tower = np.hypot(*mesh.coordinates[mesh.start, :2].T) < 1e-6
    e = int(np.flatnonzero(on_tower & (low < height + sea) & (height + sea < high))[0])
    p = mesh.properties
    arm = assembly.structure.nodes["tower_top"][2] - sea - height
    member = assembly.structure.members[mesh.member[e]]
    share = (height + sea - low[e]) / (high[e] - low[e])
    radius = 0.5 * (
        member.section_start.outer_diameter_m
        + 0.5 * (member.section_end.outer_diameter_m - member.section_start.outer_diameter_m)
    )
    strain = F * arm * radius / (p.E[e] * p.I[e])
    seen = observation_matrix(assembly, gauges) @ bent(assembly, np.array([F, 0.0, 0.0]))
    np.testing.assert_allclose(seen, [-strain, strain, 0.0], rtol=1e-7, atol=1e-7 * strain)
    pulled = observation_matrix(assembly, gauges) @ bent(assembly, np.array([0.0, 0.0, F]))
    np.testing.assert_allclose(pulled, F / (p.E[e] * p.A[e]), rtol=1e-6)
    by_member = Sensor("m", (1.0, 0.0, 0.0), member=member.name, position=share, quantity="strain")
    x = bent(assembly, np.array([F, 0.0, 0.0]))
    assert float((observation_matrix(assembly, (by_member,)) @ x)[0]) == pytest.approx(seen[0], rel=1e-9)


def test_a_rigid_structure_turns_everywhere_alike_and_is_not_strained(jacket15) -> None:
    brace = next(m.name for m in jacket15.structure.members if "brace" in m.name or "b" in m.name)
    places = ({"height_m": 60.0}, {"member": brace, "position": 0.3}, {"node": "tower_top"})
    for place in places:
        leans = tuple(Sensor("i", d, quantity="inclination", **place) for d in ((1, 0, 0), (0, 1, 0)))
        seen = observation_matrix(jacket15, leans) @ rigid_body_motion(jacket15)
        # leaning towards x is turning about y, leaning towards y about −x
        np.testing.assert_allclose(seen, [[0, 0, 0, 0, 1, 0], [0, 0, 0, -1, 0, 0]], atol=1e-9)
    gauge = Sensor("g", (0.3, 1.0, 0.2), member=brace, quantity="strain")
    strained = observation_matrix(jacket15, (gauge,)) @ rigid_body_motion(jacket15)
    np.testing.assert_allclose(strained, 0.0, atol=1e-9)


def test_an_inclinometer_sees_the_slope_of_the_beam(jacket15) -> None:
    """What the tower moves more, from one height to another, is its mean lean between them."""
    x = bent(jacket15, np.array([1e6, 0.0, 0.0]))
    heights = np.linspace(60.0, 61.0, 11)
    motion = [Sensor("u", (1, 0, 0), height_m=h) for h in (60.0, 61.0)]
    tilt = [Sensor("t", (1, 0, 0), height_m=float(h), quantity="inclination") for h in heights]
    u = observation_matrix(jacket15, tuple(motion)) @ x
    turned = observation_matrix(jacket15, tuple(tilt)) @ x
    assert np.trapezoid(turned, heights) == pytest.approx(u[1] - u[0], rel=1e-4)


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        (Sensor("a", (0, 0, 0), node="tower_top"), r"sensors.a.direction: direction must not be zero"),
        (Sensor("a", (np.nan, 0, 0), node="tower_top"), "direction must not be zero"),
        (Sensor("a", (1, 0, 0)), "give node, height_m or member"),
        (Sensor("a", (1, 0, 0), node="tower_top", height_m=3.0), "give node, height_m or member"),
        (
            Sensor("a", (1, 0, 0), node="tower_top", quantity="strain"),
            "strain is measured on a member, not on a node",
        ),
        (Sensor("a", (0, 0, 1), height_m=60.0, quantity="strain"), "must point from the section's centre"),
        (Sensor("a", (0, 0, 1), height_m=60.0, quantity="inclination"), "must be horizontal"),
        (Sensor("a", (1, 0, 0), member="tower_01"), "no such member .got 'tower_01'"),
        (Sensor("a", (1, 0, 0), node="tower_tip"), "no such node .got 'tower_tip'.*did you mean 'tower_top'"),
        (Sensor("a", (1, 0, 0), height_m=200.0), "not on the tower axis .got 200.0.; allowed: 22 to 144 m"),
    ],
)
def test_bad_sensors_are_refused(jacket15, sensor: Sensor, message: str) -> None:
    with pytest.raises(InputError, match=message):
        observation_matrix(jacket15, (sensor,))


def test_no_sensors_give_an_empty_matrix(jacket15) -> None:
    assert observation_matrix(jacket15, ()).shape == (0, jacket15.n_dof)


def test_another_package_adds_a_kind_of_sensor(jacket15, monkeypatch: pytest.MonkeyPatch) -> None:
    """A gyroscope sees the rotation about its own direction: that of a lean a quarter turn ahead."""
    gyroscope = SensorKind(
        "gyroscope",
        lambda at, d: at.axes @ d @ rotation_shape(at.xi, at.length_m, at.shear),
        lambda d: np.concatenate([np.zeros(3), d]),
        "inclination",
    )
    monkeypatch.setattr(sensors_module, "plugins_of_type", lambda group, kind: {"gyroscope": gyroscope})
    for place in ({"node": "tower_top"}, {"height_m": 60.0}):
        turn = Sensor("g", (0.0, 1.0, 0.0), quantity="gyroscope", **place)
        lean = Sensor("i", (1.0, 0.0, 0.0), quantity="inclination", **place)
        both = observation_matrix(jacket15, (turn, lean)).toarray()
        np.testing.assert_allclose(both[0], both[1], atol=1e-15)
    with pytest.raises(InputError, match=r"sensors.g.quantity: no such kind of sensor.*motion, inclination"):
        observation_matrix(jacket15, (Sensor("g", (1.0, 0.0, 0.0), node="tower_top", quantity="sonar"),))
