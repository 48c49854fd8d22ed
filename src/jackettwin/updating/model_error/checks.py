r"""What a fitted model cannot explain, and which error would explain it.

About the best fit, residuals r of all measured data, whitened by what is measured, follow

.. math:: r \sim N(0, K), \quad K = I + ΓΓ^T + J P^{-1} J^T, \qquad W = K^{-1}.

A datum left out is missed by :math:`(Wr)_i/W_{ii}` with variance :math:`1/W_{ii}` (Rasmussen & Williams 2006,
5.12), whether it was fitted or not. An error γ of unknown size takes :math:`(γ^T W r)^2/γ^T W γ` off χ²; of
a suspect that is asked for by its name this is a test of its own. The directions of pairs are data, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import exp, sqrt

import numpy as np
from scipy.special import chdtrc, ndtri

from jackettwin.arrays import FloatArray
from jackettwin.updating.data.misfit import UNLIKELY
from jackettwin.updating.data.targets import Target
from jackettwin.updating.model_error.checked_data import CheckedData, Column, checked_data
from jackettwin.updating.model_error.directions import Direction, Tolerance
from jackettwin.updating.model_error.marginal import covariance
from jackettwin.updating.model_error.pair_directions import PairDirection
from jackettwin.updating.problem import Problem

_MOST = 3
"""Explanations that are named."""
_LARGEST = 8.0
"""Standard deviations of a tolerance beyond which it is no explanation: nor does the first order hold."""
_WORTH = 4.0
"""χ² that an explanation takes off to be one: two standard deviations."""
_TOLD = 1e-9
"""Precision, in that of the measurement, below which the others say nothing of a datum."""


@dataclass(frozen=True)
class DatumCheck:
    """A measured value beside what all the others say of it.

    Attributes
    ----------
    datum : str
        ``f1``, ``ζ4``; ``α1`` of the direction in which the lower mode of a pair moves.
    miss : float
        Measured over predicted, less one; of a direction measured less predicted [rad].
    std : float
        Standard deviation of that: prediction and measurement.
    fitted : bool
    objects : bool
        Whether chance does not explain it, among so many data.
    """

    datum: str
    miss: float
    std: float
    fitted: bool
    objects: bool

    @property
    def is_direction(self) -> bool:
        """Whether it is an angle, not a share."""
        return self.datum.startswith("α")


@dataclass(frozen=True)
class Explanation:
    """An error that would explain what the model does not.

    Attributes
    ----------
    tolerance : Tolerance
    size : float
        In the tolerance's unit.
    stds : float
        The same in its standard deviations.
    gain : float
        χ² that it takes off.
    """

    tolerance: Tolerance
    size: float
    stds: float
    gain: float


@dataclass(frozen=True)
class Objection:
    """What a fitted model does not explain.

    Attributes
    ----------
    checks : tuple of DatumCheck
        Of every measured value, fitted or not.
    chi2, freedom, probability : float
        Of all values that are fitted, and of frequencies and directions that are not.
    explanations : tuple of Explanation
        The best first; empty where nothing is to be explained.
    unseen : tuple of Tolerance
        Suspects that at their size would be objected to less than every second time.
    seen_from : tuple of float
        Of each of these, the size in its unit from which it would be every second time or more, as far as the
        first order holds; infinite if it moves nothing.
    suspected : tuple of Tolerance
        Suspects that the data ask for, beyond chance.
    """

    checks: tuple[DatumCheck, ...]
    chi2: float
    freedom: int
    probability: float
    explanations: tuple[Explanation, ...] = ()
    unseen: tuple[Tolerance, ...] = ()
    suspected: tuple[Tolerance, ...] = ()
    seen_from: tuple[float, ...] = ()

    @property
    def objects(self) -> bool:
        """Whether chance does not explain what was measured."""
        stray = any(check.objects for check in self.checks)
        return self.probability < UNLIKELY or stray or bool(self.suspected)


def objection(
    problem: Problem,
    z: FloatArray,
    beside: Sequence[Target] = (),
    suspects: Sequence[Direction] = (),
    pairs: Sequence[PairDirection] = (),
) -> Objection | None:
    """Return what a problem's best fit (d,) of ln θ leaves unexplained; None without standard deviations.

    Parameters
    ----------
    beside : modes that were measured and not fitted; of these the frequencies are checked
    suspects : errors beside those of the error model that may explain it
    pairs : directions of pairs of modes that were measured
    """
    if not problem.weighted:
        return None
    rows = checked_data(problem, z, beside, suspects, pairs)
    if rows is None:
        return None
    flat = np.array([p.median is None for p in problem.parameters])
    precision = np.diag(np.where(flat, problem.prior.std**-2.0, 0.0))
    inverse = np.linalg.inv(covariance(rows.gains))
    information = rows.J.T @ inverse @ rows.J + precision
    W = inverse - inverse @ rows.J @ np.linalg.solve(information, rows.J.T @ inverse)
    Wr = W @ rows.r
    chi2 = float(rows.r @ Wr)
    used = int((np.linalg.svd(rows.J * problem.prior.std, compute_uv=False) > 0.5).sum())
    freedom = max(rows.r.size - used, 1)
    limit = -float(ndtri(0.5 * UNLIKELY / max(len(rows.names) + len(rows.asked), 1)))
    unseen = _unseen(rows.asked, W, limit)
    result = Objection(
        _checks(rows, set(problem.data_names), W, Wr, limit),
        chi2,
        freedom,
        float(chdtrc(freedom, max(chi2, 0.0))),
        unseen=tuple(tolerance for tolerance, _ in unseen),
        seen_from=tuple(size for _, size in unseen),
        suspected=_each_once(
            c.tolerance
            for c, gamma in rows.asked
            if float(gamma @ Wr) ** 2 > limit**2 * max(float(gamma @ W @ gamma), _TOLD)
        ),
    )
    if not result.objects:
        return result
    return replace(result, explanations=_explanations([*rows.known, *rows.asked], W, Wr))


def _unseen(asked: Sequence[Column], W: FloatArray, limit: float) -> list[tuple[Tolerance, float]]:
    """Return the suspects that would not be seen at their size, and from which size each would, wherever."""
    found: dict[str, tuple[Tolerance, float]] = {}
    for direction, gamma in asked:
        tolerance, power = direction.tolerance, sqrt(max(float(gamma @ W @ gamma), 0.0))
        size = tolerance.std * (limit / power if power > 0.0 else np.inf)
        if size > tolerance.std and size > found.get(tolerance.name, (tolerance, 0.0))[1]:
            found[tolerance.name] = tolerance, float(size)
    return list(found.values())


def _each_once(tolerances: Iterable[Tolerance]) -> tuple[Tolerance, ...]:
    return tuple({tolerance.name: tolerance for tolerance in tolerances}.values())


def _checks(
    rows: CheckedData, fitted: set[str], W: FloatArray, Wr: FloatArray, limit: float
) -> tuple[DatumCheck, ...]:
    """Return each datum beside what all the others say of it."""
    own = np.diag(W)
    judged = [i for i in range(len(rows.names)) if own[i] > _TOLD and np.isfinite(rows.scale[i])]
    stray = _strays(W, Wr, judged, limit)
    checks = []
    for i in judged:
        # residuals are of the model over the measured
        miss, name = -float(Wr[i] / own[i] * rows.scale[i]), rows.names[i]
        by = miss if name.startswith("α") else exp(min(miss, 50.0)) - 1.0
        std = float(rows.scale[i] / np.sqrt(own[i]))
        checks.append(DatumCheck(name, by, std, name in fitted, i in stray))
    return tuple(checks)


def _strays(W: FloatArray, Wr: FloatArray, judged: Sequence[int], limit: float) -> set[int]:
    """Return the data that the others do not allow: the worst first, without it the next.

    One datum far off makes others look wrong that were fitted together with it.
    """
    stray: set[int] = set()
    while left := [i for i in judged if i not in stray and W[i, i] > _TOLD]:
        worst = max(left, key=lambda i: abs(Wr[i]) / np.sqrt(W[i, i]))
        if abs(Wr[worst]) <= limit * np.sqrt(W[worst, worst]):
            break
        stray.add(worst)
        column, size = W[:, worst].copy(), W[worst, worst]
        Wr = Wr - column * (Wr[worst] / size)
        W = W - np.outer(column, column) / size
    return stray


def _explanations(columns: list[Column], W: FloatArray, Wr: FloatArray) -> tuple[Explanation, ...]:
    """Return the single errors that take most off χ², each name once."""
    best: dict[str, Explanation] = {}
    for direction, gamma in columns:
        seen = float(gamma @ W @ gamma)
        if seen < 1e-9:
            continue
        tolerance, size = direction.tolerance, -float(gamma @ Wr) / seen
        if abs(size) > _LARGEST:
            continue
        one = Explanation(tolerance, size * tolerance.std, size, float(gamma @ Wr) ** 2 / seen)
        if one.gain >= max(_WORTH, best[tolerance.name].gain if tolerance.name in best else 0.0):
            best[tolerance.name] = one
    return tuple(sorted(best.values(), key=lambda one: -one.gain)[:_MOST])
