"""Welds around tubes: hand values of the factor, beam theory at eight points, which welds are found."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.errors import InputError
from jackettwin.fatigue import (
    LifeModel,
    TubeDetails,
    butt_weld_factor,
    count,
    models_at_height,
    read_curve,
    read_details,
    tube_lives,
    tube_welds,
)
from jackettwin.fatigue.tube_welds import Detail
from jackettwin.structure import (
    STEEL,
    Assembly,
    Member,
    Section,
    SectionForces,
    Structure,
    assemble,
    section_forces,
)

D, T, LENGTH = 1.2, 0.04, 10.0
_AREA = np.pi * (D - T) * T
_INERTIA = np.pi / 64.0 * (D**4 - (D - 2.0 * T) ** 4)
_MODELS = models_at_height("D")


def line(*sections: Section) -> Assembly:
    """Return members in line along x, one of each section."""
    nodes = {f"n{i}": (LENGTH * i, 0.0, 0.0) for i in range(len(sections) + 1)}
    members = tuple(
        Member(f"tube_{i}", f"n{i}", f"n{i + 1}", one, one, STEEL) for i, one in enumerate(sections)
    )
    return assemble(Structure("line", nodes, members))


def detail(position: float = 0.0, scf: float = 1.0) -> TubeDetails:
    return TubeDetails(_MODELS, own=(Detail("flange", "tube_0", position, scf, _MODELS),))


@pytest.mark.parametrize(
    ("length_m", "value"),
    # D/t = 100: β = 1.5 − 1/2 + 3/4; T/t = 2: 1/(1 + 2^1.75) = 0.229169; α = 1.82 · 0.229169 of L = √(Dt)
    [(0.0, 1.0 + 3.0 * 0.229169), (0.1, 1.0 + 3.0 * 0.229169 * 0.658962)],
)
def test_the_factor_of_a_thickness_change_is_the_hand_value(length_m: float, value: float) -> None:
    assert butt_weld_factor(1.0, 0.01, 0.02, 0.005, length_m) == pytest.approx(value, rel=1e-5)


def test_walls_in_line_concentrate_nothing_and_misalignment_of_plates_half_of_its_plate_value() -> None:
    assert butt_weld_factor(D, T, T, 0.0) == 1.0
    # T = t: 1/(1 + 1) of 6 δ/t
    assert butt_weld_factor(D, T, T, 0.1 * T) == pytest.approx(1.3, rel=1e-12)


def test_stress_at_eight_points_is_that_of_beam_theory() -> None:
    (weld,), _ = tube_welds(line(Section(D, T)), detail(scf=1.5))
    N, M_y, M_z = 3e6, 2e6, -1e6
    forces = SectionForces(*(np.full((1, 1, 2), f) for f in (N, 5.0, 7.0, 11.0, M_y, M_z)))
    y, z = 0.5 * D * np.cos(np.arange(8) * np.pi / 4), 0.5 * D * np.sin(np.arange(8) * np.pi / 4)
    expected = 1.5 * (N / _AREA + (M_y * z - M_z * y) / _INERTIA)
    assert_allclose(weld.stress(forces)[:, 0], expected, rtol=1e-12)


@pytest.mark.parametrize("axis", [1, 2])
def test_the_side_towards_which_a_tube_bends_is_compressed(axis: int) -> None:
    """A curvature κ towards local y or z: −E κ R on that side, by the element's own end forces."""
    assembly = line(Section(D, T))
    (weld,), _ = tube_welds(assembly, detail())
    kappa, axes = 1e-4, assembly.mesh.axes[0]
    turned = np.cross(axes[0], axes[axis])
    u = np.concatenate([np.zeros(6), 0.5 * kappa * LENGTH**2 * axes[axis], kappa * LENGTH * turned])
    stress = weld.stress(section_forces(assembly, u[None]))[:, 0]
    expected = -STEEL.youngs_modulus_pa * kappa * 0.5 * D
    assert_allclose(stress[[2 * (axis - 1), 2 * (axis - 1) + 4]], [expected, -expected], rtol=1e-9)


def test_a_detail_within_a_member_takes_the_forces_there() -> None:
    (weld,), _ = tube_welds(line(Section(D, T)), detail(position=0.25))
    nothing = np.zeros((1, 1, 2))
    forces = SectionForces(np.array([[[4.0, 8.0]]]), *(nothing,) * 5)
    assert_allclose(weld.stress(forces), 5.0 / _AREA, rtol=1e-12)


def test_butt_welds_stand_where_walls_change_in_the_thinner_wall() -> None:
    assembly = line(Section(D, T), Section(D, T), Section(D, 0.06), Section(2.0, 0.06))
    (weld,), apart = tube_welds(assembly, TubeDetails(_MODELS))
    assert (weld.member, weld.position, weld.section) == ("tube_1", 1.0, Section(D, T))
    assert weld.scf == pytest.approx(butt_weld_factor(D, T, 0.06, 0.01), rel=1e-12)
    assert weld.warnings == () and apart == ("n3",)
    (shifted,), _ = tube_welds(assembly, TubeDetails(_MODELS, misalignment_m=0.003))
    assert shifted.scf - 1.0 == pytest.approx(1.3 * (weld.scf - 1.0), rel=1e-12)


def test_what_the_factor_does_not_hold_for_is_said() -> None:
    (thick,), _ = tube_welds(line(Section(D, 0.02), Section(D, 0.06)), TubeDetails(_MODELS))
    assert "T/t = 3" in thick.warnings[0]
    (taper,), _ = tube_welds(line(Section(D, T), Section(D + 0.05, T)), TubeDetails(_MODELS))
    assert "flush" in taper.warnings[0]


def test_the_worst_point_has_the_damage_of_its_cycles() -> None:
    assembly = line(Section(D, T))
    (weld,), _ = tube_welds(assembly, detail())
    quiet, loud = count(np.array([0.0, 1e6] * 50)), count(np.array([0.0, 1e8] * 50))
    (life,) = tube_lives(assembly.structure, [weld], [[quiet] * 3 + [loud] + [quiet] * 4], 600.0)
    assert (life.position, life.curve, life.environment) == ("135°", "D", "free-corrosion")
    assert life.largest_range_pa == 1e8 and int(np.argmax(life.damage_by_point)) == 3
    # D in free corrosion, log a = 11.687 and m = 3; (40/25)^0.2 for the wall; 99 halves
    assert life.life.damage == pytest.approx(49.5 * (100.0 * 1.6**0.2) ** 3 / 10.0**11.687, rel=1e-9)
    model = LifeModel(read_curve("D", "free-corrosion"))
    assert life.life == model.life(loud, 600.0, T)


def test_a_detail_of_an_unknown_member_is_refused() -> None:
    details = detail()
    wrong = replace(details, own=(replace(details.own[0], member="tube_9"),))
    with pytest.raises(InputError, match=r"details\.0\.member"):
        tube_welds(line(Section(D, T)), wrong)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("butt_welds: {curve: Q}", r"butt_welds\.curve.*S-N curve"),
        ("butt_welds: {misalignment_m: 4.0}", r"butt_welds\.misalignment_m"),
        ("details: [{name: a, member: leg, position: 2, curve: F}]", r"details\.yaml: details\.0\.position"),
        ("details: [{name: a, member: leg, position: 0, curve: F, scf: -1}]", r"details\.0\.scf"),
        ("details: [{name: a, member: leg, position: 0}]", "curve"),
        (f"details: [{', '.join(['{name: a, member: leg, position: 0, curve: F}'] * 2)}]", "one name"),
    ],
)
def test_details_that_cannot_be_are_refused(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "details.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_details(path, models_at_height)


def test_a_file_of_details_is_read(tmp_path: Path) -> None:
    path = tmp_path / "details.yaml"
    path.write_text(
        "butt_welds: {curve: F, misalignment_m: 0.002}\n"
        "details: [{name: flange, member: leg, position: 0.5, curve: E, scf: 1.4}]"
    )
    found = read_details(path, models_at_height)
    assert found.misalignment_m == 0.002 and found.models(50.0)[1].curve.name == "F"
    (own,) = found.own
    assert (own.name, own.member, own.position, own.scf) == ("flange", "leg", 0.5, 1.4)
    assert own.models(50.0)[1].curve.name == "E"
