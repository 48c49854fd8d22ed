r"""Maximum-likelihood refinement of all modes of a band together (Bayesian FFT identification).

The Whittle log-likelihood of the spectral matrices :math:`\hat S_k` of groups of :math:`n_k` lines,

.. math:: \ell = -\sum_k n_k\left[\ln\det E_k + \mathrm{tr}\,E_k^{-1}\hat S_k\right]

is maximised by damped Fisher scoring. A known share of the local median spectrum is added to model **and**
data. It keeps E regular where the record has less noise than the model can follow.

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


START_NOISE = 0.3
"""Noise at the start, as a share of the smallest local median of the spectrum."""
START_EXPONENTS = (0.0, 1.0, 2.0, 3.0, 4.0)
"""Common exponents of the force spectra tried at the start."""
MAX_ITERATIONS = 80
TOLERANCE = 0.1
"""The iteration has converged if the undamped step is below this share of the standard deviations of ln f and
ln ζ of the fitted modes, and the gain it predicts is below ``EXPECTED_GAIN``."""
EXPECTED_GAIN = 1.0
"""Predicted gain of log-likelihood below which the force and noise parameters have converged as well."""
FIRST_RIDGE = 1e-3
"""Ridge of the first step, as a share of the information."""
FULL_STEP_RIDGE = 1e-4
"""Ridge of a step that counts as undamped, as a share of the information. It is not zero because the data
hardly determine some directions of the parameters."""
MAX_RIDGE = 1e7
"""Ridge above which a step is negligibly short."""
MIN_GAIN = 0.001
"""Smallest gain of a step: one of less gain ends the iteration if its ridge was at most
``SHORT_STEP_RIDGE``."""
SHORT_STEP_RIDGE = 0.1
"""Largest ridge of a step whose small gain means convergence; a more damped step may just be short."""
SMALL_GAIN = 0.03
"""Gain below which a step counts as idle while the predicted gain is below ``EXPECTED_GAIN``; otherwise a
step is idle below ``MIN_GAIN``."""
MAX_IDLE_STEPS = 3
"""Consecutive idle steps that end the iteration, however damped they were."""
ZETA_RANGE = (1e-5, 0.5)
ROUNDING_OFFSET = np.complex64(1e-4 + 1e-4j)
"""Adding and subtracting this rounds derivatives below 1e-11 to zero."""


@dataclass(frozen=True)
class Evaluation:
    """The log-posterior at one set of parameters, up to a constant, and its intermediate results.

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
class Optimum:
    """The end of an optimisation.

    Attributes
    ----------
    converged : bool
    ridge : float
        That of a next step.
    expected_gain : float
        Gain of log-likelihood that the last step was expected to bring if it was not shortened.
    """

    parameters: Parameters
    value: float
    converged: bool
    ridge: float
    expected_gain: float = np.inf


def maximise(
    data: Periodogram, p: Parameters, most: int = MAX_ITERATIONS, *, ridge: float = FIRST_RIDGE
) -> Optimum:
    """Maximise the posterior by damped Fisher scoring in at most ``most`` steps, the first with ``ridge``."""
    prior = prior_of(data, p)
    at, idle, expected_gain = evaluate(data, prior, p), 0, np.inf
    if at is None:
        return Optimum(p, -np.inf, False, ridge)
    for _ in range(most):
        score, fisher = scoring(data, prior, at)
        left, expected_gain = _remaining(at.parameters, score, fisher)
        if left < TOLERANCE and expected_gain < EXPECTED_GAIN:
            return Optimum(at.parameters, at.value, True, ridge, expected_gain)
        trial, used = _ascend(data, prior, at, score, fisher, ridge)
        if trial is None:
            return Optimum(at.parameters, at.value, False, ridge, expected_gain)
        gain = trial.value - at.value
        idle = idle + 1 if gain < (SMALL_GAIN if expected_gain < EXPECTED_GAIN else MIN_GAIN) else 0
        at, ridge = trial, max(used / 10.0, 1e-6)
        if idle == MAX_IDLE_STEPS or (used <= SHORT_STEP_RIDGE and gain < MIN_GAIN):
            return Optimum(at.parameters, at.value, True, ridge, expected_gain)
    return Optimum(at.parameters, at.value, False, ridge, expected_gain)


def _ascend(
    data: Periodogram,
    prior: ParameterPrior,
    at: Evaluation,
    score: FloatArray,
    fisher: FloatArray,
    ridge: float,
) -> tuple[Evaluation | None, float]:
    """Raise the ridge until a step does not lower the posterior; return the new point and the ridge."""
    while ridge < MAX_RIDGE:
        step = _solve(fisher, score, ridge)
        if _relative_step(at.parameters, step) <= 1.0:
            trial = evaluate(data, prior, at.parameters.moved(step))
            if trial is not None and trial.value >= at.value:
                return trial, ridge
        ridge *= 6.0
    return None, ridge


def _remaining(p: Parameters, score: FloatArray, fisher: FloatArray) -> tuple[float, float]:
    """Return the distance to the maximum of the local parabola, and the gain there.

    The distance is the largest of the steps of ln f and ln ζ of the fitted modes, in standard deviations.
    """
    step = _solve(fisher, score, FULL_STEP_RIDGE)
    size = np.abs(step) * np.sqrt(np.diag(fisher))
    n = len(p.log_f)
    sought = np.append(size[p.n_fixed : n], size[n + p.n_fixed : 2 * n])
    return float(sought.max(initial=0.0)), float(0.5 * score @ step)


def start(
    data: Periodogram, f: FloatArray, zeta: FloatArray, shapes: FloatArray, outside: int = 0
) -> Parameters:
    """Return the starting point: shapes scaled to their peaks, incoherent forces, one common exponent.

    The first ``outside`` modes lie outside the band; they are scaled to the power of the nearest line.
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
    noise = np.stack([noise_level(data, START_NOISE), np.zeros(data.floor.shape[1])])
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
        for colour in START_EXPONENTS
    ]
    return max(first, key=lambda p: objective(data, prior_of(data, p), p))


def objective(data: Periodogram, prior: ParameterPrior, p: Parameters) -> float:
    """Return the log-posterior up to a constant; −∞ outside the admissible region."""
    at = evaluate(data, prior, p)
    return -np.inf if at is None else at.value


def evaluate(data: Periodogram, prior: ParameterPrior, p: Parameters) -> Evaluation | None:
    """Return the log-posterior and its intermediate results, or None outside the admissible region."""
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
    """Return the score and the Fisher information, including the prior."""
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

    Single precision halves the work; its relative error of 1e-6 is far below the convergence tolerance. Far
    from its peak a mode's derivatives have subnormal products, which take five times as long as normal ones;
    adding and subtracting ``ROUNDING_OFFSET`` sets them to zero.
    """
    weight = np.sqrt(data.count).astype(np.float32)
    u, w = derivative_factors(data, p, model, white, np.complex64)
    u *= weight
    for factor in (u, w):
        factor += ROUNDING_OFFSET
        factor -= ROUNDING_OFFSET
    return gram(u, w, misfit.transpose(1, 2, 0).astype(np.complex64) * weight)


def misfit_of(data: Periodogram, white: ComplexArray) -> ComplexArray:
    """Return the misfit W Ŝ Wᴴ − I of W = (chol E)⁻¹."""
    misfit = white @ data.dithered @ white.conj().transpose(0, 2, 1)
    return np.asarray(misfit - np.eye(white.shape[1]))


def inverse_root(matrices: ComplexArray) -> ComplexArray:
    """Return the inverse of the lower Cholesky factor of each matrix."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(matrices)))


def _relative_step(p: Parameters, step: FloatArray) -> float:
    """Return the length of a step relative to the range in which the model is nearly linear."""
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


def _solve(fisher: FloatArray, score: FloatArray, ridge: float) -> FloatArray:
    """Solve the damped scoring equation with every parameter scaled by its own information."""
    unit = 1.0 / np.sqrt(np.diag(fisher))
    scaled = fisher * np.outer(unit, unit) + ridge * np.eye(len(unit))
    solution, fault = lapack.dposv(scaled, unit * score)[1:]
    if fault:
        return np.asarray(unit * linalg.lstsq(scaled, unit * score)[0])
    return np.asarray(unit * solution)
