"""Priors of the spectral model: weak on forces, noise and phase lags, none on f and ζ of the fitted modes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


NOISE_CENTRE = 0.01
"""Centre of the prior of the noise, as a share of the smallest local median."""
COHERENCE_PRIOR = 1.0
"""Weight of ln det Γ, which keeps coherences inside the unit circle."""
COLOUR_PRIOR = 3.0
"""Standard deviation of the exponents of the force spectra about their common exponent."""
NOISE_PRIOR = (2.7, 1.0)
"""Standard deviations of the logarithm of the noise and of its exponent. The first is that of a uniform
distribution over four decades: noise may be the whole floor of the spectrum or a negligible part of it."""
LAG_PRIOR = 0.05
"""Standard deviation of the imaginary parts of a shape, as a share of its norm (3° for all channels
together)."""
FIXED_STD = 1e-4
"""Standard deviation of the prior on ln f and ln ζ of modes that are not fitted."""


@dataclass(frozen=True)
class ParameterPrior:
    """Centre and precision of the Gaussian prior of every parameter."""

    centre: FloatArray
    precision: FloatArray


def noise_level(data: Periodogram, share: float) -> FloatArray:
    """Return the logarithm of a share of each channel's smallest local median, (n_channels,)."""
    return np.asarray(np.log(share * data.floor.min(axis=0)))


def prior_of(data: Periodogram, p: Parameters) -> ParameterPrior:
    """Return the prior: weak on exponents, noise and phase lags, tight on modes that are not fitted."""
    level = noise_level(data, NOISE_CENTRE)
    blank = p.moved(-p.vector)
    mode = np.arange(len(p.log_f))
    fixed, background = (mode < p.n_fixed).astype(float), (mode < p.background).astype(float)
    centre = replace(
        blank,
        log_f=p.log_f * fixed,
        log_zeta=p.log_zeta * fixed,
        colour=p.exponent * (1.0 - background),
        noise=np.stack([level, np.zeros_like(level)]),
    )
    std = np.repeat(np.array(NOISE_PRIOR)[:, None], len(level), axis=1)
    precision = replace(
        blank,
        log_f=fixed * FIXED_STD**-2,
        log_zeta=fixed * FIXED_STD**-2,
        colour=np.full(len(p.colour), COLOUR_PRIOR**-2),
        noise=std**-2.0,
        lag=np.broadcast_to((LAG_PRIOR * p.lagging_size) ** -2.0, p.lag.shape),
    )
    return ParameterPrior(centre.vector, precision.vector)


def add_coherence_prior(p: Parameters, score: FloatArray, fisher: FloatArray) -> None:
    """Add the gradient and curvature of ln det Γ to the score and the information."""
    i, j = p.pairs.T
    if not len(i):
        return
    inverse = np.linalg.inv(p.gamma)
    first = 3 * len(p.log_f) + p.shapes.size
    at = slice(first, first + 2 * len(i))
    slope = inverse[j, i]
    score[at] += 2.0 * COHERENCE_PRIOR * np.concatenate([slope.real, -slope.imag])
    # tr(Γ⁻¹ dΓ_p Γ⁻¹ dΓ_q), dΓ = e_i e_jᵀ d + h.c.
    a = inverse[np.ix_(j, i)]
    b = inverse[np.ix_(j, j)] * inverse[np.ix_(i, i)].T
    direct, cross = a * a.T, b
    rr = 2.0 * (direct + cross).real
    ii = 2.0 * (cross - direct).real
    ri = 2.0 * (-direct.imag + cross.imag)
    fisher[at, at] += COHERENCE_PRIOR * np.block([[rr, ri], [ri.T, ii]])
