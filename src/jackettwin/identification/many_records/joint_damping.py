r"""Damping of a mode from the likelihoods of many records, since each estimate would be biased.

Frequency, force and noise differ between records; damping is common, apart from a scatter τ of ln ζ between
records. With ζ̄ the mean over records,

.. math:: \ell(\ln\barζ, \tau) = \sum_r \ln \int L_r(x)\,
          \mathcal N(x;\ \ln\barζ - \tfrac12\tau^2, \tau^2)\,\mathrm dx

is maximised over τ at every ζ̄; the interval is by likelihood ratio.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification.maximum_likelihood.line_likelihood import LOG_ZETA, likelihood_interval
from jackettwin.identification.status import ModeStatus

if TYPE_CHECKING:
    from jackettwin.identification.many_records.sightings import Sightings


SCATTERS = (0.2, 0.3, 0.4, 0.55, 0.75, 1.0)
"""Values of τ besides 0. A value below the step of the nodes cannot be distinguished from 0."""
MIN_SHARE = 0.5
"""Smallest share of the records that must have a likelihood; otherwise estimates are averaged."""


@dataclass(frozen=True)
class JointDamping:
    """Damping ratio common to many records; ``scatter`` is τ."""

    damping_ratio: float
    interval_90: tuple[float, float]
    log_std: float
    scatter: float


def joint_damping(seen: Sightings) -> JointDamping | None:
    """Return the damping by the likelihoods of the records, or None if too few have one.

    A record in which the mode is ``OK`` but has no likelihood is given a normal one in ln ζ.
    """
    has = np.isfinite(seen.damping_log_likelihood).all(axis=1)
    normal = ~has & (seen.severity <= ModeStatus.OK.severity) & np.isfinite(seen.log_covariance[:, 1, 1])
    if not has.any() or has.sum() < MIN_SHARE * (has.sum() + normal.sum()):
        return None
    away = LOG_ZETA - np.log(seen.damping_ratio[normal, None])
    each = np.vstack(
        [seen.damping_log_likelihood[has], -0.5 * away**2 / seen.log_covariance[normal, 1, 1][:, None]]
    )
    together = np.array([each.sum(axis=0), *(_scattered(each, tau) for tau in SCATTERS)])
    middle, low, high, std = likelihood_interval(together.max(axis=0))
    most = int(np.argmax(together.max(axis=1)))
    return JointDamping(
        damping_ratio=float(np.exp(middle)),
        interval_90=(float(np.exp(low)), float(np.exp(high))),
        log_std=std,
        scatter=(0.0, *SCATTERS)[most],
    )


def _scattered(each: FloatArray, tau: float) -> FloatArray:
    """Return Σ ln of the likelihoods averaged over ln ζ with mean ζ̄ and scatter τ, at the nodes of ln ζ̄."""
    apart = LOG_ZETA[:, None] - (LOG_ZETA - 0.5 * tau**2)
    kernel = np.exp(-0.5 * (apart / tau) ** 2)
    kernel /= kernel.sum(axis=0)
    top = each.max(axis=1, keepdims=True)
    mean = np.exp(each - top) @ kernel
    return np.asarray(np.sum(np.log(np.maximum(mean, 1e-300)) + top, axis=0))
