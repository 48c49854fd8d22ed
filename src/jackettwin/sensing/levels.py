r"""Levels, corners and noise by evidence: Whittle's likelihood of a record's spectra.

.. math:: -\ln L = \sum_{f>0} \ln\det S(f) + y_f^H S(f)^{-1} y_f, \qquad
          S(f) = \sum_j S_j(f)\,h_j(f) h_j(f)^H + h\,R + ε^2\,\mathrm{diag}\,|y_f|^2

with the Fourier coefficients y_f of a record, the responses h_j of its sensors to each force, the density of
white noise, and a share ε of each channel's own motion that no force explains, as a model's shapes are never
exact: without it forces must, at any level (Whittle 1953). The gradient of each force's density is one number
a frequency, :math:`h_j^H S^{-1} h_j - |h_j^H S^{-1} y|^2`, so that a search costs tens of milliseconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import minimize

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.sensing.latent_forces import LatentForce

_NOISE_STD = 3.0
"""Of the logarithm of the noise's variance beforehand: it may be twenty times more or less."""
_MISFIT = 0.5
"""Of a model at a frequency, as a share of the motion there: a second mode may lie a tenth off.

Evidence cannot choose it, as the motion itself would fit best; three simulated jackets with growth that
the model lacked did."""
_SMOOTHED = 9
"""Frequencies over which a channel's motion is averaged for it."""
_DELTA = 1e-4
_REACH = 8.0
"""Of a search about its start, in logarithms."""


@dataclass(frozen=True)
class Levels:
    """What a record says of the forces on it and of its sensors.

    Attributes
    ----------
    forces : tuple of LatentForce
    noise : (n_channels,) variances of white noise
    log_likelihood : float
    evaluations : int
    """

    forces: tuple[LatentForce, ...]
    noise: FloatArray
    log_likelihood: float
    evaluations: int


def find_levels(
    y: FloatArray,
    step_s: float,
    transfer: ComplexArray,
    which: IntArray,
    forces: tuple[LatentForce, ...],
    groups: tuple[int, ...],
) -> Levels:
    """Return the most probable levels, rates and noise of a record.

    Parameters
    ----------
    y : (n_channels, n_samples)
    transfer : (n_frequencies, n_channels, n_forces) of unit forces
    which : (n_frequencies,) the FFT's frequencies that are used
    groups : channels of one group share one noise level
    """
    n = y.shape[1]
    whole = np.fft.rfft(y, axis=1) * np.sqrt(step_s / n)
    Y, power = whole[:, which].T, uniform_filter1d(np.abs(whole) ** 2, _SMOOTHED, axis=1)[:, which].T
    omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(n, step_s)[which], dtype=np.float64)
    k, bands = len(forces), tuple(dict.fromkeys((f.kind, f.rate, f.rate_log_std) for f in forces))
    of = np.array([bands.index((f.kind, f.rate, f.rate_log_std)) for f in forces])
    members = np.array([[group == g for group in groups] for g in range(max(groups) + 1)], dtype=float)
    floor = np.array([_floor(Y, members[g] > 0.0) / step_s for g in range(len(members))])
    start = np.concatenate([[log(f.level) for f in forces], np.zeros(len(bands)), np.log(floor)])
    std = np.concatenate(
        [
            [f.level_log_std for f in forces],
            [std for _, _, std in bands],
            np.full(len(members), _NOISE_STD),
        ]
    )
    unit = tuple(force.with_level(1.0) for force in forces)

    def densities(z: FloatArray) -> FloatArray:
        return np.stack(
            [
                exp(2.0 * z[j]) * f.with_level(1.0, f.rate * exp(z[k + of[j]])).density(omega)
                for j, f in enumerate(unit)
            ]
        )

    def cost(z: FloatArray) -> tuple[float, FloatArray]:
        S_f = densities(z)
        white, missed = np.exp(z[k + len(bands) :]) @ members * step_s, _MISFIT**2 * power
        r = white + missed
        value, by_force, by_noise = _whittle(Y, transfer, S_f, r)
        gradient = np.zeros(z.size)
        gradient[:k] = 2.0 * (by_force * S_f).sum(axis=1)
        for band in range(len(bands)):
            moved = z.copy()
            moved[k + band] += _DELTA
            gradient[k + band] = (by_force * (densities(moved) - S_f)).sum() / _DELTA
        gradient[k + len(bands) :] = members @ (by_noise.sum(axis=0) * white)
        away = (z - start) / std
        return value + 0.5 * float(away @ away), gradient + away / std

    reach = np.minimum(_REACH, 4.0 * std)
    found = minimize(
        cost,
        start,
        jac=True,
        method="L-BFGS-B",
        bounds=list(zip(start - reach, start + reach, strict=True)),
        options={"maxiter": 60, "ftol": 1e-7},
    )
    z = found.x
    chosen = tuple(f.with_level(exp(z[j]), f.rate * exp(z[k + of[j]])) for j, f in enumerate(unit))
    noise = np.exp(z[k + len(bands) :]) @ members
    return Levels(chosen, noise, -float(found.fun), int(found.nfev))


def _whittle(
    Y: ComplexArray, H: ComplexArray, S_f: FloatArray, r: FloatArray
) -> tuple[float, FloatArray, FloatArray]:
    """Return −ln L, and its derivatives by the densities (n_forces, n) and by those of the noise r (n, m).

    By the matrix inversion lemma in the noise's own scale.
    """
    h = H / np.sqrt(r)[:, :, None] * np.sqrt(S_f.T)[:, None, :]
    y = Y / np.sqrt(r)
    S = h @ h.conj().transpose(0, 2, 1) + np.eye(r.shape[1])
    inverse = np.linalg.inv(S)
    solved = np.einsum("fij,fj->fi", inverse, y)
    _, logdet = np.linalg.slogdet(S)
    value = float(logdet.sum() + np.log(r).sum() + (y.conj() * solved).real.sum())
    seen = inverse @ h
    own = np.einsum("fij,fij->fj", h.conj(), seen).real
    fit = np.abs(np.einsum("fij,fi->fj", h.conj(), solved)) ** 2
    by_noise = (np.einsum("fii->fi", inverse).real - np.abs(solved) ** 2) / r
    return value, ((own - fit) / S_f.T).T, by_noise


def _floor(Y: ComplexArray, which: FloatArray) -> float:
    """Return the density of the noise to start from: the quietest twentieth of the spectra."""
    power = np.abs(Y[:, which]) ** 2
    return float(np.quantile(power, 0.05) / -np.log(0.95))
