r"""Poly-reference least squares in the frequency domain (pLSCF, "PolyMAX").

The positive half spectra — transforms of the covariances at positive lags — share the poles of the
structure. They are fitted by a right matrix fraction in :math:`\Omega = e^{-i\omega\Delta t}`,

.. math:: S^+_o(\omega) \approx B_o(\Omega) A(\Omega)^{-1}, \quad
   A = \sum_{r=0}^{n} \alpha_r \Omega^r,\ \alpha_n = I,

which is linearised, with the coefficients of B eliminated output by output (Peeters, Van der Auweraer,
Guillaume & Leuridan 2004; Cauberghe 2004). With :math:`\alpha_n = I` poles that fit noise are unstable and
can be dropped. A root :math:`\Omega_i` with :math:`A(\Omega_i) v_i = 0` is a pole :math:`\mu_i = 1/\Omega_i`,
and the residue there is proportional to :math:`B(\Omega_i) v_i`, the mode shape.

An exponential window suppresses the noise at long lags; the damping it adds is known exactly and subtracted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.mode_shapes import normalised
from jackettwin.identification.subspace.ssi_cov import OrderPoles

if TYPE_CHECKING:
    from collections.abc import Sequence


WINDOW_END = 0.01
"""Value of the exponential window at the last lag."""


def plscf_poles(
    covariances: FloatArray, orders: Sequence[int], *, band: tuple[float, float]
) -> list[OrderPoles]:
    """Return poles and shapes of every polynomial order.

    Parameters
    ----------
    covariances : (n_lags + 1, n_channels, n_references)
        Covariances of channels with references at lags 0 … n_lags.
    orders : sequence of int
        Degrees of the polynomials; each degree adds one pole per reference.
    band : (low, high)
        Fitted frequencies, in cycles per sample.
    """
    n_lags, _, n_references = covariances.shape[0] - 1, *covariances.shape[1:]
    decay = -np.log(WINDOW_END) / n_lags
    f, spectra = half_spectra(covariances, decay)
    inside = (f >= band[0]) & (f <= band[1])
    powers = np.exp(-2j * np.pi * np.outer(f[inside], np.arange(max(orders) + 1)))
    normal = _normal_equations(powers, spectra[inside])
    return [_order(normal, n, n_references, np.exp(decay)) for n in orders]


def half_spectra(covariances: FloatArray, decay: float) -> tuple[FloatArray, ComplexArray]:
    """Return frequencies [1/sample] and positive half spectra (n_frequencies, n_out, n_references)."""
    n_lags = len(covariances) - 1
    window = np.exp(-decay * np.arange(n_lags + 1))
    # lag 0 contains the measurement noise, which is white: a constant that B absorbs
    weighted = covariances * window[:, None, None]
    weighted[0] *= 0.5
    size = 2 * n_lags
    return np.asarray(np.fft.rfftfreq(size)), np.asarray(np.fft.rfft(weighted, size, axis=0))


@dataclass(frozen=True)
class _Normal:
    """Normal equations of the largest order; smaller orders take their leading blocks.

    ``r`` (n+1, n+1), ``s`` (n_out, n+1, n+1, n_references), ``t`` (n+1, n_references, n+1, n_references).
    """

    r: FloatArray
    s: FloatArray
    t: FloatArray


def _normal_equations(powers: ComplexArray, spectra: ComplexArray) -> _Normal:
    r = np.asarray((powers.conj().T @ powers).real)
    s = -np.einsum("fa,fb,fok->oabk", powers.conj(), powers, spectra, optimize=True).real
    cross = np.einsum("foj,fok->fjk", spectra.conj(), spectra)
    t = np.einsum("fa,fb,fjk->ajbk", powers.conj(), powers, cross, optimize=True).real
    return _Normal(r, np.asarray(s), np.asarray(t))


def _order(normal: _Normal, n: int, n_references: int, undo: float) -> OrderPoles:
    """Solve for one order: A from the reduced normal equations, its roots, B at the roots."""
    size = (n + 1) * n_references
    r = normal.r[: n + 1, : n + 1]
    s = normal.s[:, : n + 1, : n + 1].reshape(len(normal.s), n + 1, size)
    t = normal.t[: n + 1, :, : n + 1].reshape(size, size)
    # in a narrow band the powers are nearly linearly dependent at high order
    solved = linalg.lstsq(r, s.transpose(1, 0, 2).reshape(n + 1, -1), check_finite=False)[0]
    eliminated = solved.reshape(n + 1, len(s), size).transpose(1, 0, 2)
    m = t - np.einsum("oai,oaj->ij", s, eliminated)
    free = n * n_references
    low = linalg.lstsq(m[:free, :free], -m[:free, free:], check_finite=False)[0]
    alpha = np.concatenate([low, np.eye(n_references)]).reshape(n + 1, n_references, n_references)
    roots, vectors = _roots(alpha)
    beta = -eliminated @ alpha.reshape(size, n_references)
    at_roots = np.power.outer(roots, np.arange(n + 1))
    shapes = np.einsum("pa,oar,rp->po", at_roots, beta, vectors, optimize=True)
    keep = (np.abs(roots) > 0.0) & (roots.imag < 0.0)
    return OrderPoles(n, undo / roots[keep], normalised(np.asarray(shapes[keep])))


def _roots(alpha: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the roots Ω of det A(Ω) = 0, (n_roots,), and the null vectors (n_references, n_roots)."""
    n, k = len(alpha) - 1, alpha.shape[1]
    companion = np.zeros((n * k, n * k))
    companion[:-k, k:] = np.eye((n - 1) * k)
    companion[-k:] = -np.hstack(list(alpha[:-1]))
    roots, vectors = linalg.eig(companion, check_finite=False)
    return np.asarray(roots, dtype=complex), np.asarray(vectors[:k], dtype=complex)
