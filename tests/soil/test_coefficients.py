"""Laws as rows of numbers."""

import numpy as np
import pytest
from tests.support.law_rows import law_rows

from jackettwin.response.condensation.kernels import _law
from jackettwin.soil.laws.coefficients import law_slope, law_stiffness, static_rows
from jackettwin.soil.laws.viscoelastic import Law, Springpot, kelvin_voigt, maxwell_3, zener

LAWS: list[Law] = [
    kelvin_voigt(2e9, 3e8),
    zener(2.6e9, 8e8, 1e10),
    maxwell_3(3e9, 0.2, 0.18),
    Springpot(2e9, 0.06, 1.1),
]
ROWS = law_rows(LAWS)


def test_rows_hold_the_static_stiffness_of_every_law() -> None:
    springs = static_rows(ROWS)
    at = [1e-12, 1e-12, 1e-12, 1.1j]
    held = [float(law.stiffness(s).real) for law, s in zip(LAWS, at, strict=True)]
    np.testing.assert_allclose(springs[:, 0], held, rtol=1e-9)
    assert not np.delete(springs, [0, 4], axis=1).any()


def test_many_laws_at_once_are_each_law_alone() -> None:
    s = np.array([-0.02 + 1.1j, 0.3 + 5j, 2.0])
    rows = ROWS
    for law, many, slopes in zip(
        LAWS, law_stiffness(rows[:, None], s), law_slope(rows[:, None], s), strict=True
    ):
        np.testing.assert_allclose(many, law.stiffness(s), rtol=1e-14)
        np.testing.assert_allclose(slopes, law.slope(s), rtol=1e-14)


@pytest.mark.parametrize("law", LAWS)
def test_the_slope_is_the_difference(law: Law) -> None:
    s, h = 0.3 + 5j, 1e-4
    by_difference = (law.stiffness(s + h) - law.stiffness(s - h)) / (2.0 * h)
    np.testing.assert_allclose(law.slope(s), by_difference, rtol=1e-6)


def test_the_compiled_law_is_the_same() -> None:
    s = -0.02 + 1.1j
    for law in LAWS:
        stiffness, slope = _law.py_func(law.row, s)
        np.testing.assert_allclose([stiffness, slope], [law.stiffness(s), law.slope(s)], rtol=1e-14)
