"""Damped poles of the full model against dense methods: none missing, none extra, each to 1e-8."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator
from tests.response.conftest import monopile_structure, on_law

from jackettwin.decks import read_structure
from jackettwin.response.modes import poles
from jackettwin.response.modes.modal import DampedModes, damped_modes, undamped_modes
from jackettwin.response.state import state_matrix
from jackettwin.response.system import Pencil, System, build_system
from jackettwin.soil.laws.viscoelastic import Law, Prony, Springpot, kelvin_voigt, maxwell_3, prony_fit, zener
from jackettwin.soil.support import Spring, Support, on_translations
from jackettwin.structure import Rayleigh, assemble
from jackettwin.structure.model import PointMass

BELOW_HZ = 3.0
RAYLEIGH = Rayleigh.minimum(0.01, 0.183)
LAWS: dict[str, Law] = {
    "kelvin-voigt": kelvin_voigt(2.5e9, 7.6e8),
    "kelvin-voigt locked": kelvin_voigt(1.1e8, 1e12),
    "zener": zener(2.62e9, 8.65e8, 9.99e9),
    "zener locked": zener(2.62e9, 1e12, 9.99e9),
    "maxwell-3": maxwell_3(2.5e9, 0.2, 0.183),
    "springpot": Springpot(2.5e9, 0.1, 1.15),
}


def dense(pencil: Pencil) -> Pencil:
    groups = tuple(replace(group, S=group.S.toarray()) for group in pencil.groups)
    return Pencil(pencil.M.toarray(), pencil.K.toarray(), pencil.rayleigh, groups)


def trace_newton(pencil: Pencil, value: complex) -> complex:
    """Newton on det F(λ), λ ← λ − 1/tr(F⁻¹F'): another formula than the one under test."""
    for _ in range(4):
        value -= 1.0 / np.trace(np.linalg.solve(pencil.F(value), pencil.dF(value)))
    return complex(value)


def dense_poles(pencil: Pencil) -> np.ndarray:
    values = np.linalg.eigvals(state_matrix(pencil))
    return values[np.abs(values) <= 2.0 * pi * BELOW_HZ]


def zeros_above_the_real_axis(pencil: Pencil, low: float, high: float, n: int = 80) -> int:
    """Count zeros of det F with low < |λ| < high, 0.45π < arg λ < 0.99π by the argument principle.

    F has no poles there: the springpot's branch cut lies on the negative real axis. The edge lies right of
    the imaginary axis, where there are no zeros, to stay clear of the lightly damped ones.
    """
    right = np.exp(0.45j * pi)
    turn = np.linspace(0.45 * pi, 0.99 * pi, n)
    outer, inner = high * np.exp(1j * turn), low * np.exp(1j * turn[::-1])
    ray = np.geomspace(high, low, n)
    contour = np.concatenate([outer, ray * np.exp(0.99j * pi), inner, right * ray[::-1]])
    signs = np.array([np.linalg.slogdet(pencil.F(s))[0] for s in contour])
    steps = np.angle(signs[1:] / signs[:-1])
    assert np.abs(steps).max() < 0.5 * pi  # fine enough not to lose a turn
    return round(float(steps.sum() / (2.0 * pi)))


@pytest.fixture(params=["jacket15", "deck", "monopile"])
def assembly(request: pytest.FixtureRequest):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("name", [name for name in LAWS if name != "springpot"])
def test_none_missing_none_extra_and_each_to_1e8(assembly, name: str) -> None:
    system = build_system(assembly, on_law(assembly.structure, LAWS[name]), rayleigh=RAYLEIGH)
    found, full = damped_modes(system, below_hz=BELOW_HZ), dense(system.pencil)
    values = dense_poles(full)
    # dense eig splits multiple real poles into pairs with |Im| up to 1e-6 |λ| at c = 1e12
    oscillating = values[values.imag > 1e-5 * np.abs(values)]
    real = values[np.abs(values.imag) <= 1e-5 * np.abs(values)]
    assert found.eigenvalues.size == oscillating.size
    assert found.real_poles.size == real.size
    refined = np.array([trace_newton(full, value) for value in oscillating])
    refined = refined[np.argsort(np.abs(refined))]
    np.testing.assert_allclose(found.eigenvalues, refined, rtol=1e-8)
    # dense eig itself knows the slow, sixfold real poles −k/c of a locked damper to 4e-5 or 2e-4, as LAPACK
    # rounds: it counts them, and F itself says whether they are poles
    np.testing.assert_allclose(np.sort(found.real_poles), np.sort(real.real), rtol=1e-3)
    for value in found.real_poles:
        assert abs(newton_step(full, value)) < 1e-6 * abs(value)
    assert_eigenpairs(system, found)


def newton_step(pencil: Pencil, value: float) -> float:
    """Return the Newton step to the next real pole, on the vector nearest to the kernel of F."""
    F, slope = pencil.F(complex(value)).real, pencil.dF(complex(value)).real
    values, vectors = np.linalg.eigh(F)
    x = vectors[:, np.argmin(np.abs(values))]
    return float(x @ F @ x / (x @ slope @ x))


def assert_eigenpairs(system: System, modes: DampedModes) -> None:
    """F(λ)x vanishes beside its largest term."""
    for value, shape in zip(modes.eigenvalues, modes.shapes.T, strict=True):
        x = shape[system.free]
        F = system.pencil.F(complex(value))
        assert np.linalg.norm(F @ x) < 1e-9 * np.linalg.norm(abs(F) @ abs(x))


@pytest.mark.parametrize("alpha", [0.06, 0.8])
def test_springpot_poles_are_all_there(assembly, alpha: float) -> None:
    """As many as the argument principle counts, each at rest under Newton on the determinant."""
    law = Springpot(2.5e9, alpha, 1.15)
    system = build_system(assembly, on_law(assembly.structure, law), rayleigh=RAYLEIGH)
    found, full = damped_modes(system, below_hz=BELOW_HZ), dense(system.pencil)
    refined = np.array([trace_newton(full, value) for value in found.eigenvalues])
    np.testing.assert_allclose(found.eigenvalues, refined, rtol=1e-8)
    low, high = 0.2 * np.abs(refined).min(), 0.5 * np.abs(refined[2:4]).sum()
    inside = np.abs(refined) < high
    assert zeros_above_the_real_axis(full, low, high) == inside.sum() == 3
    assert found.real_poles.size == 0


@pytest.mark.parametrize(("alpha", "k"), [(0.03, 5e9), (0.3, 3e8), (0.7, 3e8), (0.7, 5e9)])
def test_a_start_of_one_branch_finds_what_many_do(assembly, alpha: float, k: float, monkeypatch) -> None:
    """Stiff and soft ground, up to the third bending modes: the same poles, and none twice."""

    def many(row: np.ndarray, radius: float) -> Prony:
        return prony_fit(law, 1e-4 * radius, 1e3 * radius)

    law = Springpot(k, alpha, 1.15)
    pencil = build_system(assembly, on_law(assembly.structure, law), rayleigh=RAYLEIGH).pencil
    found = [value for value, _ in poles.poles_below(pencil, 2.0 * pi * 1.5)]
    monkeypatch.setattr(poles, "one_branch", many)
    fine = [value for value, _ in poles.poles_below(pencil, 2.0 * pi * 1.5)]
    np.testing.assert_allclose(found, fine, rtol=1e-7)


@pytest.mark.parametrize("below_hz", [1.5, 3.0])
@pytest.mark.parametrize("alpha", [0.1, 0.4])
def test_a_springpot_costs_what_maxwell_branches_do(jacket15, alpha, below_hz, monkeypatch) -> None:
    """Factorisations of the whole system and solutions of Arnoldi's iteration are no more."""
    counted = {"factorised": 0, "solved": 0}

    def factorised(F):
        counted["factorised"] += 1
        return by_superlu(F)

    def shifted_inverse(pencil, sigma):
        operator, size = inverse(pencil, sigma)

        def solve(b):
            counted["solved"] += 1
            return operator.matvec(b)

        return LinearOperator((size, size), matvec=solve, dtype=np.float64), size

    by_superlu, inverse = poles.factorised, poles.shifted_inverse
    monkeypatch.setattr(poles, "factorised", factorised)
    monkeypatch.setattr(poles, "shifted_inverse", shifted_inverse)
    costs = []
    for law in (maxwell_3(2.5e9, 0.2, 0.183), Springpot(2.5e9, alpha, 1.15)):
        counted.update(factorised=0, solved=0)
        system = build_system(jacket15, on_law(jacket15.structure, law), rayleigh=RAYLEIGH)
        damped_modes(system, below_hz=below_hz)
        costs.append(tuple(counted.values()))
    assert costs[1][0] <= 1.1 * costs[0][0]
    assert costs[1][1] <= 1.1 * costs[0][1]


def test_a_springpot_may_have_no_pole_below_the_limit(monopile) -> None:
    system = build_system(monopile, on_law(monopile.structure, LAWS["springpot"]))
    found = damped_modes(system, below_hz=0.01)
    assert found.eigenvalues.size == found.real_poles.size == 0


def test_springpot_with_exponent_zero_is_a_spring(monopile) -> None:
    systems = [
        build_system(monopile, on_law(monopile.structure, law), rayleigh=RAYLEIGH)
        for law in (Springpot(2.5e9, 0.0, 1.0), Prony(k0=2.5e9))
    ]
    a, b = (damped_modes(system, below_hz=BELOW_HZ).eigenvalues for system in systems)
    np.testing.assert_allclose(a, b, rtol=1e-10)


@pytest.mark.parametrize(
    ("name", "subdivide"),
    [("kelvin-voigt", 1), ("kelvin-voigt locked", 2), ("maxwell-3", 1), ("springpot", 1), ("springpot", 2)],
)
def test_double_poles_of_a_symmetric_structure_come_twice(name: str, subdivide: int) -> None:
    """A square jacket without its RNA: fore-aft and side-side are the same to the last digit."""
    structure = read_structure("jacket15").with_masses(())
    system = build_system(
        assemble(structure, subdivide=subdivide), on_translations(structure, LAWS[name]), rayleigh=RAYLEIGH
    )
    found = damped_modes(system, below_hz=1.2)
    # rank: no vector may be given twice
    assert (
        np.linalg.matrix_rank(found.shapes, tol=1e-6 * np.linalg.norm(found.shapes, 2))
        == found.shapes.shape[1]
    )
    assert found.eigenvalues[1] == pytest.approx(found.eigenvalues[0], rel=1e-9)
    assert abs(found.eigenvalues[2] - found.eigenvalues[1]) > 0.1 * abs(found.eigenvalues[1])
    if subdivide == 1 and name != "springpot":
        values = np.linalg.eigvals(state_matrix(system.pencil))
        values = values[(values.imag > 1e-5 * np.abs(values)) & (np.abs(values) < 2.0 * pi * 1.2)]
        assert found.eigenvalues.size == values.size


def test_many_equal_oscillators_are_all_found() -> None:
    """Multiplicity far beyond two: forty equal masses on equal Zener feet, side by side."""
    import scipy.sparse as sp

    from jackettwin.response.modes.poles import poles_below
    from jackettwin.response.system import Group

    n, law = 80, zener(1.48e6, 5e4, 3.1096e5)
    eye = sp.eye_array(n, format="csc")
    pencil = Pencil(1.12e6 * eye, 0.0 * eye, Rayleigh(), (Group(law, eye, np.arange(n)),))
    pairs = poles_below(pencil, 10.0)
    values = np.array([value for value, _ in pairs])
    assert np.sum(values.imag > 1e-9) == n  # 80 oscillating …
    assert np.sum(np.abs(values.imag) <= 1e-9) == n  # … and 80 relaxation poles, size 240 < dense limit


def test_nearly_equal_poles_do_not_fall_on_one_another() -> None:
    """Two directions that differ by 1e-9, 1e-7, 1e-5 in stiffness keep two poles."""
    structure = monopile_structure(60).with_masses(())  # 366 DOFs: the sparse way
    assembly = assemble(structure)
    for split in (1e-9, 1e-7, 1e-5, 1e-4):
        matrix = np.diag([1.0, 1.0 + split, 1.0, 400.0, 400.0 * (1.0 + split), 400.0])
        support = Support(springs=(Spring("n0", matrix, LAWS["zener"]),))
        found = damped_modes(build_system(assembly, support, rayleigh=RAYLEIGH), below_hz=0.5)
        assert found.eigenvalues.size == 2
        assert np.linalg.matrix_rank(found.shapes, tol=1e-3) == 2
        gap = abs(found.eigenvalues[1] - found.eigenvalues[0]) / abs(found.eigenvalues[0])
        assert 0.0 <= gap < split


def test_free_floating_and_dashpot_only_structures_give_resting_poles() -> None:
    """Without springs a structure drifts: poles at zero, and no oscillation made from them."""
    structure = monopile_structure()
    assembly = assemble(structure)
    drifting = damped_modes(build_system(assembly, on_law(structure, kelvin_voigt(0.0, 1e6))), below_hz=0.05)
    assert np.sum(np.abs(drifting.real_poles) < 1e-6) >= 6


def test_a_structure_without_supports_floats_and_bends(monopile) -> None:
    """Six rigid motions are twelve poles at rest; the first bending pair is the undamped one."""
    system = build_system(monopile, Support())
    modes = damped_modes(system, below_hz=3.0)
    assert modes.real_poles.size == 12
    assert np.abs(modes.real_poles).max() < 1e-5  # a double root is known to √ε
    bending = undamped_modes(system, 8).frequency_hz[6:]
    np.testing.assert_allclose(modes.frequency_hz[:2], bending, rtol=1e-6)


@pytest.mark.parametrize("c", [1e-3, 1.0, 1e6, 1e9, 1e12, 1e15])
@pytest.mark.parametrize("make", [lambda c: kelvin_voigt(2.5e9, c), lambda c: zener(2.5e9, c, 1e10)])
def test_extreme_dampers_lie_between_their_limits(jacket15, c: float, make) -> None:
    support = on_translations(jacket15.structure, make(c))
    modes = damped_modes(build_system(jacket15, support, rayleigh=RAYLEIGH), below_hz=0.7)
    assert modes.eigenvalues.size == 3
    assert (0.18 < modes.frequency_hz[:2]).all() and (modes.frequency_hz[:2] < 0.187).all()
    assert (modes.damping_ratio > 0.0).all()


def test_a_mass_and_a_moment_on_top_leave_rank_and_count_alone(monopile) -> None:
    """A massless rotation (no inertia on the tip) makes M singular only for a massless beam."""
    structure = monopile_structure().with_masses((PointMass("n6", 5e5),))
    modes = damped_modes(
        build_system(assemble(structure), on_law(structure, LAWS["kelvin-voigt"])), below_hz=1.0
    )
    assert modes.eigenvalues.size >= 2
