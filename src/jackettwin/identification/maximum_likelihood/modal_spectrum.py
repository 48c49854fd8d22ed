r"""Expected periodogram of modes driven by white forces, over a finite record, in closed form.

Two modes contribute :math:`H_i(i\omega) H_j(i\omega)^*` with
:math:`H(s) = s^2/((s-\lambda)(s-\bar\lambda))`. In partial fractions,

.. math:: H_i(s) H_j(-s) = 1 + \sum_{p\in\{\lambda_i,\bar\lambda_i\}} \frac{\rho_p H_j(-p)}{s-p}
          + \sum_{p\in\{\lambda_j,\bar\lambda_j\}} \frac{\rho_p H_i(-p)}{-s-p},
          \qquad \rho_p = \frac{p^2}{p-\bar p}.

A record of length T weights the covariance at lag τ with 1 − τ/T (Fejér), which turns 1/(s−p), the
transform of :math:`e^{p\tau}`, at a Fourier frequency into :math:`F_p + L_p`,

.. math:: F_p(\omega) = \frac{1}{i\omega-p}, \qquad L_p(\omega) = \frac{e^{pT}-1}{T\,(i\omega-p)^2}.

L is leakage from the peak: it follows the force at the mode's frequency, whereas F follows the force at ω.
Over the lines of a group, of variance v about their mean ω, the means are :math:`F_p(1 - vF_p^2)` and
:math:`L_p(1 - 3vF_p^2)`.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray


def poles(frequency_hz: FloatArray, damping_ratio: FloatArray) -> ComplexArray:
    """Return λ = ω(−ζ + i√(1−ζ²)) [rad/s]."""
    return np.asarray(2.0 * np.pi * frequency_hz * (-damping_ratio + 1j * np.sqrt(1.0 - damping_ratio**2)))


def kernel(
    omega: FloatArray,
    variance: FloatArray,
    duration_s: FloatArray | float,
    first: ComplexArray,
    second: ComplexArray,
) -> tuple[ComplexArray, ComplexArray]:
    """Return the expected cross periodogram of modes under unit forces: the response at ω and the leakage.

    Parameters
    ----------
    omega, variance : (n_omega,) [rad/s], [rad²/s²]
        Mean Fourier frequency of every group of lines, and their variance about it.
    duration_s : float or (n_omega,)
    first, second : (n_first,), (n_second,) complex
        Poles of the two sets of modes, upper half plane.

    Returns
    -------
    steady, leaked : (n_omega, n_first, n_second)
    """
    own = _with_poles_of(omega, variance, duration_s, first, second)
    # the poles of the second set contribute the conjugate transpose with the sets exchanged
    other = own if first is second else _with_poles_of(omega, variance, duration_s, second, first)
    steady, leaked = (a + b.conj().transpose(0, 2, 1) for a, b in zip(own, other, strict=True))
    return np.asarray(1.0 + steady), np.asarray(leaked)


def _with_poles_of(
    omega: FloatArray,
    variance: FloatArray,
    duration_s: FloatArray | float,
    first: ComplexArray,
    second: ComplexArray,
) -> tuple[ComplexArray, ComplexArray]:
    """Return the parts of the partial fractions that have the poles of the first set."""
    n = len(first)
    p = np.concatenate([first, first.conj()])
    weight = _residue(p)[:, None] * _transfer(-p[:, None], second)
    parts = (part[:, :, None] * weight for part in fejer(omega, variance, duration_s, p))
    at, beside = (np.asarray(part[:, :n] + part[:, n:]) for part in parts)
    return at, beside


def fejer(
    omega: FloatArray, variance: FloatArray, duration_s: FloatArray | float, p: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the means of F_p and L_p over groups of lines, (n_omega, n_poles) each."""
    inverse = 1.0 / (1j * omega[:, None] - p)
    square = inverse**2
    curvature = variance[:, None] * square
    length = np.reshape(duration_s, (-1, 1))
    leak = np.expm1(p * length) / length
    return np.asarray(inverse * (1.0 - curvature)), np.asarray(leak * square * (1.0 - 3.0 * curvature))


def _transfer(s: ComplexArray, lam: ComplexArray) -> ComplexArray:
    return np.asarray(s**2 / ((s - lam) * (s - lam.conj())))


def _residue(p: ComplexArray) -> ComplexArray:
    return np.asarray(p**2 / (p - p.conj()))
