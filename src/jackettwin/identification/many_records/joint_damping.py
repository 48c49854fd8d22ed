r"""Damping of a mode from the likelihoods of many records, since each estimate would be biased.

Frequency and force differ between records; damping is common, apart from a scatter τ of ln ζ between
records. With ζ̄ the mean over records and weights w of the ranges of the noise n,

.. math:: \ell(\ln\barζ, \tau) = \max_w \sum_r \ln \sum_n w_n \int L_{rn}(x)\,
          \mathcal N(x;\ \ln\barζ - \tfrac12\tau^2, \tau^2)\,\mathrm dx
          + \alpha \sum_n w^0_n \ln w_n .

The likelihood is integrated over τ with a half-normal prior and a probability of none; the interval is by
likelihood ratio. If it is maximised over τ instead, the largest τ, by which a mean far above all records is
explained, counts as much as none: four records of ζfT = 0.2 then have 1.16 times the true damping. The
weights are those that the records show (expectation maximisation, as of a mixture); α keeps them near the
prior w⁰ where there are few.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import erf, logsumexp

from jackettwin.arrays import FloatArray
from jackettwin.identification.maximum_likelihood.line_likelihood import (
    LOG_ZETA,
    NOISE_WEIGHTS,
    likelihood_interval,
)
from jackettwin.identification.status import ModeStatus

if TYPE_CHECKING:
    from jackettwin.identification.many_records.sightings import Sightings


SCATTERS = (0.0, 0.2, 0.3, 0.4, 0.55, 0.75, 1.0)
"""Values of τ. Between 0 and the step of the nodes they cannot be distinguished."""
NO_SCATTER, USUAL_SCATTER = 0.3, 0.85
"""Prior probability that τ is 0, and standard deviation of its half-normal prior otherwise. Side-side damping
of a parked turbine is 1 % in a calm and 7 % at 25 m/s, a τ of 0.5 over all winds; that of records of one wind
does not scatter. Few records do not tell which: with a nominal 95 %, of 4 records with ζfT = 0.2 to 2, 98 to
99 % hold the mean where nothing scatters, 93 to 96 % at a τ of 0.4. Without a probability of none and a prior
of 0.7 they are 98 to 100 and 96 to 98 %, and the mean is 2 to 9 % too high where nothing scatters; with τ = 0
alone, 96 to 97 and 75 to 87 %."""
PRIOR_RECORDS = 2.0
"""α: the prior of the noise counts as so many records."""
MIXTURE_STEPS = 40
"""Most steps of expectation maximisation."""
MIXTURE_GAIN = 1e-3
"""Gain of the log-likelihood in a step below which these end."""
MANY_RECORDS, NODES_AROUND = 100, 6
"""Number of records from which only so many nodes on either side of the likeliest are computed: a factor of
3.3, beyond which the interval of so many records does not reach."""
TINY, FALLS = 1e-300, 1.0
"""Least likelihood of a record, and least fall of the logarithm per node beyond those computed."""
MIN_SHARE = 0.5
"""Smallest share of the records that must have a likelihood; otherwise estimates are averaged."""


@dataclass(frozen=True)
class JointDamping:
    """Damping ratio common to many records; ``scatter`` is τ, ``log_likelihood`` that of ``LOG_ZETA``."""

    damping_ratio: float
    interval_90: tuple[float, float]
    log_std: float
    scatter: float
    log_likelihood: FloatArray


def joint_damping(seen: Sightings) -> JointDamping | None:
    """Return the damping by the likelihoods of the records, or None if too few have one.

    A record in which the mode is ``OK`` but has no likelihood is given a normal one in ln ζ.
    """
    has = np.isfinite(seen.damping_log_likelihood).all(axis=(1, 2))
    normal = ~has & (seen.severity <= ModeStatus.OK.severity) & np.isfinite(seen.log_covariance[:, 1, 1])
    if not has.any() or has.sum() < MIN_SHARE * (has.sum() + normal.sum()):
        return None
    away = LOG_ZETA - np.log(seen.damping_ratio[normal, None])
    alone = -0.5 * away**2 / seen.log_covariance[normal, 1, 1][:, None]
    shape = (len(alone), len(NOISE_WEIGHTS), len(LOG_ZETA))
    each = np.concatenate([
        seen.damping_log_likelihood[has], np.broadcast_to(alone[:, None], shape)
    ])  # fmt: skip
    return jointly(each)


def jointly(each: FloatArray) -> JointDamping:
    """Return the damping by likelihoods (n_records, 1 + NOISE_RANGES, n_nodes) of different records."""
    top = each.max(axis=(1, 2))
    values, at = np.exp(each - top[:, None, None]), slice(None)
    if len(each) >= MANY_RECORDS:
        likeliest = int(np.argmax(np.log(NOISE_WEIGHTS @ values + TINY).sum(axis=0)))
        at = slice(max(likeliest - NODES_AROUND, 0), likeliest + NODES_AROUND + 1)
    together = np.full((len(SCATTERS), len(LOG_ZETA)), -np.inf)
    for row, tau in zip(together, SCATTERS, strict=True):
        row[at] = _over_mixture((values if tau == 0.0 else values @ _kernel(tau))[:, :, at])
    together = np.array([_continued(row) for row in together])
    over_scatter = logsumexp(together, axis=0, b=_SCATTER_WEIGHTS[:, None])
    middle, low, high, std = likelihood_interval(over_scatter)
    most = int(np.argmax(together.max(axis=1)))
    return JointDamping(
        damping_ratio=float(np.exp(middle)),
        interval_90=(float(np.exp(low)), float(np.exp(high))),
        log_std=std,
        scatter=SCATTERS[most],
        log_likelihood=over_scatter,
    )


def _continued(row: FloatArray) -> FloatArray:
    """Return a log-likelihood (n_nodes,), continued beyond the computed nodes along its last slopes.

    A step down to some low value would be overshot by the interpolation between nodes.
    """
    known = np.flatnonzero(np.isfinite(row))
    first, last = known[0], known[-1]
    below, above = np.arange(first), np.arange(1, len(row) - last)
    out = row.copy()
    out[:first] = row[first] - max(row[first + 1] - row[first], FALLS) * (first - below)
    out[last + 1 :] = row[last] - max(row[last - 1] - row[last], FALLS) * above
    return out


def _scatter_weights() -> FloatArray:
    """Return the prior probability of the interval about each of ``SCATTERS``."""
    tau = np.array(SCATTERS)
    ends = np.concatenate([tau[:1], 0.5 * (tau[1:] + tau[:-1]), [np.inf]])
    weights = (1.0 - NO_SCATTER) * np.diff(erf(ends / (USUAL_SCATTER * np.sqrt(2.0))))
    weights[0] += NO_SCATTER
    return np.asarray(weights)


_SCATTER_WEIGHTS = _scatter_weights()


def _over_mixture(values: FloatArray) -> FloatArray:
    """Return Σ ln of likelihoods (n_records, n_ranges, n_nodes) at the best weights of the ranges of noise.

    Up to a constant, with the prior of the weights.
    """
    prior = NOISE_WEIGHTS[:, None]
    weights = np.repeat(prior, values.shape[2], axis=1)
    before = np.full(values.shape[2], -np.inf)
    for _ in range(MIXTURE_STEPS):
        mixed = np.einsum("rnz,nz->rz", values, weights) + TINY
        penalty = PRIOR_RECORDS * np.sum(prior * np.log(weights / prior), axis=0)
        now = np.log(mixed).sum(axis=0) + penalty
        if np.max(now - before) < MIXTURE_GAIN:
            break
        weights = weights * np.einsum("rnz,rz->nz", values, 1.0 / mixed) + PRIOR_RECORDS * prior
        weights /= weights.sum(axis=0)
        before = now
    return np.asarray(now)


def _kernel(tau: float) -> FloatArray:
    """Return the weights (n_nodes, n_nodes) of ln ζ in columns of ln ζ̄, with mean ζ̄ and scatter τ."""
    apart = LOG_ZETA[:, None] - (LOG_ZETA - 0.5 * tau**2)
    kernel = np.exp(-0.5 * (apart / tau) ** 2)
    return np.asarray(kernel / kernel.sum(axis=0))
