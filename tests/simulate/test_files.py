"""Scenario files: what they mean, and what is refused with file, field and remedy."""

from math import pi
from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import GrowthBand, Strip, StripTable
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
    assert (s.sea.coefficients.pressure, s.sea.coefficients.added_mass) == (1.0, 1.0)
    assert s.sea.water is None
    assert s.air.wind.hub_height_m == pytest.approx(144.0 + 5.614)
    assert (s.turbine.state, s.turbine.pitch) == ("parked", pytest.approx(pi / 2))
    assert s.clock.load_step_s == 0.05
    assert [i.sensor.channel for i in s.instruments] == ["acc_top_x", "acc_top_y"]


def test_growth_and_flooding_add_their_mass_unless_told_otherwise(scenario_file) -> None:
    growth = {"marine_growth": [{"top_z_m": 2.0, "bottom_z_m": -20.0, "thickness_m": 0.1}]}
    sea = read_scenario(scenario_file(water=growth)).sea
    assert sea is not None and sea.water is not None
    assert sea.coefficients.growth == (GrowthBand(2.0, -20.0, 0.1),)
    sea = read_scenario(scenario_file(water={**growth, "adds_mass": False})).sea
    assert sea is not None and sea.water is None


def test_water_as_a_hydrodyn_user_gives_it(scenario_file) -> None:
    """Growth by depth, coefficients with and without it, over the height and of some members."""
    water = {
        "drag": 0.8,
        "pressure": 0.9,
        "with_growth": {"drag": 1.1},
        "marine_growth": [
            {"z_m": -40.0, "thickness_m": 0.05},
            {"z_m": 2.0, "thickness_m": 0.1, "density": 1400.0},
        ],
        "coefficients": [
            {"members": ["tower"], "at": [{"z_m": 0.0, "drag": 0.7, "with_growth": {"added_mass": 0.9}}]}
        ],
        "growth_density": 1300.0,
    }
    sea = read_scenario(scenario_file(water=water)).sea
    assert sea is not None
    c = sea.coefficients
    assert c.growth == (GrowthBand(2.0, -40.0, 0.1, 0.05, 1400.0, 1300.0),)
    assert (c.bare, c.grown) == (Strip(0.8, 1.0, 0.9), Strip(1.1, 1.0, 0.9))
    assert c.tables == (StripTable((0.0,), (Strip(0.7, 1.0, 0.9),), (Strip(0.7, 0.9, 0.9),), ("tower",)),)


def test_water_of_a_hydrodyn_file(scenario_file, tmp_path) -> None:
    """Beside the scenario; what it says must not be said again."""
    text = (Path(__file__).parents[1] / "data/hydrodyn/members.dat").read_text(encoding="utf-8")
    simple = text.replace("1.0         2        F", "1.0         1        F").replace(
        "3        F", "1        F"
    )
    filled = simple.replace("     1   NFillGroups", "     0   NFillGroups")
    (tmp_path / "hd.dat").write_text(filled, encoding="utf-8")
    sea = read_scenario(scenario_file(water={"hydrodyn": "hd.dat", "density": 1000.0})).sea
    assert sea is not None and sea.water is not None
    assert sea.coefficients.bare == Strip(0.65, 1.0, 1.0)
    assert (sea.coefficients.density_kg_m3, sea.ends.drag) == (1000.0, 0.2)
    with pytest.raises(InputError, match="water.drag.*HydroDyn file already"):
        read_scenario(scenario_file(water={"hydrodyn": "hd.dat", "drag": 1.0}))
    with pytest.raises(InputError, match="hd2.dat: water.hydrodyn: no such"):
        read_scenario(scenario_file(water={"hydrodyn": "hd2.dat"}))


GROWN = {"z_m": 0.0, "thickness_m": 0.1}
SOFT = {"thickness_m": 70.0, "effective_weight_n_m3": 9e3, "clay": {"strength_pa": [20e3, 90e3]}}
PILED = {
    "piles": {"length_m": 60.0, "outer_diameter_m": 2.8, "thickness_m": 0.06},
    "soil": {"layers": [SOFT]},
}
BAD = {
    "growth without heights": ({"water": {"marine_growth": [{"thickness_m": 0.1}]}}, "top_z_m.*z_m at every"),
    "one height of growth": (
        {"water": {"marine_growth": [GROWN]}},
        "water.marine_growth.*at least two heights",
    ),
    "growth upside down": (
        {"water": {"marine_growth": [{"top_z_m": -9.0, "bottom_z_m": 2.0, "thickness_m": 0.1}]}},
        "water.marine_growth.*must lie above",
    ),
    "coefficients of no member": (
        {"water": {"coefficients": [{"members": ["legs"], "at": [{"z_m": 0.0}]}]}},
        "water.coefficients.*no such member",
    ),
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
    "drag of 50": ({"water": {"drag": 50}}, "water.drag: .*got 50.; allowed: 0 to 10; check the number"),
    "end drag": ({"water": {"ends": {"drag": 50}}}, "water.ends.drag: .*allowed: 0 to 10"),
    "depth of a puddle": ({"water": {"depth_m": 0.07}}, "water.depth_m: .*allowed: 1 to 1000"),
    "growth from the moon": (
        {"water": {"marine_growth": [{**GROWN, "z_m": 4e8}, GROWN]}},
        "water.marine_growth.0.z_m: .*allowed: -10000 to 10000",
    ),
    "a tsunami": ({"waves": {"type": "jonswap", "hs_m": 1e3, "tp_s": 9.0}}, "waves.hs_m: .*> 0, ≤ 30; check"),
    "a heading in turns": ({"waves": {**WAVES, "direction_deg": 1e12}}, "direction_deg: .*-360 to 360"),
    "yes for a number": ({"wind": {"speed_m_s": True}}, "wind.speed_m_s: not a number .got True"),
    "a rotor's frequency": (
        {"damping": {"rayleigh": {"ratio": 0.01, "frequency_hz": 1e12}}},
        "damping.rayleigh.frequency_hz: .*allowed: 0.001 to 1000; check",
    ),
    "a name no file can have": ({"structure": "a" * 3000}, "structure: no such structure.*take one of these"),
    "a sensor that is never there": (
        {
            "sensors": [
                {"channel": "a", "node": "tower_top", "direction": [1, 0, 0], "dropouts_per_hour": 1e12}
            ]
        },
        "sensors.0.dropouts_per_hour: .*allowed: 0 to 36000",
    ),
    "a pile as wide as a gasometer": (
        {**PILED, "piles": {"length_m": 60.0, "outer_diameter_m": 140.0, "thickness_m": 0.06}},
        "piles.outer_diameter_m: .*allowed: 0.05 to 20",
    ),
    "clay in kilopascals": (
        {"piles": PILED["piles"], "soil": {"layers": [{**SOFT, "clay": {"strength_pa": [20.0, 90e3]}}]}},
        "soil.layers.0.clay.strength_pa: too small to be in this unit .got 20.0.*20e3",
    ),
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
