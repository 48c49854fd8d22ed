"""Beam element: closed forms of a cantilever, invariants, and the thesis's Table 3.1."""

import numpy as np
import pytest
import scipy.linalg as la

from jackettwin.structure import Material, Section, Structure, assemble, beam
from jackettwin.structure.model import Member, Reaction

L, E, RHO, G = 10.0, 210e9, 7850.0, 81e9
GYRATION = 0.19514  # √(I/A) that gives the analytic row of Table 3.1


def cantilever(direction: np.ndarray, n: int = 10) -> Structure:
    """A thin-enough tube with the table's radius of gyration, clamped at the origin, along ``direction``."""
    D = 0.6
    inner = np.sqrt(16.0 * GYRATION**2 - D**2)  # √(I/A) = √(D² + d²)/4
    section = Section(D, 0.5 * (D - inner))
    points = {f"n{k}": tuple(float(v) for v in direction * L * k / n) for k in range(n + 1)}
    members = tuple(
        Member(f"m{k}", f"n{k}", f"n{k + 1}", section, section, Material(E, G, RHO)) for k in range(n)
    )
    return Structure("cantilever", points, members, reactions=(Reaction("n0"),))


def frequencies(structure: Structure, **options: object) -> np.ndarray:
    assembly = assemble(structure, **options)  # type: ignore[arg-type]
    free = np.setdiff1d(np.arange(assembly.n_dof), assembly.dofs("n0"))
    K, M = (m.toarray()[np.ix_(free, free)] for m in (assembly.stiffness, assembly.mass))
    return np.sqrt(la.eigh(K, M, eigvals_only=True))


def closed_forms() -> dict[str, np.ndarray]:
    beta_l = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073])
    odd = (2 * np.arange(1, 3) - 1) * np.pi / (2 * L)
    return {
        "bending": beta_l**2 / L**2 * GYRATION * np.sqrt(E / RHO),
        "torsion": odd * np.sqrt(G / RHO),
        "axial": odd * np.sqrt(E / RHO),
    }


def test_closed_forms_are_the_analytic_row_of_table_3_1() -> None:
    exact = closed_forms()
    # printed to three decimals
    assert exact["bending"][0] == pytest.approx(35.487, abs=6e-4)
    assert exact["torsion"][0] == pytest.approx(504.577, abs=6e-4)
    assert exact["axial"][0] == pytest.approx(812.446, abs=6e-4)


def test_ten_modes_against_closed_forms() -> None:
    omega, exact = frequencies(cantilever(np.array([0.6, 0.0, 0.8]))), closed_forms()

    def error(value: float) -> float:
        return float(np.min(np.abs(omega - value)) / value)

    # ten elements, consistent mass: the errors known for this mesh, each with 1 % slack
    for value, known in zip(exact["bending"], (1e-6, 3.3e-5, 2.55e-4, 9.53e-4), strict=True):
        assert error(value) <= max(1.01 * known, 1e-5)
    for kind in ("torsion", "axial"):
        assert error(exact[kind][0]) <= 1.04e-3
        assert error(exact[kind][1]) <= 1e-2  # (2n−1)² times the first mode's error
    # bending comes in pairs; together with torsion and axial these are the first ten modes
    first = np.sort(
        np.concatenate([np.repeat(exact["bending"], 2), exact["torsion"][:1], exact["axial"][:1]])
    )
    np.testing.assert_allclose(omega[:10], first, rtol=1.1e-3)


@pytest.mark.parametrize(
    "direction", [(0, 0, 1), (0, 0, -1), (0, 1, 0), (1, 1, 1), (1e-4, 0, 1), (-0.3, 0.2, 0.9)]
)
@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_frequencies_do_not_depend_on_orientation(direction: tuple[float, ...], theory: str) -> None:
    unit = np.array(direction) / np.linalg.norm(direction)
    along_x = frequencies(cantilever(np.array([1.0, 0.0, 0.0])), beam_theory=theory)
    turned = frequencies(cantilever(unit), beam_theory=theory)
    np.testing.assert_allclose(turned, along_x, rtol=1e-9)


def some_elements(Phi: float = 0.0) -> beam.BeamProperties:
    one = np.ones(3)
    return beam.BeamProperties(
        E=210e9 * one, G=81e9 * one, rho=7850 * one, A=0.1 * one, I=0.01 * one, J=0.02 * one,
        L=np.array([1.0, 5.0, 20.0]), Phi=Phi * one,
    )  # fmt: skip


@pytest.mark.parametrize("Phi", [0.0, 0.7])
def test_rigid_motion_stores_no_energy_and_has_the_rigid_mass(Phi: float) -> None:
    p = some_elements(Phi)
    K, M = beam.stiffness(p), beam.mass(p)
    for e, length in enumerate(p.L):
        rotation = np.zeros(12)
        rotation[[5, 7, 11]] = 1.0, length, 1.0  # unit rotation about z at the first node
        assert np.abs(K[e] @ rotation).max() < 1e-6 * np.abs(K[e]).max()
        translation = np.tile([1.0, 0, 0, 0, 0, 0], 2)
        assert translation @ M[e] @ translation == pytest.approx(7850 * 0.1 * length)
        # ∫ρA x² dx of a rod turning about its end; exact because the shape functions hold rigid rotation
        assert rotation @ M[e] @ rotation == pytest.approx(7850 * 0.1 * length**3 / 3)


def test_timoshenko_without_shear_is_euler_bernoulli() -> None:
    p, q = some_elements(0.0), some_elements(1e-9)
    np.testing.assert_allclose(beam.stiffness(q), beam.stiffness(p), rtol=1e-8, atol=1e-8 * 210e9)


def test_timoshenko_cantilever_tip_deflection() -> None:
    """PL³/3EI + PL/κGA, exact for one element."""
    s = cantilever(np.array([1.0, 0.0, 0.0]), n=1)
    a = assemble(s, beam_theory="timoshenko")
    free = a.dofs("n1")
    p = a.mesh.properties
    flexibility = np.linalg.inv(a.stiffness.toarray()[np.ix_(free, free)])[1, 1]
    kappa = 12 * E * p.I[0] / (p.Phi[0] * G * p.A[0] * L**2)
    assert flexibility == pytest.approx(L**3 / (3 * E * p.I[0]) + L / (kappa * G * p.A[0]), rel=1e-9)


def test_geometric_stiffness_finds_the_euler_load() -> None:
    """Cantilever buckles at π²EI/4L² (closed form); ten cubic elements are within 1e-5 of it."""
    s = cantilever(np.array([0.0, 0.0, 1.0]))
    a = assemble(s)
    p = a.mesh.properties
    Kg = np.zeros((a.n_dof, a.n_dof))
    for dofs, block in zip(
        a.mesh.element_dofs(),
        beam.to_global(beam.geometric_stiffness(-np.ones(10), p), a.mesh.axes),
        strict=True,
    ):
        Kg[np.ix_(dofs, dofs)] += block
    free = np.setdiff1d(np.arange(a.n_dof), a.dofs("n0"))
    inverse = la.eigh(-Kg[np.ix_(free, free)], a.stiffness.toarray()[np.ix_(free, free)], eigvals_only=True)
    assert 1.0 / inverse.max() == pytest.approx(np.pi**2 * E * p.I[0] / (4 * L**2), rel=1e-5)


def test_compression_softens_torsion_until_it_buckles() -> None:
    """Torsional buckling of a bar (Wagner; closed form): P = GJ·A/I_p, which for a tube is G·A.

    Tension stiffens by as much as compression softens.
    """
    p = assemble(cantilever(np.array([0.0, 0.0, 1.0]))).mesh.properties
    twist = np.zeros(12)
    twist[9] = 1.0
    elastic = twist @ beam.stiffness(p)[0] @ twist
    assert elastic == pytest.approx(p.G[0] * p.J[0] / p.L[0])
    buckling = p.G * p.A  # J = I_p of a tube
    softened = twist @ beam.geometric_stiffness(-buckling, p)[0] @ twist
    assert softened == pytest.approx(-elastic)
    assert twist @ beam.geometric_stiffness(buckling, p)[0] @ twist == pytest.approx(elastic)


def test_shape_functions_interpolate_a_rigid_motion_and_a_cubic() -> None:
    N = beam.translation_shape(0.3, 5.0)
    rotation = np.zeros(12)
    rotation[[5, 7, 11]] = 1.0, 5.0, 1.0
    assert (N @ rotation)[1] == pytest.approx(1.5)
    cubic = np.zeros(12)
    cubic[[7, 11]] = 125.0, 75.0  # v = x³ on 0…5
    assert (N @ cubic)[1] == pytest.approx(1.5**3)
