"""The sheet of a member ends in the utilisation that the check has, and its lines can be followed by hand."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from jackettwin.checks import DesignBasis, calculation_sheet, frame_use, joint_sheet
from jackettwin.checks.iso19902_joints import Joint
from jackettwin.checks.iso19902_pressure import PRESSURE_CHECKS
from jackettwin.checks.joint_check import BraceUse
from jackettwin.decks import read_structure
from jackettwin.response import build_system, nodal_load, self_weight, static_displacement
from jackettwin.soil import clamped
from jackettwin.structure import Section, assemble


@pytest.fixture(scope="module")
def checked():
    jacket = read_structure("jacket15")
    wide = Section(1.6, 0.04)
    coned = (replace(m, section_end=wide) if m.name == "leg_2_bay_2" else m for m in jacket.members)
    assembly = assemble(replace(jacket, members=tuple(coned)))
    load = self_weight(assembly) + nodal_load(assembly, {"tower_top": (2e6, 5e5, 0.0, 0.0, 0.0, 1e7)})
    u = static_displacement(build_system(assembly, clamped(assembly.structure)), load)
    return assembly, u


@pytest.mark.parametrize("edition", ["2007", "2020"])
@pytest.mark.parametrize("wet", [False, True])
def test_every_member_s_sheet_has_the_check_s_utilisations(checked, edition: str, wet: bool) -> None:
    """Cones too, and under pressure; each line's unit and clause are there to follow."""
    assembly, u = checked
    basis = DesignBasis(edition=edition)
    z = np.array(assembly.mesh.coordinates[:, 2])
    depth = np.maximum(72.0 - np.stack([z[assembly.mesh.start], z[assembly.mesh.end]], axis=1), 0.0)
    uses = frame_use(assembly, u, basis, pressure=1.1e4 * depth if wet else None).members
    governed = set()
    for use in uses:
        sheet = calculation_sheet(use, basis)
        lines = {line.symbol: line.value for line in sheet}
        assert lines[f"U {use.check}"] == pytest.approx(use.utilisation, rel=1e-9), use.member
        assert len(lines) == len(sheet)  # no symbol twice
        governed.add(use.check)
    assert any(check in PRESSURE_CHECKS for check in governed) is wet
    assert {line.clause for line in sheet}


def test_steel_thinner_or_stronger_than_the_clause_covers_is_no_headline(checked) -> None:
    """13.1: f_y at most 500 MPa and 0.9 f_u, walls from 6 mm on, D/t at most 120."""
    assembly, u = checked
    brace = "brace_1_1_1"

    def beyond(**given: float) -> tuple[str, ...]:
        uses = frame_use(assembly, u, DesignBasis(**given)).members
        return next(one.beyond_validity for one in uses if one.member == brace)

    assert beyond(yield_strength_pa=500e6) == ()
    assert beyond(yield_strength_pa=501e6) == ("f_y = 501 MPa is above 500 MPa",)
    assert beyond(yield_strength_pa=355e6, tensile_strength_pa=395e6) == ()
    assert beyond(yield_strength_pa=355e6, tensile_strength_pa=394e6) == ("f_y is above 0.9 f_u",)
    thin = Section(0.7, 0.0059)
    members = tuple(
        replace(m, section_start=thin, section_end=thin) if m.name == brace else m
        for m in assembly.structure.members
    )
    thinned = assemble(replace(assembly.structure, members=members))
    use = next(one for one in frame_use(thinned, u).members if one.member == brace)
    assert use.beyond_validity == ("t = 5.9 mm is below 6 mm",)
    assert not use.covered


def test_lines_by_hand(checked) -> None:
    assembly, u = checked
    basis = DesignBasis()
    member = next(m for m in assembly.structure.members if m.name == "brace_1_1_1")
    use = next(one for one in frame_use(assembly, u, basis).members if one.member == member.name)
    found = {line.symbol: line.value for line in calculation_sheet(use, basis)}
    D, t = found["D"], found["t"]
    assert found["A"] == pytest.approx(pi * t * (D - t))
    assert found["f_v"] == pytest.approx(355e6 / sqrt(3.0))
    assert found["σ_a"] == pytest.approx(found["N"] / found["A"])
    assert found["U bending"] == pytest.approx(1.05 * found["σ_b"] / found["f_b"])
    if found["N"] < 0.0:
        assert found["U compression"] == pytest.approx(-1.18 * found["σ_a"] / found["f_c"])
    else:
        assert found["U tension"] == pytest.approx(1.05 * found["σ_a"] / 355e6)


def test_lines_under_pressure_by_hand(checked) -> None:
    """The lowest leg in 1.1 MPa of water: each line from those before it."""
    assembly, u = checked
    pressure = np.full((assembly.mesh.start.size, 2), 0.8e6)
    use = next(
        one for one in frame_use(assembly, u, pressure=pressure).members if one.member == "leg_1_bay_1"
    )
    found = {line.symbol: line.value for line in calculation_sheet(use, DesignBasis())}
    D, t = found["D"], found["t"]
    assert found["p"] == 0.8e6
    assert found["σ_h"] == pytest.approx(0.8e6 * D / (2.0 * t))
    assert found["σ_q"] == pytest.approx(0.5 * found["σ_h"])
    assert found["μ"] == pytest.approx(found["L_r"] / D * sqrt(2.0 * D / t))
    assert found["B"] == pytest.approx(min(1.25 * found["σ_h"] / found["f_h"], 1.0))
    assert found["η"] == pytest.approx(5.0 - 4.0 * found["f_h"] / found["f_y"])
    left = max(1.0 + 0.09 * found["B"] ** 2 - found["B"] ** (2.0 * found["η"]), 0.0)
    assert found["r"] == pytest.approx(max(sqrt(left) - 0.3 * found["B"], 1e-3))
    assert found["U hoop"] == pytest.approx(1.25 * found["σ_h"] / found["f_h"])
    squeezed = max(found["σ_q"] - found["σ_a"], 0.0)
    pulled = max(found["σ_a"] - found["σ_q"], 0.0)
    by_hand = (
        1.05 * pulled / found["f_t,h"]
        + 1.18 * squeezed / found["f_yc"]
        + 1.05 * found["σ_b"] / found["f_b,h"]
    )
    assert found["U pressure_section"] == pytest.approx(by_hand)


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
