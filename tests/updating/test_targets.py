import numpy as np
import pytest
from scipy.stats import multivariate_normal

from jackettwin.errors import InputError
from jackettwin.updating import Residuals, Target


def pole(f: float, zeta: float) -> complex:
    return 2 * np.pi * f * complex(-zeta, np.sqrt(1 - zeta**2))


def test_relative_residuals_are_those_of_8_4() -> None:
    r = Residuals((Target(1, 0.18, damping_ratio=0.01),), relative=True)
    values = r.values(np.array([[pole(0.1818, 0.012)]]))[0]
    np.testing.assert_allclose(values, [0.01, 0.2], rtol=1e-12)


def test_weighted_residuals_are_logarithms_over_their_standard_deviation() -> None:
    r = Residuals((Target(1, 0.18, 0.0018, 0.01, 0.003),), relative=False)
    values = r.values(np.array([[pole(0.18 * np.exp(0.02), 0.01 * np.exp(0.6))]]))[0]
    np.testing.assert_allclose(values, [2.0, 2.0], rtol=1e-9)


def test_likelihood_is_the_joint_normal_of_frequency_and_damping() -> None:
    """Against scipy's multivariate normal, the covariance of (ln f, ln ζ) written out."""
    s_f, s_zeta, rho = 0.01, 0.3, 0.6
    r = Residuals((Target(1, 0.18, s_f * 0.18, 0.01, s_zeta * 0.01, rho),), relative=False)
    value = r.values(np.array([[pole(0.18 * np.exp(0.02), 0.01 * np.exp(0.2))]]))[0]
    cov = [[s_f**2, rho * s_f * s_zeta], [rho * s_f * s_zeta, s_zeta**2]]
    expected = multivariate_normal([0.0, 0.0], cov).logpdf([0.02, 0.2])
    assert -0.5 * value @ value - r.log_normalisation == pytest.approx(expected, rel=1e-9)


def test_a_correlation_of_data_that_are_not_both_there_counts_for_nothing() -> None:
    poles = np.array([[pole(0.181, 0.012)]])
    one, two = (
        Residuals((Target(1, 0.18, 0.001, correlation=rho),), relative=False).values(poles)
        for rho in (0, 0.9)
    )
    np.testing.assert_array_equal(one, two)


def test_jacobian_is_the_difference_of_residuals(rng: np.random.Generator) -> None:
    targets = (Target(1, 0.18, 0.001, 0.01, 0.003, correlation=-0.4), Target(3, 0.5))
    r = Residuals(targets, relative=False)
    poles = np.array([pole(0.17, 0.02), pole(0.6, 0.03)])
    slopes = rng.standard_normal((2, 2)) + 1j * rng.standard_normal((2, 2))
    J = r.jacobian(poles, slopes)
    h = 1e-6
    for j in range(2):
        up, down = (r.values((poles + s * slopes[:, j])[None])[0] for s in (h, -h))
        np.testing.assert_allclose(J[:, j], (up - down) / (2 * h), rtol=1e-6)


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        ((), "nothing to update"),
        ((Target(1, 0.2), Target(1, 0.3)), "given twice"),
        ((Target(1),), "no target has"),
        ((Target(1, 0.2, correlation=1.0),), "between −1 and 1"),
    ],
)
def test_empty_or_contradictory_targets(targets: tuple[Target, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Residuals(targets, relative=True)
