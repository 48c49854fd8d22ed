"""Structure and support as one system."""

import numpy as np
import pytest
from tests.response.conftest import monopile_structure

from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import Prony, Springpot, kelvin_voigt, zener
from jackettwin.soil.support import Spring, Support, clamped, on_translations, pinned
from jackettwin.structure import Rayleigh, assemble


@pytest.mark.parametrize("law", [kelvin_voigt(2e9, 1e8), zener(1e9, 1e8, 3e9), Springpot(1e9, 0.3, 1.0)])
def test_slope_is_the_derivative_and_f_is_symmetric(monopile, law) -> None:
    support = Support(springs=(Spring("n0", np.diag([1.0, 1, 1, 9, 9, 9]), law),))
    pencil = build_system(monopile, support, rayleigh=Rayleigh.minimum(0.01, 0.2)).pencil
    s, h = -0.05 + 1.3j, 1e-5
    numeric = ((pencil.F(s + h) - pencil.F(s - h)) / (2 * h)).toarray()
    exact = pencil.dF(s).toarray()
    np.testing.assert_allclose(exact, numeric, atol=1e-6 * np.abs(exact).max())
    F = pencil.F(s).toarray()
    np.testing.assert_array_equal(F, F.T)


def test_springs_with_one_law_make_one_group(jacket15) -> None:
    a, b = kelvin_voigt(1e9, 1e8), kelvin_voigt(2e9, 1e8)
    feet = jacket15.structure.reaction_nodes
    pattern = np.diag([1.0, 1, 1, 0, 0, 0])
    springs = tuple(Spring(node, pattern, a if k < 2 else b) for k, node in enumerate(feet))
    groups = build_system(jacket15, Support(springs=springs)).pencil.groups
    assert [group.law for group in groups] == [a, b]
    assert [group.dofs.size for group in groups] == [6, 6]


def test_a_full_matrix_and_several_springs_on_a_node_add_up(monopile) -> None:
    matrix = np.diag([1e9, 2e9, 3e9, 4e11, 5e11, 6e11])
    matrix[0, 4] = matrix[4, 0] = -1e10
    whole = build_system(monopile, Support(springs=(Spring("n0", matrix),)))
    halves = build_system(monopile, Support(springs=(Spring("n0", 0.5 * matrix), Spring("n0", 0.5 * matrix))))
    difference = whole.pencil.static_stiffness() - halves.pencil.static_stiffness()
    assert np.abs(difference).max() == 0.0
    block = (whole.pencil.static_stiffness() - whole.pencil.K)[:6][:, :6].toarray()
    np.testing.assert_allclose(block, matrix, atol=1.0)  # N/m beside 1e11


def test_very_stiff_springs_are_pins(jacket15) -> None:
    structure = jacket15.structure
    stiff = undamped_modes(build_system(jacket15, on_translations(structure, Prony(k0=1e20))), 5)
    held = undamped_modes(build_system(jacket15, pinned(structure)), 5)
    np.testing.assert_allclose(stiff.frequency_hz, held.frequency_hz, rtol=1e-8)


def test_clamping_is_stiffer_than_pinning(jacket15) -> None:
    structure = jacket15.structure
    pins, clamps = (
        undamped_modes(build_system(jacket15, hold(structure)), 5).frequency_hz for hold in (pinned, clamped)
    )
    assert (clamps >= pins).all() and clamps[0] > pins[0]


def test_a_spring_on_a_held_dof_does_nothing(monopile) -> None:
    clamp = ("n0", (0, 1, 2, 3, 4, 5))
    spring = Spring("n0", np.eye(6), Prony(k0=1e9))
    system = build_system(monopile, Support(springs=(spring,), fixed=(clamp,)))
    assert system.pencil.groups == ()


@pytest.mark.parametrize(
    ("support", "message"),
    [
        (Support(fixed=(("nowhere", (0,)),)), "no such node .got 'nowhere'"),
        (Support(springs=(Spring("nowhere", np.eye(6)),)), "no such node .got 'nowhere'"),
        (
            Support(fixed=tuple((f"n{k}", tuple(range(6))) for k in range(7))),
            "every degree of freedom is fixed",
        ),
    ],
)
def test_bad_supports_are_refused(support: Support, message: str) -> None:
    with pytest.raises(InputError, match=message):
        build_system(assemble(monopile_structure()), support)
