"""Laws as rows of numbers."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil.coefficients import law_rows, static_rows
from jackettwin.soil.viscoelastic import Law, Prony, Springpot, kelvin_voigt, maxwell_3, zener

LAWS: list[Law] = [
    kelvin_voigt(2e9, 3e8),
    zener(2.6e9, 8e8, 1e10),
    maxwell_3(3e9, 0.2, 0.18),
    Springpot(2e9, 0.06, 1.1),
]


def test_rows_hold_the_static_stiffness_of_every_law() -> None:
    springs = static_rows(law_rows(LAWS))
    np.testing.assert_allclose(springs[:, 0], [law.static_stiffness for law in LAWS], rtol=1e-14)
    assert not np.delete(springs, [0, 4], axis=1).any()


def test_rows_are_as_long_as_the_longest_law() -> None:
    assert law_rows(LAWS).shape == (4, 6 + 2 * 3)
    assert law_rows([Prony(k0=1.0)]).shape == (1, 6)


def test_other_laws_are_refused() -> None:
    with pytest.raises(InputError, match="not a Prony series or springpot"):
        law_rows(["kelvin-voigt"])  # type: ignore[list-item]
