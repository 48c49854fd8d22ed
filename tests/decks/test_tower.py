"""A tower on a deck's interface: tubes, stations or ElastoDyn's, and the structure that it makes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.decks.tower import _members, _standing, read_elastodyn_tower, with_base
from jackettwin.errors import InputError
from jackettwin.response import build_system, static_displacement, undamped_modes
from jackettwin.response.superelement.craig_bampton import superelement
from jackettwin.simulate import read_scenario
from jackettwin.soil import clamped, own_support
from jackettwin.structure import Reaction, RigidLink, Structure, assemble, at_interface, check
from jackettwin.twin import read_twin
from jackettwin.updating import stages

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"
TOWER = """
tower:
  height_m: 120.0
  bottom: {outer_diameter_m: 8.0, thickness_m: 0.05}
  top: {outer_diameter_m: 6.5, thickness_m: 0.025}
"""
RNA = "rna: {mass_kg: 950000.0, cg_offset_m: [-4.7, 0.0, 4.3]}\n"


def written(folder: Path, text: str, *, foundation: str = str(DECK)) -> Path:
    path = folder / "whole.yaml"
    path.write_text(f"foundation: {foundation}\n{text}")
    return path


def frequencies(structure: Structure, number: int = 5) -> np.ndarray:
    return undamped_modes(build_system(assemble(structure), own_support(structure)), number).frequency_hz


def test_a_tower_on_a_jackets_six_interface_joints(tmp_path: Path) -> None:
    """They move as one body about the new base; mass is that of deck, tower and nacelle."""
    whole, deck = read_structure(written(tmp_path, TOWER + RNA)), read_structure(DECK)
    assert whole.interface_nodes == ("tower_base",)
    assert whole.nodes["tower_base"] == (0.0, 0.0, 30.0)
    assert whole.top_node == "tower_top"
    tubes = (
        check(assemble(replace(whole, masses=()))).mass_kg - check(assemble(replace(deck, masses=()))).mass_kg
    )
    # ∫ πρ(D − t)t of diameter and wall that go straight; twelve pieces of their means leave 1e-4
    assert tubes == pytest.approx(7850.0 * np.pi * 120.0 * (7.2125 * 0.0375 + 1.475 * 0.025 / 12.0), rel=1e-3)
    assert check(assemble(whole)).mass_kg == pytest.approx(check(assemble(deck)).mass_kg + tubes + 9.5e5)
    assert [s.parts for s in stages(whole, 1)] == [("foundation",), ("foundation", "tower")]
    modes = frequencies(whole)
    assert 0.15 < modes[0] < modes[1] < 0.25


def test_the_foundation_below_is_the_decks(tmp_path: Path) -> None:
    """Cut again at the interface, its superelement is that of the deck about the same point."""
    whole, deck = read_structure(written(tmp_path, TOWER)), read_structure(DECK)
    base, rest = at_interface(whole)
    assert rest is not None
    found, wanted = (
        superelement(build_system(assemble(part), own_support(part)), number=6, reference_m=(0.0, 0.0, 30.0))
        for part in (base, at_interface(deck)[0])
    )
    scale = np.sqrt(np.outer(*[np.diag(wanted.interface_stiffness)] * 2))
    assert np.abs((found.interface_stiffness - wanted.interface_stiffness) / scale).max() < 1e-9
    scale = np.sqrt(np.outer(*[np.diag(wanted.interface_mass)] * 2))
    assert np.abs((found.interface_mass - wanted.interface_mass) / scale).max() < 1e-9


def test_a_tower_of_a_parametric_jacket_can_be_put_back() -> None:
    """The foundation of jacket15 with the same tower on it is jacket15: one interface node stays."""
    whole = read_structure("jacket15")
    base, rest = at_interface(whole)
    assert rest is not None
    sections = [m.section_start for m in rest.members]
    step = (whole.nodes["tower_top"][2] - whole.nodes["tp_top"][2]) / len(sections)

    again = _standing(
        base,
        step * np.arange(len(sections) + 1),
        _members([(s, s) for s in sections], rest.members[0].material),
        None,
    )
    again = again.with_masses((*base.masses, *(m for m in rest.masses)))
    assert again.interface_nodes == whole.interface_nodes
    wanted = undamped_modes(build_system(assemble(whole), clamped(whole)), 5).frequency_hz
    found = undamped_modes(build_system(assemble(again), clamped(again)), 5).frequency_hz
    np.testing.assert_allclose(found, wanted, rtol=1e-9)


def test_stations_are_cones_between_heights(tmp_path: Path) -> None:
    text = "tower: {stations: [[0, 8.0, 0.05], [40, 7.5, 0.04], [120, 6.5, 0.025]]}\n"
    whole = read_structure(written(tmp_path, text))
    tower = [m for m in whole.members if m.part == "tower"]
    assert [(m.section_start.outer_diameter_m, m.section_end.outer_diameter_m) for m in tower] == [
        (8.0, 7.5),
        (7.5, 6.5),
    ]
    assert [whole.nodes[n][2] for n in ("tower_base", "tower_1", "tower_top")] == [30.0, 70.0, 150.0]


def test_links_at_the_interface_follow_the_base() -> None:
    """An interface joint that leads others, and one that follows another, end on the base alike."""
    deck = read_structure(DECK)
    linked = replace(
        deck,
        nodes=dict(deck.nodes) | {"platform": (0.0, 12.0, 31.0)},
        rigid_links=(RigidLink("1", "platform"),),
    )
    based, base = with_base(linked)
    leaders = {link.follower: link.leader for link in based.rigid_links}
    assert base == "tower_base"
    assert leaders["platform"] == leaders["1"] == leaders["6"] == base
    lower, _ = with_base(deck, 25.0)
    assert lower.nodes["tower_base"][2] == 25.0


def elastodyn(folder: Path, *, height: float = 100.0) -> Path:
    """Write an ElastoDyn tower that is a steel tube 6 m wide, wall 40 mm, with 2 % more mass."""
    D, t = 6.0, 0.04
    A = np.pi / 4.0 * (D**2 - (D - 2 * t) ** 2)
    EI = 210e9 * np.pi / 64.0 * (D**4 - (D - 2 * t) ** 4)
    rows = "\n".join(f"{x:.2f} {1.02 * 7850.0 * A} {EI} {EI}" for x in np.linspace(0.0, 1.0, 11))
    (folder / "tower.dat").write_text(
        "-- ELASTODYN TOWER\n  11 NTwInpSt - stations\n 1.0 AdjTwMa - m\n 1.0 AdjFASt - f\n 1.0 AdjSSSt - s\n"
        f"HtFract TMassDen TwFAStif TwSSStif\n(-) (kg/m) (Nm^2) (Nm^2)\n{rows}\n"
    )
    path = folder / "ElastoDyn.dat"
    path.write_text(
        f'-- ELASTODYN\n {30.0 + height} TowerHt - top\n 30.0 TowerBsHt - base\n"tower.dat" TwrFile - tower\n'
    )
    return path


def test_elastodyns_tower_is_its_tube(tmp_path: Path) -> None:
    """A tube by its mass and stiffness has the frequencies of the same tube of denser steel.

    Its area and rotary inertia are 2 % apart: 1e-4 of a bending frequency.
    """
    base, height, sections = read_elastodyn_tower(elastodyn(tmp_path))
    assert (base, height[-1], len(sections)) == (30.0, 100.0, 10)
    by_file = read_structure(written(tmp_path, "tower: {elastodyn: ElastoDyn.dat}\n" + RNA))
    tube = "{outer_diameter_m: 6.0, thickness_m: 0.04}"
    by_tube = read_structure(
        written(
            tmp_path,
            f"tower: {{height_m: 100.0, elements: 10, bottom: {tube}, top: {tube}, "
            "material: {youngs_modulus_pa: 210.0e9, density_kg_m3: 8007.0}}\n" + RNA,
        )
    )
    assert {b.part for b in by_file.beams} == {"tower"}
    np.testing.assert_allclose(frequencies(by_file, 2), frequencies(by_tube, 2), rtol=1e-4)


def test_elastodyns_stiffness_keeps_its_direction(tmp_path: Path) -> None:
    """Stiffer side to side, a tower is as soft fore and aft: upright, a section's y is the global x."""
    elastodyn(tmp_path)
    before = read_structure(written(tmp_path, "tower: {elastodyn: ElastoDyn.dat}\n"))
    file = tmp_path / "tower.dat"
    file.write_text(file.read_text().replace("1.0 AdjSSSt", "1.5 AdjSSSt"))
    after = read_structure(written(tmp_path, "tower: {elastodyn: ElastoDyn.dat}\n"))
    for axis, ratio in ((0, 1.0), (1, 1.5)):
        moved = []
        for structure in (before, after):
            # the tower alone: what it bends beyond its base
            _, tower = at_interface(structure)
            assert tower is not None
            footed = replace(tower, reactions=(Reaction("tower_base"),))
            assembly = assemble(footed, beam_theory="euler-bernoulli")
            top, force = assembly.dofs("tower_top")[axis], np.zeros(assembly.n_dof)
            force[top] = 1e5
            moved.append(static_displacement(build_system(assembly, clamped(footed)), force)[top])
        assert moved[0] / moved[1] == pytest.approx(ratio, rel=1e-6)


def test_twins_and_scenarios_take_it_inline(tmp_path: Path) -> None:
    given = f"structure:\n  foundation: {DECK}\n" + "".join(
        f"  {line}\n" for line in (TOWER + RNA).strip().splitlines()
    )
    whole = read_structure(written(tmp_path, TOWER + RNA))
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(given + "time: {duration_s: 60}\n")
    assert replace(read_scenario(scenario).asset.structure, name="whole") == whole
    twin = tmp_path / "twin.yaml"
    twin.write_text(given + "targets: [{mode: 1, frequency_hz: 0.19, damping_ratio: 0.01}]\n")
    assert replace(read_twin(twin).structure, name="whole") == whole


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (RNA, r"tower: required key is missing.*add 'tower'"),
        (TOWER + "nodes: {a: [0, 0, 0]}\n", r"nodes.*defines this itself.*foundation, interface_nodes"),
        ("tower: {}\n", r"tower.height_m, stations, elastodyn.*in one way"),
        ("tower: {height_m: 90}\n", r"tower.bottom: required key"),
        ("tower: {stations: [[0, 8, 0.05], [0, 7, 0.04]]}\n", r"tower.stations.*rising from 0"),
        ("tower: {stations: [[0, 8, 0.05], [9, 7, 5.0]]}\n", r"tower.stations.1.thickness_m"),
        (TOWER + "interface_nodes: [nowhere]\n", r"no such node.*nowhere"),
        (TOWER.replace("120.0", "-1"), r"tower.height_m"),
        ("tower: {elastodyn: nothing.dat}\n", r"nothing.dat"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_structure(written(tmp_path, text))


def test_a_second_tower_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has a tower already"):
        read_structure(written(tmp_path, TOWER, foundation="jacket15"))
