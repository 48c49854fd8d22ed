r"""Maximum-likelihood refinement of all modes of a band together (Bayesian FFT identification).

The Whittle log-likelihood of the spectral matrices :math:`\hat S_k` of groups of :math:`n_k` lines,

.. math:: \ell = -\sum_k n_k\left[\ln\det E_k + \mathrm{tr}\,E_k^{-1}\hat S_k\right]

is climbed by damped Fisher scoring. A known share of the local median spectrum is added to model **and**
data, which keeps E regular where the record has less noise than the model can follow.

Whittle 1953; Au 2011 and 2017 (Bayesian FFT, its uncertainty laws); Sykulski et al. 2019 (de-biased
Whittle likelihood).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg
from scipy.linalg import lapack

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.maximum_likelihood.parameters import Parameters, coherent_pairs
from jackettwin.identification.maximum_likelihood.prior import (
    COHERENCE_PRIOR,
    ParameterPrior,
    add_coherence_prior,
    noise_level,
    prior_of,
)
from jackettwin.identification.maximum_likelihood.spectral_model import (
    Expected,
    derivative_factors,
    expected,
    gram,
    response_power,
)

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


QUIET = 0.3
"""Noise at the start, as a share of the lowest local median."""
COLOURS = (0.0, 1.0, 2.0, 3.0, 4.0)
"""Exponents tried at the start, of all force spectra together."""
MAX_ITERATIONS = 80
TOLERANCE = 0.1
"""Stop where the whole step, undamped, is below this share of the standard deviations of ln f and ln ζ of the
modes that are sought: it would change what is said of them by nothing that matters …"""
EXPECTED_GAIN = 1.0
"""… and would gain less log-likelihood than this: forces and noise have settled as well …"""
NO_LIFT = 1e-4
"""Share of the information that is added to call a step undamped: some directions have next to none."""
MOST_LIFT = 1e7
"""The same, from which a step goes nowhere."""
LEAST_GAIN = 0.001
"""… or where a step gains less than this, if it was damped by no more than …"""
FREE = 0.1
"""… this share of the information: one held back is short. …"""
LITTLE_GAIN = 0.03
"""… Or where several steps running gain less than this and less than the above is expected, or …"""
MOST_IDLE = 3
"""… where so many running gain next to nothing, however damped."""
ZETA_RANGE = (1e-5, 0.5)
ROUNDED_OFF = np.complex64(1e-4 + 1e-4j)
"""Derivatives below 1e-11 are taken for zero."""


@dataclass(frozen=True)
class Evaluation:
    """The log-posterior at one set of parameters, up to a constant, and what it was made of.

    Attributes
    ----------
    white : (n_groups, n_channels, n_channels)
        (chol E)⁻¹.
    """

    parameters: Parameters
    value: float
    model: Expected
    white: ComplexArray


@dataclass(frozen=True)
class Climb:
    """Where a climb ended."""

    parameters: Parameters
    value: float
    converged: bool


def climbed(data: Periodogram, p: Parameters, most: int = MAX_ITERATIONS) -> Climb:
    """Climb to the maximum of the posterior by damped Fisher scoring, in at most so many steps."""
    prior = prior_of(data, p)
    at, lift, idle = point(data, prior, p), 1e-3, 0
    if at is None:
        return Climb(p, -np.inf, False)
    for _ in range(most):
        score, fisher = scoring(data, prior, at)
        left, expected_gain = _left(at.parameters, score, fisher)
        if left < TOLERANCE and expected_gain < EXPECTED_GAIN:
            return Climb(at.parameters, at.value, True)
        trial, used = _ascended(data, prior, at, score, fisher, lift)
        if trial is None:
            return Climb(at.parameters, at.value, False)
        gain = trial.value - at.value
        idle = idle + 1 if gain < (LITTLE_GAIN if expected_gain < EXPECTED_GAIN else LEAST_GAIN) else 0
        at, lift = trial, max(used / 10.0, 1e-6)
        if idle == MOST_IDLE or (used <= FREE and gain < LEAST_GAIN):
            return Climb(at.parameters, at.value, True)
    return Climb(at.parameters, at.value, False)


def _ascended(
    data: Periodogram,
    prior: ParameterPrior,
    at: Evaluation,
    score: FloatArray,
    fisher: FloatArray,
    lift: float,
) -> tuple[Evaluation | None, float]:
    """Return the first point no lower that a step, damped more and more, reaches, and how much it was."""
    while lift < MOST_LIFT:
        step = _solved(fisher, score, lift)
        if _far(at.parameters, step) <= 1.0:
            trial = point(data, prior, at.parameters.moved(step))
            if trial is not None and trial.value >= at.value:
                return trial, lift
        lift *= 6.0
    return None, lift


def _left(p: Parameters, score: FloatArray, fisher: FloatArray) -> tuple[float, float]:
    """Return how far the maximum of a parabola is, and how much higher.

    The distance is the largest in standard deviations of ln f and ln ζ of the modes that are sought.
    """
    step = _solved(fisher, score, NO_LIFT)
    size = np.abs(step) * np.sqrt(np.diag(fisher))
    n = len(p.log_f)
    sought = np.append(size[p.held : n], size[n + p.held : 2 * n])
    return float(sought.max(initial=0.0)), float(0.5 * score @ step)


def start(
    data: Periodogram, f: FloatArray, zeta: FloatArray, shapes: FloatArray, outside: int = 0
) -> Parameters:
    """Return first parameters: shapes scaled to the power of their peaks, incoherent forces, one exponent.

    So many of the first modes are beside the band: scaled to the power of the line that is nearest.
    """
    zeta = np.clip(zeta, 1e-3, 0.3)
    scaled = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    for i, phi in enumerate(scaled):
        away = np.abs(data.omega / (2.0 * np.pi) - f[i])
        near = away <= max(1.5 * f[i] * zeta[i], 1.5 / data.duration_s, float(away.min()))
        power = np.real(phi @ data.density[near] @ phi)
        response = response_power(data, f[i], zeta[i])[near]
        scaled[i] = phi * np.sqrt(max(np.mean(power / response), 1e-30))
    n = len(f)
    pairs = coherent_pairs(np.log(f))
    none = np.zeros(len(pairs), dtype=complex)
    noise = np.stack([noise_level(data, QUIET), np.zeros(data.floor.shape[1])])
    first = [
        Parameters(
            np.log(f),
            np.log(zeta),
            np.full(n, colour),
            scaled,
            none,
            noise,
            pairs,
            outside=outside,
            exponent=colour,
        )
        for colour in COLOURS
    ]
    return max(first, key=lambda p: objective(data, prior_of(data, p), p))


def objective(data: Periodogram, prior: ParameterPrior, p: Parameters) -> float:
    """Return the log-posterior up to a constant; −∞ outside the admissible region."""
    at = point(data, prior, p)
    return -np.inf if at is None else at.value


def point(data: Periodogram, prior: ParameterPrior, p: Parameters) -> Evaluation | None:
    """Return the log-posterior and what it is made of; None outside the admissible region."""
    low, high = np.log(ZETA_RANGE)
    if np.any(p.log_zeta > high) or np.any(p.log_zeta < low):
        return None
    try:
        root = np.linalg.cholesky(p.gamma)
        with np.errstate(over="ignore", invalid="ignore"):
            model = expected(data, p)
            factor = np.linalg.cholesky(model.matrix)
    except np.linalg.LinAlgError:
        return None
    log_det = 2.0 * np.log(np.einsum("kaa->ka", factor).real).sum(axis=1)
    white = np.asarray(np.linalg.inv(factor))
    trace = np.einsum("kab,kab->k", white @ data.dithered, white.conj()).real
    value = -np.sum(data.count * (log_det + trace))
    value -= 0.5 * np.sum(prior.precision * (p.vector - prior.centre) ** 2)
    value += COHERENCE_PRIOR * 2.0 * np.sum(np.log(np.diag(root).real))
    return Evaluation(p, float(value), model, white) if np.isfinite(value) else None


def scoring(data: Periodogram, prior: ParameterPrior, at: Evaluation) -> tuple[FloatArray, FloatArray]:
    """Return the score and the Fisher information, prior included."""
    p = at.parameters
    score, fisher = products(data, p, at.model, at.white, misfit_of(data, at.white))
    score -= prior.precision * (p.vector - prior.centre)
    fisher[np.diag_indices(len(score))] += prior.precision
    add_coherence_prior(p, score, fisher)
    return score, fisher


def products(
    data: Periodogram, p: Parameters, model: Expected, white: ComplexArray, misfit: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Return Σ_k n_k ⟨G_p, misfit⟩ and Σ_k n_k ⟨G_p, G_q⟩ of the whitened derivatives of E.

    In single precision, half the work: 1e-6 of a step is far below what ends a climb. Far from its peak a
    mode's derivatives have products below the least normal number, which cost five times as much as others:
    what is added and taken off rounds them to zero.
    """
    weight = np.sqrt(data.count).astype(np.float32)
    u, w = derivative_factors(data, p, model, white, np.complex64)
    u *= weight
    for factor in (u, w):
        factor += ROUNDED_OFF
        factor -= ROUNDED_OFF
    return gram(u, w, misfit.transpose(1, 2, 0).astype(np.complex64) * weight)


def misfit_of(data: Periodogram, white: ComplexArray) -> ComplexArray:
    """Return the misfit W Ŝ Wᴴ − I of W = (chol E)⁻¹."""
    misfit = white @ data.dithered @ white.conj().transpose(0, 2, 1)
    return np.asarray(misfit - np.eye(white.shape[1]))


def inverse_root(matrices: ComplexArray) -> ComplexArray:
    """Return the inverse of the lower Cholesky factor of each matrix."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(matrices)))


def _far(p: Parameters, step: FloatArray) -> float:
    """Return how far a step goes, over the neighbourhood in which the model is nearly linear."""
    n, n_pairs = len(p.log_f), len(p.coherence)
    size = np.linalg.norm(p.shapes, axis=1, keepdims=True)
    reach = np.concatenate(
        [
            0.5 * np.exp(p.log_zeta),
            np.full(n, 0.5),
            np.full(n, 2.0),
            np.broadcast_to(0.5 * size, p.shapes.shape).ravel(),
            np.full(2 * n_pairs, 1.0),
            np.full(p.noise.size, 2.0),
            np.broadcast_to(0.5 * p.lagging_size, p.lag.shape).ravel(),
        ]
    )
    return float(np.max(np.abs(step) / reach))


def _solved(fisher: FloatArray, score: FloatArray, lift: float) -> FloatArray:
    """Solve the damped scoring equation, every parameter in units of its own information."""
    unit = 1.0 / np.sqrt(np.diag(fisher))
    scaled = fisher * np.outer(unit, unit) + lift * np.eye(len(unit))
    solution, fault = lapack.dposv(scaled, unit * score)[1:]
    if fault:
        return np.asarray(unit * linalg.lstsq(scaled, unit * score)[0])
    return np.asarray(unit * solution)
