"""Choice of the recommended law, and probabilities of the laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from jackettwin.progress import SILENT, Progress
from jackettwin.soil import SERIES, members
from jackettwin.updating.posterior.laplace import log_covariance
from jackettwin.updating.update import Update

PREFERRED = 0.1
"""Ratio of probabilities above which the first law in the file is recommended: another law must be ten times
as probable to override the engineer's choice (strong evidence; Kass & Raftery 1995, section 3.2)."""


@dataclass(frozen=True)
class LawRank:
    """Rank of a law among the fitted ones.

    Attributes
    ----------
    place : int
        1 is the best; laws with practically equal costs have the same rank.
    law : str
    parameters : int
        Number of free parameters; a law never fits worse than one that it contains.
    cost : float
        Cost of its best solution, thesis (8.4); χ² if the data have standard deviations.
    solutions : int
    locked : bool
        Whether its best solution locks a damper; such laws come last.
    """

    place: int
    law: str
    parameters: int
    cost: float
    solutions: int
    locked: bool


def ranked(updates: Sequence[Update]) -> tuple[LawRank, ...]:
    """Return the laws by the cost of their best solutions, those without a locked damper first.

    Of equal costs the law with fewer parameters comes first.
    """
    order = sorted(updates, key=lambda u: (u.best.locked_damper, u.best.cost))
    ranks: list[tuple[int, Update]] = []
    for i, u in enumerate(order, start=1):
        place, first = (i, u) if not ranks else (ranks[-1][0], _head(ranks))
        same = u.best.locked_damper == first.best.locked_damper
        if not same or u.best.cost > first.best.cost + u.problem.allowance(first.best.cost):
            place = i
        ranks.append((place, u))
    ranks.sort(key=lambda pair: (pair[0], len(pair[1].problem.parameters)))
    return tuple(
        LawRank(place, u.law, len(u.problem.parameters), u.best.cost, len(u.solutions), u.best.locked_damper)
        for place, u in ranks
    )


def _head(ranks: Sequence[tuple[int, Update]]) -> Update:
    """Return the first law of the last rank."""
    return next(u for place, u in ranks if place == ranks[-1][0])


def better(longer: Update, shorter: Update) -> bool:
    """Tell whether the data require the longer of two nested laws.

    With standard deviations it must be ten times as probable by Laplace's approximation of the evidence;
    without, it must reduce the cost noticeably. If only the longer law locks a damper, it is not better.
    """
    if longer.best.locked_damper != shorter.best.locked_damper:
        return shorter.best.locked_damper
    if longer.problem.weighted:
        return bool(_log_evidence(longer) - _log_evidence(shorter) > -np.log(PREFERRED))
    cost = shorter.best.cost
    return longer.best.cost < cost - longer.problem.allowance(cost)


def recommended(updates: Sequence[Update]) -> Update | None:
    """Return the recommended law without locked damper: a sampled one, else the likely one."""
    free = [u for u in updates if not u.best.locked_damper]
    sampled = [u for u in free if u.uncertainty is not None]
    return likely(sampled or free or list(updates))


def likely(updates: Sequence[Update]) -> Update | None:
    """Return the first law or, if another is ten times as probable, the simplest one comparable to that."""
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
    """Return the probability of each law without locked damper, by Laplace's approximation of the evidence.

    The result is empty if the data have no standard deviations.
    """
    free = [u for u in updates if not u.best.locked_damper and u.problem.weighted]
    if not free:
        return {}
    log_z = np.array([_log_evidence(u) for u in free])
    return {u.law: float(p) for u, p in zip(free, np.exp(log_z - logsumexp(log_z)), strict=True)}


def _log_evidence(u: Update) -> float:
    r"""Return ln L(ẑ) + ln p(ẑ) + ½ ln det 2πΣ at the best fit (MacKay 2003, eq. (27.3))."""
    # a best fit on a bound belongs to the prior
    z = np.clip(np.log(u.best.theta), u.problem.prior.low, u.problem.prior.high)
    log_l, _ = u.problem.log_likelihood(z[None], None)
    spread = 0.5 * np.linalg.slogdet(2.0 * np.pi * log_covariance(u.problem, u.best.theta))[1]
    return float(log_l[0] + u.problem.prior.log_density(z[None])[0] + spread)


def series(fit: Callable[[str], Update], progress: Progress = SILENT) -> tuple[Update, str]:
    """Return the shortest series that one more branch does not improve, with a sentence on the reason.

    Parameters
    ----------
    fit : function
        Fits a law by its name.
    """
    first, *longer = members([SERIES])
    chosen = fit(first)
    for branches, law in enumerate(longer, start=2):
        progress.within(f"{branches} branches")
        other = fit(law)
        if not better(other, chosen):
            return chosen, _why(chosen, other, branches - 1)
        chosen = other
    return chosen, f"{SERIES}: {len(longer) + 1} branches, the largest number tried."


def _why(chosen: Update, other: Update, branches: int) -> str:
    number = "one branch" if branches == 1 else f"{branches} branches"
    least, cost = other.best.cost, chosen.best.cost
    if other.best.locked_damper and not chosen.best.locked_damper:
        reason = "one more locks a damper"
    elif chosen.problem.weighted:
        reason = "one more is not ten times as probable"
    else:
        reason = "one more does not improve the fit"
    return f"{SERIES}: {number} ({chosen.law}); {reason} (cost {cost:.3g}, with one more {least:.3g})."
