r"""Spectrum of the identified modes, for comparison with the measured one.

Frequencies, damping and shapes are those identified.
The densities S of white modal forces and N of noise maximise the likelihood of the lines near the modes;
they are found by minorisation (Zhou, Hu, Zhou & Lange 2019):

.. math:: E(f) = \sum_{ij} S_{ij}\, \phi_i \phi_j^H\, \overline{h_i h_j^*} + N, \quad
          h_i = \frac{-f^2}{f_i^2 - f^2 + 2 i \zeta_i f_i f}

The bar is the average over the lines that Welch's window mixes, so that a lightly damped mode is smeared in E
as it is in the measured spectrum. Where E is below the measured spectrum, no mode explains it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.identification.estimate import Spectrum
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.preparation.spectra import SEGMENTS
from jackettwin.identification.preparation.whitening import as_measured, left_to_differentiate
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.records import spectral_matrix

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Identification, ModalEstimate
    from jackettwin.records import Record


WINDOW_LINES = 2.0
"""Reach of a Hann window, in lines to either side."""
WINDOW_SAMPLES = 81
"""Number of points over that reach at which the average is taken."""
NEAR_HALF_BANDWIDTHS, NEAR_LINES = 3.0, 2.0
"""S and N are fitted to lines whose distance from a mode is at most this many half bandwidths plus this many
lines."""
REGULARISATION = 0.3
"""Share of the measured densities added to data and model;
without it the smallest singular values dominate."""
ITERATIONS = 100
START_NOISE_SHARE = 1e-3
"""Initial noise, as a share of a channel's mean density."""


def modal_fit(record: Record, found: Identification) -> Spectrum | None:
    """Return the fitted spectrum in the band, to compare with ``found.spectrum``; None without modes.

    Parameters
    ----------
    record : Record
        Record from which the modes were identified.
    """
    if not found.modes:
        return None
    s = found.settings
    settings = IdentificationSettings(
        lowest_frequency_hz=s.lowest_frequency_hz,
        highest_frequency_hz=s.highest_frequency_hz,
        sample_rate_hz=s.sample_rate_hz,
    )
    ready = prepare(record, settings)
    length = max(ready.y.shape[1] // SEGMENTS, 16)
    f, measured = spectral_matrix(ready.y, s.sample_rate_hz, length)
    band = (f > s.lowest_frequency_hz) & (f < s.highest_frequency_hz)
    derivatives = np.array(left_to_differentiate(ready.channels, ready.differentiated))
    motion = _motion(found.modes, f[band], f[1], derivatives, ready.scale)
    near = _lines_near_modes(found.modes, f[band], f[1])
    fitted = _fitted(measured[band], motion, near)
    density = np.einsum("faa->af", fitted).real * ready.scale[:, None] ** 2
    singular = np.linalg.svd(fitted, compute_uv=False).T.astype(np.float64)
    return as_measured(Spectrum(f[band], np.asarray(density), singular), ready.differentiated)


def _motion(
    modes: Sequence[ModalEstimate], f: FloatArray, step: float, derivatives: FloatArray, scale: FloatArray
) -> ComplexArray:
    """Return the motion of the channels per unit modal force around each line.

    Returns
    -------
    (n_frequencies, WINDOW_SAMPLES, n_modes, n_channels), times the root of the window's weight at each point
    """
    bins = np.linspace(-WINDOW_LINES, WINDOW_LINES, WINDOW_SAMPLES)
    weight = np.sinc(bins) ** 2 / np.where(np.abs(np.abs(bins) - 1.0) < 1e-9, np.inf, 1.0 - bins**2) ** 2
    weight[np.abs(np.abs(bins) - 1.0) < 1e-9] = 0.25
    fine = np.maximum(f[:, None] + step * bins, 0.1 * step)[:, :, None]
    f_i = np.array([m.frequency_hz for m in modes])
    zeta = np.array([m.damping_ratio for m in modes])
    h = -(fine**2) / (f_i**2 - fine**2 + 2j * zeta * f_i * fine)
    shapes = np.array([m.mode_shape for m in modes]) / scale
    of_quantity = (f_i / fine)[..., None] ** derivatives
    return np.asarray(h[..., None] * shapes * of_quantity * np.sqrt(weight / weight.sum())[:, None, None])


def _lines_near_modes(modes: Sequence[ModalEstimate], f: FloatArray, step: float) -> BoolArray:
    """Return which lines are near a mode; elsewhere other motion dominates."""
    reach = np.array(
        [NEAR_HALF_BANDWIDTHS * m.damping_ratio * m.frequency_hz + NEAR_LINES * step for m in modes]
    )
    return np.asarray((np.abs(f[:, None] - [m.frequency_hz for m in modes]) < reach).any(axis=1))


def _fitted(measured: ComplexArray, motion: ComplexArray, near: BoolArray) -> ComplexArray:
    """Return E with the S and N that are most likely given the lines near the modes."""
    n_modes = motion.shape[2]
    everywhere = np.einsum("fsia,fsjb->ijfab", motion, motion.conj(), optimize=True)
    measured, products = measured[near], everywhere[:, :, near]
    known = REGULARISATION * np.einsum("faa->fa", measured).real[:, :, None] * np.eye(measured.shape[1])
    power = np.einsum("faa->f", measured).real
    force = np.diag(power.max() / np.einsum("iifaa->if", products).real.max(axis=1)).astype(complex)
    noise = START_NOISE_SHARE * np.einsum("faa->a", measured).real / len(measured)
    flat = products.reshape(n_modes**2, -1)  # once: a hundred sums run over it
    fitted = _spectrum(force, noise, flat) + known
    for _ in range(ITERATIONS):
        inverse: ComplexArray = np.asarray(np.linalg.inv(fitted))
        twice: ComplexArray = np.asarray(inverse @ (measured + known) @ inverse)
        loss, gain = (_traces(matrices, flat, n_modes) for matrices in (inverse, twice))
        force = _geometric_mean(loss, force @ gain @ force)
        noise = noise * np.sqrt(np.einsum("faa->a", twice).real / np.einsum("faa->a", inverse).real)
        fitted = _spectrum(force, noise, flat) + known
    return _spectrum(force, noise, everywhere.reshape(n_modes**2, -1))


def _spectrum(force: ComplexArray, noise: FloatArray, products: ComplexArray) -> ComplexArray:
    """Return E (n_frequencies, n_channels, n_channels) of products (n_modes², all of its entries)."""
    forced = (force.ravel() @ products).reshape(-1, len(noise), len(noise))
    return np.asarray(forced + np.diag(noise))


def _traces(matrices: ComplexArray, products: ComplexArray, n_modes: int) -> ComplexArray:
    """Return the sums over all lines of tr(A Pᵢⱼ), at (j, i)."""
    sums = products @ matrices.transpose(0, 2, 1).ravel()
    return np.asarray(sums.reshape(n_modes, n_modes).T)


def _geometric_mean(b: ComplexArray, c: ComplexArray) -> ComplexArray:
    """Return the positive semi-definite X with X B X = C."""
    root = _root(b)
    inverse = np.linalg.inv(root)
    return np.asarray(inverse @ _root(root @ c @ root) @ inverse)


def _root(matrix: ComplexArray) -> ComplexArray:
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.conj().T))
    return np.asarray((vectors * np.sqrt(np.maximum(values, 1e-30 * values[-1]))) @ vectors.conj().T)
