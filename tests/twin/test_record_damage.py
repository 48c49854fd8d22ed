"""Damage of a record at the welds, and its sums in the state."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from observations import estimate, observation

from jackettwin.decks import read_structure
from jackettwin.fatigue import count
from jackettwin.loads import Coefficients, Water
from jackettwin.records import Channel, Record
from jackettwin.response import Sensor, observation_matrix, undamped_modes
from jackettwin.sensing import (
    RotorAtTop,
    Weather,
    discrete,
    readings_of,
    section_rows,
    sensed_model,
    steady_smoother,
    stress_remainder,
)
from jackettwin.structure import Rayleigh, assemble, rigid_body_motion
from jackettwin.twin import (
    DAMAGE_UNIT,
    OBSERVATION,
    STATE,
    LifeSettings,
    Observation,
    RestingLoads,
    StressModel,
    TwinState,
    advance_all,
    planned_joints,
    weld_map,
)
from jackettwin.twin.life.damage_sums import weld_sums
from jackettwin.twin.life.likely_structures import likely_structures
from jackettwin.twin.life.sensed_damage import (
    KEPT_TUBES,
    STEP,
    SensedDamage,
    damage_of,
    sensed_damage,
    steps_of,
)
from jackettwin.twin.water import WaterConfig
from jackettwin.updating import Direction, Tolerance, numbered_modes

TOWER = tuple(
    Sensor(f"a{h:.0f}{axis}", way, height_m=h)
    for h in (144.0, 77.0, 28.0)
    for axis, way in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
)
NOON = datetime(2025, 3, 1, 12, tzinfo=UTC)


def damaged(k: int, rng: np.random.Generator) -> Observation:
    """Return the observation of a record that names some of thirty sides."""
    sides = np.sort(rng.choice(30, 5, replace=False))
    damage = SensedDamage(
        sides, rng.integers(0, 900, (5, 8)), rng.integers(0, 20, 5), rng.integers(0, 30, 5), 300
    )
    made = observation(
        {1: estimate(0.18, 0.01)}, NOON + timedelta(hours=7 * k), name=f"r{k}",
        conditions={"state": "parked" if k % 3 else "idling"},
    )  # fmt: skip
    return replace(made, damage=damage)


@pytest.fixture(scope="module")
def records() -> list[Observation]:
    rng = np.random.default_rng(3)
    return [damaged(k, rng) for k in range(12)]


def test_damage_is_kept_to_a_hundredth_in_a_kilobyte() -> None:
    """Sixteen sides of eight points: half a step of the logarithm is all that is lost."""
    rng = np.random.default_rng(0)
    damage = 10.0 ** rng.uniform(-10.5, -4.0, (16, 8))
    assert_allclose(DAMAGE_UNIT * damage_of(steps_of(damage)), damage, rtol=np.expm1(0.5 * STEP) * 1.01)
    assert damage_of(steps_of(np.array([0.5 * DAMAGE_UNIT]))) == 0.0
    kept = SensedDamage(np.arange(16), steps_of(damage), np.full(16, 20), np.full(16, 30), 500)
    made = replace(observation({1: estimate(0.18, 0.01)}, NOON), damage=kept)
    document = OBSERVATION.dump(made)
    assert len(json.dumps(document["damage"])) < 1024
    again = OBSERVATION.load(json.loads(json.dumps(document)))
    assert again.damage is not None
    assert weld_sums(again.damage) == weld_sums(kept)


def test_sums_are_the_same_in_any_order_and_add_points_apart(records: list[Observation]) -> None:
    """Bit for bit; and the sum of a side is that of each point over the records that name it."""
    one, _ = advance_all(TwinState("model"), records)
    other, _ = advance_all(TwinState("model"), [*records[::-1], records[3]])
    assert other.state_hash == one.state_hash
    total = one.totals["all"]
    for side, sums in total.welds.items():
        own = [(r.damage.points[list(r.damage.sides).index(side)]) for r in records if side in r.damage.sides]
        assert_allclose(sums.points, np.sum([damage_of(p) for p in own], axis=0), atol=0.5 * len(own))
        assert sums.n == len(own)
    assert total.sensed.n == 12 and total.sensed.seconds == 7200


def test_a_day_taken_out_leaves_what_the_others_say(records: list[Observation]) -> None:
    whole, _ = advance_all(TwinState("model"), records)
    date = "2025-03-02"
    fewer, _ = advance_all(TwinState("model"), [r for r in records if f"{r.start_utc:%Y-%m-%d}" != date])
    assert whole.without_day(date).state_hash == fewer.state_hash
    replayed = whole.with_day(date, whole.days[date])
    assert replayed.totals == whole.totals


def test_states_with_damage_are_read_again(records: list[Observation]) -> None:
    state, _ = advance_all(TwinState("model"), records)
    assert STATE.load(json.loads(json.dumps(STATE.dump(state)))).state_hash == state.state_hash


def test_records_without_damage_tell_no_time() -> None:
    state, _ = advance_all(TwinState("model"), [observation({1: estimate(0.18, 0.01)}, NOON)])
    assert state.totals["all"].sensed == (0, 0, 0)


@pytest.fixture(scope="module")
def stress_model() -> StressModel:
    structure = read_structure("jacket15")
    assembly = assemble(structure, gravity=True)
    heavier = Tolerance("mass", "all of the mass", 0.02, "-", "", "")
    return StressModel(
        LifeSettings(), assembly, RestingLoads.of(assemble(structure)), Rayleigh.minimum(0.005, 0.3),
        numbered_modes(assembly, 12), (Direction(heavier, 0.02 * assembly.mass),),
    )  # fmt: skip


def test_a_structure_at_rest_bears_weight_buoyancy_and_thrust() -> None:
    """Water displaced by sealed tubes, from the drawing; the thrust where the wind blows to."""
    dry = assemble(read_structure("jacket15"))
    structure, rigid = dry.structure, rigid_body_motion(dry)
    water = WaterConfig(72.0, Coefficients(), Water(), True, None)
    steel, wet = RestingLoads.of(dry), RestingLoads.of(dry, water)
    displaced = 0.0
    for member in structure.members:
        a, b = (np.array(structure.nodes[node]) for node in (member.start, member.end))
        low, high = np.sort([a[2], b[2]]) - structure.sea_level_z_m
        share = float(np.clip(-low / max(high - low, 1e-9), 0.0, 1.0)) if high > 0.0 else 1.0
        d = member.section_start.outer_diameter_m
        displaced += 0.25 * np.pi * d**2 * share * float(np.linalg.norm(b - a)) * float(low < 0.0)
    # pieces of 4 m end at the sea level within their own length
    lift = float((wet.on_dofs - steel.on_dofs) @ rigid[:, 2])
    assert lift == pytest.approx(1025.0 * 9.80665 * displaced, rel=2e-3)
    unknown = RestingLoads.of(dry, replace(water, adds_mass=False))
    assert_allclose(unknown.on_dofs, steel.on_dofs)
    weather = Weather(working=True, heading_rad=2.0, rotor=RotorAtTop(np.zeros((6, 6)), 0.0, thrust_n=1e6))
    push = (wet.under(weather, dry).on_dofs - wet.on_dofs) @ rigid[:, :2]
    assert_allclose(push, 1e6 * np.array([np.cos(2.0), np.sin(2.0)]), rtol=1e-9)
    assert_allclose(wet.under(replace(weather, working=False), dry).on_dofs, wet.on_dofs)


def test_a_records_frequencies_tell_the_feet(stress_model: StressModel) -> None:
    """From feet six times too stiff; the interval holds both truths, and mass goes unexplained."""
    true = np.log([1.5e9, 4.0e9])
    modes = undamped_modes(stress_model.system(np.append(true, 0.0)), 5)
    seen = {m + 1: estimate(float(f), 0.01, 1e-3) for m, f in enumerate(modes.frequency_hz)}
    found = likely_structures(stress_model, seen, 1e10)
    std = np.sqrt(np.diag(found.covariance))
    assert (np.abs(found.mean[:2] - true) < 2.0 * std[:2]).all()
    assert std[1] < 0.5 and abs(found.mean[2]) < 1.0


def test_shapes_of_the_first_pair_tell_feet_from_mass(stress_model: StressModel) -> None:
    """Mixed as a record sees a pair; 1 mm/m of noise. A sensor turned round tells nothing."""
    at, true = observation_matrix(stress_model.assembly, TOWER), np.append(np.log([1.5e9, 1.5e9]), 1.0)
    modes = undamped_modes(stress_model.system(true), 2)
    shapes = at @ modes.shapes @ np.array([[0.8, 0.6], [-0.6, 0.8]])
    shapes += 1e-3 * np.abs(shapes).max() * np.random.default_rng(1).standard_normal(shapes.shape)
    found = {}
    for name, turned in (("without", None), ("shapes", 1.0), ("turned round", -1.0)):
        seen = {
            i + 1: replace(
                estimate(float(f), 0.01, 1e-3),
                mode_shape=np.append(shapes[:-1, i], (turned or 1.0) * shapes[-1, i]).astype(complex),
            )
            for i, f in enumerate(modes.frequency_hz)
        }
        found[name] = likely_structures(stress_model, seen, 6e8, sensors=at if turned else None)
        if name == "shapes":
            # refinement takes what waves move beside the mode for its own; the subspace's shape has it lag
            refined = {
                i: replace(
                    one, mode_shape=one.mode_shape * np.linspace(1.0, 1.1, len(one.mode_shape)), unrefined=one
                )
                for i, one in seen.items()
            }
            same = likely_structures(stress_model, refined, 6e8, sensors=at)
            assert_allclose(same.mean, found[name].mean)
    std = {name: np.sqrt(one.covariance[:2, :2].sum()) for name, one in found.items()}
    off = {name: abs((one.mean - true)[:2].sum()) for name, one in found.items()}
    assert off["shapes"] < 2.0 * std["shapes"] and std["shapes"] < 0.7 * std["without"]
    assert_allclose(found["turned round"].mean, found["without"].mean)


def test_slopes_of_shapes_are_differences(stress_model: StressModel) -> None:
    """Of what lies out of the pair's plane, to a tenth: the modes that are summed are not all."""
    at, theta, h = observation_matrix(stress_model.assembly, TOWER), np.array([21.1, 22.1, 0.3]), 1e-3
    system = stress_model.system(theta)
    modes, pair = undamped_modes(system, 18), np.arange(2)
    seen = np.asarray(at @ modes.shapes)
    slopes = stress_model.shape_slopes(system, modes, pair, seen)
    out = np.eye(len(seen)) - seen[:, :2] @ np.linalg.pinv(seen[:, :2])
    for j in range(3):
        step = h * np.eye(3)[j]
        near = (at @ undamped_modes(stress_model.system(theta + s), 2).shapes for s in (step, -step))
        ahead, behind = (x * np.sign((x * seen[:, :2]).sum(axis=0)) for x in near)
        expected = out @ (ahead - behind) / (2.0 * h)
        assert_allclose(
            out @ slopes[j], expected, atol=0.1 * np.abs(expected).max() + 1e-9 * np.abs(seen).max()
        )


def test_a_rotor_at_work_stiffens_no_feet(stress_model: StressModel) -> None:
    """Fore-aft 8 % up, as the rotor's stiffness makes it: told as the rotor's, within its tolerance."""
    assembly = stress_model.assembly
    top = assembly.dofs(assembly.structure.top_node)[0]
    K = sp.csc_array(([1.5e5], ([top], [top])), shape=assembly.stiffness.shape)
    third = Direction(Tolerance("rotor_at_work", "", 0.3, "-", "", ""), stiffness=0.3 * K)
    parked = replace(stress_model, at_work=third)
    working = parked.working()
    assert parked.working().at_work is None and stress_model.working() is stress_model
    true = np.log([1.5e9, 4.0e9])
    modes = undamped_modes(working.system(np.append(true, [0.0, 0.0])), 5)
    seen = {m + 1: estimate(float(f), 0.01, 1e-3) for m, f in enumerate(modes.frequency_hz)}
    off = {}
    for name, one in (("at work", working), ("parked", parked)):
        found = likely_structures(one, seen, 1e9)
        std = np.sqrt(np.diag(found.covariance))[:2]
        off[name] = np.abs(found.mean[:2] - true)
    assert (off["at work"] < std).all()
    assert off["parked"].max() > 3.0 * off["at work"].max()


def test_slopes_are_differences_of_frequencies(stress_model: StressModel) -> None:
    """Every unknown by a small step; a turned sign or a lost half would show."""
    at, h = np.array([*np.log([1.5e9, 4.0e9]), 0.3]), 1e-4
    modes = undamped_modes(stress_model.system(at), 2)
    slopes = stress_model.slopes(stress_model.system(at), modes.shapes, modes.omega)
    for j in range(3):
        step = h * np.eye(3)[j]
        ahead, behind = (undamped_modes(stress_model.system(at + s), 2).omega for s in (step, -step))
        assert_allclose(slopes[:, j], np.log(ahead / behind) / (2.0 * h), rtol=1e-4, atol=1e-9)


def test_likely_structures_come_in_pairs_about_the_likeliest(stress_model: StressModel) -> None:
    seen = {1: estimate(0.17, 0.01), 2: estimate(0.175, 0.012)}
    found = likely_structures(stress_model, seen, 1e9)
    first, one, other = (undamped_modes(s, 1).frequency_hz[0] for s in found.systems(3, seed=1))
    assert (one - first) * (other - first) < 0.0


@pytest.fixture(scope="module")
def sensed(stress_model: StressModel) -> tuple[SensedDamage, dict[int, np.ndarray]]:
    """Return what is told of a motion that the model made itself, and its true damage by side."""
    seen = {1: estimate(0.17, 0.01), 2: estimate(0.175, 0.012)}
    likely = likely_structures(stress_model, seen, 1e9)
    weather = Weather(12.0, 2.5, 8.0, 0.3, 72.0)
    system = likely.systems(1)[0]
    model = likely.damped(sensed_model(system, weather))
    known = model.with_forces(tuple(f.with_level(2e4 if f.kind == "disc" else f.level) for f in model.forces))
    blank = Record(np.ones((6, 8)), 10.0, tuple(Channel(s.channel) for s in TOWER))
    empty = readings_of(blank, TOWER, system.assembly)
    C = known.motion_rows(empty.rows, empty.tilt, empty.derivative)
    smoother = steady_smoother(*discrete(*known.dynamics(), 0.1), C, np.full(6, 5e-8))
    states, y = smoother.draw(6000, np.random.default_rng(5))
    to = np.vstack([np.eye(known.n_modes, states.shape[1]), known.force_rows()])
    rng = np.random.default_rng(6)
    motion = np.column_stack([states @ to.T, *(f.drawn(6000, 0.1, rng) for f in known.local_forces())])
    readings = readings_of(Record(y.T, 10.0, blank.channels), TOWER, system.assembly)
    damage = sensed_damage(likely, readings, weather)
    assert damage is not None
    chart = weld_map(system, known, stress_model.rest)
    lives, true = stress_model.settings.models, {}
    welds = [w for joint in chart.joints for w in joint.welds]
    cycles = chart.cycles(motion)
    sea, rows = system.assembly.structure.sea_level_z_m, section_rows(known)
    for side in damage.sides:
        if side >= 2 * len(welds):
            tube = stress_model.tubes[side - 2 * len(welds)]
            points = [count(series) for series in tube.stress(rows) @ motion.T]
            curve, t = tube.models(tube.z_m - sea)[1].curve, tube.section.thickness_m
        else:
            weld, points = welds[side // 2], cycles[side // 2][side % 2]
            z = system.assembly.structure.nodes[weld.node][2] - sea
            curve, t = lives(z)[1].curve, weld.thickness_m[side % 2]
        true[int(side)] = np.array([curve.damage(c.ranges, c.numbers, thickness_m=t) for c in points])
    return damage, true


def test_sensed_damage_is_that_of_the_motion(
    sensed: tuple[SensedDamage, dict[int, np.ndarray]],
) -> None:
    """At points that matter; what is left uncounted is small at every side."""
    damage, true = sensed
    found = DAMAGE_UNIT * damage_of(damage.points)
    for own, side in zip(found, damage.sides, strict=True):
        exact = true[int(side)]
        assert 0.4 < own.max() / exact.max() < 2.5
        assert own[exact < 0.02 * exact.max()].max(initial=0.0) < 0.2 * own.max()


def test_what_a_record_leaves_open_of_damage_has_at_least_its_remainder(
    sensed: tuple[SensedDamage, dict[int, np.ndarray]], stress_model: StressModel
) -> None:
    """The mean slope times the remainder of stress, and no more than a factor of ten."""
    damage, _ = sensed
    structure = stress_model.assembly.structure
    welds = [w for joint in planned_joints(stress_model.assembly) for w in joint.welds]
    of_joints = damage.sides < 2 * len(welds)
    for side, steps in zip(damage.sides[of_joints], damage.model[of_joints], strict=True):
        z = structure.nodes[welds[side // 2].node][2] - structure.sea_level_z_m
        curve = stress_model.settings.models(z)[1].curve
        assert STEP * steps > np.mean(curve.m) * stress_remainder(z, working=False) - STEP
        assert STEP * steps < np.log(10.0)


def test_welds_around_tubes_are_told_beside_those_of_joints(
    sensed: tuple[SensedDamage, dict[int, np.ndarray]], stress_model: StressModel
) -> None:
    """The tower's butt welds: numbered behind the sides of joints, their damage that of the motion."""
    damage, true = sensed
    n = 2 * sum(len(joint.welds) for joint in stress_model.joints)
    tubes = [int(side) for side in damage.sides if side >= n]
    assert len(tubes) == KEPT_TUBES < len(stress_model.tubes)
    ratio = [
        DAMAGE_UNIT * damage_of(own).max() / true[int(side)].max()
        for own, side in zip(damage.points, damage.sides, strict=True)
        if side >= n
    ]
    assert 0.5 < min(ratio) <= max(ratio) < 2.0
