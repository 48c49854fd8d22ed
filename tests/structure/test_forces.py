"""Section forces against statics of a cantilever and the balance of the reference jacket."""

from pathlib import Path

import numpy as np
import pytest
import scipy.sparse.linalg as spla

from jackettwin.decks import read_structure
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.forces import element_weight, section_forces, von_mises_stress
from jackettwin.structure.model import STEEL, Member, Reaction

EXAMPLES = Path(__file__).parents[2] / "examples"
L, D, T = 10.0, 1.0, 0.03


def static(assembly, load: np.ndarray, held: np.ndarray) -> np.ndarray:
    free = np.setdiff1d(np.arange(assembly.n_dof), held)
    u = np.zeros(assembly.n_dof)
    u[free] = spla.spsolve(assembly.stiffness[free][:, free].tocsc(), load[free])
    return u


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.6, 0.48, 0.64)])
def test_cantilever_under_a_tip_load(direction: tuple[float, float, float]) -> None:
    """N, V, T constant; M = V (L − x), whichever way the cantilever points."""
    tube = Section(D, T)
    tip = tuple(float(L * c) for c in direction)
    structure = Structure(
        "c",
        {"a": (0.0, 0.0, 0.0), "b": tip},
        (Member("m", "a", "b", tube, tube, STEEL),),
        reactions=(Reaction("a"),),
    )
    assembly = assemble(structure, subdivide=4)
    axis, across, twist = np.array(direction), assembly.mesh.axes[0, 1], 3e5
    load = np.zeros(assembly.n_dof)
    load[assembly.dofs("b")] = np.concatenate([2e6 * axis + 1e5 * across, twist * axis])
    forces = section_forces(assembly, static(assembly, load, assembly.dofs("a")))
    np.testing.assert_allclose(forces.axial, 2e6, rtol=1e-6)
    np.testing.assert_allclose(forces.shear, 1e5, rtol=1e-6)
    np.testing.assert_allclose(forces.torsion, twist, rtol=1e-6)
    x = np.array([[i, i + 1] for i in range(4)]) * L / 4
    np.testing.assert_allclose(forces.bending, 1e5 * (L - x), rtol=1e-6, atol=1.0)
    A, I = (np.pi / 4 * (D**2 - (D - 2 * T) ** 2), np.pi / 64 * (D**4 - (D - 2 * T) ** 4))  # noqa: E741
    sigma, tau = 2e6 / A + 1e5 * L * D / 2 / I, twist * D / 2 / (2 * I) + 2e5 / A
    stress = von_mises_stress(assembly, forces)
    assert stress[0, 0] == pytest.approx(np.sqrt(sigma**2 + 3 * tau**2), rel=1e-6)


def test_legs_and_braces_of_the_jacket_carry_its_weight() -> None:
    """Vertical components of the member forces at the feet balance the load above."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    load = np.asarray(assembly.mass @ np.tile([0, 0, -9.80665, 0, 0, 0], assembly.n_dof // 6))
    held = np.concatenate([assembly.dofs(foot)[:3] for foot in structure.reaction_nodes])
    forces = section_forces(assembly, static(assembly, load, held))
    mesh = assembly.mesh
    vertical = 0.0
    feet = [mesh.node_names.index(foot) for foot in structure.reaction_nodes]
    for side, nodes in ((0, mesh.start), (1, mesh.end)):
        at = np.isin(nodes, feet)
        local = np.stack([forces.axial, forces.shear_y, forces.shear_z], axis=-1)[at, side]
        vertical += (1 - 2 * side) * np.einsum("ei,eij->ej", local, mesh.axes[at])[:, 2].sum()
    above = load.reshape(-1, 6)[:, 2].sum() - sum(
        load[assembly.dofs(foot)][2] for foot in structure.reaction_nodes
    )
    assert vertical == pytest.approx(above, rel=1e-6)


def test_many_displacements_at_once() -> None:
    assembly = assemble(read_structure("jacket15"))
    u = np.random.default_rng(0).standard_normal((2, 3, assembly.n_dof))
    many, one = section_forces(assembly, u), section_forces(assembly, u[1, 2])
    np.testing.assert_allclose(many.bending_y[1, 2], one.bending_y, rtol=1e-9)


def beam_of(direction: tuple[float, float, float], *, pieces: int, both_ends: bool):
    """A tube under its own weight, held at one end or both: assembly, weight per metre, section forces."""
    tube = Section(D, T)
    tip = tuple(float(L * c) for c in direction)
    structure = Structure(
        "beam", {"a": (0.0, 0.0, 0.0), "b": tip}, (Member("m", "a", "b", tube, tube, STEEL),)
    )
    assembly = assemble(structure, subdivide=pieces)
    load = np.asarray(assembly.mass @ np.tile([0, 0, -9.80665, 0, 0, 0], assembly.n_dof // 6))
    held = np.concatenate([assembly.dofs(node) for node in (("a", "b") if both_ends else ("a",))])
    w = 9.80665 * 7850.0 * np.pi / 4 * (D**2 - (D - 2 * T) ** 2)
    return w, section_forces(assembly, static(assembly, load, held), along=element_weight(assembly))


@pytest.mark.parametrize("pieces", [1, 2, 5])
def test_a_beam_under_its_own_weight_however_few_its_elements(pieces: int) -> None:
    """Cantilever: V = wL, M = wL²/2 at the root, none at the tip; clamped: wL²/12, wL²/24 in the middle."""
    w, cantilever = beam_of((1.0, 0.0, 0.0), pieces=pieces, both_ends=False)
    x = np.array([[i, i + 1] for i in range(pieces)]) * L / pieces
    np.testing.assert_allclose(cantilever.shear, w * (L - x), atol=1e-6 * w * L)
    np.testing.assert_allclose(cantilever.bending, 0.5 * w * (L - x) ** 2, atol=1e-6 * w * L**2)
    if pieces < 5:  # a clamped beam of one element has no DOF left: its ends carry everything
        w, clamped = beam_of((0.0, 1.0, 0.0), pieces=pieces, both_ends=True)
        moment = w * np.array([[L**2 / 12, L**2 / 12]] if pieces == 1 else [[L**2 / 12, L**2 / 24]] * 2)
        moment[1:] = moment[1:, ::-1]
        np.testing.assert_allclose(clamped.bending, moment, rtol=1e-6)


def test_the_foot_of_a_column_carries_all_of_it() -> None:
    """N = −wL at the foot of one element, nothing at its top; inclined, the weight splits as it must."""
    w, column = beam_of((0.0, 0.0, 1.0), pieces=1, both_ends=False)
    np.testing.assert_allclose(column.axial[0], [-w * L, 0.0], atol=1e-6 * w * L)
    w, leaning = beam_of((0.6, 0.0, 0.8), pieces=1, both_ends=False)
    np.testing.assert_allclose(leaning.axial[0], [-0.8 * w * L, 0.0], atol=1e-6 * w * L)
    np.testing.assert_allclose(leaning.bending[0], [0.3 * w * L**2, 0.0], atol=1e-6 * w * L**2)


@pytest.mark.parametrize(
    "source", ["jacket15", EXAMPLES / "three_leg_jacket.yaml"], ids=["jacket15", "three legs"]
)
@pytest.mark.parametrize("subdivide", [1, 3])
def test_every_node_is_in_balance(source: str | Path, subdivide: int) -> None:
    """Weight along every member: what members pull at a free node is the weight of the masses there."""
    structure = read_structure(source)
    assembly = assemble(structure, subdivide=subdivide)
    load = np.asarray(assembly.mass @ np.tile([0, 0, -9.80665, 0, 0, 0], assembly.n_dof // 6))
    held = np.concatenate([assembly.dofs(foot) for foot in structure.reaction_nodes])
    forces = section_forces(assembly, static(assembly, load, held), along=element_weight(assembly))
    mesh = assembly.mesh
    pull = np.zeros((len(mesh.node_names), 6))
    six = np.stack(list(forces), axis=-1)
    for side, nodes in ((0, mesh.start), (1, mesh.end)):
        out = np.einsum("epi,eij->epj", six[:, side].reshape(-1, 2, 3), mesh.axes).reshape(-1, 6)
        np.add.at(pull, nodes, (1 - 2 * side) * out)
    pull[[mesh.node_names.index(foot) for foot in structure.reaction_nodes]] = 0.0
    (rna,) = structure.masses
    wanted = np.zeros_like(pull)
    x, y, _ = rna.cg_offset_m
    top = mesh.node_names.index(rna.node)
    wanted[top, 2:5] = -9.80665 * rna.mass_kg * np.array([1.0, y, -x])
    np.testing.assert_allclose(pull + wanted, 0.0, atol=1e-6 * np.abs(load).sum())
