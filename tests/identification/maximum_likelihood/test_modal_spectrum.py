"""The closed-form kernel against the plain transform of the windowed covariance."""

from __future__ import annotations

import numpy as np

from jackettwin.identification.maximum_likelihood.modal_spectrum import fejer, kernel, poles

DURATION = 100.0
P = poles(np.array([0.3]), np.array([0.02]))


def test_fejer_equals_the_plain_integral():
    omega = 2.0 * np.pi * np.array([28.0, 30.0, 45.0]) / DURATION
    t = np.linspace(0.0, DURATION, 200_001)
    plain = [np.trapezoid((1 - t / DURATION) * np.exp((P[0] - 1j * w) * t), t) for w in omega]
    # trapezoidal rule, 1600 points a cycle
    np.testing.assert_allclose(sum(fejer(omega, np.zeros(3), DURATION, P))[:, 0], plain, rtol=1e-4)


def test_mean_over_a_group_of_lines():
    """Groups a fifth of the half bandwidth wide: what remains is of fourth order, (0.2)⁴/80 of the peak."""
    step = 2.0 * np.pi * 0.3 * 0.02 / 25.0
    for centre in 2.0 * np.pi * np.array([0.294, 0.3, 0.31]):
        lines = centre + step * np.arange(-2, 3)
        lam = poles(np.array([0.3, 0.31]), np.array([0.02, 0.03]))
        each = sum(kernel(lines, np.zeros(5), DURATION, lam, lam)).mean(axis=0)
        group = sum(kernel(np.array([centre]), np.array([lines.var()]), DURATION, lam, lam))[0]
        np.testing.assert_allclose(group, each, atol=1e-4 * np.abs(each).max())
        middle = sum(kernel(np.array([centre]), np.zeros(1), DURATION, lam, lam))[0]
        assert np.abs(group - each).max() < 0.1 * np.abs(middle - each).max()
