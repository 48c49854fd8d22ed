"""Modes on springs of many stiffnesses from one factor: a chain's closed form, and the bound of the error."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp

from jackettwin.errors import NumericalError
from jackettwin.response import OnSprings

N, NEAR, MODES = 60, 8, 3
STIFFNESS = np.array([[1e3, 3e2], [1e5, 10.0], [30.0, 4e4]])
"""Springs under both ends of three chains; a chain's own are 1000 each."""


def chain(stiffness: np.ndarray) -> tuple[sp.csc_array, sp.csc_array]:
    """Return a chain of unit masses between springs (N − 1,), free at both ends."""
    ends = sp.diags_array([np.ones(N - 1), -np.ones(N - 1)], offsets=[0, 1], shape=(N - 1, N))
    return sp.csc_array(ends.T @ sp.diags_array(stiffness) @ ends), sp.csc_array(sp.eye_array(N))


def exact(K: sp.csc_array, springs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    whole = K.toarray()
    whole[[0, -1], [0, -1]] += springs
    values, shapes = la.eigh(whole, subset_by_index=[0, NEAR - 1])
    return np.sqrt(values), shapes


def test_one_factor_gives_the_modes_on_every_spring_of_a_changed_chain() -> None:
    """Springs differ a thousandfold between the cases, and a link of the chain has lost nine tenths."""
    own = np.full(N - 1, 1e3)
    near = exact(chain(own)[0], np.exp(np.log(STIFFNESS).mean(axis=0)))[1]
    own[N // 3] *= 0.1
    K, M = chain(own)
    whole = OnSprings(K, M, np.array([0, N - 1]), STIFFNESS, near)
    for springs in STIFFNESS:
        omega, shapes = whole.modes(springs, MODES)
        wanted, wanted_shapes = exact(K, springs)
        off = 1.0 - (wanted[:MODES] / omega) ** 2
        told = whole.error(springs, omega, shapes)
        assert np.all(off > -1e-10)  # Ritz values lie above
        assert off.max() < (wanted[MODES - 1] / wanted[NEAR - 1]) ** 8  # two steps, twice as many in ω²
        # the residual tells (1 − ω²/ω_j²) of the error, with ω_j above all that are in the basis
        assert np.all(off < told / (1.0 - (wanted[MODES - 1] / wanted[NEAR - 1]) ** 2) + 1e-10)
        likeness = np.abs(np.einsum("ij,ij->j", shapes, wanted_shapes[:, :MODES]))
        np.testing.assert_allclose(likeness, 1.0, atol=1e-5)  # squares of shapes' errors


def test_shapes_of_too_few_modes_are_found_out() -> None:
    K, M = chain(np.full(N - 1, 1e3))
    near = np.ones((N, 1)) + 0.1 * np.arange(N)[:, None] % 7  # no mode at all
    whole = OnSprings(K, M, np.array([0, N - 1]), STIFFNESS, near)
    omega, shapes = whole.modes(STIFFNESS[0], 4)
    off = 1.0 - (exact(K, STIFFNESS[0])[0][:4] / omega) ** 2
    told = whole.error(STIFFNESS[0], omega, shapes)
    assert off[3] > 1e-3 and told[3] > 1e-3


def test_what_is_not_held_has_no_modes() -> None:
    K, M = chain(np.full(N - 1, 1e3))
    pulled = sp.csc_array(K - 0.1 * M)  # a mean stiffness that holds it, and one that does not
    near = exact(K, np.ones(2))[1]
    springs = np.array([[1e3, 1e3], [1e-3, 1e-3]])
    whole = OnSprings(pulled, M, np.array([0, N - 1]), springs, near)
    with pytest.raises(NumericalError, match="not stable"):
        whole.modes(springs[1], 4)
