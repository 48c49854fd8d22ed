"""Whole simulations: energy, statistics, convergence, sensors, records."""

from dataclasses import replace

import numpy as np
import pytest
from tests.support.energy import energy

from jackettwin.errors import InputError
from jackettwin.records import read_record, write_record
from jackettwin.response.motion.time import Hold, first_order_hold, march_with_feedback, state_space
from jackettwin.simulate import loads_document, read_scenario, simulate
from jackettwin.simulate.motion.loads import loads_on
from jackettwin.simulate.motion.model import aerodynamics
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.motion.rotor_feedback import march_with_rotor
from jackettwin.simulate.motion.wind import rotor_loads_in, wind_field
from jackettwin.simulate.record import conditions
from jackettwin.simulate.resultant import resultants
from jackettwin.simulate.sensing import flawed, readings

WIND = {"speed_m_s": 14.0, "seed": 1}
SEA = {"type": "jonswap", "hs_m": 3.0, "tp_s": 9.0, "seed": 2}
PILES = {"foundation": "jacket15_records", "damping": {"coupled": 0.01}}


@pytest.mark.parametrize(("keys", "duration"), [({"waves": SEA}, 600.0), ({"wind": WIND}, 40.0)])
def test_the_books_close(scenario_file, keys, duration) -> None:
    """Work = stored + dissipated within 1e-3: ten minutes of waves; wind with the rotor's mean as work."""
    clock = {"duration_s": duration, "step_s": 0.01, "load_step_s": 0.01}
    motion = simulate_motion(read_scenario(scenario_file(**PILES, **keys, time=clock)))
    pencil, n = motion.model.reduced.pencil, motion.space.n
    q, v = motion.states[:, :n], motion.states[:, n : 2 * n]
    symmetric, force = [], motion.force
    for group in pencil.groups:
        if np.abs(group.S - group.S.T).max() <= 1e-9 * np.abs(group.S).max(initial=1e-300):
            symmetric.append(group)
        else:
            force = force - (group.law.c * v + group.law.k0 * q) @ group.S.T
    books = energy(replace(pencil, groups=tuple(symmetric)), motion.states, force, step_s=motion.step_s)
    left = books.work - (books.stored - books.stored[0]) - books.dissipated
    assert np.abs(left).max() < 1e-3 * books.dissipated.max()


def test_a_record_has_no_beginning(scenario_file) -> None:
    """Without a rotor's feedback the motion is periodic: the state at the end is that of the start."""
    motion = simulate_motion(read_scenario(scenario_file(**PILES, waves=SEA)))
    np.testing.assert_allclose(motion.states[-1], motion.states[0], atol=1e-8 * np.abs(motion.states).max())


def test_velocity_is_the_rate_of_displacement_and_acceleration_that_of_velocity(scenario_file) -> None:
    """Central differences of a sea's motion at 100 Hz: their error is (ω Δt)²/6, 1e-3 at 1.2 Hz."""
    kinds = ("displacement", "velocity", "acceleration")
    sensors = [{"channel": q, "node": "tower_top", "direction": [1, 0, 0], "quantity": q} for q in kinds]
    clock = {"duration_s": 60.0, "step_s": 0.01, "load_step_s": 0.05}
    s = read_scenario(scenario_file(**PILES, waves=SEA, time=clock, sensors=sensors))
    x, v, a = readings(simulate_motion(s), s)
    for whole, rate in ((x, v), (v, a)):
        differences = (whole[2:] - whole[:-2]) / (2.0 * s.clock.step_s)
        assert np.abs(differences - rate[1:-1]).max() < 5e-3 * np.abs(rate).max()


def test_the_load_step_converges(scenario_file) -> None:
    """Halving the load step changes readings by less than 1 % of their spread; the linear part is exact."""
    seen = []
    for step in (0.05, 0.025):
        clock = {"duration_s": 120.0, "step_s": 0.025, "load_step_s": step}
        s = read_scenario(scenario_file(**PILES, waves=SEA, time=clock))
        seen.append(readings(simulate_motion(s), s))
    assert np.abs(seen[1] - seen[0]).max() < 0.01 * seen[1].std()


def test_a_steady_wave_gives_the_frequency_response(scenario_file) -> None:
    """Airy wave without drag: one harmonic, amplitude |H(iω)| f."""
    waves = {"type": "airy", "height_m": 2.0, "period_s": 8.0, "relative_velocity": "none"}
    s = read_scenario(
        scenario_file(**PILES, waves=waves, water={"drag": 0.0}, time={"duration_s": 40.0, "step_s": 0.05})
    )
    motion = simulate_motion(s)
    omega, n = 2.0 * np.pi / 8.0, motion.space.n
    t = np.arange(motion.states.shape[0] - 1) * motion.step_s
    kernel = 2.0 * np.exp(-1j * omega * t) / t.size
    force = kernel @ motion.force[:-1]
    exact = np.linalg.solve(motion.model.reduced.pencil.F(1j * omega), force)
    found = kernel @ motion.states[:-1, :n]
    np.testing.assert_allclose(found, exact, atol=3e-4 * np.abs(exact).max())
    x = motion.model.top[0] @ motion.states[:-1, :n].T
    assert x.std() == pytest.approx(abs(motion.model.top[0] @ exact) / np.sqrt(2.0), rel=1e-3)


def test_relative_velocity_damps(scenario_file) -> None:
    """Drag on the structure's own motion adds damping to every first mode."""
    found = []
    for how in ("none", "linearised"):
        s = read_scenario(scenario_file(**PILES, waves={**SEA, "relative_velocity": how}))
        found.append({m.label: m.damping_ratio for m in simulate_motion(s).modes})
    for label in ("fore_aft_1", "side_side_1", "fore_aft_2"):
        assert found[0][label] < found[1][label] < found[0][label] + 0.01


@pytest.mark.parametrize("state", ["parked", "idling", "operating"])
def test_turbines_stay_bounded_and_lean_downwind(scenario_file, state: str) -> None:
    """Mean displacement: mean force over static stiffness."""
    s = read_scenario(
        scenario_file(
            **PILES,
            wind={"speed_m_s": 11.0, "turbulence": "C", "seed": 4},
            rotor={"state": state},
            sensors=[
                {"channel": "x", "node": "tower_top", "direction": [1, 0, 0], "quantity": "displacement"}
            ],
            time={"duration_s": 120.0, "step_s": 0.05},
        )
    )
    motion = simulate_motion(s)
    x = readings(motion, s)[0]
    K = motion.model.reduced.pencil.static_stiffness()
    lean = float(motion.model.top[0] @ np.linalg.solve(K, motion.force[:-1].mean(axis=0)))
    assert x.mean() == pytest.approx(lean, rel=0.02)
    assert lean > (0.2 if state == "operating" else 0.0)
    assert np.abs(x).max() < 5.0
    # IEA 15 MW turns 5.0 to 7.56 times a minute and reaches the latter at 10.6 m/s
    turns = conditions(s, motion.rotor_speed_rad_s)["rotor_speed_rpm"]
    assert turns == pytest.approx(7.56 if state == "operating" else 0.0, abs=0.01)


def test_a_swap_of_seeds_changes_the_record_and_nothing_else(scenario_file) -> None:
    one = simulate(read_scenario(scenario_file(**PILES, wind=WIND))).record
    same = simulate(read_scenario(scenario_file(**PILES, wind=WIND))).record
    other = simulate(read_scenario(scenario_file(**PILES, wind={**WIND, "seed": 2}))).record
    np.testing.assert_array_equal(one.data, same.data)
    assert np.abs(one.data - other.data).max() > 0.0
    # above the first pair, modes lie so close that their order is the wind's
    for mode, another in zip(one.metadata["true_modes"][:2], other.metadata["true_modes"][:2], strict=True):
        assert mode["label"] == another["label"]
        assert mode["frequency_hz"] == pytest.approx(another["frequency_hz"], rel=1e-3)
        # the rotor's damping is that of the record's own wind, whose mean over a minute scatters
        assert mode["damping_ratio"] == pytest.approx(another["damping_ratio"], rel=0.1)


def test_readings_between_load_steps_are_on_the_same_motion(scenario_file) -> None:
    clock = {"duration_s": 60.0, "step_s": 0.01}
    s = read_scenario(scenario_file(**PILES, waves=SEA, time=clock))
    motion = simulate_motion(s)
    fine = readings(motion, s)
    coarse = readings(motion, replace(s, clock=replace(s.clock, step_s=0.05)))
    np.testing.assert_allclose(fine[:, ::5], coarse, rtol=1e-9, atol=1e-12)


def test_flaws_are_what_they_say(scenario_file, rng) -> None:
    sensor = {"channel": "a", "node": "tower_top", "direction": [1, 0, 0]}
    s = read_scenario(
        scenario_file(
            sensors=[
                {**sensor, "noise": 0.5, "bias": 2.0},
                {**sensor, "channel": "b", "limit": 1.0},
                {**sensor, "channel": "c", "dropouts_per_hour": 60.0, "dropout_s": 0.5},
            ]
        )
    )
    clean = np.tile(2.0 * np.sin(np.arange(360_000) * 0.01), (3, 1))
    read = flawed(clean, s.instruments, step_s=0.01, seed=1)
    error = read[0] - clean[0]
    # 360 000 samples: 0.1 % of σ in mean and spread
    assert error.mean() == pytest.approx(2.0, abs=0.005)
    assert error.std() == pytest.approx(0.5, rel=0.01)
    np.testing.assert_array_equal(read[1], np.clip(clean[1], -1.0, 1.0))
    gone = np.isnan(read[2])
    # 60 gaps of half a second in an hour: 0.83 %; both numbers are random
    assert 0.003 < gone.mean() < 0.02
    np.testing.assert_array_equal(read[2][~gone], clean[2][~gone])


def test_nacelle_sensors_turn_with_it(scenario_file) -> None:
    """At 90° the nacelle's x is global y."""
    sensors = [
        {"channel": "ahead", "node": "tower_top", "direction": [1, 0, 0], "frame": "nacelle"},
        {"channel": "y", "node": "tower_top", "direction": [0, 1, 0]},
    ]
    s = read_scenario(scenario_file(**PILES, wind={**WIND, "yaw_deg": 90.0}, sensors=sensors))
    seen = readings(simulate_motion(s), s)
    np.testing.assert_allclose(seen[0], seen[1], atol=1e-12)


def test_records_survive_their_files(scenario_file, tmp_path) -> None:
    done = simulate(read_scenario(scenario_file(**PILES, wind=WIND, waves=SEA)))
    path = tmp_path / "r.parquet"
    write_record(done.record, path)
    again = read_record(path)
    np.testing.assert_array_equal(again.data, done.record.data)
    assert again.channel_names == ("acc_top_x", "acc_top_y", "wave_elevation", "wind_hub_x")
    assert again.sample_rate_hz == pytest.approx(20.0)
    assert again.conditions["mean_wind_speed_m_s"] == 14.0
    assert again.metadata["true_modes"][0]["label"] == "side_side_1"
    assert again.data.shape[1] == 1200


def test_discarded_time_is_not_recorded(scenario_file) -> None:
    s = read_scenario(
        scenario_file(**PILES, waves=SEA, time={"duration_s": 30.0, "step_s": 0.05, "discard_s": 30.0})
    )
    whole = replace(s, clock=replace(s.clock, duration_s=60.0, discard_s=0.0))
    a, b = simulate(s).record.data, simulate(whole).record.data
    np.testing.assert_allclose(a, b[:, 600:], atol=1e-9 * np.abs(b).max())


def test_loads_of_an_airy_wave_on_the_jacket(scenario_file) -> None:
    """Signs: a wave towards +x pushes towards +x and, below still water, turns about −y."""
    s = read_scenario(
        scenario_file(waves={"type": "airy", "height_m": 8.0, "period_s": 11.0}, water={"drag": 1.0})
    )
    loads = resultants(s)["water"]
    crest = int(np.argmax(loads[:, 0]))
    assert loads[crest, 4] < 0.0
    document = loads_document(s)
    assert document["force_n"]["x"]["max"] == pytest.approx(loads[crest, 0])
    assert document["force_n"]["x"]["max"] == pytest.approx(-document["force_n"]["x"]["min"], rel=1e-3)
    assert set(document["moment_msl_n_m"]["y"]) == {"max", "min", "std", "mean"}
    # symmetric about the wave's plane
    assert document["force_n"]["y"]["max"] < 1e-6 * document["force_n"]["x"]["max"]
    along = replace(s, sea=replace(s.sea, direction=0.5 * np.pi))
    assert np.abs(resultants(along)["water"][:, 1]).max() == pytest.approx(loads[crest, 0], rel=1e-6)


def test_loads_of_both_add(scenario_file) -> None:
    s = read_scenario(scenario_file(waves=SEA, wind={**WIND, "turbulence": "none"}))
    document = loads_document(s)
    parts = document["parts"]
    mean = document["force_n"]["x"]["mean"]
    both = parts["wind"]["force_n"]["x"]["mean"] + parts["water"]["force_n"]["x"]["mean"]
    assert mean == pytest.approx(both, rel=1e-3)
    # wind on the hub 150 m up overturns about +y
    arm = parts["wind"]["moment_msl_n_m"]["y"]["mean"] / parts["wind"]["force_n"]["x"]["mean"]
    assert 60.0 < arm < 160.0


def test_calm_loads_nothing(scenario_file) -> None:
    with pytest.raises(InputError, match="nothing loads"):
        resultants(read_scenario(scenario_file()))


def test_a_yawing_nacelle_turns_its_sensors(scenario_file) -> None:
    """Fore-aft on the nacelle is x cos ψ + y sin ψ of the tower top at each instant; the yaw is recorded."""
    place = {"node": "tower_top", "quantity": "displacement"}
    s = read_scenario(
        scenario_file(
            **PILES,
            wind={**WIND, "yaw_path": [[0.0, -20.0], [30.0, 40.0]]},
            sensors=[
                {"channel": "x", "direction": [1, 0, 0], **place},
                {"channel": "y", "direction": [0, 1, 0], **place},
                {"channel": "fore_aft", "direction": [2, 0, 0], "frame": "nacelle", **place},
                {"channel": "side", "direction": [0, 1, 0], "frame": "nacelle", **place},
            ],
        )
    )
    record = simulate(s).record
    x, y, fore_aft, side = record.data[:4]
    psi = record.data[record.channel_names.index("nacelle_yaw")]
    # 0 to 30 s from −20° to 40°, then it stays
    np.testing.assert_allclose(psi[[0, 300, 600, -1]], np.radians([-20.0, 10.0, 40.0, 40.0]), atol=1e-9)
    np.testing.assert_allclose(fore_aft, x * np.cos(psi) + y * np.sin(psi), atol=1e-12)
    np.testing.assert_allclose(side, y * np.cos(psi) - x * np.sin(psi), atol=1e-12)
    assert "axes" not in record.metadata


def test_a_path_that_stays_is_a_yaw(scenario_file) -> None:
    """Loads, mass, truth and start: 20° as a path of one heading is 20°."""
    place = [{"channel": "x", "direction": [1, 0, 0], "node": "tower_top"}]
    first, second = (
        simulate(read_scenario(scenario_file(**PILES, wind={**WIND, **yaw}, sensors=place))).record
        for yaw in ({"yaw_deg": 20.0}, {"yaw_path": [[0.0, 20.0], [30.0, 20.0]]})
    )
    np.testing.assert_allclose(second.data[0], first.data[0], rtol=1e-9, atol=1e-12)
    for one, other in zip(first.metadata["true_modes"], second.metadata["true_modes"], strict=True):
        assert other["damping_ratio"] == pytest.approx(one["damping_ratio"], rel=1e-9)
    assert second.conditions["yaw_deg"] == pytest.approx(20.0)


def test_the_compiled_march_is_the_general_one_with_the_rotor_as_its_feedback(scenario_file) -> None:
    """One scheme, written twice: to rounding, along a path of headings."""
    wind = {**WIND, "yaw_path": [[0.0, -20.0], [30.0, 40.0]]}
    scenario = read_scenario(scenario_file(**PILES, wind=wind))
    loads = loads_on(scenario, round(scenario.clock.total_s / scenario.clock.load_step_s))
    assert loads.rotor is not None
    space, top, n = state_space(loads.model.reduced.pencil), loads.model.top, loads.model.reduced.n
    hold = first_order_hold(space.A, space.B, 0.1)
    # the rotor's mean damping is known to neither: twice the feedback
    change, start = loads.rotor.change(np.zeros((6, 6))), np.zeros(space.A.shape[0])
    times = loads.rotor.still.shape[0]
    expected, force = march_with_feedback(
        hold,
        Hold(hold.E, hold.P0 @ top.T, hold.P1 @ top.T),
        start,
        loads.repeating[:241],
        lambda k, x: change(k % times, top @ x[n : 2 * n]),
    )
    states, extra = march_with_rotor(hold, start, loads.repeating[:241], loads.rotor, np.zeros((6, 6)), top)
    assert np.abs(force).max() > 1e3
    np.testing.assert_allclose(extra, force, atol=1e-9 * np.abs(force).max())
    np.testing.assert_allclose(states, expected, atol=1e-9 * np.abs(expected).max())


def test_rotor_loads_follow_a_yaw_path(scenario_file) -> None:
    """At every step the loads are those of a rotor that always stood at that heading."""
    wind = {**WIND, "yaw_path": [[0.0, -20.0], [30.0, 40.0]]}
    s = read_scenario(scenario_file(**PILES, wind=wind))
    air, step = s.air, s.clock.load_step_s
    aero = aerodynamics(air, s.turbine)
    field = wind_field(air, aero, duration=s.clock.total_s, step=step)
    heading = air.heading(np.arange(field.n_times) * step)
    turning = rotor_loads_in(field, air, aero, heading=heading)
    for k in (0, field.n_times // 3, field.n_times - 1):
        fixed = rotor_loads_in(field, air, aero, heading=float(heading[k]))
        np.testing.assert_allclose(turning.still[k], fixed.still[k], rtol=1e-12)
        push = np.array([0.3, -0.2, 0.1, 0.0, 0.01, 0.0])
        change = [loads.change(np.zeros((6, 6)))(k, push) for loads in (turning, fixed)]
        np.testing.assert_allclose(change[0], change[1], rtol=1e-9, atol=1e-6)
    ends = [rotor_loads_in(field, air, aero, heading=np.radians(d)).mean_damping() for d in (-20.0, 40.0)]
    between = turning.mean_damping()
    assert min(e[1, 1] for e in ends) < between[1, 1] < max(e[1, 1] for e in ends)


def test_a_heading_is_given_once(scenario_file) -> None:
    with pytest.raises(InputError, match="given twice.*keep yaw_path"):
        read_scenario(
            scenario_file(**PILES, wind={**WIND, "yaw_deg": 5.0, "yaw_path": [[0.0, 0.0], [5.0, 1.0]]})
        )


def test_times_of_a_yaw_path_grow(scenario_file) -> None:
    with pytest.raises(InputError, match="times must grow"):
        read_scenario(scenario_file(**PILES, wind={**WIND, "yaw_path": [[5.0, 0.0], [5.0, 1.0]]}))
