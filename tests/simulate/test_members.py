"""Members over a scenario: calm is statics, a sea and wind ask for more."""

import numpy as np
import pytest

from jackettwin.checks import frame_use
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.decks import read_structure
from jackettwin.loads.sea.waves import wave_number
from jackettwin.response.motion.static import nodal_load, self_weight, static_displacement
from jackettwin.response.system import build_system
from jackettwin.simulate import loads_document, read_scenario
from jackettwin.simulate.members import at_rest, scenario_uses
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.soil import clamped, pinned
from jackettwin.structure import assemble
from jackettwin.structure.forces import element_weight

SEA = {"type": "airy", "height_m": 8.0, "period_s": 9.0, "direction_deg": 20.0}


def test_calm_is_statics_and_waves_add_to_it(scenario_file) -> None:
    structure = read_structure("jacket15")
    assembly = assemble(structure, gravity=True)
    rest = static_displacement(build_system(assembly, pinned(structure)), self_weight(assembly))
    still = {use.member: use for use in frame_use(assembly, rest, along=element_weight(assembly)).members}
    calm = scenario_uses(read_scenario(scenario_file(support="pinned"))).members
    for use in calm:
        assert use.by_check == pytest.approx(still[use.member].by_check, rel=1e-6, abs=1e-12)
    rough = scenario_uses(read_scenario(scenario_file(support="pinned", waves=SEA, water={}))).members
    more = [now.utilisation - then.utilisation for now, then in zip(rough, calm, strict=True)]
    assert min(more) > -1e-6  # the worst instant is never better than rest
    legs = [m for m, use in zip(more, rough, strict=True) if use.member.startswith("leg")]
    assert min(legs) > 1e-4


def test_buoyancy_lifts_and_flooding_takes_it_back(scenario_file) -> None:
    """Added mass weighs nothing: water about closed members can only lift the legs."""
    compression = []
    for water in ({}, {"adds_mass": True}, {"adds_mass": True, "flooded": True}):
        uses = scenario_uses(read_scenario(scenario_file(support="pinned", water=water))).members
        compression.append(sum(u.by_check["compression"] for u in uses if u.member.startswith("leg")))
    dry, afloat, flooded = compression
    assert afloat < flooded < dry


MONOPILE = """
sea_level_z_m: 20.0
sections: {pile: {outer_diameter_m: 6.0, thickness_m: 0.1}}
nodes: {foot: [0.0, 0.0, 0.0], top: [0.0, 0.0, 30.0]}
members: [{nodes: [foot, top], section: pile, name: pile}]
reaction_nodes: [foot]
"""


def test_a_closed_monopile_stands_on_its_weight_less_that_of_the_water_it_displaces(
    scenario_file, tmp_path
) -> None:
    """Its top sinks by (w L² − b h²)/(2EA): w of steel over L = 30 m, b of water over h = 20 m."""
    file = tmp_path / "monopile.yaml"
    file.write_text(MONOPILE, encoding="utf-8")
    scenario = read_scenario(scenario_file(structure=str(file), support="clamped", water={"adds_mass": True}))
    motion = simulate_motion(scenario)
    top = at_rest(scenario, motion).displacement[2::6].min()
    steel = read_structure(file).members[0].material
    area = 0.25 * np.pi * (6.0**2 - 5.8**2)
    w = steel.density_kg_m3 * area * GRAVITY_M_S2
    b = scenario.sea.coefficients.density_kg_m3 * 0.25 * np.pi * 6.0**2 * GRAVITY_M_S2
    wanted = -(w * 30.0**2 - b * 20.0**2) / (2.0 * steel.youngs_modulus_pa * area)
    assert top == pytest.approx(wanted, rel=1e-6)


def test_the_foot_of_a_monopile_feels_the_overturning_moment(scenario_file, tmp_path) -> None:
    """One element, f1 of 7 Hz under a wave of 12 s: what bends its foot is the moment of the waves there."""
    file = tmp_path / "monopile.yaml"
    file.write_text(MONOPILE, encoding="utf-8")
    structure = read_structure(file)
    assembly = assemble(structure)
    pushed = static_displacement(
        build_system(assembly, clamped(structure)), nodal_load(assembly, {"top": (1e6, 0.0, 0.0)})
    )
    per_moment = frame_use(assembly, pushed).members[0].by_check["bending"] / 30e6
    waves = {"type": "airy", "height_m": 3.0, "period_s": 12.0, "direction_deg": 30.0}
    scenario = read_scenario(scenario_file(structure=str(file), support="clamped", waves=waves))
    moment = loads_document(scenario)["mudline"]["overturning_moment_n_m"]
    use = scenario_uses(scenario).members[0].by_check["bending"]
    # static to (f/f1)² = 1e-4; 2 m pieces and a load step of 0.05 s
    assert use / per_moment == pytest.approx(moment, rel=3e-3)


def test_a_lone_crest_presses_as_high_as_it_is(scenario_file, tmp_path) -> None:
    """ISO 19902 (13.2-20): at the bed 20 m under still water, ρg(20 + 4/cosh kd), 4σ being 2.6 m of sea."""
    file = tmp_path / "monopile.yaml"
    file.write_text(MONOPILE, encoding="utf-8")
    t = np.arange(0.0, 121.0, 0.25)
    eta = 4.0 * np.exp(-(((t - 60.0) / 5.0) ** 2)) * np.cos(2.0 * np.pi * (t - 60.0) / 10.0)
    np.savetxt(tmp_path / "eta.csv", np.column_stack([t, eta]), delimiter=",")
    case = {"structure": str(file), "support": "clamped", "water": {"adds_mass": True}}
    calm = read_scenario(scenario_file(**case))
    crest = read_scenario(
        scenario_file(**case, waves={"type": "elevation", "file": str(tmp_path / "eta.csv")})
    )
    assert crest.sea is not None
    k = wave_number(2.0 * np.pi / crest.sea.period_s, 20.0)
    wanted = (20.0 + 4.0 / np.cosh(20.0 * k)) / 20.0
    hoop = [scenario_uses(scenario).members[0].by_check["hoop"] for scenario in (crest, calm)]
    assert hoop[0] / hoop[1] == pytest.approx(float(wanted), rel=1e-6)
