"""Members over a scenario: calm is statics, a sea and wind ask for more."""

import pytest

from jackettwin.response.static import self_weight, static_displacement
from jackettwin.response.system import build_system
from jackettwin.simulate import read_scenario
from jackettwin.simulate.members import scenario_uses
from jackettwin.soil import pinned
from jackettwin.structure import assemble, read_structure
from jackettwin.structure.member_check import member_uses

SEA = {"type": "airy", "height_m": 8.0, "period_s": 9.0, "direction_deg": 20.0}


def test_calm_is_statics_and_waves_add_to_it(scenario_file) -> None:
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    rest = static_displacement(build_system(assembly, pinned(structure)), self_weight(assembly))
    still = {use.member: use for use in member_uses(assembly, rest)}
    calm = scenario_uses(read_scenario(scenario_file(support="pinned")))
    for use in calm:
        assert use.by_check == pytest.approx(still[use.member].by_check, rel=1e-6, abs=1e-12)
    rough = scenario_uses(read_scenario(scenario_file(support="pinned", waves=SEA, water={})))
    more = [now.utilisation - then.utilisation for now, then in zip(rough, calm, strict=True)]
    assert min(more) > -1e-6  # the worst instant is never better than rest
    legs = [m for m, use in zip(more, rough, strict=True) if use.member.startswith("leg")]
    assert min(legs) > 1e-4


def test_buoyancy_lifts_and_flooding_takes_it_back(scenario_file) -> None:
    """Added mass weighs nothing: water about closed members can only lift the legs."""
    compression = []
    for water in ({}, {"adds_mass": True}, {"adds_mass": True, "flooded": True}):
        uses = scenario_uses(read_scenario(scenario_file(support="pinned", water=water)))
        compression.append(sum(u.by_check["compression"] for u in uses if u.member.startswith("leg")))
    dry, afloat, flooded = compression
    assert afloat < flooded < dry
