"""Modes followed by shape: a permutation, a rotated pair, a mode that is gone, and a damper's whole range."""

import numpy as np
import pytest

from jackettwin.response.modes.modal import damped_modes, undamped_modes
from jackettwin.response.modes.tracking import mass_mac, track_modes
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import kelvin_voigt, zener
from jackettwin.soil.support import on_translations, pinned
from jackettwin.structure import Rayleigh

OMEGA = np.array([1.0, 1.01, 3.0, 5.0])


@pytest.fixture
def basis(rng) -> tuple[np.ndarray, np.ndarray]:
    """A mass matrix and four mass-normalised modes."""
    root = rng.standard_normal((8, 8))
    M = root @ root.T + 8.0 * np.eye(8)
    phi = np.linalg.solve(np.linalg.cholesky(M).T, np.linalg.qr(rng.standard_normal((8, 4)))[0])
    return M, phi


def test_mac_is_one_with_itself_zero_with_others_and_ignores_scale_and_phase(basis) -> None:
    M, phi = basis
    np.testing.assert_allclose(mass_mac(M, phi, phi * (2.0 - 3.0j)), np.eye(4), atol=1e-12)


def test_a_permutation_is_undone(basis) -> None:
    M, phi = basis
    order = [2, 0, 3, 1]
    assert list(track_modes(M, OMEGA, phi, phi[:, order])) == [1, 3, 0, 2]


def test_a_rotated_pair_is_followed_as_a_subspace(basis) -> None:
    """Turned by 60° the pair's single MACs are 0.25: below recognition, were it not for the subspace."""
    M, phi = basis
    c, s = np.cos(np.pi / 3), np.sin(np.pi / 3)
    turned = phi.copy()
    turned[:, :2] = phi[:, :2] @ np.array([[c, -s], [s, c]])
    assert list(track_modes(M, OMEGA, phi, turned)) == [1, 0, 2, 3]


def test_a_mode_without_kin_is_not_followed(basis, rng) -> None:
    M, phi = basis
    foreign = rng.standard_normal(8)
    foreign -= phi @ (phi.T @ (M @ foreign))
    x = np.column_stack([phi[:, 0], phi[:, 1], foreign])
    assert list(track_modes(M, OMEGA, phi, x)) == [0, 1, -1, -1]
    assert list(track_modes(M, OMEGA, phi, np.empty((8, 0)))) == [-1, -1, -1, -1]


@pytest.mark.parametrize("law_of", [lambda c: kelvin_voigt(1.1e8, c), lambda c: zener(1.1e8, c, 1e12)])
def test_numbers_hold_from_a_free_to_a_locked_damper(jacket15, law_of) -> None:
    """C from 1e4 to 1e14: mode 3 is fifth by frequency at one end, twelve real poles come, numbers stay.

    Between its two limits |λ| of a bending mode may only rise; 1e-4 for the coupling with other modes.
    """
    structure, M = jacket15.structure, jacket15.mass
    reference = undamped_modes(build_system(jacket15, pinned(structure)), 8)
    rayleigh = Rayleigh.minimum(0.01, 0.1832)
    frequency, places, n_real = [], [], []
    for c in 10.0 ** np.arange(4, 15):
        system = build_system(jacket15, on_translations(structure, law_of(c)), rayleigh=rayleigh)
        modes = damped_modes(system, below_hz=1.2)
        successor = track_modes(M, reference.omega, reference.shapes, modes.shapes)[:5]
        assert (successor >= 0).all()
        assert np.unique(successor).size == 5
        frequency.append(modes.frequency_hz[successor])
        places.append(tuple(successor))
        n_real.append(modes.real_poles.size)
    curve = np.array(frequency)
    assert (np.diff(curve, axis=0) > -1e-4 * curve[1:]).all()
    np.testing.assert_allclose(curve[-1], reference.frequency_hz[:5], rtol=1e-3)
    assert places[0] == (0, 1, 4, 2, 3) and places[-1] == (0, 1, 2, 3, 4)
    assert n_real[0] == 0 and n_real[-1] == 12
