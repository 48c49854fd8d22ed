"""Motion and stress from sensors of a jacket whose truth the model itself makes."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.fatigue import LifeModel, TubeDetails, count, read_curve
from jackettwin.fatigue.tube_welds import Detail
from jackettwin.loads import operating_point, read_rotor
from jackettwin.records import Channel, Record
from jackettwin.response import Sensor, System, build_system, static_displacement
from jackettwin.sensing import (
    MotionEstimate,
    MotionModel,
    RotorByWind,
    SensorReadings,
    Weather,
    discrete,
    motion_from,
    readings_of,
    section_rows,
    sensed_model,
    spread_of,
    steady_smoother,
)
from jackettwin.sensing.estimate import motion_at_levels
from jackettwin.sensing.wind_forces import gusts_std
from jackettwin.soil import pinned
from jackettwin.structure import Rayleigh, SectionForces, assemble, section_forces
from jackettwin.study import record_life
from jackettwin.twin import RestingLoads, weld_map

WEATHER = Weather(12.0, 2.5, 8.0, 0.3, 72.0)
STEP_S = 0.1
SENSORS = tuple(
    Sensor(f"a{h}{axis}", d, height_m=h)
    for h in (144.0, 77.0, 28.0)
    for axis, d in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
)


@pytest.fixture(scope="module")
def system() -> System:
    structure = read_structure("jacket15")
    return build_system(assemble(structure), pinned(structure), rayleigh=Rayleigh.minimum(0.01, 0.3))


@pytest.fixture(scope="module")
def model(system: System) -> MotionModel:
    return sensed_model(system, WEATHER)


def drawn(model: MotionModel, seed: int) -> tuple[np.ndarray, SensorReadings]:
    """Return the coordinates of a motion with known levels, and what sensors read of it."""
    levels = {"rotor": 2e4, "tower": 33.0}
    known = model.with_forces(
        tuple(
            f.with_level(
                levels.get(f.name.split()[0], 0.4)
                * (20.0 if " M" in f.name else 1.0)
                * (0.1 if "quick" in f.name else 1.0)
            )
            for f in model.forces
        )
    )
    blank = Record(np.ones((len(SENSORS), 8)), 1.0 / STEP_S, tuple(Channel(s.channel) for s in SENSORS))
    seen = readings_of(blank, SENSORS, model.assembly)
    C = known.motion_rows(seen.rows, seen.tilt, seen.derivative)
    s = steady_smoother(*discrete(*known.dynamics(), STEP_S), C, np.full(len(SENSORS), 5e-8))
    x, y = s.draw(6_000, np.random.default_rng(seed))
    to = np.vstack([np.eye(known.n_modes, x.shape[1]), known.force_rows()])
    rng = np.random.default_rng(seed)
    local = [force.drawn(len(x), STEP_S, rng) for force in known.local_forces()]
    record = Record(y.T, 1.0 / STEP_S, blank.channels)
    return np.column_stack([x @ to.T, *local]), readings_of(record, SENSORS, model.assembly)


@pytest.fixture(scope="module")
def truth(model: MotionModel) -> tuple[np.ndarray, SensorReadings]:
    return drawn(model, 2)


@pytest.fixture(scope="module")
def estimate(model: MotionModel, truth: tuple[np.ndarray, SensorReadings]) -> MotionEstimate:
    return motion_from(model, truth[1])


def test_a_constant_force_moves_the_model_as_statics_say(system: System, model: MotionModel) -> None:
    """Whatever the modes leave out, braces under waves included."""
    force = model.forces[-1]
    u = static_displacement(system, force.load)
    q = model.modal_loads[:, -1] / model.omega**2
    assert_allclose(model.shapes @ q + model.flexibility[:, -1], u, atol=1e-9 * np.abs(u).max())
    coordinates = np.concatenate([q, np.eye(len(model.forces))[-1], np.zeros(len(model.local))])
    rows = section_rows(model)
    exact = section_forces(model.assembly, u[None], along=force.along[None])
    for part, whole in zip(rows, exact, strict=True):
        found = np.tensordot(coordinates, part, 1)
        assert_allclose(found, whole[0], atol=1e-8 * np.abs(whole).max())


def test_local_waves_bend_each_brace_as_all_of_their_patterns_do(model: MotionModel) -> None:
    """One history of a band has the axial and bending stress of twelve independent ones at every section."""
    p, rows = model.assembly.mesh.properties, section_rows(model)

    def power(forces: SectionForces) -> np.ndarray:
        per_force = (1.0 / p.A**2, 2.0 / (p.A * p.I), 2.0 / (p.A * p.I))
        parts = (forces.axial, forces.bending_y, forces.bending_z)
        return np.sum(
            [(f**2).sum(axis=0) * c[:, None] for f, c in zip(parts, per_force, strict=True)], axis=0
        )

    for k, (waves, bent) in enumerate(zip(model.local, model.bent, strict=True), start=-len(model.local)):
        every = power(section_forces(model.assembly, bent.T, along=waves.along))
        one = power(SectionForces(*(part[k, None] for part in rows)))
        assert_allclose(one, every, rtol=1e-6, atol=1e-12 * every.max())


def test_readings_in_time_and_in_frequency_are_the_same_model(
    model: MotionModel, truth: tuple[np.ndarray, SensorReadings]
) -> None:
    """C (iω − A)⁻¹ of a force's own state is the transfer function, times i ω twice for what accelerates."""
    seen, omega = truth[1], np.array([0.2, 1.1, 5.0])
    A, _ = model.dynamics()
    C = model.motion_rows(seen.rows, seen.tilt, seen.derivative)
    n = 2 * model.n_modes
    found = model.transfer(seen.rows, seen.tilt, seen.derivative, omega)
    rows = model.force_rows()
    own = rows.argmax(axis=1)
    scale = rows[np.arange(len(own)), own]
    for k, w in enumerate(omega):
        driven = np.linalg.solve(1j * w * np.eye(n) - A[:n, :n], A[:n, own])
        direct = (C[:, :n] @ driven + C[:, own]) / scale
        assert_allclose(direct, found[k], rtol=1e-6, atol=1e-12)


def test_a_working_rotor_pushes_as_it_damps(system: System, model: MotionModel) -> None:
    """The dashpot 2ζω/φ² of the fore-aft mode times class B's gusts over the disc, along the rotor's axis."""
    at_work = replace(WEATHER, working=True)
    found = sensed_model(system, at_work)
    top = model.assembly.dofs(model.assembly.structure.top_node)[0]
    most = int(np.abs(model.shapes[top, :2]).argmax())
    ratio = found.damping / (2.0 * found.omega)
    assert ratio[most, most] == pytest.approx(model.damping[most, most] / (2.0 * model.omega[most]) + 0.08)
    assert ratio[1 - most, 1 - most] < 0.02
    thrust = found.damping[most, most] / found.shapes[top, most] ** 2 * 0.57 * 0.14 * (0.75 * 12.0 + 5.6)
    level = {force.name: force.level for force in found.forces}
    usual = {force.name: force.level for force in model.forces}
    rows = model.assembly.dofs(model.assembly.structure.top_node)
    assert level["rotor Fx"] == pytest.approx(thrust, rel=1e-6)
    for name, over in (("rotor Fy", 0.2), ("rotor Mx", 0.2 * 20.0), ("rotor Mz, quick", 0.3 * 20.0)):
        assert level[name] == pytest.approx(over * thrust)
    assert level["tower x"] == usual["tower x"]
    turned = {f.name: f for f in sensed_model(system, replace(at_work, heading_rad=np.pi / 3.0)).forces}
    assert turned["rotor Fy"].level == pytest.approx(0.2 * turned["rotor Fx"].level)
    assert_allclose(turned["rotor Fx"].load[rows[:2]], [0.5, np.sqrt(0.75)], atol=1e-12)


def test_a_known_rotor_damps_and_pushes_as_its_blades_do(system: System, model: MotionModel) -> None:
    """Of the shipped 15 MW rotor at 12 m/s the first fore-aft mode loses cφ², and gusts push by dT/dU."""
    rotor = RotorByWind(*read_rotor("iea15"), 0.17)
    weather = Weather.of({"state": "operating", "mean_wind_speed_m_s": 12.0}, 72.0, rotor=rotor)
    assert weather.rotor is not None
    found = sensed_model(system, weather)
    still = sensed_model(system, replace(weather, working=False))
    top = model.assembly.dofs(model.assembly.structure.top_node)
    most = int(np.abs(model.shapes[top[0], :2]).argmax())
    added = found.damping - still.damping
    phi = found.shapes[top]
    assert_allclose(added, phi.T @ weather.rotor.damping @ phi, atol=1e-9 * np.abs(added).max())
    assert 0.05 < added[most, most] / (2.0 * found.omega[most]) < 0.15
    level = {force.name: force.level for force in found.forces}
    assert level["rotor Fx"] == pytest.approx(0.57 * weather.rotor.thrust_slope * gusts_std(12.0))
    # dT/dU of the wake that has settled, and less than twice what the tower's motion sees
    assert 0.9 < weather.rotor.thrust_slope / weather.rotor.damping[0, 0] < 1.6
    sideways = weather.rotor.towards(0.5 * np.pi)
    assert sideways[1, 1] == pytest.approx(weather.rotor.damping[0, 0])
    assert sideways[3, 3] == pytest.approx(weather.rotor.damping[4, 4])
    # straight between computed winds, held at the ends of what the rotor works in
    assert rotor.at(13.5).damping == pytest.approx(0.5 * (rotor.at(13.0).damping + rotor.at(14.0).damping))
    assert rotor.at(60.0).thrust_slope == rotor.at(25.0).thrust_slope


def test_blades_cut_gusts_as_they_pass(system: System) -> None:
    """Moments of a known rotor have a band at three times its speed, of 0.72 of what its slow ones have."""
    rotor, control = read_rotor("iea15")
    weather = Weather.of(
        {"state": "operating", "mean_wind_speed_m_s": 13.0}, 72.0, rotor=RotorByWind(rotor, control, 0.17)
    )
    forces = {f.name: f for f in sensed_model(system, weather).forces}
    passing = forces["rotor My, passing"]
    assert passing.rate == pytest.approx(3.0 * operating_point(rotor, control, 13.0).rotor_speed)
    assert passing.level == pytest.approx(0.72 * forces["rotor My"].level)
    rows = system.assembly.dofs(system.assembly.structure.top_node)
    # all of it acts at the hub
    assert_allclose(forces["rotor Fx"].load[rows], [1.0, 0.0, 0.0, 0.0, rotor.hub_height, 0.0], atol=1e-12)
    omega = np.linspace(0.0, 10.0, 20001)
    S = passing.density(omega)
    near = np.abs(omega / passing.rate - 1.0) < 0.1
    assert 0.5 < S[near].sum() / S.sum() < 0.9
    assert not any("passing" in f.name for f in sensed_model(system, replace(weather, working=False)).forces)


def test_drift_of_accelerometers_makes_no_slow_moment(
    model: MotionModel, truth: tuple[np.ndarray, SensorReadings], estimate: MotionEstimate
) -> None:
    """Offsets of up to 1 mm/s² that drift by a tenth of it, which would move the top by metres."""
    readings = truth[1]
    n = readings.y.shape[1]
    drift = (1e-3 + 1e-4 * np.cos(np.pi * np.arange(n) / n)) * np.array([[1.0, -0.6, 0.3, 0.8, -1.0, 0.5]]).T
    found = motion_at_levels(estimate.model, replace(readings, y=readings.y + drift), estimate.levels)
    names = [model.assembly.structure.members[m].name for m in model.assembly.mesh.member]
    row = section_rows(model).bending_y[:, names.index("tower_1"), 0]
    moved_by = (found.mean() - estimate.mean()) @ row
    assert moved_by.std() < 0.5 * float(spread_of(row[None], estimate.covariance)[0])


def test_an_accelerometer_drifts_as_its_white_noise_at_a_hundredth_of_a_hertz(
    estimate: MotionEstimate,
) -> None:
    """An offset xₖ₊₁ = k xₖ + w has the density q/|1 − k e^(−iωh)|² over the rate, white noise σ².

    The offset alone is bounded by 1 mm/s², which its variance q/(1 − k²) keeps.
    """
    s, kinds = estimate.smoother, np.array(estimate.readings.derivative)
    drifts = np.flatnonzero(kinds == 2) - kinds.size
    keep, q = np.diag(s.F)[drifts], np.diag(s.Q)[drifts]
    turn = np.exp(-2j * np.pi * 0.01 * estimate.readings.step_s)
    # at 0.01 Hz its finite memory takes a part of the density
    assert_allclose(q / np.abs(1.0 - turn) ** 2, s.R[kinds == 2], rtol=1e-3)
    assert_allclose(q / (1.0 - keep**2), 1e-6, rtol=1e-9)


def test_no_motion_is_driven_by_a_rotor(model: MotionModel) -> None:
    """Negative damping of one motion leaves at least the ratio that is asked."""
    C = np.zeros((6, 6))
    C[1, 1] = -1e7
    found = model.with_damping_at_top(C, 1e-3)
    assert np.linalg.eigvalsh(found.damping).min() == pytest.approx(2e-3 * model.omega[0])


def test_section_forces_are_found_and_their_errors_are_as_said(
    model: MotionModel, truth: tuple[np.ndarray, SensorReadings], estimate: MotionEstimate
) -> None:
    """Over three motions, as one may be found better or worse than another."""
    names = [model.assembly.structure.members[m].name for m in model.assembly.mesh.member]
    base = names.index("tower_1")
    rows = section_rows(model)
    others = (drawn(model, seed) for seed in (1, 3))
    motions = [(truth[0], estimate), *((own, motion_from(model, readings)) for own, readings in others)]
    left, beside = [], []
    for coordinates, known in motions:
        for part in (rows.bending_y, rows.bending_z):
            row = part[:, base, 0]
            true, found = coordinates @ row, known.mean() @ row
            error = (found - true).std()
            left.append(error / true.std())
            beside.append(error / float(spread_of(row[None], known.covariance)[0]))
            # above 0.1 Hz, where the rotor pushes little, short waves that sensors hardly see are
            # missed: 2 to 18 %
            fast = np.fft.rfftfreq(len(true), STEP_S) > 0.1
            parts = [np.abs(np.fft.rfft(v)[fast]) ** 2 for v in (found - true[: len(found)], true)]
            assert parts[0].sum() < 0.2**2 * parts[1].sum()
    assert np.sqrt(np.mean(np.square(left))) < 0.75
    # the mean over ten minutes of slow forces is in what is said, and in no range of stress
    assert 0.6 < np.sqrt(np.mean(np.square(beside))) < 1.4


def test_damage_is_neither_too_low_nor_too_high(
    system: System, model: MotionModel, truth: tuple[np.ndarray, SensorReadings]
) -> None:
    """Damage-equivalent stress at the worst welds, against that of the motion itself."""
    coordinates, readings = truth
    life = LifeModel(read_curve("T", "air"))
    rest = RestingLoads.of(assemble(model.assembly.structure))
    base = TubeDetails(
        lambda z: ("air", life), own=(Detail("base", "tower_1", 0.0, 1.0, lambda z: ("air", life)),)
    )
    found = record_life([system], readings, WEATHER, lambda z: ("air", life), rest, details=base)
    chart = weld_map(system, model, rest)
    exact = chart.cycles(coordinates)
    welds = [w for joint in chart.joints for w in joint.welds]
    true = {
        (w.node, w.brace, side): max(life.curve.damage(c.ranges, c.numbers, thickness_m=t) for c in points)
        for w, of_weld in zip(welds, exact, strict=True)
        for side, points, t in zip(("chord", "brace"), of_weld, w.thickness_m, strict=True)
    }
    ratio = np.array(
        [(one.life.damage / true[one.weld.node, one.weld.brace, one.side]) ** 0.2 for one in found.welds[:40]]
    )
    assert 0.93 < np.median(ratio) < 1.08
    assert (np.abs(ratio - 1.0) < 0.3).mean() > 0.9
    assert "what sensors do not see" in found.welds[0].life.variance_shares
    (tube,) = (one for one in found.tubes if one.weld.name == "base")
    series = tube.weld.stress(section_rows(model)) @ coordinates.T
    thickness = tube.weld.section.thickness_m
    cycles = [count(one) for one in series]
    worst = max(life.curve.damage(c.ranges, c.numbers, thickness_m=thickness) for c in cycles)
    # slow gusts are expected rather than felt: 0.91 to 1.09 of five motions
    assert 0.85 < (tube.life.damage / worst) ** 0.2 < 1.15
    assert "what sensors do not see" in tube.life.variance_shares
