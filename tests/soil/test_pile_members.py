"""Piles as members: beams on springs along their length, beside the head that stands for them."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from click.testing import CliRunner

from jackettwin.checks import frame_use
from jackettwin.cli.main import main
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import (
    build_system,
    damped_modes,
    nodal_load,
    reduced,
    self_weight,
    state_matrix,
    static_displacement,
    undamped_modes,
    with_inner_piles,
)
from jackettwin.simulate import read_scenario
from jackettwin.simulate.motion.model import build_model
from jackettwin.soil import Foundation, Pile, Support, read_foundation, read_supported
from jackettwin.soil.piles.impedance import head_impedance
from jackettwin.soil.piles.piles import linear_springs
from jackettwin.soil.piles.radiation import Radiation
from jackettwin.structure import (
    PILES,
    Material,
    Member,
    Rayleigh,
    Reaction,
    Section,
    Structure,
    assemble,
    at_interface,
    element_weight,
    section_forces,
)

SUBDYN = Path(__file__).parents[1] / "data" / "subdyn" / "members.json"
JACKET = read_structure("jacket15")
GROUND = read_foundation("jacket15")


def column(height_m: float = 20.0) -> Structure:
    """Return a column on one foot: what stands on a pile, symmetric about its axis."""
    tube = Section(2.0, 0.05)
    member = Member("column", "foot", "top", tube, tube, Material(), "tower")
    nodes = {"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, height_m)}
    return Structure("column", nodes, (member,), reactions=(Reaction("foot"),))


def dynamic_stiffness(structure: Structure, support: Support, s: complex) -> sp.csc_array:
    return sp.csc_array(build_system(assemble(structure), support).pencil.F(s))


@pytest.mark.parametrize("s", [0.0, 1.15j, -0.02 + 4.9j])
def test_the_head_of_a_pile_is_that_of_its_members(s: complex) -> None:
    """Eliminating the pile's members leaves the head's impedance; at rest also that of the lumped head."""
    bare, (piled, support) = column(), GROUND.piled(column())
    F = dynamic_stiffness(piled, support, s)
    assembly = assemble(piled)
    foot = assembly.dofs("foot")
    along = np.concatenate([assembly.dofs(node) for node in piled.buried_nodes])
    head = F[foot][:, foot] - F[foot][:, along] @ spla.spsolve(F[along][:, along], F[along][:, foot])
    free = assemble(bare)
    head = head.toarray() - (free.stiffness + s**2 * free.mass)[free.dofs("foot")][:, free.dofs("foot")]
    wanted = head_impedance(GROUND.pile, GROUND.springs, s, law=GROUND.law)[0]
    scale = np.sqrt(np.abs(np.outer(np.diag(wanted), np.diag(wanted))))
    assert np.abs((head - wanted) / scale).max() < 1e-8
    if s == 0.0:
        lumped = GROUND.head()
        assert np.abs((head - lumped.steel - lumped.soil) / scale).max() < 1e-8


@pytest.mark.parametrize("beam", ["euler-bernoulli", "timoshenko"])
def test_massless_piles_in_elastic_ground_have_the_poles_of_their_heads(beam: str) -> None:
    """Then the static shapes of the lumped head are all that a pile can do: the poles are the same.

    Heads had Euler–Bernoulli piles under every structure: 4e-3 apart under a SubDyn deck of Timoshenko beams.
    """
    jacket = replace(JACKET, beam=beam)
    elastic = replace(GROUND, law=type(GROUND.law)(k0=1.0))
    piled, support = elastic.piled(jacket)
    piled = piled.with_material(PILES, density=0.0)
    heads = replace(elastic.heads(jacket), masses=())
    members = undamped_modes(build_system(assemble(piled), support), 12).omega
    lumped = undamped_modes(build_system(assemble(jacket), heads), 12).omega
    np.testing.assert_allclose(members, lumped, rtol=1e-8)


def test_members_have_the_poles_of_the_exact_head_and_the_lumped_one_nearly() -> None:
    """Newton on the structure over K*(λ) ends on the members' poles; the lumped head is the fast form."""
    piled, support = GROUND.piled(JACKET)
    members = damped_modes(build_system(assemble(piled), support), below_hz=0.85)
    lumped = damped_modes(build_system(assemble(JACKET), GROUND.heads(JACKET)), below_hz=0.85)
    free = assemble(JACKET)
    feet = [free.dofs(node) for node in JACKET.reaction_nodes]

    def F(s: complex) -> sp.csc_array:
        head = head_impedance(GROUND.pile, GROUND.springs, s, law=GROUND.law)[0]
        total = sp.lil_array((free.stiffness + s**2 * free.mass).astype(np.complex128))
        for dofs in feet:
            total[np.ix_(dofs, dofs)] = total[np.ix_(dofs, dofs)].toarray() + head
        return total.tocsc()

    for k in (0, 3):
        pole, x = lumped.eigenvalues[k], lumped.shapes[:, k]
        for _ in range(8):
            slope = (F(pole + 1e-6) - F(pole - 1e-6)) / 2e-6
            x = spla.spsolve(F(pole), slope @ x)
            x /= np.linalg.norm(x)
            pole -= (x @ (F(pole) @ x)) / (x @ (slope @ x))
        assert abs(pole / members.eigenvalues[k] - 1.0) < 1e-8
    # 3e-4 in frequency, 2 % in damping: docs/theory/soil.md
    np.testing.assert_allclose(lumped.frequency_hz, members.frequency_hz, rtol=3e-4)
    np.testing.assert_allclose(lumped.damping_ratio, members.damping_ratio, rtol=0.02)


WAVES = Radiation(density_kg_m3=1900.0, shear_wave_m_s=150.0, frequency_hz=0.8)


@pytest.mark.parametrize("steel", [Rayleigh(), Rayleigh.minimum(0.01, 0.18)], ids=["no steel", "steel"])
@pytest.mark.parametrize("ground", [GROUND, replace(GROUND, radiation=WAVES)], ids=["law", "radiation"])
def test_heads_with_inner_piles_have_the_poles_of_members(ground: Foundation, steel: Rayleigh) -> None:
    """All poles below 1.5 Hz, damping included, and undamped modes (docs/theory/soil.md)."""
    piled, support = ground.piled(JACKET)
    members = build_system(assemble(piled), support, rayleigh=steel)
    heads = with_inner_piles(build_system(assemble(JACKET), ground.heads(JACKET), rayleigh=steel))
    assert heads.pencil.n < 0.6 * members.pencil.n
    wanted, found = (damped_modes(one, below_hz=1.5) for one in (members, heads))
    assert wanted.eigenvalues.size > 8
    np.testing.assert_allclose(found.eigenvalues, wanted.eigenvalues, rtol=1e-8)
    at_rest = (undamped_modes(one, 12).omega for one in (members, heads))
    np.testing.assert_allclose(*at_rest, rtol=1e-8)


def test_frequencies_of_subdyn() -> None:
    """SubDyn (OpenFAST 5) on the deck that `export --pile-model members` writes, forty modes.

    Seven figures are printed: half of the last is 5e-7 of a mantissa of one.
    """
    recorded = json.loads(SUBDYN.read_text())["jacket15_piles"]
    base, _ = at_interface(JACKET)
    piled, support = GROUND.piled(replace(base, rotary_inertia=True))
    found = undamped_modes(build_system(assemble(piled), support), 40).frequency_hz
    np.testing.assert_allclose(found, recorded["frequency_hz"], rtol=6e-7)


def test_a_beam_on_an_elastic_foundation() -> None:
    """Hetényi (1946): y = 2Hβ/k·e^(−βz)·cos βz and M = H/β·e^(−βz)·sin βz of a long beam under H at its end.

    Nodal springs lumped by Simpson's rule at half a metre: 1e-3 of the largest. Between its parabolas a node
    stands for 4/3 of its length, which adds p h²/6 to the moment at it: at most 1.04 (βh)² of the largest.
    """
    k, H = 5.0e7, 1.0e6
    pile = Pile(60.0, 2.0, 0.05, element_m=0.5)
    springs = linear_springs(pile, lateral=lambda z: np.full_like(z, k), axial=lambda z: np.full_like(z, k))
    springs = replace(springs, torsional=np.full_like(springs.lateral, 1e6))  # else a single pile turns
    piled, support = Foundation(pile, springs).piled(column())
    assembly = assemble(piled)
    u = static_displacement(build_system(assembly, support), nodal_load(assembly, {"foot": (H, 0.0, 0.0)}))
    EI = 210e9 * assembly.mesh.properties.I[-1]
    beta = (k / (4.0 * EI)) ** 0.25
    nodes = ("foot", *piled.buried_nodes)
    z = -np.array([piled.nodes[node][2] for node in nodes])
    moved = np.array([u[assembly.dofs(node)[0]] for node in nodes])
    wanted = 2.0 * H * beta / k * np.exp(-beta * z) * np.cos(beta * z)
    np.testing.assert_allclose(moved, wanted, atol=1e-3 * wanted[0])
    mine = np.array([piled.members[m].part == PILES for m in assembly.mesh.member])
    bending = section_forces(assembly, u).bending[mine]
    moment = H / beta * np.exp(-beta * z) * np.abs(np.sin(beta * z))
    np.testing.assert_allclose(bending[::2, 0], moment[:-1:2], atol=1e-3 * moment.max())
    np.testing.assert_allclose(bending[:, 0], moment[:-1], atol=1.05 * (0.5 * beta) ** 2 * moment.max())


def test_a_simulation_moves_the_piles() -> None:
    """The reduced coordinates have the poles of the full model, and shapes that reach down the piles."""
    piled, support = GROUND.piled(JACKET)
    system = build_system(assemble(piled), support)
    full, small = damped_modes(system, below_hz=0.85), reduced(system, below_hz=3.0)
    poles = np.linalg.eigvals(state_matrix(small.pencil))
    poles = poles[(poles.imag > 0.0) & (np.abs(poles) < 2.0 * np.pi * 0.85)]
    poles = poles[np.argsort(np.abs(poles))]
    # feet and modes as over heads, not the hundreds of DOFs along the piles, nor shapes to make up for them
    over_heads = build_system(assemble(JACKET), GROUND.heads(JACKET))
    assert small.n == reduced(over_heads, below_hz=3.0).n
    np.testing.assert_allclose(np.abs(poles), np.abs(full.eigenvalues), rtol=5e-4)
    np.testing.assert_allclose(-poles.real / np.abs(poles), full.damping_ratio, rtol=0.02)
    below = small.basis[system.assembly.dofs("foot_1/pile_4")]
    assert np.abs(below).max() > 0.1 * np.abs(small.basis[system.assembly.dofs("foot_1")]).max()


def test_a_scenario_takes_piles_as_members(tmp_path: Path) -> None:
    path = tmp_path / "scenario.yaml"
    text = "structure: jacket15\nfoundation: jacket15\npile_model: members\ntime: {duration_s: 60}\n"
    path.write_text(text)
    scenario = read_scenario(path)
    assert scenario.asset.structure.buried_nodes
    assert build_model(scenario).reduced.n < 80
    path.write_text(text.replace("foundation: jacket15", "support: pinned"))
    with pytest.raises(InputError, match=r"pile_model.*members, with a foundation"):
        read_scenario(path)


def test_ground_holds_a_pile_at_each_node() -> None:
    """No column of a check is longer than an element of the pile, and its head is no joint of tubes."""
    piled, support = GROUND.piled(JACKET)
    assembly = assemble(piled)
    u = static_displacement(build_system(assembly, support), self_weight(assembly))
    use = frame_use(assembly, u, along=element_weight(assembly))
    own = [one for one in use.members if one.part == PILES]
    assert len(own) == 4 * (len(GROUND.springs.node_depth) - 1)
    assert all(one.buckling.K == 1.0 and one.buckling.L < 0.51 * GROUND.pile.outer_diameter_m for one in own)
    assert not any("pile" in one.chord + one.brace for one in use.joints)
    # the head carries a leg, the tip next to nothing
    axial = [one.worst.end_forces[0, 0] for one in own[: len(own) // 4]]
    assert axial[0] < -5e6
    assert abs(axial[-1]) < 0.2 * abs(axial[0])


def test_gravity_leaves_piles_to_the_ground() -> None:
    """The P-Δ of the weight is the same over members and heads: 1e-4 is what the heads differ by anyway."""
    piled, support = GROUND.piled(JACKET)
    members = undamped_modes(build_system(assemble(piled, gravity=True), support), 5).omega
    heads = GROUND.heads(JACKET)
    lumped = undamped_modes(build_system(assemble(JACKET, gravity=True), heads), 5).omega
    np.testing.assert_allclose(members, lumped, rtol=1e-4)
    weight = assemble(piled, gravity=True).weight
    assert weight is not None
    assert not any(weight.members[m.name].any() for m in piled.members if m.part == PILES)
    assert weight.members["leg_1_bay_1"].max() < -1e6


def test_a_foundation_file_says_how_its_piles_stand(tmp_path: Path) -> None:
    text = (
        "pile: {length_m: 60, outer_diameter_m: 2.8, thickness_m: 0.06}\n"
        "soil: {linear: {lateral_n_m3: 1e7, axial_n_m2: 1e8}}\n"
    )
    path = tmp_path / "piles.yaml"
    for said, asked, members in (
        ("", None, False),
        ("pile_model: members", None, True),
        ("pile_model: members", "head", False),
        ("", "members", True),
    ):
        path.write_text(text + said)
        structure, _ = read_supported(path, JACKET, pile_model=asked)
        assert bool(structure.buried_nodes) == members
    path.write_text(text + "pile_model: beams")
    with pytest.raises(InputError, match="pile_model"):
        read_supported(path, JACKET)


@pytest.mark.parametrize("command", ["modes", "check", "view", "export"])
def test_commands_take_piles_as_members(command: str, tmp_path: Path) -> None:
    out = ["--out", str(tmp_path / ("deck.dat" if command == "export" else "page.html"))]
    more = {"modes": ["--number", "3"], "check": [], "view": ["--modes", "2", *out], "export": out}[command]
    asked = [command, "jacket15", "--support", "jacket15", "--pile-model", "members", "--json", *more]
    answer = CliRunner().invoke(main, asked)
    assert answer.exit_code == 0, answer.output
    document = json.loads(answer.stdout)
    if command == "modes":
        labels = [(row["mode"], row["label"]) for row in document["modes"]]
        assert labels == [(1, "side_side_1"), (2, "fore_aft_1"), (3, "torsion_1")]
    if command == "check":
        assert {row["part"] for row in document["members"]} == {"jacket", "transition_piece", "tower", PILES}
    asked[3] = "pinned"
    refused = CliRunner().invoke(main, asked)
    assert refused.exit_code == 2
    assert "pile_model" in refused.output
