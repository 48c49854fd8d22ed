"""The closed-form kernel against the plain transform of the windowed covariance."""

from __future__ import annotations

import numpy as np

from jackettwin.identification.maximum_likelihood.modal_spectrum import fejer, poles


def test_fejer_equals_the_plain_integral():
    duration = 100.0
    p = poles(np.array([0.3]), np.array([0.02]))
    omega = 2.0 * np.pi * np.array([28.0, 30.0, 45.0]) / duration
    t = np.linspace(0.0, duration, 200_001)
    plain = [np.trapezoid((1 - t / duration) * np.exp((p[0] - 1j * w) * t), t) for w in omega]
    # trapezoidal rule, 1600 points a cycle
    np.testing.assert_allclose(fejer(omega, duration, p)[:, 0], plain, rtol=1e-4)
