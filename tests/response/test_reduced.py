"""Reduced systems against the poles of the full model."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse.linalg as spla

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import damped_modes, undamped_modes
from jackettwin.response.reduction import FREQUENCY_ERROR, reduced
from jackettwin.response.state import state_matrix
from jackettwin.response.system import build_system
from jackettwin.soil import on_translations, pinned
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.laws.viscoelastic import Law, kelvin_voigt, maxwell_3, zener
from jackettwin.structure import Assembly, Rayleigh, assemble

LAWS = {
    "kelvin-voigt": kelvin_voigt(2.5e9, 7.6e8),
    "zener": zener(2.62e9, 8.65e8, 9.99e9),
    "maxwell-3": maxwell_3(2.5e9, 0.2, 0.183),
    "near-locked": zener(8.92e7, 1e12, 1e10),
}


def oscillating(A: np.ndarray, below_hz: float) -> np.ndarray:
    values = np.linalg.eigvals(A)
    return np.sort_complex(values[(values.imag > 1e-3) & (np.abs(values) < 2 * np.pi * below_hz)])


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_poles_are_those_of_the_full_model(law: Law) -> None:
    """Modes kept up to 3 Hz leave less than 1e-4 in every pole below 0.8 Hz, damping included."""
    structure = read_structure("jacket15")
    system = build_system(
        assemble(structure), on_translations(structure, law), rayleigh=Rayleigh.minimum(0.01, 0.1832)
    )
    small = reduced(system, below_hz=3.0)
    full = np.sort_complex(damped_modes(system, below_hz=0.8).eigenvalues)
    found = oscillating(state_matrix(small.pencil), 0.8)
    assert found.size == full.size
    np.testing.assert_allclose(found.imag, full.imag, rtol=1e-4)
    np.testing.assert_allclose(found.real, full.real, rtol=2e-3)


def test_static_deflection_under_loads_on_kept_dofs_is_exact() -> None:
    structure = read_structure("jacket15")
    support = on_translations(structure, LAWS["zener"])
    system = build_system(assemble(structure), support)
    top = system.assembly.dofs("tower_top")
    small = reduced(system, below_hz=1.0, keep=tuple(top))
    f = np.zeros(system.assembly.n_dof)
    f[top[0]], f[top[4]] = 1e6, 3e6
    exact = spla.spsolve(system.pencil.static_stiffness().tocsc(), f[system.free])
    q = np.linalg.solve(small.pencil.static_stiffness(), small.basis.T @ f)
    np.testing.assert_allclose((small.basis @ q)[top], system.expand(exact)[top], rtol=1e-9, atol=1e-12)


def test_held_supports_leave_modes_only() -> None:
    structure = read_structure("jacket15")
    system = build_system(assemble(structure), pinned(structure))
    small = reduced(system, below_hz=1.0)
    np.testing.assert_allclose(small.pencil.M, np.eye(small.n), atol=1e-9)
    omega = np.sqrt(np.diag(small.pencil.K))
    assert omega[0] / (2 * np.pi) == pytest.approx(0.1832, abs=1e-4)


def test_lumped_piles_keep_their_rotations() -> None:
    structure, support = read_foundation("jacket15_records").lumped(read_structure("jacket15"))
    system = build_system(assemble(structure), support)
    full = damped_modes(system, below_hz=0.8)
    found = oscillating(state_matrix(reduced(system, below_hz=3.0).pencil), 0.8)
    np.testing.assert_allclose(np.sort(np.abs(found)), np.sort(np.abs(full.eigenvalues)), rtol=1e-5)


def test_a_band_is_needed() -> None:
    structure = read_structure("jacket15")
    system = build_system(assemble(structure), pinned(structure))
    with pytest.raises(InputError, match="below_hz"):
        reduced(system, below_hz=0.0)
    with pytest.raises(InputError, match="no mode"):
        reduced(system, below_hz=0.01)


def test_the_undamped_modes_are_right_up_to_the_band(jacket15: Assembly) -> None:
    """5e-4 up to 5 Hz, where modes with held feet and top alone are 3 % off from 2.6 Hz on."""
    system = build_system(jacket15, on_translations(jacket15.structure, kelvin_voigt(2.5e9, 7.6e8)))
    keep = tuple(jacket15.dofs("tower_top"))

    def frequencies(below_hz: float, error: float) -> tuple[np.ndarray, int]:
        small = reduced(system, below_hz=below_hz, keep=keep, error=error)
        w2 = la.eigvalsh(small.pencil.static_stiffness(), small.pencil.M)
        return np.sqrt(w2) / (2.0 * np.pi), small.n

    wanted = undamped_modes(system, 60).frequency_hz
    wanted = wanted[wanted < 5.0]
    found, n = frequencies(5.0, FREQUENCY_ERROR)
    np.testing.assert_allclose(found[: wanted.size], wanted, rtol=FREQUENCY_ERROR)
    bare, n_bare = frequencies(5.0, np.inf)
    assert np.abs(bare[: wanted.size] / wanted - 1.0).max() > 0.03
    assert n < 1.25 * n_bare
