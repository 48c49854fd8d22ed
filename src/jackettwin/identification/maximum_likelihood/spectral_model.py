r"""Spectral matrix of modes driven by coloured forces, with sensor noise.

For a group k of Fourier lines the spectral matrix is

.. math:: E_k = \Phi^T\,(\Gamma\circ(K_k\circ c_k c_k^T + L_k))\,\bar\Phi + N_k, \qquad
          c_{ki} = (f_k/f_i)^{-\alpha_i/2}, \quad N_k = \mathrm{diag}\,e^{a + b\ln(f_k/f_0)}

with the rows of Φ scaled by the roots of the force densities, Γ the coherences of the modal forces,
α the exponents of the force spectra, and K + L the expected periodogram of unit forces in closed
form (``modal_spectrum.kernel``: without bias from the finite record; L is leakage from the peaks).
Rows of Φ are real or, if shapes may have a phase lag, complex.
Every parameter changes E by a matrix :math:`u w^H + w u^H`, from which all derivatives are formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import blas

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.identification.maximum_likelihood.modal_spectrum import kernel, poles

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


STEP = 1e-5
"""Relative step of the central differences of the kernel; their relative error is of the order of its
square."""


@dataclass(frozen=True)
class Expected:
    """The model at one set of parameters.

    Attributes
    ----------
    forced : (n_groups, n_modes, n_modes)
        K ∘ ccᵀ.
    coloured : (n_groups, n_modes, n_modes)
        K ∘ ccᵀ + L.
    modal : (n_groups, n_modes, n_modes)
        Γ ∘ (K ∘ ccᵀ + L).
    matrix : (n_groups, n_channels, n_channels)
        E.
    """

    forced: ComplexArray
    coloured: ComplexArray
    modal: ComplexArray
    matrix: ComplexArray


def log_distance(data: Periodogram, p: Parameters) -> FloatArray:
    """Return ln(f_k/f_i), (n_groups, n_modes)."""
    return np.asarray(np.log(data.omega / (2.0 * np.pi))[:, None] - p.log_f)


def noise_density(data: Periodogram, p: Parameters) -> FloatArray:
    """Return N_k, (n_groups, n_channels)."""
    return np.asarray(np.exp(p.noise[0] + p.noise[1] * data.log_position[:, None]))


def expected(data: Periodogram, p: Parameters, share: float = 1.0) -> Expected:
    """Evaluate the model with ``share`` of the data's dither on the diagonal of E."""
    lam = poles(np.exp(p.log_f), np.exp(p.log_zeta))
    steady, leaked = _kernel(data, p, lam, lam)
    colour = np.exp(-0.5 * p.colour * log_distance(data, p))
    forced = steady * (colour[:, :, None] * colour[:, None, :])
    coloured = forced + leaked
    modal = p.gamma * coloured
    matrix = p.complex_shapes.T @ modal @ p.complex_shapes.conj()
    channel = np.arange(p.shapes.shape[1])
    matrix[:, channel, channel] += noise_density(data, p) + share * data.dither
    return Expected(np.asarray(forced), np.asarray(coloured), np.asarray(modal), np.asarray(matrix))


def response_power(data: Periodogram, f: float, zeta: float) -> FloatArray:
    """Return the expected periodogram of one mode under a white force of density 1, (n_groups,)."""
    lam = poles(np.array([f]), np.array([zeta]))
    steady, leaked = kernel(data.omega, data.variance, data.length_s, lam, lam)
    return np.asarray((steady + leaked)[:, 0, 0].real)


def modal_slopes(data: Periodogram, p: Parameters, model: Expected) -> tuple[ComplexArray, ...]:
    """Return the derivatives of Γ∘(K∘ccᵀ + L) by ln f, ln ζ and α of the mode with the first index."""
    f, zeta = np.exp(p.log_f), np.exp(p.log_zeta)
    lam = poles(f, zeta)
    away = log_distance(data, p)
    colour = np.exp(-0.5 * p.colour * away)
    colours = colour[:, :, None] * colour[:, None, :]

    up, down = np.exp(STEP), np.exp(-STEP)
    moved = [poles(f * up, zeta), poles(f * down, zeta), poles(f, zeta * up), poles(f, zeta * down)]
    steady, leaked = (
        part.reshape(len(part), len(moved), len(f), len(f))
        for part in _kernel(data, p, np.concatenate(moved), lam)
    )
    slopes = (
        p.gamma * ((steady[:, k] - steady[:, k + 1]) * colours + leaked[:, k] - leaked[:, k + 1])
        for k in (0, 2)
    )
    by_f, by_zeta = (np.asarray(slope / (2.0 * STEP)) for slope in slopes)
    forced = p.gamma * model.forced
    by_f += (0.5 * p.colour)[:, None] * forced
    by_colour = forced * (-0.5 * away)[:, :, None]
    return by_f, by_zeta, by_colour


def linear_curvature(
    data: Periodogram, p: Parameters, model: Expected, covariance: FloatArray
) -> ComplexArray:
    """Return Σ C_rs ∂²_rs E over real shapes, coherences and noise, (n_groups, n_channels, n_channels).

    Parameters
    ----------
    covariance : (n, n)
        C of these parameters, in the order of ``Parameters.vector``.
    """
    n_modes, n_channels = p.shapes.shape
    i, j = p.pairs.T
    cuts = np.cumsum([p.shapes.size, len(i), len(i), n_channels])
    of_shape, of_real, of_imaginary, level, exponent = np.split(np.arange(len(covariance)), cuts)

    def with_shapes(rows: Int64Array) -> FloatArray:
        return covariance[np.ix_(rows, of_shape)].reshape(-1, n_modes, n_channels)

    both = with_shapes(of_shape).reshape(n_modes, n_channels, n_modes, n_channels)
    curvature = 2.0 * np.einsum("iajb,kij->kab", both, model.modal, optimize=True)
    across = np.zeros((n_modes, n_modes, n_channels), dtype=complex)
    real, imaginary = with_shapes(of_real), with_shapes(of_imaginary)
    pair = np.arange(len(i))
    across[i, j] = real[pair, i] + 1j * imaginary[pair, i]
    across[j, i] = real[pair, j] - 1j * imaginary[pair, j]
    half = 2.0 * np.einsum("ija,kij,jb->kab", across, model.coloured, p.shapes, optimize=True)
    curvature += half + half.conj().transpose(0, 2, 1)
    x = data.log_position[:, None]
    of_noise = covariance[level, level] + 2.0 * x * covariance[level, exponent]
    of_noise = of_noise + x**2 * covariance[exponent, exponent]
    channel = np.arange(n_channels)
    curvature[:, channel, channel] += noise_density(data, p) * of_noise
    return np.asarray(curvature)


def derivative_factors(
    data: Periodogram,
    p: Parameters,
    model: Expected,
    white: ComplexArray,
    precision: type[np.complex64] | type[np.complex128] = np.complex128,
) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Return u and w of every parameter, multiplied by ``white`` (n_groups, n_channels, n_channels).

    Returns
    -------
    u, w : (n_channels, n_parameters, n_groups)
    """
    n_modes, n_channels = p.shapes.shape
    n_groups = len(data.omega)
    i, j = p.pairs.T
    shapes = white @ p.complex_shapes.T
    u, w = [], []
    for slope in modal_slopes(data, p, model):
        u.append(shapes)
        w.append(shapes @ slope.conj().transpose(0, 2, 1))
    rows = shapes @ model.modal.conj().transpose(0, 2, 1)
    size = (n_groups, n_channels, n_modes, n_channels)
    u.append(np.broadcast_to(white[:, :, None, :], size).reshape(n_groups, n_channels, -1))
    w.append(np.broadcast_to(rows[:, :, :, None], size).reshape(n_groups, n_channels, -1))
    across = shapes[:, :, j] * model.coloured[:, None, i, j].conj()
    u += [shapes[:, :, i], shapes[:, :, i]]
    w += [across, -1j * across]
    half = 0.5 * noise_density(data, p)[:, None, :]
    u += [white, white]
    w += [white * half, white * half * data.log_position[:, None, None]]
    if p.lag.size:
        of_sought = slice(p.n_fixed * n_channels, None)
        u.append(1j * u[3][:, :, of_sought])
        w.append(w[3][:, :, of_sought])
    return _stacked(u, precision), _stacked(w, precision)


def gram(
    u: npt.NDArray[Any], w: npt.NDArray[Any], misfit: npt.NDArray[Any] | None = None
) -> tuple[FloatArray, FloatArray]:
    r"""Return the inner products of :math:`G_p = u_p w_p^H + w_p u_p^H` with a matrix and with each other.

    The sum runs over pairs of channels one by one, so that no large array is formed.

    Parameters
    ----------
    u, w : (n_channels, n_parameters, n_groups)
        Complex, of single or double precision, in which the products are formed.
    misfit : (n_channels, n_channels, n_groups), optional
        Hermitian, of the same precision.

    Returns
    -------
    (n_parameters,), (n_parameters, n_parameters)
    """
    n_channels, n_parameters, _ = u.shape
    real = u.real.dtype
    syrk = blas.ssyrk if real == np.float32 else blas.dsyrk
    first = np.zeros(n_parameters)
    second = np.zeros((n_parameters, n_parameters), dtype=real, order="F")
    w_conj, u_conj = w.conj(), u.conj()
    for a in range(n_channels):
        for b in range(a, n_channels):
            g = u[a] * w_conj[b]
            g += w[a] * u_conj[b]
            flat = np.ascontiguousarray(g.real) if a == b else g.view(real)
            twice = 1.0 if a == b else 2.0
            second = syrk(twice, flat.T, beta=1.0, c=second, trans=1, lower=1, overwrite_c=1)
            if misfit is not None:
                m = np.ascontiguousarray(misfit[a, b])
                first += twice * (flat @ (m.real if a == b else m.view(real)))
    return first, np.asarray(second + np.tril(second, -1).T, dtype=np.float64)


def _kernel(
    data: Periodogram, p: Parameters, first: ComplexArray, second: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return K and L between sets of poles of all modes (``first``, one set or several) and one such set.

    A background has no peak and therefore no leakage, though its force may be large far below the band.
    """
    steady, leaked = kernel(data.omega, data.variance, data.length_s, first, second)
    leaked[:, np.arange(len(first)) % len(second) < p.background] = 0.0
    leaked[:, :, : p.background] = 0.0
    return steady, leaked


def _stacked(factors: list[ComplexArray], precision: type[np.complexfloating[Any]]) -> npt.NDArray[Any]:
    """Return (n_channels, n_parameters, n_groups) of parts (n_groups, n_channels, n_parameters)."""
    n_groups, n_channels, _ = factors[0].shape
    out = np.empty((n_channels, sum(part.shape[2] for part in factors), n_groups), dtype=precision)
    first = 0
    for part in factors:
        out[:, first : first + part.shape[2]] = part.transpose(1, 2, 0)
        first += part.shape[2]
    return out
