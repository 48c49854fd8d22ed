"""Warnings where Morison's equation and linear waves end."""

from jackettwin.simulate import read_scenario
from jackettwin.simulate.scenario.sea import sea_warnings

MONOPILE = """
sea_level_z_m: 30.0
sections: {pile: {outer_diameter_m: 9.0, thickness_m: 0.1}}
nodes: {foot: [0.0, 0.0, 0.0], top: [0.0, 0.0, 40.0]}
members: [{nodes: [foot, top], section: pile, name: pile}]
reaction_nodes: [foot]
"""


def said(path) -> list[str]:
    scenario = read_scenario(path)
    assert scenario.sea is not None
    return sea_warnings(scenario.sea, scenario.asset.structure)


def test_a_wide_column_in_short_waves(scenario_file, tmp_path) -> None:
    """9 m against 25 m of a 4 s wave; not against 140 m of a 10 s one; growth widens it."""
    file = tmp_path / "monopile.yaml"
    file.write_text(MONOPILE, encoding="utf-8")

    def warned(period: float, **water) -> list[str]:
        waves = {"type": "airy", "height_m": 1.0, "period_s": period}
        return said(scenario_file(structure=str(file), support="clamped", waves=waves, water=water))

    (only,) = warned(4.0)
    assert "pile is 9.0 m wide" in only and "wave length 25 m" in only
    assert warned(10.0) == []
    growth = [{"top_z_m": 0.0, "bottom_z_m": -30.0, "thickness_m": 0.2}]
    # 46.0 m of a 5.45 s wave: 9.2 m is its fifth
    assert warned(5.45) == [] and len(warned(5.45, marine_growth=growth)) == 1


def test_an_airy_wave_that_would_break(scenario_file) -> None:
    """Deep water: 0.141 λ, 3.5 m at 4 s; a jacket's members stay slender."""
    waves = {"type": "airy", "period_s": 4.0}
    assert said(scenario_file(waves={**waves, "height_m": 3.0})) == []
    (only,) = said(scenario_file(waves={**waves, "height_m": 4.0}))
    assert "break at 3.5 m" in only
    assert said(scenario_file(waves={"type": "jonswap", "hs_m": 4.0, "tp_s": 9.0})) == []
