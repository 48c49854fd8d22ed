"""Scenario files: what they mean, and what is refused with file, field and remedy."""

from math import pi

import pytest

from jackettwin.errors import InputError
from jackettwin.simulate import read_scenario, shipped_scenarios

WAVES = {"type": "airy", "height_m": 6.0, "period_s": 10.0}


def test_shipped_scenarios_read() -> None:
    assert "parked" in shipped_scenarios()
    for name in shipped_scenarios():
        assert read_scenario(name).clock.total_s > 0.0


def test_defaults_are_stated(scenario_file) -> None:
    """Depth from the feet, C_M = 1 + C_a, hub height from the tower top, parked at 90°."""
    s = read_scenario(scenario_file(waves=WAVES, wind={"speed_m_s": 10.0}))
    assert s.sea is not None and s.air is not None and s.turbine is not None
    assert s.sea.depth_m == pytest.approx(72.0)
    assert s.sea.coefficients.inertia == 2.0
    assert s.sea.water is None
    assert s.air.wind.hub_height_m == pytest.approx(144.0 + 5.614)
    assert (s.turbine.state, s.turbine.pitch) == ("parked", pytest.approx(pi / 2))
    assert s.clock.load_step_s == 0.05
    assert [i.sensor.channel for i in s.instruments] == ["acc_top_x", "acc_top_y"]


def test_growth_and_flooding_add_their_mass_unless_told_otherwise(scenario_file) -> None:
    growth = {"marine_growth": [{"top_z_m": 2.0, "bottom_z_m": -20.0, "thickness_m": 0.1}]}
    sea = read_scenario(scenario_file(water=growth)).sea
    assert sea is not None and sea.water is not None
    assert sea.coefficients.growth == ((2.0, -20.0, 0.1),)
    sea = read_scenario(scenario_file(water={**growth, "adds_mass": False})).sea
    assert sea is not None and sea.water is None


BAD = {
    "unknown key": ({"wavess": WAVES}, "wavess.*did you mean 'waves'"),
    "unknown nested key": ({"wind": {"speed_m_s": 9.0, "turbulance": "B"}}, "wind.turbulance.*turbulence"),
    "no such wave": ({"waves": {**WAVES, "type": "gerstner"}}, "waves.*gerstner"),
    "height of the other kind": ({"waves": {**WAVES, "hs_m": 2.0}}, "waves.hs_m.*does not belong"),
    "no period": ({"waves": {"type": "airy", "height_m": 5.0}}, "waves.period_s.*missing"),
    "negative height": ({"waves": {**WAVES, "height_m": -1.0}}, "waves.height_m.*> 0"),
    "no wind to operate in": ({"rotor": {"state": "operating"}}, "wind.*needs wind"),
    "no such rotor": ({"wind": {"speed_m_s": 9.0}, "rotor": {"data": "nrel6"}}, "nrel6"),
    "step does not divide": ({"time": {"duration_s": 10.0, "step_s": 0.03}}, "time.duration_s.*multiples"),
    "two grounds": ({"support": "pinned", "foundation": "jacket15"}, "foundation, support.*twice"),
    "soil without piles": ({"soil": {"linear": {"lateral_n_m3": 1e7, "axial_n_m2": 1e8}}}, "piles"),
    "no such structure": ({"structure": "jacket51"}, "structure.*did you mean 'jacket15'"),
    "channel twice": (
        {"sensors": [{"channel": "a", "node": "tower_top", "direction": [1, 0, 0]}] * 2},
        "sensors.*twice",
    ),
}


@pytest.mark.parametrize(("keys", "message"), BAD.values(), ids=BAD)
def test_refusals_name_the_place(scenario_file, keys, message) -> None:
    with pytest.raises(InputError, match=message) as caught:
        read_scenario(scenario_file(**keys))
    assert caught.value.file is not None


def test_a_missing_scenario_is_a_near_miss() -> None:
    with pytest.raises(InputError, match="did you mean 'parked'"):
        read_scenario("parkd")
