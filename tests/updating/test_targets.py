import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.updating import Residuals, Target


def pole(f: float, zeta: float) -> complex:
    return 2 * np.pi * f * complex(-zeta, np.sqrt(1 - zeta**2))


def test_relative_residuals_are_those_of_8_4() -> None:
    r = Residuals((Target(1, 0.18, damping_ratio=0.01),), relative=True)
    values, _ = r.evaluate(np.array([pole(0.1818, 0.012)]), np.zeros((1, 1), complex))
    np.testing.assert_allclose(values, [0.01, 0.2], rtol=1e-12)


def test_weighted_residuals_are_logarithms_over_their_standard_deviation() -> None:
    r = Residuals((Target(1, 0.18, 0.0018, 0.01, 0.003),), relative=False)
    values, _ = r.evaluate(
        np.array([pole(0.18 * np.exp(0.02), 0.01 * np.exp(0.6))]), np.zeros((1, 1), complex)
    )
    np.testing.assert_allclose(values, [2.0, 2.0], rtol=1e-9)


def test_jacobian_is_the_difference_of_residuals(rng: np.random.Generator) -> None:
    r = Residuals((Target(1, 0.18, 0.001, 0.01, 0.003), Target(3, 0.5)), relative=False)
    poles = np.array([pole(0.17, 0.02), pole(0.6, 0.03)])
    slopes = rng.standard_normal((2, 2)) + 1j * rng.standard_normal((2, 2))
    _, J = r.evaluate(poles, slopes)
    h = 1e-6
    for j in range(2):
        up, _ = r.evaluate(poles + h * slopes[:, j], slopes)
        down, _ = r.evaluate(poles - h * slopes[:, j], slopes)
        np.testing.assert_allclose(J[:, j], (up - down) / (2 * h), rtol=1e-6)


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        ((), "nothing to update"),
        ((Target(1, 0.2), Target(1, 0.3)), "given twice"),
        ((Target(1),), "no target has"),
    ],
)
def test_empty_or_contradictory_targets(targets: tuple[Target, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Residuals(targets, relative=True)
