"""Which law to recommend, and how probable each is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp

from jackettwin.updating.posterior.laplace import log_covariance
from jackettwin.updating.update import Update

PREFERRED = 0.1
"""The first law of the file is kept unless another is ten times as probable: weaker evidence is no reason to
overrule the engineer who knows the ground (Kass & Raftery 1995, section 3.2)."""


def recommended(updates: Sequence[Update]) -> Update | None:
    """Return the law to report, of those that lock no damper: a sampled one, else the likely one."""
    free = [u for u in updates if not u.best.locked_damper]
    sampled = [u for u in free if u.uncertainty is not None]
    return likely(sampled or free or list(updates))


def likely(updates: Sequence[Update]) -> Update | None:
    """Return the first law; where another is ten times as probable, the simplest that comes near that one."""
    if not updates:
        return None
    first = next((u for u in updates if not u.best.locked_damper), updates[0])
    probability = approximate_probability(updates)
    if first.law not in probability:
        return first
    least = PREFERRED * max(probability.values())
    if probability[first.law] >= least:
        return first
    near = [u for u in updates if probability.get(u.law, 0.0) >= least]
    return min(near, key=lambda u: (len(u.problem.parameters), -probability[u.law]))


def approximate_probability(updates: Sequence[Update]) -> dict[str, float]:
    """Return each law's probability by Laplace's approximation of its evidence, unless its damper is locked.

    Nothing where the data carry no standard deviations.
    """
    free = [u for u in updates if not u.best.locked_damper and u.problem.weighted]
    if not free:
        return {}
    log_z = np.array([_log_evidence(u) for u in free])
    return {u.law: float(p) for u, p in zip(free, np.exp(log_z - logsumexp(log_z)), strict=True)}


def _log_evidence(u: Update) -> float:
    r"""Return ln L(ẑ) + ln p(ẑ) + ½ ln det 2πΣ at the best fit (MacKay 2003, eq. (27.3))."""
    # a best fit on its bound is inside the prior
    z = np.clip(np.log(u.best.theta), u.problem.prior.low, u.problem.prior.high)
    log_l, _ = u.problem.log_likelihood(z[None], None)
    spread = 0.5 * np.linalg.slogdet(2.0 * np.pi * log_covariance(u.problem, u.best.theta))[1]
    return float(log_l[0] + u.problem.prior.log_density(z[None])[0] + spread)
