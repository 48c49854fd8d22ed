"""The sheet of a member ends in the utilisation that the check has, and its lines can be followed by hand."""

from dataclasses import replace
from math import pi, sqrt

import pytest

from jackettwin.checks import DesignBasis, calculation_sheet, frame_use, joint_sheet
from jackettwin.checks.iso19902_joints import Joint
from jackettwin.checks.joint_check import BraceUse
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


@pytest.mark.parametrize("conservative", [False, True])
def test_every_joint_s_sheet_has_the_check_s_utilisation(checked, conservative: bool) -> None:
    assembly, u = checked
    uses = frame_use(assembly, u, DesignBasis(conservative_joints=conservative)).joints
    assert len(uses) > 30
    for use in uses:
        lines = {line.symbol: line.value for line in joint_sheet(use, conservative=conservative)}
        assert lines["U joint"] == pytest.approx(use.utilisation, rel=1e-9), (use.node, use.brace)
        assert lines["Q_f"] == pytest.approx(use.Q_f, rel=1e-9)


def test_a_joint_s_lines_by_hand() -> None:
    """A Y joint: D 1.2 m, T 40 mm, d 0.6 m, 45°, 345 MPa; P 2 MN, chord with −8 MN and 3 MN·m.

    β 0.5, γ 15; Q_u = 30 · 0.5 = 15 in tension; P_y = 345 · π/4 (1.2² − 1.12²) = 50.29 MN, M_p = 345
    (1.2³ − 1.12³)/6 = 18.575 MN·m; q_A² = 1.1025 (25 (8/50.29)² + 11 (3/18.575)²) = 1.0138 on the worse side,
    Q_f = 1 − 0.030 · 1.0138 = 0.9696.
    P_d = 345 · 0.04² · 15 · 0.9696/(1.05 · 0.7071) = 10.813 MN, U = 0.1850.
    """
    joint = Joint(D=1.2, T=0.04, d=0.6, t=0.02, theta=pi / 4, f_y=345e6, f_yb=345e6)
    use = BraceUse("n", "leg", "brace", joint, 0.185, (0.0, 1.0, 0.0), (2e6, 0.0, 0.0), 15.0, 0.9696,
                   chord_sides=((-8e6, 3e6), (-7e6, 1e6)))  # fmt: skip
    found = {line.symbol: line.value for line in joint_sheet(use)}
    assert found["Q_u Y"] == pytest.approx(15.0)
    assert found["P_y"] == pytest.approx(50.29e6, rel=1e-3)
    assert found["M_p"] == pytest.approx(18.575e6, rel=1e-3)
    assert found["Q_f"] == pytest.approx(0.9696, abs=1e-4)
    assert found["P_d"] == pytest.approx(10.813e6, rel=1e-3)
    assert found["U joint"] == pytest.approx(0.1850, abs=2e-4)
    assert "g" not in found
