"""The sheet of a member ends in the utilisation that the check has, and its lines can be followed by hand."""

from dataclasses import replace
from math import pi, sqrt

import pytest

from jackettwin.checks import DesignBasis, calculation_sheet, frame_use
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, nodal_load, self_weight, static_displacement
from jackettwin.soil import clamped
from jackettwin.structure import assemble


@pytest.fixture(scope="module")
def checked():
    assembly = assemble(read_structure("jacket15"))
    load = self_weight(assembly) + nodal_load(assembly, {"tower_top": (2e6, 5e5, 0.0, 0.0, 0.0, 1e7)})
    u = static_displacement(build_system(assembly, clamped(assembly.structure)), load)
    return assembly, u


@pytest.mark.parametrize("edition", ["2007", "2020"])
def test_every_uniform_member_s_sheet_has_the_check_s_utilisation(checked, edition: str) -> None:
    assembly, u = checked
    basis = DesignBasis(edition=edition)
    uses = {one.member: one for one in frame_use(assembly, u, basis).members}
    uniform = [m for m in assembly.structure.members if m.section_start == m.section_end]
    assert len(uniform) > 50
    for member in uniform:
        use = uses[member.name]
        lines = {line.symbol: line.value for line in calculation_sheet(member, use, basis)}
        assert lines[f"U {use.check}"] == pytest.approx(use.utilisation, rel=1e-9), member.name


def test_lines_by_hand(checked) -> None:
    assembly, u = checked
    basis = DesignBasis()
    member = next(m for m in assembly.structure.members if m.name == "brace_1_1_1")
    use = next(one for one in frame_use(assembly, u, basis).members if one.member == member.name)
    found = {line.symbol: line.value for line in calculation_sheet(member, use, basis)}
    D, t = found["D"], found["t"]
    assert found["A"] == pytest.approx(pi * t * (D - t))
    assert found["f_v"] == pytest.approx(355e6 / sqrt(3.0))
    assert found["σ_a"] == pytest.approx(found["N"] / found["A"])
    assert found["U bending"] == pytest.approx(1.05 * found["σ_b"] / found["f_b"])
    if found["N"] < 0.0:
        assert found["U compression"] == pytest.approx(-1.18 * found["σ_a"] / found["f_c"])
    else:
        assert found["U tension"] == pytest.approx(1.05 * found["σ_a"] / 355e6)


def test_cones_and_pressure_are_refused(checked) -> None:
    assembly, u = checked
    basis = DesignBasis()
    uses = {one.member: one for one in frame_use(assembly, u, basis).members}
    tube = next(m for m in assembly.structure.members if m.section_start == m.section_end)
    cone = replace(tube, section_end=replace(tube.section_end, outer_diameter_m=2.5))
    with pytest.raises(InputError, match="uniform tubes"):
        calculation_sheet(cone, uses[cone.name], basis)
    with pytest.raises(InputError, match="hydrostatic pressure"):
        calculation_sheet(tube, replace(uses[tube.name], check="hoop"), basis)
