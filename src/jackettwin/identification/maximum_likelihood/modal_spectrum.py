r"""Expected periodogram of modes driven by white forces, over a finite record, in closed form.

Two modes contribute :math:`H_i(i\omega) H_j(i\omega)^*` with
:math:`H(s) = s^2/((s-\lambda)(s-\bar\lambda))`. In partial fractions,

.. math:: H_i(s) H_j(-s) = 1 + \sum_{p\in\{\lambda_i,\bar\lambda_i\}} \frac{\rho_p H_j(-p)}{s-p}
          + \sum_{p\in\{\lambda_j,\bar\lambda_j\}} \frac{\rho_p H_i(-p)}{-s-p},
          \qquad \rho_p = \frac{p^2}{p-\bar p}.

A record of length T weights the covariance at lag τ with 1 − τ/T (Fejér), which turns 1/(s−p), the
transform of :math:`e^{p\tau}`, at a Fourier frequency into

.. math:: F_p(\omega) = \frac{1}{i\omega-p} + \frac{e^{pT}-1}{T\,(i\omega-p)^2}.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


def poles(frequency_hz: FloatArray, damping_ratio: FloatArray) -> ComplexArray:
    """Return λ = ω(−ζ + i√(1−ζ²)) [rad/s]."""
    return np.asarray(2.0 * np.pi * frequency_hz * (-damping_ratio + 1j * np.sqrt(1.0 - damping_ratio**2)))


def kernel(omega: FloatArray, duration_s: float, first: ComplexArray, second: ComplexArray) -> ComplexArray:
    """Return the expected cross periodogram of unit-force modes, (n_omega, n_first, n_second).

    Parameters
    ----------
    omega : (n_omega,) [rad/s]
        Fourier frequencies of the record.
    first, second : (n_first,), (n_second,) complex
        Poles of the two sets of modes, upper half plane.
    """
    out = np.ones((len(omega), len(first), len(second)), dtype=complex)
    for p in (first, first.conj()):
        weight = _residue(p)[:, None] * _transfer(-p[:, None], second)
        out += fejer(omega, duration_s, p)[:, :, None] * weight
    for p in (second, second.conj()):
        weight = _residue(p) * _transfer(-p, first[:, None])
        out += fejer(-omega, duration_s, p)[:, None, :] * weight
    return out


def fejer(omega: FloatArray, duration_s: float, p: ComplexArray) -> ComplexArray:
    """Return F_p(ω), (n_omega, n_poles)."""
    inverse = 1.0 / (1j * omega[:, None] - p)
    return np.asarray(inverse + np.expm1(p * duration_s) / duration_s * inverse**2)


def _transfer(s: ComplexArray, lam: ComplexArray) -> ComplexArray:
    return np.asarray(s**2 / ((s - lam) * (s - lam.conj())))


def _residue(p: ComplexArray) -> ComplexArray:
    return np.asarray(p**2 / (p - p.conj()))
