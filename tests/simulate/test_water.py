"""Drag on relative velocity in time: against Morison's equation at an instant, and the motion it drives."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads.members.morison import point_forces
from jackettwin.loads.members.water_files import WaterSchema, depth_of
from jackettwin.loads.sea.given_kinematics import PRESSURE, REQUIRED
from jackettwin.loads.sea.waves import airy_wave
from jackettwin.simulate import read_scenario
from jackettwin.simulate.motion.model import build_model
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.motion.water import (
    relative_drag,
    relative_drag_beyond,
    water_loads,
    water_points,
    wave_field,
)
from jackettwin.simulate.resultant import resultants
from jackettwin.structure import assemble

FEET = {"support": "pinned", "damping": {"rayleigh": {"ratio": 0.001, "frequency_hz": 0.2}}}


def sea(scenario_file, how: str):
    return read_scenario(
        scenario_file(
            **FEET,
            water={"depth_m": 72.0},
            waves={"type": "airy", "height_m": 8.0, "period_s": 5.5, "relative_velocity": how},
            time={"duration_s": 30.0, "step_s": 0.05},
        )
    )


def beyond(scenario, model):
    grid = water_points(model.assembly, scenario.sea)
    columns = np.asarray(grid.N.T @ model.reduced.basis)
    loads = water_loads(scenario.sea, grid, columns, duration=30.0, keep_motion=True)
    assert loads is not None
    C = relative_drag(grid, loads, model.reduced.basis)
    return grid, columns, loads, C, relative_drag_beyond(grid, loads, model.reduced.basis, C)


def test_the_change_is_morisons_equation_with_and_without_motion(scenario_file) -> None:
    """F(u − ẋ) − F(u) at a sample of the series, on the coordinates; C ẋ is added back."""
    scenario = sea(scenario_file, "full")
    model = build_model(scenario)
    grid, columns, loads, C, found = beyond(scenario, model)
    q = 0.02 * np.random.default_rng(1).standard_normal(model.reduced.n)
    t = 37 * loads.series.step_s
    waves = wave_field(scenario.sea, duration=30.0)
    u, du = waves.motion(grid.points, np.array([t]))
    wet = loads.series.wet[37][None]
    moving, still = (
        point_forces(grid, u, du, velocity=v, wet=wet).ravel() @ columns
        for v in ((columns @ q).reshape(1, -1, 3), None)
    )
    np.testing.assert_allclose(
        found.change(t, q), moving - still + C @ q, rtol=1e-6, atol=1e-9 * np.abs(C @ q).max()
    )


def test_the_motion_is_stepped_under_it(scenario_file) -> None:
    """Forces beyond the linearised run's are the change at the motion's own velocity, settled to 1 %."""
    linear, full = (simulate_motion(sea(scenario_file, how)) for how in ("linearised", "full"))
    *_, found = beyond(sea(scenario_file, "full"), full.model)
    n = full.space.n
    added = full.force - linear.force
    wanted = np.array([found.change(k * full.step_s, x[n : 2 * n]) for k, x in enumerate(full.states[:200])])
    assert np.abs(wanted).max() > 0.0
    np.testing.assert_allclose(added[:200], wanted, atol=0.01 * np.abs(wanted).max())
    # the legs of a jacket move little in the water: no more than 1 % of the motion hangs on this
    a, b = (m.states[:, :n] @ m.model.top[0] for m in (linear, full))
    np.testing.assert_allclose(b, a, atol=0.01 * np.abs(a).max())


def test_a_given_elevation_drives_the_asset(tmp_path: Path, scenario_file) -> None:
    """What a record says of its own waves, given back: the same elevation, Hs and T from the file."""
    t = np.arange(0.0, 61.0, 0.1)
    eta = 1.5 * np.cos(2.0 * np.pi * t / 10.0)
    rows = "\n".join(f"{a:.3f},{b:.6f}" for a, b in zip(t, eta, strict=True))
    (tmp_path / "eta.csv").write_text("time_s,elevation_m\n" + rows)
    waves = {"type": "elevation", "file": str(tmp_path / "eta.csv"), "direction_deg": 30.0}
    time = {"duration_s": 60.0, "step_s": 0.05}
    scenario = read_scenario(scenario_file(waves=waves, water={}, time=time))
    assert scenario.sea is not None
    assert scenario.sea.height_m == pytest.approx(4.0 * 1.5 / np.sqrt(2.0), rel=0.01)
    assert scenario.sea.period_s == pytest.approx(10.0, rel=0.05)
    field = wave_field(scenario.sea, duration=60.0)
    found = field.elevation(np.zeros((1, 3)), t[:-11])[:, 0]
    np.testing.assert_allclose(found, eta[:-11], atol=0.02)
    with pytest.raises(InputError, match="hs_m: does not belong"):
        read_scenario(scenario_file(waves={**waves, "hs_m": 2.0}, water={}, time=time))
    with pytest.raises(InputError, match="file belongs to waves of type elevation or kinematics"):
        read_scenario(scenario_file(waves={"type": "elevation"}, water={}, time=time))


def test_a_lone_crest_loads_all_that_it_wets(tmp_path: Path, scenario_file) -> None:
    """10 m in ten calm minutes, 4σ being 3 m: members up to the crest have points, however short they are."""
    t = np.arange(0.0, 601.0, 0.5)
    eta = 10.0 * np.exp(-(((t - 300.0) / 8.0) ** 2)) * np.cos(2.0 * np.pi * (t - 300.0) / 10.0)
    np.savetxt(tmp_path / "eta.csv", np.column_stack([t, eta]), delimiter=",")
    waves = {"type": "elevation", "file": str(tmp_path / "eta.csv")}
    scenario = read_scenario(scenario_file(waves=waves, water={}, time={"duration_s": 600.0, "step_s": 0.05}))
    assert scenario.sea is not None and scenario.sea.height_m < 4.0
    assembly = assemble(scenario.asset.structure, subdivide=20)
    assert water_points(assembly, scenario.sea).points[:, 2].max() > 10.0


def test_given_kinematics_load_as_the_wave_they_were_taken_from(tmp_path: Path, scenario_file) -> None:
    """An Airy wave's own motion over the water column, from a file: the same loads, within the grid's 1 %."""
    H, T, depth = 4.0, 10.0, 72.0
    wave = airy_wave(height=H, period=T, depth=depth, stretching="vertical")
    t, z = np.arange(0.0, 20.01, 0.1), np.linspace(-depth, 3.0, 101)
    points = np.stack([np.zeros_like(z), np.zeros_like(z), z], axis=1)
    u, du = wave.motion(points, t)
    eta, p = wave.elevation(points, t), 1025.0 * wave.pressure(points, t)
    columns = [*np.broadcast_arrays(t[:, None], z), eta, u[..., 0], u[..., 2], du[..., 0], du[..., 2], p]
    header = ",".join((*REQUIRED, PRESSURE))
    rows = np.stack([c.ravel() for c in columns], axis=1)
    np.savetxt(tmp_path / "motion.csv", rows, delimiter=",", header=header, comments="")
    given = {"type": "kinematics", "file": str(tmp_path / "motion.csv"), "celerity_m_s": wave_speed(wave)}
    airy = {"type": "airy", "height_m": H, "period_s": T, "stretching": "vertical"}
    time = {"duration_s": 20.0, "step_s": 0.05}
    spread = []
    for waves in (given, airy):
        scenario = read_scenario(scenario_file(waves=waves, water={"ends": {"pressure": 1}}, time=time))
        spread.append(resultants(scenario)["water"])
    # 40 samples a period here against 256 there: extremes differ by their place between samples
    for k in (0, 4):
        assert np.ptp(spread[0][:, k]) == pytest.approx(np.ptp(spread[1][:, k]), rel=0.01)
    with pytest.raises(InputError, match="celerity_m_s: does not belong"):
        read_scenario(scenario_file(waves={**airy, "celerity_m_s": 3.0}, water={}, time=time))
    with pytest.raises(InputError, match="does not cover"):
        long = read_scenario(scenario_file(waves=given, water={}, time={"duration_s": 60.0, "step_s": 0.05}))
        resultants(long)


def test_a_depth_under_a_structure_that_stands_dry() -> None:
    """What is said is that the structure does not reach the water, not that the depth is unknown."""
    jacket = read_structure("jacket15")
    lowest = min(z for _, _, z in jacket.nodes.values())
    dry = replace(jacket, sea_level_z_m=lowest - 7.0)
    with pytest.raises(InputError, match="does not reach the bed .got 30.*sea_level_z_m"):
        depth_of(WaterSchema(depth_m=30.0), dry)
    with pytest.raises(InputError, match="depth is not known.*sea_level_z_m"):
        depth_of(WaterSchema(), dry)


def wave_speed(wave) -> float:
    return float(wave.omega[0] / wave.k[0])


def test_where_zero_stands_does_not_change_what_the_wind_does(scenario_file) -> None:
    """Moments are about still water: the same turbine 7 m higher, with its sea, has the same ones."""
    still = {"speed_m_s": 12.0, "turbulence": "none", "tower_drag": 0.5}
    time = {"duration_s": 10.0, "step_s": 0.05}
    scenario = read_scenario(scenario_file(**FEET, wind=still, rotor={"data": "iea15"}, time=time))
    own = scenario.asset.structure
    lifted = replace(
        own,
        nodes={name: (x, y, z + 7.0) for name, (x, y, z) in own.nodes.items()},
        sea_level_z_m=own.sea_level_z_m + 7.0,
    )
    other = replace(scenario, asset=replace(scenario.asset, structure=lifted))
    np.testing.assert_allclose(resultants(other)["wind"], resultants(scenario)["wind"], rtol=1e-9, atol=1.0)
